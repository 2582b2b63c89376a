//! A scene from its text, run by each estimator, and comparisons of its measures.

use crate::traced;
use lumiduct_core::measure::{self, Measure, Measures, Status};
use lumiduct_core::plan::{GatherPlan, Request};
use lumiduct_core::transport::{Findings, Run};
use lumiduct_input::{Job, Settings};
use std::fmt::Write;

/// Deviation that passes, in standard errors of both sides together.
pub(crate) const SIGMAS: f64 = 4.0;
/// Largest part of a reported bias that passes in addition, relative to the expected value.
const MOST_BIAS: f64 = 0.05;
/// Largest relative standard error of a flux whose mean number of bounces is compared. Rare paths of
/// many bounces are the tail of that mean: a run that hardly meets them cannot know their scatter.
const MOST_NOISE_OF_BOUNCES: f64 = 0.05;
/// Photon paths of a forward run.
const PHOTONS: u64 = 150_000;
/// Waves of 4 passes of a gather run: 64 passes, so that errors are known to a tenth.
const GATHER_WAVES: u64 = 16;
const SEED: u64 = 3;

/// A window and the work of a gather run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gathering {
    pub(crate) depth: u32,
    pub(crate) radius_mm: f64,
    pub(crate) angle_deg: f64,
    /// Gather paths of a pass.
    pub(crate) records: u64,
    /// Photons of a pass.
    pub(crate) photons: u64,
}

impl Gathering {
    /// A usual window for guides of some millimetres.
    pub(crate) const fn to_depth(depth: u32) -> Self {
        match depth {
            0 => Self { depth, radius_mm: 0.9, angle_deg: 7.0, records: 600, photons: 3000 },
            _ => Self { depth, radius_mm: 0.6, angle_deg: 5.0, records: 600, photons: 2000 },
        }
    }

    fn settings(self) -> GatherPlan {
        GatherPlan {
            depth: Some(self.depth),
            radius_mm: Some(self.radius_mm),
            angle_deg: Some(self.angle_deg),
            records: Some(self.records),
            photons: Some(self.photons),
            schedule: None,
        }
    }
}

/// How a run is made.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Way {
    Forward,
    Backward,
    /// Both of these, mixed.
    Mixed,
    Gather(Gathering),
    /// All three, merged.
    Merged(Gathering),
}

impl Way {
    fn settings(self) -> Settings {
        let usual = Settings { seed: Some(SEED), ..Settings::default() };
        match self {
            Self::Forward => {
                Settings { estimator: Some(Request::Forward), paths: Some(PHOTONS), ..usual }
            }
            Self::Backward => Settings { estimator: Some(Request::Backward), ..usual },
            // A different seed from the run it is compared with.
            Self::Mixed => {
                Settings { estimator: Some(Request::Mix), seed: Some(SEED + 1), ..usual }
            }
            Self::Gather(gathering) => {
                let gather = gathering.settings();
                Settings { estimator: Some(Request::Gather), gather, ..usual }
            }
            Self::Merged(gathering) => {
                let gather = gathering.settings();
                Settings { estimator: Some(Request::Mis), gather, ..usual }
            }
        }
    }

    fn waves(self) -> u64 {
        match self {
            Self::Forward | Self::Backward | Self::Mixed => 1,
            Self::Gather(_) | Self::Merged(_) => GATHER_WAVES,
        }
    }

    /// For lines of tests.
    pub(crate) fn name(self) -> String {
        match self {
            Self::Forward => "forward".to_owned(),
            Self::Backward => "backward".to_owned(),
            Self::Mixed => "mix".to_owned(),
            Self::Gather(gathering) => format!("gather D={}", gathering.depth),
            Self::Merged(gathering) => format!("mis D={}", gathering.depth),
        }
    }
}

/// A scene from its text without the head.
pub(crate) fn load(text: &str, way: Way) -> Job {
    traced::load(text, &way.settings())
}

/// All findings of a run.
pub(crate) fn findings(job: &Job, way: Way) -> Findings {
    let mut run = Run::new(&job.scene, &job.run);
    for _ in 0..way.waves() {
        run.next_wave();
    }
    run.findings()
}

