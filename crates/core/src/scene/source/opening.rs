//! The luminous opening of a luminaire: both sides of a plane, the faces of a box, or an upright cylinder.
//!
//! The intensities I(d) of a luminaire do not say where on its opening they leave. Luminance is taken as the same on all of the
//! opening that is seen from a direction d: L(d) = I(d) / A(d), with the projected area A(d) = Σ `A_f` max(0, `n_f` · d). So a face
//! emits its share `A_f` max(0, `n_f` · d) / A(d) of the intensity; the shares add up to 1 in every direction, and no flux is lost.
//! The opening is convex: light that leaves it does not meet it again. It knows no law of emission.

use crate::rng::{Dimension, Numbers, Sampler};
use crate::scene::shape::{Cylinder, Flat, Region, Shape};
use glam::{DVec2, DVec3};
use lumiduct_base::math::Frame;
use std::f64::consts::{FRAC_PI_2, PI};

/// An opening that emits to several sides.
#[derive(Debug, Clone)]
pub struct LuminousOpening {
    frame: Frame,
    /// Flat faces, and the wall of a cylinder about z, each with the area up to and including it, mm².
    shapes: Vec<(Shape, f64)>,
}

impl LuminousOpening {
    /// Both sides of a region that is symmetric about x, in the xy plane of a frame.
    pub fn two_sided(frame: Frame, region: Region) -> Self {
        let back = Frame { y: -frame.y, z: -frame.z, ..frame };
        let sides = [frame, back].map(|side| Shape::Flat(Flat::new(side, region.clone())));
        Self::of(frame, sides.into())
    }

    /// The faces of a box about the origin of a frame, with these sizes along its axes, mm; of a size of 0, both sides of a
    /// rectangle.
    pub fn cuboid(frame: Frame, sizes: DVec3) -> Self {
        let [half_x, half_y, half_z] = (0.5 * sizes).to_array();
        let Frame { origin, x, y, z } = frame;
        let axes = [(x, y, z, [half_x, half_y, half_z]), (y, z, x, [half_y, half_z, half_x])];
        let axes = axes.into_iter().chain([(z, x, y, [half_z, half_x, half_y])]);
        let faces = axes.flat_map(|(x, y, z, [half_x, half_y, half_z])| {
            [1.0, -1.0].map(|side| {
                let origin = origin + side * half_z * z;
                let frame = Frame { origin, x, y: side * y, z: side * z };
                Shape::Flat(Flat::new(frame, Region::Rectangle { half_x, half_y }))
            })
        });
        Self::of(frame, faces.filter(|face| face.area() > 0.0).collect())
    }

    /// Both ends and the wall of a cylinder about z of a frame, its middle at the origin, mm; of a height of 0, both sides of a
    /// disk.
    pub fn cylinder(frame: Frame, radius: f64, height: f64) -> Self {
        let region = Region::Annulus { inner: 0.0, outer: radius };
        let [top, bottom] = [0.5, -0.5].map(|share| frame.shifted(share * height * frame.z));
        let back = Frame { y: -bottom.y, z: -bottom.z, ..bottom };
        let ends = [top, back].map(|side| Shape::Flat(Flat::new(side, region.clone())));
        let wall = (height > 0.0).then(|| Shape::Cylinder(Cylinder::new(bottom, radius, height)));
        Self::of(frame, ends.into_iter().chain(wall).collect())
    }

    fn of(frame: Frame, shapes: Vec<Shape>) -> Self {
        let mut area = 0.0;
        let with_areas = shapes.into_iter().map(|shape| {
            area += shape.area();
            (shape, area)
        });
        Self { frame, shapes: with_areas.collect() }
    }

    /// The frame that directions refer to; z is the nadir of the luminaire.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Its faces, with the area up to and including each, mm².
    pub fn shapes(&self) -> &[(Shape, f64)] {
        &self.shapes
    }

    /// Area of all faces, mm².
    pub fn area(&self) -> f64 {
        self.shapes.last().map_or(0.0, |(_, area)| *area)
    }

    /// Projected area seen from a direction, mm².
    pub(crate) fn projected_area(&self, dir: DVec3) -> f64 {
        self.shapes.iter().map(|(shape, _)| projected(shape, dir)).sum()
    }

    /// A start of light in a direction, uniform over what is seen from there: the face and the point.
    pub(crate) fn start(&self, dir: DVec3, sampler: &mut Sampler<impl Numbers>) -> (usize, DVec3) {
        let mut left = sampler.one(Dimension::EmitPosition) * self.projected_area(dir);
        let mut chosen = 0;
        for (index, (shape, _)) in self.shapes.iter().enumerate() {
            let own = projected(shape, dir);
            if own > 0.0 {
                chosen = index;
                if left < own {
                    break;
                }
                left -= own;
            }
        }
        let u = sampler.pair(Dimension::EmitPosition);
        let shape = &self.shapes[chosen].0;
        let point = match shape.as_cylinder() {
            Some(wall) => seen_point(wall, dir, u),
            None => shape.sample(u),
        };
        (chosen, point)
    }

