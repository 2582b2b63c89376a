//! Checks of a job before it is traced: there is light, every name is known, and the estimators can
//! hit the sources.

use lumiduct_base::error::{Diagnostic, Result};
use lumiduct_core::measure;
use lumiduct_core::plan::{Estimator, Request};
use lumiduct_core::scene::{Scene, SensorId, Source};
use lumiduct_core::transport::{BLIND_PATHS, blind_sensors, invisible};
use lumiduct_input::Job;
use lumiduct_input::keys::Key;
use lumiduct_input::problems::Problems;

/// Refuses a scene without light, and checks and targets that name no measure of it, before any
/// work is done. Returns remarks.
pub(super) fn expect_sense(job: &Job) -> Result<Vec<Diagnostic>> {
    let target = job
        .run
        .stop
        .target
        .iter()
        .map(|target| (Key::of(&["run", "target", "measure"]), &target.measure));
    let check = |index| Key::of(&["check"]).index(index).field("measure");
    let checks = job.checks.iter().enumerate().map(|(index, one)| (check(index), &one.measure));
    let mut problems = Problems::default();
    expect_light(job, &mut problems);
    expect_visible_sources(job, &mut problems);
    expect_passages(job, &mut problems);
    expect_polarisation(job, &mut problems);
    expect_narrow_spectra(job, &mut problems);
    expect_one_wavelength(job, &mut problems);
    expect_measures(&job.scene, target.chain(checks), &mut problems);
    expect_sight(job, &mut problems);
    problems.finish(&job.places)
}

/// Refuses a scene in which nothing emits.
fn expect_light(job: &Job, problems: &mut Problems) {
    if job.scene.sources.iter().any(Source::is_lit) {
        return;
    }
    let key = Key::of(&["sources"]);
    let is_empty = job.scene.sources.is_empty();
    let (message, hint) = if is_empty {
        (
            "nothing emits light: there is no source to trace",
            "add a table such as [sources.led.disk]",
        )
    } else {
        (
            "nothing emits light: every source is disabled or has a flux of 0",
            "give one of them a flux, or write enabled = true",
        )
    };
    let problem = problems.error(&key, message);
    problem.hint(hint);
    if !job.places.has(&key) {
        problem.at(&job.places.root().origin);
    }
}

/// Notes names that match no measure of a scene.
pub(crate) fn expect_measures<'a>(
    scene: &Scene,
    wanted: impl Iterator<Item = (Key, &'a String)>,
    problems: &mut Problems,
) {
    let names = measure::names(scene);
    for (key, name) in wanted.filter(|(_, name)| !names.contains(name)) {
        let nearest = measure::nearest(name, names.iter().map(String::as_str));
        problems
            .error(&key, format!("there is no measure `{name}`"))
            .hint(format!("nearest names: {}", nearest.join(", ")));
    }
}

/// Remarks on sensors whose gather paths cannot reach any light.
fn expect_sight(job: &Job, problems: &mut Problems) {
    let request = |sensor: SensorId| job.run.request(sensor.index());
    let sensors: Vec<SensorId> = (0..job.scene.sensors.len())
        .map(SensorId::new)
        .filter(|&sensor| is_asked(request(sensor), Estimator::must_meet_sources))
        .collect();
    for sensor in blind_sensors(&job.scene, &sensors, job.run.seed) {
        let name = &job.scene.sensors[sensor.index()].name;
        let message = format!(
            "sees no port: none of {BLIND_PATHS} gather paths meets a surface or a source, so `{}` will hardly find light there",
            request(sensor).name()
        );
        problems
            .warning(&Key::of(&["sensors", name]), message)
            .hint("turn its axis toward the port, or name the port in its `aim`");
    }
}

/// The estimator for all sensors, if any has none of its own, and those that single sensors ask
/// for.
fn requests(job: &Job) -> Vec<(Key, Request)> {
    let sensors = &job.scene.sensors;
    let own = |sensor: usize| job.run.own_estimator(sensor);
    let is_for_all = sensors.is_empty() || (0..sensors.len()).any(|sensor| own(sensor).is_none());
    let for_all = is_for_all.then(|| (Key::of(&["run", "estimator"]), job.run.estimator));
    let single = sensors.iter().enumerate().filter_map(|(sensor, one)| {
        Some((Key::of(&["sensors", &one.name, "estimator"]), own(sensor)?.request()))
    });
    for_all.into_iter().chain(single).collect()
}

/// Refuses estimators that must hit the sources where a source cannot be hit.
fn expect_visible_sources(job: &Job, problems: &mut Problems) {
    for (key, request) in requests(job) {
        if !is_asked(request, Estimator::must_meet_sources) {
            continue;
        }
        for source in &job.scene.sources {
            let Some(why) = invisible(source, &job.scene) else { continue };
            let (name, wanted) = (&source.name, request.name());
            let message = format!("`{wanted}` paths cannot meet the source `{name}`: {why}");
            problems.error(&key, message).hint(
                "use `forward`, `mix`, `mis` or `auto`, or give the source an area and a cone of directions",
            );
        }
    }
}

/// Refuses estimators with records where polarisation is followed.
fn expect_polarisation(job: &Job, problems: &mut Problems) {
    if job.scene.polarisation.is_ignored() {
        return;
    }
    for (key, request) in requests(job) {
        if !is_asked(request, |one| !one.follows_polarisation()) {
            continue;
        }
        let message = format!("`{}` cannot follow polarisation", request.name());
        problems
            .error(&key, message)
            .hint("use `auto`, `forward`, `backward` or `mix`, or leave out `run.polarisation`");
    }
}

/// Refuses estimators that gather photons for a sensor that counts only first passages.
fn expect_passages(job: &Job, problems: &mut Problems) {
    for (index, sensor) in job.scene.sensors.iter().enumerate() {
        let request = job.run.request(index);
        let is_able = !is_asked(request, Estimator::has_records);
        if is_able || !sensor.counts_first_passage() {
            continue;
        }
        let (name, wanted) = (&sensor.name, request.name());
        let message = format!(
            "`{wanted}` cannot count first passages: the photons it gathers may have passed `{name}` before"
        );
        problems
            .error(&Key::of(&["sensors", name, "passage"]), message)
            .hint("use `auto`, `forward`, `backward` or `mix`, or passage = \"every\"");
    }
}

/// Remarks on estimators that follow few wavelengths of broad spectra.
fn expect_narrow_spectra(job: &Job, problems: &mut Problems) {
    if job.scene.spectra.are_narrow() {
        return;
    }
    for (key, request) in requests(job) {
        if is_asked(request, Estimator::has_records) {
            let message = format!(
                "`{}` follows few wavelengths in a pass: colours of broad spectra have large errors",
                request.name()
            );
            let hint = "for colours use `auto`, `forward`, `backward` or `mix`";
            problems.warning(&key, message).hint(hint);
        }
    }
}

/// Refuses estimators that cannot follow light through fluorescent media.
fn expect_one_wavelength(job: &Job, problems: &mut Problems) {
    if !job.scene.fluoresces() {
        return;
    }
    for (key, request) in requests(job) {
        if is_asked(request, |asked| !asked.follows_fluorescence()) {
            let message = format!(
                "`{}` cannot compute light that changes its wavelength: its gather paths have one from the sensor to the source",
                request.name()
            );
            problems.error(&key, message).hint("use `auto` or `forward`");
        }
    }
}

/// Whether an estimator is requested of which something is true; not where a pilot chooses.
fn is_asked(request: Request, is_true: impl Fn(Estimator) -> bool) -> bool {
    request.estimator().is_some_and(is_true)
}
