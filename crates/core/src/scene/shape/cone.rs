//! The wall of a cone frustum, or of a sector of one.

use crate::scene::Ray;
use crate::scene::shape::wedge::{Wedge, arc_bounds, azimuth, point_on_circle, turn};
use crate::scene::shape::{ChartRect, Crossing, RayStart, Toward};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame, quadratic};

/// A piece of a cone's wall between two cross-sections; the front is outside unless it has been turned
/// `Self::inward`.
///
/// The chart: u = (mean radius) φ from the frame's x axis; v = z along the axis, not along the slant, so that the
/// charts of a taper and of the straight legs before and behind it join. Hence a cell's area is not its size.
#[derive(Debug, Clone)]
pub struct Cone {
    frame: Frame,
    radius_start: f64,
    radius_end: f64,
    length: f64,
    /// Growth of the radius per length.
    slope: f64,
    /// The side toward which a ray passes as it leaves the cone.
    leaving: Toward,
    wedge: Option<Wedge>,
}

impl Cone {
    /// The wall about the z axis of `frame` with radius `radius_start` at z = 0 and `radius_end` at
    /// z = `length`, mm. Neither radius is negative, and at least one is positive.
    pub(crate) fn new(frame: Frame, radius_start: f64, radius_end: f64, length: f64) -> Self {
        let slope = (radius_end - radius_start) / length;
        let leaving = Toward::Front;
        Self { frame, radius_start, radius_end, length, slope, leaving, wedge: None }
    }

    /// The part of [`Self::new`] with azimuths from the frame's x axis counter-clockwise to `angle`, rad.
    pub(crate) fn sector(
        frame: Frame,
        radius_start: f64,
        radius_end: f64,
        length: f64,
        angle: f64,
    ) -> Self {
        let wedge = Wedge::new(angle);
        Self { wedge, ..Self::new(frame, radius_start, radius_end, length) }
    }

    /// The same wall with its front toward the axis.
    pub(crate) fn inward(self) -> Self {
        Self { leaving: Toward::Back, ..self }
    }

    pub(super) fn bounds(&self) -> Aabb {
        let arc = |radius, z| arc_bounds(&self.frame, radius, z, self.wedge.as_ref());
        arc(self.radius_start, 0.0).union(arc(self.radius_end, self.length))
    }

    /// The cone is across² = w² with w = `radius_start` + slope · z. The gradient of half the
    /// difference of the two sides points outward on the nappe w > 0, which is the only one with z
    /// in [0, length].
    #[inline]
    pub(super) fn crossings(&self, ray: &Ray, start: RayStart, mut visit: impl FnMut(Crossing)) {
        let axis = self.frame.z;
        let from = ray.origin() - self.frame.origin;
        let (along_origin, along_dir) = (from.dot(axis), ray.dir().dot(axis));
        let across_origin = from - along_origin * axis;
        let across_dir = ray.dir() - along_dir * axis;
        let (w_origin, w_dir) =
            (self.radius_start + self.slope * along_origin, self.slope * along_dir);
        let across = across_dir.length();
        // As a product: a ray along the slant has nearly equal terms.
        let a = (across - w_dir) * (across + w_dir);
        let half_b = across_origin.dot(across_dir) - w_origin * w_dir;
        let mut offer = |t: f64, toward: Toward| {
            let z = along_origin + t * along_dir;
            // An infinite or NaN t fails here: its z is NaN, or outside.
            if z >= 0.0
                && z <= self.length
                && t.is_finite()
                && self.wedge.is_none_or(|wedge| wedge.contains(self.across(ray.at(t))))
            {
                visit(Crossing { t, toward });
            }
        };
        match start {
            // The constant term is 0: the other root is -2b/a, where the slope of the quadratic, a t + b, is -b.
            RayStart::On => {
                let t = -2.0 * half_b / a;
                offer(t, if half_b < 0.0 { self.leaving } else { self.leaving.opposite() });
            }
            RayStart::Elsewhere => {
                if a == 0.0 && half_b == 0.0 {
                    return;
                }
                let c = across_origin.length_squared() - w_origin * w_origin;
                if let Some([first, second]) = quadratic(a, half_b, c) {
                    // The quadratic decreases through its first root when it opens upward.
                    let at_first =
                        if a.is_sign_positive() { self.leaving.opposite() } else { self.leaving };
                    offer(first, at_first);
                    offer(second, at_first.opposite());
                }
            }
        }
    }

    /// The frame's x and y of a point.
    #[inline]
    fn across(&self, p: DVec3) -> DVec2 {
        let from = p - self.frame.origin;
        DVec2::new(from.dot(self.frame.x), from.dot(self.frame.y))
    }

    /// Unit vector of the axis.
    pub(super) fn axis(&self) -> DVec3 {
        self.frame.z
    }

    #[inline]
    pub(super) fn normal(&self, p: DVec3) -> DVec3 {
        let from = p - self.frame.origin;
        let radial = (from - from.dot(self.frame.z) * self.frame.z).normalize();
        let outward = (radial - self.slope * self.frame.z).normalize();
        match self.leaving {
            Toward::Front => outward,
            Toward::Back => -outward,
        }
    }

    pub(super) fn area(&self) -> f64 {
        self.area_in(self.chart_bounds())
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        let (start, end) = (self.radius_start, self.radius_end);
        // The area below a radius w is proportional to w² - start²; z = (w - start) / slope without
        // the division by 0.
        let w = (start * start + u[1] * (end * end - start * start)).sqrt();
        let z = self.length * u[1] * (start + end) / (start + w);
        point_on_circle(&self.frame, w, u[0] * turn(self.wedge.as_ref()), z)
    }

