//! Vertices that light has passed, and the windows of the records that could find it there.
//!
//! A gather path leaves records up to vertex D, counted from its sensor: at every vertex that
//! scatters broadly, for the light that is scattered, and at D for all other light. The density of
//! pairs with a record over that of photons and gather paths is 1 over the etendue G/q of the
//! vertex (docs/method.md, eq. 18 and 30). This module does not know how records are made.

use crate::optics::{Finish, FinishModel, Incidence, Lobe, Side};
use crate::transport::connect::vertex::ScatteringVertex;
use crate::transport::window::Window;
use glam::DVec3;
use lumiduct_base::math::projected_cap;
use smallvec::SmallVec;
use std::collections::VecDeque;

/// Smallest probability of a side, 1: rounding near total reflection must not divide by zero. The
/// same for all techniques.
const LEAST_CHANCE: f64 = 1e-9;

/// A vertex that light has passed.
#[derive(Debug, Clone, Copy)]
pub(crate) enum PassedVertex<'s> {
    /// Into a discrete direction, or close to one.
    Along(PassedFace<'s>),
    /// Scattered broadly, with the unit directions of the light before and after.
    Scattered(ScatteringVertex<'s>, [DVec3; 2]),
}

/// Light at a face that it meets, and the side to which it leaves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PassedFace<'s> {
    finish: &'s Finish,
    incidence: Incidence,
    side: Side,
}

/// G/q of the records at a vertex, mm² sr.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum VertexWindow {
    /// Left at vertex D only.
    Along(f64),
    /// Left at any vertex up to D.
    Scattered(f64),
}

impl<'s> PassedVertex<'s> {
    /// Of a path that left an interface by a lobe, with the unit directions of the light before and
    /// after, whichever path met it.
    pub(crate) fn of_lobe(vertex: ScatteringVertex<'s>, light: [DVec3; 2], lobe: Lobe) -> Self {
        match vertex.face() {
            Some(met) if lobe == Lobe::Specular || !vertex.is_broad(light[0]) => {
                let (finish, incidence) = met.acting_on(light[0]);
                let [before, after] = light.map(|dir| dir.dot(met.facet));
                let side = if before * after < 0.0 { Side::Reflected } else { Side::Transmitted };
                Self::Along(PassedFace { finish, incidence, side })
            }
            Some(_) | None => Self::Scattered(vertex, light),
        }
    }

    /// The records that could find the light here.
    pub(crate) fn window(&self, window: Window) -> VertexWindow {
        match self {
            Self::Along(passage) => VertexWindow::Along(passage.etendue(window)),
            Self::Scattered(vertex, light) => {
                VertexWindow::Scattered(vertex.window(*light, window).unwrap_or(0.0))
            }
        }
    }
}

impl PassedFace<'_> {
    /// G/q, mm² sr: n² π r² ∫ cos θ dω over the cone about the light, above the horizon, over the
    /// probability of the path's side. Windows are not clipped: eq. (20).
    fn etendue(&self, window: Window) -> f64 {
        let Incidence { index_from, .. } = self.incidence;
        let chance = self.finish.chances(&self.incidence).of(self.side).max(LEAST_CHANCE);
        let (cos, basic) = (self.incidence.cos(), index_from * index_from / chance);
        basic * window.area() * projected_cap(cos, window.theta_max)
    }
}

impl VertexWindow {
    /// G/q of the records of gather paths that meet the vertex as this many, from 0, and end at
    /// vertex D.
    pub(crate) fn at(self, depth: usize, vertex_d: usize) -> f64 {
        match self {
            Self::Along(etendue) if depth == vertex_d => etendue,
            Self::Scattered(etendue) if depth <= vertex_d => etendue,
            Self::Along(_) | Self::Scattered(_) => 0.0,
        }
    }
}

/// Where gather paths leave records.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RecordPlaces {
    /// The window of the records.
    pub(crate) window: Window,
    /// Vertex at which they end, D; the first surface has depth 0.
    pub(crate) vertex_d: usize,
}

/// The last vertices of a photon, as many as there are from vertex D to a sensor.
#[derive(Debug)]
pub(crate) struct RecentPassages<'s> {
    places: RecordPlaces,
    passages: VecDeque<PassedVertex<'s>>,
}

