//! The cross-section of a sweep, and its validity.

use crate::scene::shape::Region;
use glam::DVec2;
use lumiduct_base::math::planar;
use std::f64::consts::{PI, TAU};

/// A cross-section in the (x, y) plane of the path's frame, mm. The path is the origin.
///
/// The constructors check it; [`crate::scene::sweep::sweep`] checks it again.
#[derive(Debug, Clone, PartialEq)]
pub enum Profile {
    /// A disk about the path.
    Circle {
        /// Radius, mm.
        radius: f64,
    },
    /// A simple polygon. Wall `i` is on the edge from point `i` to the next one.
    Polygon {
        /// The vertices, counter-clockwise, mm.
        points: Vec<DVec2>,
    },
}

/// Why a cross-section cannot be swept.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ProfileError {
    /// A length is not a positive number of reasonable size.
    #[error("{what} is {value} mm, expected a positive length")]
    Length {
        /// Which length.
        what: &'static str,
        /// Its value, mm.
        value: f64,
    },
    /// Too few or too many corners.
    #[error("the profile has {0} corners, expected {min} to {max}", min = MIN_POINTS, max = MAX_POINTS)]
    Count(usize),
    /// A coordinate is NaN, or far too large.
    #[error("point {index} of the profile is ({x}, {y}), expected two finite numbers")]
    NotFinite {
        /// Index of the point, from 0.
        index: usize,
        /// Its x.
        x: f64,
        /// Its y.
        y: f64,
    },
    /// A point lies on the one before it.
    #[error("point {index} of the profile repeats the point before it, ({x}, {y})")]
    Repeated {
        /// Index of the point, from 0.
        index: usize,
        /// Its x, mm.
        x: f64,
        /// Its y, mm.
        y: f64,
    },
    /// The points lie on a line.
    #[error("the profile has an area of {area} mm², which is zero within rounding")]
    NoArea {
        /// The area, mm².
        area: f64,
    },
    /// Two edges touch that are not neighbours, or a corner folds back.
    #[error("edges {first} and {second} of the profile cross or touch")]
    SelfCrossing {
        /// Index of the edge, from 0: the one from the point of the same number.
        first: usize,
        /// The other edge.
        second: usize,
    },
}

/// Smallest number of corners of a polygon.
const MIN_POINTS: usize = 3;
/// Largest number of corners: each becomes a surface on every leg.
const MAX_POINTS: usize = 1000;
/// Lengths up to 1000 km, mm: far from the overflow of their fourth powers.
pub(super) const MAX_LENGTH: f64 = 1e9;
/// Below this share of the size, a difference is rounding.
const ROUNDING: f64 = 1e-12;

impl Profile {
    /// A disk of `radius`, mm.
    ///
    /// # Errors
    ///
    /// [`ProfileError::Length`] if the radius is not positive, or beyond 1000 km.
    pub fn circle(radius: f64) -> Result<Self, ProfileError> {
        checked(Self::Circle { radius })
    }

    /// A rectangle about the path, mm. Wall 0 is at +x, 1 at +y, 2 at -x, 3 at -y.
    ///
    /// # Errors
    ///
    /// [`ProfileError::Length`] if a side is not positive, or beyond 1000 km; [`ProfileError::Repeated`] if it is
    /// zero within rounding compared with the other.
    pub fn rectangle(width: f64, height: f64) -> Result<Self, ProfileError> {
        length("the width", width)?;
        length("the height", height)?;
        let (x, y) = (0.5 * width, 0.5 * height);
        let points = [(x, -y), (x, y), (-x, y), (-x, -y)].map(DVec2::from).to_vec();
        checked(Self::Polygon { points })
    }

    /// A regular polygon whose corners lie on a circle of `circumradius`, mm; point 0 lies at the azimuth `rotation`,
    /// rad.
    ///
    /// # Errors
    ///
    /// [`ProfileError::Length`] if the radius is not positive, or beyond 1000 km; [`ProfileError::Count`] unless
    /// there are 3 to 1000 sides; [`ProfileError::NotFinite`] if the rotation is not finite.
    pub fn regular(sides: usize, circumradius: f64, rotation: f64) -> Result<Self, ProfileError> {
        length("the circumscribed radius", circumradius)?;
        if !(MIN_POINTS..=MAX_POINTS).contains(&sides) {
            return Err(ProfileError::Count(sides));
        }
        let azimuth = |i: usize| rotation + TAU * i as f64 / sides as f64;
        let points = (0..sides).map(|i| circumradius * DVec2::from_angle(azimuth(i))).collect();
        checked(Self::Polygon { points })
    }

    /// A simple polygon, mm. Clockwise points are reversed, so that wall `i` is the edge between points n-1-i and
    /// n-2-i of the given list.
    ///
    /// # Errors
    ///
    /// [`ProfileError::Count`] unless there are 3 to 1000 points; otherwise the first fault of the outline: a
    /// coordinate that is not finite or beyond 1000 km, a repeated point, edges that cross or touch, no area.
    pub fn polygon(mut points: Vec<DVec2>) -> Result<Self, ProfileError> {
        if planar::signed_area(&points) < 0.0 {
            points.reverse();
        }
        checked(Self::Polygon { points })
    }

