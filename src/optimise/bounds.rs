//! The bounds of a length: its limits, and the bridges between neighbours. Also the element field of a scene as a list.

use crate::optimise::feedback::{PER_MM, rounded};
use crate::optimise::law::SizeLaw;
use lumiduct_core::scene::pattern::{ElementField, ElementOutline};
use lumiduct_core::scene::shape::ChartRect;
use lumiduct_core::scene::{FaceId, Scene};
use lumiduct_input::{PatternFeedback, Vary};
use lumiduct_report::optimise::{ElementShape, FoundElement};
use std::fmt::Write;

/// Most rows whose lengths are written one by one.
const MOST_ROWS: usize = 5000;
/// Points at which lengths are written for more rows than that.
const ROW_POINTS: usize = 2000;
/// Points at which a pitch is written.
const PITCH_POINTS: usize = 200;
/// Relative rounding that must not move a cap to the next shorter length, 1.
const ROUNDING: f64 = 1e-13;

/// The least and the greatest length along a face.
#[derive(Debug, Clone)]
pub(crate) struct LengthBounds {
    vary: Vary,
    limits: [f64; 2],
    /// Places of rows, mm along the face, and the greatest length there.
    rows: Vec<[f64; 2]>,
    face_length: f64,
}

/// The field of a pattern or a relief, and its face.
pub(crate) fn field<'a>(scene: &'a Scene, name: &str) -> Option<(&'a ElementField, FaceId)> {
    let pattern = scene.patterns.iter().find(|own| own.name == name);
    let relief = scene.reliefs.iter().find(|own| own.name == name);
    pattern.map(|own| (&own.field, own.face)).or_else(|| relief.map(|own| (&own.field, own.wall)))
}

impl LengthBounds {
    pub(crate) fn of(feedback: &PatternFeedback, scene: &Scene) -> Self {
        let [from, to] = feedback.limits;
        let mut bounds = Self {
            vary: feedback.vary,
            limits: [from, to],
            rows: Vec::new(),
            face_length: feedback.face_length,
        };
        let Some((field, face)) = field(scene, &feedback.pattern) else { return bounds };
        let Some(rect) = scene.face_rect(face) else { return bounds };
        let start = rect.min.y;
        let places: Vec<f64> = (0..field.rows.count()).map(|row| field.rows.place(row)).collect();
        match feedback.vary {
            Vary::Pitch => {
                let longest = places.iter().map(|place| field.outline.size(*place).y);
                let least = from.max(longest.fold(0.0, f64::max) + feedback.bridge);
                bounds.limits[0] = rounded_up(least);
            }
            Vary::Diameter => {
                // Elements keep their bridges, and stay on the face.
                let cap = |row: usize| {
                    let edge = 2.0 * edge(field, (row, places[row]), rect);
                    rounded_down(to.min(gap(field, &places, row) - feedback.bridge).min(edge))
                };
                bounds.rows =
                    places.iter().enumerate().map(|(row, at)| [at - start, cap(row)]).collect();
            }
            Vary::Radius | Vary::Depth | Vary::Height => {
                bounds.rows = places.iter().map(|at| [at - start, to]).collect();
            }
        }
        bounds
    }

    /// Positions of the first and the last element along the face, mm; of the face where they move.
    pub(crate) fn ends(&self) -> [f64; 2] {
        match self.rows.as_slice() {
            [first, .., last] => [first[0], last[0]],
            [] | [_] => [0.0, self.face_length],
        }
    }

    /// The least and the greatest length at a point of the law, mm.
    pub(crate) fn at(&self, law: &SizeLaw, point: usize) -> [f64; 2] {
        [self.limits[0], self.greatest(law, point)]
    }

