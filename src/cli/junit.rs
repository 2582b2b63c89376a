//! The JUnit XML file that several commands write after `--junit`.

use crate::cli::exit::fail;
use lumiduct_base::error::Error;
use lumiduct_report::{Existing, JunitFile};
use std::path::Path;
use std::process::ExitCode;

/// The JUnit XML file, where one is wanted. `output` is the folder of the report.
pub(super) fn open_junit(
    file: Option<&Path>,
    output: Option<&Path>,
    existing: Existing,
) -> Result<Option<JunitFile>, Error> {
    let Some(file) = file else { return Ok(None) };
    if output == Some(file) {
        let file = file.display();
        return Err(Error::Usage(format!(
            "--junit {file}: is the folder given by -o; name a file"
        )));
    }
    JunitFile::open(file, existing).map(Some)
}

/// Writes a JUnit XML file where one is wanted, and returns the exit code of the rest.
pub(super) fn write_junit(
    file: Option<&JunitFile>,
    xml: impl FnOnce() -> Result<String, Error>,
    code: ExitCode,
) -> ExitCode {
    match file.map_or(Ok(()), |file| file.write(&xml()?)) {
        Ok(()) => code,
        Err(error) => fail(&error),
    }
}
