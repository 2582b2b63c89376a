//! A cut through the geometry with paths of light in it.

use crate::png::axis::{AxisScale, PlotAxis};
use crate::png::canvas::{Canvas, Ink, Pen};
use crate::png::geometry::{Point, Rect};
use crate::png::layout::{
    Aspect, EndMark, Header, Legend, LegendSample, MARGIN, PlotAxes, SQUEEZED_REMARK, draw_mark,
    plot_size, remark, write,
};
use crate::png::marked_axis::MarkedAxis;
use crate::png::palette::{PAPER, Rgb, outline_colour};
use crate::png::text::{Align, LABEL, TICK};
use lumiduct_base::error::Result;

/// A cut through the geometry, seen along its normal.
#[derive(Debug, Clone)]
pub(crate) struct CrossSection {
    /// What is shown.
    pub title: String,
    /// Which plane it is; may be empty.
    pub subtitle: String,
    /// Name and unit of the horizontal axis: "x in mm".
    pub x_label: String,
    /// Name and unit of the vertical axis.
    pub y_label: String,
    /// Least and greatest x of the picture, mm.
    pub x_range: [f64; 2],
    /// Least and greatest y of the picture, mm.
    pub y_range: [f64; 2],
    /// Surfaces in the plane.
    pub outlines: Vec<SurfaceDots>,
    /// Paths of light, seen along the normal of the plane.
    pub rays: Vec<RayPath>,
    /// Sources and sensors, seen likewise.
    pub places: Vec<NamedPlace>,
}

/// A name at a place.
#[derive(Debug, Clone)]
pub(crate) struct NamedPlace {
    /// The name.
    pub name: String,
    /// Where, mm.
    pub at: [f64; 2],
    /// Of what.
    pub of: PlaceOf,
}

/// What a place is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PlaceOf {
    /// A source.
    Source,
    /// A sensor.
    Sensor,
}

impl PlaceOf {
    fn colour(self) -> Rgb {
        match self {
            Self::Source => [230, 159, 0],
            Self::Sensor => [204, 121, 167],
        }
    }
}

/// A surface in the plane, as dots.
#[derive(Debug, Clone)]
pub(crate) struct SurfaceDots {
    /// Its name in the legend; may be empty.
    pub name: String,
    /// Outlines of one kind have the same number and colour; 0 is the darkest.
    pub colour: usize,
    /// Points of the surface, mm.
    pub points: Vec<[f64; 2]>,
}

/// A path of light.
#[derive(Debug, Clone)]
pub(crate) struct RayPath {
    /// Its start, its bounces and its end, mm.
    pub points: Vec<[f64; 2]>,
    /// What became of it.
    pub end: RayEnd,
}

/// What became of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RayEnd {
    /// It reached a sensor.
    Sensor,
    /// A surface or a medium absorbed it.
    Absorbed,
    /// It left the scene.
    Escaped,
    /// It leaked, or was ended by the bounce limit or by roulette.
    Lost,
}

impl RayEnd {
    const ALL: [Self; 4] = [Self::Sensor, Self::Absorbed, Self::Escaped, Self::Lost];

    fn name(self) -> &'static str {
        match self {
            Self::Sensor => "to a sensor",
            Self::Absorbed => "absorbed",
            Self::Escaped => "escaped",
            Self::Lost => "lost",
        }
    }

    fn colour(self) -> Rgb {
        match self {
            Self::Sensor => [0, 114, 178],
            Self::Absorbed => [213, 94, 0],
            Self::Escaped => [0, 158, 115],
            Self::Lost => [190, 0, 120],
        }
    }

    fn mark(self) -> EndMark {
        match self {
            Self::Sensor => EndMark::Dot,
            Self::Absorbed => EndMark::Cross,
            Self::Escaped => EndMark::Ring,
            Self::Lost => EndMark::Square,
        }
    }
}

/// Largest size of the plot itself, pixels.
const MOST: [f64; 2] = [780.0, 640.0];
/// Plots of a greater aspect ratio are squeezed.
const LONGEST: f64 = 10.0;
/// Radius of the dots of an outline, pixels.
const DOT: f64 = 1.1;

/// Distance of a name from its place, pixels.
const NAME_GAP: f64 = 7.0;
/// Steps up and down in the search for room for a name.
const NAME_STEPS: u32 = 12;

