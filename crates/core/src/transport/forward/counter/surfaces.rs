//! Counts light on surface sensors: on material faces, and on the ports and spheres that it
//! crosses.
//!
//! This module does not know where paths come from or how they continue.

use crate::optics::Side;
use crate::scene::shape::{Crossing, RayStart, Toward};
use crate::scene::{CountedLight, MediumId, Passage, PrimHit, Seeing, SensorId, SurfaceSensor};
use crate::transport::forward::counter::{Light, PhotonCounter, TravelStart};
use crate::transport::forward::sensor_table::OnPort;
use crate::transport::walk::follow::comes_through_aim;
use crate::transport::{Detection, Event, Observer, Path, Segment, Vertex};
use glam::{DVec2, DVec3};
use smallvec::SmallVec;

/// Light at a surface sensor.
struct LightAtSensor {
    counts: CountedLight,
    toward: Toward,
    point: DVec3,
    dir: DVec3,
    /// Normal of the surface.
    normal: DVec3,
    medium: MediumId,
    throughput: f64,
}

impl<'s, O: Observer> PhotonCounter<'_, 's, O> {
    /// Counts light that passes through ports and out of goniometers.
    #[inline(never)]
    pub(super) fn travel_watched(&mut self, path: &Path, segment: &Segment<'_>) {
        let run = self.run;
        for port in &run.sensors.ports {
            self.cross_port(path, segment, port);
        }
        for &(id, goniometer) in &run.sensors.near {
            if let Some((t, direction)) = goniometer.leaving(segment.ray, segment.length) {
                let throughput = self.arriving_at(path, segment, t);
                self.count_on_sphere(path, id, goniometer.cell(direction), t, throughput);
            }
        }
        for (face, patches) in &run.sensors.entry_ports {
            for patch in *patches {
                patch.crossings(segment.ray, RayStart::Elsewhere, |Crossing { t, toward }| {
                    if toward == Toward::Back && self.within(segment, t) {
                        let throughput = self.arriving_at(path, segment, t);
                        self.enter(face.index(), throughput);
                    }
                });
            }
        }
    }

    /// Counts light that passes through a port sensor.
    fn cross_port(&mut self, path: &Path, segment: &Segment<'_>, port: &OnPort<'s>) {
        let OnPort { id, sensor, patches, .. } = port;
        for patch in patches {
            patch.crossings(segment.ray, RayStart::Elsewhere, |Crossing { t, toward }| {
                if !self.within(segment, t) {
                    return;
                }
                let throughput = self.arriving_at(path, segment, t);
                let seen = LightAtSensor {
                    counts: sensor.counts,
                    toward,
                    point: segment.ray.at(t),
                    dir: segment.ray.dir(),
                    normal: patch.shape.normal(segment.ray.at(t)),
                    medium: segment.medium,
                    throughput,
                };
                if self.through_aim(path, *id, t) {
                    let uv = patch.chart(seen.point);
                    self.count_on_surface(path, *id, sensor, uv, &seen);
                } else if sensor.sides.include(seen.counts, toward) {
                    self.add(self.run.layout.outside_aim(*id), throughput);
                }
            });
        }
    }

    /// The throughput of a segment at the distance `t` along it, mm.
    fn arriving_at(&self, path: &Path, segment: &Segment<'_>, t: f64) -> f64 {
        let medium = &self.run.scene.media[segment.medium.index()];
        segment.throughput * medium.transmittance(path.wavelength, t.max(0.0))
    }

    /// Counts light on a sphere that it meets at the distance `t` if it came through the sensor's
    /// aim.
    pub(super) fn count_on_sphere(
        &mut self,
        path: &Path,
        id: SensorId,
        cell: usize,
        t: f64,
        throughput: f64,
    ) {
        if self.through_aim(path, id, t) {
            let (ray, medium) = (&path.ray, path.medium);
            let point = if t.is_finite() { ray.at(t) } else { ray.origin() };
            let (flux, source) = (self.flux * throughput, self.source);
            // The direction and normal on a sphere follow from the position.
            let (dir, normal) = (ray.dir(), ray.dir());
            let cells = &[cell];
            let light = Detection { sensor: id, cells, point, dir, normal, medium, flux, source };
            _ = self.observer.see(path, Event::Detect(&light));
            self.count(path, id, cell, throughput);
        } else {
            self.add(self.run.layout.outside_aim(id), throughput);
        }
    }

    /// Whether a crossing belongs to this segment: light at its end counts; light at its start has
    /// already been counted, except at a source.
    #[inline]
    fn within(&self, segment: &Segment<'_>, t: f64) -> bool {
        let tolerance = self.run.scene.tolerance;
        let is_past_start = match self.travel_start {
            TravelStart::Source => t >= -tolerance,
            TravelStart::Interface => t > tolerance,
        };
        is_past_start && t <= segment.length + tolerance
    }

    /// Whether light that meets a sensor at distance `t` came through one of the faces or ports it is aimed at.
    fn through_aim(&self, path: &Path, sensor: SensorId, t: f64) -> bool {
        comes_through_aim(self.run.scene, sensor, (&path.on, &path.ray), t)
    }

    #[inline(never)]
    pub(super) fn on_watched_faces(&mut self, path: &Path, vertex: &Vertex<'_>, light: Light) {
        for hit in vertex.hits.all() {
            if self.run.sensors.watched[hit.face.index()].includes(light.counts) {
                self.on_face(path, vertex.point, hit, light);
            }
        }
    }

    fn on_face(&mut self, path: &Path, point: DVec3, hit: &PrimHit, light: Light) {
        let Light { counts, dir, throughput, side, medium } = light;
        let run = self.run;
        let face = hit.face.index();
        if side == Some(Side::Transmitted) && hit.toward == Toward::Back {
            self.enter(face, throughput);
        }
        for &(id, sensor) in
            run.sensors.faces[face].iter().filter(|(_, sensor)| sensor.counts == counts)
        {
            let normal = run.scene.normal(hit.prim, point);
            // Light is reflected to the side it came from: its direction tells the side it leaves to.
            let toward = if side.is_none() { hit.toward } else { Toward::of(dir, normal) };
            let seen = LightAtSensor { counts, toward, point, dir, normal, medium, throughput };
            let distance = point.distance(path.ray.origin());
            if counts == CountedLight::Incident && !self.through_aim(path, id, distance) {
                if sensor.sides.include(counts, toward) {
                    self.add(run.layout.outside_aim(id), throughput);
                }
                continue;
            }
            let uv = run.scene.chart(hit.prim, point);
            self.count_on_surface(path, id, sensor, uv, &seen);
        }
    }

    /// Counts light that enters through a face, for the sensors with that entry.
    fn enter(&mut self, face: usize, throughput: f64) {
        let run = self.run;
        for &id in &run.sensors.entries[face] {
            if run.scene.sensors[id.index()].counts_first_passage() {
                if self.entered.contains(&id) {
                    continue;
                }
                self.entered.push(id);
            }
            self.add(run.layout.entering(id, self.source), throughput);
        }
    }

    /// Whether a passage through a sensor counts; where only first passages count, this one is
    /// remembered.
    #[inline]
    fn passes(&mut self, id: SensorId, passage: Passage) -> bool {
        match passage {
            Passage::Every => true,
            Passage::First if self.passed.contains(&id) => false,
            Passage::First => {
                self.passed.push(id);
                true
            }
        }
    }

    /// Counts light on a cell of a surface sensor, and in the views or the pixel that accept it.
    #[inline]
    fn count_on_surface(
        &mut self,
        path: &Path,
        id: SensorId,
        sensor: &SurfaceSensor,
        uv: DVec2,
        seen: &LightAtSensor,
    ) {
        let &LightAtSensor { point, dir, normal, medium, throughput, .. } = seen;
        if !sensor.sides.include(seen.counts, seen.toward) {
            self.add(self.run.layout.other_side(id), throughput);
            return;
        }
        let Some(cell) = sensor.grid.cell(uv) else { return };
        if !self.passes(id, sensor.passage) {
            return;
        }
        // Away from the face: back along arriving light, along leaving light.
        let away = if seen.counts == CountedLight::Incident { -seen.dir } else { seen.dir };
        let cells = sensor.grid.cells();
        let (flux, source) = (self.flux * throughput, self.source);
        let light =
            |cells| Detection { sensor: id, cells, point, dir, normal, medium, flux, source };
        let views = match &sensor.seeing {
            Seeing::All => {
                _ = self.observer.see(path, Event::Detect(&light(&[cell])));
                return self.count(path, id, cell, throughput);
            }
            Seeing::Views(views) => views,
            Seeing::Pixels(pixels) => {
                if let Some(pixel) = pixels.pixel(away) {
                    let cell = pixel * cells + cell;
                    _ = self.observer.see(path, Event::Detect(&light(&[cell])));
                    self.count(path, id, cell, throughput);
                }
                return;
            }
        };
        let lit: SmallVec<[usize; 4]> =
            views.accepting(away).map(|view| view * cells + cell).collect();
        if lit.is_empty() {
            return;
        }
        _ = self.observer.see(path, Event::Detect(&light(&lit)));
        let seen = self.count_on_sensor(path, id, throughput);
        for &cell in &lit {
            self.readings.sensors[id.index()].add_to_cell(cell, &seen, self.light_groups);
        }
    }
}
