//! The estimators behind one seam: what every one of them answers, with one `match` per question.
//!
//! Photons are traced in every run, for the balance and for what they count on all sensors; that is
//! the forward estimator. The others trace gather paths of their own and may observe the photons.
//! Callers need not know windows, weights or records, which differ between estimators.

use crate::plan::Estimator;
use crate::scene::{RowReach, Scene, SensorId};
use crate::transport::backward::estimator as backward;
use crate::transport::backward::mix::{self, Mixing};
use crate::transport::backward::paths::Backward;
use crate::transport::connect::weights::Sharing;
use crate::transport::estimate::{Account, Estimate};
use crate::transport::gather::estimator::Gather;
use crate::transport::gather::merged::MergedStream;
use crate::transport::gather::stream::PhotonStream;
use crate::transport::gather::{self, GatherSettings};
use crate::transport::tally::{Counts, Series, Stage, merged};
use crate::transport::task::Task;
use crate::transport::trial::{Trials, Tried};
use crate::transport::{Event, Layout, Observer, Path, ROULETTE_BELOW, Readings, forward};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// An estimator with its sensors, ready to trace.
#[derive(Debug)]
pub(crate) enum Prepared<'s> {
    Backward(Backward<'s>),
    Mix(Backward<'s>),
    Gather(Gather<'s>),
    Mis(Gather<'s>),
}

/// What an estimator found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EstimatorFindings {
    /// The estimator.
    pub estimator: Estimator,
    /// Its sensors.
    pub sensors: Vec<SensorId>,
    /// Settings of gathering.
    pub settings: Option<GatherSettings>,
    /// Its last stages, at most three; one of the last two gives the values.
    pub stages: Vec<Stage>,
}

/// The units of work of an estimator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Portion {
    /// Short batches.
    Batch,
    /// Long passes of photons and gather paths.
    Pass,
}

/// What an estimator does in a block of batches, and in part with their photons.
pub(crate) enum BatchBlock<'b, 's> {
    Backward {
        own: &'b Backward<'s>,
        task: Task<'b>,
        ended: Vec<Counts>,
    },
    Mix {
        own: &'b Backward<'s>,
        task: Task<'b>,
        ended: Vec<Counts>,
        current: Option<Box<Mixing<'b, 's>>>,
    },
    Gather {
        first: u64,
        stream: Box<PhotonStream<'b, 's>>,
    },
    Mis {
        first: u64,
        stream: Box<MergedStream<'b, 's>>,
    },
}

impl<'s> Prepared<'s> {
    /// Its name.
    pub(crate) fn estimator(&self) -> Estimator {
        match self {
            Self::Backward(_) => Estimator::Backward,
            Self::Mix(_) => Estimator::Mix,
            Self::Gather(_) => Estimator::Gather,
            Self::Mis(_) => Estimator::Mis,
        }
    }

    /// Gather paths of a batch of a stage, from all of its sensors.
    pub(crate) fn batch_paths(&self, stage: u32) -> u64 {
        match self {
            Self::Backward(own) | Self::Mix(own) => own.batch_paths(),
            Self::Gather(own) | Self::Mis(own) => own.batch_paths(stage),
        }
    }

    /// The same with gather paths in a batch in proportion to these numbers, new and old; those of a pass are part of its settings.
    pub(crate) fn resized(self, sizes: [u64; 2]) -> Self {
        match self {
            Self::Backward(own) => Self::Backward(own.resized(sizes)),
            Self::Mix(own) => Self::Mix(own.resized(sizes)),
            Self::Gather(_) | Self::Mis(_) => self,
        }
    }

    /// Its unit of work.
    pub(crate) fn portion(&self) -> Portion {
        match self {
            Self::Backward(_) | Self::Mix(_) => Portion::Batch,
            Self::Gather(_) | Self::Mis(_) => Portion::Pass,
        }
    }

    /// Batches that a thread traces together, a block: photons of passes of gathering meet the records of all of them.
    pub(crate) fn block_batches(&self) -> u64 {
        match self {
            Self::Backward(_) | Self::Mix(_) => 1,
            Self::Gather(own) | Self::Mis(own) => own.passes_together(),
        }
    }

    /// Begins a block, from the task's batch on; `None` if it was stopped.
    pub(crate) fn begin<'b>(&'b self, task: Task<'b>, batches: u64) -> Option<BatchBlock<'b, 's>> {
        let ended = Vec::with_capacity(batches as usize);
        Some(match self {
            Self::Backward(own) => BatchBlock::Backward { own, task, ended },
            Self::Mix(own) => BatchBlock::Mix { own, task, ended, current: None },
            Self::Gather(own) => {
                BatchBlock::Gather { first: task.batch, stream: own.begin(task, batches)?.into() }
            }
            Self::Mis(own) => {
                let stream = MergedStream::begin(own, task, batches)?.into();
                BatchBlock::Mis { first: task.batch, stream }
            }
        })
    }

    /// Divides the light of paths among techniques in another way.
    pub(crate) fn share_by(&mut self, sharing: Sharing) {
        match self {
            Self::Backward(own) | Self::Mix(own) => own.sharing = sharing,
            Self::Gather(own) | Self::Mis(own) => {
                own.merging.iter_mut().for_each(|own| own.sharing = sharing);
            }
        }
    }

    /// Batches of the stage in progress after which it decides how to go on; `None` if it has no
    /// such decisions.
    pub(crate) fn next_decision(&self, series: &Series) -> Option<u64> {
        match self {
            Self::Backward(_) | Self::Mix(_) => None,
            Self::Gather(own) | Self::Mis(own) => {
                Some(own.settings.next_decision(series.stage(), series.batches()))
            }
        }
    }

    /// Whether a stage with less bias may follow the one in progress now.
    pub(crate) fn may_end_stage(&self, series: &Series) -> bool {
        match self {
            Self::Backward(_) | Self::Mix(_) => false,
            Self::Gather(own) | Self::Mis(own) => {
                series.batches() >= own.settings.planned_passes(series.stage())
            }
        }
    }

    /// Whether it has stages, each with less bias than the one before.
    pub(crate) fn has_stages(&self) -> bool {
        match self {
            Self::Backward(_) | Self::Mix(_) => false,
            Self::Gather(own) | Self::Mis(own) => own.settings.has_stages(),
        }
    }

    /// How many stages ahead the next one should be: 0 where bias limits none of its values more than noise does.
    pub(crate) fn stages_ahead(&self, series: &Series, photons: &Readings) -> u32 {
        match self {
            Self::Gather(own) | Self::Mis(own) if series.batches() > 0 => {
                own.shrinks(&series.stages(), photons)
            }
            Self::Backward(_) | Self::Mix(_) | Self::Gather(_) | Self::Mis(_) => 0,
        }
    }

    /// What it has found so far.
    pub(crate) fn found(&self, series: &Series) -> EstimatorFindings {
        let (settings, sensors) = match self {
            Self::Backward(own) | Self::Mix(own) => (None, own.sensors().collect()),
            Self::Gather(own) | Self::Mis(own) => (Some(own.settings), own.sensors().collect()),
        };
        EstimatorFindings {
            estimator: self.estimator(),
            sensors,
            settings,
            stages: series.stages(),
        }
    }
}

