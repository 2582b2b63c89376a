//! The flow, one call per step: a scene file becomes a report.

mod compare;
mod progress;
mod timing;

pub use compare::{CompareWishes, Compared, Method, TruthWish, compare};
pub use progress::{Progress, TargetProgress};

use crate::error::{Diagnostic, Result};
use crate::input::keys::Key;
use crate::input::problems::Problems;
use crate::input::{self, Job, Settings};
use crate::measure::{self, Status};
use crate::report::{
    self, CheckResult, Existing, Folder, Recipe, Report, RunFacts, SceneFacts, TargetFacts,
    Written, inventory, write_whole,
};
use crate::scene::plan::{Request, RunPlan};
use crate::transport::{
    BLIND_PATHS, Findings, Interrupt, Run, Track, blind_sensors, invisible, scatterers, tracks,
};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Version of the program, for reports.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Where the report goes, and whether one that is there may be replaced.
#[derive(Debug, Clone)]
pub struct Output {
    /// The folder of the report; `reports/NAME` when none is given.
    pub dir: Option<PathBuf>,
    /// What to do with a report that is there.
    pub existing: Existing,
}

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// All paths that were asked for are traced.
    Paths,
    /// The time is up.
    Time,
    /// The target is met.
    Target,
    /// The noise is well below the target, and what is left is a bias that more paths do not take away.
    Bias,
    /// Nothing of the target's measure was found in very many paths.
    Dark,
    /// The user asked to stop.
    Interrupted,
}

impl Stop {
    /// A sentence for the report. It names no time: reports do not depend on the clock.
    pub fn reason(self) -> &'static str {
        match self {
            Self::Paths => "all requested paths were traced",
            Self::Time => "the time limit was reached",
            Self::Target => "the target error was reached",
            Self::Bias => "more paths would not help: the target is below the bias of its measure",
            Self::Dark => "more paths would hardly help: the target's measure is still nothing",
            Self::Interrupted => "interrupted: this report is partial",
        }
    }
}

/// Runs a scene file and writes its report.
pub fn run_one(
    scene: &Path,
    settings: &Settings,
    output: &Output,
    interrupt: &Interrupt,
    watch: &mut dyn FnMut(&Progress),
) -> Result<Finished> {
    let mut job = input::load(scene, settings)?;
    job.warnings.extend(expect_sense(&job)?);
    let folder = Folder::open(&output_dir(scene, output), output.existing, recipe(&job).as_ref())?;
    let traced = trace(&job, interrupt, watch);
    let report = compose(&job, &traced.findings, traced.stop);
    let written = folder.write(&report::files(&report, &job.text)?)?;
    timing::write(&folder, &traced)?;
    Ok(Finished {
        report,
        written,
        stop: traced.stop,
        dir: folder.path().to_path_buf(),
        warnings: job.warnings,
    })
}

/// Refuses a scene without light, and checks and targets that name no measure of it, before any work is done. Gives
/// back remarks.
fn expect_sense(job: &Job) -> Result<Vec<Diagnostic>> {
    let names = measure::names(&job.scene);
    let target = job
        .run
        .stop
        .target
        .iter()
        .map(|target| (Key::of(&["run", "target", "measure"]), &target.measure));
    let check = |index| Key::of(&["check"]).index(index).field("measure");
    let checks = job.checks.iter().enumerate().map(|(index, one)| (check(index), &one.measure));
    let mut problems = Problems::default();
    if job.scene.sources.is_empty() {
        problems
            .error(&Key::of(&["sources"]), "nothing emits light: there is no source to trace")
            .hint("add a table such as [sources.led.disk]");
    }
    expect_visible_sources(job, &mut problems);
    expect_discrete_directions(job, &mut problems);
    for (key, name) in target.chain(checks).filter(|(_, name)| !names.contains(name)) {
        let nearest = measure::nearest(name, names.iter().map(String::as_str));
        problems
            .error(&key, format!("there is no measure `{name}`"))
            .hint(format!("near names: {}", nearest.join(", ")));
    }
    expect_sight(job, &mut problems);
    problems.finish(&job.places)
}

/// Remarks on sensors from which no gather path could bring light.
fn expect_sight(job: &Job, problems: &mut Problems) {
    match job.run.estimator {
        // Photons find what gather paths do not.
        Request::Auto | Request::Forward | Request::Mix => return,
        Request::Backward | Request::Gather | Request::Mis => {}
    }
    for sensor in blind_sensors(&job.scene, job.run.seed) {
        let name = &job.scene.sensors[sensor.index()].name;
        let message = format!(
            "sees no port: 0 of {BLIND_PATHS} gather paths meet a surface or a source, so that `{}` finds nothing there",
            job.run.estimator.name()
        );
        problems
            .warning(&Key::of(&["sensors", name]), message)
            .hint("turn its axis toward the port, or name the port in its `aim`");
    }
}

