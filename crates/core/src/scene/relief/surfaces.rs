//! The surfaces of one element in space.
//!
//! Surfaces that meet in an edge overlap there by a few units in the last place, so that rounding leaves no gap.

use crate::scene::pattern::element::{Cap, Element, ElementForm, Way, WedgeSpan};
use crate::scene::relief::ground::{ReliefWall, Site};
use crate::scene::shape::{Cone, Flat, Region, Shape, Sphere};
use glam::{DVec2, DVec3};
use lumiduct_base::math::planar::signed_area;

/// A surface of an element.
#[derive(Debug)]
pub(crate) struct Made {
    pub(crate) shape: Shape,
    /// Whether it must be cut off at the wall, since its own edges do not end there.
    pub(crate) is_trimmed: bool,
}

impl Made {
    fn whole(shape: Shape) -> Self {
        Self { shape, is_trimmed: false }
    }
}

/// The surfaces of an element of the row at `place`, with its middle at `at` on the wall; they
/// overlap by `lap`, mm.
pub(crate) fn surfaces(
    element: &Element,
    place: f64,
    ground: &ReliefWall,
    at: DVec2,
    lap: f64,
) -> Vec<Made> {
    let site = ground.site(at);
    let height = element.height(place);
    match (&element.form, element.cap(place)) {
        (_, Some(cap)) => vec![spherical(element, &cap, &site, lap)],
        (ElementForm::Wedge { slopes, span: WedgeSpan::Ring, .. }, _) => {
            let radius = element.round.unwrap_or(0.0);
            rings(radius, height, slopes, element.way, &site, lap)
        }
        (ElementForm::Wedge { slopes, span, .. }, _) => {
            wedge(element, ReliefWedge { height, slopes: *slopes, span: *span }, &site, lap)
        }
        (ElementForm::Pyramid { width, length, .. }, _) => {
            pyramid(DVec2::new(*width, *length), height, element.way, &site, lap)
        }
        (ElementForm::Cap { .. }, None) => Vec::new(),
    }
}

fn spherical(element: &Element, cap: &Cap, site: &Site, lap: f64) -> Made {
    let Cap { radius, height, rim } = *cap;
    // Height of the wall over the centre, in the frame of the sphere.
    let wall = radius - height;
    let center = site.at(0.0, 0.0, -element.way.sign() * wall);
    let frame = Site::frame(center, site.out, site.along);
    let sphere = match (element.way, element.round) {
        (Way::Into, _) => Sphere::zone(frame, radius, -radius, lap - wall).inward(),
        (Way::OutOf, None) => Sphere::zone(frame, radius, wall - lap, radius),
        (Way::OutOf, Some(round)) => {
            // The wall falls away from its tangent: where it meets the sphere furthest around, it
            // is lower by rim²/2c.
            let lowest = wall - 0.5 * rim * rim / cap.center_from_axis(round, element.way);
            Sphere::zone(frame, radius, lowest - lap, radius)
        }
    };
    Made { shape: Shape::Sphere(sphere), is_trimmed: element.round.is_some() }
}

/// A wedge of a certain height, mm.
#[derive(Debug, Clone, Copy)]
struct ReliefWedge {
    height: f64,
    slopes: [f64; 2],
    span: WedgeSpan,
}

impl ReliefWedge {
    /// Positions of its two feet along the guide and of its edge, from its middle, mm.
    fn feet_and_edge(&self) -> ([f64; 2], f64) {
        let [before, after] = self.slopes.map(|slope| slope * self.height);
        let half = 0.5 * (before + after);
        ([-half, half], before - half)
    }
}

