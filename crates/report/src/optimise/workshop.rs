//! Drawings of the unrolled face with its holes or dots, for cutting: DXF and SVG. Reliefs have none.

use crate::OutputFile;
use crate::optimise::{ElementShape, FoundElement, OptimisationReport};
use lumiduct_files::cutting::{CutDrawing, CutOutline, dxf, svg};

/// The drawings.
pub(super) fn files(report: &OptimisationReport) -> Vec<OutputFile> {
    let of = |own: &FoundElement| outlines(report, own);
    let outlines: Option<Vec<[Option<CutOutline>; 2]>> = report.elements.iter().map(of).collect();
    let Some(outlines) = outlines.filter(|all| !all.is_empty()) else { return Vec::new() };
    let outlines = outlines.into_iter().flatten().flatten().collect();
    let drawing = CutDrawing { size: report.face_mm, layer: report.pattern.clone(), outlines };
    vec![
        OutputFile::text("pattern.dxf", dxf(&drawing)),
        OutputFile::text("pattern.svg", svg(&drawing)),
    ]
}

/// The outline of an element, and across the seam of a round face once more at the other edge; `None` for a relief.
fn outlines(report: &OptimisationReport, own: &FoundElement) -> Option<[Option<CutOutline>; 2]> {
    let at = |across: f64| {
        let middle = [across, own.along_mm];
        match report.shape {
            ElementShape::Circle => Some(CutOutline::Circle { middle, diameter: own.length_mm }),
            ElementShape::Rectangle => {
                Some(CutOutline::Rectangle { middle, size: [own.width_mm, own.length_mm] })
            }
            ElementShape::Relief => None,
        }
    };
    let ([turn, _], across) = (report.face_mm, own.across_mm);
    let half = match report.shape {
        ElementShape::Circle => 0.5 * own.length_mm,
        ElementShape::Rectangle | ElementShape::Relief => 0.5 * own.width_mm,
    };
    let beyond = match report.is_round {
        true if across < half => at(across + turn),
        true if across > turn - half => at(across - turn),
        true | false => None,
    };
    Some([Some(at(across)?), beyond])
}
