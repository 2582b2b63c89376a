//! Dominant wavelength and excitation purity (CIE 015:2018).

use crate::colour::chromaticity::Chromaticity;
use crate::colour::observer::colour_matching;
use std::sync::LazyLock;

/// The part of the spectrum locus that is used, nm. Above 699 nm its points no longer move, except back and forth by the
/// rounding of the observer.
const RANGE: std::ops::RangeInclusive<u32> = 380..=700;
/// What rounding may move an intersection beyond the end of a side of the locus, in lengths of the side.
const SLACK: f64 = 1e-9;

/// The spectrum locus, every nm.
static LOCUS: LazyLock<Vec<Chromaticity>> = LazyLock::new(|| {
    let colour = |nm| colour_matching(f64::from(nm));
    RANGE.filter_map(|nm| Chromaticity::from_tristimulus(colour(nm))).collect()
});

/// What a wavelength says of a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WavelengthKind {
    /// Its light, added to the white, gives the colour.
    Dominant,
    /// Its light, added to the colour, gives the white: of purples, which no single wavelength matches.
    Complementary,
}

/// The hue and saturation of a colour against a white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DominantWavelength {
    /// Whether the wavelength is dominant or complementary.
    pub kind: WavelengthKind,
    /// The wavelength, nm, from 380 to 700.
    pub nm: f64,
    /// Excitation purity: the distance from the white over that of the spectrum locus or the purple line, in x and y; 1 on
    /// them and 0 for the white. Coordinates with more than 1 belong to no light.
    pub purity: f64,
}

/// The dominant wavelength of a chromaticity against a white such as [`Chromaticity::EQUAL_ENERGY`], or the complementary
/// one where the line from the white meets the purple line; `None` for the white itself and for a white that is no light.
pub fn dominant_wavelength(of: Chromaticity, white: Chromaticity) -> Option<DominantWavelength> {
    let towards = [of.x - white.x, of.y - white.y];
    if let Some((nm, distance)) = spectral_colour(white, towards) {
        let kind = WavelengthKind::Dominant;
        return Some(DominantWavelength { kind, nm, purity: 1.0 / distance });
    }
    let (nm, _) = spectral_colour(white, towards.map(|component| -component))?;
    let (_, distance) = crossing(white, towards, [*LOCUS.last()?, *LOCUS.first()?])?;
    Some(DominantWavelength { kind: WavelengthKind::Complementary, nm, purity: 1.0 / distance })
}

/// Where a ray meets the spectrum locus: the wavelength in nm, and the distance in lengths of `towards`.
fn spectral_colour(from: Chromaticity, towards: [f64; 2]) -> Option<(f64, f64)> {
    let sides = RANGE.zip(LOCUS.windows(2));
    sides.into_iter().find_map(|(nm, side)| {
        let (at, distance) = crossing(from, towards, [side[0], side[1]])?;
        Some((f64::from(nm) + at, distance))
    })
}

/// Where a ray meets a side: the place on the side from 0 to 1, and the distance in lengths of `towards`.
fn crossing(
    from: Chromaticity,
    towards: [f64; 2],
    [start, end]: [Chromaticity; 2],
) -> Option<(f64, f64)> {
    let side = [end.x - start.x, end.y - start.y];
    let offset = [start.x - from.x, start.y - from.y];
    let denominator = cross(towards, side);
    let [at, distance] =
        [cross(offset, towards), cross(offset, side)].map(|area| area / denominator);
    let meets = (-SLACK..=1.0 + SLACK).contains(&at) && distance > 0.0 && distance.is_finite();
    meets.then_some((at.clamp(0.0, 1.0), distance))
}

fn cross([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    a * d - b * c
}

#[cfg(test)]
mod tests {
    use super::*;

    const D65: Chromaticity = Chromaticity { x: 0.3127, y: 0.3290 };
    const WHITES: [Chromaticity; 2] = [Chromaticity::EQUAL_ENERGY, D65];

    #[test]
    fn wavelengths_and_purities_agree_with_an_independent_program() {
        // colour-science 0.4.7, dominant_wavelength (whole nm, negative if complementary) and excitation_purity, whose
        // points of the locus are whole nm too: against E, then against D65.
        let cases = [
            (0.54369557, 0.32107944, [(618.0, 0.594617), (616.0, 0.622886)]),
            (0.37605506, 0.24452225, [(-522.0, 0.426743), (-509.0, 0.438348)]),
            (0.2, 0.6, [(521.0, 0.532630), (524.0, 0.541316)]),
            (0.45, 0.45, [(578.0, 0.702024), (579.0, 0.722826)]),
            (0.15, 0.10, [(471.0, 0.863916), (471.0, 0.854620)]),
            (0.40, 0.35, [(594.0, 0.250433), (595.0, 0.302746)]),
        ];
        for (x, y, expected) in cases {
            for (white, (nm, purity)) in WHITES.into_iter().zip(expected) {
                let own = dominant_wavelength(Chromaticity { x, y }, white).unwrap();
                let signed = match own.kind {
                    WavelengthKind::Dominant => own.nm,
                    WavelengthKind::Complementary => -own.nm,
                };
                assert!((signed - nm).abs() < 0.6, "{x} {y}: {own:?} {nm}");
                assert!((own.purity - purity).abs() < 2e-3, "{x} {y}: {own:?} {purity}");
            }
        }
    }

    #[test]
    fn mixtures_of_white_and_one_wavelength_have_that_wavelength() {
        for white in WHITES {
            for nm in [400.0, 450.0, 500.5, 520.0, 555.0, 600.25, 640.0] {
                let sums = colour_matching(nm);
                let pure = Chromaticity::from_tristimulus(sums).unwrap();
                for purity in [0.01, 0.4, 1.0] {
                    let mix = |white: f64, pure: f64| white + purity * (pure - white);
                    let of = Chromaticity { x: mix(white.x, pure.x), y: mix(white.y, pure.y) };
                    let own = dominant_wavelength(of, white).unwrap();
                    assert_eq!(own.kind, WavelengthKind::Dominant);
                    assert!((own.nm - nm).abs() < 0.1, "{nm}: {own:?}");
                    assert!((own.purity - purity).abs() < 1e-4, "{purity}: {own:?}");
                }
            }
        }
    }

    #[test]
    fn every_direction_has_a_wavelength() {
        for white in WHITES {
            for step in 0..3600 {
                let (sin, cos) = (f64::from(step) * 0.1).to_radians().sin_cos();
                let of = Chromaticity { x: white.x + 0.01 * cos, y: white.y + 0.01 * sin };
                let own = dominant_wavelength(of, white).unwrap();
                assert!((380.0..=700.0).contains(&own.nm), "{own:?}");
                assert!(own.purity > 0.01 && own.purity < 0.1, "{own:?}");
            }
            for end in [LOCUS[0], LOCUS[LOCUS.len() - 1]] {
                let own = dominant_wavelength(end, white).unwrap();
                assert!((own.purity - 1.0).abs() < 1e-6, "{own:?}");
            }
        }
    }

    #[test]
    fn white_and_senseless_colours_have_no_wavelength() {
        let bad = Chromaticity { x: f64::NAN, y: 0.3 };
        assert_eq!(dominant_wavelength(D65, D65), None);
        assert_eq!(dominant_wavelength(bad, D65), None);
        assert_eq!(dominant_wavelength(D65, bad), None);
        assert_eq!(dominant_wavelength(Chromaticity { x: f64::INFINITY, y: 0.3 }, D65), None);
    }
}
