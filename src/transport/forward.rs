//! The forward estimator: photon paths from the sources, counted where they meet a sensor.
//!
//! Every photon carries flux; sensors add it up per cell. What surfaces and media take, what escapes and what is cut
//! is counted independently, so that the balance can be checked, not enforced.

use crate::optics::Side;
use crate::rng::Sampler;
use crate::scene::shape::{Crossing, Start, Toward};
use crate::scene::{Counts, FaceId, Owner, PrimHit, Scene, SensorId, SourceId, SurfaceSensor};
use crate::transport::readings::{SensorReading, Step, Trail};
use crate::transport::watch::{OnPort, Watch};
use crate::transport::{
    Departure, Event, Layout, Leak, Path, Readings, Segment, TAILS, Vertex, walk,
};
use glam::{DVec2, DVec3};
use std::ops::ControlFlow;

/// Stream of random numbers of the forward photons.
const STREAM: u64 = 1;
/// Path classes are taken from every so many paths: they are shares for the reader, not measures.
const CLASS_EVERY: u64 = 8;

/// What all batches of a run have in common.
#[derive(Debug)]
pub(crate) struct Forward<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) layout: Layout,
    pub(crate) watch: Watch<'s>,
    pub(crate) seed: u64,
    pub(crate) bounce_limit: u32,
    /// Paths per batch of each source.
    pub(crate) shares: Vec<u64>,
}

impl<'s> Forward<'s> {
    /// Prepares a run with `batch_paths` paths a batch, divided among the sources by flux.
    pub(crate) fn new(scene: &'s Scene, seed: u64, bounce_limit: u32, batch_paths: u64) -> Self {
        Self {
            scene,
            layout: Layout::new(scene),
            watch: Watch::new(scene),
            seed,
            bounce_limit,
            shares: shares(scene, batch_paths),
        }
    }

    /// Traces one batch.
    pub(crate) fn batch(&self, batch: u64) -> Readings {
        let batch_paths = self.shares.iter().sum();
        let readings = Readings::of_batch(self.scene, &self.layout, self.seed, batch_paths, batch);
        let mut counter = Counter::new(self, readings);
        let mut index = batch * batch_paths;
        for (source, &paths) in self.shares.iter().enumerate() {
            let source = SourceId::new(source);
            let flux = self.scene.sources[source.index()].flux / paths as f64;
            for _ in 0..paths {
                counter.trace(source, flux, index);
                index += 1;
            }
        }
        counter.finish()
    }
}

/// Paths per batch of each source: by flux, at least one each.
fn shares(scene: &Scene, batch_paths: u64) -> Vec<u64> {
    let total = scene.source_flux();
    let share = |flux: f64| ((batch_paths as f64 * flux / total).round() as u64).max(1);
    scene.sources.iter().map(|source| share(source.flux)).collect()
}

/// Counts one batch.
struct Counter<'r, 's> {
    run: &'r Forward<'s>,
    readings: Readings,
    /// The scalars of the readings, until it is finished.
    sums: Vec<f64>,
    /// Flux of the photon being traced at throughput 1, lm or W.
    flux: f64,
    source: SourceId,
    classed: bool,
    trail: Trail,
    last_left: Option<FaceId>,
}

impl<'r, 's> Counter<'r, 's> {
    fn new(run: &'r Forward<'s>, mut readings: Readings) -> Self {
        Self {
            run,
            sums: std::mem::take(&mut readings.groups[0].sums),
            readings,
            flux: 0.0,
            source: SourceId::new(0),
            classed: false,
            trail: Trail::new(),
            last_left: None,
        }
    }

    fn finish(mut self) -> Readings {
        self.readings.groups[0].sums = self.sums;
        self.readings.close_batch();
        self.readings
    }

    fn trace(&mut self, source: SourceId, flux: f64, index: u64) {
        let scene = self.run.scene;
        let mut sampler = Sampler::for_path(self.run.seed, STREAM, index);
        let emitted = scene.sources[source.index()].emit(scene, &mut sampler);
        self.flux = flux;
        self.source = source;
        self.classed = index.is_multiple_of(CLASS_EVERY);
        self.trail.clear();
        self.last_left = None;
        self.add(self.run.layout.emitted(source), 1.0);
        let path = Path::emitted(scene, source, emitted);
        walk(scene, path, self.run.bounce_limit, &mut sampler, |path, event| {
            self.see(path, event);
            ControlFlow::Continue(())
        });
    }

