//! Where the elements of a pattern are: rows, grids, staggered and hexagonal fields on a face.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::patterns::ground::PatternGround;
use crate::spec::pattern::{AlongSpec, GridSpec, HexagonalSpec, LawSpec, LayoutSpec, RowSpec};
use lumiduct_core::scene::pattern::{Columns, Graded, RowPositions, TableAlong};
use lumiduct_core::scene::shape::ChartRect;

/// Pieces that approximate a power law.
const PIECES: u32 = 256;
/// Deviation from a whole number of columns around a tube that counts as rounding, 1.
const WHOLE: f64 = 1e-6;
/// Most rows of a pattern.
const MOST_ROWS: f64 = 1e7;

impl Context<'_> {
    /// The rows and columns of a layout on a face; none of them empty.
    pub(in crate::lower) fn rows_and_columns(
        &mut self,
        spec: &LayoutSpec,
        ground: &PatternGround,
        key: &Key,
    ) -> Option<(RowPositions, Columns)> {
        let (rows, columns) = match spec {
            LayoutSpec::Row(row) => self.row(row, ground, &key.field("row"))?,
            LayoutSpec::Grid(grid) => self.grid(grid, 0.0, ground, &key.field("grid"))?,
            LayoutSpec::Staggered(grid) => self.grid(grid, 0.5, ground, &key.field("staggered"))?,
            LayoutSpec::Hexagonal(hexagonal) => {
                self.grid(&rows_of(hexagonal), 0.5, ground, &key.field("hexagonal"))?
            }
        };
        if rows.count() == 0 || columns.count == 0 {
            let (x, y) = ground.size().into();
            let hint = format!("it is {x:.4} mm across and {y:.4} mm along");
            return self.refuse(key, "no element fits on the face", hint);
        }
        Some((rows, columns))
    }

    fn row(
        &mut self,
        spec: &RowSpec,
        ground: &PatternGround,
        key: &Key,
    ) -> Option<(RowPositions, Columns)> {
        let middle = 0.5 * (ground.rect.min.x + ground.rect.max.x);
        let first = match (spec.around_deg, spec.across_mm, ground.radius) {
            (Some(_), Some(_), _) => {
                let message = "is given together with across_mm, expected one of them";
                self.problems.error(&key.field("around_deg"), message);
                return None;
            }
            (Some(around), None, Some(radius)) => radius * around.to_radians(),
            (Some(_), None, None) => {
                let hint = "use across_mm, counted from the middle of the face";
                return self.refuse(&key.field("around_deg"), "the face is not round", hint);
            }
            (None, across, _) => middle + across.unwrap_or(0.0),
        };
        let columns = Columns { first, pitch: 1.0, count: 1, shift: 0.0 };
        let start = ground.rect.min.y;
        let rows = match (&spec.positions_mm, &spec.pitch_mm) {
            (Some(positions), _) => {
                if let Some(at) = positions.windows(2).position(|pair| pair[0] >= pair[1]) {
                    let key = key.field("positions_mm").index(at + 1);
                    self.problems.error(&key, "is not greater than the one before it");
                    return None;
                }
                RowPositions::Listed(positions.iter().map(|position| start + position).collect())
            }
            (None, Some(pitch)) => {
                let along = self.range(
                    spec.along_mm,
                    ground,
                    FieldAxis::TableAlong,
                    &key.field("along_mm"),
                )?;
                self.rows(pitch, along, ground, &key.field("pitch_mm"))?
            }
            // Validated: one of the two is given.
            (None, None) => return None,
        };
        Some((rows, columns))
    }

    fn grid(
        &mut self,
        spec: &GridSpec,
        stagger: f64,
        ground: &PatternGround,
        key: &Key,
    ) -> Option<(RowPositions, Columns)> {
        let along =
            self.range(spec.along_mm, ground, FieldAxis::TableAlong, &key.field("along_mm"))?;
        let rows = self.rows(&spec.pitch_mm, along, ground, &key.field("pitch_mm"))?;
        let pitch = spec.across_pitch_mm;
        let shift = stagger * pitch;
        if let (Some(period), None) = (ground.period(), spec.across_mm) {
            let fit = period / pitch;
            let count = fit.round().max(1.0);
            if (fit - count).abs() > WHOLE * count {
                let message =
                    format!("columns {pitch} mm apart do not fit: {fit:.4} of them go around");
                return self.refuse(
                    key,
                    message,
                    format!("{count} of {:.6} mm do", period / count),
                );
            }
            let columns = Columns { first: 0.5 * pitch, pitch, count: count as usize, shift };
            return Some((rows, columns));
        }
        let across =
            self.range(spec.across_mm, ground, FieldAxis::Across, &key.field("across_mm"))?;
        let width = across[1] - across[0] - shift;
        let count = (width / pitch * (1.0 + WHOLE)).floor().max(0.0);
        let first = across[0] + 0.5 * (width - (count - 1.0) * pitch);
        Some((rows, Columns { first, pitch, count: count as usize, shift }))
    }

    /// As many rows as fit into a part of the face, centred in it.
    fn rows(
        &mut self,
        pitch: &AlongSpec,
        [from, to]: [f64; 2],
        ground: &PatternGround,
        key: &Key,
    ) -> Option<RowPositions> {
        let along = self.along(pitch, ground, key)?;
        if (to - from) / along.smallest() > MOST_ROWS {
            self.problems.error(key, format!("makes more than {MOST_ROWS} rows"));
            return None;
        }
        Some(match pitch {
            AlongSpec::Same(pitch) => {
                let count = ((to - from) / pitch * (1.0 + WHOLE)).floor();
                let first = from + 0.5 * (to - from - (count - 1.0) * pitch);
                RowPositions::Even { first, pitch: *pitch, count: count as usize }
            }
            AlongSpec::Table(_) | AlongSpec::Law(_) => {
                RowPositions::Graded(Graded::new(&along, from, to))
            }
        })
    }

    /// The extent along the face, in its chart.
    pub(in crate::lower) fn along(
        &mut self,
        spec: &AlongSpec,
        ground: &PatternGround,
        key: &Key,
    ) -> Option<TableAlong> {
        let start = ground.rect.min.y;
        match spec {
            AlongSpec::Same(length) => Some(TableAlong::constant(*length)),
            AlongSpec::Table(knots) => {
                if let Some(at) = knots.iter().position(|knot| knot[1].is_nan() || knot[1] <= 0.0) {
                    let message = format!("{} is out of range, expected above 0", knots[at][1]);
                    self.problems.error(&key.index(at), message);
                    return None;
                }
                let along = TableAlong::table(knots.clone());
                if along.is_none() {
                    self.problems.error(key, "the positions of the table do not increase");
                }
                along.map(|along| along.shifted(start))
            }
            AlongSpec::Law(law) => {
                TableAlong::table(law_knots(law, ground.size().y)).map(|along| along.shifted(start))
            }
        }
    }

    /// A part of the face in its chart, across or along.
    fn range(
        &mut self,
        given: Option<[f64; 2]>,
        ground: &PatternGround,
        axis: FieldAxis,
        key: &Key,
    ) -> Option<[f64; 2]> {
        let ChartRect { min, max } = ground.rect;
        let (whole, origin) = match axis {
            FieldAxis::TableAlong => ([min.y, max.y], min.y),
            FieldAxis::Across => ([min.x, max.x], 0.5 * (min.x + max.x)),
        };
        let Some(given) = given else { return Some(whole) };
        let range = given.map(|place| origin + place);
        let least = 1e-9 * (whole[1] - whole[0]);
        if range[0] >= range[1] || range[0] < whole[0] - least || range[1] > whole[1] + least {
            let [from, to] = whole.map(|place| place - origin);
            self.problems.error(
                key,
                format!(
                    "[{}, {}] is not within the face, which goes from {from:.4} to {to:.4} mm",
                    given[0], given[1]
                ),
            );
            return None;
        }
        Some(range)
    }
}

/// An axis of a face.
#[derive(Debug, Clone, Copy)]
enum FieldAxis {
    TableAlong,
    Across,
}

/// The rows and columns of elements with six neighbours.
fn rows_of(spec: &HexagonalSpec) -> GridSpec {
    GridSpec {
        across_pitch_mm: spec.pitch_mm,
        pitch_mm: AlongSpec::Same(0.75f64.sqrt() * spec.pitch_mm),
        across_mm: spec.across_mm,
        along_mm: spec.along_mm,
    }
}

/// Positions and lengths of a power law along a face of some length, mm.
pub(crate) fn law_knots(law: &LawSpec, length: f64) -> Vec<[f64; 2]> {
    (0..=PIECES)
        .map(|i| {
            let share = f64::from(i) / f64::from(PIECES);
            [share * length, law.from_mm + (law.to_mm - law.from_mm) * share.powf(law.power)]
        })
        .collect()
}
