//! Polygons of the plane: area, centroid, clipping, triangles and the overlap with a disk.
//!
//! Polygons are lists of vertices, closed without repeating the first. Counter-clockwise areas are positive.

use crate::math::quadratic;
use glam::DVec2;

/// The edges of a polygon: every vertex with the next one.
pub fn edges(polygon: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(&a, &b)| (a, b))
}

/// Whether a simple counter-clockwise polygon has no inward corner.
pub fn is_convex(polygon: &[DVec2]) -> bool {
    let n = polygon.len();
    let turn = |i: usize| {
        let [a, b, c] = [polygon[i], polygon[(i + 1) % n], polygon[(i + 2) % n]];
        (b - a).perp_dot(c - b)
    };
    (0..n).all(|i| turn(i) >= 0.0)
}

/// Area, mm²; positive when the vertices run counter-clockwise.
pub fn signed_area(polygon: &[DVec2]) -> f64 {
    let Some(&base) = polygon.first() else { return 0.0 };
    // From the first vertex: a polygon far from the origin keeps its digits.
    0.5 * edges(polygon).map(|(a, b)| (a - base).perp_dot(b - base)).sum::<f64>()
}

/// First moment of the area about the origin, mm³: area times centroid.
pub fn area_moment(polygon: &[DVec2]) -> DVec2 {
    let Some(&base) = polygon.first() else { return DVec2::ZERO };
    let about_base = edges(polygon)
        .map(|(a, b)| (a - base).perp_dot(b - base) * (a + b - 2.0 * base))
        .sum::<DVec2>();
    about_base / 6.0 + signed_area(polygon) * base
}

/// The part of a polygon with `normal · p <= offset` (Sutherland & Hodgman, Commun. ACM 17 (1974) 32).
///
/// Pieces of a non-convex polygon stay joined by edges along the line, which cancel in areas and
/// moments.
pub fn clip(polygon: &[DVec2], normal: DVec2, offset: f64) -> Vec<DVec2> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (a, b) in edges(polygon) {
        let (out_a, out_b) = (normal.dot(a) - offset, normal.dot(b) - offset);
        if out_a <= 0.0 {
            kept.push(a);
        }
        if (out_a < 0.0 && out_b > 0.0) || (out_a > 0.0 && out_b < 0.0) {
            kept.push(a.lerp(b, out_a / (out_a - out_b)));
        }
    }
    kept
}

/// The part of a polygon between the corners `min` and `max` of a rectangle; see [`clip`].
pub fn clip_to_rectangle(polygon: &[DVec2], min: DVec2, max: DVec2) -> Vec<DVec2> {
    [(DVec2::X, max.x), (DVec2::Y, max.y), (DVec2::NEG_X, -min.x), (DVec2::NEG_Y, -min.y)]
        .into_iter()
        .fold(polygon.to_vec(), |rest, (normal, offset)| clip(&rest, normal, offset))
}

/// Area that a polygon shares with the disk of `radius` about the origin, mm²: the sum over its
/// edges of the signed area common to the disk and the triangle of origin and edge.
pub fn disk_overlap(radius: f64, polygon: &[DVec2]) -> f64 {
    let sector = |a: DVec2, b: DVec2| 0.5 * radius * radius * a.perp_dot(b).atan2(a.dot(b));
    edges(polygon)
        .map(|(a, b)| {
            let along = b - a;
            let c = a.length_squared() - radius * radius;
            let Some(roots) = quadratic(along.length_squared(), a.dot(along), c) else {
                return sector(a, b);
            };
            let [enter, leave] = roots.map(|t| t.clamp(0.0, 1.0));
            if enter >= leave {
                return sector(a, b);
            }
            let (p, q) = (a.lerp(b, enter), a.lerp(b, leave));
            sector(a, p) + 0.5 * p.perp_dot(q) + sector(q, b)
        })
        .sum()
}

/// Triangles that fill a simple counter-clockwise polygon, by cutting off ears (Meisters, Am. Math. Mon. 82 (1975) 648).
pub fn triangulate(polygon: &[DVec2]) -> Vec<[DVec2; 3]> {
    let mut rest = polygon.to_vec();
    let mut triangles = Vec::new();
    while rest.len() >= 3 {
        let n = rest.len();
        // Rounding may hide the ears of a nearly flat remainder; then any corner will do.
        let ear = (0..n).find(|&i| is_ear(&rest, i)).unwrap_or(0);
        triangles.push([rest[(ear + n - 1) % n], rest[ear], rest[(ear + 1) % n]]);
        rest.remove(ear);
    }
    triangles
}

/// Whether the ear at corner `i` is convex and contains no other vertex.
fn is_ear(polygon: &[DVec2], i: usize) -> bool {
    let n = polygon.len();
    let [a, b, c] = [polygon[(i + n - 1) % n], polygon[i], polygon[(i + 1) % n]];
    let left = |from: DVec2, to: DVec2, p: DVec2| (to - from).perp_dot(p - from);
    left(a, b, c) >= 0.0
        && !polygon.iter().any(|&p| {
            p != a
                && p != b
                && p != c
                && left(a, b, p) >= 0.0
                && left(b, c, p) >= 0.0
                && left(c, a, p) >= 0.0
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// An L of three unit squares around the corner (1, 1).
    fn ell() -> Vec<DVec2> {
        [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)]
            .map(DVec2::from)
            .to_vec()
    }

    #[test]
    fn area_and_moment_of_an_l_are_those_of_its_squares() {
        assert!((signed_area(&ell()) - 3.0).abs() < 1e-15);
        let moment = DVec2::new(0.5, 0.5) + DVec2::new(1.5, 0.5) + DVec2::new(0.5, 1.5);
        assert!((area_moment(&ell()) - moment).length() < 1e-15);
    }

    #[test]
    fn clipping_an_l_leaves_the_exact_area_even_in_two_pieces() {
        // Above x + y = 2.5 two small triangles remain, of legs 0.5.
        let rest = clip(&ell(), DVec2::new(-1.0, -1.0), -2.5);
        assert!((signed_area(&rest) - 2.0 * 0.125).abs() < 1e-15);
        let cell = clip_to_rectangle(&ell(), DVec2::splat(0.5), DVec2::splat(1.5));
        assert!((signed_area(&cell) - 0.75).abs() < 1e-15);
    }

    #[test]
    fn triangles_of_an_l_fill_it() {
        let triangles = triangulate(&ell());
        assert_eq!(triangles.len(), 4);
        assert!(triangles.iter().all(|t| signed_area(t) >= 0.0));
        assert!((triangles.iter().map(|t| signed_area(t)).sum::<f64>() - 3.0).abs() < 1e-15);
    }

    #[test]
    fn a_disk_overlaps_a_square_as_known() {
        let square = |half: f64| {
            [(-half, -half), (half, -half), (half, half), (-half, half)].map(DVec2::from)
        };
        assert!((disk_overlap(1.0, &square(2.0)) - PI).abs() < 1e-14);
        assert!((disk_overlap(2.8, &square(2.0)) - 16.0).abs() > 1e-4);
        assert!((disk_overlap(2.9, &square(2.0)) - 16.0).abs() < 1e-13);
        // Between: four caps of height r - h are missing, r² acos(h/r) - h sqrt(r² - h²) each.
        let (r, h) = (1.0f64, 0.8f64);
        let cap = r * r * (h / r).acos() - h * (r * r - h * h).sqrt();
        assert!((disk_overlap(r, &square(h)) - (PI - 4.0 * cap)).abs() < 1e-14);
    }
}
