//! Axes, colour bars and inks of curves as plain data, the same as in the pictures.

use crate::png::{
    AxisScale, BarScale, ColourMap, LinePlot, MapFrame, MarkedAxis, PolarPlot, SeriesInk,
    curve_colours, dial_axis, line_axes,
};
use serde_json::{Value, json};

/// An axis: its ends, scale and label, and its marks with and without labels.
fn axis(marked: &MarkedAxis) -> Value {
    let MarkedAxis { axis, ticks, label } = marked;
    let major: Vec<Value> =
        ticks.major.iter().map(|tick| json!([tick.value, tick.label])).collect();
    json!({
        "from": axis.min(), "to": axis.max(), "scale": scale_name(axis.scale()), "label": label,
        "ticks": major, "minor": ticks.minor,
    })
}

fn scale_name(scale: AxisScale) -> &'static str {
    match scale {
        AxisScale::Linear => "linear",
        AxisScale::Log => "log",
        AxisScale::Tangent => "tangent",
    }
}

fn bar(scale: &BarScale) -> Value {
    let palette = match scale.colours {
        ColourMap::Sequential => "sequential",
        ColourMap::Diverging => "diverging",
    };
    let mut data = axis(&scale.axis);
    data["palette"] = palette.into();
    data["beyond"] = scale.beyond.into();
    data
}

/// Axes and colour bars of a map, and axes for sections of any length.
pub(crate) fn map_axes(frame: &MapFrame) -> Value {
    /// Length of the axis of a section, pixels.
    const SECTION: f64 = 400.0;
    let [x, y] = &frame.axes;
    let longest = (x.axis.max() - x.axis.min()).hypot(y.axis.max() - y.axis.min());
    let along: Vec<Value> = MarkedAxis::of_lengths(longest, SECTION).iter().map(axis).collect();
    let mut bars = json!({ "linear": bar(&frame.bar) });
    if let Some(log) = &frame.log_bar {
        bars["log"] = bar(log);
    }
    json!({ "x": axis(x), "y": axis(y), "bars": bars, "along": along })
}

/// Axes of curves with a vertical axis of this scale.
pub(crate) fn chart_axes(plot: &LinePlot, scale: AxisScale) -> Value {
    let [x, y] = line_axes(plot, scale);
    json!({ "x": axis(&x), "y": axis(&y) })
}

/// Axes of a dial on either scale.
pub(crate) fn dial_axes(plot: &PolarPlot) -> Value {
    let [linear, log] =
        [AxisScale::Linear, AxisScale::Log].map(|scale| axis(&dial_axis(plot, scale)));
    json!({ "linear": linear, "log": log })
}

/// The colour of a curve, by its number among all or by name, and its dashes as style sheets write them.
pub(crate) fn ink(ink: SeriesInk) -> [Value; 2] {
    let place = curve_colours().iter().position(|colour| *colour == ink.colour);
    let dashes: Vec<String> = ink.dash.iter().map(f64::to_string).collect();
    let dash = if dashes.is_empty() { "none".to_owned() } else { dashes.join(" ") };
    [place.map_or("soft".into(), Value::from), dash.into()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::png::{ErrorForm, PlotSeries, SeriesForm, SeriesPoint, series_ink};

    fn plot(points: &[(f64, f64)]) -> LinePlot {
        let points = points.iter().map(|&(x, y)| SeriesPoint { x, y, std_error: 0.0 }).collect();
        let series = PlotSeries::new("exit", points, SeriesForm::Line, ErrorForm::Hidden);
        LinePlot {
            title: String::new(),
            subtitle: String::new(),
            x_label: "interfaces met".into(),
            y_label: "flux in lm".into(),
            scale: AxisScale::Linear,
            series: vec![series],
        }
    }

    #[test]
    fn axes_of_a_chart_are_those_of_its_picture() {
        let plot = plot(&[(0.0, 1e-11), (10.0, 2e5)]);
        let linear = chart_axes(&plot, AxisScale::Linear);
        assert_eq!(linear["y"]["label"], "flux in lm, ×10⁵");
        assert_eq!(linear["y"]["ticks"][1], json!([50_000.0, "0.5"]));
        let log = chart_axes(&plot, AxisScale::Log);
        assert_eq!((&log["y"]["scale"], &log["y"]["label"]), (&json!("log"), &json!("flux in lm")));
        // Eight decades below the greatest value, as in pictures.
        let from = log["y"]["from"].as_f64().unwrap();
        assert!((from / (2e-3 / 1.5) - 1.0).abs() < 1e-9, "{from}");
    }

    #[test]
    fn a_logarithmic_axis_of_nothing_is_a_linear_one() {
        let axes = chart_axes(&plot(&[(0.0, 0.0), (1.0, 0.0)]), AxisScale::Log);
        assert_eq!(axes["y"]["scale"], "linear");
    }

    #[test]
    fn inks_are_numbers_of_the_page_s_colours() {
        assert_eq!(ink(series_ink(8)), [json!(1), json!("none")]);
        assert_eq!(ink(series_ink(9)), [json!(2), json!("9 5")]);
        let grey = SeriesInk { colour: [96, 102, 110], dash: &[2.0, 4.0] };
        assert_eq!(ink(grey), [json!("soft"), json!("2 4")]);
    }
}
