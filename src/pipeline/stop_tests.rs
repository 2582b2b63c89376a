//! Runs that are stopped at a given poll of the signal, be it in the pilot, in a batch or in a
//! path.

use crate::pipeline::tests::job as short_rod;
use crate::pipeline::*;
use lumiduct_core::plan::{Estimator, GatherPlan, RunPlan};
use lumiduct_core::transport::{Phase, Run, StopAnswer, StopSignal, batch_paths};

/// The short rod by one estimator, in small batches or passes, with a plan for more than is traced.
fn settings(estimator: Request) -> Settings {
    crate::pipeline::tests::settings(estimator, 60_000)
}

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

/// Traces a job that is interrupted at the given poll.
fn stopped_at(check: u64, job: &Job) -> (Result<Traced>, u64) {
    let interrupt = Interrupt::at_check(check);
    let traced = trace(job, &interrupt, &mut |_| ());
    (traced, interrupt.checks() - check.min(interrupt.checks()))
}

/// The numbers of a run, without how estimators were chosen.
fn numbers(findings: &Findings) -> Findings {
    Findings { choices: Vec::new(), ..findings.clone() }
}

#[test]
fn a_stopped_run_ends_at_its_next_checks_and_its_command_repeats_it_on_any_threads() {
    let folder = tempfile::tempdir().unwrap();
    for estimator in [Request::Forward, Request::Backward, Request::Mix, Request::Gather] {
        let job = short_rod(folder.path(), &settings(estimator));
        let (mut stopped, mut empty) = (0, 0);
        // A thread traces four passes of gathering before any of them counts.
        let passes = if estimator == Request::Gather { 4 } else { 1 };
        for check in [1, 3, 20, 201, 333, 400].map(|check| check * passes) {
            let (traced, late) = on_threads(2, || stopped_at(check, &job));
            // Batches in progress poll once more, and so does each batch of the piece that had not
            // begun.
            assert!(late <= 32, "{late} checks after check {check} of {}", estimator.name());
            let Ok(traced) = traced else {
                empty += 1;
                continue;
            };
            assert_eq!(traced.stop, Stop::Interrupted, "{}", estimator.name());
            stopped += 1;
            let batches = traced.findings.photons.batch_count();
            let mut own = vec![format!("run.batches={batches}")];
            own.push(format!("sensors.exit.estimator={}", estimator.name()));
            let repeated = Settings {
                overrides: own,
                estimator: None,
                paths: Some(traced.findings.paths),
                ..settings(estimator)
            };
            let again = short_rod(folder.path(), &repeated);
            for threads in [1, 3] {
                let same =
                    on_threads(threads, || trace(&again, &Interrupt::default(), &mut |_| ()));
                let same = same.unwrap();
                assert_eq!(same.stop, Stop::Batches);
                assert!(same.findings == traced.findings, "{batches} batches, {threads} threads");
            }
        }
        assert!(stopped >= 3 && empty >= 1, "{stopped} stopped, {empty} empty");
    }
}

#[test]
fn more_batches_than_their_paths_need_are_traced_and_end() {
    let folder = tempfile::tempdir().unwrap();
    let overrides = vec!["run.batches=300".to_owned()];
    let options = Settings { overrides, paths: Some(300), ..settings(Request::Backward) };
    let job = short_rod(folder.path(), &options);
    let traced = trace(&job, &Interrupt::default(), &mut |_| ()).unwrap();
    assert_eq!(traced.findings.photons.batch_count(), 300);
}

#[test]
fn a_run_stopped_in_the_pilot_says_so_and_one_after_it_repeats_without_a_pilot() {
    let folder = tempfile::tempdir().unwrap();
    let auto = Settings { gather: GatherPlan::default(), ..settings(Request::Auto) };
    let job = short_rod(folder.path(), &auto);
    let error = stopped_at(8, &job).0.unwrap_err().to_string();
    assert!(error.contains("interrupted during the pilot"), "{error}");

    let whole = trace(&job, &Interrupt::default(), &mut |_| ()).unwrap();
    let [chosen] = whole.findings.estimators[..] else { panic!("one sensor") };
    let own = vec![format!("sensors.exit.estimator={}", chosen.name())];
    let again = short_rod(folder.path(), &Settings { overrides: own, ..auto });
    let mut phases = Vec::new();
    let repeated = trace(&again, &Interrupt::default(), &mut |now| phases.push(now.phase)).unwrap();
    assert!(phases.iter().all(|phase| !matches!(phase, Phase::Pilot(_))), "{phases:?}");
    assert!(repeated.findings == numbers(&whole.findings));
}

