//! What the page of a report says of a luminaire: its intensities, its flux by zones, its luminance, and its glare in standard rooms.

use crate::luminaire::ugr::{REFLECTANCES, ROOMS, ViewPlane, ratings};
use crate::luminaire::{MeasuredLuminaire, NEGLIGIBLE_FLUX};
use crate::page::{Block, table};
use lumiduct_base::number::{
    format_exact, format_fixed, format_percent, format_value, format_with_error,
};
use lumiduct_files::luminaire::{LampFlux, Luminaire, Opening, PlaneSymmetry};
use std::f64::consts::PI;

/// Zones of the summary of flux, deg.
const ZONES: [[f64; 2]; 8] = [
    [0.0, 30.0],
    [0.0, 40.0],
    [0.0, 60.0],
    [60.0, 90.0],
    [0.0, 90.0],
    [90.0, 120.0],
    [90.0, 180.0],
    [0.0, 180.0],
];
/// Angles γ and planes of the table of luminance, deg.
const LUMINANCE_ANGLES: [f64; 5] = [45.0, 55.0, 65.0, 75.0, 85.0];
const LUMINANCE_PLANES: [f64; 3] = [0.0, 45.0, 90.0];
/// Angle from which luminaires may be mirrored in screens, deg, and the limits of their average luminance there, cd/m²
/// (EN 12464-1:2021, luminance limits of luminaires for work with display screen equipment).
const SCREEN_ANGLE: f64 = 65.0;
const SCREEN_LIMITS: [f64; 3] = [1000.0, 1500.0, 3000.0];
/// Largest angle at which luminance is judged, deg: a flat opening has no projected area at 90.
const LAST_ANGLE: f64 = 85.0;
/// Most planes and angles in a table for reading.
const MOST_PLANES: usize = 8;
const MOST_ANGLES: usize = 40;

/// The part of a page on the luminaire files of a sensor.
pub(crate) fn blocks(luminaires: &[MeasuredLuminaire], sensor: &str) -> Vec<Block> {
    let Some(found) = luminaires.iter().find(|found| found.sensor == sensor) else {
        return Vec::new();
    };
    let mut blocks = vec![Block::Heading { text: "Luminaire".into() }];
    blocks.push(Block::Words { text: summary(found) });
    blocks.push(Block::Words { text: "Luminous intensities in cd:".into() });
    blocks.push(candela_table(found));
    blocks.push(zonal_flux(&found.luminaire));
    if let Some(area) = emitting_area_m2(found) {
        blocks.extend(luminances(&found.luminaire, area));
        blocks.extend(ugr_table(&found.luminaire, area));
    }
    blocks
}

fn summary(found: &MeasuredLuminaire) -> String {
    let Luminaire { lamps, opening, intensities, power_w, .. } = &found.luminaire;
    let files: Vec<String> = found.formats.iter().map(|format| found.file_name(*format)).collect();
    let flux = intensities.flux();
    let symmetry = match intensities.symmetry() {
        PlaneSymmetry::None => "without symmetry".to_owned(),
        symmetry => format!("symmetry: {}", symmetry.name()),
    };
    let error = found.std_errors.iter().copied().fold(0.0, f64::max);
    let error = if error.is_finite() {
        format!("The standard error of a value is at most {} cd.", format_value(error))
    } else {
        "The errors of the values are not known.".to_owned()
    };
    let name = if files.is_empty() { found.sensor.clone() } else { files.join(" and ") };
    let mut text = format!(
        "{name}: {} lm, peak {} cd, {symmetry}. Between the values of the table, intensities are linear in both angles; of all such \
            tables this one fits the cells of the goniometer best, and it has their flux. {error}",
        format_value(flux),
        format_value(intensities.peak()),
    );
    if let Some(distance) = found.distance_mm {
        let distance = format_value(distance);
        text += &format!(
            " An intensity is the illuminance at a distance of {distance} mm times distance squared."
        );
    }
    text += &match lamps {
        LampFlux::Absolute => " The photometry is absolute.".to_owned(),
        LampFlux::Relative { count, flux_lm } => {
            let lamps = if *count == 1 { "1 lamp".to_owned() } else { format!("{count} lamps") };
            format!(
                " The photometry is relative to {lamps} with {} lm: light output ratio {}.",
                format_value(*flux_lm),
                format_percent(flux / flux_lm)
            )
        }
    };
    if *power_w > 0.0 {
        text += &format!(
            " With {} W it has {} lm/W.",
            format_exact(*power_w),
            format_value(flux / power_w)
        );
    }
    let [x, y] = [opening.along_c0_mm, opening.along_c90_mm].map(format_exact);
    match (opening.is_round, opening.along_c0_mm > 0.0) {
        (true, true) => text += &format!(" Its opening is a disk of {x} mm."),
        (false, true) => text += &format!(" Its opening is {x} mm along C0 by {y} mm along C90."),
        (_, false) => {}
    }
    text
}

