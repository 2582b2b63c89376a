//! Named surfaces that solids and ducts share: sweeps and reflectors of revolution.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::spec::sweep::{
    CompoundParabolicSpec, CornerSpec, LegSpec, ParaboloidSpec, ProfileSpec, SweepSpec,
};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Frame, planar};
use lumiduct_base::number::format_least_length;
use lumiduct_core::scene::FacePiece;
use lumiduct_core::scene::shape::{CompoundParabola, Flat, Paraboloid, Region, Shape};
use lumiduct_core::scene::sweep::{
    CornerKind, Leg, Profile, ProfileError, SweepError, SweepProblem, Wall, WallPart, sweep,
};

/// A named face of a body under construction.
#[derive(Debug)]
pub(super) struct NamedFace {
    /// Name without the name of the body.
    pub(super) name: String,
    /// Whether it is the wall, or an end that ducts leave open.
    pub(super) part: BodyPart,
    /// Its pieces.
    pub(super) pieces: Vec<FacePiece>,
}

/// Which part of a body a face is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BodyPart {
    /// The wall, or a side of it.
    Wall,
    /// An end: a face of a solid, an open port of a duct.
    End,
}

/// The faces of a body and its volume.
#[derive(Debug)]
pub(super) struct BodySurfaces {
    pub(super) faces: Vec<NamedFace>,
    /// Volume, mm³, where known.
    pub(super) volume: Option<f64>,
}

impl NamedFace {
    pub(super) fn wall(name: &str, shape: Shape) -> Self {
        Self { name: name.to_owned(), part: BodyPart::Wall, pieces: vec![FacePiece::whole(shape)] }
    }

    pub(super) fn end(name: &str, shape: Shape) -> Self {
        Self { name: name.to_owned(), part: BodyPart::End, pieces: vec![FacePiece::whole(shape)] }
    }
}

