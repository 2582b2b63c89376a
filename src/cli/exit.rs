//! How a command ends: what it reports on the terminal, and its exit code.

use crate::cli::console::{print, print_coloured, print_error};
use lumiduct_base::error::{Diagnostic, Error, Result};
use lumiduct_input::diagnostic::{self, Colour};
use std::io::{ErrorKind, IsTerminal};
use std::process::ExitCode;

/// The exit code that shells use after Ctrl-C: 128 plus the number of the signal.
pub(super) const INTERRUPTED: u8 = 130;

/// Prints a text, or the error in place of it.
pub(super) fn finish(text: Result<String>) -> ExitCode {
    match text.and_then(|text| print(&text)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => fail(&error),
    }
}

/// Prints warnings about the input of a command.
pub(super) fn warn(warnings: &[Diagnostic]) {
    if !warnings.is_empty() {
        print_coloured(&rendered(warnings));
    }
}

/// Diagnostics with the lines they are about, in colour on a terminal.
fn rendered(diagnostics: &[Diagnostic]) -> String {
    let colour = if std::io::stderr().is_terminal() { Colour::Always } else { Colour::Never };
    diagnostic::render(diagnostics, &diagnostic::sources_of(diagnostics), colour)
}

/// Prints why a command failed, and returns its exit code.
pub(super) fn fail(error: &Error) -> ExitCode {
    match error {
        Error::Input(diagnostics) => {
            print_coloured(&rendered(diagnostics));
            ExitCode::from(2)
        }
        Error::Usage(message) => {
            print_error(&format!("error: {message}\n"));
            ExitCode::from(2)
        }
        Error::Io { .. } | Error::Output { .. } => {
            print_error(&format!("error: {error}\n"));
            ExitCode::from(if is_of_a_name(error) { 2 } else { 3 })
        }
    }
}

/// Whether a file fails because of its name: a folder where a file should be, a file where a folder
/// should be, or a name that no file can have.
fn is_of_a_name(error: &Error) -> bool {
    match error {
        Error::Io { source, .. } => matches!(
            source.kind(),
            ErrorKind::IsADirectory | ErrorKind::NotADirectory | ErrorKind::InvalidFilename
        ),
        Error::Input(_) | Error::Usage(_) | Error::Output { .. } => false,
    }
}
