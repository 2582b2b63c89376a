//! Errors of files of measured values.

/// Longest file that is read, bytes.
pub const MAX_MEASURED_BYTES: u64 = 256 << 20;

/// Why a file of measured values could not be read.
#[derive(Debug, thiserror::Error)]
pub enum MeasuredError {
    /// The operating system refuses the file.
    #[error("the file cannot be read: {0}; check the name and the permissions")]
    Unreadable(#[from] std::io::Error),
    /// The file is longer than [`MAX_MEASURED_BYTES`].
    #[error("more than {} MiB; average neighbouring values before", MAX_MEASURED_BYTES >> 20)]
    TooLong,
    /// A line is not usable.
    #[error("line {line}: {problem}")]
    WrongLine {
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        problem: String,
    },
    /// What is missing or contradicted is in no line.
    #[error("{0}")]
    NoMap(String),
}

impl MeasuredError {
    /// An error of a line, from 1.
    pub fn of_line(line: usize, problem: impl Into<String>) -> Self {
        Self::WrongLine { line, problem: problem.into() }
    }

    /// An error of the file as a whole.
    pub fn of_file(problem: impl Into<String>) -> Self {
        Self::NoMap(problem.into())
    }
}
