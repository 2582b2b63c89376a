//! Errors and how they are worded.
//!
//! Input problems are collected: one [`Error::Input`] carries every [`Diagnostic`] of a file, each with the place
//! to change. Everything else is a single sentence. This module knows no other module of the crate.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The result of everything in the crate that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a run did not happen or could not be finished.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The scene, or something it refers to, is not usable. Contains at least one diagnostic of
    /// kind `Error`.
    #[error("{}", join(.0))]
    Input(Vec<Diagnostic>),
    /// The command line asks for something that makes no sense.
    #[error("{0}")]
    Usage(String),
    /// A file could not be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// A report could not be drawn or written in its format.
    #[error("{what}: {reason}")]
    Output {
        /// What was being written.
        what: String,
        /// Why it failed.
        reason: String,
    },
}

impl Error {
    /// An I/O error with the file it happened to.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_path_buf(), source }
    }
}

/// One remark about the input, with the place to change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// Error or warning.
    pub kind: DiagnosticKind,
    /// The file, or the argument `-D key=value`; `None` for the command line as a whole.
    pub file: Option<PathBuf>,
    /// Line in the file, from 1.
    pub line: Option<usize>,
    /// Byte range in the file, to be underlined.
    pub span: Option<Range<usize>>,
    /// Dotted key, such as `media.pmma.index`; may be empty.
    pub key: String,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub hint: Option<String>,
}

/// Whether a diagnostic stops the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DiagnosticKind {
    /// The scene cannot be used.
    Error,
    /// The scene can be used, but may not be what the user means.
    Warning,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.file, self.line) {
            (Some(file), Some(line)) => write!(out, "{}:{line}: ", file.display())?,
            (Some(file), None) => write!(out, "{}: ", file.display())?,
            (None, _) => {}
        }
        if self.kind == DiagnosticKind::Warning {
            write!(out, "warning: ")?;
        }
        if !self.key.is_empty() {
            write!(out, "`{}`: ", self.key)?;
        }
        write!(out, "{}", self.message)?;
        match &self.hint {
            Some(hint) => write!(out, "; {hint}"),
            None => Ok(()),
        }
    }
}

fn join(diagnostics: &[Diagnostic]) -> String {
    diagnostics.iter().map(Diagnostic::to_string).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_diagnostic_is_one_line_with_its_place() {
        let diagnostic = Diagnostic {
            kind: DiagnosticKind::Error,
            file: Some("scenes/rod.toml".into()),
            line: Some(6),
            span: None,
            key: "media.pmma.index".into(),
            message: "0.149 is out of range, expected 1 to 4".into(),
            hint: None,
        };
        assert_eq!(
            diagnostic.to_string(),
            "scenes/rod.toml:6: `media.pmma.index`: 0.149 is out of range, expected 1 to 4"
        );
    }
}