/// The same on one thread, for tests run in parallel; backward and mixed get half a wave, of 64
/// batches.
fn findings_alone(job: &Job, way: Way) -> Findings {
    const PIECES: usize = 16;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| match way {
        Way::Forward | Way::Gather(_) | Way::Merged(_) => findings(job, way),
        Way::Backward | Way::Mixed => {
            let mut run = Run::new(&job.scene, &job.run);
            (0..PIECES).for_each(|_| run.next_piece());
            run.findings()
        }
    })
}

/// All measures of a run.
pub(crate) fn measures(text: &str, way: Way) -> Measures {
    let job = load(text, way);
    let findings = findings_alone(&job, way);
    measure::measure(&job.scene, &findings)
}

/// All measures of a run of a number of paths.
pub(crate) fn measures_of_paths(text: &str, way: Way, paths: u64) -> Measures {
    let job = traced::load(text, &Settings { paths: Some(paths), ..way.settings() });
    let mut run = Run::new(&job.scene, &job.run);
    while !run.is_complete() {
        run.next_wave();
    }
    measure::measure(&job.scene, &run.findings())
}

/// What may pass beyond noise: the reported bias of a measure, up to a share of its expected value.
pub(crate) fn bias_allowance(found: &Measure, expected: f64) -> f64 {
    found.bias.unwrap_or(0.0).min(MOST_BIAS * expected.abs())
}

/// Lines of a comparison, and those of them that fail.
#[derive(Debug, Default)]
pub(crate) struct Comparison {
    text: String,
    failed: Vec<String>,
    compared: usize,
    /// Largest deviation, in standard errors; for what needs no bias allowance.
    largest: f64,
    /// Values that need a bias allowance, and the largest that was needed, relative to the value.
    biased: usize,
    largest_bias: f64,
}

impl Comparison {
    /// Compares a value with an expected one and its error.
    pub(crate) fn add(&mut self, what: &str, found: &Measure, expected: f64, error: f64) {
        self.add_biased(what, found, [expected, error], bias_allowance(found, expected));
    }

    /// The same with a bias allowance.
    fn add_biased(&mut self, what: &str, found: &Measure, [expected, error]: [f64; 2], bias: f64) {
        // The variance of a sum of few weights goes with its mean: a run that has met too few of them
        // finds too little light and too small an error, so its error is that at the expected value.
        let few = if found.value > 0.0 { (expected / found.value).max(1.0).sqrt() } else { 1.0 };
        let noise = (few * found.std_error).hypot(error);
        let off = found.value - expected;
        let needed = (off.abs() - SIGMAS * noise).max(0.0);
        let [off_share, bias_share, needed_share] =
            [off, bias, needed].map(|part| 100.0 * part / expected.abs());
        let Measure { value, std_error, unit, .. } = found;
        let line = format!(
            "{what}: {value:.6} ± {std_error:.1e} {unit}, expected {expected:.6} ± {error:.1e}, off by {off_share:+.2} % \
             or {:+.2} sigmas, bias allowance {bias_share:.2} %, of which {needed_share:.2} % are needed",
            off / noise
        );
        self.compared += 1;
        if needed > 0.0 {
            self.biased += 1;
            self.largest_bias = self.largest_bias.max(needed / expected.abs());
        } else {
            self.largest = self.largest.max(off.abs() / noise);
        }
        writeln!(self.text, "{line}").unwrap();
        // What is no number or has no error bar fails.
        if !noise.is_finite() || off.is_nan() || needed > bias {
            self.failed.push(line);
        }
    }

    /// Fails a comparison.
    pub(crate) fn fail(&mut self, line: String) {
        self.failed.push(line);
    }

    /// Asserts that everything agreed, and that there were at least `least` values.
    pub(crate) fn assert(self, what: &str, least: usize) {
        println!(
            "{}{what}: {} values, largest {:.2} sigmas; {} need a bias allowance, {:.2} % at most",
            self.text,
            self.compared,
            self.largest,
            self.biased,
            100.0 * self.largest_bias
        );
        assert!(self.failed.is_empty(), "{what}:\n{}", self.failed.join("\n"));
        assert!(self.compared >= least, "{what}: only {} values", self.compared);
    }
}

