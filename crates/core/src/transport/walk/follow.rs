//! Gather paths from a sensor: the sources they meet, and where they could end.
//!
//! The path starts as given by its sensor, must pass through the sensor's aim, and meets emission
//! on the way. The observer decides at every visible interface whether it continues.

use crate::rng::{Numbers, Sampler};
use crate::scene::shape::{Crossing, RayStart, Toward};
use crate::scene::{
    Arrival, Arrivals, Begins, CountedLight, Owner, Passage, Place, Ray, RowReach, Scene, SensorId,
    SensorKind, StartSurfaces, SurfaceSensor, Visibility,
};
use crate::transport::stop::Pace;
use crate::transport::walk::emitters::{Emitters, SegmentStart};
use crate::transport::{
    Carries, Collision, Departure, Detection, Event, MetEmission, Observer, Path, Segment, Vertex,
    walk,
};
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// Shared data of the gather paths of a sensor.
#[derive(Debug, Clone, Copy)]
pub struct Gathering<'a, 's> {
    /// The scene.
    pub scene: &'s Scene,
    /// The sources of the scene that the paths may meet.
    pub emitters: &'a Emitters<'s>,
    /// The sensor that they start from.
    pub sensor: SensorId,
    /// Interfaces after which a path is cut, 1.
    pub bounce_limit: u32,
    /// Stops the paths; `None` if nothing does.
    pub pace: Option<&'a Pace<'a>>,
}

/// Follows one gather path; returns its number of segments.
pub fn follow(
    gathering: Gathering<'_, '_>,
    arrival: &Arrival,
    sampler: &mut Sampler<impl Numbers>,
    observer: &mut impl Observer,
) -> u64 {
    let path = Path::arriving(gathering.scene, arrival);
    let (stage, limit) = match arrival.begins {
        // A photon is counted as it leaves the face, before it can be cut there.
        Begins::BeforeFace => (FollowedLeg::BeforeFace, gathering.bounce_limit.saturating_add(1)),
        Begins::OnSensor => (FollowedLeg::First, gathering.bounce_limit),
    };
    let mut follower = Follower::new(gathering, observer, stage);
    walk(gathering.scene, path, limit, sampler, &mut follower);
    follower.segments
}

/// Follows one gather path from an interface beyond the aim; returns the number of segments.
pub fn follow_on(
    gathering: Gathering<'_, '_>,
    path: Path,
    sampler: &mut Sampler<impl Numbers>,
    observer: &mut impl Observer,
) -> u64 {
    let mut follower = Follower::new(gathering, observer, FollowedLeg::Beyond);
    walk(gathering.scene, path, gathering.bounce_limit, sampler, &mut follower);
    follower.segments
}

/// The gather paths of a sensor, if it is among `sensors`, which are sorted by id.
pub(crate) fn arrivals_of<'a, 's>(
    sensor: SensorId,
    sensors: &'a [(SensorId, Arrivals<'s>)],
) -> Option<&'a Arrivals<'s>> {
    let place = sensors.binary_search_by_key(&sensor, |(id, _)| *id).ok()?;
    Some(&sensors[place].1)
}

/// Etendue that a gather path back along some light would represent if the sensor had only one,
/// mm² sr.
pub(crate) fn etendue_of(
    light: &Detection<'_>,
    scene: &Scene,
    arrivals: &Arrivals<'_>,
    wavelength: f64,
) -> f64 {
    let index = scene.media[light.medium.index()].index(wavelength);
    index * index * arrivals.extent(&Ray::new(light.point, -light.dir), light.normal)
}

/// Whether light that starts on some surfaces along a ray, and meets a sensor at distance `t`, came
/// through one of the faces or ports it is aimed at.
pub(crate) fn comes_through_aim(
    scene: &Scene,
    sensor: SensorId,
    (on, ray): (&StartSurfaces, &Ray),
    t: f64,
) -> bool {
    let aim = &scene.sensors[sensor.index()].aim;
    aim.is_empty()
        || aim.iter().any(|&face| match scene.faces[face.index()].owner {
            Owner::Solid(_) | Owner::Sheet => on.iter().any(|prim| scene.face_of(prim) == face),
            Owner::Port => scene.face_patches(face).iter().any(|patch| {
                let mut crossed = false;
                patch.crossings(ray, RayStart::Elsewhere, |crossing| {
                    crossed |= crossing.t >= -scene.tolerance && crossing.t < t;
                });
                crossed
            }),
        })
}

