//! Diagnostics for the terminal: the place, the message, and the line with the offending text underlined.

use std::path::Path;

use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

use crate::texts::Texts;
use lumiduct_base::error::{Diagnostic, DiagnosticKind};

/// Whether text contains the colour codes of a terminal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// Plain text.
    Never,
    /// With ANSI escape sequences.
    Always,
}

/// The files that diagnostics refer to, read for their lines. Unreadable files are left out.
pub fn sources_of(diagnostics: &[Diagnostic]) -> Texts {
    let with_line = diagnostics.iter().filter(|diagnostic| diagnostic.line.is_some());
    Texts::of_files(with_line.filter_map(|diagnostic| diagnostic.file.as_deref()))
}

/// All diagnostics, by file and line. The first line of each is `file:line: key: message`, or `error: ` and the message where
/// it is about no line; then the line of the file follows, where `sources` has it, and the hint.
pub fn render(diagnostics: &[Diagnostic], sources: &Texts, colour: Colour) -> String {
    let mut sorted: Vec<_> = diagnostics.iter().collect();
    sorted.sort_by_key(|diagnostic| {
        let start = diagnostic.span.as_ref().map(|span| span.start);
        (diagnostic.file.is_none(), &diagnostic.file, diagnostic.line, start)
    });
    sorted.into_iter().map(|diagnostic| render_one(diagnostic, sources, colour)).collect()
}

fn render_one(diagnostic: &Diagnostic, sources: &Texts, colour: Colour) -> String {
    let is_marked = diagnostic.line.is_some() || diagnostic.kind == DiagnosticKind::Warning;
    let mark = if is_marked { "" } else { "error: " };
    let headline = format!("{mark}{}", Diagnostic { hint: None, ..diagnostic.clone() });
    let level = match diagnostic.kind {
        DiagnosticKind::Error => Level::ERROR,
        DiagnosticKind::Warning => Level::WARNING,
    };
    let cut = diagnostic.file.as_deref().and_then(|file| cut(diagnostic, file, sources));
    let mut group = Group::with_level(level);
    if let Some(cut) = &cut {
        let underline = AnnotationKind::Primary.span(cut.span.clone());
        group =
            group.element(Snippet::source(&cut.text).line_start(cut.line).annotation(underline));
    }
    if let Some(hint) = &diagnostic.hint {
        group = group.element(Level::HELP.message(hint));
    }
    if group.is_empty() {
        return format!("{headline}\n");
    }
    let renderer = match colour {
        Colour::Never => Renderer::plain(),
        Colour::Always => Renderer::styled(),
    };
    format!("{headline}\n{}\n", renderer.decor_style(DecorStyle::Ascii).render(&[group]))
}

/// The line to show, and what to underline in it.
struct Cut {
    line: usize,
    text: String,
    span: std::ops::Range<usize>,
}

/// Most bytes of a line that are shown on each side of the underlined part, and of that part.
const CUT_BYTES: usize = 120;

fn cut(diagnostic: &Diagnostic, file: &Path, sources: &Texts) -> Option<Cut> {
    let source = sources.file(file)?;
    let (line, span) = (diagnostic.line?, diagnostic.span.as_ref()?);
    let whole = source.line_span(line)?;
    // The file may have changed since the diagnostic was made.
    if !whole.contains(&span.start) && span.start != whole.end {
        return None;
    }
    let floor = |offset: usize| {
        (0..=offset).rev().find(|i| source.text().is_char_boundary(*i)).unwrap_or(0)
    };
    let start = floor(span.start);
    let end = floor(span.end.min(whole.end).min(start + CUT_BYTES)).max(start);
    let from = floor(whole.start.max(start.saturating_sub(CUT_BYTES)));
    let to = floor(whole.end.min(end + CUT_BYTES));
    Some(Cut { line, text: source.text()[from..to].to_owned(), span: start - from..end - from })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn diagnostic(line: usize, span: std::ops::Range<usize>) -> Diagnostic {
        Diagnostic {
            kind: DiagnosticKind::Error,
            file: Some("rod.toml".into()),
            line: Some(line),
            span: Some(span),
            key: "media.pmma.index".into(),
            message: "0.149 is out of range, expected 1 to 4".into(),
            hint: Some("did you mean 1.49?".into()),
        }
    }

    fn rendered(text: &str, diagnostics: &[Diagnostic], colour: Colour) -> String {
        let mut sources = Texts::default();
        sources.add_text(Path::new("rod.toml"), text);
        render(diagnostics, &sources, colour)
    }

    #[test]
    fn the_offending_text_is_underlined_below_a_line_to_grep_for() {
        let text = "[media.pmma]\nindex = 0.149\n";
        let expected = "rod.toml:2: `media.pmma.index`: 0.149 is out of range, expected 1 to 4
  |
2 | index = 0.149
  |         ^^^^^
  |
  = help: did you mean 1.49?
";
        assert_eq!(rendered(text, &[diagnostic(2, 21..26)], Colour::Never), expected);
    }

    #[test]
    fn what_is_about_no_line_is_called_an_error() {
        let argument = Diagnostic { file: None, line: None, hint: None, ..diagnostic(1, 0..1) };
        let text = rendered("", &[argument], Colour::Never);
        assert_eq!(text, "error: `media.pmma.index`: 0.149 is out of range, expected 1 to 4\n");
    }

    #[test]
    fn diagnostics_come_in_the_order_of_the_lines() {
        let text = "a = 1\nb = 2\n";
        let both = rendered(text, &[diagnostic(2, 6..7), diagnostic(1, 0..1)], Colour::Never);
        assert!(both.find("rod.toml:1:") < both.find("rod.toml:2:"));
    }

    #[test]
    fn colour_codes_come_only_when_asked_for() {
        assert!(!rendered("a = 1\n", &[diagnostic(1, 0..1)], Colour::Never).contains('\u{1b}'));
        assert!(rendered("a = 1\n", &[diagnostic(1, 0..1)], Colour::Always).contains('\u{1b}'));
    }

    #[test]
    fn long_lines_odd_places_and_escape_codes_do_no_harm() {
        let long = format!("a = \"{}\u{1b}[31mµ{}\"", "µ".repeat(5000), "x".repeat(5000));
        for start in [0, 5, 6, 7, 10_000, long.len() - 1, long.len(), long.len() + 5] {
            for length in [0, 1, 300, 30_000] {
                let text = rendered(&long, &[diagnostic(1, start..start + length)], Colour::Never);
                assert!(text.len() < 2500 && !text.contains('\u{1b}'), "{start} {length}");
            }
        }
        assert!(rendered("a", &[diagnostic(7, 0..1)], Colour::Never).starts_with("rod.toml:7: "));
    }
}
