//! Gather paths from a sensor: what they see of the sources, and where they could end.
//!
//! The path starts as its sensor says, has to come through the sensor's aim, and meets emission on its way. Who collects
//! the light decides at every visible interface whether it goes on.

use crate::rng::{Numbers, Sampler};
use crate::scene::shape::{Crossing, Start};
use crate::scene::{Arrival, Begins, Owner, Scene, SensorId, Visibility};
use crate::transport::emitters::{Emitters, Met, SegmentStart};
use crate::transport::stop::Pace;
use crate::transport::{
    Carries, Collision, Departure, Event, Loss, Path, ROULETTE_BELOW, Segment, Vertex, Visitor,
    walk,
};
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// Who collects what gather paths bring.
pub(crate) trait Collector {
    /// Throughput below which roulette ends paths, 1.
    fn roulette_below(&self) -> f64 {
        ROULETTE_BELOW
    }

    /// Takes the emission that a path has met.
    fn meet(&mut self, path: &Path, met: Met);

    /// Learns that a path of this throughput was lost: nobody knows what it would have met.
    fn lose(&mut self, _throughput: f64, _loss: Loss) {}

    /// Sees a visible interface before it acts; a break ends the path there.
    fn arrive(&mut self, _path: &Path, _vertex: &Vertex<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Sees where a path is going to be scattered within a medium; a break ends the path there.
    fn collide(&mut self, _path: &Path, _collision: &Collision<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Sees where a path goes on from an interface; a break ends the path there.
    fn depart(
        &mut self,
        _path: &Path,
        _vertex: &Vertex<'_>,
        _departure: &Departure,
    ) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// What the gather paths of a sensor have in common.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gathering<'a, 's> {
    pub(crate) scene: &'s Scene,
    pub(crate) emitters: &'a Emitters<'s>,
    pub(crate) sensor: SensorId,
    pub(crate) bounce_limit: u32,
    /// What may stop the paths; `None` where nothing does.
    pub(crate) pace: Option<&'a Pace<'a>>,
}

/// Follows one gather path; gives back the number of straight pieces it had.
pub(crate) fn follow(
    gathering: Gathering<'_, '_>,
    arrival: &Arrival,
    sampler: &mut Sampler<impl Numbers>,
    collector: &mut impl Collector,
) -> u64 {
    let path = Path::arriving(gathering.scene, arrival);
    let (stage, limit) = match arrival.begins {
        // A photon is counted as it leaves the face, before it can be cut there.
        Begins::BeforeFace => (Stage::BeforeFace, gathering.bounce_limit.saturating_add(1)),
        Begins::OnSensor => (Stage::First, gathering.bounce_limit),
    };
    let before_aim = SmallVec::new();
    let mut follower = Follower { gathering, collector, stage, before_aim, segments: 0 };
    walk(gathering.scene, path, limit, sampler, &mut follower);
    follower.segments
}

/// Follows one gather path on from an interface, with the aim behind it; gives back the number of straight pieces.
pub(crate) fn follow_on(
    gathering: Gathering<'_, '_>,
    path: Path,
    sampler: &mut Sampler<impl Numbers>,
    collector: &mut impl Collector,
) -> u64 {
    let (stage, before_aim) = (Stage::Beyond, SmallVec::new());
    let mut follower = Follower { gathering, collector, stage, before_aim, segments: 0 };
    walk(gathering.scene, path, gathering.bounce_limit, sampler, &mut follower);
    follower.segments
}

/// How far a gather path has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// It has yet to meet the sensor's own face.
    BeforeFace,
    /// It is on its first segment, which has to come through the aim.
    First,
    /// The aim lies behind it.
    Beyond,
}

struct Follower<'a, 's, 'c, C> {
    gathering: Gathering<'a, 's>,
    collector: &'c mut C,
    stage: Stage,
    /// Emission met at the end of the first segment: it counts if the segment ends at the aim.
    before_aim: SmallVec<[Met; 2]>,
    segments: u64,
}

