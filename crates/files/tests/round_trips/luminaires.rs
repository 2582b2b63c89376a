//! Luminaires in LM-63 and EULUMDAT.

use crate::{Verdict, config, text};
use lumiduct_files::luminaire::{
    FileGeneration, Intensities, LampFlux, Luminaire, LuminaireColour, LuminaireFormat, Opening,
    PlaneSymmetry, parse, written,
};
use proptest::array::{uniform2, uniform3};
use proptest::collection::{btree_set, vec};
use proptest::prelude::*;
use proptest::sample::select;

/// Most planes and most angles of a random luminaire.
const MOST: [usize; 2] = [33, 16];
/// Keywords for which EULUMDAT has a field.
const FIELDS: [&str; 6] = ["MANUFAC", "TEST", "LUMINAIRE", "LUMCAT", "ISSUEDATE", "LAMP"];

fn intensities() -> impl Strategy<Value = Intensities> {
    let symmetry = select(vec![
        PlaneSymmetry::Rotational,
        PlaneSymmetry::Quadrants,
        PlaneSymmetry::AboutC0,
        PlaneSymmetry::AboutC90,
        PlaneSymmetry::None,
    ]);
    // Quarters of degrees have mirror images without rounding; hundredths have up to five digits.
    let (quarters, hundredths) =
        (btree_set(1..1440u32, 0..16), btree_set(0..=18_000u32, 2..=MOST[1]));
    let candela = prop_oneof![1 => Just(0.0f64), 9 => (-1.0..5.0f64).prop_map(|n| 10f64.powf(n))];
    let candela = vec(candela, MOST[0] * MOST[1]);
    let parts = (symmetry, quarters, any::<bool>(), hundredths, candela);
    parts.prop_map(|(symmetry, mut quarters, is_mirrored, hundredths, mut candela)| {
        if is_mirrored {
            let images: Vec<u32> = quarters.iter().map(|at| 1440 - at).collect();
            quarters.extend(images);
            quarters.insert(720);
        }
        let [first, last] = match symmetry {
            PlaneSymmetry::Rotational => [0, 0],
            PlaneSymmetry::Quadrants => [0, 360],
            PlaneSymmetry::AboutC0 => [0, 720],
            PlaneSymmetry::AboutC90 => [360, 1080],
            PlaneSymmetry::None => [0, 1440],
        };
        quarters.extend([first, last]);
        quarters.retain(|at| (first..=last).contains(at) && *at < 1440);
        let planes: Vec<f64> = quarters.into_iter().map(|at| f64::from(at) / 4.0).collect();
        let angles: Vec<f64> = hundredths.into_iter().map(|at| f64::from(at) / 100.0).collect();
        candela.truncate(planes.len() * angles.len());
        Intensities::new(symmetry, planes, angles, candela).unwrap()
    })
}

fn opening() -> impl Strategy<Value = Opening> {
    // A rectangle, a circle, an ellipse or a point.
    (0..4usize, uniform3(1..20_000u32)).prop_map(|(shape, tenths)| {
        let [a, b, height_mm] = tenths.map(|tenth| f64::from(tenth) / 10.0);
        let [along_c0_mm, along_c90_mm] = [[a, b], [a, a], [a, b], [0.0; 2]][shape];
        Opening { is_round: shape == 1 || shape == 2, along_c0_mm, along_c90_mm, height_mm }
    })
}

fn luminaire() -> impl Strategy<Value = Luminaire> {
    let keywords = [&FIELDS[..], &["TESTLAB", "LAMPCAT", "OTHER", "_OWN-1"]].concat();
    let texts = (select(keywords), text()).prop_map(|(keyword, text)| {
        let text = if keyword == "OTHER" { format!("{text}\n{text}") } else { text };
        (keyword.to_owned(), text)
    });
    let measured = any::<[bool; 3]>().prop_map(|[is_accredited, is_interpolated, is_scaled]| {
        FileGeneration::Measured { is_accredited, is_interpolated, is_scaled }
    });
    let generation =
        prop_oneof![Just(FileGeneration::Undefined), Just(FileGeneration::Simulated), measured];
    let relative = (1..100u32, 10_000..1_000_000u32)
        .prop_map(|(count, lumens)| LampFlux::Relative { count, flux_lm: f64::from(lumens) });
    let lamps = prop_oneof![Just(LampFlux::Absolute), relative];
    let power = prop_oneof![Just(0.0f64), 0.1..1000.0f64];
    let words = uniform2(prop_oneof![Just(String::new()), text()]);
    let parts = (vec(texts, 0..8), generation, lamps, power, opening(), words, intensities());
    parts.prop_map(|(texts, generation, lamps, power_w, opening, words, intensities)| {
        let [temperature, rendering] = words;
        let colour = LuminaireColour { temperature, rendering };
        Luminaire { texts, generation, lamps, power_w, opening, colour, intensities }
    })
}

/// Whether two numbers are the same to seven digits: within half a unit of the last one, and rounding.
fn is_same(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 5.2e-7 * expected
}

