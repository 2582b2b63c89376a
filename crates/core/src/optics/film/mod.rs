//! Prism film: flat on one face, with parallel prisms on the other, thin compared with everything
//! around it.
//!
//! Light that meets it is traced through one period from a position drawn evenly over it, and
//! leaves where it arrived: a film of any size costs no memory. All faces contain the direction of
//! the prisms, so refraction keeps the angle of light to them: a duct lined with film guides light
//! that is close enough to its axis. For prisms of 90 degrees that is sin θ < tan(π/8) sqrt(n² - 1)
//! at every azimuth (docs/theory.md, eq. 4a; Whitehead, Nodwell & Curzon, Applied Optics 21 (1982)
//! 2755, describe the guide). That formula is not used here; the model uses Snell, Fresnel for
//! unpolarised light and total reflection at flat facets. Shifts of a pitch or two along the film
//! are neglected.

mod cell;
mod survey;

pub use survey::{acceptance_angle, along_prisms};

use crate::optics::{Incidence, Scattered, Shares, Side};
use crate::rng::{Dimension, Numbers, Sampler};
use cell::{After, Cell, CellStep, Exit, FilmIndices};
use glam::{DVec2, DVec3};

/// Steps after which light is treated as absorbed: only light that rounding has trapped between
/// faces takes this many.
const MOST_STEPS: usize = 100_000;
/// Steps after which light that has not returned to the flat face, or only under total reflection,
/// is treated as trapped.
const PASSAGE: usize = 1000;
/// Share of the arriving flux below which a branch plays roulette; survivors continue with this
/// share, 1.
const LEAST_SHARE: f64 = 1e-4;

/// A film with prisms, as specified by its maker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmMake {
    /// Refractive index, 1.
    pub index: f64,
    /// Angle between the two facets at the tip of a prism, rad.
    pub prism_angle: f64,
    /// Distance from tip to tip, mm.
    pub pitch: f64,
    /// Thickness between the flat face and the valleys, mm.
    pub base: f64,
    /// Absorption coefficient (natural logarithm), 1/mm.
    pub absorption: f64,
    /// Share of the facets that is rounded, half at tips and half in valleys; light that meets it
    /// is lost. 1.
    pub rounded: f64,
    /// Direction of the prisms.
    pub run: Grain,
}

/// Direction of a structure on a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grain {
    /// Along the grain of [`Incidence`].
    Along,
    /// Across it.
    Around,
}

/// A face of a film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilmFace {
    /// The flat face.
    Flat,
    /// The face with prisms.
    Prisms,
}

impl FilmFace {
    /// The other face.
    pub(crate) fn opposite(self) -> Self {
        match self {
            Self::Flat => Self::Prisms,
            Self::Prisms => Self::Flat,
        }
    }
}

/// A prism film, ready to be traced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrismFilm {
    cell: Cell,
    index: f64,
    /// Absorption coefficient, 1/pitch.
    absorption: f64,
    run: Grain,
}

/// Direction of arriving light, in the frame of the film's cell.
struct Approach {
    /// Across the prisms, from the flat face into the film, and along the prisms.
    axes: [DVec3; 3],
    dir: DVec3,
    indices: FilmIndices,
}

impl PrismFilm {
    /// The film of a specification.
    pub fn new(make: &FilmMake) -> Self {
        let (sin, cos) = (0.5 * make.prism_angle).sin_cos();
        let base = make.base / make.pitch;
        let cell = Cell {
            base,
            top: base + 0.5 * cos / sin,
            facet: DVec2::new(-cos, sin),
            rounded: make.rounded,
        };
        let absorption = make.absorption * make.pitch;
        Self { cell, index: make.index, absorption, run: make.run }
    }

    /// Sends on light that meets one of the faces, or absorbs it (`None`). The directions are
    /// discrete, and one of them is chosen at random.
    pub(crate) fn scatter(
        &self,
        face: FilmFace,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let approach = self.approach(face, incidence);
        let x = sampler.one(Dimension::Scatter);
        let mut state = match face {
            FilmFace::Prisms => self.cell.enter_prisms(x, approach.dir),
            FilmFace::Flat => {
                let (reflectance, dir, state) =
                    self.cell.enter_flat(x, approach.dir, &approach.indices);
                if is_reflected(reflectance, sampler) {
                    let back = Exit { dir, way: 0.0 };
                    return Some(self.leave(&approach, face, FilmFace::Flat, &back));
                }
                state
            }
        };
        for _ in 0..MOST_STEPS {
            state = match self.cell.step(&state, &approach.indices) {
                CellStep::Lost => return None,
                CellStep::Out(exit) => {
                    return Some(self.leave(&approach, face, FilmFace::Prisms, &exit));
                }
                CellStep::Met { reflectance, reflected, refracted } => match refracted {
                    Some(after) if !is_reflected(reflectance, sampler) => match after {
                        After::Inside(next) => next,
                        After::Out(exit) => {
                            return Some(self.leave(&approach, face, FilmFace::Flat, &exit));
                        }
                    },
                    Some(_) | None => reflected,
                },
            };
        }
        None
    }

