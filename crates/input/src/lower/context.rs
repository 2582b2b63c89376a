//! What the parts of the lowering share: the file, the scene built so far, and the names in it.
//! Does not know how anything is lowered.

use crate::keys::{Key, Places};
use crate::lower::weathers::Member;
use crate::problems::{Problems, face_hint};
use crate::spec::SceneSpec;
use indexmap::IndexMap;
use lumiduct_base::digest::Digest;
use lumiduct_core::scene::{Builder, FaceId, FinishId, MediumId};

/// Everything that the parts of the lowering share.
pub(crate) struct Context<'a> {
    pub(crate) spec: &'a SceneSpec,
    pub(crate) places: &'a Places,
    pub(crate) problems: &'a mut Problems,
    pub(crate) builder: Builder,
    pub(super) meshes: Digest,
    pub(super) media: IndexMap<String, MediumId>,
    pub(super) finishes: IndexMap<String, FinishId>,
    /// The back of finishes, as far as it was requested.
    pub(super) behind: IndexMap<FinishId, FinishId>,
    /// Faces by dotted name; a name such as `duct.wall` may refer to several.
    pub(super) faces: IndexMap<String, Vec<FaceId>>,
    /// All sources, by what determines their light group.
    pub(super) members: Vec<Member>,
}

impl Context<'_> {
    /// The faces of a dotted name, or an error with the closest known names.
    pub(super) fn faces_named(&mut self, name: &str, key: &Key) -> Option<Vec<FaceId>> {
        if let Some(faces) = self.faces.get(name) {
            return Some(faces.clone());
        }
        // A body that could not be built has been reported and has no faces.
        let owner = name.split('.').next().unwrap_or_default();
        let is_due = self.spec.solids.contains_key(owner) || self.spec.sheets.contains_key(owner);
        let has_faces = self.faces.keys().any(|face| face.split('.').next() == Some(owner));
        if is_due && !has_faces && !self.problems.is_free_of_errors() {
            return None;
        }
        let all = self.faces.keys().map(String::as_str);
        // For a known body its own faces, for an unknown one all faces.
        let known: Vec<&str> =
            all.filter(|face| !has_faces || face.split('.').next() == Some(owner)).collect();
        let hint = face_hint(name, known.iter().copied());
        self.problems.error(key, format!("unknown face `{name}`")).hint(hint);
        None
    }
}
