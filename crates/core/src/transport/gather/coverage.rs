//! The part of a window on its surface: windows at rims are clipped by the true area.
//!
//! A window is a disk in the tangent plane of its middle. The part of it with the surface below or
//! above it, and its moments, are found on a sunflower of points (Vogel, Math. Biosci. 44 (1979) 179).

use crate::scene::shape::{ChartRect, Crossing, RayStart};
use crate::scene::{PrimId, Ray, Scene, Surface};
use crate::transport::gather::kernel::{CutDisk, Kernels};
use crate::transport::gather::surfaces::{Slot, SurfaceNumbers};
use crate::transport::window::Window;
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Frame, circle};

/// Points in a window.
const POINTS: usize = 96;
/// Points on its rim that show whether it is whole.
const RIM_POINTS: usize = 8;
/// Least agreement of the normals of one surface in one window, as a cosine, 1.
pub(crate) const AGREEING: f64 = 0.9;
/// Largest height of the surface of a window above or below its tangent plane, in radii, 1: the
/// limit for normals that agree this well.
pub(crate) const HEIGHT: f64 = 0.5;
/// Turns from point to point of a sunflower, 2 less the golden ratio.
pub(crate) const GOLDEN_TURN: f64 = 0.381_966_011_250_105_1;

/// A surface of up to this many pieces is tested piece by piece, one of more through the boxes of
/// the whole scene.
const FEW_PIECES: usize = 4;

/// The middle of a window.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Middle {
    pub(crate) prim: PrimId,
    pub(crate) surface: Slot,
    pub(crate) point: DVec3,
    /// Unit normal of the surface there, on the side that photons come from.
    pub(crate) normal: DVec3,
    /// Unit direction of the photons, if one is wanted: places where it would come from below the
    /// surface are no part of the window.
    pub(crate) along: Option<DVec3>,
}

/// What a window covers of its surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Coverage {
    /// The share of the disk over the surface, 1.
    pub(crate) share: f64,
    /// Kernels of (distance/r)² over this part.
    pub(crate) kernels: Kernels,
    /// Slope of their linear term, 1/mm.
    pub(crate) slope: DVec3,
}

impl Coverage {
    const WHOLE: Self = Self { share: 1.0, kernels: Kernels::EVEN, slope: DVec3::ZERO };
}

/// The part of a window that lies on the surface. `turn`, in turns, rotates the points.
pub(crate) fn coverage(
    scene: &Scene,
    surfaces: &SurfaceNumbers,
    middle: &Middle,
    window: Window,
    turn: f64,
) -> Coverage {
    let frame = Frame::from_axis(middle.point, middle.normal);
    let covers = |across: DVec2| {
        let offset = frame.to_world((window.radius * across).extend(0.0));
        is_over_surface(scene, surfaces, middle, offset, window.radius)
    };
    let mut rim = (0..RIM_POINTS).map(|place| place as f64 / RIM_POINTS as f64);
    if lies_within(scene, middle, window) && rim.all(|turns| covers(circle(turns))) {
        return Coverage::WHOLE;
    }
    let mut cut = CutDisk::EMPTY;
    for place in 0..POINTS {
        let turns = (place as f64 * GOLDEN_TURN + turn).fract();
        let across = ((place as f64 + 0.5) / POINTS as f64).sqrt() * circle(turns);
        if covers(across) {
            cut.add(across);
        }
    }
    if cut.places() == POINTS as f64 {
        return Coverage::WHOLE;
    }
    let (kernels, slope) = cut.kernels();
    let slope = frame.to_world((slope / window.radius).extend(0.0));
    // The middle itself is on the surface, however thin the surface is there.
    Coverage { share: cut.places().max(1.0) / POINTS as f64, kernels, slope }
}

