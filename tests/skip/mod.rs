//! A test that is skipped says so, also where the output of tests that pass is not shown.

use std::io::Write;

/// Writes a line with the name of this test and the reason to the standard error itself, which the
/// test harness does not capture.
pub(crate) fn report(why: &str) {
    let thread = std::thread::current();
    let line = format!("\nSKIPPED {}: {why}\n", thread.name().unwrap_or("a test"));
    // A closed terminal does not fail the test.
    _ = std::io::stderr().write_all(line.as_bytes());
}
