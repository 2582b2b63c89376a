//! Whether the best design is at the edge of the values tried for a parameter.

use crate::study::{DesignRecord, ParameterFacts, StudyReport};
use lumiduct_base::number::format_value;
use lumiduct_input::Domain;

/// With fewer settings than this every one is at an edge.
const FEWEST: usize = 3;

/// A remark on a best design at the least or greatest setting of a parameter: beyond it there may
/// be a better one.
pub(super) fn edge_remark(report: &StudyReport) -> Option<String> {
    let best = report.design(report.analysis.ranked.first()?.design)?;
    let edges = edges(report, best);
    let ranges = if edges.len() == 1 { "that range" } else { "these ranges" };
    (!edges.is_empty()).then(|| {
        format!(
            "Design {} is the best and lies at the edge of the range tried: {}. The optimum may lie outside \
                {ranges}.",
            best.design,
            edges.join("; ")
        )
    })
}

/// A remark on designs of a front at the least or greatest setting of a parameter.
pub(super) fn edges_of_front(report: &StudyReport) -> Option<String> {
    let designs = report.front().filter(|design| !edges(report, design).is_empty());
    let numbers: Vec<String> = designs.map(|design| design.design.to_string()).collect();
    (!numbers.is_empty()).then(|| {
        let (designs, lie) =
            if numbers.len() == 1 { ("Design", "lies") } else { ("Designs", "lie") };
        format!(
            "{designs} {} {lie} at the edge of a range tried. The front may go on outside of it.",
            numbers.join(", ")
        )
    })
}

/// The edges at which a design lies, in words.
fn edges(report: &StudyReport, design: &DesignRecord) -> Vec<String> {
    let parameters = report.facts.parameters.iter();
    parameters.filter_map(|parameter| edge(parameter, design, &report.designs)).collect()
}

/// At which edge of a parameter a design is, in words; `None` for one inside, and for choices.
fn edge(parameter: &ParameterFacts, best: &DesignRecord, all: &[DesignRecord]) -> Option<String> {
    let own = parameter.setting_in(best).number()?;
    let tried = numbers_of(parameter, all);
    let (Some(&least), Some(&greatest)) = (tried.first(), tried.last()) else { return None };
    if tried.len() < FEWEST {
        return None;
    }
    let ([from, to], part) = match parameter.domain {
        Domain::Levels(_) | Domain::Listed => ([least, greatest], 0.0),
        // For samples that fill a range evenly, about one lies in the outermost interval at either
        // end.
        Domain::Uniform { from, to } => ([from, to], (to - from) / all.len() as f64),
        // Production scatter has no edge.
        Domain::Normal { .. } | Domain::AsInScene => return None,
    };
    let end = if own <= from + part {
        "lower"
    } else if own >= to - part {
        "upper"
    } else {
        return None;
    };
    let [own, from, to] = [own, from, to].map(format_value);
    Some(format!("{} is {own}, at the {end} end of {from} to {to}", parameter.label()))
}

/// Distinct numbers of a parameter; none unless all designs have one.
pub(super) fn numbers_of(parameter: &ParameterFacts, designs: &[DesignRecord]) -> Vec<f64> {
    let numbers: Option<Vec<f64>> =
        designs.iter().map(|design| parameter.setting_in(design).number()).collect();
    let mut numbers = numbers.unwrap_or_default();
    numbers.sort_by(f64::total_cmp);
    numbers.dedup();
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::DESIGN_FORMAT;
    use crate::study::DesignOutcome;
    use lumiduct_input::Setting;

    fn designs(lengths: &[f64]) -> Vec<DesignRecord> {
        let design = |(place, length): (usize, &f64)| DesignRecord {
            lumiduct_design: DESIGN_FORMAT,
            build: String::new(),
            study: String::new(),
            design: place + 1,
            settings: [("length".to_owned(), Setting::Number(*length))].into_iter().collect(),
            outcome: DesignOutcome::Failed(String::new()),
        };
        lengths.iter().enumerate().map(design).collect()
    }

    fn words(domain: Domain, lengths: &[f64], best: usize) -> Option<String> {
        let parameter = ParameterFacts {
            name: "length".into(),
            unit: Some("mm".into()),
            keys: Vec::new(),
            domain,
            nominal: Setting::AsInScene,
            choices: indexmap::IndexMap::new(),
        };
        let all = designs(lengths);
        edge(&parameter, &all[best], &all)
    }

    #[test]
    fn a_best_design_at_the_end_of_levels_is_at_an_edge_and_one_of_two_is_not() {
        let lengths = [20.0, 5.0, 10.0];
        let of_levels = |best| words(Domain::Listed, &lengths, best);
        assert_eq!(of_levels(1).unwrap(), "length in mm is 5, at the lower end of 5 to 20");
        assert_eq!(of_levels(0).unwrap(), "length in mm is 20, at the upper end of 5 to 20");
        assert_eq!(of_levels(2), None);
        assert_eq!(words(Domain::Listed, &[5.0, 20.0], 0), None);
    }

    #[test]
    fn of_samples_the_outermost_part_of_the_range_is_its_edge() {
        let lengths = [0.2, 0.3, 0.6, 0.9];
        let of_samples = |best| words(Domain::Uniform { from: 0.0, to: 1.0 }, &lengths, best);
        assert_eq!([0, 1, 2, 3].map(|best| of_samples(best).is_some()), [true, false, false, true]);
        let production = Domain::Normal { mean: 0.5, std_dev: 0.2, from: None, to: None };
        assert_eq!(words(production, &lengths, 3), None);
    }
}
