//! Sheets from what files say of their scatter, with checks of energy and reciprocity.

use lumiduct_base::math::common_directions;
use lumiduct_base::number::{format_fixed, format_percent};
use lumiduct_core::optics::{BsdfTable, DirectedTable, MeasuredSheet, SheetTables};
use lumiduct_files::scatter::{BsdfMatrix, ScatterFile, ScatterSide};

/// Excess of the energy that a file may have by rounding and noise, 1: values are then scaled down.
const MOST_EXCESS: f64 = 0.01;
/// Difference of paths forwards and backwards that is worth a remark, 1.
const RECIPROCAL: f64 = 0.01;

/// The sheet of a file, `turn` rad about the normal of its front, and remarks on what is assumed.
///
/// # Errors
///
/// What is wrong, if more light leaves than arrives.
pub fn measured_sheet(
    file: ScatterFile,
    turn: f64,
) -> Result<(MeasuredSheet, Vec<String>), String> {
    let ScatterFile { front, back, mut remarks } = file;
    let sheet = sheet([front, back], turn, &mut remarks);
    let sheet = conserving(sheet, &mut remarks)?;
    let (_, error) = reciprocity(&sheet);
    if error > RECIPROCAL {
        remarks.push(sheet_checks(&sheet) + "; both are used as they are");
    }
    Ok((sheet, remarks))
}

/// The tables of both sides. Transmission that is given for one side alone is taken as reciprocal.
fn sheet(sides: [ScatterSide; 2], turn: f64, remarks: &mut Vec<String>) -> MeasuredSheet {
    let [mut front, mut back] = sides.map(tables);
    let other = match (&front.transmission, &back.transmission) {
        (Some(given), None) => Some(("back", "front", given, given.reversed())),
        (None, Some(given)) => Some(("front", "back", given, given.reversed())),
        (Some(_), Some(_)) | (None, None) => None,
    };
    if let Some((name, given_name, given, reversed)) = other {
        let unlike = match largest_difference(&reversed, given) {
            difference if difference > RECIPROCAL => {
                format!(
                    "; at the same angle of incidence both sides transmit shares that differ by up to {}",
                    format_percent(difference)
                )
            }
            _ => String::new(),
        };
        remarks.push(format!(
            "no transmission from the {name} is given; it is taken as the reverse of that from the {given_name}{unlike}"
        ));
        let missing = if name == "back" { &mut back } else { &mut front };
        missing.transmission = Some(reversed);
    }
    for (name, side) in [("front", &front), ("back", &back)] {
        if side.reflection.is_none() {
            remarks.push(format!("no reflection by the {name} is given; it is taken as 0"));
        }
    }
    MeasuredSheet { front, back, turn }
}

fn tables(side: ScatterSide) -> SheetTables {
    let table = |matrix: Option<BsdfMatrix>| {
        let BsdfMatrix { pairs, values } = matrix?;
        BsdfTable::new(pairs, &values).map(DirectedTable::new)
    };
    SheetTables { reflection: table(side.reflection), transmission: table(side.transmission) }
}

/// The sheet without excess of energy, or what is wrong.
fn conserving(sheet: MeasuredSheet, remarks: &mut Vec<String>) -> Result<MeasuredSheet, String> {
    let sides = [("front", &sheet.front), ("back", &sheet.back)];
    let most = sides.map(|(name, side)| (name, largest_share(side)));
    let (name, (share, angle)) = if most[1].1.0 > most[0].1.0 { most[1] } else { most[0] };
    if share <= 1.0 {
        return Ok(sheet);
    }
    let angle = format_fixed(angle.to_degrees(), 1);
    let what = format!(
        "of light that meets the {name} at {angle} deg, {} is reflected and transmitted",
        format_percent(share)
    );
    if share > 1.0 + MOST_EXCESS {
        let [front, back] = [&sheet.front, &sheet.back].map(|side| side.transmission.as_ref());
        let is_reverse = front.zip(back).is_some_and(|(front, back)| front.is_reverse_of(back));
        let cause = if is_reverse { ", or transmission is not reciprocal" } else { "" };
        return Err(format!("{what}, more than 100 %; values may not be in 1/sr{cause}"));
    }
    remarks.push(format!("{what}; all values are scaled down to 100 %"));
    let scaled = |side: SheetTables| {
        let [reflection, transmission] = [side.reflection, side.transmission]
            .map(|table| table.map(|table| table.scaled((1.0 - f64::EPSILON) / share)));
        SheetTables { reflection, transmission }
    };
    Ok(MeasuredSheet { front: scaled(sheet.front), back: scaled(sheet.back), turn: sheet.turn })
}

/// The largest difference of the shares that two tables pass on from a direction, 1.
fn largest_difference(a: &DirectedTable, b: &DirectedTable) -> f64 {
    let directions = common_directions(&[a.incident_patches(), b.incident_patches()]);
    let differences = directions.into_iter().map(|from| (a.share(from) - b.share(from)).abs());
    differences.fold(0.0, f64::max)
}

/// The largest share of light that leaves in any direction, 1, and its angle of incidence, rad.
fn largest_share(side: &SheetTables) -> (f64, f64) {
    let tables = [&side.reflection, &side.transmission].map(Option::as_ref);
    let tables: Vec<&DirectedTable> = tables.into_iter().flatten().collect();
    let divisions: Vec<_> = tables.iter().map(|table| table.incident_patches()).collect();
    let shares = common_directions(&divisions).into_iter().map(|from| {
        let share: f64 = tables.iter().map(|table| table.share(from)).sum();
        (share, from.length().min(1.0).asin())
    });
    shares.fold((0.0, 0.0), |most, own| if own.0 > most.0 { own } else { most })
}

/// What checks of energy and reciprocity find of a sheet, in words.
pub fn sheet_checks(sheet: &MeasuredSheet) -> String {
    let sides = [&sheet.front, &sheet.back];
    let most = sides.map(|side| largest_share(side).0).into_iter().fold(0.0, f64::max);
    let energy = format!("at most {} of the light from a direction leaves", format_percent(most));
    match reciprocity(sheet) {
        (what, error) if error > 0.0 => format!(
            "{energy}; over its patches, its {what} differs from that of the paths backwards by {} (rms)",
            format_percent(error)
        ),
        _ => format!("{energy}; its values are the same for the paths backwards"),
    }
}

/// What differs most from the paths backwards, and how much, 1.
fn reciprocity(sheet: &MeasuredSheet) -> (&'static str, f64) {
    let MeasuredSheet { front, back, .. } = sheet;
    let pairs = [
        ("reflection by the front", &front.reflection, &front.reflection),
        ("reflection by the back", &back.reflection, &back.reflection),
        ("transmission", &front.transmission, &back.transmission),
    ];
    let errors = pairs.into_iter().filter_map(|(what, table, backwards)| {
        let (table, backwards) = (table.as_ref()?, backwards.as_ref()?);
        // A reverse is reciprocal.
        (!table.is_reverse_of(backwards)).then(|| (what, table.reciprocity_error(backwards)))
    });
    errors.fold(("", 0.0), |most, own| if own.1 > most.1 { own } else { most })
}