impl Context<'_> {
    /// The faces of a profile swept along a path.
    pub(super) fn sweep_surfaces(
        &mut self,
        spec: &SweepSpec,
        frame: Frame,
        key: &Key,
    ) -> Option<BodySurfaces> {
        for (index, leg) in spec.path.iter().enumerate() {
            self.check_old_key(leg, &key.field("path").index(index));
        }
        self.may_build(&key.field("path"))?;
        let profile = self.profile(&spec.profile, &key.field("profile"))?;
        let legs: Vec<Leg> = spec.path.iter().map(leg).collect();
        let swept = match sweep(frame, &profile, &legs) {
            Ok(swept) => swept,
            Err(error) => {
                let place = key.field("path");
                let place = error.leg.map_or(place.clone(), |leg| place.index(leg));
                let hint = remedy(&error, &spec.path);
                let problem = self.problems.error(&place, error.to_string());
                if let Some(hint) = hint {
                    problem.hint(hint);
                }
                return None;
            }
        };
        let sides = side_names(&spec.profile);
        let mut faces: Vec<NamedFace> = Vec::new();
        for part in &swept.parts {
            let name = match part.wall {
                Wall::Round => "wall".to_owned(),
                Wall::Edge(side) => {
                    sides.get(side).cloned().unwrap_or_else(|| format!("wall_{}", side + 1))
                }
                Wall::Mitre => "wall_mitre".to_owned(),
            };
            let piece = piece(part.clone());
            match faces.iter_mut().find(|face| face.name == name) {
                Some(face) => face.pieces.push(piece),
                None => faces.push(NamedFace { name, part: BodyPart::Wall, pieces: vec![piece] }),
            }
        }
        let [entry, exit] = &swept.ports;
        faces.push(NamedFace::end("entry", entry.shape.clone()));
        faces.push(NamedFace::end("exit", exit.shape.clone()));
        Some(BodySurfaces { faces, volume: Some(swept.volume) })
    }

    /// Notes the old name of a fold mirror.
    fn check_old_key(&mut self, leg: &LegSpec, key: &Key) {
        let LegSpec::Corner(CornerSpec { fold_mirror, mitred: Some(mitred), .. }) = leg else {
            return;
        };
        let key = key.field("mitred");
        if fold_mirror.is_some() {
            self.problems.error(&key, "repeats what `fold_mirror` says").hint("remove it");
        } else {
            self.problems
                .warning(&key, "is the old name of `fold_mirror`")
                .hint(format!("write fold_mirror = {mitred}, which is equivalent"));
        }
    }

    pub(super) fn profile(&mut self, spec: &ProfileSpec, key: &Key) -> Option<Profile> {
        self.may_build(key)?;
        let profile = profile_of(spec);
        if let Err(error) = &profile {
            self.problems.error(key, error.to_string());
        }
        profile.ok()
    }

    /// Notes two keys of the table at `table` of which the first is not below the second.
    pub(super) fn require_order(
        &mut self,
        table: &Key,
        (small_key, small): (&str, f64),
        (large_key, large): (&str, f64),
    ) -> Option<()> {
        if small >= large {
            let message = format!("{small} is not below `{large_key}`, which is {large}");
            self.problems.error(&table.field(small_key), message);
        }
        (small < large).then_some(())
    }

    /// The faces of a compound parabolic concentrator.
    pub(super) fn compound_parabolic(
        &mut self,
        spec: &CompoundParabolicSpec,
        frame: Frame,
        key: &Key,
    ) -> Option<BodySurfaces> {
        self.may_build(key)?;
        let angle = spec.acceptance_half_angle_deg.to_radians();
        let full = CompoundParabola::full_length(spec.small_radius_mm, angle);
        let length = spec.length_mm.unwrap_or(full);
        if length > full * (1.0 + 1e-12) {
            let message = format!("{length} is longer than the full length, {full:.6} mm");
            let hint = "leave length_mm out for the full length";
            return self.refuse(&key.field("length_mm"), message, hint);
        }
        let wall = CompoundParabola::new(frame, spec.small_radius_mm, angle, length);
        let wide = wall.radius_at(length);
        let faces = vec![
            NamedFace::wall("wall", Shape::CompoundParabola(wall)),
            NamedFace::end("entry", disk_facing(frame, 0.0, spec.small_radius_mm, Ends::Entry)),
            NamedFace::end("exit", disk_facing(frame, length, wide, Ends::Exit)),
        ];
        Some(BodySurfaces { faces, volume: None })
    }

    /// The faces of a paraboloid.
    pub(super) fn paraboloid(
        &mut self,
        spec: &ParaboloidSpec,
        frame: Frame,
        key: &Key,
    ) -> Option<BodySurfaces> {
        let (focal, hole, rim) = (spec.focal_length_mm, spec.hole_radius_mm, spec.radius_mm);
        self.require_order(key, ("hole_radius_mm", hole), ("radius_mm", rim))?;
        let height = |radius: f64| radius * radius / (4.0 * focal);
        let mut faces = vec![
            NamedFace::wall("wall", Shape::Paraboloid(Paraboloid::new(frame, focal, hole, rim))),
            NamedFace::end("exit", disk_facing(frame, height(rim), rim, Ends::Exit)),
        ];
        if hole > 0.0 {
            faces
                .push(NamedFace::end("entry", disk_facing(frame, height(hole), hole, Ends::Entry)));
        }
        // Half of base times height, less the tip that the hole cuts off.
        let volume =
            0.5 * std::f64::consts::PI * (rim * rim * height(rim) - hole * hole * height(hole));
        Some(BodySurfaces { faces, volume: Some(volume) })
    }
}

/// A piece of a face from a part of a sweep.
pub(super) fn piece(part: WallPart) -> FacePiece {
    FacePiece { shape: part.shape, smooth: part.smooth, chart: Some(part.chart), trim: None }
}

/// Which end of a body a disk closes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ends {
    /// At the start; its outward normal is against the axis.
    Entry,
    /// At the end; its outward normal is along the axis.
    Exit,
}

/// A disk normal to the axis at height `z`, facing out of the body.
pub(super) fn disk_facing(frame: Frame, z: f64, radius: f64, end: Ends) -> Shape {
    let frame = frame.shifted(z * frame.z);
    let frame = match end {
        Ends::Exit => frame,
        Ends::Entry => Frame { y: -frame.y, z: -frame.z, ..frame },
    };
    Shape::Flat(Flat::new(frame, Region::Annulus { inner: 0.0, outer: radius }))
}

