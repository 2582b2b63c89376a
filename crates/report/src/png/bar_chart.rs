//! Horizontal bars with their values, for the flux balance.

use crate::png::canvas::{Canvas, Ink};
use crate::png::geometry::Rect;
use crate::png::layout::{Header, MARGIN, write};
use crate::png::palette::{INK, series_ink};
use crate::png::text::{Align, LABEL};
use lumiduct_base::error::Result;
use lumiduct_base::number::{format_percent, format_value, format_with_error};

/// Horizontal bars.
#[derive(Debug, Clone)]
pub(crate) struct BarChart {
    /// What is shown.
    pub title: String,
    /// How it was found; may be empty.
    pub subtitle: String,
    /// Unit of the values: "lm".
    pub unit: String,
    /// The value that is 100 %; `None` to show no percents.
    pub whole: Option<f64>,
    /// The bars, from top to bottom. Only the first 40 are drawn; the others are summed.
    pub bars: Vec<Bar>,
}

/// One bar.
#[derive(Debug, Clone)]
pub(crate) struct Bar {
    /// Its name; long ones are shortened in the middle.
    pub name: String,
    /// Its value, which may be negative.
    pub value: f64,
    /// Standard error of the value; `None` where it is not known.
    pub std_error: Option<f64>,
    /// Bars of one kind have the same number and colour.
    pub colour: usize,
}

const WIDTH: f64 = 900.0;
const ROW: f64 = 30.0;
const THICKNESS: f64 = 18.0;
const LONGEST_NAME: f64 = 270.0;
/// Space between a bar and its texts, pixels.
const GAP: f64 = 8.0;
const MOST_BARS: usize = 40;

/// Draws bars with their names on the left, and value, standard error and percent at their ends.
pub(crate) fn bar_chart(chart: &BarChart) -> Result<Vec<u8>> {
    let bars = shown(&chart.bars);
    let header = Header::new(&chart.title, &chart.subtitle, WIDTH - 2.0 * MARGIN)?;
    let names = bars
        .iter()
        .map(|bar| LABEL.fit(&bar.name, LONGEST_NAME))
        .collect::<Result<Vec<String>>>()?;
    let texts: Vec<String> = bars.iter().map(|bar| value_text(chart, bar)).collect();
    let left = MARGIN + widest(&names)? + GAP;
    let right = (WIDTH - MARGIN - widest(&texts)? - GAP).max(left + 60.0);
    let top = (MARGIN + header.height()).round();
    let height = top + ROW * bars.len().max(1) as f64 + MARGIN - 6.0;

    let mut canvas = Canvas::new(WIDTH as usize, height as usize);
    header.draw(&mut canvas, MARGIN, MARGIN - 4.0)?;
    if bars.is_empty() {
        write(&mut canvas, "No values.", [MARGIN, top + LABEL.size], LABEL, Align::Left)?;
        return canvas.into_png();
    }
    let place = scale(&bars, left, right);
    for (index, bar) in bars.iter().enumerate() {
        let y = top + ROW * index as f64;
        let end = place(bar.value);
        let rect = Rect {
            left: end.min(place(0.0)),
            top: y + 0.5 * (ROW - THICKNESS),
            right: end.max(place(0.0)),
            bottom: y + 0.5 * (ROW + THICKNESS),
        };
        canvas.rect(rect, Ink::opaque(series_ink(bar.colour).colour));
        let baseline = (y + 0.5 * (ROW + LABEL.cap_height())).round();
        write(&mut canvas, &names[index], [left - GAP, baseline], LABEL, Align::Right)?;
        write(&mut canvas, &texts[index], [rect.right + GAP, baseline], LABEL, Align::Left)?;
    }
    let zero = Rect::new(place(0.0) - 1.0, top, 1.0, ROW * bars.len() as f64);
    canvas.rect(zero, Ink::opaque(INK));
    canvas.into_png()
}

