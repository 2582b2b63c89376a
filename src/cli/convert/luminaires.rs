//! Luminaires from one format to another.

use lumiduct_base::error::{Error, Result};
use lumiduct_base::number::{format_exact, format_value};
use lumiduct_files::luminaire::{
    LampFlux, Luminaire, LuminaireColour, LuminaireError, LuminaireFormat, ReadLuminaire,
    WrittenLuminaire, read, written,
};
use lumiduct_report::{Existing, write_whole};
use std::fmt::Write;
use std::path::Path;

/// Writes the file, and describes the luminaire.
pub(super) fn converted(
    from: &Path,
    to: Option<(&Path, LuminaireFormat)>,
    existing: Existing,
) -> Result<String> {
    let wrong = |error: LuminaireError| Error::Usage(format!("{}: {error}", from.display()));
    let ReadLuminaire { luminaire, remarks, .. } = read(from).map_err(wrong)?;
    let mut text = description(&luminaire);
    for remark in remarks {
        _ = writeln!(text, "remark: {remark}");
    }
    if let Some((to, format)) = to {
        let WrittenLuminaire { text: file, remarks } = written(&luminaire, format);
        write_whole(to, file.as_bytes(), existing)?;
        let lost = format.keywords_left_out(&luminaire);
        let lost = (!lost.is_empty()).then(|| {
            format!("{format} has no field for the texts of {}; they are left out", lost.join(", "))
        });
        for remark in remarks.into_iter().chain(lost) {
            _ = writeln!(text, "remark: {remark}");
        }
        _ = writeln!(text, "written: {} ({format})", to.display());
    }
    Ok(text)
}

/// A luminaire in a few lines.
fn description(luminaire: &Luminaire) -> String {
    let Luminaire { generation, lamps, power_w, opening, colour, intensities, .. } = luminaire;
    let mut text = String::new();
    for (name, keyword) in
        [("manufacturer", "MANUFAC"), ("luminaire", "LUMINAIRE"), ("catalogue number", "LUMCAT")]
    {
        if let Some(own) = luminaire.text(keyword) {
            _ = writeln!(text, "{name}: {own}");
        }
    }
    if let Some(name) = generation.name() {
        _ = writeln!(text, "intensities: {name}");
    }
    let flux = intensities.flux();
    _ = writeln!(
        text,
        "flux: {} lm, of it {} lm below 90°",
        format_value(flux),
        format_value(intensities.flux_between(0.0, 90.0))
    );
    _ = match (lamps, luminaire.light_output_ratio()) {
        (LampFlux::Relative { count, flux_lm }, Some(ratio)) => {
            writeln!(
                text,
                "lamps: {count} with {} lm, light output ratio {}",
                format_exact(*flux_lm),
                format_value(ratio)
            )
        }
        _ => writeln!(text, "lamps: absolute photometry"),
    };
    let ends = |angles: &[f64]| {
        format!("{} from {}° to {}°", angles.len(), angles[0], angles[angles.len() - 1])
    };
    _ = writeln!(text, "peak: {} cd", format_value(intensities.peak()));
    _ = writeln!(
        text,
        "planes: {}, symmetry {}",
        ends(intensities.planes_deg()),
        intensities.symmetry().name()
    );
    _ = writeln!(text, "angles: {}", ends(intensities.angles_deg()));
    let shape = if opening.is_round { "round" } else { "rectangular" };
    let sizes = [opening.along_c0_mm, opening.along_c90_mm, opening.height_mm].map(format_exact);
    let [along_c0, along_c90, height] = sizes;
    _ = writeln!(
        text,
        "opening: {shape}, {along_c0} mm along C0, {along_c90} mm along C90, {height} mm high"
    );
    if *power_w > 0.0 {
        _ = writeln!(text, "power: {} W", format_exact(*power_w));
    }
    let LuminaireColour { temperature, rendering } = colour;
    for (name, words) in [("colour temperature", temperature), ("colour rendering", rendering)] {
        if !words.is_empty() {
            _ = writeln!(text, "{name}: {words}");
        }
    }
    text
}
