//! The range of an axis, from the data. This module does not know what is drawn along it.

use crate::png::axis::{AxisScale, PlotAxis};

/// Largest ratio that a logarithmic axis made from data spans.
const WIDEST_RATIO: f64 = 1e8;

/// Whether an axis reaches beyond its data.
pub(super) enum Padding {
    None,
    Around,
}

/// The axis that contains some values.
pub(super) fn range(values: &[f64], scale: AxisScale, padding: Padding) -> PlotAxis {
    let usable = |value: &&f64| match scale {
        AxisScale::Linear | AxisScale::Tangent => value.is_finite(),
        AxisScale::Log => value.is_finite() && **value > 0.0,
    };
    let low = values.iter().filter(usable).copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().filter(usable).copied().fold(f64::NEG_INFINITY, f64::max);
    let single = high - low <= 1e-9 * high.abs().max(low.abs());
    match (padding, scale) {
        (Padding::None, AxisScale::Linear | AxisScale::Log | AxisScale::Tangent) if single => {
            // Puts a single value in the middle of the picture.
            let space = if high == 0.0 { 0.5 } else { 0.5 * high.abs() };
            PlotAxis::new(low - space, high + space, scale)
        }
        (Padding::None, AxisScale::Linear | AxisScale::Tangent) => PlotAxis::new(low, high, scale),
        (Padding::None, AxisScale::Log) => PlotAxis::new(low / 1.05, high * 1.05, scale),
        (Padding::Around, AxisScale::Log) => {
            PlotAxis::new(low.max(high / WIDEST_RATIO) / 1.5, high * 1.5, scale)
        }
        (Padding::Around, AxisScale::Linear | AxisScale::Tangent) => {
            // The axis includes zero where the values come near it.
            let low = if low > 0.0 && low <= 0.5 * high { 0.0 } else { low };
            let high = if high < 0.0 && high >= 0.5 * low { 0.0 } else { high };
            let space = 0.05 * (high - low);
            let below = if low == 0.0 { low } else { low - space };
            PlotAxis::new(below, if high == 0.0 { high } else { high + space }, scale)
        }
    }
}
