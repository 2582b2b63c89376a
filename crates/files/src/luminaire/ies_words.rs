//! Numbers of LM-63 files: separated by blanks, commas and line ends.

use crate::luminaire::error::LuminaireError;
use crate::luminaire::fields::NumberReader;
use crate::luminaire::format::LuminaireFormat;
use std::iter::Peekable;

/// Reads the numbers of some lines, one after the other.
pub(crate) struct WordReader<'t> {
    words: Peekable<Box<dyn Iterator<Item = (usize, &'t str)> + 't>>,
    /// Line of the last number, from 1.
    line: usize,
}

impl<'t> WordReader<'t> {
    /// Those from a line on, counted from 0.
    pub(crate) fn new(lines: &'t [&'t str], first: usize) -> Self {
        let words = lines.iter().enumerate().skip(first).flat_map(|(line, text)| {
            let is_gap =
                |letter: char| letter.is_whitespace() || letter == ',' || letter == '\u{1a}';
            text.split(is_gap).filter(|word| !word.is_empty()).map(move |word| (line + 1, word))
        });
        let words: Box<dyn Iterator<Item = (usize, &'t str)> + 't> = Box::new(words);
        Self { words: words.peekable(), line: first }
    }

    /// Line of the next number, from 1; that of the last one at the end.
    pub(crate) fn next_line(&mut self) -> usize {
        self.words.peek().map_or(self.line, |(line, _)| *line)
    }

    pub(crate) fn end(&mut self, [planes, angles]: [usize; 2]) -> Result<(), LuminaireError> {
        match self.words.next() {
            None => Ok(()),
            Some((line, word)) => {
                let what = format!("`{}` follows the last intensity", shown(word));
                let counts = format!("of {planes} horizontal times {angles} vertical angles");
                let cause = "the counts may be wrong, or numbers have decimal commas";
                Err(violated(line, format!("{what} {counts}: {cause}")))
            }
        }
    }
}

impl NumberReader for WordReader<'_> {
    fn next(&mut self, what: &str) -> Result<f64, LuminaireError> {
        let Some((line, word)) = self.words.next() else {
            return Err(self.wrong(format!("the file ends before {what}")));
        };
        self.line = line;
        let value: Option<f64> = word.parse().ok();
        let value = value.filter(|value| value.is_finite());
        value.ok_or_else(|| self.wrong(format!("expected {what}, found `{}`", shown(word))))
    }

    fn wrong(&self, problem: String) -> LuminaireError {
        violated(self.line, problem)
    }
}

/// The beginning of a word, for a message.
fn shown(word: &str) -> String {
    lumiduct_base::number::shorten(word, 30)
}

/// The error of a line, from 1.
pub(crate) fn violated(line: usize, problem: String) -> LuminaireError {
    LuminaireError::Violated { format: LuminaireFormat::Ies, line, problem }
}
