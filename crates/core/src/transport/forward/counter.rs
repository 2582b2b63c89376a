//! Photons of one batch, counted where they meet a sensor, and all of their losses.

mod surfaces;

use crate::optics::Side;
use crate::rng::{Points, Sampler, stream};
use crate::scene::{
    CountedLight, FaceId, LightGroupId, MediumId, RowReach, SensorId, SourceId, Wavelengths,
};
use crate::transport::forward::Forward;
use crate::transport::stop::Pace;
use crate::transport::tally::controls::Blocks;
use crate::transport::tally::sensor_reading::{ClassStep, DetectedLight, Trail};
use crate::transport::{
    Conversion, Departure, Emergence, Event, Leak, Observer, Path, Readings, Segment, Vertex, walk,
};
use glam::DVec3;
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// Counts one batch.
pub(super) struct PhotonCounter<'r, 's, O> {
    run: &'r Forward<'s>,
    observer: &'r mut O,
    pace: &'r Pace<'r>,
    readings: Readings,
    /// The scalars of the readings, until the batch is finished.
    sums: Vec<f64>,
    blocks: Blocks,
    /// Flux of the current photon at throughput 1, lm or W.
    flux: f64,
    pub(super) source: SourceId,
    pub(super) wavelengths: Wavelengths,
    /// Light groups of the source.
    light_groups: &'s [LightGroupId],
    pub(super) classed: bool,
    travel_start: TravelStart,
    trail: Trail,
    last_left: Option<FaceId>,
    /// First-passage sensors that the photon has passed.
    passed: SmallVec<[SensorId; 2]>,
    /// Sensors through whose entry port it has entered.
    entered: SmallVec<[SensorId; 2]>,
}

/// Where a segment starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum TravelStart {
    /// At the source: crossings at its start have not been counted.
    Source,
    /// At an interface: the previous segment has counted the crossings there.
    Interface,
}

impl<'r, 's, O: Observer> PhotonCounter<'r, 's, O> {
    pub(super) fn new(
        run: &'r Forward<'s>,
        mut readings: Readings,
        observer: &'r mut O,
        pace: &'r Pace<'r>,
    ) -> Self {
        let sums = std::mem::take(&mut readings.groups[0].sums);
        Self {
            run,
            observer,
            pace,
            blocks: Blocks::new(&run.layout, &sums),
            sums,
            readings,
            flux: 0.0,
            source: SourceId::new(0),
            wavelengths: Wavelengths::All,
            light_groups: &[],
            classed: false,
            travel_start: TravelStart::Source,
            trail: Trail::new(),
            last_left: None,
            passed: SmallVec::new(),
            entered: SmallVec::new(),
        }
    }

    pub(super) fn finish(mut self) -> Readings {
        self.readings.groups[0].sums = self.sums;
        self.readings.close_batch();
        self.readings
    }

    pub(super) fn trace(&mut self, source: SourceId, flux: f64, index: u64, points: &mut Points) {
        let scene = self.run.scene;
        let mut fresh = Sampler::for_path(self.run.seed, stream::PHOTONS, index);
        let mut sampler = points.lead(&mut fresh);
        let own = &scene.sources[source.index()];
        let wavelength = scene.photon_wavelength(source, self.wavelengths, &mut sampler);
        let emitted = own.emit(scene, wavelength, &mut sampler);
        let flux = flux * own.spectral_weight(wavelength.nm);
        self.flux = flux;
        self.source = source;
        self.light_groups = scene.light.of(source);
        self.travel_start = TravelStart::Source;
        self.trail.clear();
        self.last_left = None;
        self.passed.clear();
        self.entered.clear();
        self.add(self.run.layout.emitted(source), 1.0);
        let shape = emitted.shape;
        let path = Path::emitted(scene, source, emitted);
        _ = self.observer.see(&path, Event::Start(&Emergence { source, shape, flux }));
        walk(scene, path, self.run.bounce_limit, &mut sampler, self);
        self.blocks.count_path(&self.run.layout, &self.sums);
    }

