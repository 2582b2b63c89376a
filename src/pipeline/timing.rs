//! Timings, which are outside the reproducible set of files.

use crate::pipeline::tracing::Traced;
use lumiduct_base::error::Result;
use lumiduct_report::Folder;

/// Writes `timing.csv` next to a report.
pub(super) fn write(folder: &Folder, traced: &Traced) -> Result<()> {
    let seconds = traced.elapsed.as_secs_f64();
    let (paths, segments) = (traced.findings.paths as f64, traced.findings.segments() as f64);
    let text = format!(
        "seconds,paths_per_s,segments_per_s\n{seconds:.3},{:.0},{:.0}\n",
        paths / seconds,
        segments / seconds
    );
    folder.write_beside("timing.csv", text.as_bytes())
}
