//! The origin of light that arrives at a sensor: the starts of gather paths.
//!
//! A gather path travels against the light. It is drawn from the cells and directions of its sensor
//! and carries the extent that it represents, so that the mean of radiance times extent is the flux
//! on the sensor. This module does not know what the path meets.

use crate::rng::{Dimension, Numbers, Sampler};
use crate::scene::crossing::hit::StartSide;
use crate::scene::shape::Toward;
use crate::scene::start::area::{AreaPoint, FaceArea};
use crate::scene::start::around::Around;
use crate::scene::start::directions::{
    Drawn, away, projected_toward, toward, view_direction, views_projected,
};
use crate::scene::start::polar::{PolarLaw, bin};
use crate::scene::start::strata::{DrawnDirection, Strata, direction, numbers_in_pixel};
use crate::scene::{
    CountedLight, DrawnWavelength, Goniometer, Inside, Place, PrimId, Ray, Scene, Seeing, SensorId,
    SensorKind, Sides, SurfaceSensor, Wavelengths,
};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Frame, cosine_hemisphere, disk};
use smallvec::{SmallVec, smallvec};
use std::f64::consts::PI;

/// A path that must meet the face it starts in front of starts this far from it, relative to the
/// size of the scene: far above rounding, far below any manufacturable size.
const STEP_BACK: f64 = 1e-9;

/// The start of a gather path.
#[derive(Debug, Clone)]
pub struct Arrival {
    /// From the sensor, against the light.
    pub ray: Ray,
    /// Unit normal of the sensor; of a far field, the direction of its light.
    pub normal: DVec3,
    /// The solids it starts in.
    pub inside: Inside,
    /// The surface of the scene that it starts on.
    pub on: Option<PrimId>,
    /// Whether it starts in front of the sensor's own face and must first pass through it.
    pub begins: Begins,
    /// |cos θ| dA dω over the density of the draw, mm² sr: times radiance it is flux, times n² it
    /// is etendue.
    pub extent: f64,
    /// Its wavelength.
    pub wavelength: DrawnWavelength,
    /// The values of the sensor that receive its light: cells, or cells of views.
    pub cells: SmallVec<[usize; 1]>,
}

/// Where a gather path begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Begins {
    /// On the sensor: light arrives there.
    OnSensor,
    /// Before the sensor's face: light leaves it after the face has acted.
    BeforeFace,
}

/// Draws the starts of gather paths for one sensor.
#[derive(Debug)]
pub struct Arrivals<'s> {
    scene: &'s Scene,
    place: StartSet<'s>,
    /// The faces through which the sensor is lit, if it names any that matter.
    aim: Option<FaceArea<'s>>,
    /// Angles to the normal of a sensor that sees half spaces.
    polar: PolarLaw,
}

/// The set from which gather paths start.
#[derive(Debug)]
enum StartSet<'s> {
    Surface(&'s SurfaceSensor, FaceArea<'s>),
    /// A goniometric sphere, finite or in the far field.
    Sphere(&'s Goniometer, Around),
}

impl Arrival {
    /// The bin of its angle to the normal, of those of a law that is learned.
    pub fn polar_bin(&self) -> usize {
        bin(sin_squared(&self.ray, self.normal))
    }
}

impl<'s> Arrivals<'s> {
    /// Prepares the draws of a sensor.
    pub fn new(scene: &'s Scene, sensor: SensorId) -> Self {
        let sensor = &scene.sensors[sensor.index()];
        let place = match &sensor.kind {
            SensorKind::Surface(surface) => {
                StartSet::Surface(surface, FaceArea::new(scene, &surface.faces))
            }
            SensorKind::Goniometer(goniometer) => StartSet::Sphere(goniometer, Around::of(scene)),
        };
        let aimed = match &sensor.kind {
            // Light that leaves a face comes from the face.
            SensorKind::Surface(surface) => {
                surface.place == Place::Port || surface.counts == CountedLight::Incident
            }
            SensorKind::Goniometer(_) => true,
        };
        let aim = (aimed && !sensor.aim.is_empty()).then(|| FaceArea::new(scene, &sensor.aim));
        Self { scene, place, aim, polar: PolarLaw::Cosine }
    }