/// The intensities at some planes and angles, with the errors of the values.
fn candela_table(found: &MeasuredLuminaire) -> Block {
    let intensities = &found.luminaire.intensities;
    let (planes, angles) = (intensities.planes_deg(), intensities.angles_deg());
    let is_lit =
        |angle: usize| (0..planes.len()).any(|plane| intensities.plane(plane)[angle] > 0.0);
    // Up to the first dark angle above all light.
    let lit = (0..angles.len()).rposition(is_lit).map_or(0, |last| last + 2).min(angles.len());
    let shown = |count: usize, most: usize| -> Vec<usize> {
        (0..count).step_by(count.div_ceil(most).max(1)).collect()
    };
    let columns = shown(planes.len(), MOST_PLANES);
    let rows = shown(lit, MOST_ANGLES);
    let head: Vec<String> = std::iter::once("γ".to_owned())
        .chain(columns.iter().map(|place| format!("C{}", format_exact(planes[*place]))))
        .collect();
    let row = |angle: &usize| {
        let values = columns.iter().map(|plane| {
            format_with_error(intensities.plane(*plane)[*angle], found.std_errors[[*plane, *angle]])
        });
        std::iter::once(format!("{}°", format_exact(angles[*angle]))).chain(values).collect()
    };
    table(&head, rows.iter().map(row).collect())
}

fn zonal_flux(luminaire: &Luminaire) -> Block {
    let Luminaire { lamps, intensities, .. } = luminaire;
    let all = intensities.flux();
    let percent = |part: f64, whole: f64| {
        if whole > 0.0 { format_percent(part / whole) } else { String::new() }
    };
    let row = |[from, to]: [f64; 2]| {
        let flux = intensities.flux_between(from, to);
        let mut row = vec![
            format!("{}° to {}°", format_exact(from), format_exact(to)),
            format!("{} lm", format_value(flux)),
            percent(flux, all),
        ];
        if let LampFlux::Relative { flux_lm, .. } = lamps {
            row.push(percent(flux, *flux_lm));
        }
        row
    };
    let mut head = vec!["zone", "flux", "of the luminaire"];
    if let LampFlux::Relative { .. } = lamps {
        head.push("of the lamps");
    }
    table(&head, ZONES.map(row).into())
}

/// Average luminance of an opening of this area, m², at steep angles.
fn luminances(luminaire: &Luminaire, area: f64) -> Vec<Block> {
    let intensities = &luminaire.intensities;
    let luminance =
        |plane: f64, angle: f64| intensities.at(plane, angle) / (area * angle.to_radians().cos());
    let rows = LUMINANCE_ANGLES.map(|angle| {
        let values = LUMINANCE_PLANES.map(|plane| format_value(luminance(plane, angle)));
        std::iter::once(format!("{}°", format_exact(angle))).chain(values).collect()
    });
    let head: Vec<String> = std::iter::once("γ".to_owned())
        .chain(LUMINANCE_PLANES.map(|plane| format!("C{}", format_exact(plane))))
        .collect();
    let steep = intensities.angles_deg().iter().copied();
    let steep = steep.filter(|angle| (SCREEN_ANGLE..LAST_ANGLE).contains(angle));
    let most = steep
        .chain([SCREEN_ANGLE, LAST_ANGLE])
        .flat_map(|angle| intensities.circle().into_iter().map(move |plane| (plane, angle)))
        .map(|(plane, angle)| luminance(plane, angle))
        .fold(0.0, f64::max);
    let limits = SCREEN_LIMITS.map(|limit| {
        let word = if most <= limit { "met" } else { "exceeded" };
        format!("{} {word}", format_exact(limit))
    });
    let text = format!(
        "At the angles of the table from {}° to {}° it is at most {} cd/m². Limits for work with screens (EN 12464-1): {}.",
        format_exact(SCREEN_ANGLE),
        format_exact(LAST_ANGLE),
        format_value(most),
        limits.join(", ")
    );
    let head_text =
        "Average luminance of the opening in cd/m², the intensity over its projected area:";
    vec![Block::Words { text: head_text.into() }, table(&head, rows.into()), Block::Words { text }]
}