/// Whether EULUMDAT can name the planes of a symmetry about C90-C270: it needs equal quarters, and plane 180.
fn has_equal_quarters(planes: &[f64]) -> bool {
    let below = planes.iter().filter(|plane| **plane < 180.0).count();
    planes.contains(&180.0) && planes.len() == 2 * below + 1
}

/// Whether sums that EULUMDAT states are not so near to the middle of two written numbers that nine digits of intensities may
/// move them from one to the other.
fn rounds_clearly(own: &Luminaire) -> bool {
    let is_clear = |value: f64, unit: f64| ((value / unit).rem_euclid(1.0) - 0.5).abs() > 0.06;
    let flux = own.intensities.flux();
    let whole = match own.lamps {
        LampFlux::Absolute => is_clear(flux, 10f64.powf(flux.log10().floor() - 6.0)),
        LampFlux::Relative { flux_lm, .. } => is_clear(100.0 * flux / flux_lm, 0.01),
    };
    whole && is_clear(100.0 * own.intensities.flux_between(0.0, 90.0) / flux, 0.01)
}

/// What LM-63 has no keyword for becomes a text OTHER; EULUMDAT has the texts of its fields.
fn words_come_back(own: &Luminaire, back: &Luminaire, format: LuminaireFormat) -> Verdict {
    match format {
        LuminaireFormat::Ies | LuminaireFormat::Ies2019 => {
            let LuminaireColour { temperature, rendering } = &own.colour;
            let colour = [("colour temperature", temperature), ("colour rendering", rendering)];
            let colour = colour.into_iter().filter(|(_, words)| !words.is_empty());
            let mut texts = own.texts.clone();
            texts.extend(
                colour.map(|(what, words)| ("OTHER".to_owned(), format!("{what}: {words}"))),
            );
            prop_assert_eq!(&back.texts, &texts);
        }
        LuminaireFormat::Ldt | LuminaireFormat::Tm33 => {
            prop_assert_eq!(
                FIELDS.map(|field| back.text(field)),
                FIELDS.map(|field| own.text(field))
            );
            prop_assert_eq!(&back.colour, &own.colour);
        }
    }
    let keeps_generation = format == LuminaireFormat::Ies2019;
    let generation = if keeps_generation { own.generation } else { FileGeneration::Undefined };
    prop_assert_eq!(back.generation, generation);
    Ok(())
}

fn luminaire_comes_back(own: &Luminaire, format: LuminaireFormat) -> Verdict {
    let file = written(own, format).text;
    let back = parse(file.as_bytes(), format)?.luminaire;
    let (light, read) = (&own.intensities, &back.intensities);
    let is_ldt = format == LuminaireFormat::Ldt;
    let is_named =
        light.symmetry() != PlaneSymmetry::AboutC90 || has_equal_quarters(light.planes_deg());
    let circle = light.circle();
    let (symmetry, planes) = match is_ldt && !is_named {
        true => (PlaneSymmetry::None, &circle[..]),
        false => (light.symmetry(), light.planes_deg()),
    };
    prop_assert_eq!((read.symmetry(), read.planes_deg()), (symmetry, planes));
    prop_assert_eq!(read.angles_deg(), light.angles_deg());
    for plane in circle {
        for angle in light.angles_deg() {
            let both = [read.at(plane, *angle), light.at(plane, *angle)];
            prop_assert!(is_same(both[0], both[1]), "{format}, {plane}, {angle}: {both:?}");
        }
    }
    prop_assert!(is_same(read.flux(), light.flux()), "{format}");
    let lamps = |of: &Luminaire| match of.lamps {
        LampFlux::Absolute => (None, 0.0),
        LampFlux::Relative { count, flux_lm } => (Some(count), flux_lm),
    };
    prop_assert_eq!(lamps(&back).0, lamps(own).0);
    let mut expected = own.opening;
    if is_ldt && expected.is_round {
        // A circle of the same area.
        let diameter = (expected.along_c0_mm * expected.along_c90_mm).sqrt();
        (expected.along_c0_mm, expected.along_c90_mm) = (diameter, diameter);
    }
    prop_assert_eq!(back.opening.is_round, expected.is_round);
    let sizes = |of: &Opening| [of.along_c0_mm, of.along_c90_mm, of.height_mm];
    let pairs = sizes(&back.opening).into_iter().zip(sizes(&expected));
    for (found, expected) in
        pairs.chain([(back.power_w, own.power_w), (lamps(&back).1, lamps(own).1)])
    {
        prop_assert!(is_same(found, expected), "{format}: {found} {expected}");
    }
    words_come_back(own, &back, format)?;
    if !is_ldt || rounds_clearly(own) {
        prop_assert_eq!(&written(&back, format).text, &file);
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(256))]

    #[test]
    fn luminaires_come_back(own in luminaire()) {
        for format in [LuminaireFormat::Ies, LuminaireFormat::Ies2019, LuminaireFormat::Ldt] {
            luminaire_comes_back(&own, format)?;
        }
    }
}
