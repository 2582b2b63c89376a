//! Files of random content, written and read again: each format gives back what it can hold. Formats that the crate does not write
//! are written here.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

mod luminaires;
mod measured;
mod rays;
mod scatter;
mod spectra;

use proptest::prelude::*;
use proptest::test_runner::RngSeed;

type Verdict = Result<(), TestCaseError>;

/// The same cases in every run, and no file of failures.
fn config(cases: u32) -> ProptestConfig {
    let rng_seed = RngSeed::Fixed(20);
    ProptestConfig { cases, rng_seed, failure_persistence: None, ..ProptestConfig::default() }
}

/// A text without blanks at its ends, short enough for every field of EULUMDAT.
fn text() -> impl Strategy<Value = String> {
    "[!-~µé°]([ -~µé°]{0,20}[!-~µé°])?"
}