/// Whether a square around the window is wholly on an analytic piece that unrolls without stretching.
fn lies_within(scene: &Scene, middle: &Middle, window: Window) -> bool {
    /// Rounding of an area, relative.
    const ROUNDING: f64 = 1e-9;
    match scene.surface(middle.prim) {
        Surface::Patch(patch) => {
            let uv = patch.chart(middle.point);
            let reach = DVec2::splat(window.radius);
            let square = ChartRect { min: uv - reach, max: uv + reach };
            (patch.area_in(square) / square.area() - 1.0).abs() < ROUNDING
        }
        Surface::Triangle(..) => false,
    }
}

fn is_over_surface(
    scene: &Scene,
    surfaces: &SurfaceNumbers,
    middle: &Middle,
    offset: DVec3,
    reach: f64,
) -> bool {
    let reach = HEIGHT * reach;
    let ray = Ray::new(middle.point + offset + reach * middle.normal, -middle.normal);
    let lies = |prim: PrimId, crossing: Crossing| {
        if crossing.t <= 0.0 || crossing.t >= 2.0 * reach {
            return false;
        }
        let normal = scene.normal(prim, ray.at(crossing.t));
        let agreement = normal.dot(middle.normal);
        let comes_from_above = |along: DVec3| normal.dot(along) * agreement < 0.0;
        agreement.abs() > AGREEING && middle.along.is_none_or(comes_from_above)
    };
    let mut found = false;
    let pieces = surfaces.patches(middle.surface);
    if (1..=FEW_PIECES).contains(&pieces.len()) {
        for &prim in pieces {
            let patch = &scene.patches[prim.index()];
            patch.crossings(&ray, RayStart::Elsewhere, |crossing| found |= lies(prim, crossing));
        }
    } else {
        scene.all_crossings(&ray, |prim, crossing| {
            found |= surfaces.of(prim) == middle.surface && lies(prim, crossing);
        });
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Medium;
    use crate::scene::shape::{Flat, Region, Shape};
    use crate::scene::{Builder, FacePiece, FaceSpec, Owner};
    use lumiduct_base::units::FluxUnit;

    /// A square of 20 mm.
    fn square() -> Scene {
        let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
        let region = Region::Rectangle { half_x: 10.0, half_y: 10.0 };
        builder.add_face(FaceSpec {
            name: "square.surface".into(),
            owner: Owner::Sheet,
            front: None,
            back: None,
            pieces: vec![FacePiece::whole(Shape::Flat(Flat::new(Frame::WORLD, region)))],
        });
        builder.build()
    }

    /// Mean share over turns of a window at a distance inside the edges at +x and +y, mm.
    fn mean_share(inside: DVec2, radius: f64) -> f64 {
        const TURNS: u32 = 200;
        let (scene, prim) = (square(), PrimId::new(0));
        let surfaces = SurfaceNumbers::new(&scene);
        let point = (DVec2::splat(10.0) - inside).extend(0.0);
        let middle =
            Middle { prim, surface: surfaces.of(prim), point, normal: DVec3::NEG_Z, along: None };
        let window = Window { radius, theta_max: 0.1 };
        let shares = (0..TURNS).map(|turn| {
            let turn = f64::from(turn) / f64::from(TURNS);
            coverage(&scene, &surfaces, &middle, window, turn).share / f64::from(TURNS)
        });
        shares.sum()
    }

    #[test]
    fn a_window_over_a_straight_edge_is_clipped_by_the_segment_of_its_circle() {
        // Reference case ES-02: 1 less the circular segment beyond the edge, at a distance of s radii.
        let reference = [
            (0.0, 0.5),
            (0.25, 0.6574811788),
            (0.5, 0.8044988905),
            (0.75, 0.9278531936),
            (1.0, 1.0),
        ];
        for (s, expected) in reference {
            let share = mean_share(DVec2::new(s, 10.0), 1.0);
            assert!((share / expected - 1.0).abs() < 0.01, "{s}: {share}, not {expected}");
        }
    }

    #[test]
    fn a_window_in_a_corner_keeps_a_quarter() {
        let share = mean_share(DVec2::splat(1e-9), 1.0);
        assert!((share - 0.25).abs() < 0.01, "{share}");
        let share = mean_share(DVec2::splat(3.0), 1.0);
        assert!((share - 1.0).abs() < 1e-12, "{share}");
    }
}
