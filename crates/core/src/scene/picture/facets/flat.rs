//! Flat outlines with corners, and with holes, which no grid fits.

use crate::scene::picture::facets::triangles::Triangulation;
use crate::scene::shape::{Flat, Region};
use glam::{DVec2, DVec3};
use lumiduct_base::math::planar::triangulate;

/// Corners of a round outline.
const ROUND: usize = 32;

/// A flat surface with corners or a hole as triangles; `None` where a grid works.
pub(super) fn facets(flat: &Flat) -> Option<Triangulation> {
    let to_world = |p: &DVec2| flat.frame().point_to_world(p.extend(0.0));
    match flat.region() {
        Region::Annulus { .. }
        | Region::Sector { .. }
        | Region::Ellipse { .. }
        | Region::Rectangle { .. } => None,
        Region::Polygon(polygon) => {
            let outline = polygon.vertices();
            Some(of_triangles(polygon.triangles(), &[outline], to_world))
        }
        Region::Holed(holed) => {
            let [outline, hole] = [holed.outline(), holed.hole()].map(|region| region.rim(ROUND));
            let triangles = triangulate(&joined(&outline, &hole));
            Some(of_triangles(&triangles, &[&outline, &hole], to_world))
        }
    }
}

fn of_triangles(
    triangles: &[[DVec2; 3]],
    outlines: &[&[DVec2]],
    to_world: impl Fn(&DVec2) -> DVec3,
) -> Triangulation {
    let mut facets = Triangulation::default();
    for triangle in triangles {
        let first = facets.points.len();
        facets.points.extend(triangle.iter().map(&to_world));
        facets.triangles.push([first, first + 1, first + 2]);
    }
    for outline in outlines {
        let first = facets.points.len();
        facets.points.extend(outline.iter().map(&to_world));
        facets.rims.push((first..facets.points.len()).chain([first]).collect());
    }
    facets
}

/// An outline and a hole as one polygon, with a cut between their nearest points.
fn joined(outline: &[DVec2], hole: &[DVec2]) -> Vec<DVec2> {
    let mut nearest = (0, 0, f64::INFINITY);
    for (i, p) in outline.iter().enumerate() {
        for (j, q) in hole.iter().enumerate() {
            if p.distance_squared(*q) < nearest.2 {
                nearest = (i, j, p.distance_squared(*q));
            }
        }
    }
    let (i, j, _) = nearest;
    let around = outline.iter().cycle().skip(i).take(outline.len() + 1);
    let back = hole.iter().rev().cycle().skip(hole.len() - 1 - j).take(hole.len() + 1);
    around.chain(back).copied().collect()
}
