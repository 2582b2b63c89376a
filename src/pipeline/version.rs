//! Which version and which build of the program this is, for the files it writes.

/// Version of the program, for reports.
pub(crate) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The exact build of the program: its version and a digest of its sources. For files that are not
/// part of a report.
pub(crate) const BUILD: &str = env!("LUMIDUCT_BUILD");
