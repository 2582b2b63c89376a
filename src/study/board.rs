//! What a batch reports while it runs.

use lumiduct_base::error::Diagnostic;
use lumiduct_base::number::{format_value, format_with_error};
use lumiduct_report::study::LatestGain;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// What a batch reports before its results.
#[derive(Debug, Clone, Copy)]
pub enum BatchEvent<'a> {
    /// Study and scene have been read, with these remarks.
    Read(&'a [Diagnostic]),
    /// Designs are being computed.
    Progress(BatchProgress),
}

/// Progress of a batch.
#[derive(Debug, Clone, Copy)]
pub struct BatchProgress {
    /// Designs with a record, including those of an earlier run.
    pub done: usize,
    /// Designs that need one.
    pub wanted: usize,
    /// Designs recorded by an earlier run.
    pub found: usize,
    /// Share of this run's work that is done, 0..=1: designs that have ended, and parts of those in flight.
    pub fraction: f64,
    /// Time since the start.
    pub elapsed: Duration,
    /// What a search has found so far.
    pub lead: Option<SearchLead>,
}

/// What a search has found so far.
#[derive(Debug, Clone, Copy)]
pub enum SearchLead {
    /// The best design.
    Best(BestDesign),
    /// The size of the front.
    Front {
        /// Designs on it.
        designs: usize,
    },
}

/// The best design of a search so far.
#[derive(Debug, Clone, Copy)]
pub struct BestDesign {
    /// Its number, from 1.
    pub number: usize,
    /// The measure that decides, in its unit.
    pub value: f64,
    /// Its standard error with bias, in the unit of the measure.
    pub error: f64,
    /// Whether it passes every check; if not, it is the closest to that.
    pub passes: bool,
    /// How much better the latest designs with its choices have made it; `None` while no earlier one passes.
    pub gain: Option<LatestGain>,
}

impl BatchProgress {
    /// Designs done, and the time left.
    pub fn sentence(&self) -> String {
        let found = if self.found > 0 {
            format!(" ({} of them before)", self.found)
        } else {
            String::new()
        };
        let mut text = format!("{} of {} designs{found}", self.done, self.wanted);
        if self.fraction > 0.0 {
            let left = self.elapsed.as_secs_f64() * (1.0 - self.fraction) / self.fraction;
            text += &format!(", {left:.0} s left");
        }
        text += &self.lead.map_or(String::new(), |lead| lead.words());
        text
    }
}

impl SearchLead {
    /// Words that follow those of the progress.
    fn words(self) -> String {
        let BestDesign { number, value, error, passes, gain } = match self {
            Self::Best(best) => best,
            Self::Front { designs } => return format!(", {designs} on the front"),
        };
        if !passes {
            return format!(", design {number} is the closest to passing its checks");
        }
        let found = if error > 0.0 { format_with_error(value, error) } else { format_value(value) };
        let gained = gain.map_or(String::new(), |LatestGain { designs, gain }| {
            format!(" (the latest {designs} gained {})", format_value(gain.value))
        });
        format!(", best is design {number}: {found}{gained}")
    }
}

/// Progress of all designs in flight.
pub(crate) struct Board<'a> {
    wanted: usize,
    pending: usize,
    start: Instant,
    watch: &'a (dyn Fn(BatchEvent<'_>) + Sync),
    state: Mutex<BoardState>,
}

/// What changes on a board.
#[derive(Default)]
struct BoardState {
    /// Designs that have ended.
    ended: usize,
    /// Numbers of those in flight, with the shares that are done.
    in_flight: Vec<(usize, f64)>,
    lead: Option<SearchLead>,
}

impl<'a> Board<'a> {
    pub(crate) fn new(
        [wanted, pending]: [usize; 2],
        watch: &'a (dyn Fn(BatchEvent<'_>) + Sync),
    ) -> Self {
        let state = Mutex::default();
        Self { wanted, pending, start: Instant::now(), watch, state }
    }

    pub(crate) fn go_on(&self, design: usize, fraction: f64) {
        if let Ok(mut state) = self.state.lock() {
            match state.in_flight.iter_mut().find(|(number, _)| *number == design) {
                Some(own) => own.1 = fraction,
                None => state.in_flight.push((design, fraction)),
            }
        }
        self.show();
    }

    /// Shows what a search has found so far.
    pub(crate) fn show_lead(&self, lead: SearchLead) {
        if let Ok(mut state) = self.state.lock() {
            state.lead = Some(lead);
        }
        self.show();
    }

    pub(crate) fn end(&self, design: usize) {
        if let Ok(mut state) = self.state.lock() {
            state.ended += 1;
            state.in_flight.retain(|(number, _)| *number != design);
        }
        self.show();
    }

    pub(crate) fn show(&self) {
        let Ok(state) = self.state.lock() else { return };
        let BoardState { ended, in_flight, lead } = &*state;
        let in_flight = in_flight.iter().map(|(_, share)| share).sum::<f64>();
        let found = self.wanted - self.pending;
        (self.watch)(BatchEvent::Progress(BatchProgress {
            done: found + ended,
            wanted: self.wanted,
            found,
            fraction: ((*ended as f64 + in_flight) / self.pending.max(1) as f64).min(1.0),
            elapsed: self.start.elapsed(),
            lead: *lead,
        }));
    }
}
