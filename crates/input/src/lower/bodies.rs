//! Solids and sheets, each built after the one it is placed at.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::spec::SceneSpec;
use crate::spec::placement::PlacementSpec;
use crate::spec::sheet::SheetSpec;
use crate::spec::solid::SolidSpec;
use glam::DVec3;

/// A solid or a sheet with its name.
#[derive(Debug, Clone, Copy)]
enum PlacedBody<'a> {
    Solid(&'a str, &'a SolidSpec),
    Sheet(&'a str, &'a SheetSpec),
}

impl<'a> PlacedBody<'a> {
    fn all(spec: &'a SceneSpec) -> Vec<Self> {
        let solids = spec.solids.iter().map(|(name, solid)| Self::Solid(name, solid));
        let sheets = spec.sheets.iter().map(|(name, sheet)| Self::Sheet(name, sheet));
        solids.chain(sheets).collect()
    }

    fn name(self) -> &'a str {
        match self {
            Self::Solid(name, _) | Self::Sheet(name, _) => name,
        }
    }

    fn key(self) -> Key {
        match self {
            Self::Solid(name, solid) => Key::of(&["solids", name, solid.kind()]),
            Self::Sheet(name, sheet) => Key::of(&["sheets", name, sheet.kind()]),
        }
    }

    fn at(self) -> Option<&'a PlacementSpec> {
        match self {
            Self::Solid(_, solid) => solid.common().at.as_ref(),
            Self::Sheet(_, sheet) => sheet.common().at(),
        }
    }

    /// The name of the body at whose face it is placed.
    fn support(self) -> Option<&'a str> {
        match self.at() {
            Some(PlacementSpec::AtFace(at)) => at.face.split('.').next(),
            Some(PlacementSpec::InSpace(_)) | None => None,
        }
    }
}

/// The middle of the positions in the file: internal coordinates are relative to it, so that a
/// scene far from the user's origin keeps its precision.
pub(super) fn origin(spec: &SceneSpec) -> DVec3 {
    let position = |body: PlacedBody<'_>| match body.at() {
        None => Some(DVec3::ZERO),
        Some(PlacementSpec::InSpace(space)) => Some(DVec3::from(space.position_mm)),
        Some(PlacementSpec::AtFace(_)) => None,
    };
    let free: Vec<DVec3> = PlacedBody::all(spec).into_iter().filter_map(position).collect();
    if free.is_empty() { DVec3::ZERO } else { free.iter().sum::<DVec3>() / free.len() as f64 }
}

impl Context<'_> {
    /// Builds solids and sheets, each after the body it is placed at.
    pub(super) fn lower_bodies(&mut self) {
        let mut waiting = PlacedBody::all(self.spec);
        while !waiting.is_empty() {
            let is_waiting = |name| waiting.iter().any(|other| other.name() == name);
            let (mut ready, mut blocked): (Vec<_>, Vec<_>) = waiting
                .iter()
                .copied()
                .partition(|body: &PlacedBody<'_>| !body.support().is_some_and(is_waiting));
            if ready.is_empty() {
                for body in &blocked {
                    let message = "is placed at a face of an object that is itself placed at one of its faces";
                    let problem = self.problems.error(&body.key().field("at"), message);
                    problem.hint("give one of them a position_mm");
                }
                // What else is wrong with them is reported, too.
                std::mem::swap(&mut ready, &mut blocked);
            }
            for body in ready {
                match body {
                    PlacedBody::Solid(name, solid) => self.lower_solid(name, solid, &body.key()),
                    PlacedBody::Sheet(name, sheet) => self.lower_sheet(name, sheet, &body.key()),
                };
            }
            waiting = blocked;
        }
    }
}
