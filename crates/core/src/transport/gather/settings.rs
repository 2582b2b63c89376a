//! Settings of the gather method: the user's values, and automatic values for the rest, from a few
//! pilot paths.

use crate::plan::{GatherPlan, RunPlan, Schedule};
use crate::scene::{Emitter, Scene, SensorId};
use crate::transport::Window;
use crate::transport::gather::sounding::{Reached, Sounded, sound};
use crate::transport::photon_pilot::{PASS_SEGMENTS, PhotonPilot};
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::tally::work;
use crate::transport::walk::emitters::invisible;
use lumiduct_base::number::format_exact;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, SQRT_2};
use std::fmt;

/// Passes of a wave, after which a run may end. Without spectra its photons meet the records of all of them.
pub(crate) const WAVE_PASSES: u64 = 4;
/// Radius of the first window over the inradius of the guide, 1 (measured on prototypes; docs/method.md).
const RADIUS_PER_INRADIUS: f64 = 0.3;
/// Largest radius as a share of the radius of the smallest source, 1.
const RADIUS_PER_SOURCE: f64 = 0.75;
/// A source of at least this share of the guide's inradius fills it, 1.
const FILLS: f64 = 0.8;
/// The automatic angle over the half-width of the narrowest source, and over the scatter of the walls, 1.
const THETA_PER_SOURCE: f64 = 0.75;
const THETA_PER_SCATTER: f64 = 1.5;
/// Bounds of the automatic angle, deg.
const THETA_DEG: [f64; 2] = [0.075, 4.5];
/// Bounds of the automatic depth.
const DEPTH: [f64; 2] = [1.0, 8.0];
/// Smallest number of photons of an automatic pass: in closed mirrors each has 100,000
/// segments.
const LEAST_PHOTONS: f64 = 32.0;
/// Work of a gather path with its records in segments of photon paths, looked up in the filter of records, as measured.
/// Limited by pairs, noise is least where photons and gather paths take equal work.
const RECORD_SEGMENTS: f64 = 30.0;
/// Most segments of photon paths in an automatic pass: the records of a wave take some 100 MB in every thread.
const MOST_PASS_SEGMENTS: f64 = 2e6;
/// Passes into which a run of known length is divided: enough for an error bar even if they take half as long again as
/// expected. Fewer and larger passes contain more pairs.
const PASSES: f64 = 24.0;
/// Least passes for each thread in a run of limited time, so that threads end at about the same time.
const PASSES_PER_THREAD: usize = 2 * WAVE_PASSES as usize;

/// Windows are similar, and sensors gathered together, up to this ratio of radii and of angles to those of the first, 1.
const SIMILAR: f64 = SQRT_2;
/// Most groups of sensors: each group meets every photon.
const MOST_GROUPS: usize = 8;

/// Sensors that are gathered together, with windows that suit all of them.
#[derive(Debug, Clone)]
pub struct SensorGroup {
    /// The sensors, in their order.
    pub sensors: Vec<SensorId>,
    /// Their settings.
    pub settings: GatherSettings,
    /// The window of the first of them.
    first: Window,
}

/// Settings of the gather method for a group of sensors in a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GatherSettings {
    /// Vertex at which gather paths end, D; the first surface has depth 0.
    pub depth: u32,
    /// Window of the first stage.
    pub window: Window,
    /// Number of sensors that are gathered in the run.
    pub all_sensors: u64,
    /// Gather paths from each sensor in a pass of the first stage.
    pub gather_paths: u64,
    /// Photons in a pass.
    pub photons: u64,
    /// How the window shrinks.
    pub schedule: Schedule,
}

impl GatherSettings {
    /// Photons of a pass of the first stage, and its gather paths from all sensors of the run.
    pub fn pass_size(&self) -> [u64; 2] {
        [self.photons, self.gather_paths * self.all_sensors]
    }