/// Refuses estimators that have to meet the sources where a source cannot be met.
fn expect_visible_sources(job: &Job, problems: &mut Problems) {
    let meets = match job.run.estimator {
        Request::Auto | Request::Forward | Request::Mix => false,
        Request::Backward | Request::Gather | Request::Mis => true,
    };
    for source in job.scene.sources.iter().filter(|_| meets) {
        let Some(why) = invisible(source, &job.scene) else { continue };
        let (name, wanted) = (&source.name, job.run.estimator.name());
        let message = format!("`{wanted}` paths cannot meet the source `{name}`: {why}");
        problems.error(&Key::of(&["run", "estimator"]), message).hint(
            "use `forward`, `mix` or `auto`, or give the source an area and a cone of directions",
        );
    }
}

/// Refuses merging where a finish scatters.
fn expect_discrete_directions(job: &Job, problems: &mut Problems) {
    match job.run.estimator {
        Request::Auto | Request::Forward | Request::Backward | Request::Mix | Request::Gather => {
            return;
        }
        Request::Mis => {}
    }
    for scatterer in scatterers(&job.scene) {
        let message =
            format!("`mis` merges paths of discrete directions only: {scatterer} scatters light");
        problems
            .error(&Key::of(&["run", "estimator"]), message)
            .hint("use `auto`, or one of `forward`, `backward`, `mix` and `gather`");
    }
}

/// A run that has written its report.
#[derive(Debug)]
pub struct Finished {
    /// What the report says.
    pub report: Report,
    /// Whether it was there before.
    pub written: Written,
    /// Why the run ended.
    pub stop: Stop,
    /// Where the report lies.
    pub dir: PathBuf,
    /// Remarks on the scene file.
    pub warnings: Vec<Diagnostic>,
}

/// What decides the bytes of a job's report; nothing does when the clock stops the run.
fn recipe(job: &Job) -> Option<Recipe> {
    job.run.stop.time.is_none().then(|| Recipe {
        version: VERSION.to_owned(),
        scene_hash: job.hash.clone(),
        seed: job.run.seed,
        estimator: job.run.estimator.name().to_owned(),
        gather: report::wishes(&job.run.gather),
        asked: report::asked(&job.run.stop),
    })
}

/// The report of what was counted.
pub fn compose(job: &Job, findings: &Findings, stop: Stop) -> Report {
    let measures = measure::measure(&job.scene, findings);
    let checks = job
        .checks
        .iter()
        .map(|check| CheckResult {
            check: check.clone(),
            verdict: measure::verdict(check, &measures),
        })
        .collect();
    let mut warnings: Vec<String> = job
        .warnings
        .iter()
        .map(|warning| format!("`{}` {}", warning.key, warning.message))
        .collect();
    warnings.extend(report::remarks(&measures));
    warnings.extend(report::remark_on_paths(job.run.stop.paths, measures.paths));
    let target = job.run.stop.target.as_ref().map(|target| TargetFacts::new(target, &measures));
    Report {
        scene: SceneFacts {
            name: job.name.clone(),
            title: job.title.clone(),
            description: job.description.clone(),
            hash: job.hash.clone(),
            overrides: job.overrides.clone(),
        },
        run: RunFacts {
            version: VERSION.to_owned(),
            seed: job.run.seed,
            estimator: job.run.estimator,
            gather: report::wishes(&job.run.gather),
            gathering: gathering(findings),
            partial: stop == Stop::Interrupted,
            asked: report::asked(&job.run.stop),
            stopped: stop.reason().to_owned(),
            target,
            bounce_limit: job.run.bounce_limit,
            leaks: report::leak_places(&findings.photons.leaks, job.scene.origin),
        },
        measures,
        checks,
        warnings,
        drawing: report::drawing(&job.scene, &shown_tracks(job, REPORT_PATHS)),
    }
}

/// Paths that a report draws.
const REPORT_PATHS: usize = 60;

fn shown_tracks(job: &Job, count: usize) -> Vec<Track> {
    tracks(&job.scene, job.run.seed, job.run.bounce_limit, count)
}

/// How gathering was set, in words; empty where nothing was gathered.
fn gathering(findings: &Findings) -> String {
    findings.gathered.as_ref().map_or(String::new(), |own| report::settled(&own.settings))
}

/// What tracing gave.
#[derive(Debug)]
pub struct Traced {
    /// Everything that was counted.
    pub findings: Findings,
    /// Why it ended.
    pub stop: Stop,
    /// How long it took.
    pub elapsed: Duration,
}

