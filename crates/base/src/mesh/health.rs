//! Is a mesh closed, the right way out, and fine enough? This module only judges; the caller
//! decides what to do about it.

#[cfg(test)]
mod tests;

use crate::mesh::topology::{Groups, HalfEdge, half_edges, same_edge};
use crate::mesh::{TriangleMesh, area_vector};
use glam::DVec3;

/// Below this turn, degrees, two facets belong to one flat face with rounded coordinates.
const FLAT_DEG: f64 = 0.1;
/// Above this turn, degrees, an edge is intended.
const SHARP_DEG: f64 = 45.0;
/// The angles of a facet with its neighbours on a curved wall agree within this factor, 1.
const ALIKE: f64 = 2.0;
/// A curved wall without normals has at least this many facets in a row or a field; fewer are flat
/// faces that meet at angles.
const LEAST_FACETS: usize = 6;
/// Corner normals within this angle of the facet normal, rad, equal it: nothing is smoothed.
const OWN_NORMAL: f64 = 1.0e-3;
/// Corner normals within this angle of each other, rad, were equal before rounding to 16 bits or
/// more.
const SAME_NORMAL: f64 = 1.0e-4;

/// Beyond this drift, 1, the initial skewness is lost.
const LOST: f64 = 0.3;

/// A triangle thinner than this share of the size of its mesh, 1, is a sliver: single precision
/// positions, of 6e-8, leave its normal uncertain by hundredths.
const SLIVER: f64 = 1.0e-5;

/// Defects of one kind in a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Defects {
    /// How many.
    pub count: usize,
    /// The first of them, mm, in the coordinates of the file.
    pub first: Option<DVec3>,
}

impl Defects {
    fn add(&mut self, place: impl Fn() -> DVec3) {
        self.count += 1;
        self.first.get_or_insert_with(place);
    }
}

/// The state of a mesh before light is traced through it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshHealth {
    /// Edges with only one triangle: holes.
    pub open_edges: Defects,
    /// Edges with more than two triangles.
    pub crowded_edges: Defects,
    /// Edges that both triangles traverse in the same direction: one of the two is inside out.
    pub inconsistent_edges: Defects,
    /// Triangles without area; they are harmless.
    pub degenerate_triangles: Defects,
    /// Triangles so thin that their normal is uncertain.
    pub slivers: Defects,
    /// Triangles with a corner normal that points to their back side.
    pub opposed_normals: Defects,
    /// Largest distance of facets from the surface that their corner normals describe, mm; `None`
    /// without normals.
    pub sagitta_mm: Option<f64>,
    /// Volume, mm³; negative when the mesh is inside out. Meaningless unless it is closed.
    pub signed_volume_mm3: f64,
    /// Area, mm².
    pub area_mm2: f64,
    /// Parts that are not connected by an edge.
    pub shells: usize,
    /// How coarsely curved parts are faceted, if there are facets that no normals smooth.
    pub facets: Option<CoarseFacets>,
}

impl MeshHealth {
    /// Whether the mesh has an inside: no open, crowded or inconsistent edges, and a positive
    /// volume.
    pub fn is_sound(&self) -> bool {
        self.open_edges.count == 0
            && self.crowded_edges.count == 0
            && self.inconsistent_edges.count == 0
            && self.signed_volume_mm3 > 0.0
    }

    /// Area of facets that are not smoothed, mm².
    pub(super) fn faceted_mm2(&self) -> f64 {
        self.facets.map_or(0.0, |facets| facets.area_share * self.area_mm2)
    }
}

/// Facets that approximate a curved surface and are not smoothed by corner normals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoarseFacets {
    /// Typical angle between neighbours, degrees: area-weighted median of each triangle's largest
    /// angle.
    pub turn_deg: f64,
    /// Share of the mesh's area that is faceted this way, 1.
    pub area_share: f64,
}

impl CoarseFacets {
    /// How many facets make a full turn.
    pub fn per_turn(&self) -> f64 {
        360.0 / self.turn_deg
    }

    /// Expected relative drift of the skew invariant after `bounces` in a rod of such facets, 1:
    /// (3.2/N) sqrt(bounces). Light whose skewness drifts leaves the guide where it should stay
    /// inside. `None` where the skewness is lost and this law no longer holds.
    pub fn skew_drift(&self, bounces: f64) -> Option<f64> {
        // Coefficient fitted to rods of 64 to 1024 facets.
        Some(3.2 / self.per_turn() * bounces.sqrt()).filter(|drift| *drift < LOST)
    }
}

