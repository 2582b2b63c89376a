//! The walls that a circle sweeps: cylinders, cones and tori.

use crate::scene::shape::{Cone, Cylinder, Flat, HalfSpace, Region, Shape, Torus};
use crate::scene::sweep::chart::WallChart;
use crate::scene::sweep::path::{
    PieceForm, PrismEnd, Section, SweptPath, bend_frame, direction, mitre_frame,
};
use crate::scene::sweep::smooth::SmoothNumbers;
use crate::scene::sweep::{CornerKind, Wall, WallPart};
use glam::{DVec2, DVec3};

/// The walls along `path` of the circle of `radius` at the entry, mm.
pub(super) fn parts(radius: f64, path: &SweptPath) -> Vec<WallPart> {
    let mut smooth = SmoothNumbers::new(1);
    let mut parts = Vec::new();
    for piece in &path.pieces {
        smooth.enter(piece, |_, _| true);
        let start = &piece.start;
        let here = radius * start.scale;
        let (shape, mean) = match &piece.form {
            PieceForm::Prism { floor, ceiling } => (prism(start, here, floor, ceiling), here),
            PieceForm::Taper { length, end_scale } => {
                let end = radius * end_scale;
                (Shape::Cone(Cone::new(start.frame, here, end, *length)), 0.5 * (here + end))
            }
            PieceForm::Bend { angle, radius: major, toward } => {
                (bend(start, here, *angle, *major, *toward), here)
            }
            PieceForm::Corner { kind: CornerKind::Plain, .. } => continue,
            PieceForm::Corner { angle, toward, kind: CornerKind::Mitred } => {
                let half_x = here / (0.5 * angle).sin();
                let region = Region::Ellipse { half_x, half_y: here };
                let frame = mitre_frame(&start.frame, *angle, *toward);
                let shape = Shape::Flat(Flat::new(frame, region));
                parts.push(WallPart::mitre(shape, smooth.fresh()));
                continue;
            }
        };
        let chart = WallChart::Along {
            offset: DVec2::new(0.0, start.along),
            scale: DVec2::new(radius / mean, 1.0),
        };
        parts.push(WallPart { shape, wall: Wall::Round, smooth: smooth.id(0), chart });
    }
    parts
}

fn prism(start: &Section, radius: f64, floor: &PrismEnd, ceiling: &PrismEnd) -> Shape {
    let frame = start.frame;
    if let (Some(bottom), Some(top)) = (floor.as_flat(), ceiling.as_flat()) {
        let frame = frame.shifted(bottom * frame.z);
        return Shape::Cylinder(Cylinder::new(frame, radius, top - bottom));
    }
    // `up` = 1 keeps the part below the planes of an end, -1 the part above.
    let planes = |end: &PrismEnd, up: f64| {
        let through = frame.origin + end.height * frame.z;
        let across = direction(&frame, end.toward);
        let normal = move |slope: f64| up * (frame.z - slope * across);
        end.slopes
            .iter()
            .filter(|slope| **slope != 0.0)
            .map(|slope| HalfSpace::behind(through, normal(*slope)))
            .collect::<Vec<_>>()
    };
    let steepest =
        |end: &PrismEnd| end.slopes.iter().fold(0.0, |max: f64, slope| max.max(slope.abs()));
    let cuts = [planes(floor, -1.0), planes(ceiling, 1.0)].concat();
    let (z_min, z_max) =
        (floor.height - steepest(floor) * radius, ceiling.height + steepest(ceiling) * radius);
    Shape::Cylinder(Cylinder::cut(frame, radius, z_min, z_max, cuts))
}

fn bend(start: &Section, minor: f64, angle: f64, major: f64, toward: DVec2) -> Shape {
    let frame = bend_frame(&start.frame, major, toward);
    let x: DVec3 = start.frame.x;
    // The azimuth 0 of the section, counted about the path from the outermost point.
    let section_zero = (-x.dot(frame.z)).atan2(x.dot(frame.x));
    Shape::Torus(Torus::new(frame, major, minor, angle).with_section_zero(section_zero))
}
