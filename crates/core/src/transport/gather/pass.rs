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
//! everything counts by its weight (`merged`).

use crate::rng::{Numbers, Points, Sampler, stream};
use crate::scene::{Arrival, SensorId, Wavelengths};
use crate::transport::backward::counter::GatherPathCounter;
use crate::transport::connect::passage::{PassedRecords, RecordPlaces};
use crate::transport::connect::vertex::Turns;
use crate::transport::gather::block::CrossedCounts;
use crate::transport::gather::collect::{Collecting, EndedPaths};
use crate::transport::gather::estimator::{Gather, WaitingRecords};
use crate::transport::gather::kernel::ORDERS;
use crate::transport::gather::records::Records;
use crate::transport::gather::shares::MergedPath;
use crate::transport::gather::stages::Pass;
use crate::transport::gather::stream::PhotonStream;
use crate::transport::gather::watched::WatchedLegs;
use crate::transport::stop::RECORD_WORK;
use crate::transport::task::Task;
use crate::transport::walk::follow::{Gathering, follow};
use crate::transport::{Path, Readings};

/// A gather path that starts from a sensor.
struct StartedPath<'a, N> {
    id: SensorId,
    /// Its number among those of its sensor.
    index: u64,
    arrival: &'a Arrival,
    sampler: Sampler<N>,
}

impl<'s> Gather<'s> {
    /// Traces the gather paths of a block of passes, from the task's batch on, whose records then wait for the photons of
    /// all of them. `None` if stopped.
    pub(crate) fn begin<'g>(&'g self, task: Task<'g>, passes: u64) -> Option<PhotonStream<'g, 's>> {
        self.trace_records(task, passes).map(|(stream, _)| stream)
    }

    /// The same, and by pass the light that merged gather paths have met, without records.
    pub(super) fn trace_records<'g>(
        &'g self,
        task: Task<'g>,
        passes: u64,
    ) -> Option<(PhotonStream<'g, 's>, Vec<Readings>)> {
        let passes = passes as usize;
        let pass_of = |place: usize| self.settings.pass(task.stage, task.batch + place as u64);
        let empty = |place| {
            let Pass { gather_paths, batch, .. } = pass_of(place);
            Readings::of_batch(self.scene, &self.layout, self.seed, gather_paths, batch)
        };
        let mut counts = CrossedCounts::new(passes, self.scene.sensors.len(), empty);
        let mut met: Vec<Readings> = Vec::new();
        if self.merging.is_some() {
            met.extend((0..passes).map(empty));
        }
        let mut found = EndedPaths { passes, ..EndedPaths::default() };
        for place in 0..passes {
            found.pass = place;
            let readings = (counts.pass(place), met.get_mut(place));
            self.gather_paths_of(pass_of(place), task, readings, &mut found)?;
        }
        let first = pass_of(0);
        let records = Records::new(found.records, first.window, &self.surfaces, task.pace)?;
        let watched = WatchedLegs::new(self.scene, &self.surfaces, &records.all, first.window);
        let waiting = WaitingRecords { paths: found.paths, records, watched };
        Some((PhotonStream::new(self, first, (waiting, task.pace), counts), met))
    }

    /// Traces the gather paths of a pass; `None` if they were stopped.
    fn gather_paths_of(
        &self,
        pass: Pass,
        task: Task<'_>,
        (orders, mut met): (&mut [Readings; ORDERS], Option<&mut Readings>),
        found: &mut EndedPaths<'s>,
    ) -> Option<()> {
        let wavelengths = Wavelengths::of_pass(self.seed, pass.batch);
        let mut joints = Sampler::for_path(self.seed, stream::JOINED_SOURCES, pass.batch);
        for (id, arrivals) in &self.sensors {
            let offset = id.index() as u64;
            let of_sensor = stream::GATHER_POINTS + offset;
            let mut points =
                Points::of_batch((self.seed, of_sensor, pass.batch), pass.gather_paths);
            for index in pass.batch * pass.gather_paths..(pass.batch + 1) * pass.gather_paths {
                if task.pace.spend(RECORD_WORK).is_break() {
                    return None;
                }
                let mut fresh = Sampler::for_path(self.seed, stream::GATHER + offset, index);
                let mut sampler = points.lead(&mut fresh);
                let Some(arrival) = arrivals.draw_of(wavelengths, &mut sampler) else { continue };
                let path = StartedPath { id: *id, index, arrival: &arrival, sampler };
                let shared = met.as_deref_mut().map(|readings| (readings, &mut joints));
                self.gather_path(path, (pass, task), (orders, shared), found);
            }
        }
        Some(())
    }

    /// Traces one gather path: alone it counts in all orders, merged in other readings.
    fn gather_path(
        &self,
        StartedPath { id, index, arrival, mut sampler }: StartedPath<'_, impl Numbers>,
        (pass, task): (Pass, Task<'_>),
        (orders, shared): (&mut [Readings; ORDERS], Option<(&mut Readings, &mut Sampler)>),
        found: &mut EndedPaths<'s>,
    ) {
        let etendue = Path::arriving(self.scene, arrival).etendue(self.scene, arrival.extent);
        let etendue = etendue / pass.gather_paths as f64;
        let (batches, places) = (found.passes as f64, self.record_places(pass));
        let merging = self.merging.as_ref();
        let mut collecting = Collecting {
            gather: self,
            window: pass.window,
            etendue,
            merged: merging.map(|_| MergedPath::new(arrival, etendue / batches, places)),
            id,
            index,
            cells: &arrival.cells,
            sampler: Sampler::for_path(self.seed, stream::RECORDS + id.index() as u64, index),
            facing: None,
            found,
            orders,
        };
        let gathering = Gathering {
            scene: self.scene,
            emitters: &self.emitters,
            sensor: id,
            bounce_limit: merging.map_or(u32::MAX, |own| own.bounce_limit),
            pace: Some(task.pace),
        };
        let segments = if let (Some(backward), Some((readings, joints))) = (merging, shared) {
            let mut counter = GatherPathCounter {
                backward,
                arrival,
                etendue,
                radiance: 0.0,
                share: 1.0 / pass.gather_paths as f64,
                id,
                photon_fluxes: Some(task.photon_fluxes),
                batches,
                records: Some(PassedRecords::new(places)),
                turns: Turns::default(),
                joints,
                readings,
            };
            follow(gathering, arrival, &mut sampler, &mut (&mut counter, &mut collecting))
        } else {
            follow(gathering, arrival, &mut sampler, &mut collecting)
        };
        orders[0].segments += segments;
    }

    /// Where the gather paths of a pass leave records.
    pub(super) fn record_places(&self, pass: Pass) -> RecordPlaces {
        RecordPlaces { window: pass.window, vertex_d: self.settings.depth as usize }
    }
}
