//! What of the repository is not in the package that `cargo package` makes of it.

use std::path::Path;

/// Whether this is the package, which leaves out `reports/`: then it says that a test is skipped. In the repository the
/// reports are there, and a test fails that misses them.
#[allow(clippy::print_stderr, reason = "the reason belongs to the output of the test")]
pub(crate) fn is_without_reports() -> bool {
    // Cargo adds this file to every package.
    let is_package = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml.orig").is_file();
    if is_package {
        eprintln!("skipped: the package leaves out reports/, which this test reads");
    }
    is_package
}