    #[inline]
    fn see(&mut self, path: &Path, event: Event<'_>) {
        let layout = self.run.layout;
        match event {
            Event::Travel(segment) => self.travel(path, segment),
            Event::Arrive(vertex) => self.arrive(path, vertex),
            Event::Depart(vertex, departure) => self.depart(path, vertex, departure),
            Event::Absorbed(vertex) => {
                let face = vertex.interface.acting.face;
                self.add(layout.absorbed_by_face(face), vertex.throughput);
            }
            Event::Roulette(lost) => self.add(layout.roulette(), lost),
            Event::Escaped(throughput) => {
                self.add(layout.escaped(self.last_left), throughput);
                for &(id, goniometer) in &self.run.watch.far {
                    self.count(path, id, goniometer.cell(path.ray.dir()), throughput);
                }
            }
            Event::Cut(throughput) => self.add(layout.cut(), throughput),
            Event::Leaked(ray, throughput) => {
                self.add(layout.leaked(), throughput);
                self.readings.leaks.push(Leak { point: ray.origin(), dir: ray.dir() });
            }
        }
    }

    #[inline]
    fn travel(&mut self, path: &Path, segment: &Segment<'_>) {
        self.readings.segments += 1;
        if segment.arriving < segment.throughput {
            let slot = self.run.layout.absorbed_in_medium(segment.medium);
            self.add(slot, segment.throughput - segment.arriving);
        }
        let run = self.run;
        for port in &run.watch.ports {
            self.cross_port(path, segment, port);
        }
        for &(id, goniometer) in &run.watch.near {
            if let Some(direction) = goniometer.leaving(segment.ray, segment.length) {
                self.count(path, id, goniometer.cell(direction), segment.throughput);
            }
        }
        for (face, patches) in &run.watch.entry_ports {
            for patch in *patches {
                patch.shape.crossings(segment.ray, Start::Elsewhere, |Crossing { t, toward }| {
                    if toward == Toward::Back && self.within(segment, t) {
                        for id in &run.watch.entries[face.index()] {
                            self.add(run.layout.entering(*id), segment.throughput);
                        }
                    }
                });
            }
        }
    }

    /// Counts light that passes through a port sensor on its way.
    #[inline]
    fn cross_port(&mut self, path: &Path, segment: &Segment<'_>, port: &OnPort<'s>) {
        let OnPort { id, sensor, patches } = port;
        for patch in patches {
            patch.shape.crossings(segment.ray, Start::Elsewhere, |Crossing { t, toward }| {
                if !self.within(segment, t) {
                    return;
                }
                let medium = &self.run.scene.media[segment.medium.index()];
                let throughput = segment.throughput * medium.transmittance(path.wavelength, t);
                let seen = Seen {
                    counts: sensor.counts,
                    toward,
                    point: segment.ray.at(t),
                    dir: segment.ray.dir(),
                };
                if self.through_aim(path, *id, t) {
                    let uv = patch.chart(seen.point);
                    self.count_on_surface(path, *id, sensor, uv, &seen, throughput);
                } else if sensor.sides.include(seen.counts, toward) {
                    self.add(self.run.layout.outside_aim(*id), throughput);
                }
            });
        }
    }

    /// Whether a crossing belongs to this segment: light at its end counts, light at its start has counted before.
    #[inline]
    fn within(&self, segment: &Segment<'_>, t: f64) -> bool {
        let tolerance = self.run.scene.tolerance;
        t > tolerance && t <= segment.length + tolerance
    }

    /// Whether light that meets a sensor at distance `t` came through one of the faces or ports it is aimed at.
    fn through_aim(&self, path: &Path, sensor: SensorId, t: f64) -> bool {
        let scene = self.run.scene;
        let aim = &scene.sensors[sensor.index()].aim;
        aim.is_empty()
            || aim.iter().any(|&face| match scene.faces[face.index()].owner {
                Owner::Solid(_) | Owner::Sheet => {
                    path.on.iter().any(|&prim| scene.face_of(prim) == face)
                }
                Owner::Port => scene.face_patches(face).iter().any(|patch| {
                    let mut crossed = false;
                    patch.shape.crossings(&path.ray, Start::Elsewhere, |crossing| {
                        crossed |= crossing.t >= -scene.tolerance && crossing.t < t;
                    });
                    crossed
                }),
            })
    }

    #[inline]
    fn arrive(&mut self, path: &Path, vertex: &Vertex<'_>) {
        self.on_faces(path, vertex, Counts::Incident, vertex.dir, vertex.throughput, None);
    }

    #[inline]
    fn depart(&mut self, path: &Path, vertex: &Vertex<'_>, departure: &Departure) {
        let face = vertex.interface.acting.face;
        let absorbed = vertex.throughput - departure.throughput;
        if absorbed > 0.0 {
            self.add(self.run.layout.absorbed_by_face(face), absorbed);
        }
        self.on_faces(
            path,
            vertex,
            Counts::Leaving,
            departure.dir,
            departure.throughput,
            Some(departure.side),
        );
        let transmitted = departure.side == Side::Transmitted;
        if transmitted {
            for hit in vertex.hits.all() {
                if let (Owner::Solid(_), Toward::Front) = (hit.owner, hit.toward) {
                    self.last_left = Some(hit.face);
                }
            }
        }
        if self.classed {
            self.step(Step { face: face.index() as u32, transmitted });
        }
    }

