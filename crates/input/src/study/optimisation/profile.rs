//! The wanted light along a face, from a table.

use crate::keys::{Key, Places};
use crate::problems::Problems;
use crate::texts::{Origin, TextId};
use csv::{ReaderBuilder, StringRecord, Trim};
use lumiduct_core::scene::pattern::TableAlong;

/// The columns of a profile.
const COLUMNS: [&str; 2] = ["along_mm", "light"];

/// Light at positions, mm; `None` where the table is not valid, which has then been noted.
pub(super) fn rows(places: &Places, table: TextId, problems: &mut Problems) -> Option<TableAlong> {
    let text = places.sources().get(table).text();
    let mut refuse = |start: usize, message: &str| {
        let line = text.get(start..).and_then(|rest| rest.lines().next()).unwrap_or_default();
        let origin = Origin { source: table, span: start..start + line.len() };
        let hint = "a profile has the columns `along_mm` and `light`, separated by commas";
        problems.error(&Key::root(), message).hint(hint).at(&origin);
        None
    };
    let mut reader =
        ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let columns = match reader.headers() {
        Ok(headers) => COLUMNS.map(|name| headers.iter().position(|own| own == name)),
        Err(error) => return refuse(0, &error.to_string()),
    };
    let [Some(along), Some(light)] = columns else {
        return refuse(0, "a column is missing");
    };
    let mut rows: Vec<[f64; 2]> = Vec::new();
    for record in reader.records() {
        let record = match record {
            Ok(record) => record,
            Err(error) => {
                let at = error.position().map_or(0, |position| position.byte() as usize);
                return refuse(at, "this row has a different number of cells from the first");
            }
        };
        let start = record.position().map_or(0, |position| position.byte() as usize);
        let [Some(place), Some(value)] = [along, light].map(|column| number(&record, column))
        else {
            return refuse(start, "a cell of this row is not a finite number");
        };
        if value < 0.0 {
            return refuse(start, "the light is below 0");
        }
        if rows.last().is_some_and(|last| last[0] >= place) {
            return refuse(start, "the position is not greater than the one before it");
        }
        rows.push([place, value]);
    }
    if rows.is_empty() {
        return refuse(0, "there are no rows");
    }
    TableAlong::table(rows)
}

fn number(record: &StringRecord, column: usize) -> Option<f64> {
    record.get(column)?.parse().ok().filter(|number: &f64| number.is_finite())
}
