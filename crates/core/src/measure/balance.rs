//! The flux balance: where all the light went.
//!
//! Every line is counted separately and none is adjusted, so the remainder, the residual, shows
//! whether the bookkeeping lost any light. Virtual sensors let light pass and have no line here.

use crate::measure::evidence::Evidence;
use crate::measure::{Measure, Replicates};
use crate::scene::{FaceId, MediumId, Owner, Scene, SourceId};
use crate::transport::Readings;
use indexmap::IndexMap;
use serde::Serialize;

/// Where the light went, lm or W. The lines sum to the emitted flux, without heat.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Balance {
    /// Flux that started, all sources together.
    pub emitted: Measure,
    /// The same for each source.
    pub emitted_by_source: IndexMap<String, Measure>,
    /// Flux absorbed at each face of a solid or a sheet.
    pub absorbed: IndexMap<String, Measure>,
    /// Flux absorbed in each medium.
    pub absorbed_medium: IndexMap<String, Measure>,
    /// Flux that fluorescence in each medium absorbed, less what it emitted, lm: negative where light that the eye sees better
    /// was emitted. Only media that fluoresce.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub converted: IndexMap<String, Measure>,
    /// Radiant flux that fluorescence turned to heat in each of these media, W, without what the media absorb themselves; not a
    /// line of the balance of luminous flux.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub heat: IndexMap<String, Measure>,
    /// Flux that left the scene, by the face of a solid through which it was last transmitted.
    pub escaped: IndexMap<String, Measure>,
    /// Flux that left the scene without ever having left a solid.
    pub escaped_directly: Measure,
    /// Flux cut by the bounce limit.
    pub cut: Measure,
    /// Flux removed by roulette, less the gain of its survivors: zero apart from noise.
    pub roulette: Measure,
    /// Flux lost through holes in the geometry.
    pub leaked: Measure,
    /// Emitted flux less all other lines: only rounding.
    pub residual: Measure,
}

/// Computes the balance.
pub(crate) fn balance(evidence: &Evidence<'_>) -> Balance {
    let (scene, layout) = (evidence.scene, evidence.layout);
    let line = |slot: usize| evidence.entry(|flux| flux(slot));
    let sources = 0..scene.sources.len();
    let emitted = |flux: &dyn Fn(usize) -> f64| -> f64 {
        sources.clone().map(|source| flux(layout.emitted(SourceId::new(source)))).sum()
    };
    let spent = spent(evidence);
    let faces = |slot: &dyn Fn(FaceId) -> usize, counts: fn(Owner) -> bool| {
        let faces = scene.faces.iter().enumerate().filter(|(_, face)| counts(face.owner));
        faces.map(|(index, face)| (face.name.clone(), line(slot(FaceId::new(index))))).collect()
    };
    let converting = |measure: &dyn Fn(MediumId) -> Measure| {
        let media = scene.media.iter().enumerate();
        let media = media.filter(|(_, medium)| medium.fluorescence().is_some());
        media
            .map(|(index, medium)| (medium.name().to_owned(), measure(MediumId::new(index))))
            .collect()
    };
    Balance {
        converted: converting(&|medium| line(layout.converted(medium))),
        heat: converting(&|medium| {
            let heat = evidence.entry(|flux| flux(layout.heat(medium)));
            Measure { unit: "W".into(), ..heat }
        }),
        emitted: evidence.entry(emitted),
        emitted_by_source: sources
            .clone()
            .map(|source| {
                let name = scene.sources[source].name.clone();
                (name, line(layout.emitted(SourceId::new(source))))
            })
            .collect(),
        absorbed: faces(&|face| layout.absorbed_by_face(face), is_material),
        absorbed_medium: scene
            .media
            .iter()
            .enumerate()
            .map(|(index, medium)| {
                let slot = layout.absorbed_in_medium(MediumId::new(index));
                (medium.name().to_owned(), line(slot))
            })
            .collect(),
        escaped: faces(&|face| layout.escaped(Some(face)), is_of_a_solid),
        escaped_directly: line(layout.escaped(None)),
        cut: line(layout.cut()),
        roulette: line(layout.roulette()),
        leaked: line(layout.leaked()),
        residual: evidence
            .entry(|flux| emitted(flux) - spent.iter().map(|&slot| flux(slot)).sum::<f64>()),
    }
}

