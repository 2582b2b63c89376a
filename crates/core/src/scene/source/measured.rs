//! Emission by a measured distribution of luminous intensity.
//!
//! A table over half-planes C and angles γ, linear in both between its nodes. Directions are drawn by exact inversion of its
//! marginals, so that stratified points stay stratified.

use glam::DVec3;
use lumiduct_base::math::linear_over_ring;
use std::f64::consts::TAU;

/// A distribution over directions: γ is the angle to +z, the nadir of a luminaire; C is 0 toward +x and, counter-clockwise as seen
/// from the zenith, 90° toward -y (LM-63-2002, section 3; CIE 121:1996).
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredEmission {
    /// The whole circle from 0, rad; one plane for a distribution that is the same in all.
    planes: Vec<f64>,
    /// Increasing, rad.
    angles: Vec<f64>,
    /// Density by plane and angle, 1/sr.
    density: Vec<f64>,
    /// ∫ density · sin γ dγ up to each angle, by plane, 1/rad.
    up_to_angle: Vec<f64>,
    /// Share of the flux up to each plane, 1; the last is 1.
    up_to_plane: Vec<f64>,
    /// The largest density, 1/sr: peak intensity over flux.
    peak: f64,
}

impl MeasuredEmission {
    /// Planes from 0 and angles within 0 to π, both increasing, in rad, and intensities plane by plane in any unit, none negative. `None`
    /// if there is no light.
    ///
    /// # Panics
    ///
    /// If the numbers do not match.
    pub fn new(planes: Vec<f64>, angles: Vec<f64>, intensities: Vec<f64>) -> Option<Self> {
        assert_eq!(intensities.len(), planes.len() * angles.len(), "an intensity for each node");
        assert_eq!(planes[0], 0.0, "planes begin at 0");
        let mut up_to_angle = Vec::with_capacity(intensities.len());
        for own in intensities.chunks(angles.len()) {
            let mut sum = 0.0;
            up_to_angle.push(0.0);
            for (ends, values) in angles.windows(2).zip(own.windows(2)) {
                sum += linear_over_ring([ends[0], ends[1]], [values[0], values[1]]);
                up_to_angle.push(sum);
            }
        }
        let mut table = Self {
            planes,
            angles,
            density: intensities,
            up_to_angle,
            up_to_plane: vec![0.0],
            peak: 0.0,
        };
        let mut flux = 0.0;
        for place in 0..table.planes.len() {
            let (next, width) = table.after(place);
            flux += 0.5 * width * (table.of_plane(place) + table.of_plane(next));
            table.up_to_plane.push(flux);
        }
        if !flux.is_finite() || flux <= 0.0 {
            return None;
        }
        for numbers in [&mut table.density, &mut table.up_to_angle, &mut table.up_to_plane] {
            numbers.iter_mut().for_each(|number| *number /= flux);
        }
        table.peak = table.density.iter().copied().fold(0.0, f64::max);
        Some(table)
    }

    /// The largest density, 1/sr: peak intensity over flux.
    pub(crate) fn peak(&self) -> f64 {
        self.peak
    }

    /// The largest angle to +z at which there may be light, rad.
    pub fn widest(&self) -> f64 {
        self.angles[self.angles.len() - 1]
    }

    /// Whether it is the same in all planes.
    pub fn is_rotational(&self) -> bool {
        self.planes.len() == 1
    }

    /// A direction in proportion to the flux.
    pub(crate) fn sample(&self, [across, along]: [f64; 2]) -> DVec3 {
        let whole = self.up_to_plane[self.planes.len()];
        let wanted = across * whole;
        let place = self.up_to_plane.partition_point(|share| *share <= wanted) - 1;
        let place = place.min(self.planes.len() - 1);
        let (next, width) = self.after(place);
        let [first, last] = [self.of_plane(place), self.of_plane(next)];
        let share = within_line([first, last], (wanted - self.up_to_plane[place]) / width);
        let plane = self.planes[place] + share * width;

        let mixed = |numbers: &[f64], angle: usize| {
            let of = |plane: usize| numbers[plane * self.angles.len() + angle];
            of(place) + share * (of(next) - of(place))
        };
        let wanted = along * (first + share * (last - first));
        // The last segment that begins at or below the wanted share.
        let (mut low, mut high) = (0, self.angles.len() - 1);
        while high - low > 1 {
            let middle = low.midpoint(high);
            if mixed(&self.up_to_angle, middle) <= wanted { low = middle } else { high = middle }
        }
        let ends = [self.angles[low], self.angles[high]];
        let values = [low, high].map(|angle| mixed(&self.density, angle));
        let angle = within_ring(ends, values, wanted - mixed(&self.up_to_angle, low));
        let (sin, cos) = angle.sin_cos();
        DVec3::new(sin * plane.cos(), -sin * plane.sin(), cos)
    }

    /// Density with which a unit vector is drawn, 1/sr.
    pub(crate) fn density(&self, dir: DVec3) -> f64 {
        let angle = dir.truncate().length().atan2(dir.z);
        let plane = (-dir.y).atan2(dir.x).rem_euclid(TAU);
        let angles = &self.angles;
        if !(angles[0]..=angles[angles.len() - 1]).contains(&angle) {
            return 0.0;
        }
        let low = angles.partition_point(|own| *own <= angle).clamp(1, angles.len() - 1) - 1;
        let along = (angle - angles[low]) / (angles[low + 1] - angles[low]);
        let of_plane = |place: usize| {
            let own = &self.density[place * angles.len() + low..];
            own[0] + along * (own[1] - own[0])
        };
        let place = self.planes.partition_point(|own| *own <= plane).max(1) - 1;
        let (next, width) = self.after(place);
        let across = (plane - self.planes[place]) / width;
        of_plane(place) + across * (of_plane(next) - of_plane(place))
    }