/// Traces rounds until a stop rule holds.
pub fn trace(job: &Job, interrupt: &Interrupt, watch: &mut dyn FnMut(&Progress)) -> Traced {
    let start = Instant::now();
    let mut run = Run::new(&job.scene, &job.run);
    let (mut target, mut gathering_told) = (None, false);
    let stop = loop {
        let round_end = run.round_end();
        let mut early = None;
        while run.waves() < round_end && early.is_none() {
            run.next_piece();
            early = early_stop(&job.run, &run, start.elapsed(), interrupt);
            let mut progress = Progress::of(&job.run, &run, start.elapsed(), target.clone());
            if !gathering_told {
                progress.gathering = gathering(&run.findings());
                gathering_told = true;
            }
            watch(&progress);
        }
        if let Some(stop) = early {
            break stop;
        }
        target = TargetProgress::of(job, &run);
        watch(&Progress::of(&job.run, &run, start.elapsed(), target.clone()));
        let stop = target.as_ref().and_then(|target| target_stop(target, run.paths()));
        // Smaller windows take a bias away.
        if let Some(stop) = stop.filter(|stop| *stop != Stop::Bias || !run.shrinks()) {
            break stop;
        }
        let is_held = || match &target {
            Some(target) => is_held_by_bias(target),
            None => measure::is_held_by_bias(&job.scene, &run.findings()),
        };
        if run.may_end_stage() && is_held() {
            run.next_stage();
        }
    };
    Traced { findings: run.findings(), stop, elapsed: start.elapsed() }
}

/// A run to a target gives up on one that its bias keeps from it once the noise is this share of what is wanted, 1.
const NOISE_DONE: f64 = 0.3;
/// Paths after which a run to a target gives up on a measure that is nothing.
const DARK_PATHS: u64 = 200_000_000;

/// What the target of a run says about its end.
fn target_stop(target: &TargetProgress, paths: u64) -> Option<Stop> {
    let (reached, wanted) = (&target.reached, target.wanted);
    if reached.relative_error() <= wanted {
        return Some(Stop::Target);
    }
    let noise_done = NOISE_DONE * wanted * reached.value.abs();
    if reached.value != 0.0 && reached.std_error <= noise_done {
        return Some(Stop::Bias);
    }
    (reached.value == 0.0 && paths >= DARK_PATHS).then_some(Stop::Dark)
}

/// Whether a smaller window brings the target nearer than more of the same work.
fn is_held_by_bias(target: &TargetProgress) -> bool {
    let reached = &target.reached;
    reached.status == Status::BiasNotResolved
        || reached.bias.is_some_and(|bias| bias > reached.std_error)
}

/// What may end a run before its round is over.
fn early_stop(
    plan: &RunPlan,
    run: &Run<'_>,
    elapsed: Duration,
    interrupt: &Interrupt,
) -> Option<Stop> {
    if interrupt.is_raised() {
        return Some(Stop::Interrupted);
    }
    if !run.is_between_waves() {
        return None;
    }
    if run.is_complete() {
        return Some(Stop::Paths);
    }
    plan.stop.time.is_some_and(|limit| elapsed >= limit).then_some(Stop::Time)
}

/// `reports/NAME` after the scene file, unless told otherwise.
fn output_dir(scene: &Path, output: &Output) -> PathBuf {
    output
        .dir
        .clone()
        .unwrap_or_else(|| Path::new("reports").join(scene.file_stem().unwrap_or_default()))
}

/// Paths that a check draws.
const CHECK_PATHS: usize = 50;

/// What a check found.
#[derive(Debug)]
pub struct Checked {
    /// What is in the scene.
    pub text: String,
    /// Remarks on the scene file.
    pub warnings: Vec<Diagnostic>,
}

/// Validates a scene, lists what is in it, and draws its cross-section with some traced paths.
pub fn check(
    scene: &Path,
    settings: &Settings,
    picture: Option<&Path>,
    existing: Existing,
) -> Result<Checked> {
    let mut job = input::load(scene, settings)?;
    job.warnings.extend(expect_sense(&job)?);
    let default = PathBuf::from(format!("{}.check.png", job.name));
    // The default name belongs to this program: it is drawn anew at every check.
    let (picture, existing) =
        picture.map_or((&*default, Existing::Replace), |path| (path, existing));
    let bytes = report::scene_picture(&job.title, &job.scene, &shown_tracks(&job, CHECK_PATHS))?;
    write_whole(picture, &bytes, existing)?;
    let text = format!("{}\n{}picture: {}\n", job.title, inventory(&job.scene), picture.display());
    Ok(Checked { text, warnings: job.warnings })
}
