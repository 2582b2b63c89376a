//! The best design of a search as production scatters it: random designs about it, numbered after those of the search.

use crate::study::analysis::analysed;
use crate::study::confirm::fresh_seed;
use crate::study::designs::{Design, sampled};
use crate::study::execute::{DesignBatch, execute};
use crate::study::facts::parameter_facts;
use crate::study::sampling::random;
use lumiduct_base::error::Result;
use lumiduct_input::{Parameter, Samples, Setting};
use lumiduct_report::study::{DesignRecord, PlanFacts, StudyFacts, StudyReport};

/// Traces designs scattered about the best of the first `searched` numbers, as a study of their own; `None` if it was interrupted.
pub(crate) fn production(
    batch: &DesignBatch<'_>,
    facts: &StudyFacts,
    best: &DesignRecord,
    samples: &Samples,
    searched: usize,
) -> Result<Option<StudyReport>> {
    let own = |parameter: &Parameter| {
        let about = best.settings.get(&parameter.name).unwrap_or(&Setting::AsInScene);
        parameter.scattered(about)
    };
    let parameters: Vec<Parameter> = batch.study.parameters.iter().map(own).collect();
    let settings = sampled(&parameters, &random(samples, parameters.len()));
    let numbered = settings.into_iter().zip(searched + 1..);
    let designs: Vec<Design> =
        numbered.map(|(settings, number)| Design { number, settings }).collect();
    let wanted: Vec<usize> = designs.iter().map(|design| design.number).collect();
    // The best is partly luck with the random numbers of the search.
    let seed = fresh_seed(batch.study);
    execute(&DesignBatch { seed: Some(seed), ..*batch }, &designs, &wanted)?;
    let records = batch.store.records()?.split_off(&(searched + 1));
    if records.len() < designs.len() {
        return Ok(None);
    }
    let facts = StudyFacts {
        plan: PlanFacts::Tolerance(samples.seed),
        designs: designs.len(),
        seed,
        production_designs: None,
        parameters: parameters.iter().map(parameter_facts).collect(),
        // What designs cost is for the choice between them.
        measures: batch.study.measures.clone(),
        ranking: None,
        gain_limit: None,
        ..facts.clone()
    };
    Ok(Some(analysed(facts, records.into_values().collect())))
}
