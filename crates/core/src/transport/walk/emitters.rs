//! Sources as gather paths see them: the basic radiance they emit against a ray.
//!
//! Points, lines and collimated beams have no radiance that a ray could meet; an estimator that
//! must meet such sources is refused.

use crate::scene::shape::{Crossing, RayStart, Shape};
use crate::scene::{
    Emitter, EmitterKind, PrimId, Scene, SolidId, Source, SourceId, StartSolids as SourceStart,
};
use crate::transport::{MetEmission, Path, Segment};
use glam::DVec3;
use lumiduct_base::math::Aabb;

/// Light of a source behind a face is met at the start of a segment, up to rounding of this size, relative to the scene.
const AT_START: f64 = 1e-9;

/// The sources of a scene, prepared for rays.
#[derive(Debug)]
pub struct Emitters<'s> {
    scene: &'s Scene,
    seen: Vec<SeenSource<'s>>,
}

/// A source that rays can meet.
#[derive(Debug)]
struct SeenSource<'s> {
    id: SourceId,
    source: &'s Source,
    body: EmittingBody<'s>,
}

#[derive(Debug)]
enum EmittingBody<'s> {
    Surface {
        shapes: &'s [(Shape, f64)],
        on: &'s [PrimId],
        contact: Contact,
        /// Box around the shapes, with room for rounding, mm.
        bounds: Aabb,
    },
    Volume {
        solid: SolidId,
        /// Flux per volume, lm/mm³.
        density: f64,
        /// Usual length of a path through it, mm: the side of a cube of its volume.
        usual_length: f64,
    },
}

/// Position of a source relative to a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Contact {
    /// On no face.
    Free,
    /// It shines away from the face: a ray meets it before the face acts.
    Before,
    /// It shines into the face: a ray meets it after the face has acted.
    Behind,
}

/// Start of a segment, which decides about emission right there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SegmentStart {
    /// On a free sensor: emission there counts.
    Sensor,
    /// On a face that is the sensor: emission away from it there does not arrive at it.
    Face,
    /// At an interface: the previous segment met the emission there.
    Interface,
}

/// Why rays cannot meet a source; `None` if they can, or if it is dark.
pub fn invisible(source: &Source, scene: &Scene) -> Option<&'static str> {
    if !source.is_lit() {
        return None;
    }
    let any = DVec3::Z;
    match &source.emitter {
        Emitter::Point(_) => Some("it is a point"),
        Emitter::Line { .. } => Some("it is a line"),
        Emitter::Rays { .. } => Some("it is a set of rays"),
        Emitter::Fitted { .. } => None,
        Emitter::Surface { .. } | Emitter::Opening(_) | Emitter::Far { .. } => source
            .emission
            .density(EmitterKind::Surface, any)
            .is_none()
            .then_some("it shines in one direction"),
        Emitter::Volume { solid, .. } => {
            if source.emission.density(EmitterKind::Volume, any).is_none() {
                return Some("it shines in one direction");
            }
            scene.solids[solid.index()]
                .volume
                .is_none()
                .then_some("the volume of its solid is not known")
        }
    }
}

impl<'s> Emitters<'s> {
    /// The shining sources of a scene that rays can meet.
    pub fn new(scene: &'s Scene) -> Self {
        let visible = scene.sources.iter().enumerate();
        let visible =
            visible.filter(|(_, source)| source.is_lit() && invisible(source, scene).is_none());
        let seen = visible.filter_map(|(index, source)| {
            Some(SeenSource { id: SourceId::new(index), source, body: body(scene, source)? })
        });
        Self { scene, seen: seen.collect() }
    }

    /// Whether paths can meet the light of a source.
    pub(crate) fn meets(&self, source: SourceId) -> bool {
        self.seen.iter().any(|seen| seen.id == source)
    }

    /// Everything that a path meets along a segment.
    pub(crate) fn along(
        &self,
        path: &Path,
        segment: &Segment<'_>,
        start: SegmentStart,
        mut visit: impl FnMut(MetEmission),
    ) {
        for seen in &self.seen {
            match &seen.body {
                EmittingBody::Surface { bounds, .. } => {
                    if bounds.is_near(segment.ray.origin(), segment.ray.at(segment.length)) {
                        self.surface(seen, path, segment, start, &mut visit);
                    }
                }
                EmittingBody::Volume { solid, density, .. } => {
                    if path.inside.contains(*solid) {
                        let radiance = self.volume(seen, *density, path, segment);
                        let emitted = self.volume_radiance(seen, path, -path.ray.dir());
                        // A source may be dark at the wavelength of the path.
                        if emitted > 0.0 {
                            visit(MetEmission {
                                source: seen.id,
                                shape: 0,
                                t: segment.length,
                                radiance,
                                emitted,
                            });
                        }
                    }
                }
            }
        }
    }

