//! Rows of a pattern: lines across a face, one after the other along it. Each row is found
//! directly, however many there are.

use crate::scene::pattern::TableAlong;

/// The positions of rows along a face.
#[derive(Debug, Clone, PartialEq)]
pub enum RowPositions {
    /// At listed positions, mm, increasing.
    Listed(Vec<f64>),
    /// At equal distances.
    Even {
        /// Position of the first row, mm.
        first: f64,
        /// Distance from row to row, mm.
        pitch: f64,
        /// Number of rows.
        count: usize,
    },
    /// At distances that change along the face.
    Graded(Graded),
}

/// Rows whose distance p(v) changes: row j lies where N(v) = ∫ dv/p reaches j + ½.
#[derive(Debug, Clone, PartialEq)]
pub struct Graded {
    pieces: Vec<LinearPiece>,
    count: usize,
}

/// A part of the face in which the distance is linear.
#[derive(Debug, Clone, Copy, PartialEq)]
struct LinearPiece {
    /// Its start and end, mm.
    from: f64,
    to: f64,
    /// Distance at its start, mm, and its slope, 1.
    pitch: f64,
    growth: f64,
    /// N at its start, 1.
    number: f64,
}

impl LinearPiece {
    /// Rows between the start of the piece and a position: ∫ dv/(p + k v) = ln(1 + k v/p)/k.
    fn number_to(&self, place: f64) -> f64 {
        let way = place - self.from;
        if self.growth == 0.0 {
            return way / self.pitch;
        }
        (self.growth * way / self.pitch).ln_1p() / self.growth
    }

    /// The position at this number of rows from the start of the piece.
    fn place_of(&self, number: f64) -> f64 {
        let way = if self.growth == 0.0 {
            number * self.pitch
        } else {
            self.pitch * (self.growth * number).exp_m1() / self.growth
        };
        (self.from + way).min(self.to)
    }
}

impl Graded {
    /// As many whole rows as fit between two positions, mm, at the distances of `pitch`, which are
    /// positive.
    pub fn new(pitch: &TableAlong, from: f64, to: f64) -> Self {
        let mut number = 0.0;
        let mut pieces = Vec::new();
        for [from, to, before, after] in pitch.pieces(from, to) {
            let growth = (after - before) / (to - from);
            let piece = LinearPiece { from, to, pitch: before, growth, number };
            number += piece.number_to(to);
            pieces.push(piece);
        }
        // Rounding must not remove the last row.
        let count = (number * (1.0 + 1e-12)).floor() as usize;
        Self { pieces, count }
    }

    fn place(&self, row: usize) -> f64 {
        let number = row as f64 + 0.5;
        let next = self.pieces.partition_point(|piece| piece.number <= number);
        self.pieces.get(next.max(1) - 1).map_or(0.0, |piece| piece.place_of(number - piece.number))
    }

    fn number(&self, place: f64) -> f64 {
        let next = self.pieces.partition_point(|piece| piece.from <= place);
        self.pieces
            .get(next.max(1) - 1)
            .map_or(0.0, |piece| piece.number + piece.number_to(place.clamp(piece.from, piece.to)))
    }
}

impl RowPositions {
    /// Number of rows.
    pub fn count(&self) -> usize {
        match self {
            Self::Listed(places) => places.len(),
            Self::Even { count, .. } => *count,
            Self::Graded(graded) => graded.count,
        }
    }

    /// Position of a row along the face, mm.
    #[inline]
    pub fn place(&self, row: usize) -> f64 {
        match self {
            Self::Listed(places) => places[row],
            Self::Even { first, pitch, .. } => first + row as f64 * pitch,
            Self::Graded(graded) => graded.place(row),
        }
    }

    /// The rows from one position along the face to another, mm.
    pub(crate) fn between(&self, from: f64, to: f64) -> std::ops::Range<usize> {
        let before = |limit: f64| {
            let (mut low, mut high) = (0, self.count());
            while low < high {
                let middle = low.midpoint(high);
                if self.place(middle) < limit {
                    low = middle + 1;
                } else {
                    high = middle;
                }
            }
            low
        };
        before(from)..before(to)
    }

    /// The rows that may reach a position: its neighbours and one more on either side.
    #[inline]
    pub(crate) fn near(&self, place: f64) -> std::ops::Range<usize> {
        let middle = match self {
            Self::Listed(places) => places.partition_point(|row| *row < place) as f64 - 0.5,
            Self::Even { first, pitch, .. } => ((place - first) / pitch).round(),
            Self::Graded(graded) => (graded.number(place) - 0.5).round(),
        };
        let (first, last) = ((middle - 1.0).ceil().max(0.0), (middle + 1.0).floor());
        first as usize..((last + 1.0).max(0.0) as usize).min(self.count())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_every_kind_are_found_beside_their_places() {
        let pitch = TableAlong::table(vec![[0.0, 2.0], [30.0, 0.5], [50.0, 0.5]]).unwrap();
        let kinds = [
            RowPositions::Listed(vec![1.0, 2.5, 7.0, 20.0, 40.0]),
            RowPositions::Even { first: 0.7, pitch: 1.3, count: 30 },
            RowPositions::Graded(Graded::new(&pitch, 3.0, 48.0)),
        ];
        for rows in kinds {
            assert!(rows.count() > 4);
            for row in 0..rows.count() {
                let near = rows.near(rows.place(row));
                assert!(near.contains(&row) && near.len() <= 3, "{rows:?}, {row}: {near:?}");
                // Half way to the next row, both are near.
                if row + 1 < rows.count() {
                    let near = rows.near(0.5 * (rows.place(row) + rows.place(row + 1)));
                    assert!(near.contains(&row) && near.contains(&(row + 1)), "{rows:?}, {row}");
                }
            }
            assert!(rows.near(-1e6).len() <= 1 && rows.near(1e6).len() <= 1);
        }
    }

    #[test]
    fn graded_rows_keep_their_distances() {
        let pitch = TableAlong::table(vec![[0.0, 1.0], [100.0, 4.0]]).unwrap();
        let rows = RowPositions::Graded(Graded::new(&pitch, 0.0, 100.0));
        // ∫ dv/(1 + 0.03 v) = ln(4)/0.03 = 46.2
        assert_eq!(rows.count(), 46);
        for row in 0..45 {
            let (here, next) = (rows.place(row), rows.place(row + 1));
            let expected = pitch.at(0.5 * (here + next));
            assert!(((next - here) / expected - 1.0).abs() < 1e-3, "{row}: {here} {next}");
        }
        let even = RowPositions::Graded(Graded::new(&TableAlong::constant(2.5), 10.0, 35.0));
        assert_eq!((even.count(), even.place(0), even.place(9)), (10, 11.25, 33.75));
    }
}