/// Examines a mesh.
pub fn health(mesh: &TriangleMesh) -> MeshHealth {
    let half_edges = half_edges(&mesh.triangles);
    let mut health = MeshHealth {
        opposed_normals: opposed_normals(mesh),
        sagitta_mm: sagitta(mesh, &half_edges),
        shells: shells(mesh, &half_edges),
        facets: facets(mesh, &half_edges),
        ..MeshHealth::default()
    };
    for edge in half_edges.chunk_by(same_edge) {
        let middle = || {
            let ends = [edge[0].low, edge[0].high].map(|end| mesh.positions[end as usize]);
            ends[0].midpoint(ends[1])
        };
        match edge {
            [_] => health.open_edges.add(middle),
            [one, other] => {
                if one.is_upward(&mesh.triangles) == other.is_upward(&mesh.triangles) {
                    health.inconsistent_edges.add(middle);
                }
            }
            _ => health.crowded_edges.add(middle),
        }
    }
    // Relative to a point of the mesh: far from the origin the tetrahedra would cancel.
    let center = mesh.bounds().center();
    let thin = SLIVER * mesh.bounds().diagonal();
    for triangle in 0..mesh.triangles.len() {
        let corners = mesh.corners(triangle);
        let [a, b, c] = corners.map(|corner| corner - center);
        let double_area = area_vector([a, b, c]).length();
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        if double_area == 0.0 {
            health.degenerate_triangles.add(|| corners[0]);
        } else if double_area < thin * longest {
            health.slivers.add(|| corners[0]);
        }
        health.area_mm2 += 0.5 * double_area;
        health.signed_volume_mm3 += a.dot(b.cross(c)) / 6.0;
    }
    health
}

fn opposed_normals(mesh: &TriangleMesh) -> Defects {
    let mut opposed = Defects::default();
    for (triangle, normals) in mesh.normals.iter().flatten().enumerate() {
        let corners = mesh.corners(triangle);
        let facet = area_vector(corners);
        if normals.iter().any(|normal| normal.dot(facet) < 0.0) {
            opposed.add(|| corners[0]);
        }
    }
    opposed
}

/// Over the middle of an edge `e` a surface with the normals `a` and `b` at its ends rises by `e · (b - a)/8`: a parabola.
fn sagitta(mesh: &TriangleMesh, half_edges: &[HalfEdge]) -> Option<f64> {
    let normals = mesh.normals.as_ref()?;
    let rises = half_edges.iter().map(|side| {
        let [low, high] =
            side.corners(&mesh.triangles).map(|corner| normals[side.triangle as usize][corner]);
        let ends = [side.low, side.high].map(|end| mesh.positions[end as usize]);
        ((ends[1] - ends[0]).dot(high - low) / 8.0).abs()
    });
    Some(rises.fold(0.0, f64::max))
}

fn shells(mesh: &TriangleMesh, half_edges: &[HalfEdge]) -> usize {
    let mut groups = Groups::new(mesh.triangles.len());
    for edge in half_edges.chunk_by(same_edge) {
        for other in &edge[1..] {
            groups.join(edge[0].triangle, other.triangle);
        }
    }
    // Collapsed triangles have no edges and form no shell.
    let group = groups.numbered();
    let mut present: Vec<u32> =
        half_edges.iter().map(|half_edge| group[half_edge.triangle as usize]).collect();
    present.sort_unstable();
    present.dedup();
    present.len()
}

/// An edge at which the surface turns slightly and no normals smooth it.
struct Turn {
    triangles: [u32; 2],
    /// Angle by which the surface turns, degrees; positive where it is convex.
    angle_deg: f64,
}

/// Flat pieces in a row or a field, each with two or more neighbours to which it turns the same way
/// by similar angles, as on a curved wall without normals. A piece with the normals of a curved
/// surface bends light as that surface does, so it does not count, and neither do flat faces that
/// meet at an angle.
fn facets(mesh: &TriangleMesh, half_edges: &[HalfEdge]) -> Option<CoarseFacets> {
    let areas: Vec<DVec3> =
        (0..mesh.triangles.len()).map(|triangle| area_vector(mesh.corners(triangle))).collect();
    let (turns, piece_of) = turns(mesh, half_edges, &areas);
    let turn = turns_of_walls(&turns, &piece_of);
    let area = |triangle: usize| 0.5 * areas[triangle].length();
    let total: f64 = (0..turn.len()).map(area).sum();
    let mut turned: Vec<(f64, f64)> = turn
        .iter()
        .enumerate()
        .filter(|(_, turn)| **turn > 0.0)
        .map(|(triangle, turn)| (*turn, area(triangle)))
        .collect();
    turned.sort_by(|one, other| one.0.total_cmp(&other.0));
    let curved: f64 = turned.iter().map(|(_, area)| area).sum();
    let mut below = 0.0;
    let (turn_deg, _) = turned.iter().find(|(_, area)| {
        below += area;
        below >= 0.5 * curved
    })?;
    Some(CoarseFacets { turn_deg: *turn_deg, area_share: curved / total })
}