    pub(super) fn chart(&self, p: DVec3) -> DVec2 {
        let across = self.across(p);
        let azimuth = self.wedge.map_or_else(|| azimuth(across), |wedge| wedge.azimuth(across));
        DVec2::new(self.mean_radius() * azimuth, (p - self.frame.origin).dot(self.frame.z))
    }

    pub(super) fn chart_bounds(&self) -> ChartRect {
        let turn = turn(self.wedge.as_ref());
        ChartRect { min: DVec2::ZERO, max: DVec2::new(self.mean_radius() * turn, self.length) }
    }

    /// ∫∫ w sqrt(1 + slope²) dφ dz.
    pub(super) fn area_in(&self, rect: ChartRect) -> f64 {
        let rect = rect.intersection(&self.chart_bounds());
        if rect.is_empty() {
            return 0.0;
        }
        let mean = self.radius_start + 0.5 * self.slope * (rect.min.y + rect.max.y);
        rect.area() * mean / self.mean_radius() * self.slope.hypot(1.0)
    }

    fn mean_radius(&self) -> f64 {
        0.5 * (self.radius_start + self.radius_end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    fn frame() -> Frame {
        Frame::from_axis(DVec3::new(0.4, -0.2, 1.0), DVec3::new(0.2, -0.5, 0.6))
    }

    fn crossings(cone: &Cone, ray: &Ray, start: RayStart) -> Vec<Crossing> {
        let mut found = Vec::new();
        cone.crossings(ray, start, |crossing| found.push(crossing));
        found.sort_by(|a, b| a.t.total_cmp(&b.t));
        found
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(31), cases: 2000, ..ProptestConfig::default() })]

        /// Two random points of the wall: the line through them crosses at both, in at one and out
        /// at the other as given by the normals. From either one the other is found, without the
        /// start.
        #[test]
        fn a_chord_between_two_points_of_the_wall_is_found_from_either_end(
            u in proptest::array::uniform4(0.0..1.0f64), end in 0.0..4.0f64, angle in 1.0..7.0f64,
        ) {
            for cone in [
                Cone::sector(frame(), 2.0, end, 3.0, angle),
                Cone::sector(frame(), 2.0, end, 3.0, angle).inward(),
            ] {
                let (p, q) = (cone.sample([u[0], u[1]]), cone.sample([u[2], u[3]]));
                prop_assume!((p - q).length() > 1e-2);
                let ray = Ray::new(p, q - p);
                prop_assume!(cone.normal(p).dot(ray.dir()).abs() > 1e-3);
                prop_assume!(cone.normal(q).dot(ray.dir()).abs() > 1e-3);
                let from_outside = crossings(&cone, &ray.advanced(-7.0), RayStart::Elsewhere);
                prop_assert_eq!(from_outside.len(), 2);
                for (crossing, point) in from_outside.iter().zip([p, q]) {
                    prop_assert!((ray.at(crossing.t - 7.0) - point).length() < 1e-9);
                    prop_assert_eq!(crossing.toward, Toward::of(ray.dir(), cone.normal(point)));
                }
                let on = crossings(&cone, &ray, RayStart::On);
                prop_assert_eq!(on.len(), 1);
                prop_assert!((ray.at(on[0].t) - q).length() < 1e-9);
                prop_assert_eq!(on[0].toward, from_outside[1].toward);
            }
        }
    }

    #[test]
    fn a_ray_along_the_slant_crosses_once_and_the_other_nappe_is_not_there() {
        let cone = Cone::new(Frame::WORLD, 2.0, 0.25, 1.75);
        // Slope -1: this ray is parallel to the generator through (2, 0, 0).
        let ray = Ray::new(DVec3::new(1.0, 0.0, 0.0), DVec3::new(-1.0, 0.0, 1.0));
        let found = crossings(&cone, &ray, RayStart::Elsewhere);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((ray.at(found[0].t) - DVec3::new(-0.5, 0.0, 1.5)).length() < 1e-14);
        assert_eq!(found[0].toward, Toward::Front);
        // Beyond the apex, z > 2, lies the other nappe; the wall ends before it.
        let across = Ray::new(DVec3::new(-9.0, 0.0, 3.0), DVec3::X);
        assert!(crossings(&cone, &across, RayStart::Elsewhere).is_empty());
    }

    #[test]
    fn areas_of_cells_add_up_and_samples_follow_them() {
        for (cone, area) in [
            (Cone::new(frame(), 3.0, 1.0, 2.0), 0.5 * TAU * 4.0 * 8.0f64.sqrt()),
            (Cone::sector(frame(), 0.0, 3.0, 4.0, 2.0), 0.5 * 2.0 * 3.0 * 5.0),
            (Cone::new(frame(), 1.0, 1.0 + 1e-14, 4.0), TAU * 4.0),
        ] {
            assert!((cone.area() - area).abs() < 1e-12 * area);
            let (n, samples, bounds) = (4u32, 40_000u32, cone.chart_bounds());
            let step = bounds.max / f64::from(n);
            let mut counts = [0u32; 16];
            for i in 0..samples {
                let golden = (f64::from(i) * 0.618_033_988_749_894_9).fract();
                let p = cone.sample([(f64::from(i) + 0.5) / f64::from(samples), golden]);
                let cell = (cone.chart(p) / step).floor().clamp(DVec2::ZERO, DVec2::splat(3.0));
                counts[(cell.y as u32 * n + cell.x as u32) as usize] += 1;
            }
            let mut sum = 0.0;
            for (i, &count) in (0u32..).zip(&counts) {
                let min = step * DVec2::new(f64::from(i % n), f64::from(i / n));
                let part = cone.area_in(ChartRect { min, max: min + step });
                assert!((f64::from(count) / f64::from(samples) - part / area).abs() < 1e-3);
                sum += part;
            }
            assert!((sum - area).abs() < 1e-12 * area);
        }
    }
}