    /// Counts light on the sensors of all faces that meet at a vertex.
    #[inline]
    fn on_faces(
        &mut self,
        path: &Path,
        vertex: &Vertex<'_>,
        counts: Counts,
        dir: DVec3,
        throughput: f64,
        side: Option<Side>,
    ) {
        for hit in vertex.hits.all() {
            if self.run.watch.watched[hit.face.index()] {
                self.on_face(path, vertex.point, hit, counts, dir, throughput, side);
            }
        }
    }

    fn on_face(
        &mut self,
        path: &Path,
        point: DVec3,
        hit: &PrimHit,
        counts: Counts,
        dir: DVec3,
        throughput: f64,
        side: Option<Side>,
    ) {
        let run = self.run;
        let face = hit.face.index();
        if side == Some(Side::Transmitted) && hit.toward == Toward::Back {
            for id in &run.watch.entries[face] {
                self.add(run.layout.entering(*id), throughput);
            }
        }
        for &(id, sensor) in
            run.watch.faces[face].iter().filter(|(_, sensor)| sensor.counts == counts)
        {
            let normal = run.scene.normal(hit.prim, point);
            // Light is reflected to the side it came from: its direction tells the side it leaves to.
            let toward = if side.is_none() { hit.toward } else { Toward::of(dir, normal) };
            let seen = Seen { counts, toward, point, dir };
            let uv = run.scene.chart(hit.prim, point);
            self.count_on_surface(path, id, sensor, uv, &seen, throughput);
        }
    }

    /// Counts light on a cell of a surface sensor, and in the views that take it in.
    #[inline]
    fn count_on_surface(
        &mut self,
        path: &Path,
        id: SensorId,
        sensor: &SurfaceSensor,
        uv: DVec2,
        seen: &Seen,
        throughput: f64,
    ) {
        if !sensor.sides.include(seen.counts, seen.toward) {
            self.add(self.run.layout.other_side(id), throughput);
            return;
        }
        let Some(cell) = sensor.grid.cell(uv) else { return };
        let Some(views) = &sensor.views else {
            self.count(path, id, cell, throughput);
            return;
        };
        // Away from the face: back along arriving light, along leaving light.
        let away = if seen.counts == Counts::Incident { -seen.dir } else { seen.dir };
        let cells = sensor.grid.cells();
        let mut first = true;
        for view in views.accepting(away) {
            if first {
                self.count_totals(path, id, throughput);
                first = false;
            }
            self.readings.sensors[id.index()]
                .cells
                .add(view * cells + cell, self.flux * throughput);
        }
    }

    /// Counts flux in a cell and in the sensor's totals.
    #[inline]
    fn count(&mut self, path: &Path, id: SensorId, cell: usize, throughput: f64) {
        self.count_totals(path, id, throughput);
        self.readings.sensors[id.index()].cells.add(cell, self.flux * throughput);
    }

    #[inline]
    fn count_totals(&mut self, path: &Path, id: SensorId, throughput: f64) {
        let layout = self.run.layout;
        self.add(layout.sensor_flux(id, self.source), throughput);
        self.add(layout.depth_weighted(id), throughput * f64::from(path.depth));
        for (tail, &depth) in TAILS.iter().enumerate() {
            if path.depth <= depth {
                break;
            }
            self.add(layout.deeper(id, tail), throughput);
        }
        let flux = self.flux * throughput;
        let reading = &mut self.readings.sensors[id.index()];
        reading.depths.add(SensorReading::depth_bin(path.depth), flux);
        if self.classed {
            let class = reading.classes.entry(self.trail.clone()).or_default();
            class.flux += flux;
            class.depth_weighted += flux * f64::from(path.depth);
        }
    }

    /// Adds a step to the trail of a path; the same step in a row counts once, a full trail is marked as cut off.
    fn step(&mut self, step: Step) {
        if self.trail.last() == Some(&Some(step)) || self.trail.last() == Some(&None) {
            return;
        }
        let full = self.trail.len() == self.trail.inline_size();
        if full {
            self.trail.pop();
        }
        self.trail.push((!full).then_some(step));
    }

    #[inline]
    fn add(&mut self, slot: usize, throughput: f64) {
        self.sums[slot] += self.flux * throughput;
    }
}

/// Light at a surface sensor.
struct Seen {
    counts: Counts,
    toward: Toward,
    point: DVec3,
    dir: DVec3,
}

