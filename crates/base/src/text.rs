//! User texts made harmless for display on terminals, in spreadsheets and on pages.

/// Whether a character is invisible and changes how others are shown: control characters of ASCII
/// and ISO 6429, and those that change the direction of writing (Unicode 16, chapter 23.2; "Trojan
/// Source", Boucher & Anderson 2023).
pub fn is_control(letter: char) -> bool {
    letter.is_control()
        || matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The same text with its control characters escaped, as `\u{1b}`; line breaks and tabs stay.
pub fn visible(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for letter in text.chars() {
        if is_control(letter) && !matches!(letter, '\n' | '\t') {
            shown.extend(letter.escape_unicode());
        } else {
            shown.push(letter);
        }
    }
    shown
}

/// A table cell that no spreadsheet reads as a formula: a text that begins like one gets an
/// apostrophe (OWASP, CSV Injection). Numbers stay as they are.
pub fn spreadsheet_cell(text: &str) -> String {
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r']);
    if is_formula && text.parse::<f64>().is_err() { format!("'{text}") } else { text.to_owned() }
}

/// A page of Markdown in which no text is read as HTML (`CommonMark` 0.31, section 6.6: how a tag
/// begins), with its control characters escaped.
pub fn markdown_page(page: &str) -> String {
    let page = visible(page);
    let mut safe = String::with_capacity(page.len());
    let mut letters = page.chars().peekable();
    while let Some(letter) = letters.next() {
        let next = letters.peek();
        let is_tag = next.is_some_and(|next| next.is_ascii_alphabetic() || "/!?".contains(*next));
        if letter == '<' && is_tag { safe.push_str("&lt;") } else { safe.push(letter) }
    }
    safe
}

/// A table cell in Markdown, with bars and line breaks escaped so that they do not end it.
pub fn markdown_cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_written_out() {
        assert_eq!(
            visible("a\u{1b}[31m\n\tb\u{202e}c\u{7f}"),
            "a\\u{1b}[31m\n\tb\\u{202e}c\\u{7f}"
        );
        assert_eq!(visible("Ø 5 mm, 45° – grün"), "Ø 5 mm, 45° – grün");
    }

    #[test]
    fn formulas_become_texts_and_numbers_stay() {
        for text in ["=1+1", "+cmd", "-x", "@a", "\tb", "\rc", "-1 mm"] {
            assert_eq!(spreadsheet_cell(text), format!("'{text}"));
        }
        for text in ["-1.5", "+2", "-inf", "-1e-7", "exit.flux", "", "a=b"] {
            assert_eq!(spreadsheet_cell(text), text);
        }
    }

    #[test]
    fn tags_become_text_and_comparisons_stay() {
        assert_eq!(
            markdown_page("<script>a</script> <!-- x --> 1 < 2 <= 3 \u{1b}[31m"),
            "&lt;script>a&lt;/script> &lt;!-- x --> 1 < 2 <= 3 \\u{1b}[31m"
        );
        assert_eq!(markdown_cell("a|b\nc"), "a\\|b c");
    }
}