/// Unified glare ratings in standard rooms with luminaires that have an opening of this area, m²; why there are none without symmetry.
fn ugr_table(luminaire: &Luminaire, area: f64) -> Vec<Block> {
    let intensities = &luminaire.intensities;
    let views: &[(&str, ViewPlane)] = match intensities.symmetry() {
        PlaneSymmetry::Rotational => &[("", ViewPlane::C0)],
        PlaneSymmetry::Quadrants => &[("C0 ", ViewPlane::C0), ("C90 ", ViewPlane::C90)],
        PlaneSymmetry::AboutC0 | PlaneSymmetry::AboutC90 | PlaneSymmetry::None => {
            let text = "The UGR table is for luminaires that are symmetric about C0 and C90, or rotationally.";
            return vec![Block::Words { text: text.into() }];
        }
    };
    if intensities.flux() == 0.0 {
        return Vec::new();
    }
    let of_view = |(name, _): &(&str, ViewPlane)| {
        let name = (*name).to_owned();
        REFLECTANCES.map(|all| name.clone() + &all.map(format_exact).join("/"))
    };
    let head: Vec<String> =
        std::iter::once("room".to_owned()).chain(views.iter().flat_map(of_view)).collect();
    let row = |room: [f64; 2]| {
        let ratings = views.iter().flat_map(|(_, view)| ratings(intensities, area, room, *view));
        let [width, length] = room.map(format_exact);
        std::iter::once(format!("{width}H × {length}H"))
            .chain(ratings.map(|rating| format_fixed(rating, 1)))
            .collect()
    };
    let view = match views {
        [_] => "",
        _ => "the C plane along the line of sight, and ",
    };
    let text = format!(
        "Unified glare rating (UGR, CIE 117) in the standard rooms of CIE 190. Rows: width across the line of sight by length along it, where H = 2 m is the \
            height of the luminaires above the eye; the luminaires are 0.25 H apart. Columns: {view}the reflectances of ceiling, walls and floor. The light of the \
            background is computed by form factors, so ratings differ by about 0.2 from those by the tables of CIE 190."
    );
    vec![Block::Words { text }, table(&head, ROOMS.map(row).into())]
}

/// Area of the opening, m², if it emits all light; `None` for a point, a line, or with light that a flat opening cannot emit.
fn emitting_area_m2(found: &MeasuredLuminaire) -> Option<f64> {
    area_m2(&found.luminaire.opening).filter(|_| found.upward_share <= NEGLIGIBLE_FLUX)
}

