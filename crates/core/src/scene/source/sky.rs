//! Light of the sky as a law of emission: its directions, in the frame of the emitter.
//!
//! It knows the luminance of the sky relative to the zenith and how to sample it, but not where
//! light starts or how much there is.

use crate::optics::{SkyBound, SkyModel};
use crate::rng::{Dimension, Numbers, Sampler};
use glam::DVec3;
use lumiduct_base::math::{Frame, cosine_hemisphere, from_cosine, uniform_sphere};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The kind of emitter, which sets the measure in which a law is uniform.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EmitterKind {
    /// A point: laws are intensities.
    Point,
    /// A surface: laws are radiances, and flux is proportional to the cosine to the normal.
    Surface,
    /// A volume: laws are intensities.
    Volume,
    /// The far distance: laws are radiances, and a disk across each direction receives the flux.
    Far,
}

/// Steps of the quadrature from zenith to horizon, with two points of Gauss each, and around. The
/// edges of the field of a tilted plane leave an error of 1e-5; skies on a level plane are accurate
/// to 1e-9.
const STEPS: [u32; 2] = [256, 512];
/// A surface that receives less than this share of a level one's flux sees no sky worth tracing.
const LEAST_SHARE: f64 = 1e-3;

/// A sky, seen from an emitter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sky {
    model: SkyModel,
    /// East, north and up in the frame of the emitter.
    frame: Frame,
    amounts: Amounts,
}

/// Integrals of a sky of unit zenith luminance, sr.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Amounts {
    /// ∫ L dω: for a disk turned across every direction.
    across: f64,
    /// ∫ L cos θ dω over the half space in front of the emitter's plane.
    on_plane: f64,
    /// ∫ L cos Z dω: on a level plane.
    level: f64,
}

impl Sky {
    /// A sky whose east, north and up are x, y and z of a frame, given in the frame of the emitter.
    pub fn new(model: SkyModel, frame: Frame) -> Self {
        Self { model, frame, amounts: amounts(&model, &frame) }
    }

    /// Illuminance of a level plane over the luminance of the zenith, sr.
    pub fn level_illuminance(&self) -> f64 {
        self.amounts.level
    }

    /// Flux over zenith luminance and area, sr: of the plane of a surface, or of a disk across each direction.
    pub fn projected_solid_angle(&self, kind: EmitterKind) -> f64 {
        match kind {
            EmitterKind::Surface => self.amounts.on_plane,
            EmitterKind::Far | EmitterKind::Point | EmitterKind::Volume => self.amounts.across,
        }
    }

    /// Whether a surface receives enough of the sky to be traced.
    pub fn is_seen_by_surface(&self) -> bool {
        self.amounts.on_plane > LEAST_SHARE * self.amounts.level
    }

    /// Density in 1/sr with which [`Sky::sample`] draws the direction of travel `dir`.
    pub(crate) fn density(&self, kind: EmitterKind, dir: DVec3) -> f64 {
        let cos = match kind {
            EmitterKind::Surface => dir.z.max(0.0),
            EmitterKind::Far | EmitterKind::Point | EmitterKind::Volume => 1.0,
        };
        self.luminance(dir) * cos / self.projected_solid_angle(kind)
    }

    /// A direction of travel, in proportion to the flux: by rejection from an even part and a glow
    /// about the sun that together are nowhere less than the sky.
    pub(crate) fn sample(&self, kind: EmitterKind, sampler: &mut Sampler<impl Numbers>) -> DVec3 {
        let SkyBound { even, glow, decay, sun } = self.model.bound();
        let sun = self.frame.to_world(sun);
        let even_flux = match kind {
            EmitterKind::Surface => PI * even,
            EmitterKind::Far | EmitterKind::Point | EmitterKind::Volume => TAU * even,
        };
        // ∫ exp(-kχ) sin χ dχ over 0..π is (1 + exp(-kπ)) / (1 + k²).
        let glow_flux = glow * TAU * (1.0 + (-decay * PI).exp()) / (1.0 + decay * decay);
        let even_share = even_flux / (even_flux + glow_flux);
        loop {
            let is_even = glow == 0.0 || sampler.one(Dimension::EmitDirection) < even_share;
            let dir = if is_even {
                self.even_direction(kind, sampler)
            } else {
                -glow_direction(sun, decay, sampler)
            };
            let from_sun = (-dir.dot(sun)).clamp(-1.0, 1.0).acos();
            let bound = even + if glow == 0.0 { 0.0 } else { glow * (-decay * from_sun).exp() };
            // The even part of a surface is already drawn with the cosine.
            let cos = match (kind, is_even) {
                (EmitterKind::Surface, false) => dir.z,
                (EmitterKind::Surface, true)
                | (EmitterKind::Far | EmitterKind::Point | EmitterKind::Volume, _) => 1.0,
            };
            if sampler.one(Dimension::EmitDirection) * bound < self.luminance(dir) * cos {
                return dir;
            }
        }
    }

