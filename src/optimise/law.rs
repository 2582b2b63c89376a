//! A length along a face as a function of few values: straight lines, or a monotone spline.
//!
//! The spline has the slopes of Fritsch & Butland, "A method for constructing local monotone piecewise cubic interpolants",
//! SIAM J. Sci. Stat. Comput. 5 (1984) 300: it rises and falls only where its points do.

use lumiduct_input::LawKind;

/// Points along a face whose values a law joins.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SizeLaw {
    /// Positions of the points, mm, increasing.
    pub(crate) points: Vec<f64>,
    kind: LawKind,
}

impl SizeLaw {
    /// The law of a kind over zones at these positions, mm, increasing, at least two; a spline goes from the first to the last
    /// element of the pattern, at the positions `ends`.
    pub(crate) fn over(kind: LawKind, zones: &[f64], ends: [f64; 2]) -> Self {
        let points = match kind {
            LawKind::Spline(count) => {
                let last_point = (count.max(2) - 1) as f64;
                let share = |place: usize| place as f64 / last_point;
                let [first, last] = ends;
                (0..count.max(2)).map(|place| first + (last - first) * share(place)).collect()
            }
            LawKind::Table => zones.to_vec(),
        };
        Self { points, kind }
    }

    /// The length at a position, mm; constant beyond the ends.
    pub(crate) fn at(&self, values: &[f64], place: f64) -> f64 {
        let points = &self.points;
        let next = points.partition_point(|own| *own <= place);
        if next == 0 {
            return values.first().copied().unwrap_or(0.0);
        }
        if next >= points.len() {
            return values.last().copied().unwrap_or(0.0);
        }
        let width = points[next] - points[next - 1];
        let t = (place - points[next - 1]) / width;
        let [before, after] = [values[next - 1], values[next]];
        match self.kind {
            LawKind::Table => before + t * (after - before),
            LawKind::Spline(_) => {
                let [rise, fall] = [next - 1, next].map(|point| width * self.slope(values, point));
                let (t2, t3) = (t * t, t * t * t);
                before * (2.0 * t3 - 3.0 * t2 + 1.0)
                    + rise * (t3 - 2.0 * t2 + t)
                    + after * (3.0 * t2 - 2.0 * t3)
                    + fall * (t3 - t2)
            }
        }
    }

    /// Slope at a point: the weighted harmonic mean of those of its intervals, or 0 at a turning point.
    fn slope(&self, values: &[f64], point: usize) -> f64 {
        let secant = |from: usize| {
            let width = self.points[from + 1] - self.points[from];
            ((values[from + 1] - values[from]) / width, width)
        };
        if point == 0 {
            return secant(0).0;
        }
        if point + 1 == self.points.len() {
            return secant(point - 1).0;
        }
        let ([left, right], [before, after]) = {
            let (own, other) = (secant(point - 1), secant(point));
            ([own.0, other.0], [own.1, other.1])
        };
        if left * right <= 0.0 {
            return 0.0;
        }
        let share = (before + 2.0 * after) / (3.0 * (before + after));
        left * right / (share * right + (1.0 - share) * left)
    }

    /// Shares of the points in the length at a position: those of a straight line between the two beside it.
    pub(crate) fn shares(&self, place: f64) -> Vec<f64> {
        let mut shares = vec![0.0; self.points.len()];
        let next = self.points.partition_point(|own| *own <= place);
        match (next.checked_sub(1), self.points.get(next)) {
            (Some(before), Some(after)) => {
                let width = after - self.points[before];
                let share = (place - self.points[before]) / width;
                (shares[before], shares[next]) = (1.0 - share, share);
            }
            (Some(only), None) => shares[only] = 1.0,
            (None, _) => shares[0] = 1.0,
        }
        shares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spline_meets_its_points_and_never_overshoots() {
        let zones: Vec<f64> = (0..41).map(|place| 10.0 * f64::from(place)).collect();
        let law = SizeLaw::over(LawKind::Spline(6), &zones, [0.0, 400.0]);
        assert_eq!(law.points, [0.0, 80.0, 160.0, 240.0, 320.0, 400.0]);
        let values = [3.0, 3.0, 9.0, 9.5, 2.0, 1.0];
        for (point, value) in law.points.iter().zip(values) {
            assert!((law.at(&values, *point) - value).abs() < 1e-12);
        }
        for step in 0..4000 {
            let place = 0.1 * f64::from(step);
            let interval = law.points.partition_point(|own| *own <= place).clamp(1, 5);
            let [low, high] = {
                let pair = [values[interval - 1], values[interval]];
                [pair[0].min(pair[1]), pair[0].max(pair[1])]
            };
            let found = law.at(&values, place);
            assert!((low - 1e-12..=high + 1e-12).contains(&found), "{found} at {place}");
        }
        assert_eq!((law.at(&values, -5.0), law.at(&values, 999.0)), (3.0, 1.0));
    }

    #[test]
    fn a_straight_line_is_kept_by_both_laws() {
        let zones = [0.0, 1.0, 4.0, 9.0];
        for kind in [LawKind::Table, LawKind::Spline(5)] {
            let law = SizeLaw::over(kind, &zones, [0.0, 9.0]);
            let values: Vec<f64> = law.points.iter().map(|at| 2.0 + 0.5 * at).collect();
            for place in [0.3, 2.0, 7.7] {
                assert!((law.at(&values, place) - 2.0 - 0.5 * place).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn the_points_beside_a_place_share_it() {
        let zones = [0.0, 10.0, 20.0];
        let table = SizeLaw::over(LawKind::Table, &zones, [-5.0, 25.0]);
        assert_eq!((&table.points, table.shares(10.0)), (&zones.to_vec(), vec![0.0, 1.0, 0.0]));
        let spline = SizeLaw::over(LawKind::Spline(3), &zones, [-5.0, 25.0]);
        assert_eq!(spline.points, [-5.0, 10.0, 25.0]);
        assert!((spline.shares(0.0)[0] - 2.0 / 3.0).abs() < 1e-12);
        assert_eq!([spline.shares(-9.0), spline.shares(25.0)], [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    }
}