    /// The same with smaller passes, where the plan leaves their size open.
    pub(crate) fn with_passes_of_size(self, factor: f64, plan: &GatherPlan) -> Self {
        let scaled = |count: u64, given: Option<u64>| match given {
            Some(_) => count,
            None => ((factor * count as f64) as u64).max(1),
        };
        Self {
            photons: scaled(self.photons, plan.photons),
            gather_paths: scaled(self.gather_paths, plan.records),
            ..self
        }
    }
}

impl fmt::Display for GatherSettings {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { depth, window, gather_paths, photons, schedule, all_sensors: _ } = self;
        let schedule = match schedule {
            Schedule::Stages => "shrinking in stages",
            Schedule::Fixed => "of fixed size",
        };
        write!(
            out,
            "depth {depth}, windows from {} mm and {} deg {schedule}, {photons} photons and {gather_paths} gather \
             paths from each sensor in the first passes",
            format_exact(window.radius),
            format_exact(window.theta_max.to_degrees())
        )
    }
}

/// Passes, one after the other on each thread, into which a run of limited time is divided.
pub(crate) fn passes_in_turn() -> f64 {
    let threads = rayon::current_num_threads();
    PASSES.max((PASSES_PER_THREAD * threads) as f64) / threads as f64
}

impl PhotonPilot {
    /// The same, with passes sized for a run of known length: by its number of paths, and by its time, which allows
    /// `by_time` ns of work in a pass.
    pub(crate) fn with_passes_for(self, plan: &RunPlan, by_time: Option<f64>) -> Self {
        let by_paths = plan.stop.paths.map(|paths| {
            let passes = plan.stop.batches.map_or(PASSES, |batches| batches as f64);
            let segments = self.segments_past_records(self.depth(&plan.gather));
            let gather_paths = segments / RECORD_SEGMENTS;
            paths as f64 / passes / (1.0 + gather_paths) * segments
        });
        let segments = by_time.map(|work| work / work::OF_PHOTON_SEGMENT);
        let known = segments.into_iter().chain(by_paths).reduce(f64::min);
        known.map_or(self, |segments| Self {
            pass_segments: segments.min(MOST_PASS_SEGMENTS),
            pass_work: by_time,
            ..self
        })
    }

    /// The depth of gather paths.
    fn depth(self, plan: &GatherPlan) -> u32 {
        // A third of the surfaces that a photon meets.
        let automatic = ((self.steps_per_path - 1.0) / 3.0).clamp(DEPTH[0], DEPTH[1]);
        plan.depth.unwrap_or(automatic as u32)
    }

    /// Segments of a photon path beside records at this depth. It goes step by step near them, for about as many bounces as a
    /// gather path has.
    pub(super) fn segments_past_records(self, depth: u32) -> f64 {
        self.steps_per_path.min(self.segments_per_path + f64::from(depth))
    }

    /// Photons of an automatic pass, with this many segments each.
    fn photons(self, segments: f64) -> u64 {
        let least = LEAST_PHOTONS * self.pass_segments / PASS_SEGMENTS;
        (self.pass_segments / segments).max(least).max(1.0).ceil() as u64
    }
}

