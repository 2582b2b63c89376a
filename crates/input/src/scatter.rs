//! Sheets from what files say of their scatter, with checks of energy and reciprocity.

use lumiduct_base::math::common_directions;
use lumiduct_base::number::{format_fixed, format_percent};
use lumiduct_core::optics::{
    BsdfTable, DirectedTable, MeasuredSheet, SheetChecks, SheetPart, SheetSide, SheetTables,
};
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
    let lines = [&front, &back].map(TableLines::of);
    let sides = both_sides([front, back], &mut remarks);
    let most = LargestShare::of(&sides);
    let sides = conserving(sides, &most, &mut remarks)
        .map_err(|problem| format!("line {}: {problem}", most.line(lines)))?;
    let irreversible = least_reversible(&sides);
    // Scaled down where it was more.
    let largest_share = most.share.min(1.0);
    let checks = SheetChecks { largest_share, irreversible };
    if irreversible.is_some_and(|(_, error)| error > RECIPROCAL) {
        remarks.push(format!("{checks}; the values are used as they are"));
    }
    let [front, back] = sides;
    Ok((MeasuredSheet { front, back, turn, checks }, remarks))
}

/// The tables of both sides. Transmission that is given for one side alone is taken as reciprocal.
fn both_sides(sides: [ScatterSide; 2], remarks: &mut Vec<String>) -> [SheetTables; 2] {
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
    [front, back]
}

fn tables(side: ScatterSide) -> SheetTables {
    let table = |matrix: Option<BsdfMatrix>| {
        let BsdfMatrix { pairs, values, .. } = matrix?;
        BsdfTable::new(pairs, &values).map(DirectedTable::new)
    };
    SheetTables { reflection: table(side.reflection), transmission: table(side.transmission) }
}

/// Lines of the first values of the tables of a side, from 1.
#[derive(Clone, Copy)]
struct TableLines {
    reflection: Option<usize>,
    transmission: Option<usize>,
}

impl TableLines {
    fn of(side: &ScatterSide) -> Self {
        let line = |matrix: &Option<BsdfMatrix>| matrix.as_ref().map(|matrix| matrix.line);
        Self { reflection: line(&side.reflection), transmission: line(&side.transmission) }
    }
}

/// The largest share of light from a direction that leaves a sheet.
struct LargestShare {
    /// The side that the light meets.
    side: SheetSide,
    /// The share, 1.
    share: f64,
    /// How much of it is reflected, 1.
    reflected: f64,
    /// Its angle of incidence, rad.
    angle: f64,
}

impl LargestShare {
    fn of([front, back]: &[SheetTables; 2]) -> Self {
        let [front, back] = [(SheetSide::Front, front), (SheetSide::Back, back)]
            .map(|(side, tables)| Self::of_side(side, tables));
        if back.share > front.share { back } else { front }
    }

    fn of_side(side: SheetSide, tables: &SheetTables) -> Self {
        let all = [&tables.reflection, &tables.transmission].map(Option::as_ref);
        let divisions: Vec<_> =
            all.into_iter().flatten().map(|table| table.incident_patches()).collect();
        let shares = common_directions(&divisions).into_iter().map(|from| {
            let [reflected, transmitted] =
                all.map(|table| table.map_or(0.0, |table| table.share(from)));
            let angle = from.length().min(1.0).asin();
            Self { side, share: reflected + transmitted, reflected, angle }
        });
        let none = Self { side, share: 0.0, reflected: 0.0, angle: 0.0 };
        shares.fold(none, |most, own| if own.share > most.share { own } else { most })
    }

    /// The line of the first value of the table with the larger part of it, from 1.
    fn line(&self, [front, back]: [TableLines; 2]) -> usize {
        let (own, other) = match self.side {
            SheetSide::Front => (front, back),
            SheetSide::Back => (back, front),
        };
        // Transmission may be the reverse of that from the other side.
        let transmission = own.transmission.or(other.transmission);
        let is_reflected = 2.0 * self.reflected > self.share;
        let line = if is_reflected { own.reflection } else { transmission };
        line.expect("light that leaves is that of a table")
    }
}

/// Both sides without excess of energy, or what is wrong.
fn conserving(
    sides: [SheetTables; 2],
    most: &LargestShare,
    remarks: &mut Vec<String>,
) -> Result<[SheetTables; 2], String> {
    let share = most.share;
    if share <= 1.0 {
        return Ok(sides);
    }
    let name = match most.side {
        SheetSide::Front => "front",
        SheetSide::Back => "back",
    };
    let angle = format_fixed(most.angle.to_degrees(), 1);
    let what = format!(
        "of light that meets the {name} at {angle} deg, {} is reflected and transmitted",
        format_percent(share)
    );
    if share > 1.0 + MOST_EXCESS {
        let [front, back] = sides.each_ref().map(|side| side.transmission.as_ref());
        let is_reverse = front.zip(back).is_some_and(|(front, back)| front.is_reverse_of(back));
        let cause = if is_reverse { ", or transmission is not reciprocal" } else { "" };
        return Err(format!("{what}, more than 100 %; values may not be in 1/sr{cause}"));
    }
    remarks.push(format!("{what}; all values are scaled down to 100 %"));
    Ok(sides.map(|side| {
        let [reflection, transmission] = [side.reflection, side.transmission]
            .map(|table| table.map(|table| table.scaled((1.0 - f64::EPSILON) / share)));
        SheetTables { reflection, transmission }
    }))
}

/// The largest difference of the shares that two tables pass on from a direction, 1.
fn largest_difference(a: &DirectedTable, b: &DirectedTable) -> f64 {
    let directions = common_directions(&[a.incident_patches(), b.incident_patches()]);
    let differences = directions.into_iter().map(|from| (a.share(from) - b.share(from)).abs());
    differences.fold(0.0, f64::max)
}

/// What differs most from the reversed paths, and how much, 1.
fn least_reversible([front, back]: &[SheetTables; 2]) -> Option<(SheetPart, f64)> {
    let pairs = [
        (SheetPart::FrontReflection, &front.reflection, &front.reflection),
        (SheetPart::BackReflection, &back.reflection, &back.reflection),
        (SheetPart::Transmission, &front.transmission, &back.transmission),
    ];
    let errors = pairs.into_iter().filter_map(|(part, table, backwards)| {
        let (table, backwards) = (table.as_ref()?, backwards.as_ref()?);
        // A reverse is reciprocal.
        (!table.is_reverse_of(backwards)).then(|| (part, table.reciprocity_error(backwards)))
    });
    errors.max_by(|a, b| a.1.total_cmp(&b.1))
}