/// Progress of a gather path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FollowedLeg {
    /// It has yet to meet the sensor's own face.
    BeforeFace,
    /// It is on its first segment, which must pass through the aim.
    First,
    /// It has passed the aim.
    Beyond,
}

struct Follower<'a, 's, 'o, O> {
    gathering: Gathering<'a, 's>,
    observer: &'o mut O,
    stage: FollowedLeg,
    /// Emission met at the end of the first segment: it counts if the segment ends at the aim.
    before_aim: SmallVec<[MetEmission; 2]>,
    segments: u64,
    /// The sensor, if light counts only on its first passage.
    first_passage: Option<&'s SurfaceSensor>,
    /// Whether the last interface was the sensor's own face, where the path starts.
    at_own_face: bool,
}

impl<'a, 's, 'o, O: Observer> Follower<'a, 's, 'o, O> {
    fn new(gathering: Gathering<'a, 's>, observer: &'o mut O, stage: FollowedLeg) -> Self {
        let first_passage = match &gathering.scene.sensors[gathering.sensor.index()].kind {
            SensorKind::Surface(surface) if surface.passage == Passage::First => Some(surface),
            SensorKind::Surface(_) | SensorKind::Goniometer(_) => None,
        };
        Self {
            gathering,
            observer,
            stage,
            before_aim: SmallVec::new(),
            segments: 0,
            first_passage,
            at_own_face: false,
        }
    }

    /// Travels along a segment as far as its light counts; a break ends the path where the light
    /// has passed the sensor before.
    fn travel_counted(&mut self, path: &Path, segment: &Segment<'_>) -> ControlFlow<()> {
        let Some(length) = self.passed_at(segment) else {
            self.travel(path, segment);
            return ControlFlow::Continue(());
        };
        self.travel(path, &Segment { length, ..*segment });
        ControlFlow::Break(())
    }

    /// Distance along a segment, mm, at which its light has passed the sensor before, as photons
    /// would be counted: at the end of their segment, not at its start.
    fn passed_at(&self, segment: &Segment<'_>) -> Option<f64> {
        let sensor = self.first_passage.filter(|sensor| sensor.place == Place::Port)?;
        let Gathering { scene, .. } = self.gathering;
        let tolerance = scene.tolerance;
        // The first segment starts on the sensor.
        let least = if self.segments == 1 { tolerance } else { -tolerance };
        let mut nearest: Option<f64> = None;
        for patch in sensor.faces.iter().flat_map(|&face| scene.face_patches(face)) {
            patch.crossings(segment.ray, RayStart::Elsewhere, |Crossing { t, toward }| {
                let is_within = t > least && t < segment.length - tolerance;
                if is_within && sensor.sides.include(sensor.counts, toward.opposite()) {
                    nearest = Some(nearest.map_or(t, |other| other.min(t)));
                }
            });
        }
        // Emission at the position of the sensor has passed it.
        nearest.map(|t| (t - 2.0 * tolerance).max(0.0))
    }

    /// Whether the light of a path from an interface has passed the sensor there before.
    fn has_passed(&self, vertex: &Vertex<'_>, departure: &Departure) -> bool {
        let Some(sensor) = self.first_passage.filter(|_| !self.at_own_face) else { return false };
        let light = match sensor.counts {
            CountedLight::Incident => -departure.dir,
            CountedLight::Leaving => -vertex.dir,
        };
        sensor.place == Place::Face
            && vertex.hits.all().filter(|hit| sensor.faces.contains(&hit.face)).any(|hit| {
                let normal = self.gathering.scene.normal(hit.prim, vertex.point);
                sensor.sides.include(sensor.counts, Toward::of(light, normal))
            })
    }

