//! Light in its own colour on a screen (sRGB).

use crate::png::palette::{NEUTRAL, Rgb};
use glam::{DMat3, DVec3};
use ndarray::Array2;

/// Linear sRGB from X, Y, Z for a white of Y = 1 (IEC 61966-2-1:1999, eq. 7), column by column.
const SRGB_FROM_XYZ: DMat3 = DMat3::from_cols_array(&[
    3.2406, -0.9689, 0.0557, -1.5372, 1.8758, -0.2040, -0.4986, 0.0415, 1.0570,
]);
/// Share of the lit cells that are no brighter than the screen can show, 1; without it one hot cell would darken all others.
const SHOWN_IN_FULL: f64 = 0.995;

/// Cells as they look side by side, the brightest as bright as a screen shows their colours.
pub(crate) fn on_screen(stimuli: &Array2<DVec3>) -> Array2<Rgb> {
    let shown = stimuli.mapv(within_gamut);
    let mut most: Vec<f64> =
        shown.iter().map(|own| own.max_element()).filter(|own| *own > 0.0).collect();
    most.sort_by(f64::total_cmp);
    let at = (SHOWN_IN_FULL * most.len().saturating_sub(1) as f64).ceil() as usize;
    let white = most.get(at).copied().unwrap_or(1.0);
    shown.mapv(|own| if own.is_finite() { encoded(own / white) } else { NEUTRAL })
}

/// Linear sRGB; colours that no screen has are mixed with grey of their luminance until it has them.
fn within_gamut(xyz: DVec3) -> DVec3 {
    let rgb = SRGB_FROM_XYZ * xyz;
    let least = rgb.min_element();
    // Outside of the sensor there is none.
    if least >= 0.0 || !rgb.is_finite() {
        return rgb;
    }
    let grey = xyz.y.max(0.0);
    let kept = grey / (grey - least);
    (DVec3::splat(grey) + kept * (rgb - DVec3::splat(grey))).max(DVec3::ZERO)
}

/// IEC 61966-2-1:1999, eq. 9 to 11; what is too bright keeps its hue.
fn encoded(linear: DVec3) -> Rgb {
    let linear = linear / linear.max_element().max(1.0);
    linear.to_array().map(|own| {
        let curved =
            if own <= 0.003_130_8 { 12.92 * own } else { 1.055 * own.powf(1.0 / 2.4) - 0.055 };
        (255.0 * curved).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumiduct_core::colour::Chromaticity;
    use ndarray::array;

    /// Tristimulus values of a chromaticity u', v' with this Y.
    fn light(u: f64, v: f64, y: f64) -> DVec3 {
        DVec3::from_array(Chromaticity::from_uv_1976([u, v]).tristimulus(y))
    }

    #[test]
    fn white_is_white_and_the_red_of_screens_is_red() {
        // D65, the red primary of sRGB (x 0.64, y 0.33), no light, and no sensor.
        let [white, red] = [light(0.197_83, 0.468_34, 100.0), light(0.450_7, 0.522_9, 21.26)];
        let found = on_screen(&array![[white, red, DVec3::ZERO, DVec3::NAN]]);
        let near =
            |own: Rgb, expected: Rgb| own.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 3);
        assert!(near(found[[0, 0]], [255, 255, 255]), "{found:?}");
        assert!(near(found[[0, 1]], [255, 0, 0]), "{found:?}");
        assert_eq!([found[[0, 2]], found[[0, 3]]], [[0, 0, 0], NEUTRAL]);
    }

    #[test]
    fn pure_colours_keep_their_luminance() {
        // 520 nm is beyond any screen.
        let green = light(0.023_1, 0.583_7, 3.0);
        let shown = within_gamut(green);
        assert!(shown.min_element().abs() < 1e-9 && shown.y > shown.x, "{shown}");
        let luminance = shown.dot(DVec3::new(0.2126, 0.7152, 0.0722));
        assert!((luminance - 3.0).abs() < 0.01, "{luminance}");
    }
}
