//! The command that repeats a run which the clock or the user has ended.

use crate::pipeline::stop::Stop;
use lumiduct_core::transport::Findings;
use lumiduct_input::Job;
use lumiduct_input::keys::Key;

/// The command that gives the same numbers without pilot and clock; `None` where the scene alone
/// repeats the run.
pub(super) fn command(job: &Job, findings: &Findings, stop: Stop) -> Option<String> {
    match stop {
        Stop::Time | Stop::Interrupted => {}
        Stop::Paths | Stop::Batches | Stop::Target | Stop::Bias | Stop::Dark => return None,
    }
    let mut words = vec!["lumiduct".into(), "run".into(), format!("{}.toml", job.name)];
    let mut define = |setting: String| words.extend(["-D".to_owned(), setting]);
    // Those of a repeated run are given anew.
    let is_own = |setting: &&String| {
        !setting.starts_with("run.batches") && !setting.starts_with("run.planned_paths")
    };
    job.settings.overrides.iter().filter(is_own).cloned().for_each(&mut define);
    for (sensor, estimator) in job.scene.sensors.iter().zip(&findings.estimators) {
        let key = Key::of(&["sensors", &sensor.name, "estimator"]);
        define(format!("{key}={}", estimator.name()));
    }
    define(format!("run.batches={}", findings.photons.batch_count()));
    if let (Some(_), Some(planned)) = (findings.gathering().next(), job.run.stop.paths_for_stages())
    {
        define(format!("run.planned_paths={planned}"));
    }
    let gather = &job.settings.gather;
    let [photons, records] = pass_size(job, findings);
    let flags = [
        ("--depth", gather.depth.map(|depth| depth.to_string())),
        ("--radius-mm", gather.radius_mm.map(|radius| radius.to_string())),
        ("--angle-deg", gather.angle_deg.map(|angle| angle.to_string())),
        ("--records", records.map(|records| records.to_string())),
        ("--photons", photons.map(|photons| photons.to_string())),
        ("--schedule", gather.schedule.map(|schedule| schedule.name().to_owned())),
        ("--seed", job.settings.seed.map(|seed| seed.to_string())),
        // Where windows shrink depends on the target.
        (
            "--target",
            job.run
                .stop
                .target
                .as_ref()
                .map(|target| format!("{}%", 100.0 * target.relative_error)),
        ),
        ("--paths", Some(findings.paths.to_string())),
    ];
    for (flag, value) in flags {
        words.extend(value.into_iter().flat_map(|value| [flag.to_owned(), value]));
    }
    Some(words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" "))
}

/// Photons and gather paths of a pass, which otherwise would follow from the length of the run.
fn pass_size(job: &Job, findings: &Findings) -> [Option<u64>; 2] {
    let Some((_, first)) = findings.gathering().next() else {
        let asked = &job.settings.gather;
        return [asked.photons, asked.records];
    };
    // The same for all groups.
    first.pass_size().map(Some)
}

/// A word quoted for a POSIX shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "._-=/%+,:".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_come_through_a_shell() {
        assert_eq!(
            quoted("solids.rod.cylinder.length_mm=1.5"),
            "solids.rod.cylinder.length_mm=1.5"
        );
        assert_eq!(quoted("title=it's [1, 2]"), "'title=it'\\''s [1, 2]'");
        assert_eq!(quoted(""), "''");
    }
}