    /// Luminance of the light that travels along `dir` relative to that of the zenith, 1.
    fn luminance(&self, dir: DVec3) -> f64 {
        self.model.luminance(self.frame.to_local(-dir))
    }

    fn even_direction(&self, kind: EmitterKind, sampler: &mut Sampler<impl Numbers>) -> DVec3 {
        let u = sampler.pair(Dimension::EmitDirection);
        match kind {
            EmitterKind::Surface => cosine_hemisphere(u),
            EmitterKind::Far | EmitterKind::Point | EmitterKind::Volume => {
                let toward = uniform_sphere(u);
                -self.frame.to_world(toward.with_z(toward.z.abs()))
            }
        }
    }
}

/// A direction at an angle χ from an axis with density ∝ exp(-kχ), by rejection: χ exp(-kχ) is that of the sum of two
/// exponential numbers, and sin χ / χ is at most 1.
fn glow_direction(axis: DVec3, decay: f64, sampler: &mut Sampler<impl Numbers>) -> DVec3 {
    loop {
        let [u, v] = sampler.pair(Dimension::EmitDirection);
        let angle = -((1.0 - u) * (1.0 - v)).ln() / decay;
        if angle < PI && sampler.one(Dimension::EmitDirection) * angle <= angle.sin() {
            let local = from_cosine(angle.cos(), sampler.one(Dimension::EmitDirection));
            return Frame::from_axis(DVec3::ZERO, axis).to_world(local);
        }
    }
}