impl BatchBlock<'_, '_> {
    /// Makes ready for the photons of a batch of the block; `None` if stopped.
    pub(crate) fn begin_photons(&mut self, batch: u64) -> Option<()> {
        match self {
            Self::Backward { own, task, ended } => {
                ended.push(Counts::closed([own.trace(Task { batch, ..*task })?]));
            }
            Self::Mix { own, task, ended, current } => {
                let next = Mixing::begin(own, Task { batch, ..*task })?;
                ended.extend(current.replace(Box::new(next)).map(|own| own.into_counts()));
            }
            Self::Gather { first, stream } => stream.begin_pass((batch - *first) as usize),
            Self::Mis { first, stream } => stream.begin_pass((batch - *first) as usize),
        }
        Some(())
    }

    /// Whether it observes photons.
    pub(crate) fn observes(&self) -> bool {
        match self {
            Self::Backward { .. } => false,
            Self::Mix { .. } | Self::Gather { .. } | Self::Mis { .. } => true,
        }
    }

    /// The counts of all batches, after the photons of the last.
    pub(crate) fn finish(self) -> Counts {
        match self {
            Self::Backward { ended, .. } => merged(ended),
            Self::Mix { ended, current, .. } => {
                merged(ended.into_iter().chain(current.map(|own| own.into_counts())))
            }
            Self::Gather { stream, .. } => stream.into_counts(),
            Self::Mis { stream, .. } => stream.into_counts(),
        }
    }
}