    /// Sets the law of the angles to the normal, which is the cosine law at first.
    pub fn set_polar(&mut self, polar: PolarLaw) {
        self.polar = polar;
    }

    /// Density of a start by the cosine law over that by the law that it was drawn by.
    pub fn polar_reciprocal(&self, start: &Arrival) -> f64 {
        self.polar.reciprocal(sin_squared(&start.ray, start.normal))
    }

    /// Whether starts lie in all directions of a half space, so that the law of their angles matters.
    pub fn see_half_spaces(&self) -> bool {
        let sees_all = match &self.place {
            StartSet::Surface(sensor, _) => matches!(sensor.seeing, Seeing::All),
            StartSet::Sphere(goniometer, _) => goniometer.radius.is_some(),
        };
        sees_all && self.aim.is_none()
    }

    /// The strata of the draws: the values of the sensor, as far as starts can be drawn for one of them.
    pub fn strata(&self) -> Strata<'s> {
        match &self.place {
            StartSet::Surface(sensor, area) => Strata::of_surface(sensor, area),
            StartSet::Sphere(goniometer, _) => Strata::of_sphere(goniometer),
        }
    }

    /// Draws a start; `None` where it misses the sensor or a side that counts: such a draw represents no light.
    pub fn draw(&self, sampler: &mut Sampler<impl Numbers>) -> Option<Arrival> {
        self.draw_from((None, Wavelengths::All), sampler)
    }

    /// Draws a start of some wavelengths; `None` as for [`Self::draw`].
    pub(crate) fn draw_of(
        &self,
        wavelengths: Wavelengths,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Arrival> {
        self.draw_from((None, wavelengths), sampler)
    }

    /// Draws a start from one of its strata, which are drawn equally often; `None` as for [`Self::draw`].
    pub fn draw_in(
        &self,
        (strata, stratum): (&Strata<'s>, usize),
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Arrival> {
        self.draw_from((Some((strata, stratum)), Wavelengths::All), sampler)
    }

    #[inline(always)]
    fn draw_from(
        &self,
        (part, wavelengths): (Option<(&Strata<'s>, usize)>, Wavelengths),
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Arrival> {
        let wavelength = self.scene.gather_wavelength(wavelengths, sampler);
        let arrival = match &self.place {
            StartSet::Surface(sensor, area) => {
                let u = sampler.pair(Dimension::GatherPosition);
                let (start, area) = match part {
                    None => (area.sample(u)?, area.area()),
                    Some((strata, stratum)) => strata.point(area, stratum, u)?,
                };
                let cell = sensor.grid.cell(start.uv)?;
                let view = part.and_then(|(strata, stratum)| strata.view(stratum));
                let toward = self.surface_direction((sensor, view), &start, sampler)?;
                self.at_surface(sensor, &start, cell, toward, area)
            }
            StartSet::Sphere(goniometer, around) => {
                let cell = part.map(|(_, stratum)| stratum);
                match goniometer.radius {
                    None => self.in_far_field((goniometer, cell), *around, sampler),
                    Some(radius) => self.on_sphere((goniometer, cell), radius, sampler),
                }
            }
        };
        arrival.map(|arrival| Arrival { wavelength, ..arrival })
    }

    /// Extent of a draw of a start by [`Self::draw`], as in [`Arrival::extent`], mm² sr, for a start that was not necessarily
    /// drawn. The ray leaves the sensor against light that the sensor counts; `normal` is that of a surface sensor.
    pub fn extent(&self, ray: &Ray, normal: DVec3) -> f64 {
        match &self.place {
            StartSet::Surface(sensor, area) => {
                area.area() * self.surface_projected(sensor, ray, normal)
            }
            StartSet::Sphere(goniometer, around) => match goniometer.radius {
                None => {
                    let beyond = ray.origin() - 4.0 * around.radius * ray.dir();
                    self.across(&Ray::new(beyond, ray.dir()), *around) * 4.0 * PI
                }
                Some(radius) => {
                    let out = (ray.origin() - goniometer.frame.origin) / radius;
                    let aimed = self.aim.as_ref();
                    let projected = aimed.map_or_else(
                        || self.half_space(ray, out),
                        |aim| projected_toward(aim, ray, out),
                    );
                    4.0 * PI * radius * radius * projected
                }
            },
        }
    }

    /// |cos θ| over the density with which a direction is drawn at a point of a surface sensor, sr.
    fn surface_projected(&self, sensor: &SurfaceSensor, ray: &Ray, normal: DVec3) -> f64 {
        match (&sensor.seeing, &self.aim) {
            (Seeing::Views(views), _) => {
                let accepting = views.accepting(away(ray.dir(), sensor.counts)).count();
                views_projected(views, accepting.max(1), ray.dir().dot(normal))
            }
            (Seeing::Pixels(pixels), _) => pixels.projected_toward(ray.dir()),
            (Seeing::All, Some(aim)) => projected_toward(aim, ray, normal),
            (Seeing::All, None) => match sensor.sides {
                Sides::Front | Sides::Back => self.half_space(ray, normal),
                Sides::Both => 2.0 * self.half_space(ray, normal),
            },
        }
    }

    /// |cos θ| over the density of a direction of a half space, sr.
    fn half_space(&self, ray: &Ray, normal: DVec3) -> f64 {
        PI * self.polar.reciprocal(sin_squared(ray, normal))
    }

    /// A direction of the half space about an axis.
    fn direction(&self, axis: DVec3, sampler: &mut Sampler<impl Numbers>) -> DVec3 {
        let [u, turn] = sampler.pair(Dimension::GatherDirection);
        let local = cosine_hemisphere([self.polar.draw(u), turn]);
        Frame::from_axis(DVec3::ZERO, axis).to_world(local)
    }

    /// The reciprocal of the density over area with which a ray of a far field is drawn, mm².
    fn across(&self, ray: &Ray, around: Around) -> f64 {
        let aimed = self.aim.as_ref();
        aimed.map_or(PI * around.radius * around.radius, |aim| 1.0 / aim.density_across(ray))
    }

    /// A direction against the light for a point of a surface sensor, with |cos θ| over its
    /// density, sr, and the views that accept it.
    fn surface_direction(
        &self,
        (sensor, view): (&SurfaceSensor, Option<usize>),
        start: &AreaPoint,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Drawn> {
        match &sensor.seeing {
            Seeing::All => {}
            Seeing::Views(views) => {
                return Some(view_direction((views, view), sensor.counts, start, sampler));
            }
            Seeing::Pixels(pixels) => {
                let mut u = sampler.pair(Dimension::GatherDirection);
                if let Some(pixel) = view {
                    u = numbers_in_pixel(&pixels.grid, pixel, u);
                }
                let (dir, pixel, projected) = pixels.draw(u)?;
                return Some(Drawn { dir, projected, views: smallvec![pixel] });
            }
        }
        if let Some(aim) = &self.aim {
            let target = aim.sample(sampler.pair(Dimension::GatherPosition))?;
            return toward(aim, start, target.point);
        }
        let front = match sensor.sides {
            Sides::Front => true,
            Sides::Back => false,
            Sides::Both => sampler.one(Dimension::GatherDirection) < 0.5,
        };
        // Arriving light comes from the side that counts; leaving light goes to it.
        let outward = front == (sensor.counts == CountedLight::Incident);
        let axis = if outward { start.normal } else { -start.normal };
        let dir = self.direction(axis, sampler);
        let projected = self.surface_projected(sensor, &Ray::new(start.point, dir), start.normal);
        Some(Drawn { dir, projected, views: SmallVec::new() })
    }

    fn at_surface(
        &self,
        sensor: &SurfaceSensor,
        start: &AreaPoint,
        cell: usize,
        drawn: Drawn,
        area: f64,
    ) -> Option<Arrival> {
        let Drawn { dir, projected, views } = drawn;
        if !sensor.sides.include(sensor.counts, Toward::of(-dir, start.normal)) {
            return None;
        }
        let begins = match (sensor.place, sensor.counts) {
            (Place::Port, _) | (Place::Face, CountedLight::Incident) => Begins::OnSensor,
            (Place::Face, CountedLight::Leaving) => Begins::BeforeFace,
        };
        let (ray, on) = match begins {
            Begins::OnSensor => (Ray::new(start.point, dir), start.prim),
            Begins::BeforeFace => {
                let back = STEP_BACK * self.scene.bounds.diagonal();
                (Ray::new(start.point - back * dir, dir), None)
            }
        };
        let cells = match &sensor.seeing {
            Seeing::All => smallvec![cell],
            Seeing::Views(_) | Seeing::Pixels(_) => {
                views.into_iter().map(|view| view * sensor.grid.cells() + cell).collect()
            }
        };
        Some(self.arrival((ray, start.normal), on, begins, area * projected, cells))
    }

    /// A start outside of everything, in a direction of a far-field goniometer.
    fn in_far_field(
        &self,
        (goniometer, cell): (&Goniometer, Option<usize>),
        around: Around,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Arrival> {
        let u = sampler.pair(Dimension::GatherDirection);
        let DrawnDirection { cell, out, solid_angle } = direction(goniometer, cell, u);
        let u = sampler.pair(Dimension::GatherPosition);
        let through = match &self.aim {
            Some(aim) => aim.sample(u)?.point,
            None => {
                let frame = Frame::from_axis(around.center, out);
                frame.point_to_world(around.radius * disk(u))
            }
        };
        // Beyond the ball, whichever point of it the ray passes through.
        let ray = Ray::new(through + 2.0 * around.radius * out, -out);
        let extent = self.across(&ray, around) * solid_angle;
        extent
            .is_finite()
            .then(|| self.arrival((ray, out), None, Begins::OnSensor, extent, smallvec![cell]))
    }

    /// A start on a goniometric sphere of finite radius, inward.
    fn on_sphere(
        &self,
        (goniometer, cell): (&Goniometer, Option<usize>),
        radius: f64,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Arrival> {
        let u = sampler.pair(Dimension::GatherPosition);
        let DrawnDirection { cell, out, solid_angle } = direction(goniometer, cell, u);
        let start = AreaPoint {
            point: goniometer.frame.origin + radius * out,
            normal: -out,
            uv: DVec2::ZERO,
            prim: None,
        };
        let Drawn { dir, projected, .. } = match &self.aim {
            Some(aim) => {
                let target = aim.sample(sampler.pair(Dimension::GatherPosition))?;
                toward(aim, &start, target.point).filter(|drawn| drawn.dir.dot(out) < 0.0)?
            }
            None => {
                let dir = self.direction(-out, sampler);
                let projected = self.half_space(&Ray::new(start.point, dir), out);
                Drawn { dir, projected, views: SmallVec::new() }
            }
        };
        let extent = solid_angle * radius * radius * projected;
        let ray = Ray::new(start.point, dir);
        Some(self.arrival((ray, out), None, Begins::OnSensor, extent, smallvec![cell]))
    }

    /// A start with the solids around it, of light without a spectrum.
    fn arrival(
        &self,
        (ray, normal): (Ray, DVec3),
        on: Option<PrimId>,
        begins: Begins,
        extent: f64,
        cells: SmallVec<[usize; 1]>,
    ) -> Arrival {
        let inside = self.scene.inside_at(&ray, StartSide::Ahead);
        let wavelength = DrawnWavelength::REFERENCE;
        Arrival { ray, normal, inside, on, begins, extent, wavelength, cells }
    }
}

/// sin² of the angle between a ray and a normal.
fn sin_squared(ray: &Ray, normal: DVec3) -> f64 {
    (1.0 - ray.dir().dot(normal).powi(2)).max(0.0)
}
