//! Contribution of a photon to a gather record: the position and the position-and-angle estimate,
//! and that within media.
//!
//! `L*(x,ω) = 1/n² Σ Φ_p K_r K_θ / |cos θ_p|` (docs/method.md, eq. 15): `K_r` is 1/ΔA over the disk
//! of the window in the tangent plane, clipped at rims, times the cosine between the normals at
//! record and photon, so that it integrates to 1 over a curved surface, too. `K_θ` is 1/ΔΩ over the
//! cone. Where the cone comes near the horizon at the photon's position, or holds directions in
//! which total reflection begins there, `K_θ / |cos θ_p|` becomes 1/∫ cos θ dω over the part of the
//! cone on the side of its axis. It has the same integral, and photons at grazing incidence need
//! not be left out and have bounded weights.
//!
//! Within a medium that scatters, `L*(x,ω) = 1/n² Σ Φ_p S(ω_p→ω) / (σ_s ΔV)` over the photons that
//! are scattered in the ball of the window (eq. 23, after Jensen & Christensen, SIGGRAPH 1998, eq.
//! 15): gather paths are scattered with the same probability there, so their estimate needs no
//! other factor.

use crate::optics::{FinishModel, Incidence};
use crate::scene::MediumId;
use crate::transport::gather::coverage::{AGREEING, HEIGHT};
use crate::transport::gather::cut_cone::CutCone;
use crate::transport::gather::kernel::{Kernels, ORDERS, weights_by_order};
use crate::transport::gather::records::{GatherRecord, RecordKind, SurfaceRecord, VolumeRecord};
use crate::transport::gather::surfaces::Slot;
use crate::transport::window::Window;
use glam::DVec3;

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

/// The window of a pass, ready to weigh photons.
#[derive(Debug, Clone, Copy)]
pub struct PairWeights {
    radius_squared: f64,
    chord_squared: f64,
    theta_max: f64,
    sin_theta: f64,
    /// 1/ΔΩ, 1/sr.
    per_solid_angle: f64,
}

impl PairWeights {
    /// For pairs within a window.
    pub fn new(window: Window) -> Self {
        Self {
            radius_squared: window.radius.powi(2),
            chord_squared: window.chord().powi(2),
            theta_max: window.theta_max,
            sin_theta: window.theta_max.sin(),
            per_solid_angle: 1.0 / window.solid_angle(),
        }
    }

    /// Flux in the cells of a record per unit of a photon's flux, for each order; `None` if the
    /// photon is not in its window.
    #[inline]
    pub fn flux(&self, record: &GatherRecord<'_>, photon: &PhotonHit) -> Option<[f64; ORDERS]> {
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
    fn at_surface(&self, record: &SurfaceRecord<'_>, photon: &SurfaceHit) -> Option<[f64; ORDERS]> {
        let offset = photon.point - record.point;
        let height = offset.dot(record.normal);
        let across = offset.length_squared() - height * height;
        let agreement = record.normal.dot(photon.incidence.normal);
        if across > self.radius_squared
            || height * height > HEIGHT * HEIGHT * self.radius_squared
            || agreement < AGREEING
            || record.surface != photon.surface
            || record.medium != photon.medium
        {
            return None;
        }
        let (share, of_angle) = match record.kind {
            RecordKind::Along(wanted) => self.along(wanted, photon)?,
            RecordKind::Scattered { finish, out } => {
                (finish.evaluate(&photon.incidence, out), WITHOUT_ANGLE)
            }
        };
        let lean = record.slope.dot(offset);
        let of_position = record.kernels.at(across / self.radius_squared).map(|k| k + lean);
        let value = record.value * agreement * share;
        Some(weights_by_order(of_position, of_angle).map(|weight| value * weight))
    }

    fn within(&self, record: &VolumeRecord, photon: &VolumeHit) -> Option<[f64; ORDERS]> {
        let apart = photon.point.distance_squared(record.point);
        if apart > self.radius_squared || record.medium != photon.medium {
            return None;
        }
        let value = record.value * record.scattering.phase(photon.dir.dot(record.out));
        let of_position = record.kernels.at(apart / self.radius_squared);
        Some(weights_by_order(of_position, WITHOUT_ANGLE).map(|weight| value * weight))
    }

    /// `K_θ / |cos θ_p|`, 1/sr, and the kernels of a photon's angle to the wanted direction; `None` outside of the
    /// cone, and beyond an edge in it.
    #[inline]
    fn along(&self, wanted: DVec3, photon: &SurfaceHit) -> Option<(f64, [f64; 2])> {
        let t = photon.incidence.dir.distance_squared(wanted) / self.chord_squared;
        let cos_axis = -wanted.dot(photon.incidence.normal);
        if t > 1.0 || cos_axis <= 0.0 {
            return None;
        }
        let cos = photon.incidence.cos();
        let critical = total_reflection_below(&photon.incidence);
        // Cosines differ by no more than the angles.
        let is_cut = (cos_axis - critical).abs() < self.theta_max && critical > 0.0;
        if cos_axis > self.sin_theta + GRAZING && !is_cut {
            return Some((self.per_solid_angle / cos, Kernels::EVEN.at(t)));
        }
        let side = if cos_axis < critical { [0.0, critical] } else { [critical, 1.0] };
        if cos < side[0] || (cos > side[1] && side[1] < 1.0) {
            return None;
        }
        let cone = CutCone::new(cos_axis, self.theta_max, side);
        Some((1.0 / cone.projected, cone.kernels.at(t)))
    }
}

/// Kernels of a pair whose angle does not matter.
const WITHOUT_ANGLE: [f64; 2] = [1.0; 2];

/// Cosine to the normal below which light is totally reflected, 1; 0 if none is.
#[inline]
fn total_reflection_below(incidence: &Incidence) -> f64 {
    let ratio = incidence.index_to / incidence.index_from;
    (1.0 - ratio * ratio).max(0.0).sqrt()
}
