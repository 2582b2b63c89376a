//! What a study is, without its results.

use crate::pipeline::VERSION;
use lumiduct_input::{Cost, Parameter, Plan, Project, Study, Tie};
use lumiduct_report as report;
use lumiduct_report::study::{FACTS_FORMAT, GainLimit, ParameterFacts, PlanFacts, StudyFacts};

/// What a study is, for its reports.
pub(crate) fn facts(study: &Study, designs: usize) -> StudyFacts {
    let run = &study.base.run;
    let project = study.base.project.clone();
    let cost = study.cost.is_some().then(|| Cost::NAME.to_owned());
    StudyFacts {
        lumiduct_batch: FACTS_FORMAT,
        version: VERSION.to_owned(),
        name: study.name.clone(),
        title: study.title.clone(),
        description: study.description.clone(),
        logo: project.as_ref().and_then(|project| project.logo.clone()),
        project: project.map(|project| Project { logo: None, ..project }),
        hash: study.hash.clone(),
        scene: study.base.name.clone(),
        overrides: study.common.overrides.clone(),
        plan: match &study.plan {
            Plan::Grid => PlanFacts::Grid,
            Plan::OneAtATime => PlanFacts::OneAtATime,
            Plan::List(_) => PlanFacts::List,
            Plan::LatinHypercube(samples) => PlanFacts::LatinHypercube(samples.seed),
            Plan::Sobol(samples) => PlanFacts::Sobol(samples.seed),
            Plan::Tolerance(samples) => PlanFacts::Tolerance(samples.seed),
            Plan::Search(plan) => PlanFacts::Search(plan.seed),
        },
        designs,
        production_designs: study.production.as_ref().map(|own| own.count as usize),
        seed: run.seed,
        estimator: run.estimator.name().to_owned(),
        asked: report::asked(&run.stop),
        parameters: study.parameters.iter().map(parameter_facts).collect(),
        measures: study.measures.iter().cloned().chain(cost).collect(),
        ranking: study.ranking.clone(),
        objectives: study.objectives().to_vec(),
        gain_limit: study.plan.search().and_then(|plan| {
            Some(GainLimit { least: plan.least_gain?, designs: plan.designs as usize })
        }),
        checks: study.checks.clone(),
        keep: study.keep,
    }
}

/// What a parameter of a study is, for its reports.
pub(crate) fn parameter_facts(parameter: &Parameter) -> ParameterFacts {
    let key = |tie: &Tie| {
        let factor =
            if tie.factor == 1.0 { String::new() } else { format!(" = {} times it", tie.factor) };
        let offset = match tie.offset {
            0.0 => String::new(),
            offset if tie.factor == 1.0 => format!(" = it plus {offset}"),
            offset => format!(" plus {offset}"),
        };
        format!("{}{factor}{offset}", tie.key)
    };
    ParameterFacts {
        name: parameter.name.clone(),
        unit: parameter.unit.clone(),
        keys: parameter.ties.iter().map(key).collect(),
        domain: parameter.domain.clone(),
        nominal: parameter.nominal.clone(),
        choices: parameter.choices.clone(),
    }
}
