//! What is printed: results on stdout, everything else on stderr.
//!
//! Streams may be closed or full. That never ends the program with a panic: exit codes say what the work deserves.

use crate::error::Error;
use std::io::{ErrorKind, Write};

/// Prints to stdout; a reader that closed the pipe has seen enough.
pub(super) fn print(text: &str) -> Result<(), Error> {
    let mut stdout = std::io::stdout();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(reason) if reason.kind() != ErrorKind::BrokenPipe => {
            Err(Error::Output { what: "standard output".into(), reason: reason.to_string() })
        }
        Ok(()) | Err(_) => Ok(()),
    }
}

/// Prints to stderr in one write. A text that nobody can read is lost, for there is no place left to say so.
pub(super) fn print_error(text: &str) {
    _ = std::io::stderr().write_all(text.as_bytes());
}
