//! Flat walls that form a straight prism over a convex polygon.

use crate::scene::find_legs::duct::{FlatWall, SAME};
use crate::scene::plain_leg::{LegSection, LegSide, MOST_SIDES};
use crate::scene::{PlainLeg, PrimId, Scene};
use glam::{DVec2, DVec3};
use lumiduct_base::math::Frame;
use smallvec::SmallVec;

/// A wall as a side of the polygon across the axis.
#[derive(Debug, Clone, Copy)]
struct PrismSide {
    wall: FlatWall,
    ends: [DVec2; 2],
    normal: DVec2,
}

/// The longest prism that a wall is part of.
pub(super) fn within(scene: &Scene, prim: PrimId) -> Option<PlainLeg> {
    let patch = &scene.patches[prim.index()];
    let wall = FlatWall::of(prim, patch)?;
    let walls = FlatWall::all_of(scene, patch.owner);
    let length = |leg: &PlainLeg| leg.spans[0][1] - leg.spans[0][0];
    let legs = wall.sides.iter().filter_map(|side| along(*side, &wall, &walls));
    legs.max_by(|a, b| length(a).total_cmp(&length(b)))
}

/// The prism whose axis is parallel to half of a side of a wall.
fn along(half_length: DVec3, wall: &FlatWall, walls: &[FlatWall]) -> Option<PlainLeg> {
    let (axis, length) = (half_length.normalize(), half_length.length());
    let frame = Frame::from_axis_and_x(wall.middle, axis, wall.normal)?;
    let size = length + wall.sides[0].length() + wall.sides[1].length();
    let is_near = |a: DVec2, b: DVec2| a.distance(b) < SAME * size;
    let side = |wall: &FlatWall| -> Option<PrismSide> {
        let across = wall.sides.into_iter().find(|side| side.dot(axis).abs() < SAME * size)?;
        let middle = frame.point_to_local(wall.middle);
        let half = frame.to_local(across).truncate();
        let is_as_long = (wall.extent(axis) - length).abs() < SAME * size
            && middle.z.abs() < SAME * size
            && wall.normal.dot(axis).abs() < SAME;
        is_as_long.then(|| PrismSide {
            wall: *wall,
            ends: [middle.truncate() - half, middle.truncate() + half],
            normal: frame.to_local(wall.normal).truncate(),
        })
    };
    let others: Vec<PrismSide> = walls.iter().filter_map(side).collect();
    let first = side(wall)?;
    let mut sides = vec![first];
    let mut corners = vec![first.ends[1]];
    while !is_near(*corners.last()?, first.ends[0]) {
        let (from, end) = (sides.last()?.wall.prim, *corners.last()?);
        let mut next = others.iter().filter(|side| {
            side.wall.prim != from && side.ends.iter().any(|own| is_near(*own, end))
        });
        // Where three walls meet, none follows.
        let (Some(side), None) = (next.next(), next.next()) else { return None };
        if sides.len() == MOST_SIDES {
            return None;
        }
        let [a, b] = side.ends;
        sides.push(*side);
        corners.push(if is_near(a, end) { b } else { a });
    }
    let middle = corners.iter().sum::<DVec2>() / corners.len() as f64;
    let is_outward = |side: &PrismSide| (side.ends[0] - middle).dot(side.normal) > 0.0;
    let is_one_side = sides.iter().all(|side| is_outward(side) == is_outward(&first));
    let sides: Vec<LegSide> = sides.iter().map(|side| leg_side(side, middle)).collect();
    let is_convex = sides.iter().all(|side| {
        let reach = |corner: &DVec2| (*corner - middle).dot(side.normal) - side.offset;
        side.offset > 0.0 && corners.iter().all(|corner| reach(corner) < SAME * size)
    });
    let radius = corners.iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
    // All face inward, or all outward.
    let fits = is_convex && is_one_side && sides.len() >= 3;
    fits.then(|| PlainLeg {
        frame: frame.shifted(frame.to_world(middle.extend(0.0))),
        is_one_face: walls
            .iter()
            .filter(|other| sides.iter().any(|side| side.wall == other.prim))
            .all(|other| other.face == wall.face),
        section: LegSection::Polygon { radius, sides: sides.into() },
        spans: SmallVec::from_elem([-length, length], 1),
    })
}

/// A side about the middle of the polygon.
fn leg_side(side: &PrismSide, middle: DVec2) -> LegSide {
    let offset = (0.5 * (side.ends[0] + side.ends[1]) - middle).dot(side.normal);
    LegSide {
        normal: side.normal.normalize() * offset.signum(),
        offset: offset.abs(),
        wall: side.wall.prim,
    }
}