    /// Ends the paths of a source.
    pub(super) fn end_source(&mut self) {
        let controls = self.blocks.end_source(&self.run.layout, &self.sums);
        self.readings.controls.merge(&controls);
    }

    #[inline(always)]
    fn travel(&mut self, path: &Path, segment: &Segment<'_>) {
        self.readings.segments += 1;
        if segment.arriving < segment.throughput {
            let slot = self.run.layout.absorbed_in_medium(segment.medium);
            self.add(slot, segment.throughput - segment.arriving);
        }
        let sensors = &self.run.sensors;
        if sensors.ports.iter().any(|port| port.may_be_crossed(segment))
            || !sensors.near.is_empty()
            || !sensors.entry_ports.is_empty()
        {
            self.travel_watched(path, segment);
        }
        self.travel_start = TravelStart::Interface;
    }

    #[inline(always)]
    fn arrive(&mut self, path: &Path, vertex: &Vertex<'_>) {
        _ = self.observer.see(path, Event::Arrive(vertex));
        let light = Light {
            counts: CountedLight::Incident,
            dir: vertex.dir,
            throughput: vertex.throughput,
            side: None,
            medium: vertex.interface.from,
        };
        self.on_faces(path, vertex, light);
    }

    #[inline(always)]
    fn depart(&mut self, path: &Path, vertex: &Vertex<'_>, departure: &Departure) {
        _ = self.observer.see(path, Event::Depart(vertex, departure));
        let face = vertex.interface.acting.face;
        let absorbed = vertex.throughput - departure.throughput;
        if absorbed > 0.0 {
            self.add(self.run.layout.absorbed_by_face(face), absorbed);
        }
        if let Some((kind, surprise)) = self.run.surprises.at_face(self.source, vertex, departure) {
            self.add(self.run.layout.control(kind), surprise);
        }
        let light = Light {
            counts: CountedLight::Leaving,
            dir: departure.dir,
            throughput: departure.throughput,
            side: Some(departure.side),
            medium: match departure.side {
                Side::Reflected => vertex.interface.from,
                Side::Transmitted => vertex.interface.to,
            },
        };
        self.on_faces(path, vertex, light);
        let transmitted = departure.side == Side::Transmitted;
        if transmitted {
            let left = self.run.scene.face_left(vertex.interface, vertex.hits);
            self.last_left = left.or(self.last_left);
        }
        if self.classed {
            self.step(ClassStep { face: face.index() as u32, transmitted });
        }
    }

    /// Counts light on the sensors of all faces that meet at a vertex; most have none.
    #[inline(always)]
    fn on_faces(&mut self, path: &Path, vertex: &Vertex<'_>, light: Light) {
        let hits = vertex.hits;
        if self.run.sensors.watched[hits.nearest().face.index()].includes(light.counts)
            || !hits.others().is_empty()
        {
            self.on_watched_faces(path, vertex, light);
        }
    }

    /// Counts flux in a cell and in the sensor's totals.
    #[inline]
    fn count(&mut self, path: &Path, id: SensorId, cell: usize, throughput: f64) {
        let light = self.count_on_sensor(path, id, throughput);
        self.readings.sensors[id.index()].add_to_cell(cell, &light, self.light_groups);
    }

    #[inline]
    fn count_on_sensor(&mut self, path: &Path, id: SensorId, throughput: f64) -> DetectedLight {
        let flux = self.flux * throughput;
        let &Path { depth, wavelength, .. } = path;
        let light = DetectedLight { flux, depth, source: self.source, wavelength };
        let reading = &mut self.readings.sensors[id.index()];
        reading.add(&mut self.sums, &self.run.layout, id, &light);
        if self.classed {
            let class = reading.classes.entry(self.trail.clone()).or_default();
            class.flux += flux;
            class.depth_weighted += flux * f64::from(path.depth);
        }
        light
    }

