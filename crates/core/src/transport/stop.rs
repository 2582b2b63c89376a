//! What stops a run from outside, the user or the clock, and how often tracing checks for it.
//!
//! The interval between two checks is a fixed amount of counted work, not of time. Stopped work is
//! dropped as a whole: results depend only on the number of finished batches.

use crate::transport::tally::work;
use std::cell::Cell;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Work between two checks, in segments of paths: a tenth of a millisecond in simple scenes,
/// some milliseconds where a ray is expensive.
pub(crate) const CHECK_EVERY: u32 = 1024;
/// Work of a gather path with its records, in segments: it follows from the times in
/// [`crate::transport::tally::work`].
pub(crate) const RECORD_WORK: u32 = 32;
/// Time by which a run may exceed its limit if it has no finished batch, so that short runs have
/// something to report.
pub const FIRST_BATCH_GRACE: Duration = Duration::from_millis(400);

/// Activity of a program when the user requests a stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Activity {
    /// It reads, computes, compares or draws something that is only useful as a whole: nothing is
    /// lost or half written if it ends at once.
    Computing,
    /// It traces: paths end at their next check, and the finished work is reported.
    Tracing,
    /// Files are moved into place, which takes little time.
    Writing,
}

/// Effect of a request to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopAnswer {
    /// The run ends by itself.
    EndRun,
    /// The program must end now.
    EndProgram,
}

/// A flag that stops a run.
#[derive(Debug, Clone, Default)]
pub struct Interrupt(Arc<Flag>);

#[derive(Debug)]
struct Flag {
    raised: AtomicBool,
    /// An [`Activity`].
    activity: AtomicU8,
    /// Checks by runs in progress.
    checks: AtomicU64,
    /// The check at which the flag is raised.
    raised_at: u64,
}

impl Default for Flag {
    fn default() -> Self {
        Self {
            raised: AtomicBool::new(false),
            activity: AtomicU8::new(Activity::Computing as u8),
            checks: AtomicU64::new(0),
            raised_at: u64::MAX,
        }
    }
}

impl Interrupt {
    /// A flag that is raised at the given check of a run, counted from 1: for tests that do not
    /// depend on time.
    pub fn at_check(check: u64) -> Self {
        Self(Arc::new(Flag { raised_at: check, ..Flag::default() }))
    }

    /// Records the activity of the program from now on.
    pub fn begin(&self, activity: Activity) {
        self.0.activity.store(activity as u8, Ordering::SeqCst);
    }

    /// Requests a stop, as the user does; the effect depends on the current activity. The second
    /// request ends the program in any case.
    pub fn request(&self) -> StopAnswer {
        let is_second = self.0.raised.swap(true, Ordering::SeqCst);
        let is_computing = self.0.activity.load(Ordering::SeqCst) == Activity::Computing as u8;
        if is_second || is_computing { StopAnswer::EndProgram } else { StopAnswer::EndRun }
    }

    /// Requests the run to stop.
    pub fn raise(&self) {
        self.0.raised.store(true, Ordering::Relaxed);
    }

    /// Whether the run is requested to stop.
    pub fn is_raised(&self) -> bool {
        self.0.raised.load(Ordering::Relaxed)
    }

    /// Number of checks by runs.
    pub fn checks(&self) -> u64 {
        self.0.checks.load(Ordering::Relaxed)
    }

    fn check(&self) -> bool {
        let check = self.0.checks.fetch_add(1, Ordering::Relaxed) + 1;
        if check >= self.0.raised_at {
            self.raise();
        }
        self.is_raised()
    }
}

/// What stops a run from outside: an interrupt, and its time limit.
#[derive(Debug, Clone, Default)]
pub struct StopSignal {
    interrupt: Interrupt,
    end: Option<TimeLimit>,
}

/// The end of a run's time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum TimeLimit {
    /// At a time.
    At(Instant),
    /// After this many checks, and some more as grace: a clock that counts work.
    AtCheck { check: u64, grace: u64 },
}

impl StopSignal {
    /// An interrupt, and an end if the time is limited.
    pub fn new(interrupt: &Interrupt, end: Option<Instant>) -> Self {
        Self { interrupt: interrupt.clone(), end: end.map(TimeLimit::At) }
    }

    /// A time that ends at a check of the interrupt, with some more checks of grace: a clock that
    /// counts work and not time, for tests.
    pub fn ending_at_check(interrupt: &Interrupt, check: u64, grace: u64) -> Self {
        Self { interrupt: interrupt.clone(), end: Some(TimeLimit::AtCheck { check, grace }) }
    }

    /// Whether work must stop.
    pub(crate) fn is_due(&self) -> bool {
        self.interrupt.check() || self.end.is_some_and(|end| self.is_over(end))
    }

    fn is_over(&self, end: TimeLimit) -> bool {
        match end {
            TimeLimit::At(end) => Instant::now() >= end,
            TimeLimit::AtCheck { check, .. } => self.interrupt.checks() >= check,
        }
    }