/// Draws outlines as dots and paths of light as thin lines, each path with a mark at its end; then names.
pub(crate) fn cross_section(section: &CrossSection) -> Result<Vec<u8>> {
    let axes =
        [section.x_range, section.y_range].map(|[a, b]| PlotAxis::new(a, b, AxisScale::Linear));
    let size = plot_size(axes, MOST, LONGEST);
    let [x, y] = axes;
    let x = MarkedAxis::level(x, &section.x_label, size.width);
    let y = MarkedAxis::upright(y, &section.y_label, size.height);
    let frame = PlotAxes::new([x, y], [size.width, size.height])?;
    let content = MARGIN + frame.left_margin() + size.width + MARGIN + 6.0;
    let width = content.max(620.0).ceil();
    let left = (MARGIN + frame.left_margin() + 0.5 * (width - content)).round();
    let header = Header::new(&section.title, &section.subtitle, width - 2.0 * MARGIN)?;
    let names = legend_names(section);
    let entries: Vec<(LegendSample, &str)> =
        names.iter().map(|(sample, name)| (*sample, name.as_str())).collect();
    let legend = Legend::new(&entries, width - 2.0 * MARGIN)?;
    let top = (MARGIN + header.height() + legend.height()).round();
    let below = match size.aspect {
        Aspect::True => 0.0,
        Aspect::Squeezed => TICK.line_step() + 8.0,
    };
    let bottom = top + size.height + frame.bottom_margin();
    let mut canvas = Canvas::new(width as usize, (bottom + below + MARGIN - 6.0) as usize);
    let area = Rect::new(left, top, size.width, size.height);
    header.draw(&mut canvas, MARGIN, MARGIN - 4.0)?;
    legend.draw(&mut canvas, MARGIN, MARGIN + header.height() - 8.0)?;
    frame.draw_grid(&mut canvas, area);
    canvas.clip_to(area);
    draw_outlines(&mut canvas, &frame, area, &section.outlines);
    draw_rays(&mut canvas, &frame, area, &section.rays);
    draw_names(&mut canvas, &frame, area, &section.places)?;
    canvas.clip_to_all();
    frame.draw(&mut canvas, area)?;
    if size.aspect == Aspect::Squeezed {
        remark(&mut canvas, SQUEEZED_REMARK, [MARGIN, bottom + TICK.line_step()])?;
    }
    canvas.into_png()
}

/// One entry per outline name and per path end that occurs, with the number of paths.
fn legend_names(section: &CrossSection) -> Vec<(LegendSample, String)> {
    let mut entries: Vec<(LegendSample, String)> = Vec::new();
    for outline in &section.outlines {
        let entry = (LegendSample::Dot(outline_colour(outline.colour), 4.0), outline.name.clone());
        if !entries.contains(&entry) {
            entries.push(entry);
        }
    }
    for end in RayEnd::ALL {
        let count = section.rays.iter().filter(|ray| ray.end == end).count();
        if count > 0 {
            entries.push((
                LegendSample::MarkedLine(pen(end), end.mark()),
                format!("{} ({count})", end.name()),
            ));
        }
    }
    entries
}

fn pen(end: RayEnd) -> Pen {
    Pen { ink: Ink { colour: end.colour(), opacity: 0.6 }, width: 1.1, dash: &[] }
}

fn draw_outlines(canvas: &mut Canvas, frame: &PlotAxes, area: Rect, outlines: &[SurfaceDots]) {
    for outline in outlines {
        let ink = Ink::opaque(outline_colour(outline.colour));
        for point in &outline.points {
            canvas.dot(frame.place(area, *point), DOT, ink);
        }
    }
}

fn draw_rays(canvas: &mut Canvas, frame: &PlotAxes, area: Rect, rays: &[RayPath]) {
    for ray in rays {
        let places: Vec<Point> = ray.points.iter().map(|point| frame.place(area, *point)).collect();
        canvas.line(&places, &pen(ray.end));
    }
    for ray in rays {
        if let Some(last) = ray.points.last() {
            draw_mark(canvas, ray.end.mark(), frame.place(area, *last), ray.end.colour());
        }
    }
}

