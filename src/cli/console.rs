//! What is printed: results on stdout, everything else on stderr.
//!
//! Streams may be closed or full. That never ends the program with a panic: exit codes say what the work deserves.
//! Control characters of names and titles never reach a terminal.

use lumiduct_base::error::Error;
use lumiduct_base::text::visible;
use std::io::{ErrorKind, Write};

/// Prints to stdout; a reader that closed the pipe has seen enough.
pub(super) fn print(text: &str) -> Result<(), Error> {
    let (text, mut stdout) = (visible(text), std::io::stdout());
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(reason) if reason.kind() != ErrorKind::BrokenPipe => {
            Err(Error::Output { what: "standard output".into(), reason: reason.to_string() })
        }
        Ok(()) | Err(_) => Ok(()),
    }
}

/// Prints to stderr in one write. A text that nobody can read is lost, for there is no place left to say so.
pub(super) fn print_error(text: &str) {
    _ = std::io::stderr().write_all(visible(text).as_bytes());
}

/// The same for a text in colours: of control characters the sequences that set a colour stay.
pub(super) fn print_coloured(text: &str) {
    let mut pieces = text.split("\u{1b}[");
    let mut shown = visible(pieces.next().unwrap_or_default());
    for piece in pieces {
        let parameters = piece.trim_start_matches(|letter: char| "0123456789;".contains(letter));
        shown += if parameters.starts_with('m') { "\u{1b}[" } else { "\\u{1b}[" };
        shown += &visible(piece);
    }
    _ = std::io::stderr().write_all(shown.as_bytes());
}
