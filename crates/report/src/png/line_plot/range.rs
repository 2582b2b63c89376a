//! The range of an axis, from the data. This module does not know what is drawn along it.

use crate::png::axis::{Axis, Scale};

/// Largest ratio that a logarithmic axis made from data spans.
const WIDEST_RATIO: f64 = 1e8;

/// Whether an axis reaches beyond its data.
pub(super) enum Padding {
    None,
    Around,
}

/// The axis that contains some values.
pub(super) fn range(values: &[f64], scale: Scale, padding: Padding) -> Axis {
    let usable = |value: &&f64| match scale {
        Scale::Linear | Scale::Tangent => value.is_finite(),
        Scale::Log => value.is_finite() && **value > 0.0,
    };
    let low = values.iter().filter(usable).copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().filter(usable).copied().fold(f64::NEG_INFINITY, f64::max);
    let single = high - low <= 1e-9 * high.abs().max(low.abs());
    match (padding, scale) {
        (Padding::None, Scale::Linear | Scale::Log | Scale::Tangent) if single => {
            // Puts a single value in the middle of the picture.
            let space = if high == 0.0 { 0.5 } else { 0.5 * high.abs() };
            Axis::new(low - space, high + space, scale)
        }
        (Padding::None, Scale::Linear | Scale::Tangent) => Axis::new(low, high, scale),
        (Padding::None, Scale::Log) => Axis::new(low / 1.05, high * 1.05, scale),
        (Padding::Around, Scale::Log) => {
            Axis::new(low.max(high / WIDEST_RATIO) / 1.5, high * 1.5, scale)
        }
        (Padding::Around, Scale::Linear | Scale::Tangent) => {
            // The axis includes zero where the values come near it.
            let low = if low > 0.0 && low <= 0.5 * high { 0.0 } else { low };
            let high = if high < 0.0 && high >= 0.5 * low { 0.0 } else { high };
            let space = 0.05 * (high - low);
            let below = if low == 0.0 { low } else { low - space };
            Axis::new(below, if high == 0.0 { high } else { high + space }, scale)
        }
    }
}
