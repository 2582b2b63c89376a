//! A search for the best design, or for a front: the designs that are proposed are traced one after the other.
//!
//! A resumed search proposes the same designs again and takes their records.

use crate::study::analysis::latest_gain;
use crate::study::board::{BestDesign, SearchLead};
use crate::study::designs::Design;
use crate::study::execute::{DesignBatch, DesignEnd, DesignTracing, expect_design};
use crate::study::front::front;
use crate::study::propose::{DesignMeter, ProposalEnd, ProposalStop, count_searched, propose};
use crate::study::race::ChoiceSet;
use crate::study::score::{DesignStanding, Goal};
use lumiduct_base::error::Result;
use lumiduct_input::{SearchPlan, Setting};
use lumiduct_report::study::{DesignRecord, LatestGain};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// Searches: every design that it proposes gets its record.
pub(crate) fn search(batch: &DesignBatch<'_>, plan: &SearchPlan) -> Result<ProposalEnd> {
    let mut records = batch.store.records()?;
    let most = plan.designs as usize;
    // Those after them are of production.
    drop(records.split_off(&(most + 1)));
    let pending = most.saturating_sub(records.len());
    let tracing = DesignTracing::new(batch, [most, pending])?;
    let meter = RecordedDesigns { batch, plan, tracing, records, standings: Vec::new() };
    let (end, meter) = propose(&batch.study.parameters, plan, meter)?;
    let further = match end {
        ProposalEnd::Complete(designs) => meter.records.range(designs + 1..).next(),
        ProposalEnd::Stopped => None,
    };
    match further {
        Some((number, _)) => {
            Err(batch.store.no_record(*number, "the search ends before this design"))
        }
        None => Ok(end),
    }
}

/// Designs with records, which are traced as they are asked for.
struct RecordedDesigns<'a> {
    batch: &'a DesignBatch<'a>,
    plan: &'a SearchPlan,
    tracing: DesignTracing<'a>,
    records: BTreeMap<usize, DesignRecord>,
    /// Of the designs so far.
    standings: Vec<DesignStanding>,
}

impl RecordedDesigns<'_> {
    /// The record of a design, which is traced if it has none.
    fn recorded(&mut self, design: &Design) -> std::result::Result<&DesignRecord, ProposalStop> {
        let record = match self.records.entry(design.number) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(place) => {
                if self.batch.interrupt.is_raised() {
                    return Err(ProposalStop::Interrupted);
                }
                match self.tracing.trace_timed(design).map_err(ProposalStop::Failed)? {
                    DesignEnd::Stopped => return Err(ProposalStop::Interrupted),
                    DesignEnd::Recorded(record) => place.insert(*record),
                }
            }
        };
        expect_design(self.batch, Some(design), record).map_err(ProposalStop::Failed)?;
        Ok(record)
    }

    /// What the latest designs of a combination have gained, where one objective decides.
    fn latest_gain(&self, combination: &ChoiceSet) -> Option<LatestGain> {
        let parameters = &self.batch.study.parameters;
        let [ranking] = self.batch.study.objectives() else { return None };
        let is_own = |record: &&DesignRecord| {
            let settings: Vec<Setting> = record.settings.values().cloned().collect();
            combination.is_of(&settings)
        };
        let designs = self.records.range(..=self.standings.len()).map(|(_, record)| record);
        let designs: Vec<&DesignRecord> = designs.filter(is_own).collect();
        latest_gain(ranking, count_searched(parameters), &designs)
    }

    /// Shows the best design so far, or how large the front is.
    fn show_lead(&self, combination: &ChoiceSet) {
        let [ranking] = self.batch.study.objectives() else {
            let costs: Vec<&[f64]> =
                self.standings.iter().filter_map(DesignStanding::costs).collect();
            self.tracing.board.show_lead(SearchLead::Front { designs: front(&costs).len() });
            return;
        };
        let scores = self.standings.iter().map(|own| own.score(&Goal::One(0)));
        let numbered = (1..).zip(scores).filter(|(_, score)| score.is_finite());
        let best = numbered.min_by(|one, other| one.1.total_cmp(&other.1));
        let best = best.and_then(|(number, _)| self.records.get(&number));
        if let Some((best, found)) =
            best.and_then(|own| Some((own, own.measure(&ranking.measure)?)))
        {
            let gain = self.latest_gain(combination);
            self.tracing.board.show_lead(SearchLead::Best(BestDesign {
                number: best.design,
                value: found.value,
                error: found.total_error(),
                passes: best.passes(),
                gain: gain.map(|own| (own.designs, own.gain.value)),
            }));
        }
    }
}

impl DesignMeter for RecordedDesigns<'_> {
    fn measure(
        &mut self,
        design: &Design,
        combination: &ChoiceSet,
    ) -> std::result::Result<DesignStanding, ProposalStop> {
        let objectives = self.batch.study.objectives();
        let standing = DesignStanding::of(objectives, self.recorded(design)?);
        self.standings.push(standing.clone());
        self.show_lead(combination);
        Ok(standing)
    }

    fn is_settled(&self, combination: &ChoiceSet) -> bool {
        let gain = || self.latest_gain(combination).map(|own| own.gain);
        let is_less = |least: f64| gain().is_some_and(|own| own.value <= least.max(own.std_error));
        self.plan.least_gain.is_some_and(is_less)
    }
}
