//! A value against the angle of incidence, linear between the angles of a table. It does not know
//! finishes or indices.

use std::f64::consts::FRAC_PI_2;

/// A table over angles of incidence from 0 to 90 deg.
#[derive(Debug, Clone, PartialEq)]
pub struct AngleTable {
    /// Angle, rad, and value, 1.
    rows: Vec<[f64; 2]>,
}

impl AngleTable {
    /// A table of angles, rad, that increase from 0 to π/2, each with its value, 1.
    pub fn new(rows: Vec<[f64; 2]>) -> Self {
        debug_assert!(rows.is_sorted_by(|a, b| a[0] < b[0]) && rows.len() >= 2);
        Self { rows }
    }

    /// The same value at every angle, 1.
    pub fn constant(value: f64) -> Self {
        Self::new(vec![[0.0, value], [FRAC_PI_2, value]])
    }

    /// The value at an angle of incidence of this cosine, 1.
    pub(crate) fn at(&self, cos: f64) -> f64 {
        let angle = cos.clamp(0.0, 1.0).acos();
        let last = self.rows.len() - 1;
        let next = self.rows.partition_point(|row| row[0] <= angle).clamp(1, last);
        let ([from, low], [to, high]) = (self.rows[next - 1], self.rows[next]);
        low + (high - low) * ((angle - from) / (to - from)).min(1.0)
    }

    /// The largest value, 1.
    pub(crate) fn greatest(&self) -> f64 {
        self.rows.iter().map(|row| row[1]).fold(f64::NEG_INFINITY, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_met_at_the_angles_of_the_table_and_linear_between() {
        let table = AngleTable::new(vec![[0.0, 0.1], [0.5, 0.2], [1.0, 0.8], [FRAC_PI_2, 1.0]]);
        for (angle, value) in [(0.0, 0.1), (0.25, 0.15), (0.5, 0.2), (0.9, 0.68), (1.0, 0.8)] {
            assert!((table.at(f64::cos(angle)) - value).abs() < 1e-12, "{angle}");
        }
        assert!((table.at(0.0) - 1.0).abs() < 1e-12 && table.at(-1e-17) <= 1.0);
        assert_eq!((table.greatest(), AngleTable::constant(0.3).at(0.4)), (1.0, 0.3));
    }
}
