//! Parts of the repository that are not in the package made by `cargo package`.

use crate::skip;
use std::path::Path;

/// Whether this is the package, which leaves out `reports/`: then it prints that a test is skipped.
/// In the repository the reports exist, and a test without them fails.
pub(crate) fn is_without_reports() -> bool {
    // Cargo adds this file to every package.
    let is_package = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml.orig").is_file();
    if is_package {
        skip::report("the package leaves out reports/, which this test reads");
    }
    is_package
}
