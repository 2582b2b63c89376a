//! Rules of media.

use crate::check::scene::Scene;
use crate::keys::Key;
use crate::problems::Problems;

pub(super) fn check(scene: Scene<'_>, problems: &mut Problems) {
    let surroundings = &scene.spec.surroundings;
    let medium = scene.spec.media.get(surroundings);
    if medium.is_some_and(|medium| medium.scattering.is_some()) {
        problems
            .error(
                &Key::of(&["surroundings"]),
                format!("`{surroundings}` scatters: light would never leave the scene"),
            )
            .hint("put a solid of this medium around the scene");
    }
}