    /// Area, mm².
    pub(crate) fn area(&self) -> f64 {
        match self {
            Self::Circle { radius } => PI * radius * radius,
            Self::Polygon { points } => planar::signed_area(points),
        }
    }

    /// Length of the outline, mm.
    pub(crate) fn perimeter(&self) -> f64 {
        match self {
            Self::Circle { radius } => TAU * radius,
            Self::Polygon { points } => planar::edges(points).map(|(a, b)| (b - a).length()).sum(),
        }
    }

    /// Reach of the profile along `direction`: the largest p · direction over its points.
    pub(crate) fn reach(&self, direction: DVec2) -> f64 {
        match self {
            Self::Circle { radius } => radius * direction.length(),
            Self::Polygon { points } => {
                points.iter().map(|p| p.dot(direction)).fold(f64::NEG_INFINITY, f64::max)
            }
        }
    }

    /// The largest distance of a point from the path, mm.
    pub(crate) fn size(&self) -> f64 {
        match self {
            Self::Circle { radius } => *radius,
            Self::Polygon { points } => points.iter().map(|p| p.length()).fold(0.0, f64::max),
        }
    }

    /// First moments ∫ p · direction dA of the parts with negative and with positive p · direction, mm³.
    pub(super) fn half_moments(&self, direction: DVec2) -> [f64; 2] {
        match self {
            // Half a disk: area π r²/2, centroid at 4r/3π.
            Self::Circle { radius } => [-1.0, 1.0].map(|side| side * 2.0 / 3.0 * radius.powi(3)),
            Self::Polygon { points } => [direction, -direction].map(|outward| {
                planar::area_moment(&planar::clip(points, outward, 0.0)).dot(direction)
            }),
        }
    }

    /// The profile scaled by `scale` as a region of the plane, and its mirror image in y for a frame that looks the
    /// other way along the path.
    pub(super) fn regions(&self, scale: f64) -> [Region; 2] {
        match self {
            Self::Circle { radius } => {
                [(); 2].map(|()| Region::Annulus { inner: 0.0, outer: scale * radius })
            }
            Self::Polygon { points } => match *points.as_slice() {
                [a, b, c, d] if is_rectangle([a, b, c, d]) => {
                    [(); 2].map(|()| Region::Rectangle { half_x: scale * b.x, half_y: scale * b.y })
                }
                _ => {
                    let section: Vec<DVec2> = points.iter().map(|p| scale * *p).collect();
                    let mirrored = section.iter().rev().map(|p| DVec2::new(p.x, -p.y)).collect();
                    [Region::polygon(section), Region::polygon(mirrored)]
                }
            },
        }
    }

    /// What prevents the profile from being swept, if anything.
    pub(super) fn check(&self) -> Result<(), ProfileError> {
        match self {
            Self::Circle { radius } => length("the radius", *radius),
            Self::Polygon { points } => check_polygon(points),
        }
    }
}

/// Whether the points are those of [`Profile::rectangle`].
fn is_rectangle([a, b, c, d]: [DVec2; 4]) -> bool {
    let mirrored = DVec2::new(-b.x, b.y);
    b.x > 0.0 && b.y > 0.0 && a == -mirrored && c == mirrored && d == -b
}

fn checked(profile: Profile) -> Result<Profile, ProfileError> {
    profile.check().map(|()| profile)
}

fn length(what: &'static str, value: f64) -> Result<(), ProfileError> {
    let usable = value > 0.0 && value <= MAX_LENGTH;
    if usable { Ok(()) } else { Err(ProfileError::Length { what, value }) }
}

fn check_polygon(points: &[DVec2]) -> Result<(), ProfileError> {
    if !(MIN_POINTS..=MAX_POINTS).contains(&points.len()) {
        return Err(ProfileError::Count(points.len()));
    }
    for (index, p) in points.iter().enumerate() {
        // Also false for NaN.
        if !p.abs().cmple(DVec2::splat(MAX_LENGTH)).all() {
            return Err(ProfileError::NotFinite { index, x: p.x, y: p.y });
        }
    }
    let size = points.iter().map(|p| p.distance(points[0])).fold(0.0, f64::max);
    for (i, (a, b)) in planar::edges(points).enumerate() {
        if a.distance(b) <= ROUNDING * size {
            let index = (i + 1) % points.len();
            return Err(ProfileError::Repeated { index, x: b.x, y: b.y });
        }
    }
    if let Some((first, second)) = crossing_edges(points) {
        return Err(ProfileError::SelfCrossing { first, second });
    }
    let area = planar::signed_area(points);
    if area <= ROUNDING * size * size {
        return Err(ProfileError::NoArea { area });
    }
    Ok(())
}

/// Two edges of a polygon that meet elsewhere than at their common end.
fn crossing_edges(points: &[DVec2]) -> Option<(usize, usize)> {
    let edges: Vec<(DVec2, DVec2)> = planar::edges(points).collect();
    let n = edges.len();
    (0..n).find_map(|i| (i + 1..n).find(|&k| meet(&edges, i, k)).map(|k| (i, k)))
}

