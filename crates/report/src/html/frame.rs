//! The frame of a page: title, parts, tables, places for plots, and everything that draws them in the same file.
//!
//! It knows no report: it turns titles, tables and plots as plain data into one self-contained
//! file. The page loads nothing; only without scripts it shows the picture files next to it.

use crate::page::{PagePart, Plots, Standing};
use crate::png::{ColourMap, curve_colours};
use lumiduct_base::error::{Error, Result};
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment, Value, context};
use serde::Serialize;

/// The style of every page.
const STYLE: &str = include_str!("assets/page.css");
/// The frame, a template.
const TEMPLATE: &str = include_str!("assets/page.html");
/// The scripts in their order; together they are one module.
const SCRIPTS: [&str; 12] = [
    include_str!("assets/format.js"),
    include_str!("assets/axis.js"),
    include_str!("assets/figure.js"),
    include_str!("assets/chart.js"),
    include_str!("assets/map.js"),
    include_str!("assets/polar.js"),
    include_str!("assets/flow.js"),
    include_str!("assets/view.js"),
    include_str!("assets/scene.js"),
    include_str!("assets/local_axes.js"),
    include_str!("assets/turn.js"),
    include_str!("assets/page.js"),
];

/// A page.
#[derive(Debug, Serialize)]
pub(crate) struct Page {
    /// Its title.
    pub(crate) title: String,
    /// Client and author.
    pub(crate) masthead: Option<Masthead>,
    /// Its description, if any.
    pub(crate) description: Option<String>,
    /// The verdict, in words.
    pub(crate) verdict: String,
    /// The verdict as a status.
    pub(crate) standing: Standing,
    /// Its contents, in order.
    pub(crate) parts: Vec<PagePart>,
    /// Its origin, in small print at the end.
    pub(crate) footer: String,
}

/// Client and author of a page.
#[derive(Debug, Serialize)]
pub(crate) struct Masthead {
    /// Lines with their names: `Client`, `Date`.
    pub(crate) lines: Vec<[String; 2]>,
    /// Data URI of a picture embedded in the page.
    pub(crate) logo: Option<String>,
}

/// The page as one file.
pub(crate) fn render(page: &Page, plots: &Plots) -> Result<String> {
    let failed = |reason: String| Error::Output { what: "report.html".into(), reason };
    let [sequential, diverging] =
        [ColourMap::Sequential, ColourMap::Diverging].map(ColourMap::stops);
    let palettes = serde_json::json!({ "sequential": sequential, "diverging": diverging });
    let data = serde_json::json!({ "palettes": palettes, "plots": plots.data() });
    let data = serde_json::to_string(&data).map_err(|reason| failed(reason.to_string()))?;
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    // Template tags leave no empty lines.
    let syntax = SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build();
    environment.set_syntax(syntax.map_err(|reason| failed(reason.to_string()))?);
    environment
        .render_str(
            TEMPLATE,
            context! {
                page => Serde(page),
                style => Value::from_safe_string(STYLE.to_owned()),
                scripts => Value::from_safe_string(SCRIPTS.concat()),
                // No text within the data can close the element that contains them.
                data => Value::from_safe_string(data.replace('<', "\\u003c")),
                series => Serde(curve_colours()),
            },
        )
        .map_err(|reason| failed(reason.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::{Block, table};

    fn page(text: &str) -> String {
        let mut plots = Plots::default();
        let plot = plots.add(text, serde_json::json!({"plot": "chart", "title": text}), None);
        let list = Block::List { items: vec![text.to_owned()] };
        let cells = table(&["head"], vec![vec![text.to_owned()]]);
        let part = PagePart { title: text.to_owned(), blocks: vec![list, cells, plot] };
        let page = Page {
            title: text.to_owned(),
            masthead: Some(Masthead { lines: vec![[text, text].map(str::to_owned)], logo: None }),
            description: Some(text.to_owned()),
            verdict: text.to_owned(),
            standing: Standing::Open,
            parts: vec![part],
            footer: text.to_owned(),
        };
        render(&page, &plots).unwrap()
    }

    #[test]
    fn no_text_becomes_a_part_of_the_page() {
        let html = page("</script><b>\"&'{{ 1 }}");
        assert!(!html.contains("<b>"));
        assert!(html.contains("&lt;b&gt;&quot;&amp;&#x27;{{ 1 }}"));
        // The scripts and the data end once each.
        assert_eq!(html.matches("</script").count(), 2);
        assert!(html.contains("\\u003c/script>"));
    }

    #[test]
    fn nothing_is_loaded_from_anywhere() {
        let html = page("words");
        // The only XML namespace, which is not an address to load.
        let html = html.replace("http://www.w3.org/2000/svg", "");
        for address in ["http:", "https:", "//", "src=", "href=\"", "@import", "url("] {
            let found: Vec<&str> = html
                .match_indices(address)
                .map(|(at, _)| &html[at..html.floor_char_boundary(at + 60)])
                .filter(|text| !text.starts_with("href=\"#") && !text.starts_with("// "))
                .collect();
            assert!(found.is_empty(), "{address}: {found:?}");
        }
    }

    #[test]
    fn no_script_ends_its_element() {
        assert!(SCRIPTS.iter().all(|script| !script.contains("</")));
        assert!(!STYLE.contains("</"));
    }
}
