//! The state that the files of `lower` share: the spec of the scene file, the scene built so far, the names
//! in both, and whether geometry is to be made. This module does not know how anything is lowered.

use crate::export::Exports;
use crate::keys::{Key, Places};
use crate::lower::weathers::Member;
use crate::problems::{Problems, face_hint, name_hint};
use crate::spec::SceneSpec;
use crate::tree::Node;
use glam::DVec3;
use indexmap::{IndexMap, IndexSet};
use lumiduct_base::digest::Digest;
use lumiduct_base::math::Frame;
use lumiduct_core::colour::SpectralDraw;
use lumiduct_core::optics::Finish;
use lumiduct_core::scene::{Builder, FaceId, FinishId, MediumId};
use std::sync::Arc;

/// How far to go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scope {
    /// Keys and names only: no geometry, and no file besides those that were read.
    Keys,
    /// The whole scene.
    Scene,
}

/// Where a finish has values by wavelength, nm.
#[derive(Debug)]
pub(super) struct FinishTable {
    pub(super) key: Key,
    pub(super) range: [f64; 2],
    /// The wavelength at which it acts on all light, nm; `None` for that of each path.
    pub(super) wavelength: Option<f64>,
}

/// Everything that the topics share.
pub(super) struct Context<'a> {
    pub(super) spec: &'a SceneSpec,
    pub(super) places: &'a Places,
    pub(super) problems: &'a mut Problems,
    pub(super) scope: Scope,
    pub(super) builder: Builder,
    pub(super) meshes: Digest,
    pub(super) media: IndexMap<String, MediumId>,
    pub(super) finishes: IndexMap<String, FinishId>,
    /// The named finishes that were looked at so far; `None` for one with a problem.
    pub(super) named_finishes: IndexMap<String, Option<Finish>>,
    /// The back of finishes, as far as it was requested.
    pub(super) behind: IndexMap<FinishId, FinishId>,
    /// Tables by wavelength of finishes.
    pub(super) finish_tables: Vec<FinishTable>,
    /// Faces by dotted name; a name such as `duct.wall` may refer to several.
    pub(super) faces: IndexMap<String, Vec<FaceId>>,
    /// The spectrum of the source that is lowered.
    pub(super) spectrum: Option<Arc<SpectralDraw>>,
    /// All sources, by what determines their light group.
    pub(super) members: Vec<Member>,
    /// Luminaire files that goniometers are to write.
    pub(super) exports: Exports,
}

impl<'a> Context<'a> {
    pub(super) fn new(
        spec: &'a SceneSpec,
        places: &'a Places,
        scope: Scope,
        builder: Builder,
        problems: &'a mut Problems,
    ) -> Self {
        Self {
            spec,
            places,
            problems,
            scope,
            builder,
            meshes: Digest::default(),
            media: IndexMap::from([(crate::spec::AIR.to_owned(), MediumId::new(0))]),
            finishes: IndexMap::new(),
            named_finishes: IndexMap::new(),
            behind: IndexMap::new(),
            finish_tables: Vec::new(),
            faces: IndexMap::new(),
            spectrum: None,
            members: Vec::new(),
            exports: Exports::default(),
        }
    }

    /// Notes an error with a hint; nothing is made.
    pub(super) fn refuse<T>(
        &mut self,
        key: &Key,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> Option<T> {
        self.problems.error(key, message).hint(hint);
        None
    }

    /// Whether geometry is to be made from the table at `key`. It is not if a key in it has an error, since
    /// the geometry would cause further errors.
    pub(super) fn may_build(&self, key: &Key) -> Option<()> {
        (self.scope == Scope::Scene && self.problems.is_whole(key)).then_some(())
    }

    /// Names in a table of the file. An entry with an error, which has no spec, counts as well.
    pub(super) fn names(&self, family: &str) -> IndexSet<&'a str> {
        let table = self.places.root().get(family).and_then(Node::table);
        table.into_iter().flatten().map(|(name, _)| name.as_str()).collect()
    }

    /// Notes a name that is neither in a table of the file nor predefined.
    pub(super) fn require_known(
        &mut self,
        [what, family]: [&str; 2],
        name: &str,
        predefined: &[&str],
        key: &Key,
    ) {
        let known: Vec<&str> =
            self.names(family).into_iter().chain(predefined.iter().copied()).collect();
        if !known.contains(&name) {
            let message = format!("unknown {what} `{}`", name.escape_debug());
            let hint = name_hint(name, known.iter().copied());
            self.problems.certain_error(key, message).hint(hint);
        }
    }

    /// The faces of a dotted name, or an error with the closest known names.
    pub(super) fn faces_named(&mut self, name: &str, key: &Key) -> Option<Vec<FaceId>> {
        if self.scope == Scope::Keys {
            return None;
        }
        if let Some(faces) = self.faces.get(name) {
            return Some(faces.clone());
        }
        // What could not be built has been reported and has no faces.
        let owner = name.split('.').next().unwrap_or_default();
        let has_faces = self.faces.keys().any(|face| face.split('.').next() == Some(owner));
        if self.is_unfinished(name, has_faces) {
            return None;
        }
        let all = self.faces.keys().map(String::as_str);
        // For a known body its own faces, for an unknown one all faces.
        let known: Vec<&str> =
            all.filter(|face| !has_faces || face.split('.').next() == Some(owner)).collect();
        let hint = face_hint(name, known.iter().copied());
        self.refuse(key, format!("unknown face `{name}`"), hint)
    }

    /// Whether a face may be missing only because of a problem that is reported: of its body, or of
    /// the relief that makes it.
    fn is_unfinished(&self, face: &str, has_faces: bool) -> bool {
        let (body, own) = face.split_once('.').unwrap_or((face, ""));
        let is_due = |family: &str, name: &str| self.places.has(&Key::of(&[family, name]));
        let is_body = ["solids", "sheets", "sources"].iter().any(|family| is_due(family, body));
        !self.problems.is_free_of_errors() && is_body && (!has_faces || is_due("reliefs", own))
    }

    /// East, north and up as x, y and z; `None` where they are not valid.
    pub(super) fn sky_frame(&self) -> Option<Frame> {
        let [up, north] = [self.spec.up, self.spec.north].map(DVec3::from);
        up.try_normalize().and(north.try_normalize())?;
        // The second axis of this frame points west.
        let Frame { x: north, y: west, z: up, .. } =
            Frame::from_axis_and_x(DVec3::ZERO, up, north)?;
        Some(Frame { origin: DVec3::ZERO, x: -west, y: north, z: up })
    }
}
