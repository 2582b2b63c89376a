//! Plots as plain data for the scripts of a page: the same numbers as the pictures, with their errors.
//!
//! Numbers have six significant digits, which is more than a plot shows.

use crate::drawing::{Fate, SceneDrawing};
use crate::html::axes::{chart_axes, dial_axes, ink, map_axes};
use crate::html::cells::{coarse, joined};
use crate::local_axes::LocalAxes;
use crate::png::{
    self, AxisScale, ErrorForm, HeatMap, LinePlot, MapCells, MapColours, MapFrame, MapPlaces,
    PolarPlot, SeriesForm, on_screen, series_ink,
};
use glam::DVec3;
use lumiduct_core::colour::Chromaticity;
use lumiduct_core::measure::{Balance, Measure};
use ndarray::Array2;
use serde_json::{Value, json};

/// Significant digits of numbers.
const DIGITS: i32 = 6;
/// Significant digits of standard errors and biases.
const ERROR_DIGITS: i32 = 3;
/// Significant digits of chromaticities.
const COLOUR_DIGITS: i32 = 6;
/// Digits of coordinates below the size of a scene.
const PLACE_DIGITS: i32 = 4;

/// A number with some significant digits; null where it is non-finite.
fn number(value: f64, digits: i32) -> Value {
    if !value.is_finite() {
        return Value::Null;
    }
    let text = format!("{value:.*e}", (digits - 1) as usize);
    plain(text.parse().unwrap_or(value))
}

/// Whole numbers without a point.
fn plain(value: f64) -> Value {
    if value == value.trunc() && value.abs() < 1e15 { json!(value as i64) } else { json!(value) }
}

fn numbers<'a>(values: impl IntoIterator<Item = &'a f64>, digits: i32) -> Value {
    values.into_iter().map(|value| number(*value, digits)).collect()
}

/// Values, and their errors with fewer digits.
fn with_errors<'a>(values: impl Iterator<Item = (&'a f64, &'a f64)>) -> [Value; 2] {
    let (mut shown, mut errors) = (Vec::new(), Vec::new());
    for (value, error) in values {
        shown.push(number(*value, DIGITS));
        errors.push(number(*error, ERROR_DIGITS));
    }
    [shown, errors].map(Value::from)
}

/// The data from which scripts draw a map, without its words.
fn cell_data(cells: &MapCells) -> Value {
    let side = joined(&cells.values);
    if side > 1 {
        let mut data = cell_data(&coarse(cells, side));
        let remark = format!("each cell shown is the mean of {side} by {side}");
        data["remark"] = remark.into();
        return data;
    }
    let [values, errors] = with_errors(cells.values.iter().zip(&cells.errors));
    let biases = cells.biases.as_ref().map(|biases| numbers(biases, ERROR_DIGITS));
    let mut data = json!({
        "plot": "map", "x": numbers(&cells.x, DIGITS), "y": numbers(&cells.y, DIGITS),
        "values": values, "errors": errors, "biases": biases,
    });
    if let Some(MapColours { stimuli, uv_errors }) = &cells.colours {
        data["colours"] = on_screen(stimuli).iter().map(|rgb| json!(rgb)).collect();
        let uv = |own: &DVec3| {
            let colour = Chromaticity::from_tristimulus(own.to_array());
            colour.map_or([f64::NAN; 2], Chromaticity::uv_1976)
        };
        let of = |place: usize| numbers(&stimuli.map(|own| uv(own)[place]), COLOUR_DIGITS);
        data["uv"] = json!([of(0), of(1)]);
        let errors =
            |own: &[Array2<f64>; 2]| json!(own.each_ref().map(|own| numbers(own, ERROR_DIGITS)));
        data["uv_errors"] = uv_errors.as_ref().map_or(Value::Null, errors);
    }
    data
}

