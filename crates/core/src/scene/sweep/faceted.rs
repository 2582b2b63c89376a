//! The walls that a polygon sweeps, edge by edge: planes along straight legs; about a bend axis, which lies in the plane
//! of the polygon, cylinders, cones and plane sectors.

use crate::scene::shape::{ChartRect, Cone, Cylinder, Flat, Region, Shape};
use crate::scene::sweep::chart::{Sector, Sense, Trapezoid, WallChart};
use crate::scene::sweep::path::{
    PieceForm, PrismEnd, Section, SweptPath, bend_frame, direction, mitre_frame, unit,
};
use crate::scene::sweep::smooth::SmoothNumbers;
use crate::scene::sweep::{CornerKind, Wall, WallPart};
use glam::DVec2;
use lumiduct_base::math::{Frame, planar};

/// Below this share of the size, a difference is rounding: an edge is parallel, a wall has no height.
const ROUNDING: f64 = 1e-12;

/// An edge of the profile at the entry.
struct ProfileEdge {
    from: DVec2,
    to: DVec2,
    /// Length of the outline before it, mm.
    around: f64,
    length: f64,
}

impl ProfileEdge {
    /// Unit vector from its start to its end.
    fn along(&self) -> DVec2 {
        (self.to - self.from) / self.length
    }

    fn middle(&self) -> DVec2 {
        0.5 * (self.from + self.to)
    }

    /// The rectangle of the wall above it in the chart of the sweep.
    fn chart(&self, from: f64, to: f64) -> ChartRect {
        ChartRect {
            min: DVec2::new(self.around, from),
            max: DVec2::new(self.around + self.length, to),
        }
    }
}

/// An arc of the path.
struct Arc {
    angle: f64,
    radius: f64,
    toward: DVec2,
}

/// The walls along `path` of the polygon with the counter-clockwise `points` at the entry, mm.
pub(super) fn parts(points: &[DVec2], path: &SweptPath) -> Vec<WallPart> {
    let edges = edges(points);
    let mut smooth = SmoothNumbers::new(edges.len());
    let mut parts = Vec::new();
    for piece in &path.pieces {
        // The outward normal of a wall in the section is its edge turned by -90°.
        smooth.enter(piece, |wall, toward| edges[wall].along().perp_dot(toward).abs() > ROUNDING);
        let start = &piece.start;
        if let PieceForm::Corner { angle, toward, kind } = &piece.form {
            if *kind == CornerKind::Mitred {
                let id = smooth.fresh();
                let plates = mitre(points, start, *angle, *toward);
                parts.extend(plates.into_iter().map(|shape| WallPart::mitre(shape, id)));
            }
            continue;
        }
        for (i, edge) in edges.iter().enumerate() {
            let wall = match &piece.form {
                PieceForm::Prism { floor, ceiling } => prism(edge, start, floor, ceiling),
                PieceForm::Taper { length, end_scale } => {
                    Some(taper(edge, start, *length, *end_scale))
                }
                PieceForm::Bend { angle, radius, toward } => {
                    let arc = Arc { angle: *angle, radius: *radius, toward: *toward };
                    Some(bend(edge, start, &arc))
                }
                PieceForm::Corner { .. } => None,
            };
            let part = |(shape, chart)| WallPart {
                shape,
                wall: Wall::Edge(i),
                smooth: smooth.id(i),
                chart,
            };
            parts.extend(wall.map(part));
        }
    }
    parts
}

fn edges(points: &[DVec2]) -> Vec<ProfileEdge> {
    let mut around = 0.0;
    planar::edges(points)
        .map(|(from, to)| {
            let length = (to - from).length();
            around += length;
            ProfileEdge { from, to, around: around - length, length }
        })
        .collect()
}

