//! Rough interfaces and rough mirrors made of many unresolved plane facets.
//!
//! Slopes follow GGX with Smith masking, separately for arriving and leaving light (Walter,
//! Marschner, Li & Torrance, Microfacet models for refraction through rough surfaces, EGSR 2007:
//! WMLT below). Facets are drawn from the distribution of visible normals (Heitz, Sampling the GGX
//! distribution of visible normals, JCGT 7 (2018) 4). Light meets one facet: light that another
//! facet would catch on the way out counts as absorbed. This module knows media only by their
//! indices.
//!
//! `f(i→o)/n_o²` is the same both ways, so a gather path does what a photon does, without a factor.

use crate::optics::finish::model::FinishModel;
use crate::optics::finish::smooth::SmoothInterface;
use crate::optics::{FaceMueller, Incidence, Scattered, Shares, Side, fresnel};
use crate::rng::{Dimension, Numbers, Sampler};
use glam::DVec3;
use lumiduct_base::math::{Frame, disk};
use std::f64::consts::PI;

/// Facets of a quadrature over the visible ones, along each of two axes.
const FACETS: u32 = 48;

/// A rough surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Microfacet {
    roughness: f64,
    facets: FacetKind,
}

/// The kind of its facets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FacetKind {
    /// Smooth interfaces of the two media.
    Interface,
    /// Mirrors with the same reflectance, 1, at every angle.
    Mirror {
        /// Share that is mirrored, 0..=1.
        reflectance: f64,
    },
    /// Metal of complex index n + ik.
    Metal {
        /// Real part of the index.
        n: f64,
        /// Imaginary part of the index, not negative.
        k: f64,
    },
}

/// A facet that light meets.
struct MetFacet {
    /// Its unit normal in the frame of the surface.
    normal: DVec3,
    /// Cosine of the angle of incidence on it.
    cos: f64,
    /// The frame of the surface, with +z on the side the light comes from.
    frame: Frame,
}