    /// Why no length meets the bounds; `None` where some do.
    pub(crate) fn contradiction(&self) -> Option<String> {
        let [from, to] = self.limits;
        if from > to {
            return Some(match self.vary {
                Vary::Pitch => format!(
                    "the limits contradict each other: elements and bridges need a pitch of at least {from:.4} mm, and at most \
                     {to} mm is allowed; change `limits`, `bridge_mm` or the size of the elements"
                ),
                Vary::Diameter | Vary::Radius | Vary::Depth | Vary::Height => format!(
                    "the limits contradict each other: at least {from} mm and at most {to} mm; change `limits`"
                ),
            });
        }
        let narrow = self.rows.iter().find(|row| row[1] < from)?;
        Some(format!(
            "the limits contradict each other: at {:.4} mm along the face the bridges leave {:.4} mm, and at least {from} mm is \
             wanted; change `limits`, `bridge_mm` or the pitch",
            narrow[0], narrow[1]
        ))
    }

    /// The greatest length near a point of the law, mm: the largest cap within half the way to its neighbours.
    fn greatest(&self, law: &SizeLaw, point: usize) -> f64 {
        let at = law.points[point];
        // The first and the last length also hold beyond their points.
        let reach =
            |other: Option<&f64>| other.map_or(f64::INFINITY, |other| 0.5 * (other - at).abs());
        let before = reach(point.checked_sub(1).and_then(|own| law.points.get(own)));
        let after = reach(law.points.get(point + 1));
        let near = self.rows.iter().filter(|row| row[0] >= at - before && row[0] <= at + after);
        let caps = near.map(|row| row[1]).fold(f64::NEG_INFINITY, f64::max);
        if caps.is_finite() { caps.min(self.limits[1]) } else { self.limits[1] }
    }

    /// A length at a point of the law, clamped to its bounds, mm.
    pub(crate) fn clamp(&self, law: &SizeLaw, point: usize, value: f64) -> f64 {
        let [least, greatest] = self.at(law, point);
        value.min(greatest).max(least)
    }

    /// Whether the bounds leave a length at a point of the law room on both sides.
    pub(crate) fn leave_room(&self, law: &SizeLaw, point: usize, value: f64) -> bool {
        let [least, greatest] = self.at(law, point);
        least < value && value < greatest
    }

    /// Places at which lengths are written, mm along the face, and the greatest length there.
    fn written(&self) -> Vec<[f64; 2]> {
        if self.rows.is_empty() {
            let step = |place: usize| self.face_length * place as f64 / PITCH_POINTS as f64;
            return (0..=PITCH_POINTS).map(|place| [step(place), self.limits[1]]).collect();
        }
        let count = if self.rows.len() > MOST_ROWS { ROW_POINTS } else { self.rows.len() };
        sampled(&self.rows, count)
    }

    /// The lengths of a law as a value of the scene: a table of places and lengths.
    pub(crate) fn table(&self, law: &SizeLaw, values: &[f64]) -> String {
        let mut text = String::from("[");
        for [place, cap] in self.written() {
            // A cap below the least length contradicts it; the caller has refused that.
            let length = law.at(values, place).min(cap).max(self.limits[0].min(cap));
            let comma = if text.len() > 1 { ", " } else { "" };
            _ = write!(text, "{comma}[{}, {}]", rounded(place), rounded(length));
        }
        text + "]"
    }
}

/// The longest length that can be written up to a cap, mm.
fn rounded_down(cap: f64) -> f64 {
    (PER_MM * cap * (1.0 + ROUNDING)).floor() / PER_MM
}

/// The shortest length that can be written from a least one on, mm.
fn rounded_up(least: f64) -> f64 {
    (PER_MM * least * (1.0 - ROUNDING)).ceil() / PER_MM
}

