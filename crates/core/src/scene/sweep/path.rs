//! From legs to pieces: where every straight, taper, bend and corner lies, with the walls at a
//! corner extended to the planes that end them.

use crate::scene::sweep::profile::MAX_LENGTH;
use crate::scene::sweep::{CornerKind, Leg, Profile, SweepError, SweepProblem};
use glam::{DVec2, DVec3};
use lumiduct_base::math::Frame;
use std::f64::consts::{PI, TAU};

/// The pieces of a path in order, and the section after the last one.
#[derive(Debug, Clone)]
pub(super) struct SweptPath {
    pub(super) pieces: Vec<PathPiece>,
    pub(super) exit: Section,
}

/// A position on the path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Section {
    /// Origin on the centre line, z along it.
    pub(super) frame: Frame,
    /// Size of the profile relative to the entry.
    pub(super) scale: f64,
    /// Distance from the entry along the centre line, mm.
    pub(super) along: f64,
}

/// A piece of the path that sweeps one surface per wall.
#[derive(Debug, Clone)]
pub(super) struct PathPiece {
    /// Its leg.
    pub(super) leg: usize,
    /// Its start. Segments may start before or after this section, as set by their floor.
    pub(super) start: Section,
    pub(super) form: PieceForm,
}

/// The geometry of a piece.
#[derive(Debug, Clone)]
pub(super) enum PieceForm {
    /// All points over the profile between two ends.
    Prism { floor: PrismEnd, ceiling: PrismEnd },
    /// A straight leg that changes its size, to `end_scale` relative to the entry.
    Taper { length: f64, end_scale: f64 },
    /// An arc.
    Bend { angle: f64, radius: f64, toward: DVec2 },
    /// No length: the crossing of two centre lines.
    Corner { angle: f64, toward: DVec2, kind: CornerKind },
}

/// The end of a prism, as planes through one point of its axis: z = height + slope (q · toward) over the point q of the
/// section.
#[derive(Debug, Clone)]
pub(super) struct PrismEnd {
    pub(super) height: f64,
    pub(super) toward: DVec2,
    /// One for each plane; 0 for a plain section.
    pub(super) slopes: Vec<f64>,
}

impl PrismEnd {
    fn flat(height: f64) -> Self {
        Self { height, toward: DVec2::X, slopes: vec![0.0] }
    }