impl FinishModel for Microfacet {
    /// Integrals over the visible facets, to 4e-3.
    fn shares(&self, incidence: &Incidence) -> Shares {
        if self.is_nothing(incidence) {
            return Shares { reflected: 0.0, transmitted: 1.0 };
        }
        let middle = |cell: u32| (f64::from(cell) + 0.5) / f64::from(FACETS);
        let mut flux = [0.0; 2];
        for cell in 0..FACETS * FACETS {
            // Steep facets are few, and light is totally reflected there.
            let steep = middle(cell / FACETS);
            let weight = 3.0 * steep * steep / f64::from(FACETS * FACETS);
            let facet = self.seen(incidence, [1.0 - steep.powi(3), middle(cell % FACETS)]);
            let shares = self.of_facet(&facet, incidence);
            for (flux, side) in flux.iter_mut().zip([Side::Reflected, Side::Transmitted]) {
                let sent = self.sent(&facet, side, incidence, shares.of(side));
                *flux += sent.map_or(0.0, |out| weight * out.factor);
            }
        }
        let [reflected, transmitted] = flux;
        Shares { reflected, transmitted }
    }

    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        if self.is_nothing(incidence) {
            return Some(Scattered::specular(incidence.dir, 1.0, Side::Transmitted));
        }
        let facet = self.draw(incidence, sampler);
        let shares = self.of_facet(&facet, incidence);
        let side = shares.choose_side(sampler)?;
        self.sent(&facet, side, incidence, shares.sum())
    }

    fn scatter_radiance(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        self.scatter(incidence, sampler).map(Scattered::normalised)
    }

    fn scatter_toward(
        &self,
        side: Side,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        if self.is_nothing(incidence) {
            return (side == Side::Transmitted)
                .then(|| Scattered::specular(incidence.dir, 1.0, side));
        }
        let facet = self.draw(incidence, sampler);
        let share = self.of_facet(&facet, incidence).of(side);
        if share > 0.0 { self.sent(&facet, side, incidence, share) } else { None }
    }

    /// That of a facet without tilt.
    fn albedo_about(&self, incidence: &Incidence) -> f64 {
        let frame = Frame::from_axis(DVec3::ZERO, incidence.normal);
        let level = MetFacet { normal: DVec3::Z, cos: incidence.cos(), frame };
        self.of_facet(&level, incidence).sum()
    }

    /// About those of a facet without tilt, leaving out no side.
    fn chances(&self, incidence: &Incidence) -> Shares {
        match self.facets {
            FacetKind::Interface if self.is_nothing(incidence) => self.shares(incidence),
            FacetKind::Interface => SmoothInterface::chances_about(&incidence.unpolarised()),
            FacetKind::Mirror { .. } | FacetKind::Metal { .. } => {
                Shares { reflected: 1.0, transmitted: 0.0 }
            }
        }
    }

    /// Where it has no effect, light keeps its polarisation.
    fn mueller(&self, incidence: &Incidence, side: Side) -> Option<FaceMueller> {
        self.is_nothing(incidence).then(|| FaceMueller::ideal(side))
    }

    fn radiance_chances(&self, incidence: &Incidence) -> Shares {
        SmoothInterface::chances_about(&incidence.unpolarised())
    }

    /// WMLT eq. 20 and, with the square of the index on the exit side, eq. 21.
    fn evaluate(&self, incidence: &Incidence, out: DVec3) -> f64 {
        let frame = Frame::from_axis(DVec3::ZERO, incidence.normal);
        let (from, out) = (frame.to_local(-incidence.dir), frame.to_local(out));
        let (n_i, n_o) = (incidence.index_from, incidence.index_to);
        let reflected = out.z > 0.0;
        if self.is_nothing(incidence) {
            return 0.0;
        }
        let half = if reflected { from + out } else { -(n_i * from + n_o * out) };
        let normal = (half * half.z.signum()).try_normalize().unwrap_or(DVec3::Z);
        let (cos_i, cos_o) = (from.dot(normal), out.dot(normal));
        if cos_i <= 0.0 || (cos_o > 0.0) != reflected || from.z <= 0.0 || out.z == 0.0 {
            return 0.0;
        }
        let facet = MetFacet { normal, cos: cos_i.min(1.0), frame };
        let shares = self.of_facet(&facet, incidence);
        let seen =
            self.density(normal.z) * self.seen_over_cos(from.z) * self.seen_over_cos(out.z.abs());
        if reflected {
            return 0.25 * shares.reflected * seen;
        }
        let jacobian = n_i * cos_i + n_o * cos_o;
        shares.transmitted * seen * cos_i * cos_o.abs() * (n_o * n_o) / (jacobian * jacobian)
    }

    /// Approximate: twice the tilt of the facets.
    fn width(&self) -> Option<f64> {
        Some(2.0 * self.roughness)
    }
}

impl Microfacet {
    /// A surface of roughness α (WMLT eq. 33): the root mean square slope of the facets visible in
    /// its middle, above 0.
    pub fn new(roughness: f64, facets: FacetKind) -> Self {
        Self { roughness, facets }
    }

    /// Whether light can only pass through it, unbent: facets between equal indices have no effect.
    fn is_nothing(&self, incidence: &Incidence) -> bool {
        self.facets == FacetKind::Interface && incidence.index_from == incidence.index_to
    }

    fn draw(&self, incidence: &Incidence, sampler: &mut Sampler<impl Numbers>) -> MetFacet {
        self.seen(incidence, sampler.pair(Dimension::Scatter))
    }

