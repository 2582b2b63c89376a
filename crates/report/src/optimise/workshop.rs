//! Drawings of the unrolled face with its holes or dots, for cutting: DXF and SVG. Reliefs have none.

use crate::OutputFile;
use crate::optimise::{ElementShape, OptimisationReport};
use lumiduct_files::cutting::{CutDrawing, CutOutline, dxf, svg};

/// The drawings.
pub(super) fn files(report: &OptimisationReport) -> Vec<OutputFile> {
    let outline = |own: &crate::optimise::FoundElement| {
        let middle = [own.across_mm, own.along_mm];
        match report.shape {
            ElementShape::Circle => Some(CutOutline::Circle { middle, diameter: own.length_mm }),
            ElementShape::Rectangle => {
                Some(CutOutline::Rectangle { middle, size: [own.width_mm, own.length_mm] })
            }
            ElementShape::Relief => None,
        }
    };
    let outlines: Option<Vec<CutOutline>> = report.elements.iter().map(outline).collect();
    let Some(outlines) = outlines.filter(|all| !all.is_empty()) else { return Vec::new() };
    let drawing = CutDrawing { size: report.face_mm, layer: report.pattern.clone(), outlines };
    vec![
        OutputFile::text("pattern.dxf", dxf(&drawing)),
        OutputFile::text("pattern.svg", svg(&drawing)),
    ]
}
