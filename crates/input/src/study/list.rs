//! The designs of a table: a column for each parameter, a row for each design.

use crate::keys::{Key, Places};
use crate::problems::{Problems, name_hint};
use crate::spec::study::MOST_DESIGNS;
use crate::study::parameters::{Parameter, Setting};
use crate::texts::{Origin, TextId};
use csv::{ReaderBuilder, StringRecord, Trim};

/// The rows of a table, a setting for each parameter. An empty cell leaves a parameter as the scene has it.
pub(super) fn rows(
    places: &Places,
    table: TextId,
    parameters: &[Parameter],
    problems: &mut Problems,
) -> Vec<Vec<Setting>> {
    let text = places.sources().get(table).text();
    let mut reader =
        ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let mut table = Table { source: table, text, problems };
    let headers = match reader.headers() {
        Ok(headers) => headers.clone(),
        Err(error) => {
            table.refuse(0, &error.to_string());
            return Vec::new();
        }
    };
    let Some(columns) = table.columns(&headers, parameters) else { return Vec::new() };
    let mut rows = Vec::new();
    for record in reader.records() {
        match record {
            Ok(record) => rows.push(table.row(&record, &columns, parameters)),
            Err(error) => {
                let at = error.position().map_or(0, |position| position.byte() as usize);
                table.refuse(at, "this row has a different number of cells from the first");
                return Vec::new();
            }
        }
        if rows.len() > MOST_DESIGNS {
            table.refuse(0, &format!("more than {MOST_DESIGNS} designs"));
            return Vec::new();
        }
    }
    if rows.is_empty() {
        table.refuse(0, "has no designs");
    }
    rows
}

/// A table that is being read.
struct Table<'a> {
    source: TextId,
    text: &'a str,
    problems: &'a mut Problems,
}

impl Table<'_> {
    /// Notes what is wrong in the line that starts at a byte.
    fn refuse(&mut self, start: usize, message: &str) {
        let rest = self.text.get(start..).unwrap_or_default();
        let start = start + (rest.len() - rest.trim_start().len());
        let line = self.text.get(start..).and_then(|rest| rest.lines().next()).unwrap_or_default();
        let origin = Origin { source: self.source, span: start..start + line.len() };
        self.problems.error(&Key::root(), message).at(&origin);
    }

    /// The column of each parameter.
    fn columns(&mut self, headers: &StringRecord, parameters: &[Parameter]) -> Option<Vec<usize>> {
        let names = || parameters.iter().map(|parameter| parameter.name.as_str());
        if let [single] = headers.iter().collect::<Vec<_>>()[..]
            && let Some(other) = single.chars().find(|c| [';', '\t'].contains(c))
        {
            let other = if other == ';' { "semicolons" } else { "tabs" };
            let message = format!("the cells of a table are separated by commas, not by {other}");
            self.refuse(0, &message);
            return None;
        }
        if headers.is_empty() {
            self.refuse(0, "the table is empty: it needs a column for each parameter");
            return None;
        }
        for header in headers.iter().filter(|header| !names().any(|name| name == *header)) {
            let hint = name_hint(header, names());
            self.refuse(0, &format!("there is no parameter `{header}`; {hint}"));
        }
        let mut columns = Vec::new();
        for name in names() {
            let mut own = (0..headers.len()).filter(|column| headers.get(*column) == Some(name));
            match (own.next(), own.next()) {
                (Some(column), None) => columns.push(column),
                (Some(_), Some(_)) => self.refuse(0, &format!("the column `{name}` occurs twice")),
                (None, _) => self.refuse(0, &format!("there is no column `{name}`")),
            }
        }
        (columns.len() == parameters.len()).then_some(columns)
    }

    fn row(
        &mut self,
        record: &StringRecord,
        columns: &[usize],
        parameters: &[Parameter],
    ) -> Vec<Setting> {
        let start = record.position().map_or(0, |position| position.byte() as usize);
        let mut settings = Vec::new();
        for (parameter, &column) in parameters.iter().zip(columns) {
            let cell = record.get(column).unwrap_or_default();
            settings.push(match setting(cell, parameter) {
                Ok(setting) => setting,
                Err(message) => {
                    self.refuse(start, &format!("`{}`: {message}", parameter.name));
                    Setting::AsInScene
                }
            });
        }
        settings
    }
}

fn setting(cell: &str, parameter: &Parameter) -> Result<Setting, String> {
    if cell.contains('\n') {
        return Err("a quotation mark is not closed".into());
    }
    if cell.is_empty() {
        return Ok(Setting::AsInScene);
    }
    if !parameter.choices.is_empty() {
        let known = parameter.choices.keys().map(String::as_str);
        return match parameter.choices.contains_key(cell) {
            true => Ok(Setting::Choice(cell.to_owned())),
            false => Err(format!("`{cell}` is not one of its choices; {}", name_hint(cell, known))),
        };
    }
    match cell.parse::<f64>() {
        Ok(number) if number.is_finite() => {
            Ok(if parameter.whole { Setting::whole(number) } else { Setting::Number(number) })
        }
        Ok(_) | Err(_) => Err(format!("`{cell}` is not a number")),
    }
}
