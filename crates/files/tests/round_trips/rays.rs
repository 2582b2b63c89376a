//! Rays in every format.

use crate::{Verdict, config, text};
use lumiduct_base::units::FluxUnit;
use lumiduct_files::rays::{
    FileRay, RayFileError, RayFormat, RayReader, RaySetInfo, RayText, write,
};
use proptest::array::uniform3;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;
use std::f64::consts::TAU;

/// A ray; its direction has a length of 1, or one that differs by as much as readers accept.
fn ray() -> impl Strategy<Value = FileRay> {
    let length = prop_oneof![Just(1.0f64), 0.9995..1.0005f64];
    let flux = prop_oneof![1 => Just(0.0f32), 9 => (-20.0..5.0f32).prop_map(|n| 10f32.powf(n))];
    let parts = (uniform3(-1e6..1e6f32), -1.0..1.0f64, 0.0..TAU, length, flux);
    parts.prop_map(|(position_mm, z, azimuth, length, flux)| {
        let (across, (sin, cos)) = ((1.0 - z * z).sqrt(), azimuth.sin_cos());
        let direction = [across * cos, across * sin, z].map(|own| (length * own) as f32);
        FileRay { position_mm, direction, flux }
    })
}

fn file_of(own: &[FileRay], info: &RaySetInfo, format: RayFormat) -> Result<Vec<u8>, RayFileError> {
    let mut file = Vec::new();
    write(&mut file, format, info, own.iter().copied().map(Ok))?;
    Ok(file)
}

fn rays_come_back(own: &[FileRay], info: &RaySetInfo, format: RayFormat) -> Verdict {
    let reader = RayReader::of_bytes(file_of(own, info, format)?, format)?;
    let stated = reader.info().clone();
    let found = reader.collect::<Result<Vec<FileRay>, _>>()?;
    prop_assert_eq!((stated.count, stated.unit), (info.count, info.unit));
    // Binary headers have it in single precision.
    prop_assert!((stated.flux - info.flux).abs() <= 1e-7 * info.flux, "{format}: {stated:?}");
    if format == RayFormat::Tm25 {
        prop_assert_eq!((&stated.texts, stated.is_measured), (&info.texts, info.is_measured));
    }
    prop_assert_eq!(found.len(), own.len());
    for (found, own) in found.iter().zip(own) {
        prop_assert_eq!((found.position_mm, found.flux), (own.position_mm, own.flux));
        let length = own.direction.map(|axis| f64::from(axis).powi(2)).iter().sum::<f64>().sqrt();
        for (found, own) in found.direction.into_iter().zip(own.direction) {
            let off = f64::from(found) - f64::from(own) / length;
            prop_assert!(off.abs() <= 4.0 * f64::from(f32::EPSILON), "{format}: {off}");
        }
    }
    // Unit vectors come back to the last bit.
    let again = RayReader::of_bytes(file_of(&found, info, format)?, format)?;
    prop_assert_eq!(again.collect::<Result<Vec<FileRay>, _>>()?, found);
    Ok(())
}

proptest! {
    #![proptest_config(config(64))]

    #[test]
    fn rays_come_back_from_every_format(
        own in vec(ray(), 1..40),
        unit in select(vec![FluxUnit::Lumen, FluxUnit::Watt]),
        is_measured in any::<bool>(),
        texts in vec(prop::option::of(text()), RayText::ALL.len()),
    ) {
        let texts = RayText::ALL.into_iter().zip(texts);
        let texts = texts.filter_map(|(kind, text)| Some((kind, text?))).collect();
        let flux = own.iter().map(|ray| f64::from(ray.flux)).sum();
        let count = own.len() as u64;
        let info = RaySetInfo { count, unit, flux, luminous_flux_lm: None, is_measured, texts };
        for format in [RayFormat::Tm25, RayFormat::Zemax, RayFormat::Csv] {
            rays_come_back(&own, &info, format)?;
        }
    }
}