fn meet(edges: &[(DVec2, DVec2)], i: usize, k: usize) -> bool {
    let ((a, b), (c, d)) = (edges[i], edges[k]);
    if k == i + 1 || (i == 0 && k + 1 == edges.len()) {
        // Neighbours: only a fold that runs back along itself. (After the last edge comes edge 0.)
        let (first, second) = if k == i + 1 { (b - a, d - c) } else { (d - c, b - a) };
        let sine = first.perp_dot(second);
        let fold = first.dot(second) < 0.0;
        return fold && sine.abs() <= ROUNDING * first.length() * second.length();
    }
    let side = |from: DVec2, to: DVec2, p: DVec2| (to - from).perp_dot(p - from);
    let apart = |x: f64, y: f64| (x > 0.0 && y > 0.0) || (x < 0.0 && y < 0.0);
    // Edges on one line have no sides: their boxes decide.
    a.min(b).cmple(c.max(d)).all()
        && c.min(d).cmple(a.max(b)).all()
        && !apart(side(a, b, c), side(a, b, d))
        && !apart(side(c, d, a), side(c, d, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(points: &[(f64, f64)]) -> Result<Profile, ProfileError> {
        Profile::polygon(points.iter().copied().map(DVec2::from).collect())
    }

    #[test]
    fn clockwise_points_are_reversed() {
        let profile = polygon(&[(0.0, 0.0), (0.0, 1.0), (2.0, 0.0)]).unwrap();
        assert_eq!(profile.area(), 1.0);
        let Profile::Polygon { points } = profile else { panic!("a polygon") };
        assert_eq!(points[0], DVec2::new(2.0, 0.0));
    }

    #[test]
    fn unusable_profiles_are_refused_with_their_figure() {
        let message = |result: Result<Profile, ProfileError>| result.unwrap_err().to_string();
        assert!(message(Profile::circle(0.0)).contains("radius is 0 mm"));
        assert!(message(Profile::circle(f64::NAN)).contains("NaN"));
        assert!(message(Profile::rectangle(1.0, -2.0)).contains("height is -2 mm"));
        assert!(message(Profile::regular(2, 1.0, 0.0)).contains("2 corners"));
        assert!(message(Profile::regular(1001, 1.0, 0.0)).contains("1001 corners"));
        assert!(message(polygon(&[(0.0, 0.0), (1.0, 0.0)])).contains("2 corners"));
        let infinite = polygon(&[(0.0, 0.0), (1.0, 0.0), (0.0, f64::INFINITY)]);
        assert!(message(infinite).contains("point 2"));
        let repeated = polygon(&[(0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (0.0, 1.0)]);
        assert!(message(repeated).contains("point 2"));
        let bow_tie = polygon(&[(0.0, 0.0), (1.0, 1.0), (3.0, 0.0), (0.0, 1.0)]);
        assert!(message(bow_tie).contains("edges 0 and 2"));
        let touching = polygon(&[(0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (2.0, 0.0), (0.0, 2.0)]);
        assert!(message(touching).contains("cross or touch"));
        let on_a_line = polygon(&[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)]);
        assert!(on_a_line.is_err());
        let spike = polygon(&[(0.0, 0.0), (2.0, 0.0), (1.0, 0.0), (1.0, 1.0)]);
        assert!(message(spike).contains("edges 0 and 1"));
    }

    #[test]
    fn good_profiles_have_their_area_and_perimeter() {
        let rectangle = Profile::rectangle(4.0, 3.0).unwrap();
        assert_eq!((rectangle.area(), rectangle.perimeter()), (12.0, 14.0));
        assert!(matches!(
            rectangle.regions(2.0)[0],
            Region::Rectangle { half_x: 4.0, half_y: 3.0 }
        ));
        let hexagon = Profile::regular(6, 2.0, 0.1).unwrap();
        assert!((hexagon.area() - 6.0 * 3.0f64.sqrt()).abs() < 1e-13);
        assert!((hexagon.perimeter() - 12.0).abs() < 1e-13);
        assert!((Profile::regular(1000, 1.0, 0.0).unwrap().area() - PI).abs() < 1e-4);
        let collinear = polygon(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 1.0)]);
        assert_eq!(collinear.unwrap().area(), 1.0);
    }

    #[test]
    fn half_moments_add_up_to_the_moment() {
        let ell =
            polygon(&[(0.0, -1.0), (2.0, -1.0), (2.0, 0.5), (1.0, 0.5), (1.0, 2.0), (0.0, 2.0)])
                .unwrap();
        let direction = DVec2::from_angle(2.0);
        let [negative, positive] = ell.half_moments(direction);
        let Profile::Polygon { points } = &ell else { panic!("a polygon") };
        let whole = planar::area_moment(points).dot(direction);
        assert!(negative < 0.0 && positive > 0.0);
        assert!((negative + positive - whole).abs() < 1e-13);
    }
}