impl Balance {
    /// All lines by their dotted names.
    pub(crate) fn measures(&self) -> IndexMap<String, Measure> {
        let mut out = IndexMap::new();
        let mut add = |name: String, measure: &Measure| {
            out.insert(format!("balance.{name}"), measure.clone());
        };
        add("emitted".into(), &self.emitted);
        if self.emitted_by_source.len() > 1 {
            self.emitted_by_source.iter().for_each(|(name, m)| add(format!("emitted.{name}"), m));
        }
        self.absorbed.iter().for_each(|(name, m)| add(format!("absorbed.{name}"), m));
        self.absorbed_medium.iter().for_each(|(name, m)| add(format!("absorbed_medium.{name}"), m));
        self.converted.iter().for_each(|(name, m)| add(format!("converted.{name}"), m));
        self.heat.iter().for_each(|(name, m)| add(format!("heat.{name}"), m));
        self.escaped.iter().for_each(|(name, m)| add(format!("escaped.{name}"), m));
        add("escaped_directly".into(), &self.escaped_directly);
        add("cut".into(), &self.cut);
        add("roulette".into(), &self.roulette);
        add("leaked".into(), &self.leaked);
        add("residual".into(), &self.residual);
        out
    }
}

/// Values of a line in single groups of batches, by its full name.
pub(crate) fn replicates(scene: &Scene, photons: &Readings, name: &str) -> Option<Replicates> {
    let value = |photons: &Readings| {
        let line = balance(&Evidence::new(scene, photons)).measures().swap_remove(name)?;
        Some(line.value)
    };
    let without = photons
        .groups
        .iter()
        .map(|group| Some((group.group, value(&photons.without_group(group.group))?)));
    Some(Replicates::new(value(photons)?, &without.collect::<Option<Vec<_>>>()?))
}

/// The scalars of every possible fate of emitted light.
fn spent(evidence: &Evidence<'_>) -> Vec<usize> {
    let (scene, layout) = (evidence.scene, evidence.layout);
    let faces = || (0..scene.faces.len()).map(FaceId::new);
    let mut slots: Vec<usize> = faces().map(|face| layout.absorbed_by_face(face)).collect();
    slots.extend((0..scene.media.len()).map(|m| layout.absorbed_in_medium(MediumId::new(m))));
    if scene.fluoresces() {
        slots.extend((0..scene.media.len()).map(|m| layout.converted(MediumId::new(m))));
    }
    slots.extend(faces().map(|face| layout.escaped(Some(face))));
    slots.extend([layout.escaped(None), layout.cut(), layout.roulette(), layout.leaked()]);
    slots
}

fn is_material(owner: Owner) -> bool {
    match owner {
        Owner::Solid(_) | Owner::Sheet => true,
        Owner::Port => false,
    }
}

fn is_of_a_solid(owner: Owner) -> bool {
    match owner {
        Owner::Solid(_) => true,
        Owner::Sheet | Owner::Port => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::measure;
    use crate::measure::samples::{add, readings, scene};

    #[test]
    fn every_line_is_found_and_what_is_missing_is_the_residual() {
        let scene = scene(&[("led", 3.0), ("lamp", 1.0)], Vec::new());
        let readings = readings(&scene, 128, |_, layout, batch| {
            add(batch, layout.emitted(SourceId::new(0)), 3.0);
            add(batch, layout.emitted(SourceId::new(1)), 1.0);
            add(batch, layout.absorbed_by_face(FaceId::new(0)), 0.5);
            add(batch, layout.absorbed_in_medium(MediumId::new(0)), 0.25);
            add(batch, layout.escaped(None), 2.0);
            add(batch, layout.cut(), 0.125);
            add(batch, layout.roulette(), -0.0625);
            add(batch, layout.leaked(), 0.03125);
        });
        let measures = measure(&scene, &readings);
        let value = |name: &str| measures.values[&format!("balance.{name}")].value;
        assert_eq!((value("emitted"), value("emitted.lamp")), (4.0, 1.0));
        assert_eq!(value("absorbed.wall.surface"), 0.5);
        assert_eq!(value("absorbed_medium.air"), 0.25);
        assert_eq!(value("escaped_directly"), 2.0);
        assert_eq!((value("cut"), value("roulette"), value("leaked")), (0.125, -0.0625, 0.03125));
        assert_eq!(value("residual"), 4.0 - 2.84375);
        // The wall is not a solid that light could leave.
        assert!(measures.balance.escaped.is_empty());
    }

    #[test]
    fn a_line_with_nothing_on_it_is_known_exactly() {
        let scene = scene(&[("led", 1.0)], Vec::new());
        let measures = measure(&scene, &readings(&scene, 128, |_, _, _| {}));
        let leaked = &measures.balance.leaked;
        assert_eq!((leaked.value, leaked.std_error), (0.0, 0.0));
        assert_eq!(leaked.status, crate::measure::Status::Ok);
    }
}