/// The wall over an edge between two ends; `None` where the ends meet all along it.
fn prism(
    edge: &ProfileEdge,
    start: &Section,
    floor: &PrismEnd,
    ceiling: &PrismEnd,
) -> Option<(Shape, WallChart)> {
    let Section { frame, scale, along } = *start;
    let (across, half) = (direction(&frame, edge.along()), 0.5 * scale * edge.length);
    let middle = frame.origin + scale * direction(&frame, edge.middle());
    let wall = Frame { origin: middle, x: across, y: frame.z, z: across.cross(frame.z) };
    let chart = |v: f64| WallChart::Along {
        offset: DVec2::new(edge.around + 0.5 * edge.length, v),
        scale: DVec2::new(1.0 / scale, 1.0),
    };
    if let (Some(bottom), Some(top)) = (floor.as_flat(), ceiling.as_flat()) {
        let height = 0.5 * (bottom + top);
        let region = Region::Rectangle { half_x: half, half_y: 0.5 * (top - bottom) };
        let flat = Flat::new(wall.shifted(height * frame.z), region);
        return Some((Shape::Flat(flat), chart(along + height)));
    }
    // Counter-clockwise: the floor from the edge's start to its end, the ceiling back.
    let corner = |share: f64, height: &dyn Fn(DVec2) -> f64| {
        let q = scale * edge.from.lerp(edge.to, share);
        DVec2::new((2.0 * share - 1.0) * half, height(q))
    };
    let mut corners: Vec<DVec2> =
        kinks(edge, floor).into_iter().map(|share| corner(share, &|q| floor.highest(q))).collect();
    corners.extend(
        kinks(edge, ceiling).into_iter().rev().map(|share| corner(share, &|q| ceiling.lowest(q))),
    );
    let size = half + ceiling.height.abs() + floor.height.abs();
    let mut outline: Vec<DVec2> = Vec::with_capacity(corners.len());
    for at in corners {
        if outline.iter().all(|known| known.distance(at) > ROUNDING * size) {
            outline.push(at);
        }
    }
    let is_wall = outline.len() >= 3 && planar::signed_area(&outline) > ROUNDING * size * half;
    is_wall.then(|| (Shape::Flat(Flat::new(wall, Region::polygon(outline))), chart(along)))
}

/// The places on an edge, as shares of its length, where an end has its corners: the ends of the edge, and where the
/// planes of a mitre cross.
fn kinks(edge: &ProfileEdge, end: &PrismEnd) -> Vec<f64> {
    let [from, to] = [edge.from, edge.to].map(|p| p.dot(end.toward));
    let crosses = end.slopes.len() > 1 && from * to < 0.0;
    let kink = crosses.then(|| from / (from - to));
    [Some(0.0), kink, Some(1.0)].into_iter().flatten().collect()
}

fn taper(edge: &ProfileEdge, start: &Section, length: f64, end_scale: f64) -> (Shape, WallChart) {
    let Section { frame, scale, along } = *start;
    let across = direction(&frame, edge.along());
    let growth = end_scale - scale;
    // From the middle of the edge at the start to its middle at the end: sideways, and up the slant.
    let sideways = growth * edge.middle().dot(edge.along());
    let rise = growth * (edge.middle() - edge.middle().dot(edge.along()) * edge.along());
    let slant = direction(&frame, rise) + length * frame.z;
    let height = slant.length();
    let up = slant / height;
    let origin = frame.origin + scale * direction(&frame, edge.middle());
    let wall = Frame { origin, x: across, y: up, z: across.cross(up) };
    let (half_bottom, half_top) = (0.5 * scale * edge.length, 0.5 * end_scale * edge.length);
    let bottom = [-half_bottom, half_bottom];
    let top = [sideways - half_top, sideways + half_top];
    let corners = [(bottom[0], 0.0), (bottom[1], 0.0), (top[1], height), (top[0], height)];
    let region = Region::polygon(corners.map(DVec2::from).to_vec());
    let chart = WallChart::Trapezoid {
        target: edge.chart(along, along + length),
        trapezoid: Trapezoid { bottom, top, height },
    };
    (Shape::Flat(Flat::new(wall, region)), chart)
}

fn bend(edge: &ProfileEdge, start: &Section, arc: &Arc) -> (Shape, WallChart) {
    let Section { frame, scale, along } = *start;
    let Arc { angle, radius, toward } = *arc;
    let about = bend_frame(&frame, radius, toward);
    // Distances from the bend axis and heights along it.
    let [from, to] = [edge.from, edge.to]
        .map(|p| DVec2::new(radius - scale * p.dot(toward), scale * toward.perp_dot(p)));
    let tolerance = ROUNDING * (radius + scale * edge.length);
    if (to.y - from.y).abs() <= tolerance {
        return flat_bend(edge, along, arc, &about, [from, to]);
    }
    let base = about.shifted(from.y.min(to.y) * about.z);
    let height = (to.y - from.y).abs();
    let (shape, mean) = if (to.x - from.x).abs() <= tolerance {
        let mean = 0.5 * (from.x + to.x);
        let wall = Cylinder::sector(base, mean, 0.0, height, angle);
        (Shape::Cylinder(if to.y > from.y { wall.inward() } else { wall }), mean)
    } else {
        let (low, high) = if to.y > from.y { (from.x, to.x) } else { (to.x, from.x) };
        let wall = Cone::sector(base, low, high, height, angle);
        let wall = if to.y > from.y { wall.inward() } else { wall };
        (Shape::Cone(wall), 0.5 * (low + high))
    };
    // An edge that goes up the axis has the guide outside of its radius: its front is toward the axis.
    let growth = edge.length / (to.y - from.y);
    let chart = WallChart::Across {
        offset: DVec2::new(edge.around + growth * (from.y.min(to.y) - from.y), along),
        scale: DVec2::new(growth, radius / mean),
    };
    (shape, chart)
}