    fn travel(&mut self, path: &Path, segment: &Segment<'_>) {
        let Gathering { scene, emitters, sensor, .. } = self.gathering;
        match self.stage {
            // Emission from the face itself does not leave by the action of the face.
            FollowedLeg::BeforeFace => {}
            FollowedLeg::Beyond => {
                emitters.along(path, segment, SegmentStart::Interface, |met| {
                    _ = self.observer.see(path, Event::Meet(&met));
                });
            }
            FollowedLeg::First => {
                let opening = aim_opening(scene, sensor, segment);
                if opening.is_some() {
                    self.stage = FollowedLeg::Beyond;
                }
                let from = opening.unwrap_or(segment.length) - scene.tolerance;
                // Only a sensor on a face starts paths on a surface.
                let start = if path.on.iter().next().is_none() {
                    SegmentStart::Sensor
                } else {
                    SegmentStart::Face
                };
                emitters.along(path, segment, start, |met| {
                    if met.t < from {
                        return;
                    }
                    match opening {
                        Some(_) => _ = self.observer.see(path, Event::Meet(&met)),
                        None => self.before_aim.push(met),
                    }
                });
            }
        }
    }

    fn arrive(&mut self, path: &Path, vertex: &Vertex<'_>) -> ControlFlow<()> {
        if self.stage == FollowedLeg::First {
            let aim = &self.gathering.scene.sensors[self.gathering.sensor.index()].aim;
            if !vertex.hits.all().any(|hit| aim.contains(&hit.face)) {
                return ControlFlow::Break(());
            }
            for met in self.before_aim.drain(..) {
                _ = self.observer.see(path, Event::Meet(&met));
            }
        }
        self.at_own_face = self.stage == FollowedLeg::BeforeFace;
        self.stage = FollowedLeg::Beyond;
        match vertex.interface.visibility {
            Visibility::Visible => self.observer.see(path, Event::Arrive(vertex)),
            Visibility::Invisible => ControlFlow::Continue(()),
        }
    }

    fn collide(&mut self, path: &Path, collision: &Collision<'_>) -> ControlFlow<()> {
        match self.stage {
            // Light that is scattered in front of the aim does not pass through it.
            FollowedLeg::First => ControlFlow::Break(()),
            FollowedLeg::BeforeFace | FollowedLeg::Beyond => {
                self.observer.see(path, Event::Collide(collision))
            }
        }
    }
}

impl<O: Observer> Observer for Follower<'_, '_, '_, O> {
    const CARRIES: Carries = Carries::Radiance;

    #[inline]
    fn roulette_below(&self) -> f64 {
        self.observer.roulette_below()
    }

    #[inline]
    fn allows_jumps(&self) -> bool {
        self.observer.allows_jumps()
    }

    #[inline]
    fn limit_row(&self, path: &Path, reach: &mut RowReach) {
        self.observer.limit_row(path, reach);
    }

    #[inline]
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        match event {
            Event::Travel(segment) => {
                self.segments += 1;
                self.travel_counted(path, segment)?;
                self.gathering.pace.map_or(ControlFlow::Continue(()), |pace| pace.spend(1))
            }
            Event::Jump(_) => {
                self.segments += 1;
                self.gathering.pace.map_or(ControlFlow::Continue(()), |pace| pace.spend(1))
            }
            Event::Arrive(vertex) => self.arrive(path, vertex),
            Event::Collide(collision) => self.collide(path, collision),
            Event::Depart(vertex, departure) if self.has_passed(vertex, departure) => {
                ControlFlow::Break(())
            }
            Event::Depart(..) | Event::Cut(_) | Event::Leaked(..) => self.observer.see(path, event),
            // A sensor that looks through something sees no light of the medium before it.
            Event::Convert(_) => ControlFlow::Break(()),
            Event::Start(_)
            | Event::Detect(_)
            | Event::Meet(_)
            | Event::Absorbed(_)
            | Event::Roulette(_)
            | Event::Escaped(_) => ControlFlow::Continue(()),
        }
    }
}

/// Distance along its first segment at which a gather path passes the aim: zero if there is none,
/// otherwise where it crosses a port of the aim; `None` where only the segment's end can be on the
/// aim.
fn aim_opening(scene: &Scene, sensor: SensorId, segment: &Segment<'_>) -> Option<f64> {
    let aim = &scene.sensors[sensor.index()].aim;
    if aim.is_empty() {
        return Some(0.0);
    }
    let mut opening: Option<f64> = None;
    for &face in aim.iter().filter(|face| scene.faces[face.index()].owner == Owner::Port) {
        for patch in scene.face_patches(face) {
            patch.crossings(segment.ray, RayStart::Elsewhere, |Crossing { t, .. }| {
                if t > 0.0 && t <= segment.length + scene.tolerance {
                    opening = Some(opening.map_or(t, |first| first.min(t)));
                }
            });
        }
    }
    opening
}
