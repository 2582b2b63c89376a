//! The gather method: gather paths of limited depth from the sensors end in records, and photons
//! are streamed past them.
//!
//! A gather path continues through specular and narrow scatter up to vertex D, where it leaves
//! records for photons that travel near the mirrored and the refracted direction: the
//! position-and-angle estimate. On a surface that scatters broadly, and where a medium scatters, it
//! leaves records for all photons: the position estimate. Emission that it meets counts directly;
//! photons give all other light, including what could be seen through vertex D. So nothing counts
//! twice. All sensors share one stream of photons, and no photon is kept: memory scales with the
//! records. When merged with forward and backward, gather paths continue to the sources, and
//! everything counts by its weight (`merge`).

use crate::rng::Sampler;
use crate::scene::Arrival;
use crate::transport::forward::Forward;
use crate::transport::gather::collect::{Collecting, Found};
use crate::transport::gather::estimator::{Gather, Pass, PassReadings, Waiting};
use crate::transport::gather::merged::{MergedStream, Merging};
use crate::transport::gather::records::Records;
use crate::transport::gather::stream::Stream;
use crate::transport::gather::window::ESTIMATES;
use crate::transport::stop::{Pace, RECORD_WORK, StopSignal};
use crate::transport::walk::follow::{Gathering, follow};
use crate::transport::{Observer, Path, Readings};

/// Streams of random numbers of the gather paths and of their records; each sensor has a separate
/// one.
const PATH_STREAM: u64 = 2 << 32;
const RECORD_STREAM: u64 = 3 << 32;

impl<'s> Gather<'s> {
    /// Runs one pass with the photons of a batch, which can have another observer unless all is
    /// merged. `None` if it was stopped.
    pub(crate) fn pass(
        &self,
        forward: &Forward<'_>,
        pass: Pass,
        beside: &mut impl Observer,
        signal: &StopSignal,
    ) -> Option<PassReadings> {
        let pace = Pace::new(signal);
        let paths = pass.gather_paths;
        let empty = || Readings::of_batch(self.scene, &self.layout, self.seed, paths, pass.batch);
        let mut windows = [empty(), empty(), empty(), empty()];
        let photon_fluxes = forward.photon_fluxes();
        let beside_paths = Beside { photon_fluxes: &photon_fluxes, pace: &pace };
        let waiting = self.gather_paths(pass, beside_paths, &mut windows)?;
        let mut stream = Stream::new(self, pass, (&waiting, &pace), &mut windows);
        let photons = match self.merging {
            None => forward.batch_observed(pass.batch, &mut (&mut stream, beside), &pace)?,
            Some(_) => {
                let mut merged = MergedStream::new(&mut stream, pass, &photon_fluxes);
                forward.batch_observed(pass.batch, &mut merged, &pace)?
            }
        };
        let work = stream.finish();
        (!pace.is_stopped()).then_some(PassReadings { photons, windows, work })
    }

    /// Traces the gather paths of a pass; `None` if they were stopped.
    fn gather_paths(
        &self,
        pass: Pass,
        Beside { photon_fluxes, pace }: Beside<'_>,
        windows: &mut [Readings; ESTIMATES],
    ) -> Option<Waiting<'s>> {
        let mut found = Found::default();
        for (id, arrivals) in &self.sensors {
            for index in pass.batch * pass.gather_paths..(pass.batch + 1) * pass.gather_paths {
                if pace.spend(RECORD_WORK).is_break() {
                    return None;
                }
                let stream = id.index() as u64;
                let mut sampler = Sampler::for_path(self.seed, PATH_STREAM + stream, index);
                let Some(arrival) = arrivals.draw(&mut sampler) else { continue };
                let Arrival { extent, cells, .. } = &arrival;
                let etendue = Path::arriving(self.scene, &arrival).etendue(self.scene, *extent);
                let etendue = etendue / pass.gather_paths as f64;
                let mut collecting = Collecting {
                    gather: self,
                    window: pass.window,
                    etendue,
                    merging: self.merging.map(|_| Merging::new(etendue, photon_fluxes)),
                    id: *id,
                    index,
                    cells,
                    sampler: Sampler::for_path(self.seed, RECORD_STREAM + stream, index),
                    facing: None,
                    found: &mut found,
                    windows,
                };
                let gathering = Gathering {
                    scene: self.scene,
                    emitters: &self.emitters,
                    sensor: *id,
                    bounce_limit: self.merging.unwrap_or(u32::MAX),
                    pace: Some(pace),
                };
                let segments = follow(gathering, &arrival, &mut sampler, &mut collecting);
                windows[0].segments += segments;
            }
        }
        let records = Records::new(found.records, pass.window, &self.surfaces, pace)?;
        Some(Waiting { paths: found.paths, records })
    }
}

/// Context of the gather paths of a pass.
#[derive(Clone, Copy)]
struct Beside<'a> {
    /// Flux of one photon of each source, lm or W.
    photon_fluxes: &'a [f64],
    /// Stops the paths.
    pace: &'a Pace<'a>,
}