    /// Adds a step to the trail of a path; repeats of a step count once, and a full trail is marked
    /// as cut off.
    fn step(&mut self, step: ClassStep) {
        if self.trail.last() == Some(&Some(step)) || self.is_trail_full() {
            return;
        }
        let full = self.trail.len() == self.trail.inline_size();
        if full {
            self.trail.pop();
        }
        self.trail.push((!full).then_some(step));
    }

    /// Whether the trail is cut off.
    fn is_trail_full(&self) -> bool {
        self.trail.last() == Some(&None)
    }

    #[inline(always)]
    fn add(&mut self, slot: usize, throughput: f64) {
        self.sums[slot] += self.flux * throughput;
    }
}

impl<O: Observer> Observer for PhotonCounter<'_, '_, O> {
    #[inline(always)]
    fn roulette_below(&self) -> f64 {
        self.observer.roulette_below()
    }

    #[inline(always)]
    fn allows_jumps(&self) -> bool {
        self.observer.allows_jumps()
    }

    #[inline(always)]
    fn limit_row(&self, path: &Path, reach: &mut RowReach) {
        self.observer.limit_row(path, reach);
        // The faces are steps of the path's class.
        if self.classed && !reach.is_one_face && !self.is_trail_full() {
            reach.end_after(0);
        }
    }

    #[inline(always)]
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        let layout = self.run.layout;
        match event {
            Event::Travel(segment) => {
                self.travel(path, segment);
                return self.pace.spend(1);
            }
            Event::Arrive(vertex) => self.arrive(path, vertex),
            Event::Depart(vertex, departure) => self.depart(path, vertex, departure),
            Event::Collide(_) => return self.observer.see(path, event),
            Event::Convert(&Conversion { medium, absorbed, emitted, heat, .. }) => {
                self.add(layout.converted(medium), absorbed - emitted);
                self.add(layout.heat(medium), heat);
            }
            Event::Jump(jump) => {
                self.readings.segments += 1;
                self.add(layout.absorbed_in_medium(jump.medium), jump.absorbed_in_medium);
                for &(face, absorbed) in jump.absorbed_by_faces {
                    self.add(layout.absorbed_by_face(face), absorbed);
                }
                // Sensors on a wall that a row meets count on the other side.
                for &(id, sensor) in &self.run.sensors.faces[jump.face.index()] {
                    let seen = match sensor.counts {
                        CountedLight::Incident => jump.arriving,
                        CountedLight::Leaving => jump.leaving,
                    };
                    self.add(layout.other_side(id), seen);
                }
                return self.pace.spend(1);
            }
            Event::Absorbed(vertex) => {
                let face = vertex.interface.acting.face;
                self.add(layout.absorbed_by_face(face), vertex.throughput);
            }
            Event::Roulette(lost) => {
                self.add(layout.roulette(), lost);
                self.add(layout.control(self.run.surprises.at_roulette(self.source)), lost);
            }
            Event::Escaped(throughput) => {
                self.add(layout.escaped(self.last_left), throughput);
                for &(id, goniometer) in &self.run.sensors.far {
                    self.count_on_sphere(
                        path,
                        id,
                        goniometer.cell(path.ray.dir()),
                        f64::INFINITY,
                        throughput,
                    );
                }
            }
            Event::Cut(throughput) => self.add(layout.cut(), throughput),
            // The bounce loop makes none of these: this counter makes the first two, and only gather paths
            // meet emission.
            Event::Start(_) | Event::Detect(_) | Event::Meet(_) => {}
            Event::Leaked(ray, throughput) => {
                self.add(layout.leaked(), throughput);
                self.readings.leaks.push(Leak { point: ray.origin(), dir: ray.dir() });
            }
        }
        ControlFlow::Continue(())
    }
}

/// Light arriving at, or leaving, the faces of a vertex.
#[derive(Clone, Copy)]
pub(super) struct Light {
    pub(super) counts: CountedLight,
    /// Unit direction of travel.
    pub(super) dir: DVec3,
    pub(super) throughput: f64,
    /// The side it leaves to; `None` for arriving light.
    pub(super) side: Option<Side>,
    /// The medium it is in.
    pub(super) medium: MediumId,
}
