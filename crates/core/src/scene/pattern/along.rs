//! A quantity that changes along a face: a table with linear interpolation.

/// Values at positions along a face; constant before the first and after the last.
#[derive(Debug, Clone, PartialEq)]
pub struct TableAlong {
    /// Positions, mm, increasing, with their values.
    knots: Vec<[f64; 2]>,
}

impl TableAlong {
    /// The same value everywhere.
    pub fn constant(value: f64) -> Self {
        Self { knots: vec![[0.0, value]] }
    }

    /// A table of positions, mm, and values; `None` without any, or where the positions do not
    /// increase.
    pub fn table(knots: Vec<[f64; 2]>) -> Option<Self> {
        let increases = knots.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        (increases && !knots.is_empty()).then_some(Self { knots })
    }

    /// The value at a position, mm.
    #[inline]
    pub fn at(&self, place: f64) -> f64 {
        match self.knots.as_slice() {
            [] => 0.0,
            [[_, value]] => *value,
            knots => {
                let next = knots.partition_point(|knot| knot[0] <= place);
                if next == 0 {
                    return knots[0][1];
                }
                let [from, before] = knots[next - 1];
                let Some([to, after]) = knots.get(next) else { return before };
                before + (place - from) / (to - from) * (after - before)
            }
        }
    }

    /// The smallest value.
    pub fn smallest(&self) -> f64 {
        self.knots.iter().map(|knot| knot[1]).fold(f64::INFINITY, f64::min)
    }

    /// The table with positions measured from another origin, `by` mm before this one's.
    pub fn shifted(mut self, by: f64) -> Self {
        self.knots.iter_mut().for_each(|knot| knot[0] += by);
        self
    }

    /// The pieces between two positions, each with the values at its ends:
    /// `[from, to, before, after]`.
    pub(crate) fn pieces(&self, from: f64, to: f64) -> Vec<[f64; 4]> {
        let inner =
            self.knots.iter().map(|knot| knot[0]).filter(|place| *place > from && *place < to);
        let places: Vec<f64> =
            std::iter::once(from).chain(inner).chain(std::iter::once(to)).collect();
        places
            .windows(2)
            .map(|pair| [pair[0], pair[1], self.at(pair[0]), self.at(pair[1])])
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_lie_on_straight_lines_between_the_places_and_stay_outside() {
        let along = TableAlong::table(vec![[10.0, 1.0], [20.0, 3.0], [40.0, 2.0]]).unwrap();
        for (place, value) in [(0.0, 1.0), (10.0, 1.0), (15.0, 2.0), (30.0, 2.5), (50.0, 2.0)] {
            assert_eq!(along.at(place), value);
        }
        assert_eq!(along.pieces(15.0, 45.0).len(), 3);
        assert_eq!(along.clone().shifted(5.0).at(20.0), 2.0);
        assert_eq!((along.smallest(), TableAlong::constant(7.0).at(-3.0)), (1.0, 7.0));
        assert_eq!(TableAlong::table(vec![[1.0, 1.0], [1.0, 2.0]]), None);
        assert_eq!(TableAlong::table(Vec::new()), None);
    }
}
