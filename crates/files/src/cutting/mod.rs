//! Drawings for cutting and drilling: outlines in a plane, in millimetres, as DXF and as SVG.
//!
//! ```
//! use lumiduct_files::cutting::{CutDrawing, CutOutline, dxf, svg};
//!
//! let hole = CutOutline::Circle { middle: [10.0, 5.0], diameter: 2.0 }; // mm
//! let drawing = CutDrawing { size: [20.0, 10.0], layer: "holes".into(), outlines: vec![hole] };
//! assert!(dxf(&drawing).contains("CIRCLE"));
//! assert!(svg(&drawing).contains("<circle cx=\"10\" cy=\"5\" r=\"1\"/>"));
//! ```

mod dxf;
mod svg;

pub use dxf::dxf;
pub use svg::svg;

/// Outlines on a rectangular sheet whose lower left corner is the origin.
#[derive(Debug, Clone, PartialEq)]
pub struct CutDrawing {
    /// Width and height of the sheet, mm.
    pub size: [f64; 2],
    /// Name of the layer of the outlines.
    pub layer: String,
    /// What is cut.
    pub outlines: Vec<CutOutline>,
}

/// The outline of a hole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CutOutline {
    /// A circle.
    Circle {
        /// Its middle, mm.
        middle: [f64; 2],
        /// Its diameter, mm.
        diameter: f64,
    },
    /// A rectangle with sides along the axes.
    Rectangle {
        /// Its middle, mm.
        middle: [f64; 2],
        /// Its width and height, mm.
        size: [f64; 2],
    },
}

/// The corners of a rectangle, counter-clockwise, mm.
fn corners(middle: [f64; 2], size: [f64; 2]) -> [[f64; 2]; 4] {
    let [x, y] = [0.5 * size[0], 0.5 * size[1]];
    [[-x, -y], [x, -y], [x, y], [-x, y]].map(|[u, v]| [middle[0] + u, middle[1] + v])
}

/// A length with a resolution of a hundredth of a micrometre, mm.
fn length(value: f64) -> String {
    let text = format!("{:.5}", value + 0.0);
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing() -> CutDrawing {
        CutDrawing {
            size: [40.0, 20.0],
            layer: "holes & <slots>".into(),
            outlines: vec![
                CutOutline::Circle { middle: [10.0, 12.5], diameter: 3.25 },
                CutOutline::Rectangle { middle: [30.0, 10.0], size: [2.0, 4.0] },
            ],
        }
    }

    /// Pairs of a group code and a value.
    fn pairs(text: &str) -> Vec<(i32, &str)> {
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len() % 2, 0);
        lines.chunks(2).map(|pair| (pair[0].trim().parse().unwrap(), pair[1])).collect()
    }

    #[test]
    fn a_dxf_has_every_outline_with_its_place_and_size() {
        let text = dxf(&drawing());
        let pairs = pairs(&text);
        let at = |code: i32, value: &str| pairs.iter().position(|own| *own == (code, value));
        let circle = at(0, "CIRCLE").unwrap();
        let own = &pairs[circle + 1..circle + 6];
        assert_eq!(own, [(8, "HOLES_SLOTS"), (10, "10"), (20, "12.5"), (30, "0"), (40, "1.625")]);
        let vertices: Vec<(&str, &str)> = pairs
            .windows(4)
            .filter(|own| own[0] == (0, "VERTEX") && own[1] == (8, "HOLES_SLOTS"))
            .map(|own| (own[2].1, own[3].1))
            .collect();
        assert_eq!(vertices, [("29", "8"), ("31", "8"), ("31", "12"), ("29", "12")]);
        assert_eq!(pairs.last(), Some(&(0, "EOF")));
        assert!(at(1, "AC1009").is_some() && at(9, "$INSUNITS").is_some());
    }

    #[test]
    fn an_svg_is_a_document_in_millimetres_with_every_outline() {
        let text = svg(&drawing());
        let document = roxmltree::Document::parse(&text).unwrap();
        let root = document.root_element();
        assert_eq!(root.attribute("width"), Some("40mm"));
        let of = |name: &str| document.descendants().filter(|node| node.has_tag_name(name)).count();
        assert_eq!((of("circle"), of("rect")), (1, 2));
        // The y axis of SVG goes down.
        let circle = document.descendants().find(|node| node.has_tag_name("circle")).unwrap();
        assert_eq!(circle.attribute("cy"), Some("7.5"));
    }

    #[test]
    fn lengths_are_short() {
        assert_eq!(
            [0.0, -0.000_000_1, 1.5, 10.0, 2.123_456].map(length),
            ["0", "0", "1.5", "10", "2.12346"]
        );
    }
}