    /// The facet of two numbers in 0..1, in proportion to its area as seen from the direction of
    /// the light (Heitz 2018, section 3). The surface is stretched until it is a hemisphere; its
    /// projection is a disk cut by its own edge.
    fn seen(&self, incidence: &Incidence, u: [f64; 2]) -> MetFacet {
        let frame = Frame::from_axis(DVec3::ZERO, incidence.normal);
        let local = frame.to_local(-incidence.dir);
        let from = local.with_z(local.z.max(0.0));
        let stretch = DVec3::new(self.roughness, self.roughness, 1.0);
        let view = (stretch * from).normalize();
        let across = DVec3::new(-view.y, view.x, 0.0).try_normalize().unwrap_or(DVec3::X);
        let up = view.cross(across);
        let DVec3 { x, y, .. } = disk(u);
        let lower = 0.5 * (1.0 + view.z);
        let y = (1.0 - lower) * (1.0 - x * x).max(0.0).sqrt() + lower * y;
        let toward = (1.0 - x * x - y * y).max(0.0).sqrt();
        let bump = x * across + y * up + toward * view;
        let normal = (stretch * bump.with_z(bump.z.max(1e-12))).normalize();
        MetFacet { normal, cos: from.dot(normal).clamp(0.0, 1.0), frame }
    }

    /// Light that one facet reflects and transmits.
    fn of_facet(&self, facet: &MetFacet, incidence: &Incidence) -> Shares {
        let Incidence { index_from, index_to, .. } = *incidence;
        match self.facets {
            FacetKind::Interface => {
                let reflected = fresnel::dielectric(facet.cos, index_from, index_to).unpolarised();
                Shares { reflected, transmitted: 1.0 - reflected }
            }
            FacetKind::Mirror { reflectance } => {
                Shares { reflected: reflectance, transmitted: 0.0 }
            }
            FacetKind::Metal { n, k } => {
                let reflected = fresnel::conductor(facet.cos, index_from, n, k).unpolarised();
                Shares { reflected, transmitted: 0.0 }
            }
        }
    }

    /// Light that a facet sends to a side with this share, less the part masked on the way out;
    /// `None` into the surface.
    fn sent(
        &self,
        facet: &MetFacet,
        side: Side,
        incidence: &Incidence,
        share: f64,
    ) -> Option<Scattered> {
        let Incidence { dir, index_from, index_to, .. } = *incidence;
        let normal = facet.frame.to_world(facet.normal);
        let (dir, height) = match side {
            Side::Reflected => {
                let dir = fresnel::mirrored(dir, normal);
                (dir, dir.dot(incidence.normal))
            }
            Side::Transmitted => {
                let cos_t = fresnel::cos_transmitted(facet.cos, index_from, index_to)?;
                let eta = index_from / index_to;
                let dir = fresnel::refracted(dir, normal, facet.cos, cos_t, eta);
                (dir, -dir.dot(incidence.normal))
            }
        };
        let factor = share * self.seen_over_cos(height) * height;
        (height > 0.0).then_some(Scattered::diffuse(dir, factor, side))
    }

    /// Area of facets per area and solid angle of their normal, 1/sr (WMLT eq. 33).
    fn density(&self, cos: f64) -> f64 {
        let alpha2 = self.roughness * self.roughness;
        let stretched = 1.0 - cos * cos * (1.0 - alpha2);
        alpha2 / (PI * stretched * stretched)
    }

