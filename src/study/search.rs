//! A search for the best design, or for a front: the designs that are proposed are traced one after the other.
//!
//! A resumed search proposes the same designs again and takes their records.

use crate::study::analysis::Gains;
use crate::study::board::{BestDesign, SearchLead};
use crate::study::designs::Design;
use crate::study::execute::{DesignBatch, DesignEnd, DesignTracing, expect_design, settings};
use crate::study::propose::{DesignMeter, ProposalEnd, ProposalStop, propose};
use crate::study::score::{DesignStanding, Goal, unbeaten};
use indexmap::IndexMap;
use lumiduct_base::error::Result;
use lumiduct_input::{Ranking, SearchPlan, Setting};
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

    /// The measure that decides; `None` for a front.
    fn ranking(&self) -> Option<&Ranking> {
        self.batch.study.ranking.as_ref()
    }

    /// What the latest designs with the choices of some settings have gained.
    fn latest_gain(&self, settings: &IndexMap<String, Setting>) -> Option<LatestGain> {
        let parameters = self.batch.study.parameters.iter().map(|own| (&own.name, &own.domain));
        let designs = self.records.range(..=self.standings.len()).map(|(_, record)| record);
        Gains::new(self.ranking()?, parameters).latest(settings, designs)
    }

    /// The best design so far, or how large the front is; `None` while nothing could be measured.
    fn lead(&self) -> Option<SearchLead> {
        let Some(ranking) = self.ranking() else {
            let costs: Vec<&[f64]> =
                self.standings.iter().filter_map(DesignStanding::costs).collect();
            return Some(SearchLead::Front { designs: unbeaten(&costs).len() });
        };
        let scores = self.standings.iter().map(|own| own.score(&Goal::One(0)));
        let numbered = (1..).zip(scores).filter(|(_, score)| score.is_finite());
        let (number, _) = numbered.min_by(|one, other| one.1.total_cmp(&other.1))?;
        let best = self.records.get(&number)?;
        let found = best.measure(&ranking.measure)?;
        Some(SearchLead::Best(BestDesign {
            number,
            value: found.value,
            error: found.total_error(),
            passes: best.passes(),
            gain: self.latest_gain(&best.settings),
        }))
    }
}

impl DesignMeter for RecordedDesigns<'_> {
    fn measure(&mut self, design: &Design) -> std::result::Result<DesignStanding, ProposalStop> {
        let study = self.batch.study;
        let objectives = match &study.ranking {
            Some(ranking) => std::slice::from_ref(ranking),
            None => study.objectives(),
        };
        let standing = DesignStanding::of(objectives, self.recorded(design)?);
        self.standings.push(standing.clone());
        if let Some(lead) = self.lead() {
            self.tracing.board.show_lead(lead);
        }
        Ok(standing)
    }

    fn is_settled(&self, next: &Design) -> bool {
        let gain = || self.latest_gain(&settings(self.batch.study, next)).map(|own| own.gain);
        let is_within =
            |least: f64| gain().is_some_and(|own| own.value <= least.max(own.std_error));
        self.plan.least_gain.is_some_and(is_within)
    }
}
