//! The text of an XML document, element by element.

use std::fmt::Write;

/// A document of elements that have either elements or a text.
#[derive(Debug)]
pub(crate) struct XmlText {
    text: String,
    depth: usize,
}

impl XmlText {
    /// A document with its declaration only.
    pub(crate) fn new() -> Self {
        Self { text: "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\r\n".to_owned(), depth: 0 }
    }

    /// An element with elements.
    pub(crate) fn parent(&mut self, name: &str, children: impl FnOnce(&mut Self)) {
        let indent = "  ".repeat(self.depth);
        _ = write!(self.text, "{indent}<{name}>\r\n");
        self.depth += 1;
        children(self);
        self.depth -= 1;
        _ = write!(self.text, "{indent}</{name}>\r\n");
    }

    /// An element with a text.
    pub(crate) fn leaf(&mut self, name: &str, text: &str) {
        self.leaf_at(name, &[], text);
    }

    /// An element with attributes and a text.
    pub(crate) fn leaf_at(&mut self, name: &str, attributes: &[(&str, &str)], text: &str) {
        _ = write!(self.text, "{}<{name}", "  ".repeat(self.depth));
        for (attribute, value) in attributes {
            _ = write!(self.text, " {attribute}=\"{}\"", escaped(value));
        }
        _ = write!(self.text, ">{}</{name}>\r\n", escaped(text));
    }

    /// The document.
    pub(crate) fn finish(self) -> String {
        self.text
    }
}

/// A text for an element or an attribute in quotes (XML 1.0, 2.4). Characters that no document may have (2.2) become blanks.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\u{fffe}' | '\u{ffff}' => out.push(' '),
            _ if letter.is_control() => out.push(' '),
            _ => out.push(letter),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_comes_back_from_a_reader() {
        let odd = "a & b < c > d \"e\" 'f' ]]> Söhne & Töchter &amp; 10° ½ 灯";
        let mut out = XmlText::new();
        out.parent("Root", |out| {
            out.leaf_at("Leaf", &[("name", odd)], odd);
            out.leaf("Leaf", "a\u{1}b\u{ffff}c\nd");
        });
        let text = out.finish();
        assert!(text.contains("a &amp; b &lt; c &gt; d &quot;e&quot;"), "{text}");
        let document = roxmltree::Document::parse(&text).unwrap();
        let leaves: Vec<_> =
            document.root_element().children().filter(roxmltree::Node::is_element).collect();
        assert_eq!((leaves[0].attribute("name"), leaves[0].text()), (Some(odd), Some(odd)));
        assert_eq!(leaves[1].text(), Some("a b c d"));
    }
}