/// Rows for a table of about `count` points: some of the rows, each with the least cap of all up to its neighbours, so that no straight line
/// between two of them rises above a cap.
fn sampled(rows: &[[f64; 2]], count: usize) -> Vec<[f64; 2]> {
    let size = rows.len().div_ceil(count).max(1);
    if size == 1 {
        return rows.to_vec();
    }
    let cap = |rows: &[[f64; 2]]| rows.iter().map(|row| row[1]).fold(f64::INFINITY, f64::min);
    let mut found = Vec::new();
    let mut before = f64::INFINITY;
    for group in rows.chunks(size) {
        let own = cap(group);
        found.push([group[0][0], before.min(own)]);
        before = own;
    }
    // A last group of one row has its point already.
    if let Some(last) = rows.last().filter(|_| rows.len() % size != 1) {
        found.push([last[0], before]);
    }
    found
}

/// Distance from the elements of a row to their nearest neighbours, mm between middles.
fn gap(field: &ElementField, places: &[f64], row: usize) -> f64 {
    let columns = field.columns;
    let beside = if columns.count > 1 { columns.pitch } else { f64::INFINITY };
    // Rows of the same shift have elements in the same columns; the others lie beside these.
    let others = [1, 2].into_iter().flat_map(|by| [row.checked_sub(by), Some(row + by)]);
    let along = others.flatten().filter_map(|other| {
        let aside = if other % 2 == row % 2 { 0.0 } else { aside(field) };
        Some((places.get(other)? - places[row]).abs().hypot(aside))
    });
    along.fold(beside, f64::min)
}

/// Distance from the middles of a row's elements to the nearest edge of the face, mm.
fn edge(field: &ElementField, (row, at): (usize, f64), rect: ChartRect) -> f64 {
    let columns = field.columns;
    let along = (at - rect.min.y).min(rect.max.y - at);
    if field.period.is_some() {
        return along;
    }
    let [from, to] = [0, columns.count.saturating_sub(1)].map(|column| columns.place(row, column));
    along.min(from - rect.min.x).min(rect.max.x - to)
}

/// Distance across the face from an element to the nearest one of a row with the other shift, mm.
fn aside(field: &ElementField) -> f64 {
    let columns = field.columns;
    // Columns repeat by their pitch, a round face by its circumference.
    let repeats = [(columns.count > 1).then_some(columns.pitch), field.period];
    let shift = columns.shift.abs();
    repeats.into_iter().flatten().fold(shift, |least, by| least.min((by - shift).abs()))
}

/// An unrolled face with its elements.
pub(crate) struct FoundFace {
    pub(crate) elements: Vec<FoundElement>,
    /// The form of the elements.
    pub(crate) shape: ElementShape,
    /// Width and length, mm.
    pub(crate) size_mm: [f64; 2],
    /// Whether it goes once around.
    pub(crate) is_round: bool,
}