#[test]
fn a_pilot_that_takes_half_of_the_time_is_given_up_and_photons_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let auto = Settings { gather: GatherPlan::default(), ..settings(Request::Auto) };
    let job = short_rod(folder.path(), &auto);
    let start = |signal: &StopSignal| {
        on_threads(1, || Run::start(&job.scene, &job.run, signal, &mut |_| ()))
    };
    let free = Interrupt::default();
    start(&StopSignal::new(&free, None)).unwrap();
    let whole = free.checks();
    assert!(whole > 400, "a pilot of {whole} checks");
    for (checks, is_given_up) in [(whole / 2, true), (whole, true), (3 * whole, false)] {
        let clock = Interrupt::default();
        let mut run = start(&StopSignal::ending_at_check(&clock, checks, 10)).unwrap();
        if is_given_up {
            // Each batch that had not begun polls once.
            assert!(clock.checks() <= checks / 2 + 40, "{} of {checks} checks", clock.checks());
        }
        on_threads(1, || run.next_piece());
        let findings = run.findings();
        assert_eq!(findings.choices.is_empty(), is_given_up, "{checks} checks of {whole}");
        assert!(!is_given_up || findings.estimators == [Estimator::Forward]);
    }
}

#[test]
fn passes_of_gathering_fit_into_a_short_time_and_their_command_repeats_them() {
    let folder = tempfile::tempdir().unwrap();
    let time = Some(std::time::Duration::from_secs(3600));
    let options = Settings { estimator: Some(Request::Gather), time, ..Settings::default() };
    let job = short_rod(folder.path(), &options);
    // An automatic pass of a run of unknown length has four million segments, which are 3900 polls.
    let (checks, grace) = (600, 40);
    let clock = Interrupt::default();
    let signal = StopSignal::ending_at_check(&clock, checks, grace);
    let mut run = on_threads(1, || Run::start(&job.scene, &job.run, &signal, &mut |_| ())).unwrap();
    while clock.checks() < checks {
        on_threads(1, || run.next_piece());
    }
    assert!(clock.checks() <= checks + 20, "{} checks", clock.checks());
    assert!(run.batches() >= 4, "{} passes", run.batches());
    let findings = run.findings();

    let command = compose(&job, &findings, Stop::Time).unwrap().run.repeat.unwrap();
    let (_, settings) = findings.gathering().next().unwrap();
    let [photons, records] = [settings.photons, settings.gather_paths];
    assert!(command.contains(&format!("--records {records} --photons {photons}")), "{command}");
    let plan = run.state().plan(&job.run);
    assert_eq!(plan.sensor_estimators, [Some(Estimator::Gather)]);
    assert_eq!((plan.gather.photons, plan.gather.records), (Some(photons), Some(records)));
    let mut again = Run::new(&job.scene, &plan);
    while again.batches() < run.batches() {
        on_threads(1, || again.next_piece());
    }
    assert!(again.findings() == findings);
}

