//! The shape of an XML text, before it is read as a tree.
//!
//! The reader of XML compares every attribute with those before it, and every namespace with all of its ancestors, so that a text of
//! a megabyte could keep it busy for a minute. Files of scatter have a few of each, which this linear look ensures.

use crate::scatter::error::Violation;

/// Most attributes of an element.
const ATTRIBUTES: usize = 64;
/// Most declarations of namespaces.
const NAMESPACES: usize = 64;
/// Most elements within each other.
const DEPTH: usize = 64;

/// Refuses a text with more of anything than a file of scatter has. What is no XML is left to the reader.
pub(super) fn check(text: &str) -> Result<(), Violation> {
    let mut rest = text;
    let (mut namespaces, mut depth) = (0, 0usize);
    while let Some(at) = rest.find('<') {
        rest = &rest[at..];
        let line = || 1 + text[..text.len() - rest.len()].matches('\n').count();
        let refuse = |what: &str, most: usize| {
            let problem = format!("it has more than {most} {what}; files of scatter have few");
            Err(Violation::new(line(), problem))
        };
        let markup = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>"), ("<!", ">")];
        let other = markup.into_iter().find(|(start, _)| rest.starts_with(start));
        if let Some((start, end)) = other {
            let Some(end_at) = rest[start.len()..].find(end) else { return Ok(()) };
            rest = &rest[start.len() + end_at + end.len()..];
            continue;
        }
        let Some(tag) = tag(rest) else { return Ok(()) };
        if tag.attributes > ATTRIBUTES {
            return refuse("attributes in an element", ATTRIBUTES);
        }
        namespaces += tag.namespaces;
        if namespaces > NAMESPACES {
            return refuse("declarations of namespaces", NAMESPACES);
        }
        let inner = &rest[1..tag.length];
        if inner.starts_with('/') {
            depth = depth.saturating_sub(1);
        } else if !inner.ends_with("/>") {
            depth += 1;
        }
        if depth > DEPTH {
            return refuse("elements within each other", DEPTH);
        }
        rest = &rest[tag.length..];
    }
    Ok(())
}

/// A tag from its `<` to its `>`.
struct Tag {
    /// With both brackets, if it has no attribute too many, bytes.
    length: usize,
    attributes: usize,
    namespaces: usize,
}

/// The tag that a text begins with, up to one attribute too many; `None` if it does not end.
fn tag(text: &str) -> Option<Tag> {
    let (mut attributes, mut namespaces, mut quote) = (0, 0, None);
    for (at, letter) in text.char_indices() {
        match (quote, letter) {
            (Some(own), _) if letter == own => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(letter),
            (None, '=') => {
                attributes += 1;
                let name = text[..at].trim_end().rsplit(char::is_whitespace).next();
                namespaces += usize::from(name.is_some_and(|name| name.starts_with("xmlns")));
                if attributes > ATTRIBUTES {
                    return Some(Tag { length: at + 1, attributes, namespaces });
                }
            }
            (None, '>') => return Some(Tag { length: at + 1, attributes, namespaces }),
            (None, _) => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str, line: usize, words: &str) {
        let found = check(text).unwrap_err();
        assert!(found.line == line && found.problem.contains(words), "{found:?}");
    }

    #[test]
    fn a_text_that_would_keep_the_reader_busy_is_refused() {
        let attributes: String = (0..65).map(|n| format!(" a{n}='1'")).collect();
        refused(&format!("<a>\n<b{attributes}/></a>"), 2, "64 attributes");
        let nested: String = (0..65).map(|n| format!("<a xmlns:n{n} = \"u\">\n")).collect();
        refused(&nested, 65, "64 declarations of namespaces");
        refused(&"<a>\n".repeat(65), 65, "64 elements within each other");
        // A megabyte of attributes in a tag, which ends or not.
        for text in
            [format!("<a {}>", "=".repeat(1 << 20)), format!("\n<a{}", " b=".repeat(1 << 20))]
        {
            refused(&text, 1 + usize::from(text.starts_with('\n')), "64 attributes");
        }
    }

    #[test]
    fn what_only_looks_like_much_is_not() {
        let quoted = format!("<a b=\"{}\"/>", "c='1' > ".repeat(100));
        let comment = format!("<!-- {} -->", "<a>".repeat(100));
        let data = format!("<![CDATA[{}]]>", "<a b='1'>".repeat(100));
        let flat = "<a><b/><b c='1'></b></a>".repeat(100);
        for text in [&quoted, &comment, &data, &flat, "<a", "<!-- <a", "<?xml", "no"] {
            check(text).unwrap();
        }
    }
}
