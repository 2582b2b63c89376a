//! Expectations that can be met.

use crate::check::scene::Scene;
use crate::keys::Key;
use crate::problems::Problems;
use crate::spec::run::CheckSpec;

pub(crate) fn check(scene: Scene<'_>, problems: &mut Problems) {
    check_demands(&scene.spec.check, problems);
}

/// Notes demands that nothing can meet.
pub(crate) fn check_demands(checks: &[CheckSpec], problems: &mut Problems) {
    for (i, check) in checks.iter().enumerate() {
        let key = Key::of(&["check"]).index(i);
        if let (Some(min), Some(max)) = (check.min, check.max)
            && min > max
        {
            problems.error(&key.field("min"), format!("{min} is above `max`, which is {max}"));
        }
        if check.equals.is_none() {
            for (name, is_given) in
                [("within", check.within.is_some()), ("sigmas", check.sigmas.is_some())]
            {
                if is_given {
                    problems
                        .error(&key.field(name), "is only for `equals`")
                        .hint(format!("remove `{name}`"));
                }
            }
        }
    }
}