#[test]
fn large_batches_of_a_run_of_limited_time_are_resumed_and_repeated() {
    let folder = tempfile::tempdir().unwrap();
    let time = Some(std::time::Duration::from_secs(3600));
    for estimator in [Request::Forward, Request::Backward, Request::Mix] {
        let options = Settings { estimator: Some(estimator), time, ..Settings::default() };
        let job = short_rod(folder.path(), &options);
        let start = |checks, plan: &RunPlan| {
            let signal = StopSignal::ending_at_check(&Interrupt::default(), checks, 40);
            on_threads(2, || Run::start(&job.scene, plan, &signal, &mut |_| ())).unwrap()
        };
        let go_on = |run: &mut Run<'_>, pieces| {
            (0..pieces).for_each(|_| on_threads(2, || run.next_piece()));
        };
        let mut run = start(20_000, &job.run);
        let usual = batch_paths(&job.scene, &job.run);
        // Half of the work of the mix and a tenth of that of backward are photons.
        let least = if estimator == Request::Forward { usual } else { usual / 4 };
        assert!(run.photons_per_batch() > least, "{} photons", run.photons_per_batch());
        go_on(&mut run, 3);
        let state = run.state();
        go_on(&mut run, 2);
        let mut resumed = start(10_000, &state.plan(&job.run));
        resumed.restore(state);
        go_on(&mut resumed, 2);
        let findings = run.findings();
        assert!(resumed.findings() == findings, "{}", estimator.name());

        let repeated = Settings {
            overrides: vec![format!("run.batches={}", run.batches())],
            paths: Some(run.paths()),
            time: None,
            ..options
        };
        let again = short_rod(folder.path(), &repeated);
        let same = on_threads(3, || trace(&again, &Interrupt::default(), &mut |_| ()));
        assert!(same.unwrap().findings == findings, "{}", estimator.name());
    }
}

#[test]
fn an_interrupted_run_of_automatic_passes_is_repeated_by_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let (asked, estimator) = (60_000, Some(Request::Gather));
    let options = Settings { estimator, paths: Some(asked), ..Settings::default() };
    let job = short_rod(folder.path(), &options);
    let planned = on_threads(2, || Run::new(&job.scene, &job.run)).planned_paths().unwrap();
    assert!((asked..asked + 48).contains(&planned), "{planned} paths: 24 passes, rounded up");

    let (mut repeated, whole) = (0, Interrupt::default());
    trace(&job, &whole, &mut |_| ()).unwrap();
    for share in [0.5, 0.7, 0.9] {
        let check = (share * whole.checks() as f64) as u64;
        let Ok(traced) = on_threads(2, || stopped_at(check, &job)).0 else { continue };
        let command = compose(&job, &traced.findings, traced.stop).unwrap().run.repeat.unwrap();
        let word = |flag: &str| {
            let value = command.split(flag).nth(1).and_then(|rest| rest.split_whitespace().next());
            value.unwrap().parse::<u64>().unwrap()
        };
        let [photons, records] = ["--photons ", "--records "].map(|flag| Some(word(flag)));
        let again = Settings {
            gather: GatherPlan { photons, records, ..GatherPlan::default() },
            paths: Some(word("--paths ")),
            overrides: vec![format!("run.batches={}", word("run.batches="))],
            ..options.clone()
        };
        let again = short_rod(folder.path(), &again);
        let same = on_threads(3, || trace(&again, &Interrupt::default(), &mut |_| ())).unwrap();
        assert!(same.findings == traced.findings, "{command}");
        repeated += 1;
    }
    assert!(repeated >= 2, "{repeated} of 3 runs had begun");
}

#[test]
fn a_run_stopped_soon_after_a_stage_began_is_repeated_by_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let options = settings(Request::Gather);
    let job = short_rod(folder.path(), &options);
    let (mut repeated, whole) = (0, Interrupt::default());
    trace(&job, &whole, &mut |_| ()).unwrap();
    for check in (1..20).map(|part| part * whole.checks() / 40) {
        let Ok(traced) = on_threads(1, || stopped_at(check, &job)).0 else { continue };
        let stages = &traced.findings.others[0].stages;
        let few = stages.last().filter(|stage| stage.number > 0);
        let Some(stage) = few.filter(|stage| stage.counts.first().batch_count() < 16) else {
            continue;
        };
        let command = compose(&job, &traced.findings, traced.stop).unwrap().run.repeat.unwrap();
        let own = ["run.batches", "run.planned_paths"].map(|key| {
            let word = command.split_whitespace().find(|word| word.starts_with(key));
            word.unwrap_or_else(|| panic!("no {key} in {command}")).to_owned()
        });
        let (overrides, paths) = (own.to_vec(), Some(traced.findings.paths));
        let again =
            short_rod(folder.path(), &Settings { overrides, paths, ..settings(Request::Gather) });
        let same = on_threads(2, || trace(&again, &Interrupt::default(), &mut |_| ())).unwrap();
        assert!(same.findings == traced.findings, "stage {}: {command}", stage.number);
        repeated += 1;
    }
    assert!(repeated >= 2, "{repeated} stopped early in a stage");
}

