//! The comparison of estimators: each in turn for the same time, several runs each, against a
//! truth.
//!
//! A run of an estimator is sampled at checkpoints, which does not count toward its time. The
//! report computes the errors from the samples.

mod bench;
mod method;
mod runner;
mod truth;
mod truth_file;

pub use method::Method;
pub use truth::TruthOption;

use crate::pipeline::compare::bench::Bench;
use crate::pipeline::compare::runner::{Stint, trace};
use crate::pipeline::compare::truth::Known;
use crate::pipeline::output::{Output, output_dir};
use crate::pipeline::sense::expect_sense;
use crate::pipeline::version::VERSION;
use lumiduct_base::error::{Diagnostic, Error, Result};
use lumiduct_baselines::Baseline;
use lumiduct_core::plan::Request;
use lumiduct_core::scene::SensorId;
use lumiduct_core::transport::{Activity, Interrupt, invisible, turbid_media};
use lumiduct_input::{self as input, Job, Settings};
use lumiduct_report::{self as report, Comparison, Contestant, Folder, FolderLock, Truth};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Refuses methods without first passages where the sensor counts only those.
fn expect_passages(job: &Job, sensor: SensorId, methods: &[Method]) -> Result<()> {
    let sensor = &job.scene.sensors[sensor.index()];
    let unable: Vec<&str> = methods
        .iter()
        .filter(|method| !method.knows_first_passages())
        .map(|method| method.name())
        .collect();
    if unable.is_empty() || !sensor.counts_first_passage() {
        return Ok(());
    }
    Err(Error::Usage(format!(
        "--estimators: {} cannot count first passages, as sensor `{}` does: leave them out, or set passage = \"every\"",
        unable.join(", "),
        sensor.name
    )))
}

/// What is to be compared, and for how long.
#[derive(Debug, Clone)]
pub struct CompareOptions {
    /// Name of the sensor; the only one if none is given.
    pub sensor: Option<String>,
    /// The methods, in the order of the table.
    pub methods: Vec<Method>,
    /// Time for each method, all of its runs together.
    pub time: Duration,
    /// Independent runs of each method, 2 at least.
    pub repetitions: u32,
    /// What they are compared with.
    pub truth: TruthOption,
}

/// A comparison that has been written.
#[derive(Debug)]
pub struct Compared {
    /// The table, for the terminal.
    pub text: String,
    /// Folder of the files.
    pub dir: PathBuf,
    /// Remarks on the scene file.
    pub warnings: Vec<Diagnostic>,
}

/// Checkpoints of a run: the last is its end, and each is this much later than the one before.
const CHECKPOINTS: i32 = 13;
const CHECKPOINT_RATIO: f64 = std::f64::consts::SQRT_2;

/// Compares methods on a sensor of a scene file and writes the results.
///
/// # Errors
///
/// [`Error::Input`] as [`input::load`] and if the scene cannot be traced. [`Error::Usage`] if the sensor is unknown
/// or ambiguous, a method cannot work on the scene, the light has a spectrum or its polarisation is followed, the truth is missing or unusable, the folder is not free, or a
/// run ends before anything is counted. [`Error::Output`] or [`Error::Io`] if the results cannot be composed or
/// written.
pub fn compare(
    scene: &Path,
    settings: &Settings,
    options: &CompareOptions,
    output: &Output,
    interrupt: &Interrupt,
    watch: &mut dyn FnMut(&str),
) -> Result<Compared> {
    // The gather settings of the file are used; its choice of estimator is not.
    let loading =
        Settings { estimator: Some(Request::Auto), time: Some(options.time), ..settings.clone() };
    let job = input::load(scene, &loading)?;
    expect_sense(&job)?;
    if job.scene.is_spectral() {
        let message = if job.scene.fluoresces() {
            "methods are compared without spectra, so not where media fluoresce"
        } else {
            "methods are compared without spectra; remove the key `spectrum` of the sources"
        };
        return Err(Error::Usage(message.into()));
    }
    if !job.scene.polarisation.is_ignored() {
        let message = "methods are compared without polarisation: leave out `run.polarisation`";
        return Err(Error::Usage(message.into()));
    }
    let id = sensor(&job, options.sensor.as_deref())?;
    let run_time = options.time.div_f64(f64::from(options.repetitions));
    let bench = Bench { id, job: &job, interrupt, run_time };
    expect_able(&job, &options.methods)?;
    expect_passages(&job, id, &options.methods)?;
    let known = truth::known(&bench, &options.truth)?;
    let lock = FolderLock::take(&dir_of(scene, output))?;
    let folder = Folder::open(lock, output.existing, None)?;
    let truth = match known {
        Known::Truth(truth) => truth,
        Known::Takes(time) => truth::find(&bench, options.repetitions, time, watch)?,
    };
    let mut contestants = Vec::new();
    for &method in &options.methods {
        contestants.push(contestant(&bench, method, (options.repetitions, &truth), watch)?);
    }
    let comparison = Comparison {
        title: job.title.clone(),
        scene: scene_words(&job),
        program: format!(
            "lumiduct {VERSION}, seed {}, {} threads",
            job.run.seed,
            rayon::current_num_threads()
        ),
        sensor: bench.sensor().to_owned(),
        cells: bench.cells(),
        measure: bench.measure(),
        unit: job.scene.unit.flux().to_owned(),
        truth,
        repetitions: options.repetitions,
        run_time: run_time.as_secs_f64(),
        contestants,
    };
    let files = report::comparison_files(&comparison)?;
    interrupt.begin(Activity::Writing);
    folder.write(&files)?;
    let text = format!(
        "{}\n{}: {}\n",
        report::comparison_table(&comparison),
        comparison.measure,
        folder.path().display()
    );
    Ok(Compared { text, dir: folder.path().to_path_buf(), warnings: job.warnings })
}