/// The unrolled face of a pattern or a relief.
pub(crate) fn unrolled(scene: &Scene, name: &str) -> FoundFace {
    let found = field(scene, name).and_then(|own| Some((own.0, scene.face_rect(own.1)?)));
    let Some((field, rect)) = found else {
        let (shape, size_mm) = (ElementShape::Relief, [0.0, 0.0]);
        return FoundFace { elements: Vec::new(), shape, size_mm, is_round: false };
    };
    let (shape, height): (ElementShape, Box<dyn Fn(f64) -> f64 + '_>) = match &field.outline {
        ElementOutline::Circle { .. } => (ElementShape::Circle, Box::new(|_| 0.0)),
        ElementOutline::Rectangle { .. } => (ElementShape::Rectangle, Box::new(|_| 0.0)),
        ElementOutline::Relief(element) => {
            (ElementShape::Relief, Box::new(|place| element.height(place)))
        }
    };
    let size = rect.max - rect.min;
    let list = field.places().map(|(place, middle)| {
        let own = field.outline.size(place);
        let mut across = middle.x - rect.min.x;
        if field.period.is_some() {
            // One turn around a round face.
            across = across.rem_euclid(size.x);
        }
        FoundElement {
            across_mm: rounded(across),
            along_mm: rounded(middle.y - rect.min.y),
            width_mm: rounded(own.x),
            length_mm: rounded(own.y),
            height_mm: rounded(height(place)),
        }
    });
    FoundFace {
        elements: list.collect(),
        shape,
        size_mm: size.to_array(),
        is_round: field.period.is_some(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use lumiduct_core::scene::pattern::{Columns, RowPositions, TableAlong};

    fn field(columns: Columns, period: Option<f64>) -> ElementField {
        ElementField {
            outline: ElementOutline::Circle { diameter: TableAlong::constant(4.0) },
            rows: RowPositions::Even { first: 10.0, pitch: 10.0, count: 6 },
            columns,
            period,
        }
    }

    #[test]
    fn fewer_points_than_rows_keep_below_the_cap_of_every_row() {
        let cap = |row: usize| if row.is_multiple_of(7) { 2.0 } else { 3.0 + (row % 5) as f64 };
        let rows: Vec<[f64; 2]> = (0..6001)
            .map(|row| [0.5 * row as f64, if row < 3000 { 9.0 } else { cap(row) }])
            .collect();
        let found = sampled(&rows, 500);
        assert!(found.len() <= 501, "{}", found.len());
        assert_eq!((found[0], found.last()), ([0.0, 9.0], Some(&[3000.0, 2.0])));
        let table = TableAlong::table(found).unwrap();
        for [place, cap] in &rows {
            assert!(table.at(*place) <= cap + 1e-12, "{place}");
        }
        assert!(sampled(&rows, rows.len()) == rows);
    }

    #[test]
    fn a_length_that_is_written_reaches_its_cap_and_not_beyond() {
        for (cap, longest) in [(7.3 - 1.5, 5.8), (20.0 / 3.0, 6.6666), (28.5, 28.5)] {
            assert_eq!(rounded_down(cap), longest);
            assert_eq!(rounded(rounded_down(cap)), longest);
        }
        for (least, shortest) in [(4.1 + 1.2, 5.3), (20.0 / 3.0, 6.6667)] {
            assert_eq!(rounded_up(least), shortest);
            assert_eq!(rounded(rounded_up(least)), shortest);
        }
    }

    #[test]
    fn elements_keep_from_all_edges_of_a_flat_face_and_from_the_ends_of_a_round_one() {
        let rect = ChartRect { min: DVec2::new(-5.0, 0.0), max: DVec2::new(5.0, 80.0) };
        let columns = Columns { first: -2.0, pitch: 3.0, count: 2, shift: 1.5 };
        for (period, row, at, expected) in [
            (None, 0, 40.0, 3.0),
            (None, 1, 40.0, 2.5),
            (None, 0, 1.0, 1.0),
            (None, 0, 78.0, 2.0),
            (Some(10.0), 1, 40.0, 40.0),
        ] {
            assert_eq!(edge(&field(columns, period), (row, at), rect), expected, "{row} {at}");
        }
    }

    #[test]
    fn neighbours_of_staggered_rows_are_beside_or_two_rows_away() {
        let places: Vec<f64> = (0..6).map(|row| 10.0 + 10.0 * f64::from(row)).collect();
        for (pitch, shift, count, period, expected) in [
            (60.0, 0.0, 2, None, 10.0),
            (8.0, 0.0, 2, None, 8.0),
            (60.0, 30.0, 2, None, 20.0),
            (12.0, 6.0, 2, None, 10f64.hypot(6.0)),
            (12.0, 9.0, 2, None, 10f64.hypot(3.0)),
            (12.0, 9.0, 1, None, 10f64.hypot(9.0)),
            (12.0, 9.0, 1, Some(10.0), 10f64.hypot(1.0)),
        ] {
            let columns = Columns { first: 0.0, pitch, count, shift };
            let found = gap(&field(columns, period), &places, 2);
            assert!((found - expected).abs() < 1e-12, "{pitch} {shift} {count}: {found}");
        }
    }
}