    /// Share of facets that is not masked in a direction of this cosine (WMLT eq. 34), over the cosine; 1.
    fn seen_over_cos(&self, cos: f64) -> f64 {
        let alpha2 = self.roughness * self.roughness;
        2.0 / (cos + (alpha2 + (1.0 - alpha2) * cos * cos).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Finish;
    use crate::optics::finish::testing::{
        assert_follows, assert_mean_factors, assert_reciprocal, assert_sound, facets, incidence,
        rough_metal,
    };

    const INDICES: [[f64; 2]; 2] = [[1.0, 1.49], [1.49, 1.0]];

    fn rough(roughness: f64, facets: FacetKind) -> Finish {
        Finish::Microfacet(Microfacet::new(roughness, facets))
    }

    fn all(roughness: f64) -> [Finish; 3] {
        [
            FacetKind::Interface,
            FacetKind::Mirror { reflectance: 0.9 },
            FacetKind::Metal { n: 0.8, k: 5.9 },
        ]
        .map(|facets| rough(roughness, facets))
    }

    #[test]
    fn photons_and_gather_paths_follow_it() {
        assert_sound(&facets(0.05));
        assert_sound(&facets(0.5));
        assert_sound(&rough_metal());
        assert_mean_factors(&facets(0.7));
    }

    #[test]
    fn scattered_light_follows_the_distribution_function_and_its_share_is_told() {
        for finish in all(0.4).into_iter().chain([rough(0.15, FacetKind::Interface)]) {
            for indices in INDICES {
                for angle in [0.0, 0.6, 1.2] {
                    let incidence = incidence(angle, indices);
                    for side in [Side::Reflected, Side::Transmitted] {
                        let integral = assert_follows(&finish, &incidence, side);
                        let told = finish.shares(&incidence).of(side);
                        assert!(
                            (integral - told).abs() < 4e-3,
                            "{side:?} {angle}: {integral}, {told}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn the_distribution_function_is_reciprocal() {
        for finish in all(0.3) {
            for indices in INDICES {
                assert_reciprocal(&finish, indices);
            }
        }
    }

    #[test]
    fn rougher_facets_catch_more_of_the_light_and_none_creates_any() {
        for (roughness, most) in [(0.01, 5e-4), (0.1, 0.03), (0.3, 0.2), (1.0, 0.75)] {
            let mirror = rough(roughness, FacetKind::Mirror { reflectance: 1.0 });
            for angle in [0.0, 0.5, 1.0] {
                let lost = 1.0 - mirror.shares(&incidence(angle, [1.0, 1.0])).reflected;
                assert!((-1e-12..most).contains(&lost), "{roughness} at {angle}: {lost}");
            }
        }
    }

    #[test]
    fn fine_facets_share_light_as_a_smooth_interface() {
        let finish = rough(1e-3, FacetKind::Interface);
        for indices in INDICES {
            for angle in [0.0, 0.4, 0.6, 0.9, 1.2] {
                let incidence = incidence(angle, indices);
                let (fine, smooth) =
                    (finish.shares(&incidence), SmoothInterface.shares(&incidence));
                assert!((fine.reflected - smooth.reflected).abs() < 1e-3, "{fine:?}, {smooth:?}");
                assert!(
                    (fine.transmitted - smooth.transmitted).abs() < 1e-3,
                    "{fine:?}, {smooth:?}"
                );
            }
        }
    }

    #[test]
    fn areas_of_facets_add_up_to_the_area_of_the_surface() {
        // ∫ D cos θ dω = 1 (WMLT eq. 4).
        for roughness in [0.05, 0.5, 1.0] {
            let surface = Microfacet::new(roughness, FacetKind::Interface);
            let steps = 20_000;
            let sum: f64 = (0..steps)
                .map(|i| {
                    let cos = 1.0 - ((f64::from(i) + 0.5) / f64::from(steps)).powi(3);
                    let width =
                        3.0 * ((f64::from(i) + 0.5) / f64::from(steps)).powi(2) / f64::from(steps);
                    2.0 * PI * surface.density(cos) * cos * width
                })
                .sum();
            assert!((sum - 1.0).abs() < 1e-5, "{roughness}: {sum}");
        }
    }

    #[test]
    fn between_equal_indices_small_facets_do_nothing() {
        let finish = rough(0.4, FacetKind::Interface);
        let incidence = incidence(0.7, [1.3, 1.3]);
        let mut sampler = Sampler::for_path(1, 0, 0);
        let out = finish.scatter(&incidence, &mut sampler).unwrap();
        assert_eq!((out.dir, out.factor, out.side), (incidence.dir, 1.0, Side::Transmitted));
    }
}
