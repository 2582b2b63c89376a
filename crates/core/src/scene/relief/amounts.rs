//! Amounts of an element: its area on the wall, and its volume in the solid.
//!
//! On flat walls they are in closed form. Where a ball or a saw cut meets a round wall there is
//! none, and they are sums over strips.

use crate::scene::pattern::element::{Cap, Element, ElementForm, Way, WedgeSpan};
use crate::scene::shape::ChartRect;
use glam::DVec2;
use lumiduct_base::math::planar::disk_overlap;
use std::f64::consts::{PI, TAU};

/// Number of strips for areas and volumes on round walls.
const STEPS: u32 = 128;

impl Element {
    /// Area of the footprint of an element of a row on the wall, mm².
    pub(crate) fn area(&self, place: f64) -> f64 {
        match (&self.form, self.round) {
            (ElementForm::Cap { size, height }, None) => {
                PI * Cap::new(size, height, place).rim.powi(2)
            }
            (
                ElementForm::Wedge {
                    span: WedgeSpan::Through(width) | WedgeSpan::Within(width),
                    ..
                },
                None,
            ) => width * self.length(place),
            (ElementForm::Wedge { span: WedgeSpan::Ring, .. }, Some(wall)) => {
                TAU * wall * self.length(place)
            }
            (ElementForm::Pyramid { width, length, .. }, _) => width * length,
            (ElementForm::Cap { .. } | ElementForm::Wedge { .. }, _) => {
                let half = 0.5 * self.length(place);
                self.integral(place, half, [-half, half], |v| 2.0 * self.half_width(place, v))
            }
        }
    }

    /// Area of the footprint, within a part of the wall, of an element with its middle at `at`,
    /// mm².
    pub(super) fn area_in(&self, place: f64, at: DVec2, rect: ChartRect) -> f64 {
        let rect = ChartRect { min: rect.min - at, max: rect.max - at };
        let half = 0.5 * self.length(place);
        match (&self.form, self.round) {
            (ElementForm::Cap { .. }, None) => return disk_overlap(half, &rect.corners()),
            (
                ElementForm::Cap { .. } | ElementForm::Wedge { span: WedgeSpan::Through(_), .. },
                Some(_),
            ) => {}
            // All others have a rectangular footprint.
            (ElementForm::Wedge { .. } | ElementForm::Pyramid { .. }, _) => {
                let reach = DVec2::new(self.half_width(place, self.edge(place)), half);
                return rect.intersection(&ChartRect { min: -reach, max: reach }).area();
            }
        }
        self.integral(place, half, [rect.min.y, rect.max.y], |v| {
            let width = self.half_width(place, v);
            (width.min(rect.max.x) - (-width).max(rect.min.x)).max(0.0)
        })
    }

    /// Volume that an element of a row removes from the solid or adds to it, mm³.
    pub(crate) fn volume(&self, place: f64) -> f64 {
        match (&self.form, self.round) {
            // Archimedes' cap.
            (ElementForm::Cap { size, height }, None) => {
                let Cap { radius, height, .. } = Cap::new(size, height, place);
                PI * height * height * (radius - height / 3.0)
            }
            (ElementForm::Cap { size, height }, Some(wall)) => {
                let cap = Cap::new(size, height, place);
                let c = cap.center_from_axis(wall, self.way);
                self.integral(place, cap.rim, [-cap.rim, cap.rim], |v| {
                    let disk = ((cap.radius - v) * (cap.radius + v)).max(0.0).sqrt();
                    let shared = lens(disk, wall, c);
                    match self.way {
                        Way::Into => shared,
                        Way::OutOf => PI * disk * disk - shared,
                    }
                })
            }
            (
                ElementForm::Wedge {
                    span: WedgeSpan::Through(width) | WedgeSpan::Within(width),
                    ..
                },
                None,
            ) => 0.5 * width * self.height(place) * self.length(place),
            // Pappus: the centre of the triangle lies a third of its height from the wall.
            (ElementForm::Wedge { span: WedgeSpan::Ring, .. }, Some(wall)) => {
                let (height, length) = (self.height(place), self.length(place));
                PI * (wall + self.way.sign() * height / 3.0) * height * length
            }
            (ElementForm::Wedge { .. }, _) => {
                let wall = self.round.unwrap_or(f64::INFINITY);
                let (height, length) = (self.height(place), self.length(place));
                // Chords times the remaining length at their depth.
                let half = 0.5 * height;
                self.integral(place, half, [-half, half], |from_middle| {
                    let depth = 0.5 * height + from_middle;
                    let chord = 2.0 * (depth * (2.0 * wall - depth)).max(0.0).sqrt();
                    chord * length * (1.0 - depth / height)
                })
            }
            (ElementForm::Pyramid { width, length, .. }, _) => {
                width * length * self.height(place) / 3.0
            }
        }
    }

    /// The integral over a part of [-half, half] of a function that may fall to 0 at the ends like
    /// a square root, and may have a kink at the edge of the element.
    fn integral(&self, place: f64, half: f64, part: [f64; 2], of: impl Fn(f64) -> f64) -> f64 {
        // v = half sin θ, by the middles of equal steps of θ on either side of the edge.
        let angle = |v: f64| (v / half).clamp(-1.0, 1.0).asin();
        let [from, to] = part.map(angle);
        let edge = angle(self.edge(place)).clamp(from, to);
        let piece = |from: f64, to: f64| {
            let step = (to - from) / f64::from(STEPS);
            let at = |i: u32| from + (f64::from(i) + 0.5) * step;
            let sum: f64 = (0..STEPS).map(|i| of(half * at(i).sin()) * at(i).cos()).sum();
            sum * step * half
        };
        piece(from, edge) + piece(edge, to)
    }
}

/// Area that two disks with their middles a distance apart share, mm².
fn lens(one: f64, other: f64, apart: f64) -> f64 {
    if apart >= one + other {
        return 0.0;
    }
    if apart <= (one - other).abs() {
        return PI * one.min(other).powi(2);
    }
    // Distances of the common chord from the two middles.
    let to_chord = 0.5 * (apart * apart + (one - other) * (one + other)) / apart;
    // For the turn x to the chord's ends: r² (x - sin x)/2.
    let segment = |radius: f64, distance: f64| {
        let half = ((radius - distance) * (radius + distance)).max(0.0).sqrt();
        0.5 * radius * radius * less_its_sine(2.0 * half.atan2(distance))
    };
    segment(one, to_chord) + segment(other, apart - to_chord)
}

/// x - sin x, accurate where both are nearly equal.
fn less_its_sine(x: f64) -> f64 {
    if x > 0.3 {
        return x - x.sin();
    }
    let x2 = x * x;
    x * x2 / 6.0 * (1.0 - x2 / 20.0 * (1.0 - x2 / 42.0 * (1.0 - x2 / 72.0 * (1.0 - x2 / 110.0))))
}
