//! Scatter files, described.

use lumiduct_base::error::{Error, Result};
use lumiduct_base::number::format_percent;
use lumiduct_core::optics::{DirectedTable, SheetTables};
use lumiduct_files::scatter;
use lumiduct_input::measured_sheet;
use std::fmt::Write;
use std::path::Path;

/// Angles of incidence of the table, deg.
const ANGLES_DEG: [u32; 6] = [0, 15, 30, 45, 60, 75];

/// What a sheet reflects and transmits, and remarks.
pub(super) fn description(path: &Path) -> Result<String> {
    let wrong = |problem: String| Error::Usage(format!("{}: {problem}", path.display()));
    let file = scatter::read(path).map_err(|error| wrong(error.to_string()))?;
    let (sheet, remarks) = measured_sheet(file, 0.0).map_err(wrong)?;
    let mut text = format!("{:<26} {:>8}", "share of light, incident", "diffuse");
    for angle in ANGLES_DEG {
        _ = write!(text, " {:>8}", format!("at {angle}°"));
    }
    text.push('\n');
    for (name, SheetTables { reflection, transmission }) in
        [("front", &sheet.front), ("back", &sheet.back)]
    {
        row(&mut text, &format!("reflected by the {name}"), reflection.as_ref());
        row(&mut text, &format!("transmitted from the {name}"), transmission.as_ref());
    }
    _ = writeln!(text, "checked: {}", sheet.checks);
    for remark in remarks {
        _ = writeln!(text, "remark: {remark}");
    }
    Ok(text)
}

fn row(text: &mut String, name: &str, table: Option<&DirectedTable>) {
    let share = |of: &dyn Fn(&DirectedTable) -> f64| format_percent(table.map_or(0.0, of));
    _ = write!(text, "{name:<26} {:>8}", share(&DirectedTable::share_of_diffuse));
    for angle in ANGLES_DEG {
        let angle = f64::from(angle).to_radians();
        _ = write!(text, " {:>8}", share(&|table| table.share_at(angle)));
    }
    text.push('\n');
}
