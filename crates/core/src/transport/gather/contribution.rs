//! Contribution of a photon to a gather record: the position and the position-and-angle estimate,
//! and that within media.
//!
//! `L*(x,ω) = 1/n² Σ Φ_p K_r K_θ / |cos θ_p|` (docs/method.md, eq. 15): `K_r` is 1/ΔA over the disk
//! of the window in the tangent plane, clipped at rims, times the cosine between the normals at
//! record and photon, so that it integrates to 1 over a curved surface, too. `K_θ` is 1/ΔΩ over the
//! cone. Where the cone comes near the horizon at the photon's position, `K_θ / |cos θ_p|` becomes
//! 1/∫ cos θ dω over the part of the cone above the horizon. It has the same integral, and photons
//! at grazing incidence need not be left out and have bounded weights.
//!
//! Within a medium that scatters, `L*(x,ω) = 1/n² Σ Φ_p p(ω_p→ω) / (σ_s ΔV)` over the photons that
//! are scattered in the ball of the window (eq. 24, after Jensen & Christensen, SIGGRAPH 1998, eq.
//! 15): gather paths are scattered with the same probability there, so their estimate needs no
//! other factor.

use crate::optics::{FinishModel, Incidence};
use crate::scene::MediumId;
use crate::transport::gather::coverage::{AGREEING, HEIGHT};
use crate::transport::gather::records::{GatherRecord, RecordKind, SurfaceRecord, VolumeRecord};
use crate::transport::gather::surfaces::Slot;
use crate::transport::gather::window::{ANGLE_OF, COUNTED, NESTED, RADIUS_OF, Window};
use glam::DVec3;
use lumiduct_base::math::projected_cap;

/// Cosines that the directions of a cone must stay above for `1/|cos θ_p|` to be used, 1.
const GRAZING: f64 = 0.03;

/// A photon that may belong to records.
#[derive(Debug, Clone, Copy)]
pub enum PhotonHit {
    /// A photon that meets a surface.
    Surface(SurfaceHit),
    /// A photon that is scattered within a medium.
    Volume(VolumeHit),
}

/// A photon that meets a surface.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceHit {
    /// The smooth surface, by its index in the list of all.
    pub surface: Slot,
    /// The medium it arrives in.
    pub medium: MediumId,
    /// Position, mm.
    pub point: DVec3,
    /// Its incidence, about the geometric normal of the surface on the side it comes from.
    pub incidence: Incidence,
}

/// A photon that is scattered within a medium.
#[derive(Debug, Clone, Copy)]
pub struct VolumeHit {
    /// The medium, by its index among surfaces and media.
    pub medium: Slot,
    /// Position, mm.
    pub point: DVec3,
    /// Unit direction of travel before scattering.
    pub dir: DVec3,
}

/// The nested windows of a pass.
#[derive(Debug, Clone, Copy)]
pub struct NestedWindows {
    radii_squared: [f64; NESTED],
    chords_squared: [f64; NESTED],
    theta_max: [f64; NESTED],
    /// 1/ΔΩ, 1/sr.
    per_solid_angle: [f64; NESTED],
    /// Sine of the widest angle.
    sin_widest: f64,
}

impl NestedWindows {
    /// The nested windows of the widest one.
    pub fn new(window: Window) -> Self {
        let nested = window.nested();
        Self {
            radii_squared: nested.map(|window| window.radius.powi(2)),
            chords_squared: nested.map(|window| window.chord().powi(2)),
            theta_max: nested.map(|window| window.theta_max),
            per_solid_angle: nested.map(|window| 1.0 / window.solid_angle()),
            sin_widest: window.theta_max.sin(),
        }
    }

    /// Flux in the cells of a record per unit of a photon's flux, for each window; `None` if the
    /// photon is in none of them.
    #[inline]
    pub fn flux(&self, record: &GatherRecord<'_>, photon: &PhotonHit) -> Option<[f64; COUNTED]> {
        match (record, photon) {
            (GatherRecord::Surface(record), PhotonHit::Surface(hit)) => {
                self.at_surface(record, hit)
            }
            (GatherRecord::Volume(record), PhotonHit::Volume(hit)) => self.within(record, hit),
            (GatherRecord::Surface(_), PhotonHit::Volume(_))
            | (GatherRecord::Volume(_), PhotonHit::Surface(_)) => None,
        }
    }

    #[inline]
    fn at_surface(
        &self,
        record: &SurfaceRecord<'_>,
        photon: &SurfaceHit,
    ) -> Option<[f64; COUNTED]> {
        let offset = photon.point - record.point;
        let height = offset.dot(record.normal);
        let across = offset.length_squared() - height * height;
        let [widest, ..] = self.radii_squared;
        let agreement = record.normal.dot(photon.incidence.normal);
        if across > widest
            || height * height > HEIGHT * HEIGHT * widest
            || agreement < AGREEING
            || record.surface != photon.surface
            || record.medium != photon.medium
        {
            return None;
        }
        let within = |window: usize| across <= self.radii_squared[RADIUS_OF[window]];
        match record.kind {
            RecordKind::Along(wanted) => {
                let apart = photon.incidence.dir.distance_squared(wanted);
                let [widest, ..] = self.chords_squared;
                if apart > widest {
                    return None;
                }
                let cos_wanted = -wanted.dot(photon.incidence.normal);
                Some(each(record.values, |window| {
                    let angle = ANGLE_OF[window];
                    let inside = within(window) && apart <= self.chords_squared[angle];
                    let per_angle = || self.per_projected(angle, cos_wanted, photon);
                    if inside { agreement * per_angle() } else { 0.0 }
                }))
            }
            RecordKind::Scattered { finish, out } => {
                let scattered = agreement * finish.evaluate(&photon.incidence, out);
                Some(each(record.values, |window| if within(window) { scattered } else { 0.0 }))
            }
        }
    }

    fn within(&self, record: &VolumeRecord, photon: &VolumeHit) -> Option<[f64; COUNTED]> {
        let apart = photon.point.distance_squared(record.point);
        let [widest, ..] = self.radii_squared;
        if apart > widest || record.medium != photon.medium {
            return None;
        }
        let turned = record.scattering.phase(photon.dir.dot(record.out));
        let within = |window: usize| apart <= self.radii_squared[RADIUS_OF[window]];
        Some(each(record.values, |window| if within(window) { turned } else { 0.0 }))
    }

    /// `K_θ / |cos θ_p|` for one of the nested angles, 1/sr; `cos_wanted` is that of the cone's
    /// axis at the photon's position.
    #[inline]
    fn per_projected(&self, angle: usize, cos_wanted: f64, photon: &SurfaceHit) -> f64 {
        if cos_wanted > self.sin_widest + GRAZING {
            self.per_solid_angle[angle] / photon.incidence.cos()
        } else {
            1.0 / projected_cap(cos_wanted, self.theta_max[angle])
        }
    }
}

/// Values of a record times the share of a photon, for each window.
#[inline]
fn each(values: [f64; NESTED], share: impl Fn(usize) -> f64) -> [f64; COUNTED] {
    std::array::from_fn(|window| values[RADIUS_OF[window]] * share(window))
}