/// The wall on an edge at right angles to the bend axis; `ends` are the edge's distances from it and heights along it.
fn flat_bend(
    edge: &ProfileEdge,
    along: f64,
    arc: &Arc,
    about: &Frame,
    ends: [DVec2; 2],
) -> (Shape, WallChart) {
    let [from, to] = ends;
    let level = about.shifted(0.5 * (from.y + to.y) * about.z);
    let (frame, sense) = if to.x > from.x {
        (level, Sense::Forward)
    } else {
        // The front looks down the axis: measured from the end of the arc, it is counter-clockwise
        // again.
        let last = direction(about, unit(arc.angle));
        (Frame { x: last, y: last.cross(about.z), z: -about.z, ..level }, Sense::Backward)
    };
    let region = Region::sector(from.x.min(to.x), from.x.max(to.x), arc.angle);
    let chart = WallChart::Sector {
        target: edge.chart(along, along + arc.radius * arc.angle),
        sector: Sector { radii: [from.x, to.x], angle: arc.angle, sense },
    };
    (Shape::Flat(Flat::new(frame, region)), chart)
}

/// The plate across a mitred corner: the profile's outer half as the incoming leg meets the plate, and its mirror image
/// from the outgoing one.
fn mitre(points: &[DVec2], at: &Section, angle: f64, toward: DVec2) -> Vec<Shape> {
    let stretch = 1.0 / (0.5 * angle).sin();
    let section: Vec<DVec2> =
        points.iter().map(|p| at.scale * DVec2::new(p.dot(toward), toward.perp_dot(*p))).collect();
    let size = stretch * section.iter().map(|q| q.length()).fold(0.0, f64::max);
    let outer_half = |polygon: &[DVec2]| -> Vec<DVec2> {
        let on_line = |x: f64| if x > -ROUNDING * size { 0.0 } else { x };
        let half = planar::clip(polygon, DVec2::X, 0.0);
        half.into_iter().map(|q| DVec2::new(on_line(stretch * q.x), q.y)).collect()
    };
    let plates: Vec<Vec<DVec2>> = if planar::is_convex(&section) {
        with_mirror_image(outer_half(&section))
    } else {
        let triangles = planar::triangulate(&section);
        triangles.iter().flat_map(|triangle| with_mirror_image(outer_half(triangle))).collect()
    };
    let frame = mitre_frame(&at.frame, angle, toward);
    plates
        .into_iter()
        .filter(|plate| planar::signed_area(plate) > ROUNDING * size * size)
        .map(|plate| Shape::Flat(Flat::new(frame, Region::polygon(plate))))
        .collect()
}

/// A convex polygon of x <= 0 and its mirror image in x, as one polygon when they have an edge in common.
fn with_mirror_image(half: Vec<DVec2>) -> Vec<Vec<DVec2>> {
    let mirrored = |chain: &[DVec2]| -> Vec<DVec2> {
        chain.iter().rev().map(|q| DVec2::new(-q.x, q.y)).collect()
    };
    let n = half.len();
    // Where the outline leaves the mirror line, it runs round the outside to where it comes back.
    let Some(leaves) = (0..n).find(|&i| half[i].x == 0.0 && half[(i + 1) % n].x < 0.0) else {
        let image = mirrored(&half);
        return vec![half, image];
    };
    let mut outline = half;
    outline.rotate_left(leaves);
    let back = (1..n).find(|&i| outline[i].x == 0.0);
    outline.truncate(back.map_or(n, |i| i + 1));
    // A corner that only touches the line is its own image.
    let image = mirrored(&outline[1..back.unwrap_or(n)]);
    outline.extend(image);
    vec![outline]
}
