//! The local axes of every face and sensor of a scene, for drawings and tables.

use crate::drawing::{Role, role, sensed_faces};
use glam::DVec3;
use lumiduct_core::scene::shape::ChartRect;
use lumiduct_core::scene::{FaceId, Scene, SensorKind};

/// The axes of a face or of a sensor.
#[derive(Debug, Clone)]
pub(crate) struct LocalAxes {
    /// Its name.
    pub(crate) name: String,
    /// What it is.
    pub(crate) role: Role,
    /// Where u and v are 0, mm in the user's coordinates; for a goniometer, its middle.
    pub(crate) origin: DVec3,
    /// Unit vector along u; the direction of C = 0 of a goniometer.
    pub(crate) u: DVec3,
    /// Unit vector along v; the direction of C = 90 deg of a goniometer.
    pub(crate) v: DVec3,
    /// Unit normal; the pole of a goniometer, gamma = 0.
    pub(crate) normal: DVec3,
    /// What u and v cover, mm; `None` for a goniometer.
    pub(crate) rect: Option<ChartRect>,
}

/// The axes of all faces that have unrolled coordinates, and of all goniometers.
pub(crate) fn local_axes(scene: &Scene) -> Vec<LocalAxes> {
    let sensed = sensed_faces(scene);
    let faces = scene.faces.iter().enumerate().filter_map(|(index, face)| {
        let id = FaceId::new(index);
        let found = scene.face_axes(id)?;
        Some(LocalAxes {
            name: face.name.clone(),
            role: role(face, sensed.contains(&id)),
            origin: found.origin + scene.origin,
            u: found.u,
            v: found.v,
            normal: found.normal,
            rect: Some(found.rect),
        })
    });
    let spheres = scene.sensors.iter().filter_map(|sensor| match &sensor.kind {
        SensorKind::Surface(_) => None,
        SensorKind::Goniometer(goniometer) => Some(LocalAxes {
            name: sensor.name.clone(),
            role: Role::Sensor,
            origin: goniometer.frame.origin + scene.origin,
            u: goniometer.frame.x,
            v: -goniometer.frame.y,
            normal: goniometer.frame.z,
            rect: None,
        }),
    });
    faces.chain(spheres).collect()
}