/// A map as in its picture, with its cells and their names.
pub(crate) fn map(map: &HeatMap) -> Value {
    let MapPlaces { geometry, names, units, .. } = map.places;
    let mut data = cell_data(&map.cells);
    data["axes"] = map_axes(&MapFrame::new(map));
    data["geometry"] = json!(geometry);
    let entries = [
        ("title", map.title.as_str()),
        ("quantity", &map.quantity),
        ("unit", &map.unit),
        ("x_name", names[0]),
        ("y_name", names[1]),
        ("x_unit", units[0]),
        ("y_unit", units[1]),
    ];
    for (key, text) in entries {
        data[key] = text.into();
    }
    data
}

/// Intensity by angle.
pub(crate) fn polar(plot: &PolarPlot) -> Value {
    let curves: Vec<Value> = plot
        .curves
        .iter()
        .enumerate()
        .map(|(place, curve)| {
            let points = curve.points.iter().map(|(_, value)| value);
            let [y, error] = with_errors(points.zip(&curve.std_errors));
            let gamma = numbers(curve.points.iter().map(|(gamma, _)| gamma), DIGITS);
            let [colour, dash] = ink(series_ink(place));
            json!({
                "name": curve.name, "colour": colour, "dash": dash, "gamma": gamma, "y": y, "error": error,
            })
        })
        .collect();
    json!({
        "plot": "polar", "title": plot.title, "unit": plot.unit, "axes": dial_axes(plot), "curves": curves,
    })
}

/// Curves over an axis; `unit` is that of their values.
pub(crate) fn chart(plot: &LinePlot, unit: &str) -> Value {
    let series: Vec<Value> = plot
        .series
        .iter()
        .enumerate()
        .map(|(place, series)| {
            let points = series.points.iter().map(|point| (&point.y, &point.std_error));
            let [y, error] = with_errors(points);
            let form = match series.form {
                SeriesForm::Line => "line",
                SeriesForm::Steps => "steps",
                SeriesForm::Dots => "dots",
            };
            let errors = match series.errors {
                ErrorForm::Bars => "bars",
                ErrorForm::Band => "band",
                ErrorForm::Hidden => "hidden",
            };
            let [colour, dash] = ink(png::ink(series, place));
            let x = numbers(series.points.iter().map(|point| &point.x), DIGITS);
            json!({
                "name": series.name, "form": form, "errors": errors, "colour": colour, "dash": dash,
                "x": x, "y": y, "error": error,
            })
        })
        .collect();
    let [linear, log] = [AxisScale::Linear, AxisScale::Log].map(|scale| chart_axes(plot, scale));
    json!({
        "plot": "chart", "title": plot.title, "unit": unit, "series": series, "x_name": plot.x_label,
        "axes": { "linear": linear, "log": log },
    })
}

/// Curves over an axis that extends further on a logarithmic scale, which shows more of the tail.
pub(crate) fn chart_with_tail(plot: &LinePlot, with_tail: &LinePlot, unit: &str) -> Value {
    let mut data = chart(with_tail, unit);
    data["axes"]["linear"] = chart_axes(plot, AxisScale::Linear);
    data
}

/// The balance, from the sources to where the light went.
pub(crate) fn flow(balance: &Balance, whole: f64, unit: &str) -> Value {
    let line = |name: String, kind: &str, measure: &Measure| {
        let [value, error] =
            [(measure.value, DIGITS), (measure.std_error, ERROR_DIGITS)].map(|(x, n)| number(x, n));
        json!({ "name": name, "kind": kind, "value": value, "error": error })
    };
    let mut sources: Vec<Value> = balance
        .emitted_by_source
        .iter()
        .map(|(name, measure)| line(name.clone(), "source", measure))
        .collect();
    let lines =
        |all: &indexmap::IndexMap<String, Measure>, words: &str, kind: &str| -> Vec<Value> {
            let lit = all.iter().filter(|(_, measure)| measure.value != 0.0);
            lit.map(|(name, measure)| line(format!("{words} {name}"), kind, measure)).collect()
        };
    let mut sinks = lines(&balance.escaped, "escaped by", "escaped");
    sinks.push(line("escaped, never in a solid".into(), "escaped", &balance.escaped_directly));
    sinks.extend(lines(&balance.absorbed, "absorbed by", "absorbed"));
    sinks.extend(lines(&balance.absorbed_medium, "absorbed in", "medium"));
    for (medium, measure) in &balance.converted {
        // Light that the eye sees better is a gain.
        let gain = Measure { value: -measure.value, ..measure.clone() };
        if gain.value > 0.0 {
            sources.push(line(format!("gained by conversion in {medium}"), "source", &gain));
        } else if measure.value > 0.0 {
            sinks.push(line(format!("lost by conversion in {medium}"), "medium", measure));
        }
    }
    sinks.push(line("cut by the bounce limit".into(), "lost", &balance.cut));
    sinks.push(line("leaked".into(), "lost", &balance.leaked));
    json!({ "plot": "flow", "unit": unit, "whole": whole, "sources": sources, "sinks": sinks })
}

