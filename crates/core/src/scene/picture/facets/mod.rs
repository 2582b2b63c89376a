//! Surfaces as triangles, for pictures alone: light never meets them.
//!
//! Every shape maps the unit square onto its surface, so one grid of points works for all of them;
//! only flat outlines with corners and meshes are treated separately. The deviation of chords from
//! the surface sets the spacing of a grid.

mod flat;
mod mesh;
mod outline;
mod triangles;

pub use triangles::Triangulation;

use crate::scene::shape::Shape;
use crate::scene::{FaceId, Patch, PieceRange, Scene};
use glam::DVec3;

/// Allowed deviation of chords from a surface, as a share of the deviation of the coarsest grid, 1.
const RELATIVE: f64 = 0.006;
/// Largest number of steps of a grid along one side.
const MOST_STEPS: usize = 32;
/// Largest number of squares of a grid.
const MOST_SQUARES: usize = 512;
/// Positions along a chord where its distance from the surface is computed, 1: no two are mirror
/// images.
const LOOKED_AT: [f64; 3] = [0.3, 0.5, 0.65];
/// Points of a patch closer to each other than this share of its size are the same, 1.
const SAME: f64 = 1e-6;

/// The fineness of facets.
#[derive(Debug, Clone, Copy)]
pub struct Fineness {
    /// Invisible distance of a chord from the surface, mm.
    pub deviation: f64,
    /// Edge of the cubes in which corners of fine meshes are merged, mm.
    pub mesh_cell: f64,
    /// Largest number of patches of one face: beyond it, only every second, third and so on is
    /// drawn.
    pub patches: usize,
}

/// A face as triangles.
#[derive(Debug, Clone)]
pub struct FaceFacets {
    /// The triangles.
    pub facets: Triangulation,
    /// One in this many of the pieces of the face is included: 1 where it is whole.
    pub one_in: usize,
}

impl Scene {
    /// A face as triangles.
    pub fn face_facets(&self, face: FaceId, fineness: &Fineness) -> FaceFacets {
        match &self.faces[face.index()].extent {
            PieceRange::Patches(_) | PieceRange::Ports(_) => {
                patch_facets(self.face_patches(face), fineness)
            }
            PieceRange::Mesh(_) => {
                let bodies: Vec<_> = self.mesh_pieces(face).collect();
                let one_in = bodies.len().div_ceil(fineness.patches).max(1);
                let drawn = bodies.into_iter().step_by(one_in).collect();
                FaceFacets { facets: mesh::facets(drawn, fineness.mesh_cell), one_in }
            }
        }
    }
}

fn patch_facets(patches: &[Patch], fineness: &Fineness) -> FaceFacets {
    let one_in = patches.len().div_ceil(fineness.patches).max(1);
    let mut facets = Triangulation::default();
    for patch in patches.iter().step_by(one_in) {
        let mut piece = shape_facets(&patch.shape, fineness.deviation);
        // Walls are drawn whole, with their elements in front; the surfaces that cut elements off
        // are not drawn.
        if let Some(trim) = patch.trim.as_ref().filter(|trim| trim.is_of_element()) {
            piece.keep(trim);
        }
        facets.append(piece);
    }
    FaceFacets { facets, one_in }
}

/// A shape as triangles whose chords deviate from it by `deviation` mm, or by a small share of its
/// own size.
pub fn shape_facets(shape: &Shape, deviation: f64) -> Triangulation {
    if let Shape::Flat(flat) = shape
        && let Some(facets) = flat::facets(flat)
    {
        return facets;
    }
    let [mut columns, mut rows] = [0, 1].map(|axis| steps(shape, axis, deviation));
    while columns * rows > MOST_SQUARES {
        if columns > rows { columns /= 2 } else { rows /= 2 }
    }
    grid(shape, [columns, rows])
}

/// A point of a grid line: `along` in the direction of `axis`, at `across` of the other.
fn on_line(shape: &Shape, axis: usize, along: f64, across: f64) -> DVec3 {
    shape.sample(if axis == 0 { [along, across] } else { [across, along] })
}

fn steps(shape: &Shape, axis: usize, deviation: f64) -> usize {
    let coarsest = bulge(shape, axis, 1).max(bulge(shape, axis, 2));
    let enough = deviation.max(RELATIVE * coarsest);
    let mut steps = 1;
    while steps < MOST_STEPS && bulge(shape, axis, steps) > enough {
        steps *= 2;
    }
    steps
}

/// Deviation of chords over `steps` equal parts of the grid lines along `axis` from the surface,
/// mm.
fn bulge(shape: &Shape, axis: usize, steps: usize) -> f64 {
    let mut most = 0.0_f64;
    for across in [0.0, 0.5, 1.0] {
        let at = |along: f64| on_line(shape, axis, along, across);
        for step in 0..steps {
            let share = |part: f64| (step as f64 + part) / steps as f64;
            let (from, to) = (at(share(0.0)), at(share(1.0)));
            for part in LOOKED_AT {
                most = most.max(distance_from_chord(at(share(part)), from, to));
            }
        }
    }
    most
}