impl<C: Collector> Follower<'_, '_, '_, C> {
    fn travel(&mut self, path: &Path, segment: &Segment<'_>) {
        let Gathering { scene, emitters, sensor, .. } = self.gathering;
        match self.stage {
            // What shines from the face itself does not leave it by the face's doing.
            Stage::BeforeFace => {}
            Stage::Beyond => {
                emitters.along(path, segment, SegmentStart::Interface, |met| {
                    self.collector.meet(path, met);
                });
            }
            Stage::First => {
                let opening = aim_opening(scene, sensor, segment);
                if opening.is_some() {
                    self.stage = Stage::Beyond;
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
                        Some(_) => self.collector.meet(path, met),
                        None => self.before_aim.push(met),
                    }
                });
            }
        }
    }

    fn arrive(&mut self, path: &Path, vertex: &Vertex<'_>) -> ControlFlow<()> {
        if self.stage == Stage::First {
            let aim = &self.gathering.scene.sensors[self.gathering.sensor.index()].aim;
            if !vertex.hits.all().any(|hit| aim.contains(&hit.face)) {
                return ControlFlow::Break(());
            }
            for met in self.before_aim.drain(..) {
                self.collector.meet(path, met);
            }
        }
        self.stage = Stage::Beyond;
        match vertex.interface.visibility {
            Visibility::Visible => self.collector.arrive(path, vertex),
            Visibility::Invisible => ControlFlow::Continue(()),
        }
    }

    fn collide(&mut self, path: &Path, collision: &Collision<'_>) -> ControlFlow<()> {
        match self.stage {
            // Light that is scattered in front of the aim does not come through it.
            Stage::First => ControlFlow::Break(()),
            Stage::BeforeFace | Stage::Beyond => self.collector.collide(path, collision),
        }
    }
}

impl<C: Collector> Visitor for Follower<'_, '_, '_, C> {
    const CARRIES: Carries = Carries::Radiance;

    #[inline]
    fn roulette_below(&self) -> f64 {
        self.collector.roulette_below()
    }

    #[inline]
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        match event {
            Event::Travel(segment) => {
                self.segments += 1;
                self.travel(path, segment);
                self.gathering.pace.map_or(ControlFlow::Continue(()), |pace| pace.spend(1))
            }
            Event::Arrive(vertex) => self.arrive(path, vertex),
            Event::Collide(collision) => self.collide(path, collision),
            Event::Depart(vertex, departure) => self.collector.depart(path, vertex, departure),
            Event::Cut(throughput) => {
                self.collector.lose(throughput, Loss::Cut);
                ControlFlow::Continue(())
            }
            Event::Leaked(_, throughput) => {
                self.collector.lose(throughput, Loss::Leaked);
                ControlFlow::Continue(())
            }
            Event::Absorbed(_) | Event::Roulette(_) | Event::Escaped(_) => {
                ControlFlow::Continue(())
            }
        }
    }
}

/// How far along its first segment a gather path comes through the aim: at once without any, else where it crosses a
/// port of the aim; `None` where only the segment's end can be on the aim.
fn aim_opening(scene: &Scene, sensor: SensorId, segment: &Segment<'_>) -> Option<f64> {
    let aim = &scene.sensors[sensor.index()].aim;
    if aim.is_empty() {
        return Some(0.0);
    }
    let mut opening: Option<f64> = None;
    for &face in aim.iter().filter(|face| scene.faces[face.index()].owner == Owner::Port) {
        for patch in scene.face_patches(face) {
            patch.crossings(segment.ray, Start::Elsewhere, |Crossing { t, .. }| {
                if t > 0.0 && t <= segment.length + scene.tolerance {
                    opening = Some(opening.map_or(t, |first| first.min(t)));
                }
            });
        }
    }
    opening
}
