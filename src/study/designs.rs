//! From a plan to designs: what every parameter is set to in each.

use crate::study::sampling::{latin_hypercube, quantile, random, sobol};
use lumiduct_input::{Domain, Parameter, Plan, Setting, Study};

/// One design: a setting for each parameter, in the order of the study.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Design {
    /// Its number, from 1.
    pub(crate) number: usize,
    pub(crate) settings: Vec<Setting>,
}

/// All designs of a study that are known before any is traced, numbered from 1. The same study gives the same designs.
pub(crate) fn designs(study: &Study) -> Vec<Design> {
    let parameters = &study.parameters;
    let settings = match &study.plan {
        Plan::Grid => grid(parameters),
        Plan::OneAtATime => one_at_a_time(parameters),
        Plan::List(rows) => rows.clone(),
        Plan::LatinHypercube(own) => sampled(parameters, &latin_hypercube(own, parameters.len())),
        Plan::Sobol(own) => sampled(parameters, &sobol(own, parameters.len())),
        Plan::Tolerance(own) => sampled(parameters, &random(own, parameters.len())),
        // It proposes them one after the other.
        Plan::Search(_) => Vec::new(),
    };
    let numbered = settings.into_iter().enumerate();
    numbered.map(|(index, settings)| Design { number: index + 1, settings }).collect()
}

/// Every combination of all levels; the last parameter changes fastest.
fn grid(parameters: &[Parameter]) -> Vec<Vec<Setting>> {
    parameters.iter().fold(vec![Vec::new()], |rows, parameter| {
        let levels = levels(parameter);
        let longer = |row: &Vec<Setting>| {
            let row = row.clone();
            levels.iter().map(move |level| row.iter().chain([level]).cloned().collect())
        };
        rows.iter().flat_map(longer).collect()
    })
}

/// The scene as it is, then each level of each parameter on its own.
fn one_at_a_time(parameters: &[Parameter]) -> Vec<Vec<Setting>> {
    let base = vec![Setting::AsInScene; parameters.len()];
    let mut rows = vec![base.clone()];
    for (place, parameter) in parameters.iter().enumerate() {
        for level in levels(parameter).iter().filter(|level| **level != parameter.nominal) {
            let mut row = base.clone();
            row[place] = level.clone();
            rows.push(row);
        }
    }
    rows
}

fn levels(parameter: &Parameter) -> &[Setting] {
    match &parameter.domain {
        Domain::Levels(levels) => levels,
        Domain::Uniform { .. } | Domain::Normal { .. } | Domain::Listed | Domain::AsInScene => &[],
    }
}

pub(crate) fn sampled(parameters: &[Parameter], samples: &[Vec<f64>]) -> Vec<Vec<Setting>> {
    let row = |sample: &Vec<f64>| {
        let pairs = parameters.iter().zip(sample);
        pairs.map(|(parameter, &share)| quantile(parameter, share)).collect()
    };
    samples.iter().map(row).collect()
}
