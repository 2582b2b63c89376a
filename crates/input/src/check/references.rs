//! References to media and finishes: they exist, and no finish contains itself.

use indexmap::{IndexMap, IndexSet};

use crate::check::scene::Scene;
use crate::keys::Key;
use crate::problems::{Problems, name_hint};
use crate::spec::finish::{FinishRef, FinishSpec};
use crate::spec::sheet::SheetCommon;
use crate::spec::source::BodySpec;
use crate::spec::{PREDEFINED_FINISHES, PREDEFINED_MEDIA};
use crate::tree::Node;

pub(crate) fn check(scene: Scene<'_>, problems: &mut Problems) {
    let media = known(scene, "media", &PREDEFINED_MEDIA);
    let mut require_medium = |key: Key, name: &str| {
        if !media.contains(name) {
            unknown(&key, "medium", name, &media, problems);
        }
    };
    require_medium(Key::of(&["surroundings"]), &scene.spec.surroundings);
    for (name, solid) in &scene.spec.solids {
        require_medium(Key::of(&["solids", name, solid.kind(), "medium"]), &solid.common().medium);
    }
    let finishes = known(scene, "finishes", &PREDEFINED_FINISHES);
    for (key, finish) in finish_refs(scene) {
        if let FinishRef::Name(name) = finish
            && !finishes.contains(name.as_str())
        {
            unknown(&key, "finish", name, &finishes, problems);
        }
    }
    check_loops(scene, problems);
}

/// Names in a table of the file, and the predefined ones. A medium or finish with an error counts
/// as known, too.
fn known<'a>(scene: Scene<'a>, family: &str, predefined: &[&'a str]) -> IndexSet<&'a str> {
    let table = scene.places.root().get(family).and_then(Node::table);
    table
        .into_iter()
        .flatten()
        .map(|(name, _)| name.as_str())
        .chain(predefined.iter().copied())
        .collect()
}

fn unknown(key: &Key, what: &str, name: &str, known: &IndexSet<&str>, problems: &mut Problems) {
    let message = format!("unknown {what} `{}`", name.escape_debug());
    problems.error(key, message).hint(name_hint(name, known.iter().copied()));
}

/// All finishes that the scene uses, with those inside mixtures.
pub(crate) fn finish_refs(scene: Scene<'_>) -> Vec<(Key, &FinishRef)> {
    let mut found = Vec::new();
    for (name, finish) in &scene.spec.finishes {
        mixture_refs(&Key::of(&["finishes", name]), finish, &mut found);
    }
    for (name, solid) in &scene.spec.solids {
        let key = Key::of(&["solids", name, solid.kind()]);
        face_refs(&key, &solid.common().faces, &mut found);
    }
    for (name, sheet) in &scene.spec.sheets {
        let key = Key::of(&["sheets", name, sheet.kind()]);
        match sheet.common() {
            SheetCommon::Sheet(common) => {
                add_ref(key.field("finish"), &common.finish, &mut found);
                if let Some(back) = &common.back {
                    add_ref(key.field("back"), back, &mut found);
                }
            }
            SheetCommon::Duct(common) => {
                add_ref(key.field("finish"), &common.finish, &mut found);
                if let Some(outer) = &common.outer {
                    add_ref(key.field("outer"), outer, &mut found);
                }
                face_refs(&key, &common.faces, &mut found);
            }
        }
    }
    for (name, pattern) in &scene.spec.patterns {
        let key = Key::of(&["patterns", name]);
        add_ref(key.field("finish"), &pattern.finish, &mut found);
    }
    for (name, relief) in &scene.spec.reliefs {
        if let Some(finish) = &relief.finish {
            add_ref(Key::of(&["reliefs", name, "finish"]), finish, &mut found);
        }
    }
    for (name, source) in &scene.spec.sources {
        let Some(common) = source.common() else { continue };
        match &common.body {
            BodySpec::Finish(finish) => {
                add_ref(Key::of(&["sources", name, source.kind(), "body"]), finish, &mut found);
            }
            BodySpec::Transparent | BodySpec::Absorbing => {}
        }
    }
    found
}

fn face_refs<'a>(
    key: &Key,
    faces: &'a IndexMap<String, FinishRef>,
    found: &mut Vec<(Key, &'a FinishRef)>,
) {
    for (face, finish) in faces {
        add_ref(key.field("faces").field(face), finish, found);
    }
}

fn add_ref<'a>(key: Key, finish: &'a FinishRef, found: &mut Vec<(Key, &'a FinishRef)>) {
    if let FinishRef::Inline(inline) = finish {
        mixture_refs(&key, inline, found);
    }
    found.push((key, finish));
}

fn mixture_refs<'a>(key: &Key, finish: &'a FinishSpec, found: &mut Vec<(Key, &'a FinishRef)>) {
    for (i, part) in parts(finish).iter().enumerate() {
        add_ref(key.field("mixture").index(i).field("finish"), &part.finish, found);
    }
}

fn parts(finish: &FinishSpec) -> &[crate::spec::finish::MixturePartSpec] {
    match finish {
        FinishSpec::Mixture(parts) => parts,
        FinishSpec::Smooth(_)
        | FinishSpec::Specular(_)
        | FinishSpec::Metal(_)
        | FinishSpec::Absorber(_)
        | FinishSpec::Open(_)
        | FinishSpec::PrismFilm(_)
        | FinishSpec::Ggx(_)
        | FinishSpec::Abg(_)
        | FinishSpec::Harvey(_)
        | FinishSpec::Tabulated(_)
        | FinishSpec::Coated(_)
        | FinishSpec::Lambertian(_)
        | FinishSpec::Gaussian(_) => &[],
    }
}

/// Finds mixtures that contain themselves: the rest after repeatedly removing finishes that use no
/// unresolved one.
fn check_loops(scene: Scene<'_>, problems: &mut Problems) {
    let finishes = &scene.spec.finishes;
    let mut users: IndexMap<&str, Vec<&str>> = IndexMap::new();
    let mut open: IndexMap<&str, usize> = IndexMap::new();
    for (name, finish) in finishes {
        let mut refs = Vec::new();
        mixture_refs(&Key::root(), finish, &mut refs);
        let used = refs.iter().filter_map(|(_, finish)| match finish {
            FinishRef::Name(used) => finishes.get_key_value(used).map(|(used, _)| used.as_str()),
            FinishRef::Inline(_) => None,
        });
        let used: IndexSet<_> = used.collect();
        open.insert(name, used.len());
        used.into_iter().for_each(|used| users.entry(used).or_default().push(name));
    }
    let mut resolved: Vec<_> =
        open.iter().filter(|(_, uses)| **uses == 0).map(|(name, _)| *name).collect();
    while let Some(name) = resolved.pop() {
        open.swap_remove(name);
        for user in users.get(name).into_iter().flatten() {
            if let Some(uses) = open.get_mut(user) {
                *uses -= 1;
                if *uses == 0 {
                    resolved.push(user);
                }
            }
        }
    }
    for name in finishes.keys().filter(|name| open.contains_key(name.as_str())) {
        problems.error(
            &Key::of(&["finishes", name]),
            "this mixture contains itself, or another one that does",
        );
    }
}
