//! What is printed: results on stdout, everything else on stderr.
//!
//! Streams may be closed or full. The program never panics because of it, and the exit code still
//! reflects the work. Control characters in names and titles never reach a terminal.

use lumiduct_base::error::Error;
use lumiduct_base::text::visible;
use std::io::{ErrorKind, Write};

/// Prints to stdout; a pipe that the reader has closed is not an error.
pub(super) fn print(text: &str) -> Result<(), Error> {
    let (text, mut stdout) = (visible(text), std::io::stdout());
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(reason) if reason.kind() != ErrorKind::BrokenPipe => {
            Err(Error::Output { what: "standard output".into(), reason: reason.to_string() })
        }
        Ok(()) | Err(_) => Ok(()),
    }
}

/// Prints to stderr in one write. If stderr fails the text is lost: there is nowhere left to report
/// it.
pub(super) fn print_error(text: &str) {
    _ = std::io::stderr().write_all(visible(text).as_bytes());
}

/// The same for coloured text: of the control characters only colour sequences are kept.
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
