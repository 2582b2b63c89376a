//! Settings and domains of parameters in words.

use crate::study::{DesignRecord, ParameterFacts, StudyReport};
use lumiduct_base::number::format_value;
use lumiduct_input::{Domain, Setting};
use std::fmt::Write;

/// A setting, without its unit.
pub(super) fn setting_word(setting: &Setting) -> String {
    match setting {
        Setting::Number(number) => format_value(*number),
        Setting::Choice(name) => name.clone(),
        Setting::AsInScene => "as in the scene".into(),
    }
}

/// The domain of a parameter, in words.
pub(super) fn domain_words(domain: &Domain) -> String {
    match domain {
        Domain::Levels(levels) => levels.iter().map(setting_word).collect::<Vec<_>>().join(", "),
        Domain::Uniform { from, to } => {
            format!("uniform from {} to {}", format_value(*from), format_value(*to))
        }
        Domain::Normal { mean, std_dev, from, to } => {
            let (mean, std_dev) = (format_value(*mean), format_value(*std_dev));
            let mut text = format!("normal, mean {mean}, standard deviation {std_dev}");
            if let Some(from) = from {
                _ = write!(text, ", not below {}", format_value(*from));
            }
            if let Some(to) = to {
                _ = write!(text, ", not above {}", format_value(*to));
            }
            text
        }
        Domain::Listed => "from the table".into(),
        Domain::AsInScene => "as in the scene".into(),
    }
}

/// The settings of a design as cells of a table.
pub(super) fn settings(report: &StudyReport, design: &DesignRecord) -> Vec<String> {
    report.facts.varied().map(|parameter| setting(parameter, design)).collect()
}

/// The settings of a design in words, with units.
pub(super) fn settings_words(report: &StudyReport, design: &DesignRecord) -> String {
    let word = |own: &ParameterFacts| {
        let unit = own.unit.as_ref().map_or(String::new(), |unit| format!(" {unit}"));
        let unit = if own.setting_in(design).number().is_some() { unit } else { String::new() };
        format!("{} {}{unit}", own.name, setting(own, design))
    };
    report.facts.varied().map(word).collect::<Vec<_>>().join(", ")
}

/// What a parameter is set to in a design, without its unit.
pub(super) fn setting(parameter: &ParameterFacts, design: &DesignRecord) -> String {
    let found = parameter.setting_in(design);
    let of_scene =
        if design.settings.get(&parameter.name) == Some(found) { "" } else { " (scene)" };
    match found {
        Setting::Number(_) => setting_word(found) + of_scene,
        Setting::Choice(_) | Setting::AsInScene => setting_word(found),
    }
}
