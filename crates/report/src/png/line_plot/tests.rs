use super::*;
use crate::png::tests::Decoded;

fn axes_of(plot: &LinePlot) -> [PlotAxis; 2] {
    data_axes(plot, plot.scale)
}

fn plot(form: SeriesForm, points: &[[f64; 3]]) -> LinePlot {
    let points = points.iter().map(|&[x, y, std_error]| SeriesPoint { x, y, std_error }).collect();
    LinePlot {
        title: "Bounces".to_string(),
        subtitle: String::new(),
        x_label: "bounces".to_string(),
        y_label: "share of the flux".to_string(),
        scale: AxisScale::Linear,
        series: vec![PlotSeries::new("", points, form, ErrorForm::Band)],
    }
}

#[test]
fn curves_that_belong_together_have_one_colour() {
    let mut plot = plot(SeriesForm::Line, &[[0.0, 1.0, 0.0], [1.0, 2.0, 0.0]]);
    let mut lit = |look: Look| {
        plot.series[0].look = look;
        Decoded::new(&line_plot(&plot).unwrap()).places(paired_colour(1)).len()
    };
    let [whole, dashed, bound] = [Look::Solid(1), Look::Dashed(1), Look::Bound].map(&mut lit);
    assert!(dashed > whole / 3 && dashed < whole * 4 / 5 && bound == 0, "{whole} {dashed}");
}

#[test]
fn stacked_plots_are_drawn_one_below_the_other() {
    let upper = plot(SeriesForm::Line, &[[0.0, 1.0, 0.0], [1.0, 2.0, 0.0]]);
    let mut lower = upper.clone();
    lower.series[0].look = Look::Solid(1);
    let single = Decoded::new(&line_plot(&upper).unwrap());
    let both = Decoded::new(&stacked_plots(&[upper, lower]).unwrap());
    assert_eq!((both.width, both.height), (single.width, 2 * single.height));
    assert_eq!(both.bounds(series_ink(0).colour), single.bounds(series_ink(0).colour));
    let [_, top, _, _] = both.bounds(paired_colour(1));
    assert!(top > single.height, "{top}");
}

#[test]
fn steps_reach_half_way_to_their_neighbours() {
    let plot = plot(SeriesForm::Steps, &[[0.0, 1.0, 0.0], [1.0, 2.0, 0.0], [3.0, 4.0, 0.0]]);
    assert_eq!(
        outline(&plot.series[0]),
        [[-0.5, 1.0], [0.5, 1.0], [0.5, 2.0], [2.0, 2.0], [2.0, 4.0], [4.0, 4.0]]
    );
    let [x, _] = axes_of(&plot);
    assert_eq!((x.min(), x.max()), (-0.5, 4.0));
}

#[test]
fn the_frame_holds_the_error_bars_and_begins_at_zero_where_values_come_near_it() {
    let axes = axes_of(&plot(SeriesForm::Line, &[[0.0, 2.0, 0.5], [1.0, 8.0, 2.0]]));
    assert_eq!(axes[1].min(), 0.0);
    assert!(axes[1].max() > 10.0 && axes[1].max() < 11.0);
    let axes = axes_of(&plot(SeriesForm::Line, &[[0.0, 98.0, 0.5], [1.0, 99.0, 0.5]]));
    assert!(axes[1].min() > 97.0 && axes[1].min() < 97.5);
}

#[test]
fn zeros_lie_below_a_logarithmic_frame() {
    let points = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.01, 0.0]];
    let axes = data_axes(&plot(SeriesForm::Steps, &points), AxisScale::Log);
    assert!(axes[1].min() > 0.005 && axes[1].min() < 0.01);
    assert!(axes[1].fraction(0.0) < -1.0);
}

#[test]
fn a_rising_line_is_drawn_from_the_lower_left_to_the_upper_right() {
    let points: Vec<[f64; 3]> = (0..=10).map(|i| [f64::from(i), f64::from(i), 0.0]).collect();
    let picture = Decoded::new(&line_plot(&plot(SeriesForm::Line, &points)).unwrap());
    let mut places = picture.places(series_ink(0).colour);
    places.sort_unstable();
    let (first, last) = (places[0], places[places.len() - 1]);
    assert!(last.0 - first.0 > 700 && first.1 - last.1 > 340, "{first:?} {last:?}");
}

#[test]
fn a_gap_in_the_values_is_a_gap_in_the_curve() {
    let points =
        [[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [2.0, f64::NAN, 0.0], [3.0, 1.0, 0.0], [4.0, 1.0, 0.0]];
    let picture = Decoded::new(&line_plot(&plot(SeriesForm::Line, &points)).unwrap());
    let [left, _, right, _] = picture.bounds(series_ink(0).colour);
    let places = picture.places(series_ink(0).colour);
    let middle = left + (right - left) / 2;
    assert!(places.iter().all(|place| place.0.abs_diff(middle) > (right - left) / 5));
}