    /// Height of the highest plane over `q`, mm: the start of a prism with this floor.
    pub(super) fn highest(&self, q: DVec2) -> f64 {
        self.heights(q).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Height of the lowest plane over `q`, mm: the end of a prism with this ceiling.
    pub(super) fn lowest(&self, q: DVec2) -> f64 {
        self.heights(q).fold(f64::INFINITY, f64::min)
    }

    fn heights(&self, q: DVec2) -> impl Iterator<Item = f64> {
        let x = q.dot(self.toward);
        self.slopes.iter().map(move |slope| self.height + slope * x)
    }

    /// The height when the end is a plain section.
    pub(super) fn as_flat(&self) -> Option<f64> {
        (self.slopes == [0.0]).then_some(self.height)
    }
}

impl Section {
    /// The section advanced along z.
    fn advanced(&self, length: f64) -> Self {
        let frame = self.frame.shifted(length * self.frame.z);
        Self { frame, along: self.along + length, ..*self }
    }
}

/// The unit vector of an azimuth; exact on the axes, where sin and cos leave 1e-16.
pub(super) fn unit(azimuth: f64) -> DVec2 {
    let snap = |x: f64| if x.abs() < 1e-15 { 0.0 } else { x };
    let (sin, cos) = azimuth.sin_cos();
    DVec2::new(snap(cos), snap(sin))
}

/// Direction of an azimuth of the section, given as a unit vector.
pub(super) fn direction(frame: &Frame, toward: DVec2) -> DVec3 {
    toward.x * frame.x + toward.y * frame.y
}

/// The axes of `frame` rotated by `angle` so that z turns to the azimuth `toward`.
fn turned(frame: &Frame, angle: f64, toward: DVec2) -> Frame {
    let inner = direction(frame, toward);
    let axis = frame.z.cross(inner);
    let DVec2 { x: cos, y: sin } = unit(angle);
    let z = (cos * frame.z + sin * inner).normalize();
    let inner = cos * inner - sin * frame.z;
    let x = toward.x * inner - toward.y * axis;
    let x = (x - x.dot(z) * z).normalize();
    Frame { origin: frame.origin, x, y: z.cross(x), z }
}

/// The frame of a bend, which turns about its z: x points from the axis to the start of the bend, y
/// along the path there.
pub(super) fn bend_frame(start: &Frame, radius: f64, toward: DVec2) -> Frame {
    let inner = direction(start, toward);
    Frame { origin: start.origin + radius * inner, x: -inner, y: start.z, z: start.z.cross(inner) }
}

/// The frame of the plate across a mitred corner, where `before` is the section arriving at the
/// crossing: z points out of the guide, x half way between the two directions of the path, y along
/// the bend axis.
pub(super) fn mitre_frame(before: &Frame, angle: f64, toward: DVec2) -> Frame {
    let inner = direction(before, toward);
    let DVec2 { x: cos, y: sin } = unit(0.5 * angle);
    Frame {
        origin: before.origin,
        x: cos * before.z + sin * inner,
        y: before.z.cross(inner),
        z: sin * before.z - cos * inner,
    }
}

/// Lays out the legs, starting at `frame`, and checks each of them against the profile.
pub(super) fn trace(
    frame: Frame,
    profile: &Profile,
    legs: &[Leg],
) -> Result<SweptPath, SweepError> {
    let nowhere = |problem| SweepError { leg: None, problem };
    profile.check().map_err(|error| nowhere(error.into()))?;
    if legs.is_empty() {
        return Err(nowhere(SweepProblem::NoLegs));
    }
    let mut tracer = Tracer {
        profile,
        at: Section { frame, scale: 1.0, along: 0.0 },
        open: None,
        pieces: Vec::new(),
    };
    for (leg, &step) in legs.iter().enumerate() {
        tracer.go(leg, step).map_err(|problem| SweepError { leg: Some(leg), problem })?;
    }
    tracer.close(None);
    Ok(SweptPath { pieces: tracer.pieces, exit: tracer.at })
}

/// Follows the legs. Straight legs and the walls of corners that continue each other become one
/// prism.
struct Tracer<'a> {
    profile: &'a Profile,
    at: Section,
    open: Option<OpenPrism>,
    pieces: Vec<PathPiece>,
}

/// A prism that may still grow; its end so far is `at` of the tracer.
struct OpenPrism {
    leg: usize,
    start: Section,
    floor: PrismEnd,
    length: f64,
}

