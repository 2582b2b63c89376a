//! The unrolled wall of a cylinder that planes have cut: an area between sinusoids of the azimuth, in closed form.

use crate::scene::shape::HalfSpace;
use lumiduct_base::math::Frame;
use std::f64::consts::TAU;

/// The part of a cylinder's wall below all ceilings and above all floors.
#[derive(Debug, Clone)]
pub(super) struct UnrolledWall {
    floors: Vec<Wave>,
    ceilings: Vec<Wave>,
}

/// A height over the azimuth φ: mean + cos · cos φ + sin · sin φ, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Wave {
    mean: f64,
    cos: f64,
    sin: f64,
}

/// A range of azimuths between one floor and one ceiling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Strip {
    /// First azimuth, rad.
    from: f64,
    /// Last azimuth, rad.
    to: f64,
    floor: Wave,
    ceiling: Wave,
}

impl UnrolledWall {
    /// The wall of `radius` about the z axis of `frame` with z in `heights`, inside all `cuts`.
    pub(super) fn new(frame: &Frame, radius: f64, heights: [f64; 2], cuts: &[HalfSpace]) -> Self {
        let level = |mean: f64| Wave { mean, cos: 0.0, sin: 0.0 };
        let mut unrolled =
            Self { floors: vec![level(heights[0])], ceilings: vec![level(heights[1])] };
        for cut in cuts {
            let normal = frame.to_local(cut.normal);
            // A plane along the axis is replaced by one tilted by 1e-12 rad: far below any area
            // that matters.
            let slope = if normal.z.abs() < 1e-12 { 1e-12f64.copysign(normal.z) } else { normal.z };
            let wave = Wave {
                mean: (cut.offset - cut.normal.dot(frame.origin)) / slope,
                cos: -radius * normal.x / slope,
                sin: -radius * normal.y / slope,
            };
            if slope > 0.0 { unrolled.ceilings.push(wave) } else { unrolled.floors.push(wave) }
        }
        unrolled
    }

    /// The wall for azimuths in [`from`, `to`] within [0, 2π], divided so that floor and ceiling
    /// are the same waves over a whole strip.
    pub(super) fn strips(&self, from: f64, to: f64) -> Vec<Strip> {
        let waves: Vec<Wave> = self.floors.iter().chain(&self.ceilings).copied().collect();
        let mut breaks = vec![from, to];
        for (i, one) in waves.iter().enumerate() {
            for other in &waves[i + 1..] {
                breaks.extend(one.minus(other).zeros().filter(|phi| *phi > from && *phi < to));
            }
        }
        breaks.sort_by(f64::total_cmp);
        breaks
            .windows(2)
            .filter_map(|ends| {
                let at = 0.5 * (ends[0] + ends[1]);
                let by_height = |a: &&Wave, b: &&Wave| a.at(at).total_cmp(&b.at(at));
                let floor = *self.floors.iter().max_by(by_height)?;
                let ceiling = *self.ceilings.iter().min_by(by_height)?;
                (ceiling.at(at) > floor.at(at)).then_some(Strip {
                    from: ends[0],
                    to: ends[1],
                    floor,
                    ceiling,
                })
            })
            .collect()
    }
}

impl Strip {
    /// Area over the unit circle, mm: times the radius it is the area of the wall.
    pub(super) fn area(&self) -> f64 {
        self.area_to(self.to)
    }

    /// The azimuth below which the `share` of the strip's area lies, rad.
    pub(super) fn azimuth_of_share(&self, share: f64) -> f64 {
        let target = share * self.area();
        let (mut low, mut high) = (self.from, self.to);
        // The area grows with the azimuth: 53 halvings exhaust the digits of an f64.
        for _ in 0..53 {
            let middle = 0.5 * (low + high);
            if self.area_to(middle) < target { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Lowest and highest z at an azimuth, mm.
    pub(super) fn heights(&self, azimuth: f64) -> [f64; 2] {
        [self.floor.at(azimuth), self.ceiling.at(azimuth)]
    }

    fn area_to(&self, to: f64) -> f64 {
        self.ceiling.minus(&self.floor).integral(self.from, to)
    }
}

impl Wave {
    fn at(&self, azimuth: f64) -> f64 {
        let (sin, cos) = azimuth.sin_cos();
        self.mean + self.cos * cos + self.sin * sin
    }

    fn minus(&self, other: &Self) -> Self {
        Self { mean: self.mean - other.mean, cos: self.cos - other.cos, sin: self.sin - other.sin }
    }

    fn integral(&self, from: f64, to: f64) -> f64 {
        let ((sin_a, cos_a), (sin_b, cos_b)) = (from.sin_cos(), to.sin_cos());
        self.mean * (to - from) + self.cos * (sin_b - sin_a) - self.sin * (cos_b - cos_a)
    }

    /// The azimuths in [0, 2π] where the wave is 0; none when it is 0 everywhere or nowhere.
    fn zeros(&self) -> impl Iterator<Item = f64> {
        let amplitude = self.cos.hypot(self.sin);
        let crest = self.sin.atan2(self.cos);
        // NaN, which drops out below, if the wave never reaches 0.
        let half_width = (-self.mean / amplitude).acos();
        [crest - half_width, crest + half_width]
            .into_iter()
            .filter(|phi| phi.is_finite())
            .map(|phi| phi.rem_euclid(TAU))
    }
}
