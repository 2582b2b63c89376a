//! The texts that input comes from: files and arguments of the command line.
//!
//! Knows nothing of the contents of the texts. A file is read whole, once, within a limit of size.

use std::fmt;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Largest readable file, bytes.
pub(crate) const MAX_FILE_BYTES: u64 = 16 << 20;

/// One of the [`Texts`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TextId(usize);

/// A stretch of bytes in one of the texts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// The text.
    pub source: TextId,
    /// Bytes of it.
    pub span: Range<usize>,
}

/// Where a text comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum TextKind {
    /// A file.
    File(PathBuf),
    /// An argument `-D key=value`; the text is what follows `-D`.
    Argument,
}

/// A text with its lines.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct SourceText {
    kind: TextKind,
    text: String,
    /// Offset of the first byte of each line.
    line_starts: Vec<usize>,
}

impl SourceText {
    fn new(kind: TextKind, text: String) -> Self {
        let line_starts = std::iter::once(0)
            .chain(text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i + 1));
        let line_starts = line_starts.collect();
        Self { kind, text, line_starts }
    }

    /// The whole text.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// Whether it is a file.
    pub(crate) fn is_file(&self) -> bool {
        match self.kind {
            TextKind::File(_) => true,
            TextKind::Argument => false,
        }
    }

    /// How a message names the text: the path, or the argument.
    pub(crate) fn label(&self) -> PathBuf {
        match &self.kind {
            TextKind::File(path) => path.clone(),
            TextKind::Argument => argument_label(&self.text).into(),
        }
    }

    /// The line of a byte, from 1; `None` for an argument, which has no lines.
    pub(crate) fn line(&self, offset: usize) -> Option<usize> {
        match self.kind {
            TextKind::File(_) => Some(self.line_starts.partition_point(|start| *start <= offset)),
            TextKind::Argument => None,
        }
    }

    /// The bytes of a line counted from 1, without its line end; `None` beyond the last.
    pub(crate) fn line_span(&self, line: usize) -> Option<Range<usize>> {
        let start = *self.line_starts.get(line.checked_sub(1)?)?;
        let end = self.line_starts.get(line).map_or(self.text.len(), |next| next - 1);
        let text = self.text.get(start..end)?;
        Some(start..start + text.trim_end_matches('\r').len())
    }
}

/// All texts that one scene is made of.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Texts {
    list: Vec<SourceText>,
}

impl Texts {
    /// Reads a file, or returns it if it was read before.
    pub(crate) fn add_file(&mut self, path: &Path) -> Result<TextId, Unreadable> {
        let known = self
            .list
            .iter()
            .position(|source| matches!(&source.kind, TextKind::File(file) if file == path));
        match known {
            Some(index) => Ok(TextId(index)),
            None => {
                let text = read(path)?;
                Ok(self.add_text(path, &text))
            }
        }
    }

    /// Takes a text as that of a file, without looking at the file.
    pub(crate) fn add_text(&mut self, path: &Path, text: &str) -> TextId {
        self.add(TextKind::File(path.to_path_buf()), text.into())
    }

    /// Takes an argument of the command line, without the `-D`.
    pub(crate) fn add_argument(&mut self, text: &str) -> TextId {
        self.add(TextKind::Argument, text.into())
    }

    fn add(&mut self, kind: TextKind, text: String) -> TextId {
        self.list.push(SourceText::new(kind, text));
        TextId(self.list.len() - 1)
    }

    /// One text. Ids of another `Sources` are invalid here.
    pub(crate) fn get(&self, id: TextId) -> &SourceText {
        &self.list[id.0]
    }

    /// The folder of the file of a place; `None` on the command line.
    pub(crate) fn folder(&self, origin: &Origin) -> Option<&Path> {
        match &self.get(origin.source).kind {
            TextKind::File(path) => path.parent(),
            TextKind::Argument => None,
        }
    }