impl Observer for BatchBlock<'_, '_> {
    #[inline]
    fn roulette_below(&self) -> f64 {
        match self {
            Self::Backward { .. } | Self::Mix { current: None, .. } => ROULETTE_BELOW,
            Self::Mix { current: Some(own), .. } => own.roulette_below(),
            Self::Gather { stream, .. } => stream.roulette_below(),
            Self::Mis { stream, .. } => stream.roulette_below(),
        }
    }

    #[inline]
    fn allows_jumps(&self) -> bool {
        match self {
            Self::Backward { .. } | Self::Mix { current: None, .. } => true,
            Self::Mix { current: Some(own), .. } => own.allows_jumps(),
            Self::Gather { stream, .. } => stream.allows_jumps(),
            Self::Mis { .. } => false,
        }
    }

    #[inline]
    fn limit_row(&self, path: &Path, reach: &mut RowReach) {
        match self {
            Self::Backward { .. } | Self::Mix { .. } | Self::Mis { .. } => {}
            Self::Gather { stream, .. } => stream.limit_row(path, reach),
        }
    }

    #[inline]
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        match self {
            Self::Backward { .. } | Self::Mix { current: None, .. } => ControlFlow::Continue(()),
            Self::Mix { current: Some(own), .. } => own.see(path, event),
            Self::Gather { stream, .. } => stream.see(path, event),
            Self::Mis { stream, .. } => stream.see(path, event),
        }
    }
}

/// All estimators of a block, as one observer of its photons.
pub(crate) struct Observers<'o, 'b, 's>(pub(crate) &'o mut [BatchBlock<'b, 's>]);

impl Observer for Observers<'_, '_, '_> {
    /// The smallest of all: merged paths have weights that roulette would change.
    #[inline]
    fn roulette_below(&self) -> f64 {
        self.0.iter().map(Observer::roulette_below).fold(ROULETTE_BELOW, f64::min)
    }

    #[inline]
    fn allows_jumps(&self) -> bool {
        self.0.iter().all(Observer::allows_jumps)
    }

    #[inline]
    fn limit_row(&self, path: &Path, reach: &mut RowReach) {
        self.0.iter().for_each(|one| one.limit_row(path, reach));
    }

    #[inline]
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        self.0.iter_mut().try_for_each(|one| one.see(path, event))
    }
}

/// The estimate of a sensor, from what its estimator found and from photons.
pub(crate) fn estimate<'a>(
    scene: &Scene,
    (estimator, found): (Estimator, Option<&'a EstimatorFindings>),
    photons: &'a Readings,
    id: SensorId,
) -> Estimate<'a> {
    let layout = Layout::new(scene);
    let stages = found.map_or(&[][..], |found| &found.stages);
    let last = || stages.last().map(|stage| stage.counts.first());
    let own = match estimator {
        Estimator::Forward => None,
        Estimator::Backward => last().map(|own| backward::estimate(own, photons, &layout, id)),
        Estimator::Mix => last().map(|own| unbiased(estimator, own)),
        Estimator::Gather | Estimator::Mis => {
            gather::estimate(estimator, (stages, photons), &layout.flux_slots(id))
        }
    };
    own.unwrap_or_else(|| unbiased(Estimator::Forward, photons))
}

fn unbiased(estimator: Estimator, readings: &Readings) -> Estimate<'_> {
    Estimate { estimator, readings, bias: None, is_contradicted: false }
}

/// How the values of a sensor were computed, where there is something to say.
pub(crate) fn account(
    scene: &Scene,
    found: &EstimatorFindings,
    photons: &Readings,
    id: SensorId,
) -> Option<Account> {
    match found.estimator {
        Estimator::Forward | Estimator::Backward | Estimator::Mix => None,
        Estimator::Gather | Estimator::Mis => {
            let settings = found.settings.as_ref()?;
            gather::account((scene, settings), found.estimator, (&found.stages, photons), id)
        }
    }
}

/// Tries an estimator on all sensors; `None` if stopped.
pub(crate) fn trial(estimator: Estimator, trials: &Trials<'_>) -> Option<Vec<Tried>> {
    match estimator {
        Estimator::Forward => forward::trial(trials),
        Estimator::Backward => backward::trial(trials),
        Estimator::Mix => mix::trial(trials),
        Estimator::Gather => gather::trial(trials),
        // A pilot does not choose it.
        Estimator::Mis => Some(Vec::new()),
    }
}