/// The scene in three dimensions.
pub(crate) fn scene(drawing: &SceneDrawing) -> Value {
    let places = Decimals::of(drawing);
    let faces: Vec<Value> = drawing
        .faces
        .iter()
        .map(|face| {
            let triangles: Vec<usize> = face.facets.triangles.iter().flatten().copied().collect();
            json!({
                "name": face.name, "role": face.role, "points": places.flat(&face.facets.points),
                "triangles": triangles, "rims": face.facets.rims,
            })
        })
        .collect();
    let mut groups: Vec<(Fate, &str, usize)> = Vec::new();
    for path in &drawing.paths {
        match groups.iter_mut().find(|(_, end, _)| *end == path.end) {
            Some((_, _, count)) => *count += 1,
            None => groups.push((path.fate, &path.end, 1)),
        }
    }
    groups.sort_by_key(|(fate, end, _)| (*fate, *end));
    let group_of = |end: &str| groups.iter().position(|(_, name, _)| *name == end);
    let paths: Vec<Value> = drawing
        .paths
        .iter()
        .map(|path| json!({ "group": group_of(&path.end), "points": places.flat(&path.points) }))
        .collect();
    let marks: Vec<Value> = drawing
        .marks
        .iter()
        .map(|mark| json!({ "name": mark.name, "role": mark.role, "at": places.flat(&[mark.at]) }))
        .collect();
    let groups: Vec<Value> = groups
        .iter()
        .map(|(fate, name, count)| json!({ "name": name, "fate": fate, "count": count }))
        .collect();
    json!({
        "plot": "scene", "middle": places.flat(&[drawing.middle]), "faces": faces, "marks": marks,
        "groups": groups, "paths": paths, "upright": drawing.is_upright,
    })
}

/// Local axes in the scene: places as in the drawing, and three unit vectors each.
pub(crate) fn axes(drawing: &SceneDrawing, axes: &[LocalAxes]) -> Value {
    let places = Decimals::of(drawing);
    axes.iter()
        .map(|one| {
            let vectors = [one.u, one.v, one.normal].map(|unit| unit.to_array()).concat();
            json!({
                "name": one.name, "role": one.role, "at": places.flat(&[one.origin]),
                "axes": numbers(&vectors, ERROR_DIGITS), "round": one.rect.is_none(),
            })
        })
        .collect()
}

/// Coordinates with as many decimals as a picture can show.
struct Decimals {
    unit: f64,
}

impl Decimals {
    fn of(drawing: &SceneDrawing) -> Self {
        let exponent = drawing.radius.max(f64::MIN_POSITIVE).log10().floor() as i32;
        Self { unit: 10f64.powi(PLACE_DIGITS - exponent) }
    }

    fn flat(&self, points: &[DVec3]) -> Value {
        let all = points.iter().flat_map(|point| point.to_array());
        all.map(|x| plain((x * self.unit).round() / self.unit)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_unknown_ones_are_null() {
        let shown = |value: f64| number(value, DIGITS).to_string();
        assert_eq!(shown(298_436.818_647), "298437");
        assert_eq!(shown(0.703_175_187), "0.703175");
        assert_eq!(shown(-1.234_567_8e-9), "-1.23457e-9");
        assert_eq!([0.0, f64::NAN, f64::INFINITY].map(shown), ["0", "null", "null"]);
    }
}