fn distance_from_chord(p: DVec3, from: DVec3, to: DVec3) -> f64 {
    let chord = to - from;
    let length = chord.length_squared();
    let share = if length > 0.0 { ((p - from).dot(chord) / length).clamp(0.0, 1.0) } else { 0.0 };
    p.distance(from + share * chord)
}

fn grid(shape: &Shape, [columns, rows]: [usize; 2]) -> Triangulation {
    let share = |index: usize, steps: usize| index as f64 / steps as f64;
    let points: Vec<DVec3> = (0..=rows)
        .flat_map(|row| (0..=columns).map(move |column| (row, column)))
        .map(|(row, column)| shape.sample([share(column, columns), share(row, rows)]))
        .collect();
    let size = points.iter().map(|p| p.distance(points[0])).fold(0.0, f64::max);
    let same = |a: usize, b: usize| points[a].distance(points[b]) <= SAME * size;
    let at = |row: usize, column: usize| row * (columns + 1) + column;
    let mut triangles = Vec::new();
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let [a, b] = [at(row, column), at(row, column + 1)];
        let [d, c] = [at(row + 1, column), at(row + 1, column + 1)];
        // At the pole of a sphere or the middle of a disk one side of a square is a point.
        let is_whole = |[p, q, r]: &[usize; 3]| !same(*p, *q) && !same(*q, *r) && !same(*r, *p);
        triangles.extend([[a, b, c], [a, c, d]].into_iter().filter(is_whole));
    }
    let along_rows = [0, rows].map(|row| (0..=columns).map(|column| at(row, column)).collect());
    let along_columns = [0, columns].map(|column| (0..=rows).map(|row| at(row, column)).collect());
    let mut rims: Vec<Vec<usize>> = Vec::new();
    for [one, other] in [along_rows, along_columns] {
        let (one, other): (Vec<usize>, Vec<usize>) = (one, other);
        // A closed surface has no rim at its seam.
        if !one.iter().zip(&other).all(|(a, b)| same(*a, *b)) {
            rims.extend(
                [one, other].into_iter().filter(|rim| rim.iter().any(|i| !same(*i, rim[0]))),
            );
        }
    }
    Triangulation { points, triangles, rims }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::{Cylinder, Flat, Region, Sphere, Torus};
    use glam::DVec2;
    use lumiduct_base::math::Frame;

    fn area(facets: &Triangulation) -> f64 {
        let area = |corners: &[usize; 3]| {
            let [a, b, c] = corners.map(|i| facets.points[i]);
            0.5 * (b - a).cross(c - a).length()
        };
        facets.triangles.iter().map(area).sum()
    }

    fn shapes() -> Vec<Shape> {
        let flat = |region| Shape::Flat(Flat::new(Frame::WORLD, region));
        let notched = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 0.5), (0.0, 2.0)];
        let square = || Region::Rectangle { half_x: 2.0, half_y: 1.5 };
        vec![
            flat(Region::Annulus { inner: 0.0, outer: 2.0 }),
            flat(Region::Annulus { inner: 1.0, outer: 2.0 }),
            flat(Region::sector(0.5, 2.0, 4.0)),
            flat(Region::Ellipse { half_x: 2.4, half_y: 0.7 }),
            flat(square()),
            flat(Region::polygon(notched.map(DVec2::from).to_vec())),
            flat(Region::holed(square(), Region::Annulus { inner: 0.0, outer: 1.1 })),
            Shape::Cylinder(Cylinder::new(Frame::WORLD, 2.0, 10.0)),
            Shape::Sphere(Sphere::zone(Frame::WORLD, 3.0, -3.0, 1.0)),
            Shape::Torus(Torus::new(Frame::WORLD, 5.0, 1.0, 1.5)),
        ]
    }

    #[test]
    fn facets_have_the_area_of_their_surface_to_a_percent() {
        for shape in shapes() {
            let facets = shape_facets(&shape, 1e-4);
            let (found, wanted) = (area(&facets), shape.area());
            assert!((found / wanted - 1.0).abs() < 0.012, "{shape:?}: {found} of {wanted}");
        }
    }

    #[test]
    fn rims_are_where_a_surface_ends() {
        let rims: Vec<usize> =
            shapes().iter().map(|shape| shape_facets(shape, 1e-4).rims.len()).collect();
        // Disk, ring, sector, ellipse, rectangle, polygon, holed, cylinder, cap, bend.
        assert_eq!(rims, [1, 2, 4, 1, 4, 1, 2, 2, 1, 2]);
    }

    #[test]
    fn straight_lines_take_no_steps_and_coarse_pictures_fewer() {
        let tube = Shape::Cylinder(Cylinder::new(Frame::WORLD, 2.0, 10.0));
        assert_eq!([0, 1].map(|axis| steps(&tube, axis, 1e-4)), [32, 1]);
        assert!(steps(&tube, 0, 0.5) < 16);
    }
}
