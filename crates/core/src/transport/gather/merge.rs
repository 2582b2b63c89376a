//! Merging of forward, backward and gather by multiple importance sampling: the share of a path
//! that each counts.
//!
//! All three can find the same path of discrete directions; the balance heuristic (Veach & Guibas,
//! SIGGRAPH 1995) divides its light among them by their densities. Per etendue these are
//! `c_F = N p_e`, `c_B = M p_g` and `c_M = N p_e M p_g G/q` (docs/method.md, eq. 16 to 18). This
//! module does not trace paths, and does not know the origin of the shares.

use crate::optics::{Finish, FinishModel, Incidence, Side};
use crate::scene::Scene;
use crate::transport::gather::window::Window;
use crate::transport::walk::scatter::MetInterface;
use glam::DVec3;
use lumiduct_base::math::projected_cap;
use std::collections::{BTreeSet, VecDeque};

/// Merged paths have no roulette above this throughput, 1: it would change their densities.
pub(crate) const ROULETTE_BELOW: f64 = 1e-4;
/// Smallest probability of a lobe, 1: rounding near total reflection must not divide by zero. The
/// same for all three.
const LEAST_CHANCE: f64 = 1e-9;
/// Light at a face that it meets, and its continuation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FacePassage<'s> {
    finish: &'s Finish,
    /// Incidence of the light, also when it comes from a gather path.
    incidence: Incidence,
    side: Side,
}

impl<'s> FacePassage<'s> {
    /// For a photon that meets a face.
    pub(crate) fn of_photon(facing: &MetInterface<'s>, side: Side) -> Self {
        Self { finish: facing.faces.own, incidence: facing.incidence, side }
    }

    /// For the light that a gather path at a face would find along `dir`.
    pub(crate) fn of_gather_path(facing: &MetInterface<'s>, dir: DVec3, side: Side) -> Self {
        let own = facing.incidence;
        let (finish, incidence) = match side {
            Side::Reflected => (facing.faces.own, Incidence { dir: -dir, ..own }),
            Side::Transmitted => (
                facing.faces.behind,
                Incidence {
                    dir: -dir,
                    normal: -own.normal,
                    index_from: own.index_to,
                    index_to: own.index_from,
                    grain: own.grain,
                },
            ),
        };
        Self { finish, incidence, side }
    }

    /// G/q, mm² sr: n² π r² ∫ cos θ dω over the cone about the light, above the horizon, over the
    /// probability of the path's side. Windows are not clipped: eq. (20).
    pub(crate) fn etendue(&self, window: Window) -> f64 {
        let Incidence { index_from, .. } = self.incidence;
        let chance = self.finish.chances(&self.incidence).of(self.side).max(LEAST_CHANCE);
        let (cos, basic) = (self.incidence.cos(), index_from * index_from / chance);
        basic * window.area() * projected_cap(cos, window.theta_max)
    }
}

/// The last faces that a photon has met, as many as there are from vertex D to a sensor.
#[derive(Debug)]
pub(crate) struct Recent<'s> {
    passages: VecDeque<FacePassage<'s>>,
    /// Vertex at which gather paths leave records, D.
    depth: usize,
}

impl<'s> Recent<'s> {
    pub(crate) fn new(depth: u32) -> Self {
        Self { passages: VecDeque::new(), depth: depth as usize }
    }

    pub(crate) fn clear(&mut self) {
        self.passages.clear();
    }

    pub(crate) fn push(&mut self, passage: FacePassage<'s>) {
        if self.passages.len() > self.depth {
            self.passages.pop_front();
        }
        self.passages.push_back(passage);
    }

    /// G/q at vertex D, counted back from the photon's position; zero if it has met too few faces.
    pub(crate) fn etendue(&self, window: Window) -> f64 {
        match self.passages.front() {
            Some(passage) if self.passages.len() > self.depth => passage.etendue(window),
            Some(_) | None => 0.0,
        }
    }
}

/// A cause of scatter off discrete directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scatterer<'s> {
    /// A finish.
    Finish {
        /// Its name, or a description of an inline one.
        finish: &'s str,
        /// Dotted name of the first face that has it.
        face: &'s str,
    },
    /// A medium, by its name.
    Medium(&'s str),
}

impl std::fmt::Display for Scatterer<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Finish { finish, face } => write!(f, "the finish `{finish}` on `{face}`"),
            Self::Medium(name) => write!(f, "the medium `{name}`"),
        }
    }
}