fn amounts(model: &SkyModel, frame: &Frame) -> Amounts {
    let [rings, sectors] = STEPS;
    let (ring, sector) = (FRAC_PI_2 / f64::from(rings), TAU / f64::from(sectors));
    let mut sum = Amounts { across: 0.0, on_plane: 0.0, level: 0.0 };
    // Gauss points: 1/√3 of the half step from its middle.
    let offset = 0.5 / 3f64.sqrt();
    let places = (0..rings).map(f64::from).flat_map(|i| [i + 0.5 - offset, i + 0.5 + offset]);
    for place in places {
        let (sin, cos) = (place * ring).sin_cos();
        let solid_angle = sin * 0.5 * ring * sector;
        for j in 0..sectors {
            let (around_sin, around_cos) = ((f64::from(j) + 0.5) * sector).sin_cos();
            let toward = DVec3::new(sin * around_cos, sin * around_sin, cos);
            let light = model.luminance(toward) * solid_angle;
            sum.across += light;
            sum.level += light * cos;
            sum.on_plane += light * (-frame.to_world(toward).z).max(0.0);
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::CIE_TYPES;
    use crate::tally::Tally;

    /// A surface that faces the zenith: light goes along its +z, down.
    fn level() -> Frame {
        Frame { origin: DVec3::ZERO, x: DVec3::X, y: DVec3::NEG_Y, z: DVec3::NEG_Z }
    }

    /// A surface that faces a horizon with some tilt.
    fn tilted() -> Frame {
        Frame::from_axis(DVec3::ZERO, DVec3::new(-0.8, 0.1, -0.5).normalize())
    }

    fn sun() -> DVec3 {
        DVec3::new(0.6, 0.3, 0.5).normalize()
    }

    #[test]
    fn walls_and_disks_across_the_light_get_their_share() {
        let even = Sky::new(SkyModel::uniform(), level());
        let overcast = Sky::new(SkyModel::overcast(), level());
        let wall = Frame { origin: DVec3::ZERO, x: DVec3::Y, y: DVec3::Z, z: DVec3::X };
        // For a disk across all directions 2π L and 4/3 π Lz; illuminance of a wall half of π L.
        for (found, expected) in [
            (even.projected_solid_angle(EmitterKind::Far), TAU),
            (overcast.projected_solid_angle(EmitterKind::Far), 4.0 / 3.0 * PI),
            (
                Sky::new(SkyModel::uniform(), wall).projected_solid_angle(EmitterKind::Surface),
                0.5 * PI,
            ),
        ] {
            assert!((found / expected - 1.0).abs() < 1e-5, "{found}, {expected}");
        }
    }

    #[test]
    fn level_planes_get_what_integrals_say_to_nine_digits() {
        // Moon & Spencer (1942) for the overcast sky.
        for (model, expected) in [(SkyModel::uniform(), PI), (SkyModel::overcast(), 7.0 / 9.0 * PI)]
        {
            let sky = Sky::new(model, level());
            assert!((sky.level_illuminance() / expected - 1.0).abs() < 1e-9);
            let on_plane = sky.projected_solid_angle(EmitterKind::Surface);
            assert!((on_plane / expected - 1.0).abs() < 1e-9, "{on_plane}, {expected}");
        }
    }

    #[test]
    fn directions_come_with_the_density_that_is_told() {
        // The mean of g / density over drawn directions is ∫ g dω, here of g = (1 - cos Z)² sin²azimuth over what is lit.
        for (number, kind) in [3, 8, 12, 15]
            .into_iter()
            .flat_map(|number| [EmitterKind::Far, EmitterKind::Surface].map(|kind| (number, kind)))
        {
            let model = SkyModel::of_type(number, sun()).unwrap();
            let sky = Sky::new(model, tilted());
            let lit = |dir: DVec3| match kind {
                EmitterKind::Surface => f64::from(u8::from(dir.z > 0.3)),
                EmitterKind::Far | EmitterKind::Point | EmitterKind::Volume => 1.0,
            };
            let value = |dir: DVec3| {
                let up = tilted().to_local(-dir);
                lit(dir) * (1.0 - up.z).powi(2) * f64::from(u8::from(up.z > 0.1)) * (1.0 + up.x)
            };
            let drawn = Tally::of((0..40_000).map(|index| {
                let dir = sky.sample(kind, &mut Sampler::for_path(8, 0, index));
                value(dir) / sky.density(kind, dir)
            }));
            let n = 400;
            let mut exact = 0.0;
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let z = (f64::from(i) + 0.5) / f64::from(n);
                let toward = from_cosine(z, (f64::from(j) + 0.5) / f64::from(n));
                exact += value(-tilted().to_world(toward)) * TAU / f64::from(n * n);
            }
            assert!(drawn.sigmas_from(exact).abs() < 4.0, "{number} {kind:?}: {drawn:?} {exact}");
        }
    }

    #[test]
    fn densities_are_normalised() {
        for number in 1..=CIE_TYPES {
            let sky = Sky::new(SkyModel::of_type(number, sun()).unwrap(), tilted());
            for kind in [EmitterKind::Far, EmitterKind::Surface] {
                let n = 300;
                let mut sum = 0.0;
                for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                    let z = 2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0;
                    let dir = from_cosine(z, (f64::from(j) + 0.5) / f64::from(n));
                    sum += sky.density(kind, dir) * 2.0 * TAU / f64::from(n * n);
                }
                assert!((sum - 1.0).abs() < 3e-3, "type {number}, {kind:?}: {sum}");
            }
        }
    }

    #[test]
    fn a_surface_that_faces_the_ground_sees_no_sky() {
        let down = Frame::WORLD;
        assert!(!Sky::new(SkyModel::uniform(), down).is_seen_by_surface());
        assert!(Sky::new(SkyModel::uniform(), level()).is_seen_by_surface());
    }
}
