//! Straight tubes with a solid wall.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::surfaces::{BodyPart, BodySurfaces, NamedFace, piece};
use crate::spec::solid::{TubeOuterSpec, TubeSolidSpec};
use lumiduct_base::math::{Frame, planar};
use lumiduct_core::scene::shape::{Flat, Region, Shape};
use lumiduct_core::scene::sweep::{
    Leg, OutlineError, PrismNumber, Prisms, Profile, Sweep, SweepError, WallPart, sweep,
};

impl Context<'_> {
    /// The faces of a tube: a bore, an outside, and two ends with a hole.
    pub(super) fn tube_surfaces(
        &mut self,
        spec: &TubeSolidSpec,
        frame: Frame,
        key: &Key,
    ) -> Option<BodySurfaces> {
        self.may_build(&key.field("outer"))?;
        let inner = self.profile(&spec.inner, &key.field("inner"))?;
        let outer = match outline(&inner, &spec.outer) {
            Ok(outer) => outer,
            Err(error) => {
                self.problems.error(&key.field("outer"), error.to_string());
                return None;
            }
        };
        if let Some(beyond) = reach_into_bore(&inner, &outer) {
            let message = format!("the facets of the prisms reach {beyond:.4} mm into the bore");
            let hint = "make base_mm larger, prism_angle_deg smaller or the prisms more";
            return self.refuse(&key.field("outer"), message, hint);
        }
        let swept = |profile| straight(frame, profile, spec.length_mm);
        match (swept(&inner), swept(&outer)) {
            (Ok(inner), Ok(outer)) => tube(&inner, &outer),
            (Err(error), _) | (_, Err(error)) => {
                self.problems.error(key, error.to_string());
                None
            }
        }
    }
}

fn straight(frame: Frame, profile: &Profile, length: f64) -> Result<Sweep, SweepError> {
    sweep(frame, profile, &[Leg::Straight { length, end_scale: 1.0 }])
}

/// How far edges of the outside cut into a round bore, mm; on flat sides prisms lie on the wall.
fn reach_into_bore(inner: &Profile, outer: &Profile) -> Option<f64> {
    let (Profile::Circle { radius }, Profile::Polygon { points }) = (inner, outer) else {
        return None;
    };
    let nearest = planar::edges(points)
        .map(|(from, to)| {
            let edge = to - from;
            let share = (-from.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
            (from + share * edge).length()
        })
        .fold(f64::INFINITY, f64::min);
    (nearest <= *radius).then_some(radius - nearest)
}

fn outline(inner: &Profile, outer: &TubeOuterSpec) -> Result<Profile, OutlineError> {
    match outer {
        TubeOuterSpec::WallMm(wall) => inner.grown(*wall),
        TubeOuterSpec::Prisms(prisms) => {
            // Validated: one of the two is given.
            let pitch = PrismNumber::Pitch(prisms.pitch_mm.unwrap_or_default());
            let number = prisms.count.map_or(pitch, |count| PrismNumber::Count(count as usize));
            let angle = prisms.prism_angle_deg.to_radians();
            inner.grown(prisms.base_mm)?.with_prisms(&Prisms { number, angle })
        }
    }
}

/// `None` where a wall is not that of a straight leg, which does not happen here.
fn tube(inner: &Sweep, outer: &Sweep) -> Option<BodySurfaces> {
    let bore: Option<Vec<WallPart>> = inner.parts.iter().map(WallPart::turned).collect();
    let wall = |name: &str, parts: Vec<WallPart>| NamedFace {
        name: name.to_owned(),
        part: BodyPart::Wall,
        pieces: parts.into_iter().map(piece).collect(),
    };
    let mut faces = vec![wall("inner", bore?), wall("outer", outer.parts.clone())];
    for (name, end) in [("entry", 0), ("exit", 1)] {
        let (Shape::Flat(outline), Shape::Flat(hole)) =
            (&outer.ports[end].shape, &inner.ports[end].shape)
        else {
            return None;
        };
        let region = Region::holed(outline.region().clone(), hole.region().clone());
        faces.push(NamedFace::end(name, Shape::Flat(Flat::new(*outline.frame(), region))));
    }
    Some(BodySurfaces { faces, volume: Some(outer.volume - inner.volume) })
}
