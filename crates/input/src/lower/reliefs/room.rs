//! Whether the elements of a relief fit into their solid, and which other walls they cut.

use crate::keys::Key;
use crate::lower::context::Context;
use glam::{DVec2, DVec3};
use lumiduct_core::scene::relief::{Relief, ReliefWall, Site, Way, WedgeSpan};
use lumiduct_core::scene::shape::{RayStart, Shape};
use lumiduct_core::scene::{Owner, Patch, Ray, Scene};

/// Normals that differ by less are equal up to rounding, 1. Lengths likewise, as a share of the
/// width of the wall.
const ROUNDING: f64 = 1e-9;
/// The outline of an element is tested this share inside, so that it is not on the edge of the
/// wall.
const INSET: f64 = 1e-6;

impl Context<'_> {
    /// The patches of the solid in which grooves from side to side end, with their walls; none for
    /// other elements.
    pub(super) fn sides(&mut self, relief: &Relief, key: &Key) -> Option<Vec<(usize, ReliefWall)>> {
        let (Some(WedgeSpan::Through(width)), Way::Into, None) =
            (relief.element.span(), relief.element.way, relief.element.round)
        else {
            return Some(Vec::new());
        };
        let scene = self.builder.scene();
        let walls: Vec<(usize, &Patch)> = walls_of(scene, scene.owner(relief.wall)).collect();
        let mut sides: Vec<(usize, ReliefWall)> = Vec::new();
        for (place, middle) in relief.field.places() {
            let site = relief.ground.site(middle);
            for side in [-1.0, 1.0] {
                let (along, depth) = (relief.element.edge(place), relief.element.height(place));
                let end = site.at(0.5 * side * width, along, -depth);
                let Some(found) = side_at(&walls, end, side * site.across, width) else {
                    let message = "goes from side to side, but does not end in flat sides at right angles to its wall";
                    return self.refuse(key, message, "give it a length_mm, or make it less deep");
                };
                if sides.iter().all(|(index, _)| *index != found) {
                    sides.extend(
                        ReliefWall::of(&scene.patches[found]).map(|ground| (found, ground)),
                    );
                }
            }
        }
        Some(sides)
    }

    /// Whether the elements cut neither another wall nor its elements.
    pub(super) fn has_room(&mut self, relief: &Relief, on: &str, key: &Key) -> Option<()> {
        let scene = self.builder.scene();
        if relief.ground.is_flat()
            && let Some((along, room)) = first_without_room(scene, relief)
        {
            let start = scene.face_rect(relief.wall).map_or(0.0, |rect| rect.min.y);
            let (height, beyond) = match relief.element.way {
                Way::Into => ("depth", "the solid goes on"),
                Way::OutOf => ("height", "there is room"),
            };
            let message = format!(
                "{:.4} mm along `{on}` its {height} is {:.4} mm, and {beyond} for {room:.4} mm",
                along - start,
                relief.element.height(along)
            );
            return self.refuse(&key.field("element"), message, "make it smaller");
        }
        let owner = scene.owner(relief.wall);
        let others = scene.reliefs.iter().filter(|other| {
            other.wall != relief.wall && scene.owner(other.wall) == owner && other.ground.is_flat()
        });
        let mut met = others.filter(|other| relief.ground.is_flat() && boxes_meet(relief, other));
        if let Some(other) = met.next() {
            let message = format!("may cut into the elements of `{}` on another wall", other.name);
            return self.refuse(key, message, "leave elements out near the common edge");
        }
        Some(())
    }
}

/// The patches of a solid except those of its reliefs, with their numbers.
fn walls_of(scene: &Scene, owner: Owner) -> impl Iterator<Item = (usize, &Patch)> {
    let patches = scene.patches.iter().enumerate();
    patches.filter(move |(_, patch)| patch.owner == owner && !is_of_relief(scene, patch))
}

/// Whether a patch belongs to a face made by a relief.
fn is_of_relief(scene: &Scene, patch: &Patch) -> bool {
    let name = &scene.faces[patch.face.index()].name;
    scene.reliefs.iter().any(|relief| relief.name == *name)
}

/// The flat side of a solid with this outward normal that contains a point.
fn side_at(walls: &[(usize, &Patch)], point: DVec3, outward: DVec3, width: f64) -> Option<usize> {
    let ray = Ray::new(point - width * outward, outward);
    let found = walls.iter().find(|(_, patch)| {
        let Shape::Flat(flat) = &patch.shape else { return false };
        let mut holds = false;
        patch.shape.crossings(&ray, RayStart::Elsewhere, |crossing| {
            holds |= (crossing.t / width - 1.0).abs() < ROUNDING;
        });
        holds && flat.frame().z.distance(outward) < ROUNDING
    });
    found.map(|(index, _)| *index)
}

/// The first row with an element that has less room than its height, and that room, mm.
fn first_without_room(scene: &Scene, relief: &Relief) -> Option<(f64, f64)> {
    let walls: Vec<(usize, &Patch)> = walls_of(scene, scene.owner(relief.wall)).collect();
    relief.field.places().find_map(|(place, middle)| {
        let half = 0.5 * relief.element.size(place) * (1.0 - INSET);
        let corners = [(0.0, 0.0), (-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let rooms = corners.map(|corner| {
            let site = relief.ground.site(middle + half * DVec2::from(corner));
            room_at(scene, relief, &walls, &site)
        });
        let room = rooms.into_iter().fold(f64::INFINITY, f64::min);
        (relief.element.height(place) >= room).then_some((place, room))
    })
}

/// Distance from a point of a wall to the next wall of the same solid, or to the elements sunk into
/// it, mm.
fn room_at(scene: &Scene, relief: &Relief, walls: &[(usize, &Patch)], site: &Site) -> f64 {
    let dir = relief.element.way.sign() * site.out;
    let ray = Ray::new(site.origin, dir);
    let mut room = f64::INFINITY;
    for (_, wall) in walls.iter().filter(|(_, wall)| wall.face != relief.wall) {
        wall.shape.crossings(&ray, RayStart::Elsewhere, |crossing| {
            let sunk = scene
                .reliefs
                .iter()
                .filter(|other| other.wall == wall.face && other.element.way == Way::Into);
            let taken = sunk.map(|other| other.height()).fold(0.0, f64::max);
            if crossing.t > 0.0 {
                room = room.min(crossing.t - taken);
            }
        });
    }
    room
}

/// Whether the boxes around the elements of two flat walls of one solid overlap, in the axes of the
/// first.
fn boxes_meet(one: &Relief, other: &Relief) -> bool {
    let [min, max] = one.extent();
    let [from, to] = other.extent();
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for corner in 0..8 {
        let pick = |axis: usize| if corner >> axis & 1 == 0 { from[axis] } else { to[axis] };
        let site = other.ground.site(DVec2::new(pick(0), pick(1)));
        let local = one.ground.unroll(site.at(0.0, 0.0, pick(2)));
        (low, high) = (low.min(local), high.max(local));
    }
    low.cmplt(max).all() && high.cmpgt(min).all()
}