    fn surface(
        &self,
        seen: &SeenSource<'_>,
        path: &Path,
        segment: &Segment<'_>,
        start: SegmentStart,
        visit: &mut impl FnMut(MetEmission),
    ) {
        let EmittingBody::Surface { shapes, on, contact, .. } = &seen.body else { return };
        let (scene, ray) = (self.scene, segment.ray);
        let tolerance = scene.tolerance;
        let medium = &scene.media[segment.medium.index()];
        let index = medium.index(path.wavelength);
        let (from, to) = match (contact, start) {
            (Contact::Free, SegmentStart::Sensor) => (-tolerance, segment.length),
            (Contact::Free, SegmentStart::Face | SegmentStart::Interface) => {
                (tolerance, segment.length)
            }
            (Contact::Before, SegmentStart::Sensor) => (-tolerance, segment.length + tolerance),
            (Contact::Before, SegmentStart::Face | SegmentStart::Interface) => {
                (tolerance, segment.length + tolerance)
            }
            (Contact::Behind, _) => {
                (-AT_START * scene.bounds.diagonal(), segment.length - tolerance)
            }
        };
        for (place, (shape, _)) in shapes.iter().enumerate() {
            let starts_there = on.get(place).is_some_and(|prim| path.on.contains(*prim));
            let shape_start = if starts_there { RayStart::On } else { RayStart::Elsewhere };
            shape.crossings(ray, shape_start, |Crossing { t, .. }| {
                if t < from || t > to {
                    return;
                }
                let whole = seen.source.radiance(shape, ray.at(t), -ray.dir()) / (index * index);
                if whole <= 0.0 {
                    return;
                }
                let emitted = scene.gathered_spectral_weight(seen.id, path.wavelength) * whole;
                // A source may be dark at the wavelength of the path.
                if emitted > 0.0 {
                    let arriving =
                        segment.throughput * medium.transmittance(path.wavelength, t.max(0.0));
                    visit(MetEmission {
                        source: seen.id,
                        shape: place,
                        t,
                        radiance: emitted * arriving,
                        emitted,
                    });
                }
            });
        }
    }

    /// Basic radiance that a source emits along the start of a photon's path, from one of its
    /// shapes, lm/(mm² sr): the same that a gather path meets there as [`MetEmission::emitted`]. 0 for a
    /// source that rays cannot meet.
    pub(crate) fn emitted(&self, source: SourceId, path: &Path, shape: usize) -> f64 {
        let Some(seen) = self.seen.iter().find(|seen| seen.id == source) else { return 0.0 };
        match &seen.body {
            EmittingBody::Surface { shapes, .. } => {
                let index = self.scene.media[path.medium.index()].index(path.wavelength);
                let (start, dir) = (path.ray.origin(), path.ray.dir());
                let spectral = self.scene.gathered_spectral_weight(source, path.wavelength);
                spectral * seen.source.radiance(&shapes[shape].0, start, dir) / (index * index)
            }
            EmittingBody::Volume { .. } => self.volume_radiance(seen, path, path.ray.dir()),
        }
    }

    /// Basic radiance of a path of usual length through a glowing solid, lm/(mm² sr); 0 for a
    /// surface.
    fn volume_radiance(&self, seen: &SeenSource<'_>, path: &Path, out: DVec3) -> f64 {
        let EmittingBody::Volume { density, usual_length, .. } = &seen.body else { return 0.0 };
        let index = self.scene.media[path.medium.index()].index(path.wavelength);
        let law = seen.source.emission.density(EmitterKind::Volume, out).unwrap_or(0.0);
        let spectral = self.scene.gathered_spectral_weight(seen.id, path.wavelength);
        spectral * density * law * usual_length / (index * index)
    }

    /// Emission along a segment in a glowing solid: ∫ ε exp(-αs) ds, lm/(mm² sr), over n².
    fn volume(
        &self,
        seen: &SeenSource<'_>,
        density: f64,
        path: &Path,
        segment: &Segment<'_>,
    ) -> f64 {
        let medium = &self.scene.media[segment.medium.index()];
        let index = medium.index(path.wavelength);
        let absorption = medium.absorption(path.wavelength);
        let length = if absorption == 0.0 {
            segment.length
        } else {
            -(-absorption * segment.length).exp_m1() / absorption
        };
        let law =
            seen.source.emission.density(EmitterKind::Volume, -segment.ray.dir()).unwrap_or(0.0);
        let spectral = self.scene.gathered_spectral_weight(seen.id, path.wavelength);
        segment.throughput * spectral * density * law * length / (index * index)
    }
}

fn body<'s>(scene: &'s Scene, source: &'s Source) -> Option<EmittingBody<'s>> {
    let surface = |shapes: &'s [(Shape, f64)]| EmittingBody::Surface {
        shapes,
        on: &source.on,
        contact: contact(source),
        bounds: source.emitter.bounds().grown(2.0 * AT_START * scene.bounds.diagonal()),
    };
    match &source.emitter {
        Emitter::Surface { shapes, .. } => Some(surface(shapes)),
        Emitter::Opening(opening) => Some(surface(opening.shapes())),
        Emitter::Far { shapes, .. } | Emitter::Fitted { shapes, .. } => Some(surface(shapes)),
        Emitter::Volume { solid, .. } => {
            let volume = scene.solids[solid.index()].volume?;
            Some(EmittingBody::Volume {
                solid: *solid,
                density: source.flux / volume,
                usual_length: volume.cbrt(),
            })
        }
        Emitter::Point(_) | Emitter::Line { .. } | Emitter::Rays { .. } => None,
    }
}

