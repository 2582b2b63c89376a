//! Traces the validation at its full precision, by the test that also holds its page.

use crate::{Share, commits, root};
use std::io;
use std::process::Command;

/// What becomes of docs/validation.md.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ResultsPage {
    /// It must be what comes out.
    Verify,
    /// It is written anew.
    Write,
}

/// Traces cases with the errors of docs/validation.md; returns whether all values are met, and the
/// page is right.
pub(crate) fn validate(share: Share, page: ResultsPage) -> io::Result<bool> {
    let scope = match share {
        Share::All => "all".to_owned(),
        Share::Tenth => format!("{}/10", commits()? % 10),
    };
    let mut test = Command::new(env!("CARGO"));
    test.args(["test", "--locked", "--test", "validation", "--", "--nocapture"])
        .env("LUMIDUCT_VALIDATION", scope)
        .current_dir(root());
    match page {
        ResultsPage::Verify => test.env_remove("UPDATE_GOLDEN"),
        ResultsPage::Write => test.env("UPDATE_GOLDEN", "1"),
    };
    Ok(test.status()?.success())
}