    /// ∫ A(d) dω over the directions up to an angle to z, rad; mm² sr.
    pub(crate) fn projected_extent(&self, widest: f64) -> f64 {
        let per_area = |shape: &Shape| {
            let flat = shape.as_flat();
            match flat.map_or(0.0, |flat| flat.frame().z.dot(self.frame.z)) {
                down if down > 0.5 => PI * widest.min(FRAC_PI_2).sin().powi(2),
                up if up < -0.5 => PI * widest.max(FRAC_PI_2).cos().powi(2),
                // A side, or the wall of a cylinder.
                _ => widest - widest.sin() * widest.cos(),
            }
        };
        self.shapes.iter().map(|(shape, _)| shape.area() * per_area(shape)).sum()
    }
}

/// Projected area of a face seen from a direction, mm²; 0 from behind.
fn projected(shape: &Shape, dir: DVec3) -> f64 {
    match (shape.as_cylinder(), shape.as_flat()) {
        // Diameter times length times the sine of the angle to the axis.
        (Some(wall), _) => shape.area() / PI * dir.cross(wall.frame().z).length(),
        (None, Some(flat)) => shape.area() * flat.frame().z.dot(dir).max(0.0),
        (None, None) => 0.0,
    }
}

/// A point of the wall of a cylinder, uniform over what is seen of it from a direction.
fn seen_point(wall: &Cylinder, dir: DVec3, [across, along]: [f64; 2]) -> DVec3 {
    let frame = wall.frame();
    let toward = frame.to_local(dir).truncate().normalize_or(DVec2::X);
    // Its distance from the line of sight through the axis is uniform.
    let across = 2.0 * across - 1.0;
    let normal = (1.0 - across * across).sqrt() * toward + across * toward.perp();
    let [low, high] = wall.heights();
    frame.point_to_world((wall.radius() * normal).extend(low + along * (high - low)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Emission, Emitter, Source, StartSolids};
    use crate::tally::Tally;
    use lumiduct_base::math::uniform_sphere;
    use std::f64::consts::TAU;

    fn frame() -> Frame {
        let axis = DVec3::new(0.3, -0.2, -0.9).normalize();
        Frame::from_axis(DVec3::new(5.0, 1.0, -2.0), axis)
    }

    fn openings() -> [LuminousOpening; 4] {
        let ellipse = Region::Ellipse { half_x: 3.0, half_y: 1.0 };
        [
            LuminousOpening::two_sided(frame(), ellipse),
            LuminousOpening::cuboid(frame(), DVec3::new(2.0, 3.0, 4.0)),
            LuminousOpening::cuboid(frame(), DVec3::new(2.0, 0.0, 4.0)),
            LuminousOpening::cylinder(frame(), 1.5, 2.0),
        ]
    }

    #[test]
    fn projected_areas_are_those_of_geometry() {
        let dir = frame().to_world(DVec3::new(1.0, -2.0, 2.0) / 3.0);
        let expected = [
            PI * 3.0 * 2.0 / 3.0,
            (3.0 * 4.0 + 2.0 * 4.0 * 2.0 + 2.0 * 3.0 * 2.0) / 3.0,
            2.0 * 4.0 * 2.0 / 3.0,
            PI * 2.25 * 2.0 / 3.0 + 3.0 * 2.0 * 5f64.sqrt() / 3.0,
        ];
        for (opening, expected) in openings().iter().zip(expected) {
            for dir in [dir, -dir] {
                let found = opening.projected_area(dir);
                assert!((found / expected - 1.0).abs() < 1e-12, "{opening:?}: {found} {expected}");
            }
        }
        assert_eq!(openings().map(|opening| opening.shapes().len()), [2, 6, 2, 3]);
    }

    #[test]
    fn starts_are_uniform_over_what_is_seen() {
        for opening in openings() {
            let dir = frame().to_world(DVec3::new(-0.6, 0.48, -0.64));
            // Places across the line of sight, from the middle, and squares of places along both axes of each flat face.
            let across = Frame::from_axis(opening.frame().origin, dir);
            let whole = opening.projected_area(dir);
            let mut counts = vec![0.0; opening.shapes().len()];
            let mut places = [Tally::default(), Tally::default()];
            let mut squares = vec![[Tally::default(); 2]; opening.shapes().len()];
            let starts = 20_000;
            for index in 0..starts {
                let (face, point) = opening.start(dir, &mut Sampler::for_path(3, 0, index));
                let normal = opening.shapes()[face].0.normal(point);
                assert!(normal.dot(dir) > -1e-12, "{opening:?} starts on its far side");
                counts[face] += 1.0 / starts as f64;
                if let Some(flat) = opening.shapes()[face].0.as_flat() {
                    let own = flat.frame().point_to_local(point);
                    [own.x, own.y]
                        .iter()
                        .zip(&mut squares[face])
                        .for_each(|(x, sum)| sum.add(x * x));
                }
                let seen = across.point_to_local(point);
                [seen.x, seen.y].into_iter().zip(&mut places).for_each(|(x, tally)| tally.add(x));
            }
            for ((shape, _), found) in opening.shapes().iter().zip(counts) {
                let share = projected(shape, dir) / whole;
                let error = (share * (1.0 - share) / starts as f64).sqrt();
                assert!(
                    (found - share).abs() <= 4.0 * error + 1e-9,
                    "{opening:?}: {found} {share}"
                );
            }
            for ((shape, _), squares) in opening.shapes().iter().zip(squares) {
                let Some(flat) = shape.as_flat() else { continue };
                let expected = match *flat.region() {
                    Region::Rectangle { half_x, half_y } => [half_x, half_y].map(|a| a * a / 3.0),
                    Region::Ellipse { half_x, half_y } => [half_x, half_y].map(|a| a * a / 4.0),
                    Region::Annulus { outer, .. } => [0.25 * outer * outer; 2],
                    _ => unreachable!("openings have no other faces"),
                };
                for (square, expected) in squares.iter().zip(expected) {
                    let is_seen = projected(shape, dir) > 0.0;
                    assert!(
                        !is_seen || square.sigmas_from(expected).abs() < 4.5,
                        "{shape:?}: {square:?}"
                    );
                }
            }
            // The outline is symmetric about the middle.
            for place in places {
                assert!(place.sigmas_from(0.0).abs() < 4.0, "{opening:?}: {place:?}");
            }
        }
    }

    #[test]
    fn the_wall_of_a_cylinder_is_seen_evenly_from_side_to_side() {
        let opening = LuminousOpening::cylinder(Frame::WORLD, 2.0, 5.0);
        let square =
            Tally::of((0..20_000).map(|index| {
                opening.start(DVec3::X, &mut Sampler::for_path(4, 0, index)).1.y.powi(2)
            }));
        // The mean square of a uniform number from -2 to 2.
        assert!(square.sigmas_from(4.0 / 3.0).abs() < 4.0, "{square:?}");
    }

    #[test]
    fn extents_are_integrals_of_the_projected_area() {
        let steps = 400;
        for opening in openings() {
            for widest in [0.7, 2.0, PI] {
                let part = |n: usize| (n as f64 + 0.5) / steps as f64;
                let ring = |n: usize| {
                    let (gamma, c) = (widest * part(n / steps), TAU * part(n % steps));
                    let (sin, cos) = gamma.sin_cos();
                    let dir = DVec3::new(sin * c.cos(), sin * c.sin(), cos);
                    opening.projected_area(frame().to_world(dir)) * sin
                };
                let sum: f64 = (0..steps * steps).map(ring).sum();
                let expected = sum * widest * TAU / (steps * steps) as f64;
                let found = opening.projected_extent(widest);
                assert!((found / expected - 1.0).abs() < 1e-4, "{opening:?}: {found} {expected}");
            }
            let all = opening.projected_extent(PI);
            assert!((all / opening.area() - PI).abs() < 1e-12, "{opening:?}: {all}");
        }
    }

    #[test]
    fn luminance_times_projected_area_is_the_intensity() {
        for opening in openings() {
            let source = Source {
                name: "lamp".into(),
                flux: 7.0,
                emitter: Emitter::Opening(opening.clone()),
                emission: Emission::CosinePower(2.0),
                start: StartSolids::Outside,
                on: Vec::new(),
                spectrum: None,
                elevation: None,
                sun: None,
            };
            for index in 0..50 {
                let local = uniform_sphere(Sampler::for_path(5, 0, index).pair(Dimension::Scatter));
                let dir = opening.frame().to_world(local);
                let of_face = |(shape, _): &(Shape, f64)| {
                    // The point that faces the direction; of a flat face, any one.
                    let point = shape
                        .as_cylinder()
                        .map_or(shape.sample([0.5; 2]), |wall| seen_point(wall, dir, [0.5; 2]));
                    source.radiance(shape, point, dir) * projected(shape, dir)
                };
                let found: f64 = opening.shapes().iter().map(of_face).sum();
                let expected = 7.0 * 3.0 * local.z.max(0.0).powi(2) / TAU;
                assert!((found - expected).abs() < 1e-12, "{opening:?}: {found} {expected}");
            }
        }
    }
}
