//! Metropolis light transport in primary sample space, on gather paths.
//!
//! Veach & Guibas, Metropolis Light Transport, SIGGRAPH 1997; Kelemen et al. 2002 (see
//! [`crate::primary`]). A chain varies the random numbers of a gather path and visits paths in
//! proportion to the flux they carry, I. This gives the distribution of light but not its amount:
//! the mean of I over independent paths, b, scales it to flux. Proposal and state both count,
//! weighted by the acceptance probability. Every batch is a separate chain with its own b: the flux
//! on the sensor is unbiased, its distribution over cells only in the limit of long chains.

use crate::one_sensor::OneSensor;
use crate::primary::{Mutation, Primary};
use lumiduct_core::rng::{Numbers, Sampler, stream};
use lumiduct_core::transport::tally::sensor_reading::DetectedLight;
use lumiduct_core::transport::walk::follow::follow;
use lumiduct_core::transport::{Event, Observer, Path, Readings};
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// Probability of a large step, 1.
const LARGE_STEPS: f64 = 0.3;
/// Share of the paths of a chain among which its first state is chosen, 1.
const START: f64 = 0.1;

/// What all chains of a run have in common.
#[derive(Debug)]
pub(super) struct Metropolis<'s> {
    sensor: OneSensor<'s>,
    /// Paths of a chain.
    paths: u64,
}

impl<'s> Metropolis<'s> {
    pub(super) fn new(sensor: OneSensor<'s>) -> Self {
        Self { paths: sensor.batch_paths(), sensor }
    }

    /// Runs one chain.
    pub(super) fn chain(&self, batch: u64) -> Readings {
        let mut readings = self.sensor.empty(self.paths, batch);
        let own = Sampler::for_path(self.sensor.seed, stream::BASELINE_CHAINS, batch);
        let mut primary = Primary::new(own);
        let mut chain = Chain {
            metropolis: self,
            state: SeenLight::default(),
            fresh_flux: 0.0,
            fresh_paths: 0,
            weight: 0.0,
            readings: &mut readings,
        };
        let start = ((START * self.paths as f64) as u64).max(1);
        for _ in 0..start {
            chain.start(&mut primary);
        }
        for _ in start..self.paths {
            chain.step(&mut primary);
        }
        let b = chain.fresh_flux / chain.fresh_paths as f64;
        let scale = if chain.weight > 0.0 { b / chain.weight } else { 0.0 };
        let mut readings = readings.combined([scale, 0.0], &readings);
        readings.close_batch();
        readings
    }
}

/// The light that a path has collected.
#[derive(Debug, Default)]
struct SeenLight {
    cells: SmallVec<[usize; 1]>,
    lights: SmallVec<[DetectedLight; 2]>,
    /// All of it, I, lm or W.
    flux: f64,
    segments: u64,
}

struct Chain<'a, 's> {
    metropolis: &'a Metropolis<'s>,
    state: SeenLight,
    /// Sum of I over independent paths.
    fresh_flux: f64,
    fresh_paths: u64,
    /// Weight of all states that carry light.
    weight: f64,
    readings: &'a mut Readings,
}

impl Chain<'_, '_> {
    /// Chooses the first state among independent paths, in proportion to their flux.
    fn start(&mut self, primary: &mut Primary) {
        let proposal = self.propose(primary, Mutation::Large);
        let share = if proposal.flux > 0.0 { proposal.flux / self.fresh_flux } else { 0.0 };
        self.go_on(primary, proposal, share);
    }

    /// A step of the chain.
    fn step(&mut self, primary: &mut Primary) {
        let large = primary.decide() < LARGE_STEPS;
        let mutation = if large { Mutation::Large } else { Mutation::Small };
        let proposal = self.propose(primary, mutation);
        // A state without light always accepts the proposal.
        let is_lit = self.state.flux > 0.0;
        let acceptance = if is_lit { (proposal.flux / self.state.flux).min(1.0) } else { 1.0 };
        self.count(&proposal, acceptance);
        let state = std::mem::take(&mut self.state);
        self.count(&state, 1.0 - acceptance);
        self.state = state;
        self.go_on(primary, proposal, acceptance);
    }

    fn propose(&mut self, primary: &mut Primary, mutation: Mutation) -> SeenLight {
        primary.propose(mutation);
        let seen = self.metropolis.sensor.look(&mut Sampler::of(primary));
        self.readings.segments += seen.segments;
        if mutation == Mutation::Large {
            self.fresh_flux += seen.flux;
            self.fresh_paths += 1;
        }
        seen
    }

    fn go_on(&mut self, primary: &mut Primary, proposal: SeenLight, acceptance: f64) {
        if primary.decide() < acceptance {
            self.state = proposal;
        } else {
            primary.reject();
        }
    }

    fn count(&mut self, seen: &SeenLight, weight: f64) {
        if seen.flux == 0.0 {
            return;
        }
        self.weight += weight;
        for light in &seen.lights {
            let light = DetectedLight { flux: weight * light.flux / seen.flux, ..*light };
            self.metropolis.sensor.count(self.readings, &seen.cells, &light);
        }
    }
}

impl OneSensor<'_> {
    /// The light of the gather path that these random numbers generate.
    fn look(&self, sampler: &mut Sampler<impl Numbers>) -> SeenLight {
        let Some(arrival) = self.arrivals.draw(sampler) else { return SeenLight::default() };
        let mut looking = Looking { etendue: self.etendue(&arrival), seen: SeenLight::default() };
        let segments = follow(self.gathering(self.bounce_limit), &arrival, sampler, &mut looking);
        SeenLight { cells: arrival.cells, segments, ..looking.seen }
    }
}

/// Collects the light of one gather path.
struct Looking {
    /// Etendue of the path, mm² sr.
    etendue: f64,
    seen: SeenLight,
}

impl Observer for Looking {
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        let Event::Meet(met) = event else { return ControlFlow::Continue(()) };
        let flux = met.radiance * self.etendue;
        self.seen.flux += flux;
        self.seen.lights.push(DetectedLight {
            flux,
            depth: path.depth,
            source: met.source,
            wavelength: path.wavelength,
        });
        ControlFlow::Continue(())
    }
}