    /// Shares of light that meets one of the faces evenly: the mean over `places` positions in the
    /// period, at each of which light is split at every interface and weak branches play roulette.
    /// Two positions are far enough apart for a tip or valley to lie between them.
    pub fn shares(&self, face: FilmFace, incidence: &Incidence, places: u32) -> Shares {
        let approach = self.approach(face, incidence);
        // Always the same numbers: a share is not a random quantity.
        let mut sampler = Sampler::for_path(0, 0, 0);
        let mut sums = [0.0; 2];
        for place in 0..places {
            let x = middle(place, places);
            self.split_from(face, x, &approach, &mut sampler, |through, exit, share| {
                sums[usize::from(through != face)] += share * self.transmittance(exit.way);
            });
        }
        let [reflected, transmitted] = sums.map(|sum| sum / f64::from(places));
        Shares { reflected, transmitted }
    }

    /// The same film without its rounded edges.
    fn with_sharp_edges(&self) -> Self {
        Self { cell: Cell { rounded: 0.0, ..self.cell }, ..*self }
    }

    /// Whether some light that enters the flat face evenly is not totally reflected before it
    /// returns there, as far as this many positions show.
    fn leaks(&self, incidence: &Incidence, places: u32) -> bool {
        let Approach { dir, indices, .. } = self.approach(FilmFace::Flat, incidence);
        (0..places).any(|place| {
            let (reflectance, _, mut state) =
                self.cell.enter_flat(middle(place, places), dir, &indices);
            if reflectance >= 1.0 {
                return false;
            }
            for _ in 0..PASSAGE {
                state = match self.cell.step(&state, &indices) {
                    CellStep::Met { reflected, refracted: None, .. } => reflected,
                    CellStep::Met { refracted: Some(After::Out(_)), .. } => return false,
                    CellStep::Met { .. } | CellStep::Lost | CellStep::Out(_) => return true,
                };
            }
            // Light that rounding has trapped has not leaked.
            false
        })
    }

    /// Follows the branches of light from one position: the face through which each leaves, its
    /// direction, and its share before absorption.
    fn split_from(
        &self,
        face: FilmFace,
        x: f64,
        approach: &Approach,
        sampler: &mut Sampler,
        mut leave: impl FnMut(FilmFace, &Exit, f64),
    ) {
        let mut waiting = Vec::new();
        match face {
            FilmFace::Prisms => waiting.push((self.cell.enter_prisms(x, approach.dir), 1.0)),
            FilmFace::Flat => {
                let (reflectance, dir, state) =
                    self.cell.enter_flat(x, approach.dir, &approach.indices);
                leave(FilmFace::Flat, &Exit { dir, way: 0.0 }, reflectance);
                waiting.push((state, 1.0 - reflectance));
            }
        }
        for _ in 0..MOST_STEPS {
            let Some((state, share)) = waiting.pop() else { return };
            let goes_on =
                share >= LEAST_SHARE || sampler.one(Dimension::Roulette) * LEAST_SHARE < share;
            if !goes_on {
                continue;
            }
            let share = share.max(LEAST_SHARE);
            match self.cell.step(&state, &approach.indices) {
                CellStep::Lost => {}
                CellStep::Out(exit) => leave(FilmFace::Prisms, &exit, share),
                CellStep::Met { reflectance, reflected, refracted } => {
                    let refracted_share = (1.0 - reflectance) * share;
                    match refracted {
                        Some(After::Inside(next)) => waiting.push((next, refracted_share)),
                        Some(After::Out(exit)) => leave(FilmFace::Flat, &exit, refracted_share),
                        None => {}
                    }
                    waiting.push((reflected, reflectance * share));
                }
            }
        }
    }

    /// Light that arrived at one face and leaves through the other or the same one.
    fn leave(
        &self,
        approach: &Approach,
        arrived: FilmFace,
        through: FilmFace,
        exit: &Exit,
    ) -> Scattered {
        let [x, y, w] = approach.axes;
        let dir = exit.dir.x * x + exit.dir.y * y + exit.dir.z * w;
        let side = if through == arrived { Side::Reflected } else { Side::Transmitted };
        Scattered::specular(dir, self.transmittance(exit.way), side)
    }

    fn approach(&self, face: FilmFace, incidence: &Incidence) -> Approach {
        let Incidence { dir, normal, index_from, index_to, grain, .. } = *incidence;
        let (into, flat, prisms) = match face {
            FilmFace::Flat => (-normal, index_from, index_to),
            FilmFace::Prisms => (normal, index_to, index_from),
        };
        let along = match self.run {
            Grain::Along => grain,
            Grain::Around => grain.cross(normal),
        };
        let axes = [along.cross(into), into, along];
        Approach {
            axes,
            dir: DVec3::from_array(axes.map(|axis| dir.dot(axis))),
            indices: FilmIndices { flat, film: self.index, prisms },
        }
    }

    /// Beer and Lambert, over a path length in pitches.
    fn transmittance(&self, length: f64) -> f64 {
        if self.absorption == 0.0 { 1.0 } else { (-self.absorption * length).exp() }
    }
}

/// The middle of a position interval in the period, pitches.
fn middle(place: u32, places: u32) -> f64 {
    (f64::from(place) + 0.5) / f64::from(places)
}

/// One draw; none where only one outcome is possible.
fn is_reflected(reflectance: f64, sampler: &mut Sampler<impl Numbers>) -> bool {
    reflectance > 0.0 && sampler.one(Dimension::Lobe) < reflectance
}

#[cfg(test)]
mod tests;