/// The media of a scene that scatter.
pub fn turbid_media(scene: &Scene) -> impl Iterator<Item = Scatterer<'_>> {
    let turbid = scene.media.iter().filter(|medium| medium.scattering().is_some());
    turbid.map(|medium| Scatterer::Medium(medium.name()))
}

/// The finishes and media of a scene that prevent merging the three estimators. Where light is
/// scattered, a gather path and a photon that meet in their windows do not form the same path as
/// either of them; and where one side has several discrete directions, the probability of a side is
/// not that of a path.
pub fn scatterers(scene: &Scene) -> Vec<Scatterer<'_>> {
    let mut seen = BTreeSet::new();
    let sides = scene.faces.iter().flat_map(|face| {
        let patterns = face.patterns.iter().map(|&number| &scene.patterns[number]);
        let elements = patterns.flat_map(|pattern| {
            let bore = pattern.wall.map(|wall| wall.bore);
            [Some(pattern.front), Some(pattern.back), bore]
        });
        [face.front, face.back].into_iter().chain(elements).map(move |id| (face, id))
    });
    sides
        .filter_map(|(face, id)| {
            let named = &scene.finishes[id?.index()];
            let is_new = !named.finish.has_one_direction_a_side() && seen.insert(id);
            is_new.then(|| Scatterer::Finish { finish: &named.name, face: &face.name })
        })
        .chain(turbid_media(scene))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A gather path in glass that meets air, refracted.
    fn refracted() -> (MetInterface<'static>, DVec3) {
        let (sin, index) = (0.5f64, 1.5);
        let dir = DVec3::new(sin, 0.0, -(1.0 - sin * sin).sqrt());
        let incidence = Incidence {
            dir,
            normal: DVec3::Z,
            index_from: index,
            index_to: 1.0,
            grain: DVec3::ZERO,
        };
        let faces = crate::optics::Faces { own: &Finish::Smooth, behind: &Finish::Smooth };
        let out = DVec3::new(index * sin, 0.0, -(1.0 - (index * sin).powi(2)).sqrt());
        (MetInterface { faces, incidence, facet: DVec3::Z }, out)
    }

    #[test]
    fn a_gather_path_and_the_photon_of_the_same_path_tell_the_same_window() {
        let window = Window { radius: 0.5, theta_max: 0.02 };
        let (facing, out) = refracted();
        for side in [Side::Reflected, Side::Transmitted] {
            let Incidence { dir, normal, index_from, index_to, grain } = facing.incidence;
            let (out, light) = match side {
                Side::Reflected => {
                    let out = DVec3::new(dir.x, 0.0, -dir.z);
                    (out, Incidence { dir: -out, normal, index_from, index_to, grain })
                }
                Side::Transmitted => (
                    out,
                    Incidence {
                        dir: -out,
                        normal: -normal,
                        index_from: index_to,
                        index_to: index_from,
                        grain: DVec3::ZERO,
                    },
                ),
            };
            let photon =
                MetInterface { incidence: light, facet: light.normal, faces: facing.faces };
            let told = FacePassage::of_gather_path(&facing, out, side).etendue(window);
            let expected = FacePassage::of_photon(&photon, side).etendue(window);
            let chance = Finish::Smooth.chances(&light).of(side);
            // n² |cos θ| π r² 2π (1 - cos θ_max) / q
            let formula =
                light.index_from.powi(2) * light.cos() * window.area() * window.solid_angle()
                    / chance;
            assert!((told / expected - 1.0).abs() < 1e-12, "{side:?}: {told}, {expected}");
            assert!((told / formula - 1.0).abs() < 1e-3, "{side:?}: {told}, {formula}");
        }
    }

    #[test]
    fn vertex_d_is_counted_from_the_sensor() {
        let window = Window { radius: 0.5, theta_max: 0.02 };
        let at = |index_from: f64| {
            let incidence = Incidence {
                dir: DVec3::NEG_Z,
                normal: DVec3::Z,
                index_from,
                index_to: index_from,
                grain: DVec3::ZERO,
            };
            FacePassage { finish: &Finish::Open, incidence, side: Side::Transmitted }
        };
        let mut recent = Recent::new(2);
        for (met, index) in [1.0, 2.0, 3.0, 4.0].into_iter().enumerate() {
            assert_eq!(recent.etendue(window) > 0.0, met > 2, "{met} faces");
            recent.push(at(index));
        }
        // The third from the end.
        assert_eq!(recent.etendue(window), at(2.0).etendue(window));
        recent.clear();
        assert_eq!(recent.etendue(window), 0.0);
    }
}