    /// ∫ density · sin γ dγ over a plane, 1/rad.
    fn of_plane(&self, place: usize) -> f64 {
        self.up_to_angle[(place + 1) * self.angles.len() - 1]
    }

    /// The plane after one, around the circle, and its distance, rad.
    fn after(&self, place: usize) -> (usize, f64) {
        match self.planes.get(place + 1) {
            Some(next) => (place + 1, next - self.planes[place]),
            None => (0, self.planes[0] + TAU - self.planes[place]),
        }
    }
}

/// Where in 0 to 1 the integral of a linear function with these values at the ends reaches `wanted`.
fn within_line([first, last]: [f64; 2], wanted: f64) -> f64 {
    let root = (first * first + 2.0 * (last - first) * wanted).max(0.0).sqrt();
    // The root without cancellation; 0 where there is no light.
    if first + root > 0.0 { (2.0 * wanted / (first + root)).clamp(0.0, 1.0) } else { 0.0 }
}

/// Where in an interval the integral of [`linear_over_ring`] reaches `wanted`: Newton's method within a bracket.
fn within_ring([from, to]: [f64; 2], [first, last]: [f64; 2], wanted: f64) -> f64 {
    /// Steps that suffice by bisection alone.
    const STEPS: usize = 60;
    let slope = (last - first) / (to - from);
    let (mut low, mut high) = (from, to);
    let mut angle = 0.5 * (from + to);
    for _ in 0..STEPS {
        let value = first + slope * (angle - from);
        let excess = linear_over_ring([from, angle], [first, value]) - wanted;
        if excess < 0.0 {
            low = angle;
        } else {
            high = angle;
        }
        let next = angle - excess / (value * angle.sin());
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - angle).abs() <= f64::EPSILON * to {
            return next;
        }
        angle = next;
    }
    angle
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> MeasuredEmission {
        let planes = [0.0, 1.0, 2.5, 4.0].to_vec();
        let angles = [0.0, 0.4, 1.0, 1.5].to_vec();
        let intensities =
            vec![5.0, 4.0, 1.0, 0.0, 5.0, 9.0, 0.0, 2.0, 5.0, 0.0, 0.0, 0.0, 5.0, 1.0, 3.0, 1.0];
        MeasuredEmission::new(planes, angles, intensities).unwrap()
    }

    #[test]
    fn a_table_of_a_cosine_is_a_lambertian_emitter() {
        let angles: Vec<f64> = (0..=900).map(|n| f64::from(n) * 0.1f64.to_radians()).collect();
        let intensities = angles.iter().map(|angle| angle.cos().max(0.0)).collect();
        let table = MeasuredEmission::new(vec![0.0], angles, intensities).unwrap();
        assert!(table.is_rotational() && (table.peak() * std::f64::consts::PI - 1.0).abs() < 1e-6);
        for u in [0.01, 0.3, 0.9] {
            // sin²γ is uniform.
            let dir = table.sample([0.25, u]);
            assert!((dir.truncate().length_squared() - u).abs() < 1e-5, "{dir}");
            assert!((table.density(dir) - dir.z / std::f64::consts::PI).abs() < 1e-5);
            assert!(dir.x.abs() < 1e-12 && dir.y < 0.0, "C90 is toward -y: {dir}");
        }
    }

    #[test]
    fn directions_follow_the_density_to_the_last_digit() {
        // The share of the light below a drawn plane and angle, by a fine sum of the density, is what was drawn.
        let table = table();
        for u in [[0.1, 0.2], [0.35, 0.5], [0.5, 0.9], [0.99, 0.01]] {
            let dir = table.sample(u);
            let plane = (-dir.y).atan2(dir.x).rem_euclid(TAU);
            let steps = 400;
            let middle = |n: usize, range: f64| (n as f64 + 0.5) * range / steps as f64;
            let mut below = 0.0;
            for (c, g) in
                (0..steps * steps).map(|n| (middle(n / steps, plane), middle(n % steps, 1.5)))
            {
                let dir = DVec3::new(g.sin() * c.cos(), -g.sin() * c.sin(), g.cos());
                below += table.density(dir) * g.sin() * plane * 1.5 / (steps * steps) as f64;
            }
            assert!((below - u[0]).abs() < 1e-4, "{below}, {u:?}");
            let angle = dir.truncate().length().atan2(dir.z);
            let of_angle = |to: f64| -> f64 {
                let at = |g: f64| {
                    table.density(DVec3::new(
                        g.sin() * plane.cos(),
                        -g.sin() * plane.sin(),
                        g.cos(),
                    ))
                };
                (0..20_000)
                    .map(|n| (f64::from(n) + 0.5) * to / 20_000.0)
                    .map(|g| at(g) * g.sin() * to / 20_000.0)
                    .sum()
            };
            assert!((of_angle(angle) / of_angle(1.5) - u[1]).abs() < 1e-4, "{u:?}");
        }
        assert_eq!(table.density(-DVec3::Z), 0.0);
    }

    #[test]
    fn ends_of_the_unit_square_are_directions_and_darkness_is_no_table() {
        for u in [
            [0.0, 0.0],
            [1.0f64.next_down(); 2],
            [0.0, 1.0f64.next_down()],
            [1.0f64.next_down(), 0.0],
        ] {
            assert!(table().sample(u).is_normalized(), "{u:?}");
        }
        assert_eq!(MeasuredEmission::new(vec![0.0], vec![0.0, 1.0], vec![0.0; 2]), None);
    }
}
