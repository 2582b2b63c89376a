//! Volume of a ball within its medium: windows of records within media are clipped by the true
//! volume.
//!
//! From the middle, the medium is probed in some directions: `ΔV = ∫ min(r, d(ω))³/3 dω`, with d(ω)
//! the extent of the medium, and likewise the moments of (distance/r)². If a medium bends back into
//! the ball, only the nearer part counts; the rest is an error that shrinks with the window.

use crate::scene::{Inside, MediumId, MeetingPoint, Ray, Scene, StartSurfaces, Visibility};
use crate::transport::Path;
use crate::transport::gather::coverage::GOLDEN_TURN;
use crate::transport::gather::kernel::{Kernels, MOMENTS};
use crate::transport::window::Window;
use glam::DVec3;
use lumiduct_base::math::{Frame, from_cosine};
use std::f64::consts::PI;

/// Directions in which the medium is probed, on a spiral over the sphere.
const DIRECTIONS: usize = 48;

/// A ball, limited to its medium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ClippedBall {
    /// Its volume, mm³.
    pub(crate) volume: f64,
    /// Kernels of (distance/r)² over it.
    pub(crate) kernels: Kernels,
}

/// The ball of a window about the position of a path, limited to its medium; `turn` and `tilt`, uniform in [0, 1),
/// rotate the directions.
pub(crate) fn clipped_ball(
    scene: &Scene,
    path: &Path,
    point: DVec3,
    window: Window,
    [turn, tilt]: [f64; 2],
) -> ClippedBall {
    let frame = Frame::from_axis(DVec3::ZERO, from_cosine(1.0 - 2.0 * tilt, turn));
    let mut moments = [0.0; MOMENTS];
    for place in 0..DIRECTIONS {
        let cos = 1.0 - (2 * place + 1) as f64 / DIRECTIONS as f64;
        let turns = (place as f64 * GOLDEN_TURN + turn).fract();
        let dir = frame.to_world(from_cosine(cos, turns));
        let reach = clear_way(scene, path, &Ray::new(point, dir), window.radius) / window.radius;
        for (power, moment) in moments.iter_mut().enumerate() {
            // ∫ u^(2k) u² du up to the reach.
            *moment += reach.powi(2 * power as i32 + 3) / (2 * power + 3) as f64;
        }
    }
    let volume = 4.0 * PI * window.radius.powi(3) * moments[0] / DIRECTIONS as f64;
    ClippedBall { volume, kernels: Kernels::of_moments(moments) }
}

/// Distance that a ray stays in the medium of a path, mm, up to a limit.
fn clear_way(scene: &Scene, path: &Path, ray: &Ray, most: f64) -> f64 {
    let (mut ray, mut way) = (*ray, 0.0);
    let (mut on, mut inside): (StartSurfaces, Inside) =
        (StartSurfaces::default(), path.inside.clone());
    let medium: MediumId = path.medium;
    while way < most {
        let Some(hits) = scene.find_next(&ray, &on, &inside) else { return most };
        way += hits.distance();
        let point = ray.at(hits.distance());
        let meeting = MeetingPoint { point, dir: ray.dir() };
        match scene.interface(&hits, &meeting, &inside, medium).visibility {
            Visibility::Visible => return way.min(most),
            // A joint, or a body of the same medium: the records of a medium do not distinguish
            // bodies.
            Visibility::Invisible => {
                hits.cross(&mut inside);
                on = StartSurfaces::hits(&hits);
                ray = Ray::new(point, ray.dir());
            }
        }
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Medium;
    use crate::optics::REFERENCE_WAVELENGTH;
    use crate::scene::shape::{Shape, Sphere};
    use crate::scene::{Builder, FacePiece, FaceSpec, Owner, Solid};
    use lumiduct_base::math::Aabb;
    use lumiduct_base::units::FluxUnit;

    const RADIUS: f64 = 5.0;

    /// A ball of glass about the origin.
    fn glass_ball() -> Scene {
        let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
        let medium = builder.add_medium(Medium::new("glass", 1.5, 0.0));
        let solid = builder.add_solid(Solid {
            name: "ball".into(),
            medium,
            priority: 0,
            bounds: Aabb::EMPTY,
            volume: None,
        });
        builder.add_face(FaceSpec {
            name: "ball.surface".into(),
            owner: Owner::Solid(solid),
            front: None,
            back: None,
            pieces: vec![FacePiece::whole(Shape::Sphere(Sphere::zone(
                Frame::WORLD,
                RADIUS,
                -RADIUS,
                RADIUS,
            )))],
        });
        builder.build()
    }

    /// Mean volume about a point on the x axis, over many turns.
    fn mean_volume(x: f64, radius: f64) -> f64 {
        const TURNS: u32 = 400;
        let scene = glass_ball();
        let point = DVec3::new(x, 0.0, 0.0);
        let inside: Inside = std::iter::once(crate::scene::SolidId::new(0)).collect();
        let path = Path {
            ray: Ray::new(point, DVec3::Z),
            throughput: 1.0,
            wavelength: REFERENCE_WAVELENGTH,
            band: 0,
            stokes: None,
            source: None,
            medium: scene.medium_in(&inside),
            inside,
            on: StartSurfaces::default(),
            depth: 0,
        };
        let window = Window { radius, theta_max: 0.1 };
        let volumes = (0..TURNS).map(|turn| {
            let share = f64::from(turn) / f64::from(TURNS);
            let turns = [share, (share * 7.0 + 0.3).fract()];
            clipped_ball(&scene, &path, point, window, turns).volume / f64::from(TURNS)
        });
        volumes.sum()
    }

    #[test]
    fn a_ball_deep_in_its_medium_is_whole() {
        let volume = mean_volume(1.0, 2.0);
        assert!((volume / (4.0 / 3.0 * PI * 8.0) - 1.0).abs() < 1e-9, "{volume}");
    }

    #[test]
    fn a_ball_over_the_edge_of_its_medium_keeps_what_two_balls_share() {
        // Two balls of radii R and r at a distance d share π (R + r - d)² (d² + 2 d (R + r) - 3 (R - r)²)/(12 d).
        for (d, r) in [(4.0, 1.5), (4.9, 1.0), (3.5, 3.0)] {
            let shared = PI
                * (RADIUS + r - d).powi(2)
                * (d * d + 2.0 * d * (RADIUS + r) - 3.0 * (RADIUS - r).powi(2))
                / (12.0 * d);
            let volume = mean_volume(d, r);
            assert!((volume / shared - 1.0).abs() < 0.01, "{d}, {r}: {volume}, not {shared}");
        }
    }
}