/// The bars that are drawn: if there are too many, the last one is the sum of the others.
fn shown(bars: &[Bar]) -> Vec<Bar> {
    if bars.len() <= MOST_BARS {
        return bars.to_vec();
    }
    let (first, rest) = bars.split_at(MOST_BARS - 1);
    let sum = Bar {
        name: format!("{} others", rest.len()),
        value: rest.iter().map(|bar| bar.value).sum(),
        std_error: None,
        colour: rest[0].colour,
    };
    first.iter().cloned().chain([sum]).collect()
}

fn widest(texts: &[String]) -> Result<f64> {
    texts.iter().try_fold(0.0f64, |widest, text| Ok(widest.max(LABEL.width(text)?))).map(f64::ceil)
}

fn value_text(chart: &BarChart, bar: &Bar) -> String {
    let value = match bar.std_error {
        Some(std_error) if std_error != 0.0 => format_with_error(bar.value, std_error),
        Some(_) | None => format_value(bar.value),
    };
    let text = format!("{value} {}", chart.unit).trim_end().to_string();
    match chart.whole {
        Some(whole) if whole != 0.0 => {
            format!("{text}   {}", format_percent(bar.value / whole))
        }
        Some(_) | None => text,
    }
}

/// Where a value lies between two columns of pixels, zero among them.
fn scale(bars: &[Bar], left: f64, right: f64) -> impl Fn(f64) -> f64 {
    let finite = || bars.iter().map(|bar| bar.value).filter(|value| value.is_finite());
    let low = finite().fold(0.0, f64::min);
    let high = finite().fold(0.0, f64::max);
    let range = if high - low > 0.0 && (high - low).is_finite() { high - low } else { 1.0 };
    move |value| {
        let value = if value.is_finite() { value } else { 0.0 };
        (left + ((value - low) / range).clamp(0.0, 1.0) * (right - left)).round()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::png::tests::Decoded;

    fn bar(name: &str, value: f64, colour: usize) -> Bar {
        Bar { name: name.to_string(), value, std_error: Some(0.001), colour }
    }

    fn chart(bars: Vec<Bar>) -> BarChart {
        BarChart {
            title: "Flux balance".to_string(),
            subtitle: String::new(),
            unit: "lm".to_string(),
            whole: Some(4.0),
            bars,
        }
    }

    #[test]
    fn bars_are_as_long_as_their_values_and_negative_ones_point_left() {
        let chart = chart(vec![bar("exit", 2.0, 0), bar("wall", 1.0, 1), bar("roulette", -0.5, 2)]);
        let picture = Decoded::new(&bar_chart(&chart).unwrap());
        let bounds = [0, 1, 2].map(|index| picture.bounds(series_ink(index).colour));
        let length = |bounds: [usize; 4]| (bounds[2] - bounds[0]) as f64;
        assert!((length(bounds[0]) / length(bounds[1]) - 2.0).abs() < 0.02);
        assert!((length(bounds[0]) / length(bounds[2]) - 4.0).abs() < 0.05);
        assert_eq!(bounds[0][0], bounds[1][0]);
        assert!(bounds[2][2] <= bounds[0][0]);
    }

    #[test]
    fn values_are_written_with_error_unit_and_percent() {
        let chart = chart(Vec::new());
        assert_eq!(value_text(&chart, &bar("exit", 2.0, 0)), "2.0000 ± 0.0010 lm   50.00 %");
        let exact = Bar { std_error: Some(0.0), ..bar("leaked", 0.0, 0) };
        assert_eq!(value_text(&chart, &exact), "0 lm   0.00 %");
        let no_whole = BarChart { whole: None, ..chart };
        let unknown = Bar { std_error: None, ..bar("exit", 0.25, 0) };
        assert_eq!(value_text(&no_whole, &unknown), "0.25 lm");
    }

    #[test]
    fn too_many_bars_are_added_up() {
        let bars: Vec<Bar> = (0..100).map(|index| bar(&format!("face {index}"), 1.0, 0)).collect();
        let shown = shown(&bars);
        assert_eq!(shown.len(), MOST_BARS);
        assert_eq!(shown.iter().map(|bar| bar.value).sum::<f64>(), 100.0);
        assert_eq!(shown[MOST_BARS - 1].name, "61 others");
    }
}