impl<'s> RecentPassages<'s> {
    /// Of a photon that has yet to start.
    pub(crate) fn new(places: RecordPlaces) -> Self {
        Self { places, passages: VecDeque::new() }
    }

    /// Another photon starts.
    pub(crate) fn clear(&mut self) {
        self.passages.clear();
    }

    /// The photon has passed a vertex.
    pub(crate) fn push(&mut self, passage: PassedVertex<'s>) {
        if self.passages.len() > self.places.vertex_d {
            self.passages.pop_front();
        }
        self.passages.push_back(passage);
    }

    /// The windows at these vertices, the last first.
    pub(crate) fn windows(&self) -> SmallVec<[VertexWindow; 9]> {
        let last_first = self.passages.iter().rev();
        last_first.map(|passage| passage.window(self.places.window)).collect()
    }

    /// G/q of the records on a path from here to a sensor, which passes `next` first if given, mm² sr.
    pub(crate) fn sum(&self, next: Option<PassedVertex<'s>>) -> f64 {
        let RecordPlaces { window, vertex_d } = self.places;
        let passed = next.iter().chain(self.passages.iter().rev()).enumerate();
        passed
            .map(|(depth, passage)| match passage {
                PassedVertex::Along(_) if depth != vertex_d => 0.0,
                PassedVertex::Along(_) | PassedVertex::Scattered(..) => {
                    passage.window(window).at(depth, vertex_d)
                }
            })
            .sum()
    }
}

/// The records that a gather path has left so far.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PassedRecords {
    places: RecordPlaces,
    vertices: usize,
    sum: f64,
}

impl PassedRecords {
    /// Of a path that starts.
    pub(crate) fn new(places: RecordPlaces) -> Self {
        Self { places, vertices: 0, sum: 0.0 }
    }