/// Groups of some sensors by their windows, out of all that are gathered in the run; `None` if stopped.
pub fn groups(
    scene: &Scene,
    plan: &RunPlan,
    (sensors, all_sensors): (&[SensorId], usize),
    pilot: PhotonPilot,
    signal: &StopSignal,
) -> Option<Vec<SensorGroup>> {
    let (seed, plan) = (plan.seed, &plan.gather);
    let depth = pilot.depth(plan);
    let segments = pilot.segments_past_records(depth);
    let photons = plan.photons.unwrap_or_else(|| pilot.photons(segments));
    let share = photons as f64 * segments / RECORD_SEGMENTS;
    let all_sensors = all_sensors.max(1) as u64;
    let gather_paths = plan.records.unwrap_or(share.ceil() as u64).div_ceil(all_sensors);
    let pace = Pace::new(signal);
    let reached = Reached::new(scene, seed, &pace)?;
    let mut groups: Vec<SensorGroup> = Vec::new();
    for &sensor in sensors {
        let sounded = sound(scene, sensor, &reached, (seed, depth), &pace)?;
        let own = automatic_window(scene, &sounded);
        let window = Window {
            radius: plan.radius_mm.unwrap_or(own.radius),
            theta_max: plan.angle_deg.map_or(own.theta_max, f64::to_radians),
        };
        let places = (0..groups.len()).map(|place| (groups[place].log_ratio(window), place));
        let nearest = places.min_by(|(a, _), (b, _)| a.total_cmp(b));
        match nearest {
            Some((log_ratio, place))
                if log_ratio <= SIMILAR.ln() || groups.len() == MOST_GROUPS =>
            {
                groups[place].add(sensor, window);
            }
            Some(_) | None => groups.push(SensorGroup {
                sensors: vec![sensor],
                settings: GatherSettings {
                    depth,
                    window,
                    all_sensors,
                    gather_paths: gather_paths.max(1),
                    photons,
                    schedule: plan.schedule.unwrap_or_default(),
                },
                first: window,
            }),
        }
    }
    Some(groups)
}

impl SensorGroup {
    /// The larger ratio of radii and angles, as a logarithm, between its first window and another.
    fn log_ratio(&self, window: Window) -> f64 {
        let own = self.first;
        let ratio = |one: f64, other: f64| (one / other).ln().abs();
        ratio(own.radius, window.radius).max(ratio(own.theta_max, window.theta_max))
    }

    /// Adds a sensor; the smaller window suits both.
    fn add(&mut self, sensor: SensorId, window: Window) {
        self.sensors.push(sensor);
        let own = &mut self.settings.window;
        own.radius = own.radius.min(window.radius);
        own.theta_max = own.theta_max.min(window.theta_max);
    }
}

/// The window for what a sensor's pilot found.
fn automatic_window(scene: &Scene, sounded: &Sounded) -> Window {
    let Sounded { inradius, index, scatter, to_aperture, from_sources } = sounded;
    let lit = || {
        let sources = scene.sources.iter().zip(from_sources);
        sources
            .filter(|(source, _)| source.is_lit())
            .filter_map(|(source, distance)| Some((source, (*distance)?)))
    };
    // Points, and lines along an axis, have no width.
    let half_widths = lit().map(|(source, _)| half_width(&source.emitter));
    let smallest = half_widths.filter(|width| *width > 0.0).fold(f64::INFINITY, f64::min);
    // A source that fills the guide is as wide as its emission: the images of its rim in the walls
    // join. A smaller one is seen from the records at its distance.
    let seen_by_paths = lit().filter(|(source, _)| invisible(source, scene).is_none());
    let widths = seen_by_paths.map(|(source, distance)| {
        let radius = half_width(&source.emitter);
        let seen = if radius < FILLS * inradius { radius / distance } else { 0.5 * PI };
        source.emission.half_angle().map_or(seen, |own| own.min(seen))
    });
    let narrowest = widths.fold(PI, f64::min);
    let [least, most] = THETA_DEG.map(f64::to_radians);
    // Refraction narrows light that enters a denser medium.
    let by_source = THETA_PER_SOURCE * narrowest / index;
    let theta = by_source.max(THETA_PER_SCATTER * scatter).min(*to_aperture);
    Window {
        radius: (RADIUS_PER_INRADIUS * inradius).min(RADIUS_PER_SOURCE * smallest),
        theta_max: theta.clamp(least, most),
    }
}

/// Half of the width of a source, mm: for a flat one, of the shorter side; for a round one, the
/// radius.
fn half_width(emitter: &Emitter) -> f64 {
    let bounds = emitter.bounds();
    let mut extents = (bounds.max - bounds.min).to_array();
    extents.sort_by(f64::total_cmp);
    let [_, middle, _] = extents;
    0.5 * middle
}