#[cfg(test)]
mod tests {
    use crate::math::{Aabb, Frame};
    use crate::optics::{Bsdf, Medium};
    use crate::scene::plan::{Estimator, RunPlan, StopRules};
    use crate::scene::shape::{Cylinder, Flat, Region, Shape};
    use crate::scene::{
        Builder, Counts, Emission, EmitSide, Emitter, FaceSpec, Grid, Owner, Piece, Place, Scene,
        Sensor, SensorId, SensorKind, Sides, Source, SourceId, Start, SurfaceSensor,
    };
    use crate::tally::sigmas;
    use crate::transport::{Readings, Run};
    use crate::units::FluxUnit;
    use glam::DVec3;

    /// A mirror tube of radius 5 with a Lambertian disk in its entry and a sensor in its exit.
    fn mirror_tube(reflectance: f64, length: f64) -> Scene {
        let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
        let mirror =
            builder.add_finish("mirror", Bsdf::Specular { reflectance, transmittance: 0.0 });
        let black = builder.add_finish("black", Bsdf::Absorber);
        builder.add_face(FaceSpec {
            name: "tube.wall".into(),
            owner: Owner::Sheet,
            front: Some(black),
            back: Some(mirror),
            pieces: vec![Piece::whole(Shape::Cylinder(Cylinder::new(Frame::WORLD, 5.0, length)))],
        });
        let disk = |z: f64| {
            Shape::Flat(Flat::new(
                Frame::WORLD.shifted(DVec3::new(0.0, 0.0, z)),
                Region::Annulus { inner: 0.0, outer: 5.0 },
            ))
        };
        let port = builder.add_face(FaceSpec {
            name: "exit".into(),
            owner: Owner::Port,
            front: None,
            back: None,
            pieces: vec![Piece::whole(disk(length))],
        });
        builder.add_source(Source {
            name: "led".into(),
            flux: 1.0,
            emitter: Emitter::surface(vec![disk(0.0)], EmitSide::Front, None),
            emission: Emission::Lambertian,
            start: Start::Outside,
            on: Vec::new(),
        });
        let grid = Grid::Cartesian { rect: disk(0.0).chart_bounds(), nu: 32, nv: 32 };
        let areas = grid.cell_areas(|rect| builder.scene().face_area_in(port, rect));
        builder.add_sensor(Sensor {
            name: "exit".into(),
            kind: SensorKind::Surface(SurfaceSensor {
                faces: vec![port],
                place: Place::Port,
                counts: Counts::Incident,
                sides: Sides::Back,
                grid,
                areas,
                views: None,
                frame: None,
            }),
            aim: Vec::new(),
            entering: None,
        });
        let scene = builder.build();
        assert!(scene.bounds.overlaps(&Aabb::of([DVec3::ZERO])));
        scene
    }

    fn run(scene: &Scene, paths: u64) -> Readings {
        let plan = RunPlan {
            estimator: Estimator::Forward,
            seed: 1,
            bounce_limit: 100_000,
            stop: StopRules { paths: Some(paths), ..StopRules::default() },
        };
        let mut run = Run::new(scene, &plan);
        while !run.is_complete() {
            run.next_wave();
        }
        run.readings()
    }

    #[test]
    fn a_mirror_tube_passes_what_the_closed_form_says_and_the_balance_closes() {
        // DESIGN section 6, B1: aspect 10 and 100 at R 0.95.
        for (length, expected) in [(100.0, 0.51084474), (1000.0, 0.04442615)] {
            let scene = mirror_tube(0.95, length);
            let readings = run(&scene, 500_000);
            let layout = crate::transport::Layout::new(&scene);
            let flux = readings.scalar(layout.sensor_flux(SensorId::new(0), SourceId::new(0)));
            let z = sigmas(flux.mean(), flux.std_error(), expected);
            assert!(z.abs() < 4.0, "{} ± {}, expected {expected}", flux.mean(), flux.std_error());
            let (first, lines) = (
                layout.emitted(SourceId::new(0)),
                layout.emitted(SourceId::new(0)) + 1..=layout.leaked(),
            );
            let lost =
                readings.function(|sums| lines.clone().map(sums).sum::<f64>() - sums(first)).mean();
            assert!(lost.abs() < 1e-9, "balance is open by {lost}");
            assert_eq!(readings.scalar(layout.leaked()).mean(), 0.0);
        }
    }

    #[test]
    fn readings_have_the_same_bits_on_any_number_of_threads() {
        let scene = mirror_tube(0.95, 100.0);
        let on = |threads| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap()
                .install(|| run(&scene, 20_000))
        };
        let one = on(1);
        for threads in [2, 3, 8] {
            assert!(one == on(threads), "{threads} threads differ");
        }
    }
}