fn profile_of(spec: &ProfileSpec) -> Result<Profile, ProfileError> {
    match spec {
        ProfileSpec::Circle(circle) => Profile::circle(circle.radius_mm),
        ProfileSpec::Rectangle(r) => Profile::rectangle(r.width_mm, r.height_mm),
        ProfileSpec::RegularPolygon(p) => {
            let half_angle = std::f64::consts::PI / f64::from(p.sides);
            // Validated: one of the two is given.
            let flats = p.across_flats_mm.map(|flats| 0.5 * flats / half_angle.cos());
            let radius = p.radius_mm.or(flats).unwrap_or_default();
            Profile::regular(p.sides as usize, radius, p.rotation_deg.to_radians())
        }
        ProfileSpec::Polygon(polygon) => {
            Profile::polygon(polygon.points_mm.iter().map(|p| DVec2::from(*p)).collect())
        }
    }
}

fn leg(spec: &LegSpec) -> Leg {
    match spec {
        LegSpec::Straight(straight) => {
            Leg::Straight { length: straight.straight_mm, end_scale: straight.end_scale }
        }
        LegSpec::Bend(bend) => Leg::Bend {
            angle: bend.bend_deg.to_radians(),
            radius: bend.radius_mm,
            toward: bend.toward_deg.to_radians(),
        },
        LegSpec::Corner(corner) => Leg::Corner {
            angle: corner.corner_deg.to_radians(),
            toward: corner.toward_deg.to_radians(),
            kind: if corner.has_fold_mirror() { CornerKind::Mitred } else { CornerKind::Plain },
        },
    }
}

/// What to write instead, with the least sufficient length where a length is at fault.
fn remedy(error: &SweepError, path: &[LegSpec]) -> Option<String> {
    let leg = path.get(error.leg?)?;
    match &error.problem {
        SweepProblem::TightBend { reach, .. } => {
            Some(format!("make radius_mm more than {}", format_least_length(*reach)))
        }
        SweepProblem::TooShort { missing } => Some(match leg {
            LegSpec::Straight(straight) => {
                let least = format_least_length(straight.straight_mm + missing);
                format!("make straight_mm at least {least}")
            }
            LegSpec::Bend(_) | LegSpec::Corner(_) => {
                let least = format_least_length(*missing);
                format!("put a straight leg of at least {least} mm between the corners")
            }
        }),
        SweepProblem::Overlap { .. } => Some(
            "make the legs between them longer, or turn to another side with toward_deg".into(),
        ),
        SweepProblem::Profile(_)
        | SweepProblem::NoLegs
        | SweepProblem::OutOfRange { .. }
        | SweepProblem::Angle { .. }
        | SweepProblem::Scaled { .. }
        | SweepProblem::ClosedRing => None,
    }
}

/// Names of the sides of a polygonal wall; empty for a round one.
fn side_names(profile: &ProfileSpec) -> Vec<String> {
    match profile {
        ProfileSpec::Circle(_) => Vec::new(),
        ProfileSpec::Rectangle(_) => {
            ["wall_plus_x", "wall_plus_y", "wall_minus_x", "wall_minus_y"].map(String::from).into()
        }
        ProfileSpec::RegularPolygon(p) => {
            (1..=p.sides).map(|side| format!("wall_{side}")).collect()
        }
        ProfileSpec::Polygon(p) => {
            let points: Vec<DVec2> = p.points_mm.iter().map(|p| DVec2::from(*p)).collect();
            let sides = points.len();
            // Clockwise points are swept in reverse; sides are named in the order of the file.
            let clockwise = planar::signed_area(&points) < 0.0;
            let in_file =
                |side: usize| if clockwise { (2 * sides - 2 - side) % sides } else { side };
            (0..sides).map(|side| format!("wall_{}", in_file(side) + 1)).collect()
        }
    }
}

/// Direction of a tilted axis in a local frame.
pub(super) fn tilted(tilt_deg: f64, azimuth_deg: f64) -> DVec3 {
    let (sin, cos) = tilt_deg.to_radians().sin_cos();
    let (sin_azimuth, cos_azimuth) = azimuth_deg.to_radians().sin_cos();
    DVec3::new(sin * cos_azimuth, sin * sin_azimuth, cos)
}