    /// The same with [`FIRST_BATCH_GRACE`] more time.
    pub(crate) fn with_grace(&self) -> Self {
        self.with_end(|end| match end {
            TimeLimit::At(end) => TimeLimit::At(end.checked_add(FIRST_BATCH_GRACE).unwrap_or(end)),
            TimeLimit::AtCheck { check, grace } => {
                TimeLimit::AtCheck { check: check + grace, grace }
            }
        })
    }

    /// The same with half of the remaining time.
    pub(crate) fn with_half(&self) -> Self {
        let now = Instant::now();
        self.with_end(|end| match end {
            TimeLimit::At(end) => TimeLimit::At(now + end.saturating_duration_since(now) / 2),
            TimeLimit::AtCheck { check, grace } => {
                let left = check.saturating_sub(self.interrupt.checks());
                TimeLimit::AtCheck { check: check - left / 2, grace }
            }
        })
    }

    /// Whether the clock ends work.
    pub(crate) fn is_timed(&self) -> bool {
        matches!(self.end, Some(TimeLimit::At(_)))
    }

    /// Work of one thread that fits in the remaining time, ns (`work`); `None` if it is not limited. A thread does `speed`
    /// times as much as that of the reference machine.
    pub(crate) fn work_left(&self, speed: f64) -> Option<f64> {
        Some(match self.end? {
            TimeLimit::At(end) => {
                1e9 * speed * end.saturating_duration_since(Instant::now()).as_secs_f64()
            }
            TimeLimit::AtCheck { check, .. } => {
                let left = check.saturating_sub(self.interrupt.checks());
                work::OF_PHOTON_SEGMENT * left as f64 * f64::from(CHECK_EVERY)
            }
        })
    }

    fn with_end(&self, other: impl FnOnce(TimeLimit) -> TimeLimit) -> Self {
        Self { interrupt: self.interrupt.clone(), end: self.end.map(other) }
    }
}

/// The work of one batch or pass, which a signal can end.
#[derive(Debug)]
pub struct Pace<'a> {
    signal: &'a StopSignal,
    /// Work until the next check.
    left: Cell<u32>,
    is_stopped: Cell<bool>,
}

impl<'a> Pace<'a> {
    /// Checks the signal for the first time.
    pub fn new(signal: &'a StopSignal) -> Self {
        let pace = Self { signal, left: Cell::new(0), is_stopped: Cell::new(false) };
        _ = pace.check();
        pace
    }

    /// Counts work, in segments of paths; a break ends the batch.
    #[inline(always)]
    pub(crate) fn spend(&self, work: u32) -> ControlFlow<()> {
        let left = self.left.get();
        if left > work {
            self.left.set(left - work);
            return ControlFlow::Continue(());
        }
        self.check()
    }

    /// Whether the batch must be dropped.
    pub(crate) fn is_stopped(&self) -> bool {
        self.is_stopped.get()
    }

    #[cold]
    #[inline(never)]
    fn check(&self) -> ControlFlow<()> {
        // For a stopped batch nothing is left: every further piece of work gets here and ends.
        if !self.is_stopped() && !self.signal.is_due() {
            self.left.set(CHECK_EVERY);
            return ControlFlow::Continue(());
        }
        self.left.set(0);
        self.is_stopped.set(true);
        ControlFlow::Break(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pace_checks_after_a_fixed_amount_of_work_and_stays_stopped() {
        let interrupt = Interrupt::at_check(4);
        let signal = StopSignal::new(&interrupt, None);
        let pace = Pace::new(&signal);
        let mut work = 0;
        while pace.spend(1).is_continue() {
            work += 1;
        }
        assert_eq!(interrupt.checks(), 4);
        assert_eq!(work, 3 * CHECK_EVERY - 1, "two checks went by, the third ended it");
        assert!(pace.is_stopped() && pace.spend(1).is_break());
        assert_eq!(interrupt.checks(), 4, "a stopped batch does not check again");
    }

    #[test]
    fn an_end_in_the_past_stops_at_the_first_check_unless_there_is_grace() {
        let now = Instant::now();
        let signal = StopSignal::new(&Interrupt::default(), Some(now));
        assert!(Pace::new(&signal).is_stopped());
        assert!(signal.with_half().is_due());
        assert_eq!(signal.with_grace().end, Some(TimeLimit::At(now + FIRST_BATCH_GRACE)));
        assert!(!Pace::new(&StopSignal::default()).is_stopped());
    }

    #[test]
    fn the_first_request_ends_what_is_traced_and_the_second_the_program() {
        let interrupt = Interrupt::default();
        interrupt.begin(Activity::Tracing);
        assert_eq!(interrupt.request(), StopAnswer::EndRun);
        assert!(interrupt.is_raised());
        assert_eq!(interrupt.request(), StopAnswer::EndProgram);
        for (activity, answer) in [
            (Activity::Computing, StopAnswer::EndProgram),
            (Activity::Tracing, StopAnswer::EndRun),
            (Activity::Writing, StopAnswer::EndRun),
        ] {
            let interrupt = Interrupt::default();
            interrupt.begin(activity);
            assert_eq!(interrupt.request(), answer, "{activity:?}");
        }
        assert_eq!(Interrupt::default().request(), StopAnswer::EndProgram, "before tracing");
    }
}
