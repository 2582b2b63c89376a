//! Properties of prism films against the angle, as a table.

use lumiduct_base::number::format_value;
use lumiduct_core::optics::film::{acceptance_angle, along_prisms};
use lumiduct_core::optics::{FilmFace, Finish, Incidence, PrismFilm, Shares};
use lumiduct_core::scene::NamedFinish;
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;

/// Sample points per period for the shares, which gives about a thousandth.
const PLACES: u32 = 1000;

/// A table of reflectance, transmittance and loss for each prism film among some finishes, lit from
/// both sides, in steps of the angle from the normal, in degrees, in the plane along the prisms and
/// the plane across them; `None` without any film. `index` is that of the medium around them, 1.
pub fn film_tables(finishes: &[NamedFinish], index: f64, step_deg: f64) -> Option<String> {
    let tables: Vec<String> = finishes
        .iter()
        .enumerate()
        .filter_map(|(place, named)| {
            let Finish::PrismFilm { film, .. } = &named.finish else { return None };
            // The back of a film is the same film and is in its table.
            (!is_behind(named, &finishes[..place]))
                .then(|| table(&named.name, film, index, step_deg))
        })
        .collect();
    (!tables.is_empty()).then(|| tables.join("\n"))
}

/// Whether a finish is the back of one of those before it.
fn is_behind(named: &NamedFinish, finishes: &[NamedFinish]) -> bool {
    let front = named.finish.from_behind();
    finishes.iter().any(|other| Some(&other.finish) == front.as_ref())
}

fn table(name: &str, film: &PrismFilm, index: f64, step_deg: f64) -> String {
    let guided = acceptance_angle(film, index).to_degrees();
    let mut text = format!(
        "Prism film `{name}`\n\nLight that meets the flat face within {guided:.3} degrees of the prism \
            direction is totally reflected at every azimuth about it.\n\nShares in percent, angles from the normal of the film, for \
         unpolarised light; R reflected, T transmitted, A absorbed or lost.\n\n"
    );
    for (face, lit) in
        [(FilmFace::Flat, "Lit on the flat face"), (FilmFace::Prisms, "Lit on the prisms")]
    {
        // Writing to a string cannot fail.
        _ = write!(
            text,
            "{lit}\n\n| angle, ° | R along the prisms | T | A | R across the prisms | T | A |\n|--:|--:|--:|--:|--:|--:|--:|\n"
        );
        let steps = (89.999 / step_deg).floor() as u32;
        for step in 0..=steps {
            let angle = f64::from(step) * step_deg;
            let planes = [FilmPlane::Along, FilmPlane::Across];
            let shares = planes.map(|plane| {
                film.shares(face, &in_plane(plane, angle.to_radians(), index), PLACES)
            });
            let cells = shares.map(cells).join(" | ");
            _ = writeln!(text, "| {} | {cells} |", format_value(angle));
        }
        text.push('\n');
    }
    text
}

/// A plane through the normal of a film.
#[derive(Debug, Clone, Copy)]
enum FilmPlane {
    Along,
    Across,
}

/// Light in a plane at an angle from the normal, rad.
fn in_plane(plane: FilmPlane, angle: f64, index: f64) -> Incidence {
    match plane {
        FilmPlane::Along => along_prisms(FRAC_PI_2 - angle, 0.0, index),
        FilmPlane::Across => along_prisms(FRAC_PI_2, angle, index),
    }
}

fn cells(Shares { reflected, transmitted }: Shares) -> String {
    let lost = (1.0 - reflected - transmitted).max(0.0);
    [reflected, transmitted, lost].map(|share| format!("{:.2}", 100.0 * share)).join(" | ")
}