/// Names next to their places, on a white background, where there is room.
fn draw_names(
    canvas: &mut Canvas,
    frame: &PlotAxes,
    area: Rect,
    places: &[NamedPlace],
) -> Result<()> {
    let mut taken: Vec<Rect> = Vec::new();
    let inside = || {
        let seen = places.iter().map(|place| (place, frame.place(area, place.at)));
        seen.filter(|(_, at)| area.contains(*at))
    };
    // No mark lies on a name.
    for (place, at) in inside() {
        draw_mark(canvas, EndMark::Square, at, place.of.colour());
    }
    for (place, at) in inside() {
        let (width, height) = (LABEL.width(&place.name)?, LABEL.line_step());
        // To the left where there is no room on the right.
        let is_left = at[0] + NAME_GAP + width > area.right;
        let left = if is_left { at[0] - NAME_GAP - width } else { at[0] + NAME_GAP };
        let room = |step: f64| Rect::new(left, at[1] + (step - 0.5) * height, width, height);
        let is_free = |own: &Rect| {
            let is_inside = area.top <= own.top && own.bottom <= area.bottom;
            is_inside && !taken.iter().any(|other| own.meets(*other))
        };
        let steps = (0..NAME_STEPS).flat_map(|step| [f64::from(step), -f64::from(step)]);
        // A name without room is listed in the text of the check.
        let Some(own) = steps.map(room).find(is_free) else { continue };
        canvas.rect(own.grown(1.0), Ink { colour: PAPER, opacity: 0.8 });
        let base = own.top + 0.5 * (height + LABEL.cap_height());
        write(canvas, &place.name, [left, base], LABEL, Align::Left)?;
        taken.push(own);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::png::palette::INK;
    use crate::png::tests::Decoded;

    fn section_with(rays: Vec<RayPath>, places: Vec<NamedPlace>) -> Decoded {
        let outline = SurfaceDots { name: String::new(), colour: 2, points: Vec::new() };
        decoded(CrossSection { rays, places, ..empty([-10.0, 10.0], outline) })
    }

    fn section(x_range: [f64; 2], points: Vec<[f64; 2]>, rays: Vec<RayPath>) -> Decoded {
        let outline = SurfaceDots { name: String::new(), colour: 2, points };
        decoded(CrossSection { rays, ..empty(x_range, outline) })
    }

    fn decoded(section: CrossSection) -> Decoded {
        Decoded::new(&cross_section(&section).unwrap())
    }

    fn empty(x_range: [f64; 2], outline: SurfaceDots) -> CrossSection {
        CrossSection {
            title: "Pipe".to_string(),
            subtitle: "plane y = 0".to_string(),
            x_label: "x in mm".to_string(),
            y_label: "z in mm".to_string(),
            x_range,
            y_range: [-10.0, 10.0],
            outlines: vec![outline],
            rays: Vec::new(),
            places: Vec::new(),
        }
    }

    fn circle() -> Vec<[f64; 2]> {
        (0..2000)
            .map(|step| (f64::from(step) * std::f64::consts::TAU / 2000.0).sin_cos())
            .map(|(sin, cos)| [8.0 * cos, 8.0 * sin])
            .collect()
    }

    #[test]
    fn a_circle_is_round() {
        for x_range in [[-10.0, 10.0], [-20.0, 60.0], [-9.0, 150.0]] {
            let [left, top, right, bottom] =
                section(x_range, circle(), Vec::new()).bounds(outline_colour(2));
            assert!((right - left).abs_diff(bottom - top) <= 2, "{x_range:?}");
        }
    }

    #[test]
    fn very_long_scenes_are_squeezed_and_stay_tall_enough_to_be_read() {
        let [left, top, right, bottom] =
            section([-9.0, 991.0], circle(), Vec::new()).bounds(outline_colour(2));
        assert!(bottom - top > 50 && right - left < 20);
    }

    #[test]
    fn places_are_marked_and_names_stay_in_the_plot() {
        let named = |y: f64, count: usize| {
            let one = NamedPlace { name: "led".into(), at: [0.0, y], of: PlaceOf::Source };
            section_with(Vec::new(), vec![one; count])
        };
        let one = named(0.0, 1);
        assert!(one.places(PlaceOf::Source.colour()).len() > 10);
        assert!(one.places(PlaceOf::Sensor.colour()).is_empty());
        // Names at one place are stacked: more ink than for one name, and no ink below the plot.
        let ink = |picture: &Decoded| picture.places(INK);
        let bare = ink(&named(0.0, 0));
        let own = ink(&one).len() - bare.len();
        let three = ink(&named(0.0, 3)).len() - bare.len();
        assert!(own > 5 && three > 2 * own, "{own} {three}");
        let lowest = |places: &[(usize, usize)]| places.iter().map(|place| place.1).max();
        assert_eq!(lowest(&ink(&named(-9.9, 6))), lowest(&bare));
    }

    #[test]
    fn paths_end_in_the_mark_of_their_fate() {
        let ray = |y: f64, end: RayEnd| RayPath { points: vec![[-9.0, y], [5.0, y]], end };
        let rays = vec![ray(-4.0, RayEnd::Sensor), ray(4.0, RayEnd::Lost)];
        let picture = section([-10.0, 10.0], Vec::new(), rays);
        // The lines are translucent: only the marks have the full colour, here and in the legend.
        let sensor = picture.places(RayEnd::Sensor.colour());
        let lost = picture.places(RayEnd::Lost.colour());
        assert!(sensor.len() > 20 && lost.len() > 20);
        // The lowest places are in the plot, not in the legend.
        let (sensor, lost) = (sensor[sensor.len() - 1], lost[lost.len() - 1]);
        assert!(sensor.0.abs_diff(lost.0) <= 3);
        assert!(sensor.1 > lost.1, "y grows upward");
        assert!(picture.places(RayEnd::Absorbed.colour()).is_empty());
    }
}
