//! The sensors of a scene by the places where light can meet them: found once per run, queried at every event.

use crate::scene::{
    CountedLight, FaceId, Goniometer, Owner, Patch, Place, Scene, SensorId, SensorKind,
    SurfaceSensor,
};
use crate::transport::Segment;
use lumiduct_base::math::Aabb;

/// The sensors of a scene, by where light can meet them.
#[derive(Debug)]
pub(crate) struct SensorTable<'s> {
    /// Sensors on ports: every segment is tested against their patches.
    pub(crate) ports: Vec<OnPort<'s>>,
    /// For every face, the light that is counted on it.
    pub(crate) watched: Vec<Watched>,
    /// For every face, the sensors on it.
    pub(crate) faces: Vec<Vec<(SensorId, &'s SurfaceSensor)>>,
    /// Far-field goniometers: escaping light is counted.
    pub(crate) far: Vec<(SensorId, &'s Goniometer)>,
    /// Goniometers of finite radius: every segment is tested.
    pub(crate) near: Vec<(SensorId, &'s Goniometer)>,
    /// For every face, the sensors with a transmission relative to the flux that enters through it.
    pub(crate) entries: Vec<Vec<SensorId>>,
    /// Open ports that are such entries.
    pub(crate) entry_ports: Vec<(FaceId, &'s [Patch])>,
}

/// The light that is counted on a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Watched {
    incident: bool,
    leaving: bool,
}

impl Watched {
    /// Whether arriving or leaving light is counted.
    #[inline(always)]
    pub(crate) fn includes(self, counts: CountedLight) -> bool {
        match counts {
            CountedLight::Incident => self.incident,
            CountedLight::Leaving => self.leaving,
        }
    }
}

/// A sensor on a port.
#[derive(Debug)]
pub(crate) struct OnPort<'s> {
    /// The sensor.
    pub(crate) id: SensorId,
    /// Its surface sensor.
    pub(crate) sensor: &'s SurfaceSensor,
    /// The pieces of its port.
    pub(crate) patches: Vec<&'s Patch>,
    /// A box around them, with room for rounding.
    bounds: Aabb,
}

impl OnPort<'_> {
    /// Whether a segment comes near the port; most do not, and need no further test.
    #[inline(always)]
    pub(crate) fn may_be_crossed(&self, segment: &Segment<'_>) -> bool {
        self.bounds.is_near(segment.ray.origin(), segment.ray.at(segment.length))
    }
}

impl<'s> SensorTable<'s> {
    /// Sorts the sensors of a scene.
    pub(crate) fn new(scene: &'s Scene) -> Self {
        let mut table = Self {
            ports: Vec::new(),
            watched: Vec::new(),
            faces: vec![Vec::new(); scene.faces.len()],
            far: Vec::new(),
            near: Vec::new(),
            entries: vec![Vec::new(); scene.faces.len()],
            entry_ports: Vec::new(),
        };
        for (index, sensor) in scene.sensors.iter().enumerate() {
            let id = SensorId::new(index);
            match &sensor.kind {
                SensorKind::Surface(surface) => table.add_surface(scene, id, surface),
                SensorKind::Goniometer(goniometer) if goniometer.radius.is_some() => {
                    table.near.push((id, goniometer));
                }
                SensorKind::Goniometer(goniometer) => table.far.push((id, goniometer)),
            }
            if let Some(face) = sensor.entering {
                if scene.faces[face.index()].owner == Owner::Port
                    && table.entries[face.index()].is_empty()
                {
                    table.entry_ports.push((face, scene.face_patches(face)));
                }
                table.entries[face.index()].push(id);
            }
        }
        table.watched = (table.faces.iter().zip(&table.entries))
            .map(|(sensors, entries)| {
                let any = |counts| sensors.iter().any(|(_, sensor)| sensor.counts == counts);
                // Light enters where it leaves the face inward.
                Watched {
                    incident: any(CountedLight::Incident),
                    leaving: any(CountedLight::Leaving) || !entries.is_empty(),
                }
            })
            .collect();
        table
    }

    fn add_surface(&mut self, scene: &'s Scene, id: SensorId, sensor: &'s SurfaceSensor) {
        match sensor.place {
            Place::Port => {
                let patches: Vec<&Patch> =
                    sensor.faces.iter().flat_map(|face| scene.face_patches(*face)).collect();
                let bounds = patches
                    .iter()
                    .fold(Aabb::EMPTY, |bounds, patch| bounds.union(patch.shape.bounds()))
                    .grown(2.0 * scene.tolerance);
                self.ports.push(OnPort { id, sensor, patches, bounds });
            }
            Place::Face => {
                for face in &sensor.faces {
                    self.faces[face.index()].push((id, sensor));
                }
            }
        }
    }
}