    /// All texts in the order of their first use.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &SourceText> {
        self.list.iter()
    }

    /// The text of a file, if it was read.
    pub(crate) fn file(&self, path: &Path) -> Option<&SourceText> {
        self.list.iter().find(|source| matches!(&source.kind, TextKind::File(file) if file == path))
    }

    /// The files that diagnostics refer to, read again for their lines. Unreadable files are left
    /// out.
    pub(crate) fn of_files<'a>(paths: impl IntoIterator<Item = &'a Path>) -> Self {
        let mut sources = Self::default();
        for path in paths {
            // If a file is gone, its message is shown without the line.
            _ = sources.add_file(path);
        }
        sources
    }

    /// The text at a place, on one line and no longer than 40 characters.
    pub(crate) fn excerpt(&self, origin: &Origin) -> String {
        let text = self.get(origin.source).text.get(origin.span.clone()).unwrap_or_default();
        let line = text.lines().next().unwrap_or_default();
        if line.chars().count() > EXCERPT_CHARS || line.len() < text.trim_end().len() {
            let cut: String = line.chars().take(EXCERPT_CHARS - 3).collect();
            return format!("{}...", cut.escape_debug());
        }
        // Quotes stay as the user wrote them; only terminal control characters are escaped.
        line.chars()
            .map(|c| if c.is_control() { c.escape_debug().to_string() } else { c.to_string() })
            .collect()
    }
}

/// Longest piece of a file that is quoted in a message, characters.
const EXCERPT_CHARS: usize = 40;

/// Why a file could not be read.
#[derive(Debug)]
pub(crate) enum Unreadable {
    /// There is no such file.
    Missing,
    /// It is a directory, a device or a pipe.
    NotAFile,
    /// It is larger than [`MAX_FILE_BYTES`].
    TooLarge,
    /// It is not UTF-8, first in this line.
    NotUtf8 {
        /// Line, from 1.
        line: usize,
    },
    /// An error of the system.
    Io(std::io::Error),
}

impl fmt::Display for Unreadable {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing => write!(out, "no such file"),
            Self::NotAFile => write!(out, "not a file"),
            Self::TooLarge => write!(out, "larger than {} MiB", MAX_FILE_BYTES >> 20),
            Self::NotUtf8 { line } => write!(out, "not UTF-8 text, first in line {line}"),
            Self::Io(error) => write!(out, "cannot be read: {error}"),
        }
    }
}

/// How a message names the argument `-D text`.
pub(crate) fn argument_label(text: &str) -> String {
    format!("-D {}", text.escape_debug())
}

fn read(path: &Path) -> Result<String, Unreadable> {
    let failed = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => Unreadable::Missing,
        _ => Unreadable::Io(error),
    };
    // Checked before opening: opening a pipe waits for its writer.
    if !std::fs::metadata(path).map_err(failed)?.is_file() {
        return Err(Unreadable::NotAFile);
    }
    let mut bytes = Vec::new();
    File::open(path)
        .map_err(failed)?
        .take(MAX_FILE_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(Unreadable::TooLarge);
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        Unreadable::NotUtf8 { line: 1 + good.iter().filter(|b| **b == b'\n').count() }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_counted_from_one_and_end_before_the_line_break() {
        let source = SourceText::new(TextKind::File("a".into()), "one\r\ntwo\nthree".into());
        assert_eq!((source.line(0), source.line(4), source.line(5)), (Some(1), Some(1), Some(2)));
        let lines: Vec<_> =
            (0..5).map(|line| source.line_span(line).map(|span| &source.text[span])).collect();
        assert_eq!(lines, [None, Some("one"), Some("two"), Some("three"), None]);
    }

    #[test]
    fn what_is_no_text_file_is_refused_without_waiting() {
        let folder = tempfile::tempdir().unwrap();
        let mut sources = Texts::default();
        assert!(matches!(sources.add_file(folder.path()), Err(Unreadable::NotAFile)));
        assert!(matches!(sources.add_file(&folder.path().join("gone")), Err(Unreadable::Missing)));
        let binary = folder.path().join("binary");
        std::fs::write(&binary, b"a\nb\xff").unwrap();
        assert!(matches!(sources.add_file(&binary), Err(Unreadable::NotUtf8 { line: 2 })));
        let huge = folder.path().join("huge");
        File::create(&huge).unwrap().set_len(MAX_FILE_BYTES + 1).unwrap();
        assert!(matches!(sources.add_file(&huge), Err(Unreadable::TooLarge)));
    }

    #[test]
    fn excerpts_are_short_and_harmless() {
        let mut sources = Texts::default();
        let long = sources.add_argument(&"x".repeat(100));
        let bell = sources.add_argument("'\u{1b}[31m'");
        assert_eq!(sources.excerpt(&Origin { source: long, span: 0..100 }).len(), 40);
        assert_eq!(sources.excerpt(&Origin { source: bell, span: 0..7 }), r"'\u{1b}[31m'");
    }
}
