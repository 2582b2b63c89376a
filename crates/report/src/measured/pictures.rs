//! Pictures of a measured beside a computed map: both, their differences, and sections.

use crate::OutputFile;
use crate::diff::limit;
use crate::measured::MeasuredDiff;
use crate::measured::figures::half_plane;
use crate::png::{
    AxisScale, ColourMap, ErrorForm, HeatMap, LinePlot, MapCells, PlotSeries, SeriesForm,
    SeriesPoint, heat_map, line_plot,
};
use lumiduct_base::error::Result;
use lumiduct_core::measure::not_below_zero;
use ndarray::Array2;

/// A map with the name of its picture.
pub(crate) struct NamedMap {
    /// File name of the picture.
    pub(crate) file: String,
    /// The map.
    pub(crate) map: HeatMap,
}

/// Sections with the name of their picture.
pub(crate) struct NamedSection {
    /// File name of the picture.
    pub(crate) file: String,
    /// The curves.
    pub(crate) plot: LinePlot,
}

/// Computed, measured as adjusted, and the differences after and before adjustment.
pub(crate) fn maps(diff: &MeasuredDiff) -> [NamedMap; 4] {
    let computed = &diff.computed.cells;
    let [before, after] = &diff.measured;
    let shown = after.mapv(not_below_zero);
    let both = computed.values.iter().chain(&shown).copied().filter(|value| value.is_finite());
    let top = both.fold(0.0, f64::max);
    let none = Array2::from_elem(computed.values.dim(), f64::NAN);
    let adjusted = adjusted_words(diff);
    let value = |file: &str, title: &str, values: Array2<f64>, errors: &Array2<f64>| {
        named(diff, file, title, values, errors, [0.0, top])
    };
    let differences = [after, before].map(|measured| measured - &computed.values);
    let most = differences.each_ref().map(|all| limit(&all.iter().copied().collect::<Vec<_>>()));
    let [better, worse] = differences;
    let difference = |file: &str, title: &str, values: Array2<f64>, most: f64| {
        named(diff, file, title, values, &computed.errors, [-most, most])
    };
    [
        value("computed", "computed", computed.values.mapv(not_below_zero), &computed.errors),
        value("measured", &format!("measured{adjusted}"), shown, &none),
        difference("difference", &format!("measured − computed{adjusted}"), better, most[0]),
        difference("difference_before", "measured − computed, as the file is", worse, most[1]),
    ]
}

/// What was done to the measured values: `, aligned and scaled`.
pub(crate) fn adjusted_words(diff: &MeasuredDiff) -> &'static str {
    let is_aligned = diff.shift.is_found(0) || diff.shift.is_found(1);
    match (is_aligned, diff.scale.is_some()) {
        (true, true) => ", aligned and scaled",
        (true, false) => ", aligned",
        (false, true) => ", scaled",
        (false, false) => "",
    }
}

fn named(
    diff: &MeasuredDiff,
    file: &str,
    title: &str,
    values: Array2<f64>,
    errors: &Array2<f64>,
    limits: [f64; 2],
) -> NamedMap {
    let MapCells { x, y, .. } = diff.computed.cells.clone();
    let is_difference = limits[0] < 0.0;
    let quantity = diff.name.split('.').nth(1).unwrap_or_default();
    let map = HeatMap {
        title: format!("{}: {title}", diff.name),
        subtitle: String::new(),
        quantity: if is_difference { "difference".to_owned() } else { quantity.to_owned() },
        unit: diff.unit.clone(),
        places: diff.computed.kind.places,
        cells: MapCells { x, y, values, errors: errors.clone(), biases: None, colours: None },
        colours: if is_difference { ColourMap::Diverging } else { ColourMap::Sequential },
        limits: Some(limits),
    };
    NamedMap { file: format!("{}.{file}.png", diff.name), map }
}

/// Both maps along their middle row and column, or in the planes C0-C180 and C90-C270.
pub(crate) fn sections(diff: &MeasuredDiff) -> [NamedSection; 2] {
    let [_, after] = &diff.measured;
    let computed = &diff.computed.cells;
    let along = |values: &Array2<f64>, axis: usize| -> Vec<[f64; 2]> {
        if diff.computed.is_intensity() {
            let plane = 90.0 * axis as f64;
            let there = half_plane(&diff.computed, values, plane);
            let back = half_plane(&diff.computed, values, plane + 180.0);
            let back = back.into_iter().rev().map(|[gamma, value]| [-gamma, value]);
            return back.chain(there).collect();
        }
        let edges = diff.computed.edges()[axis];
        let (rows, columns) = values.dim();
        let at = |place: usize| if axis == 0 { [rows / 2, place] } else { [place, columns / 2] };
        let middle = |place: usize| 0.5 * (edges[place] + edges[place + 1]);
        (0..edges.len() - 1).map(|place| [middle(place), values[at(place)]]).collect()
    };
    [0, 1].map(|axis| {
        let curve = |name: String, values: &Array2<f64>, errors: Option<&Array2<f64>>| {
            let errors = errors.map(|errors| along(errors, axis));
            let point = |(place, [x, y]): (usize, [f64; 2])| SeriesPoint {
                x,
                y,
                std_error: errors.as_ref().map_or(0.0, |errors| errors[place][1]),
            };
            let points = along(values, axis).into_iter().enumerate().map(point).collect();
            let form = if errors.is_some() { ErrorForm::Band } else { ErrorForm::Hidden };
            PlotSeries::new(name, points, SeriesForm::Line, form)
        };
        let (place, x_label) = if diff.computed.is_intensity() {
            let plane = 90 * axis;
            (format!("plane C{plane} to C{}", plane + 180), "γ in deg")
        } else {
            let words = ["middle row", "middle column"][axis];
            (words.to_owned(), diff.computed.kind.places.labels[axis])
        };
        let measured = format!("measured{}", adjusted_words(diff));
        let quantity = diff.name.split('.').nth(1).unwrap_or_default();
        let plot = LinePlot {
            title: format!("{}: {place}", diff.name),
            subtitle: String::new(),
            x_label: x_label.into(),
            y_label: format!("{quantity} in {}", diff.unit),
            scale: AxisScale::Linear,
            series: vec![
                curve("computed".to_owned(), &computed.values, Some(&computed.errors)),
                curve(measured, after, None),
            ],
        };
        NamedSection { file: format!("{}.section_{}.png", diff.name, ["a", "b"][axis]), plot }
    })
}

/// The files of all pictures.
pub(crate) fn files(maps: &[NamedMap], sections: &[NamedSection]) -> Result<Vec<OutputFile>> {
    let mut files = Vec::new();
    for NamedMap { file, map } in maps {
        files.push(OutputFile { name: file.clone(), bytes: heat_map(map)? });
    }
    for NamedSection { file, plot } in sections {
        files.push(OutputFile { name: file.clone(), bytes: line_plot(plot)? });
    }
    Ok(files)
}
