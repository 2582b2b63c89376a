//! SVG in millimetres, for laser cutters and for a look.

use crate::cutting::{CutDrawing, CutOutline, length};
use std::fmt::Write;

/// A drawing as SVG; y goes up, as in the drawing.
pub fn svg(drawing: &CutDrawing) -> String {
    let [width, height] = drawing.size.map(length);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" viewBox=\"0 0 {width} {height}\">\n\
         <g fill=\"none\" stroke=\"#000000\" stroke-width=\"0.1\">\n\
         <rect x=\"0\" y=\"0\" width=\"{width}\" height=\"{height}\" stroke=\"#808080\"/>\n"
    );
    let flip = |[x, y]: [f64; 2]| [x, drawing.size[1] - y].map(length);
    for outline in &drawing.outlines {
        match outline {
            CutOutline::Circle { middle, diameter } => {
                let ([x, y], r) = (flip(*middle), length(0.5 * diameter));
                _ = writeln!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"/>");
            }
            CutOutline::Rectangle { middle, size } => {
                let [w, h] = size.map(length);
                let [x, y] = flip([middle[0] - 0.5 * size[0], middle[1] + 0.5 * size[1]]);
                _ = writeln!(out, "<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"/>");
            }
        }
    }
    out + "</g>\n</svg>\n"
}