/// Area of a flat opening, m²; `None` for a point or a line.
fn area_m2(opening: &Opening) -> Option<f64> {
    let box_area = opening.along_c0_mm * opening.along_c90_mm * 1e-6;
    let area = if opening.is_round { 0.25 * PI * box_area } else { box_area };
    (area > 0.0).then_some(area)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumiduct_files::luminaire::{FileGeneration, Intensities, LuminaireColour};
    use ndarray::Array2;

    /// A Lambertian disk of 100 mm with 1000 cd along its axis: the same luminance in all directions, I / (π r²), and sin² γ of its flux
    /// within γ.
    fn lambertian(lamps: LampFlux) -> MeasuredLuminaire {
        let angles: Vec<f64> = (0..=180).map(f64::from).collect();
        let of = |angle: &f64| if *angle < 90.0 { 1000.0 * angle.to_radians().cos() } else { 0.0 };
        let candela = angles.iter().map(of).collect();
        let intensities =
            Intensities::new(PlaneSymmetry::Rotational, vec![0.0], angles, candela).unwrap();
        let opening =
            Opening { is_round: true, along_c0_mm: 100.0, along_c90_mm: 100.0, height_mm: 0.0 };
        MeasuredLuminaire {
            sensor: "far".into(),
            formats: Vec::new(),
            luminaire: Luminaire {
                texts: Vec::new(),
                generation: FileGeneration::Simulated,
                lamps,
                power_w: 0.0,
                opening,
                colour: LuminaireColour::default(),
                intensities,
            },
            distance_mm: None,
            std_errors: Array2::zeros((1, 181)),
            upward_share: 0.0,
            remarks: Vec::new(),
        }
    }

    fn rows(blocks: &[Block]) -> Vec<&Vec<String>> {
        let rows = blocks.iter().filter_map(|block| match block {
            Block::Table { rows, .. } => Some(rows),
            Block::Heading { .. }
            | Block::Words { .. }
            | Block::List { .. }
            | Block::Plot { .. }
            | Block::PlotRow { .. } => None,
        });
        rows.flatten().collect()
    }

    #[test]
    fn a_lambertian_disk_has_one_luminance_and_its_zones() {
        let lamps = LampFlux::Relative { count: 1, flux_lm: 4000.0 };
        let all = blocks(&[lambertian(lamps)], "far");
        let rows = rows(&all);
        let row = |head: &str| rows.iter().find(|row| row[0] == head && row.len() > 2).unwrap();
        // 1000 cd / (π (0.05 m)²) = 127 324 cd/m²; between the angles of the table, lines lie below the cosine.
        for angle in ["45°", "65°", "85°"] {
            assert_eq!(row(angle)[1..], ["1.273×10⁵", "1.273×10⁵", "1.273×10⁵"], "{angle}");
        }
        // sin² 30° = 1/4, sin² 60° = 3/4; 3141.6 lm of 4000 lm.
        assert_eq!(row("0° to 30°")[2..], ["25.00 %", "19.63 %"]);
        assert_eq!(row("0° to 60°")[2..], ["75.00 %", "58.90 %"]);
        assert_eq!(row("0° to 180°")[2..], ["100.00 %", "78.54 %"]);
        assert_eq!(row("90° to 180°")[1], "0 lm");
        // The same from all sides: one column for each set of reflectances.
        assert_eq!(row("4H × 8H").len(), 6);
    }

    #[test]
    fn ratings_are_given_for_symmetric_luminaires_with_an_opening() {
        let words = |found: &MeasuredLuminaire| -> String {
            let all = blocks(std::slice::from_ref(found), "far");
            let words = all.iter().filter_map(|block| match block {
                Block::Words { text } => Some(text.as_str()),
                Block::Heading { .. }
                | Block::Table { .. }
                | Block::List { .. }
                | Block::Plot { .. }
                | Block::PlotRow { .. } => None,
            });
            words.collect::<Vec<_>>().join(" ")
        };
        let mut found = lambertian(LampFlux::Absolute);
        assert!(words(&found).contains("Unified glare rating"));
        let values = |symmetry, planes: &[f64]| {
            let candela = vec![1.0; 2 * planes.len()];
            Intensities::new(symmetry, planes.to_vec(), vec![0.0, 90.0], candela).unwrap()
        };
        found.luminaire.intensities = values(PlaneSymmetry::Quadrants, &[0.0, 90.0]);
        found.std_errors = Array2::zeros((2, 2));
        assert!(words(&found).contains("the C plane along the line of sight"));
        found.luminaire.intensities = values(PlaneSymmetry::AboutC0, &[0.0, 180.0]);
        let said = words(&found);
        assert!(said.contains("is for luminaires that are symmetric"), "{said}");
        found.luminaire.opening = Opening::default();
        let said = words(&found);
        assert!(!said.contains("glare") && !said.contains("UGR"), "no opening: {said}");
    }

    #[test]
    fn a_long_table_is_thinned_and_ends_where_the_light_does() {
        let found = lambertian(LampFlux::Absolute);
        let Block::Table { rows, head, .. } = candela_table(&found) else { panic!("no table") };
        assert_eq!(head, ["γ", "C0"]);
        assert!((20..=40).contains(&rows.len()), "{} rows", rows.len());
        assert_eq!([&rows[0][0], &rows[1][0], &rows[rows.len() - 1][0]], ["0°", "3°", "90°"]);
    }
}