/// All runs of a method.
fn contestant(
    bench: &Bench<'_>,
    method: Method,
    (repetitions, truth): (u32, &Truth),
    watch: &mut dyn FnMut(&str),
) -> Result<Contestant> {
    let end = bench.run_time.as_secs_f64();
    let checkpoints: Vec<Duration> = (0..CHECKPOINTS)
        .map(|place| Duration::from_secs_f64(end / CHECKPOINT_RATIO.powi(CHECKPOINTS - 1 - place)))
        .collect();
    let (mut runs, mut cut) = (Vec::new(), 0.0);
    for run in 0..repetitions {
        watch(&format!("{}: run {} of {repetitions}", method.name(), run + 1));
        let cells = truth.cells.as_ref();
        let stint = Stint { method, run: u64::from(run), checkpoints: &checkpoints, cells };
        let traced = trace(bench, &stint)?;
        cut += traced.cut / f64::from(repetitions);
        runs.push(traced.samples);
    }
    let (name, label) = (method.name().to_owned(), method.label());
    Ok(Contestant { name, label, origin: method.origin(), runs, cut })
}

/// The sensor of this name, or the only one.
fn sensor(job: &Job, name: Option<&str>) -> Result<SensorId> {
    let names: Vec<&str> = job.scene.sensors.iter().map(|sensor| sensor.name.as_str()).collect();
    let all = names.join(", ");
    let place = match (name, names.len()) {
        (_, 0) => return Err(Error::Usage("the scene has no sensor to compare on".into())),
        (Some(name), _) => names.iter().position(|known| *known == name).ok_or_else(|| {
            Error::Usage(format!("--sensor: there is no sensor `{name}`; the sensors are: {all}"))
        })?,
        (None, 1) => 0,
        (None, _) => {
            let message = format!("the scene has several sensors; name one with --sensor: {all}");
            return Err(Error::Usage(message));
        }
    };
    Ok(SensorId::new(place))
}

/// Refuses methods that cannot meet a source, or gather in media.
fn expect_able(job: &Job, methods: &[Method]) -> Result<()> {
    let unseen = job.scene.sources.iter().find_map(|source| {
        invisible(source, &job.scene).map(|why| format!("the source `{}`: {why}", source.name))
    });
    let maps_photons = methods.contains(&Method::Baseline(Baseline::Sppm));
    if let Some(medium) = turbid_media(&job.scene).next().filter(|_| maps_photons) {
        return Err(Error::Usage(format!(
            "--estimators: sppm gathers on surfaces only: the medium `{medium}` scatters light; leave it out"
        )));
    }
    let blind: Vec<&str> = methods
        .iter()
        .filter(|method| method.meets_sources())
        .map(|method| method.name())
        .collect();
    match unseen {
        Some(unseen) if !blind.is_empty() => Err(Error::Usage(format!(
            "--estimators: {} cannot meet {unseen}; leave them out, or give the source an area and a cone of directions",
            blind.join(", ")
        ))),
        Some(_) | None => Ok(()),
    }
}

/// `reports/NAME-compare` after the scene file, unless a folder is given.
fn dir_of(scene: &Path, output: &Output) -> PathBuf {
    match output.dir {
        Some(_) => output_dir(scene, output),
        None => {
            let mut dir = output_dir(scene, output).into_os_string();
            dir.push("-compare");
            dir.into()
        }
    }
}

fn scene_words(job: &Job) -> String {
    let set = job.overrides.iter().map(|one| format!(", `{one}`")).collect::<String>();
    format!("`{}.toml` (hash {}{set})", job.name, job.hash)
}