/// The edges between flat pieces at which the surface turns slightly and no normals smooth it, and the piece of each triangle.
fn turns(mesh: &TriangleMesh, half_edges: &[HalfEdge], areas: &[DVec3]) -> (Vec<Turn>, Vec<u32>) {
    let (mut turns, mut pieces) = (Vec::new(), Groups::new(areas.len()));
    for edge in half_edges.chunk_by(same_edge) {
        let [one, other] = edge else { continue };
        let triangles = [one.triangle, other.triangle];
        let [near, far] = triangles.map(|triangle| areas[triangle as usize]);
        let angle = dihedral_deg(near, far);
        if angle < FLAT_DEG {
            pieces.join(one.triangle, other.triangle);
        }
        let is_turn = (FLAT_DEG..SHARP_DEG).contains(&angle)
            && !normals_agree(mesh, one, other)
            && triangles.iter().all(|own| has_own_normals(mesh, *own as usize, areas));
        if !is_turn {
            continue;
        }
        let beyond = mesh.corners(other.triangle as usize)[other.opposite_corner()];
        let here = mesh.positions[one.low as usize];
        let is_convex = (beyond - here).dot(near) < 0.0;
        turns.push(Turn { triangles, angle_deg: if is_convex { angle } else { -angle } });
    }
    (turns, pieces.numbered())
}

/// Whether all corner normals of a triangle equal its facet normal.
fn has_own_normals(mesh: &TriangleMesh, triangle: usize, areas: &[DVec3]) -> bool {
    let Some(normals) = &mesh.normals else { return true };
    let facet = areas[triangle].normalize_or_zero();
    normals[triangle].iter().all(|normal| normal.distance(facet) < OWN_NORMAL)
}

/// The largest turn at each triangle that belongs to a curved wall, degrees; 0 at all others.
fn turns_of_walls(turns: &[Turn], piece_of: &[u32]) -> Vec<f64> {
    let pieces = piece_of.iter().max().map_or(0, |last| *last as usize + 1);
    let joined = |turn: &Turn| turn.triangles.map(|triangle| piece_of[triangle as usize]);
    // By piece: its neighbours and the angles to them.
    let mut neighbours: Vec<Vec<(u32, f64)>> = vec![Vec::new(); pieces];
    for turn in turns {
        let [a, b] = joined(turn);
        neighbours[a as usize].push((b, turn.angle_deg));
        neighbours[b as usize].push((a, turn.angle_deg));
    }
    let goes_on = |piece: u32, from: u32, angle: f64| {
        neighbours[piece as usize].iter().any(|(other, next)| {
            *other != from && (next / angle) < ALIKE && (angle / next) < ALIKE && next * angle > 0.0
        })
    };
    // A turn belongs to a wall if the wall continues with similar turns beyond one of its two
    // pieces.
    let of_walls: Vec<&Turn> = turns
        .iter()
        .filter(|turn| {
            let [a, b] = joined(turn);
            goes_on(a, b, turn.angle_deg) || goes_on(b, a, turn.angle_deg)
        })
        .collect();
    let mut walls = Groups::new(pieces);
    for [a, b] in of_walls.iter().map(|turn| joined(turn)) {
        walls.join(a, b);
    }
    let wall_of = walls.numbered();
    let mut sizes = vec![0usize; pieces];
    wall_of.iter().for_each(|wall| sizes[*wall as usize] += 1);
    let mut largest = vec![0.0f64; piece_of.len()];
    for turn in of_walls {
        if sizes[wall_of[joined(turn)[0] as usize] as usize] >= LEAST_FACETS {
            for triangle in turn.triangles {
                let largest = &mut largest[triangle as usize];
                *largest = largest.max(turn.angle_deg.abs());
            }
        }
    }
    largest
}

/// Angle between two facets by their areas, degrees; 0 for one without area.
fn dihedral_deg(one: DVec3, other: DVec3) -> f64 {
    one.cross(other).length().atan2(one.dot(other)).to_degrees()
}

/// Whether the corner normals of two triangles are the same at both ends of their common edge.
pub fn normals_agree(mesh: &TriangleMesh, one: &HalfEdge, other: &HalfEdge) -> bool {
    let Some(normals) = &mesh.normals else { return false };
    let [one, other] = [one, other].map(|side| {
        side.corners(&mesh.triangles).map(|corner| normals[side.triangle as usize][corner])
    });
    one[0].distance(other[0]) < SAME_NORMAL && one[1].distance(other[1]) < SAME_NORMAL
}