fn contact(source: &Source) -> Contact {
    match source.start {
        SourceStart::Outside if source.on.is_empty() => Contact::Free,
        SourceStart::Outside | SourceStart::Ahead => Contact::Before,
        SourceStart::Behind => Contact::Behind,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Medium;
    use crate::rng::Sampler;
    use crate::scene::shape::{Cylinder, Flat, Region};
    use crate::scene::{
        Builder, DrawnWavelength, Emission, EmitSide, EmittedRay, FittedLight, LuminousOpening,
        Ray, RaySet,
    };
    use lumiduct_base::math::Frame;
    use lumiduct_base::units::FluxUnit;
    use std::sync::Arc;

    /// Light to both sides of a plane, fitted to a few rays.
    fn fitted() -> Emitter {
        let ray = |n: u16| {
            let [x, y, z] = [7, 11, 13].map(|step| f32::from(n * step % 17) / 17.0 - 0.4);
            let direction = glam::Vec3::new(x * y, z, x).normalize();
            EmittedRay { position: glam::Vec3::new(y, x, 0.1 * z), direction, flux: 1.0 + z }
        };
        let rays = RaySet::new((0..200).map(ray)).unwrap();
        let frame =
            Frame::from_axis(DVec3::new(7.0, 0.0, 5.0), DVec3::new(0.3, 0.1, 1.0).normalize());
        Emitter::fitted(Arc::new(FittedLight::new(&rays, None).unwrap()), frame)
    }

    #[test]
    fn a_photon_and_the_gather_path_that_meets_its_start_tell_the_same_emission() {
        let mut builder =
            Builder::new(DVec3::ZERO, Medium::new("water", 1.3, 0.1), FluxUnit::Lumen);
        let disk = |z: f64| {
            let frame = Frame::WORLD.shifted(DVec3::new(0.0, 0.0, z));
            Shape::Flat(Flat::new(frame, Region::Annulus { inner: 0.0, outer: 2.0 }))
        };
        let tilted = Frame::from_axis(DVec3::ZERO, DVec3::new(0.3, 0.0, 1.0).normalize());
        let cone = Emission::Cone { half_angle: 0.2, axis: DVec3::Z };
        let wall = Shape::Cylinder(Cylinder::new(Frame::WORLD, 1.0, 3.0));
        let surface = |shapes, frame| Emitter::surface(shapes, EmitSide::Front, frame);
        let aside = |x: f64| tilted.shifted(DVec3::new(x, 0.0, 0.0));
        let (sizes, flat) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 2.0, 0.0));
        let cosine = Emission::CosinePower(0.5);
        let emitters = [
            (surface(vec![disk(5.0)], Some(tilted)), cone),
            (surface(vec![disk(9.0), wall, disk(20.0)], None), Emission::CosinePower(3.0)),
            (fitted(), Emission::Isotropic),
            (Emitter::Opening(LuminousOpening::cuboid(aside(20.0), sizes)), Emission::Isotropic),
            (Emitter::Opening(LuminousOpening::cuboid(aside(40.0), flat)), Emission::Isotropic),
            (Emitter::Opening(LuminousOpening::cylinder(aside(60.0), 1.0, 2.0)), cosine),
        ];
        for (emitter, emission) in emitters {
            builder.add_source(Source {
                name: "lamp".into(),
                flux: 7.0,
                emitter,
                emission,
                start: SourceStart::Outside,
                on: Vec::new(),
                spectrum: None,
                elevation: None,
                sun: None,
            });
        }
        let scene = builder.build();
        let emitters = Emitters::new(&scene);
        for (source, index) in
            (0..scene.sources.len()).flat_map(|one| (0..200).map(move |i| (one, i)))
        {
            let id = SourceId::new(source);
            let mut sampler = Sampler::for_path(3, 0, index);
            let wavelength = DrawnWavelength::REFERENCE;
            let emitted = scene.sources[source].emit(&scene, wavelength, &mut sampler);
            let shape = emitted.shape;
            let photon = Path::emitted(&scene, id, emitted);
            let told = emitters.emitted(id, &photon, shape);
            let back = Ray::new(photon.ray.at(1.0), -photon.ray.dir());
            let gather = Path { ray: back, throughput: 0.5, ..photon.clone() };
            let segment = Segment {
                ray: &back,
                length: 1.5,
                medium: gather.medium,
                throughput: 0.5,
                arriving: 0.4,
            };
            let mut met = Vec::new();
            emitters.along(&gather, &segment, SegmentStart::Interface, |one| met.push(one));
            let own = met.iter().find(|met| met.source == id && (met.t - 1.0).abs() < 1e-9);
            let own = own.expect("the ray leads back to the start");
            assert!((own.emitted / told - 1.0).abs() < 1e-6, "{source}: {own:?}, {told}");
            assert!((own.radiance / told / 0.5 - (-0.1f64).exp()).abs() < 1e-6, "{own:?}, {told}");
        }
    }
}