impl Tracer<'_> {
    fn go(&mut self, leg: usize, step: Leg) -> Result<(), SweepProblem> {
        match step {
            Leg::Straight { length, end_scale } => self.straight(leg, length, end_scale),
            Leg::Bend { angle, radius, toward } => self.bend(leg, angle, radius, toward),
            Leg::Corner { angle, toward, kind } => self.corner(leg, angle, toward, kind),
        }
    }

    fn straight(&mut self, leg: usize, length: f64, end_scale: f64) -> Result<(), SweepProblem> {
        positive("the length of this leg", length)?;
        positive("the end scale of this leg", end_scale)?;
        if end_scale == 1.0 {
            self.extend(leg, length).leg = leg;
            return Ok(());
        }
        let scale = self.at.scale * end_scale;
        if !(1e-6..=1e6).contains(&scale) {
            return Err(SweepProblem::Scaled { scale });
        }
        self.close(None);
        self.push(leg, self.at, PieceForm::Taper { length, end_scale: scale });
        self.at = Section { scale, ..self.at.advanced(length) };
        Ok(())
    }

    fn bend(
        &mut self,
        leg: usize,
        angle: f64,
        radius: f64,
        toward: f64,
    ) -> Result<(), SweepProblem> {
        positive("the radius of the bend", radius)?;
        check_azimuth(toward)?;
        if !(angle > 0.0 && angle <= TAU) {
            return Err(out_of_range("the bend", angle, "more than 0, up to 360"));
        }
        let toward = unit(toward);
        let reach = self.at.scale * self.profile.reach(toward);
        if reach >= radius {
            return Err(SweepProblem::TightBend { radius, reach });
        }
        self.close(None);
        self.push(leg, self.at, PieceForm::Bend { angle, radius, toward });
        let center = self.at.frame.origin + radius * direction(&self.at.frame, toward);
        let frame = turned(&self.at.frame, angle, toward);
        let origin = center - radius * direction(&frame, toward);
        let along = self.at.along + radius * angle;
        self.at = Section { frame: Frame { origin, ..frame }, along, ..self.at };
        Ok(())
    }

    fn corner(
        &mut self,
        leg: usize,
        angle: f64,
        toward: f64,
        kind: CornerKind,
    ) -> Result<(), SweepProblem> {
        check_azimuth(toward)?;
        if !(angle > 0.0 && angle < PI) {
            return Err(out_of_range("the corner", angle, "more than 0, less than 180"));
        }
        let toward = unit(toward);
        // Over a point q of the section, the halving plane lies at -tan(angle/2) (q · toward) from the crossing of the
        // centre lines, and the mitre plate, at right angles to it, at cot(angle/2) (q · toward).
        let tan = (0.5 * angle).tan();
        let slopes = match kind {
            CornerKind::Plain => vec![-tan],
            CornerKind::Mitred => vec![-tan, 1.0 / tan],
        };
        // From the section through the inner edge to the crossing.
        let to_crossing = tan * self.at.scale * self.profile.reach(toward);
        self.extend(leg, to_crossing);
        self.close(Some((toward, slopes.clone())));
        self.push(leg, self.at, PieceForm::Corner { angle, toward, kind });
        self.at.frame = turned(&self.at.frame, angle, toward);
        // The other side is the mirror image.
        let slopes = slopes.into_iter().map(|slope| -slope).collect();
        let floor = PrismEnd { height: 0.0, toward, slopes };
        self.open = Some(OpenPrism { leg, start: self.at, floor, length: 0.0 });
        self.extend(leg, to_crossing);
        Ok(())
    }

    /// Extends the open prism by `length`; starts one here if there is none.
    fn extend(&mut self, leg: usize, length: f64) -> &mut OpenPrism {
        let start = self.at;
        let prism = self.open.get_or_insert_with(|| OpenPrism {
            leg,
            start,
            floor: PrismEnd::flat(0.0),
            length: 0.0,
        });
        prism.length += length;
        self.at = prism.start.advanced(prism.length);
        prism
    }

    /// Ends the open prism, if any, here: by slanted planes or by the section.
    fn close(&mut self, slanted: Option<(DVec2, Vec<f64>)>) {
        let Some(OpenPrism { leg, start, floor, length }) = self.open.take() else { return };
        let ceiling = match slanted {
            Some((toward, slopes)) => PrismEnd { height: length, toward, slopes },
            None => PrismEnd::flat(length),
        };
        self.push(leg, start, PieceForm::Prism { floor, ceiling });
    }

    fn push(&mut self, leg: usize, start: Section, form: PieceForm) {
        self.pieces.push(PathPiece { leg, start, form });
    }
}

fn positive(what: &'static str, value: f64) -> Result<(), SweepProblem> {
    let usable = value > 0.0 && value <= MAX_LENGTH;
    if usable { Ok(()) } else { Err(SweepProblem::OutOfRange { what, value }) }
}

fn check_azimuth(toward: f64) -> Result<(), SweepProblem> {
    // Far beyond any practical value, where the azimuth would lose its digits.
    let usable = toward.abs() <= 1e3 * TAU;
    if usable { Ok(()) } else { Err(out_of_range("`toward`", toward, "a finite azimuth")) }
}

fn out_of_range(what: &'static str, angle: f64, expected: &'static str) -> SweepProblem {
    SweepProblem::Angle { what, value_deg: angle.to_degrees(), expected }
}
