//! The kinds of surprises that photons of a scene may meet: of each source, at roulette and at either side of every face.

use crate::optics::Side;
use crate::scene::shape::Toward;
use crate::scene::{Owner, Scene, SourceId};
use crate::transport::tally::CONTROLS;
use crate::transport::{Departure, Vertex};

/// Kinds of surprises, by number.
#[derive(Debug)]
pub(crate) struct Surprises {
    /// Kinds of each source.
    of_source: usize,
    /// For every face, the kind of light that meets its front; that of light that meets its back is the next.
    faces: Vec<usize>,
}

impl Surprises {
    /// Numbers the faces of solids, where most choices are made, before those of sheets. Ports act on no light.
    pub(crate) fn new(scene: &Scene) -> Self {
        let mut kinds = vec![0; scene.faces.len()];
        let is_solid = |face: &usize| matches!(scene.faces[*face].owner, Owner::Solid(_));
        let is_sheet = |face: &usize| scene.faces[*face].owner == Owner::Sheet;
        let faces = 0..scene.faces.len();
        let ranked = faces.clone().filter(is_solid).chain(faces.filter(is_sheet));
        let mut next = 1;
        for face in ranked {
            kinds[face] = next;
            next += 2;
        }
        Self { of_source: next, faces: kinds }
    }

    /// The kind of roulette.
    pub(crate) fn at_roulette(&self, source: SourceId) -> usize {
        (source.index() * self.of_source).min(CONTROLS - 1)
    }

    /// The kind of a choice at a face, and the throughput that it transmits less what was to be expected; `None` where
    /// nothing was chosen.
    #[inline(always)]
    pub(crate) fn at_face(
        &self,
        source: SourceId,
        vertex: &Vertex<'_>,
        departure: &Departure,
    ) -> Option<(usize, f64)> {
        if departure.chance >= 1.0 {
            return None;
        }
        let acting = &vertex.interface.acting;
        let side = match acting.toward {
            Toward::Front => 1,
            Toward::Back => 0,
        };
        let kind = source.index() * self.of_source + self.faces[acting.face.index()] + side;
        let unexpected = vertex.throughput * (1.0 - departure.chance);
        let surprise = match departure.side {
            Side::Reflected => -unexpected,
            Side::Transmitted => unexpected,
        };
        Some((kind.min(CONTROLS - 1), surprise))
    }
}