/// The flanks of a wedge and, unless it goes through, its ends.
fn wedge(element: &Element, wedge: ReliefWedge, site: &Site, lap: f64) -> Vec<Made> {
    let sign = element.way.sign();
    let (feet, edge) = wedge.feet_and_edge();
    let half = match (wedge.span, element.round) {
        // Half of the chord at its depth.
        (WedgeSpan::Through(_) | WedgeSpan::Ring, Some(round)) => {
            (wedge.height * (2.0 * round - wedge.height)).max(0.0).sqrt()
        }
        (WedgeSpan::Through(width) | WedgeSpan::Within(width), _) => 0.5 * width,
        (WedgeSpan::Ring, None) => return Vec::new(),
    };
    let is_trimmed = element.round.is_some();
    let mut made: Vec<Made> = [0, 1]
        .map(|side| {
            let (foot, slope) = (feet[side], wedge.slopes[side]);
            let toward = if side == 0 { -sign } else { sign };
            // Up the flank, and out of the solid.
            let rise = DVec2::new(edge - foot, sign * wedge.height);
            let normal = toward * site.along + slope * site.out;
            let up = rise.normalize();
            let frame = Site::frame(
                site.at(0.0, foot + 0.5 * rise.x, 0.5 * rise.y),
                normal.normalize(),
                up.x * site.along + up.y * site.out,
            );
            let region =
                Region::Rectangle { half_x: half + lap, half_y: 0.5 * rise.length() + lap };
            Made { shape: Shape::Flat(Flat::new(frame, region)), is_trimmed }
        })
        .into();
    let has_ends = match (wedge.span, element.way) {
        (WedgeSpan::Through(_), Way::Into) | (WedgeSpan::Ring, _) => false,
        (WedgeSpan::Through(_), Way::OutOf) | (WedgeSpan::Within(_), _) => true,
    };
    if has_ends {
        for side in [-1.0, 1.0] {
            let outline = [(feet[0], 0.0), (edge, sign * wedge.height), (feet[1], 0.0)];
            let corners = outline.map(|(along, out)| site.at(side * half, along, out));
            made.push(triangle(corners, side * sign * site.across, lap));
        }
    }
    made
}

/// A flat triangle with its front toward `normal`, larger by `lap`, mm.
fn triangle(corners: [DVec3; 3], normal: DVec3, lap: f64) -> Made {
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    let y = (corners[1] - middle).reject_from(normal).normalize();
    let frame = Site::frame(middle, normal, y);
    let mut local = corners.map(|corner| frame.point_to_local(corner).truncate());
    if signed_area(&local) < 0.0 {
        local.reverse();
    }
    // No edge is closer to the middle than a third of the height on the longest one.
    let longest = (0..3).map(|i| local[i].distance(local[(i + 1) % 3])).fold(0.0, f64::max);
    let nearest = 2.0 / 3.0 * signed_area(&local) / longest;
    let grown = local.map(|corner| (1.0 + lap / nearest) * corner).to_vec();
    Made::whole(Shape::Flat(Flat::new(frame, Region::polygon(grown))))
}

/// The four sides of a pyramid.
fn pyramid(size: DVec2, height: f64, way: Way, site: &Site, lap: f64) -> Vec<Made> {
    let (half, sign) = (0.5 * size, way.sign());
    let top = site.at(0.0, 0.0, sign * height);
    let corner = |x: f64, y: f64| site.at(x * half.x, y * half.y, 0.0);
    let sides = [
        ((-1.0, -1.0), (1.0, -1.0), -site.along, half.y),
        ((1.0, 1.0), (-1.0, 1.0), site.along, half.y),
        ((-1.0, 1.0), (-1.0, -1.0), -site.across, half.x),
        ((1.0, -1.0), (1.0, 1.0), site.across, half.x),
    ];
    sides
        .map(|(first, second, aside, reach)| {
            // Raised sides face away from the top, sunk ones toward it, both out of the wall.
            let normal = (sign * height * aside + reach * site.out).normalize();
            triangle([corner(first.0, first.1), top, corner(second.0, second.1)], normal, lap)
        })
        .into()
}

/// The flanks of a wedge all around a round wall: cones, and flat rings where a flank is upright.
fn rings(
    radius: f64,
    height: f64,
    slopes: &[f64; 2],
    way: Way,
    site: &Site,
    lap: f64,
) -> Vec<Made> {
    let wedge = ReliefWedge { height, slopes: *slopes, span: WedgeSpan::Ring };
    let (feet, edge) = wedge.feet_and_edge();
    let end = radius + way.sign() * height;
    let axis = |along: f64, z: DVec3| Site::frame(site.at(0.0, along, -radius), z, site.out);
    [(feet[0], edge, [radius, end]), (edge, feet[1], [end, radius])]
        .into_iter()
        .map(|(from, to, [first, last])| {
            let length = to - from;
            if length > 0.0 {
                // Longer at both ends, along its slant.
                let slope = (last - first) / length;
                let lap = lap / slope.hypot(1.0);
                let cone = Cone::new(
                    axis(from - lap, site.along),
                    first - lap * slope,
                    last + lap * slope,
                    length + 2.0 * lap,
                );
                return Made::whole(Shape::Cone(cone));
            }
            // Upright: the front faces along the guide where the radius falls.
            let z = if first > last { site.along } else { -site.along };
            let (inner, outer) = (first.min(last) - lap, first.max(last) + lap);
            let ring = Region::Annulus { inner, outer };
            Made::whole(Shape::Flat(Flat::new(axis(from, z), ring)))
        })
        .collect()
}