/// Whether a measure is a sum, a mean or the colour of light, which every estimator gives without additional
/// bias.
fn is_plain(name: &str) -> bool {
    let Some((sensor, rest)) = name.split_once('.') else { return false };
    let rest = rest.split('.').next().unwrap_or(rest);
    sensor != "balance"
        && [
            "flux",
            "radiant_flux",
            "colour_x",
            "colour_y",
            "cell",
            "ring",
            "luminance_avg",
            "bounces_mean",
        ]
        .contains(&rest)
}

fn is_dark(measure: &Measure) -> bool {
    measure.status == Status::NoSignal
}

/// The sensor of a mean number of bounces.
fn bounces_of(name: &str) -> Option<&str> {
    name.strip_suffix(".bounces_mean")
}

/// Whether a run has counted enough light of a sensor to know its mean number of bounces.
fn knows_bounces(measures: &Measures, sensor: &str) -> bool {
    let [flux, mean] =
        ["flux", "bounces_mean"].map(|name| &measures.values[&format!("{sensor}.{name}")]);
    !is_dark(flux)
        && flux.std_error < MOST_NOISE_OF_BOUNCES * flux.value
        && mean.status != Status::TooFew
}

/// Where the bias of a mean number of bounces is not resolved, that which is reported is no bound:
/// a window lets in trapped light, of many bounces and hardly any flux.
fn allowance(name: &str, found: &Measure, expected: f64) -> f64 {
    let is_unresolved = matches!(found.status, Status::BiasInNoise | Status::BiasNotResolved);
    if is_unresolved && bounces_of(name).is_some() {
        return MOST_BIAS * expected;
    }
    bias_allowance(found, expected)
}

/// Compares the values of each way with those of the first.
pub(crate) fn agree(what: &str, text: &str, ways: &[Way]) {
    let mut comparison = Comparison::default();
    let (first, others) = ways.split_first().unwrap();
    let expected = measures(text, *first);
    for &way in others {
        let found = measures(text, way);
        for (name, measure) in found.values.iter().filter(|(name, _)| is_plain(name)) {
            let reference = &expected.values[name.as_str()];
            let is_known =
                |sensor| [&expected, &found].iter().all(|run| knows_bounces(run, sensor));
            if is_dark(measure) && is_dark(reference) || !bounces_of(name).is_none_or(is_known) {
                continue;
            }
            let what = format!("{what}, {}, {name}", way.name());
            let bias = allowance(name, measure, reference.value);
            let expected = [reference.value, reference.total_error()];
            comparison.add_biased(&what, measure, expected, bias);
        }
    }
    comparison.assert(what, others.len());
}

/// All estimators, forward first.
const SHALLOW: [Way; 6] = [
    Way::Forward,
    Way::Backward,
    Way::Mixed,
    Way::Gather(Gathering::to_depth(0)),
    Way::Gather(Gathering::to_depth(2)),
    Way::Merged(Gathering { records: 200, photons: 1000, ..Gathering::to_depth(1) }),
];

/// Forward, backward, mixed, gathered at depths 0, 2 and 8, and merged.
pub(crate) fn all_agree(what: &str, text: &str) {
    let deep = Way::Gather(Gathering::to_depth(8));
    agree(what, text, &[&SHALLOW[..], &[deep]].concat());
}

/// The same without the deepest, for scenes where light meets few surfaces.
pub(crate) fn shallow_agree(what: &str, text: &str) {
    agree(what, text, &SHALLOW);
}

/// The same with a window of half the size at depth 0, for dark cells beside bright ones. A wider window spills light into
/// them; the stated bias covers it, but here bias is allowed only as a share of the expected value, which is 0.
pub(crate) fn shallow_agree_beside_dark(what: &str, text: &str) {
    let narrow =
        Gathering { depth: 0, radius_mm: 0.45, angle_deg: 3.5, records: 3000, photons: 6000 };
    shallow_agree_gathering(what, text, narrow);
}

/// The same with other gathering at its depth.
pub(crate) fn shallow_agree_gathering(what: &str, text: &str, own: Gathering) {
    let ways = SHALLOW.map(|way| match way {
        Way::Gather(usual) if usual.depth == own.depth => Way::Gather(own),
        way => way,
    });
    agree(what, text, &ways);
}