    /// The path has passed a vertex.
    pub(crate) fn push<'s>(&mut self, passage: impl FnOnce() -> PassedVertex<'s>) {
        if self.vertices <= self.places.vertex_d {
            self.sum = self.sum(Some(passage()));
        }
        self.vertices += 1;
    }

    /// Vertices that the path has passed.
    pub(crate) fn vertices(&self) -> usize {
        self.vertices
    }

    /// G/q of these records, and of that at the next vertex if given, mm² sr.
    pub(crate) fn sum(&self, next: Option<PassedVertex<'_>>) -> f64 {
        let RecordPlaces { window, vertex_d } = self.places;
        self.sum + next.map_or(0.0, |next| next.window(window).at(self.vertices, vertex_d))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::{Faces, REFERENCE_WAVELENGTH};
    use crate::transport::walk::scatter::MetInterface;
    use std::f64::consts::PI;

    static WHITE: Finish = Finish::Lambertian { reflectance: 0.6, transmittance: 0.2 };

    const WINDOW: Window = Window { radius: 0.5, theta_max: 0.02 };

    /// A face as light from glass along `dir` meets it, with air behind.
    fn met_from_glass(finish: &'static Finish, dir: DVec3) -> MetInterface<'static> {
        let incidence = Incidence {
            dir,
            normal: DVec3::Z,
            index_from: 1.5,
            index_to: 1.0,
            wavelength: REFERENCE_WAVELENGTH,
            grain: DVec3::ZERO,
            s_share: Incidence::UNPOLARISED,
        };
        MetInterface {
            faces: Faces { own: finish, behind: finish },
            incidence,
            facet: DVec3::Z,
            shading: DVec3::Z,
        }
    }

    /// The same face as it is met from air.
    fn met_from_air(finish: &'static Finish, dir: DVec3) -> MetInterface<'static> {
        let glass = met_from_glass(finish, dir);
        let Incidence { index_from, index_to, .. } = glass.incidence;
        let (index_from, index_to) = (index_to, index_from);
        let incidence =
            Incidence { dir, normal: DVec3::NEG_Z, index_from, index_to, ..glass.incidence };
        MetInterface { incidence, facet: DVec3::NEG_Z, shading: DVec3::NEG_Z, ..glass }
    }

    fn at(met: MetInterface<'static>) -> ScatteringVertex<'static> {
        ScatteringVertex::at(DVec3::ZERO, met)
    }

    #[test]
    fn a_gather_path_and_the_photon_of_the_same_path_find_the_same_window() {
        let sin = 0.5f64;
        let inside = DVec3::new(sin, 0.0, -(1.0 - sin * sin).sqrt());
        let outside = DVec3::new(1.5 * sin, 0.0, -(1.0 - (1.5 * sin).powi(2)).sqrt());
        let mirrored = DVec3::new(inside.x, 0.0, -inside.z);
        for [before, after] in [[inside, outside], [inside, mirrored], [-outside, -inside]] {
            // The photon meets the face along `before`, the gather path along `-after`.
            let from = |dir: DVec3| {
                let own = if dir.z < 0.0 { met_from_glass } else { met_from_air };
                own(&Finish::Smooth, dir)
            };
            let [by_photon, by_path] = [before, -after].map(|dir| {
                let passage = PassedVertex::of_lobe(at(from(dir)), [before, after], Lobe::Specular);
                passage.window(WINDOW).at(3, 3)
            });
            assert!((by_photon / by_path - 1.0).abs() < 1e-12, "{by_photon}, {by_path}");
            // n² |cos θ| π r² 2π (1 - cos θ_max) / q
            let light = from(before).incidence;
            let side = if before.z * after.z < 0.0 { Side::Reflected } else { Side::Transmitted };
            let formula =
                light.index_from.powi(2) * light.cos() * WINDOW.area() * WINDOW.solid_angle()
                    / Finish::Smooth.chances(&light).of(side);
            assert!((by_photon / formula - 1.0).abs() < 1e-3, "{by_photon}, {formula}");
        }
    }

    #[test]
    fn scattered_light_has_records_at_every_vertex_up_to_d() {
        let light = [DVec3::new(0.6, 0.0, -0.8), DVec3::new(0.0, 0.8, -0.6)];
        let passage =
            PassedVertex::of_lobe(at(met_from_glass(&WHITE, light[0])), light, Lobe::Diffuse);
        let window = passage.window(WINDOW);
        // Transmitted, S/ϱ = 0.2/0.8 |cos θ|/π, into air: π r² π n² / 0.25.
        let expected = WINDOW.area() * PI / 0.25;
        assert!((window.at(0, 2) / expected - 1.0).abs() < 1e-12, "{window:?}, {expected}");
        assert_eq!([window.at(2, 2), window.at(3, 2)], [window.at(0, 2), 0.0]);
        let straight =
            PassedVertex::of_lobe(at(met_from_glass(&WHITE, light[0])), light, Lobe::Specular);
        assert_eq!(straight.window(WINDOW).at(0, 2), 0.0, "left at D alone");
    }

    #[test]
    fn both_ends_of_a_path_add_up_the_same_records() {
        let light = [DVec3::new(0.6, 0.0, -0.8), DVec3::new(0.0, 0.8, -0.6)];
        let passages: Vec<PassedVertex<'_>> =
            [Lobe::Diffuse, Lobe::Specular, Lobe::Specular, Lobe::Diffuse]
                .into_iter()
                .map(|lobe| {
                    PassedVertex::of_lobe(at(met_from_glass(&WHITE, light[0])), light, lobe)
                })
                .collect();
        for vertex_d in 0..5 {
            let places = RecordPlaces { window: WINDOW, vertex_d };
            let mut recent = RecentPassages::new(places);
            passages.iter().for_each(|&passage| recent.push(passage));
            let mut passed = PassedRecords::new(places);
            passages.iter().rev().for_each(|&passage| passed.push(|| passage));
            let [by_photon, by_path] = [recent.sum(None), passed.sum(None)];
            assert!((by_photon - by_path).abs() < 1e-12 * by_path, "{vertex_d}");
            // A pair at the second vertex from the sensor: one vertex before it, two beyond.
            let mut before = PassedRecords::new(places);
            before.push(|| passages[3]);
            let own = passages[2].window(WINDOW).at(1, vertex_d);
            let mut beyond = RecentPassages::new(places);
            passages[..2].iter().for_each(|&passage| beyond.push(passage));
            let beyond = beyond.windows();
            let beyond = beyond.iter().zip(2..).map(|(window, depth)| window.at(depth, vertex_d));
            let by_pair = before.sum(None) + own + beyond.sum::<f64>();
            assert!(
                (by_pair - by_path).abs() < 1e-12 * by_path,
                "{vertex_d}: {by_pair}, {by_path}"
            );
        }
    }
}