#[test]
fn merged_passes_fit_into_a_short_time_where_paths_never_end() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("box.toml");
    std::fs::write(&scene, MIRROR_BOX).unwrap();
    let time = Some(std::time::Duration::from_secs(3600));
    let options = Settings { estimator: Some(Request::Mis), time, ..Settings::default() };
    let job = prepare(&scene, &options).unwrap();
    // A path has 20 polls, and the pilot takes 640 of them.
    let (checks, clock) = (3000, Interrupt::default());
    let signal = StopSignal::ending_at_check(&clock, checks, 100);
    let mut run = on_threads(1, || Run::start(&job.scene, &job.run, &signal, &mut |_| ())).unwrap();
    while clock.checks() < checks {
        on_threads(1, || run.next_piece());
    }
    assert!(clock.checks() <= checks + 20, "{} checks", clock.checks());
    assert!(run.batches() >= 4, "{} passes", run.batches());
}

#[test]
fn a_request_ends_tracing_and_lets_files_take_their_places() {
    let folder = tempfile::tempdir().unwrap();
    let options = settings(Request::Forward);
    short_rod(folder.path(), &options);
    let scene = folder.path().join("rod.toml");
    let output = Output::new(Some(folder.path().join("out")), Existing::Keep);
    let interrupt = Interrupt::default();
    let mut answers = Vec::new();
    let finished = run_one(&scene, &options, &output, &interrupt, &mut |progress| {
        if matches!(progress.phase, Phase::Batches(_)) && answers.is_empty() {
            answers.push(interrupt.request());
        }
    });
    assert_eq!(answers, [StopAnswer::EndRun]);
    assert_eq!(finished.unwrap().stop, Stop::Interrupted);
    let whole = Interrupt::default();
    let output = Output::new(Some(folder.path().join("whole")), Existing::Keep);
    run_one(&scene, &options, &output, &whole, &mut |_| ()).unwrap();
    assert_eq!(whole.request(), StopAnswer::EndRun, "the last activity was to write");
}

#[test]
fn a_check_comes_within_a_path_that_never_ends() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("box.toml");
    std::fs::write(&scene, MIRROR_BOX).unwrap();
    for estimator in [Request::Forward, Request::Gather, Request::Auto] {
        let options =
            Settings { estimator: Some(estimator), paths: Some(100_000), ..Settings::default() };
        let job = prepare(&scene, &options).unwrap();
        for check in [10, 1400] {
            let (traced, late) = on_threads(1, || stopped_at(check, &job));
            assert!(late <= 20, "{late} checks after check {check} of {}", estimator.name());
            match traced {
                Ok(traced) => assert_eq!((traced.stop, check), (Stop::Interrupted, 1400)),
                Err(error) => assert!(error.to_string().contains("nothing to report"), "{error}"),
            }
        }
    }
}

/// A closed box of perfect mirrors: every path reaches the bounce limit, and has 19 polls.
const MIRROR_BOX: &str = r#"
lumiduct = 1
title = "mirror box"
[finishes.silver.specular]
reflectance = 1
[sheets.box.tube]
profile = { rectangle = { width_mm = 40, height_mm = 40 } }
path = [{ straight_mm = 40 }]
finish = "silver"
[sheets.bottom.rectangle]
width_mm = 40
height_mm = 40
finish = "silver"
[sheets.top.rectangle]
width_mm = 40
height_mm = 40
finish = "silver"
at = { position_mm = [0, 0, 40] }
[sources.led.disk]
radius_mm = 2
at = { position_mm = [5, 3, 10] }
flux_lm = 100
[run]
bounce_limit = 20_000
[sensors.cell]
plane = { rectangle = { width_mm = 20, height_mm = 20 } }
at = { position_mm = [0, 0, 30], axis = [0, 0, -1] }
"#;
