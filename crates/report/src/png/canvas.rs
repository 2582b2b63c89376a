//! The canvas: areas, lines, dots, bitmaps and text in pixels, and the PNG file made from it.
//!
//! The only module that uses the `png` crate. Knows nothing of axes and data. The origin is the
//! upper left corner, whole numbers are edges of pixels. Everything is drawn [`FINER`] times finer
//! and averaged at the end, so that slanted edges are smooth while edges on whole pixels stay
//! sharp.

use crate::png::geometry::{Point, Rect, clip, distance};
use crate::png::palette::{PAPER, Rgb};
use crate::png::text::{self, Label};
use lumiduct_base::error::{Error, Result};

/// Fine pixels per pixel, in each direction.
const FINER: usize = 3;

/// A colour and how much it covers what is below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ink {
    /// The colour.
    pub(crate) colour: Rgb,
    /// From 0, invisible, to 1.
    pub(crate) opacity: f64,
}

impl Ink {
    /// A colour that hides what is below.
    pub(crate) fn opaque(colour: Rgb) -> Self {
        Self { colour, opacity: 1.0 }
    }
}

/// What a line is drawn with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pen {
    /// Colour; a line that crosses itself is not darker there.
    pub(crate) ink: Ink,
    /// Width of the line, pixels.
    pub(crate) width: f64,
    /// Lengths of dashes and gaps in turn, pixels; empty for a solid line.
    pub(crate) dash: &'static [f64],
}

/// A picture under construction.
pub(crate) struct Canvas {
    width: usize,
    height: usize,
    fine: Vec<u8>,
    /// Which transparent stroke touched a fine pixel last, so that it inks every pixel once.
    touched: Vec<u32>,
    stroke: u32,
    clip: Rect,
}

impl Canvas {
    /// A white canvas of a size in pixels.
    pub(crate) fn new(width: usize, height: usize) -> Self {
        let count = width * height * FINER * FINER;
        Self {
            width,
            height,
            fine: PAPER.repeat(count),
            touched: vec![0; count],
            stroke: 0,
            clip: Rect::new(0.0, 0.0, width as f64, height as f64),
        }
    }

    /// From now on lines, dots and areas are drawn only inside `area`.
    pub(crate) fn clip_to(&mut self, area: Rect) {
        self.clip = Rect {
            left: area.left.max(0.0),
            top: area.top.max(0.0),
            right: area.right.min(self.width as f64),
            bottom: area.bottom.min(self.height as f64),
        };
    }

    /// Ends the clipping.
    pub(crate) fn clip_to_all(&mut self) {
        self.clip = Rect::new(0.0, 0.0, self.width as f64, self.height as f64);
    }

    /// Fills a rectangle.
    pub(crate) fn rect(&mut self, rect: Rect, ink: Ink) {
        let Rect { left, top, right, bottom } = rect;
        self.area(&[[left, top], [right, top], [right, bottom], [left, bottom]], ink);
    }

    /// The outline of a rectangle, one pixel wide, outside of it.
    pub(crate) fn border(&mut self, rect: Rect, ink: Ink) {
        let Rect { left, top, right, bottom } = rect.grown(1.0);
        self.rect(Rect { left, top, right, bottom: top + 1.0 }, ink);
        self.rect(Rect { left, top: bottom - 1.0, right, bottom }, ink);
        self.rect(Rect { left, top, right: left + 1.0, bottom }, ink);
        self.rect(Rect { left: right - 1.0, top, right, bottom }, ink);
    }

    /// Fills a polygon, by the even-odd rule; non-finite corners are left out.
    pub(crate) fn area(&mut self, corners: &[Point], ink: Ink) {
        self.stroke += 1;
        let corners: Vec<Point> =
            corners.iter().copied().filter(|p| p[0].is_finite() && p[1].is_finite()).collect();
        let low = corners.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min).max(self.clip.top);
        let high =
            corners.iter().map(|p| p[1]).fold(f64::NEG_INFINITY, f64::max).min(self.clip.bottom);
        for row in fine_range(low, high) {
            let y = fine_centre(row);
            let mut crossings: Vec<f64> = Vec::new();
            for (index, from) in corners.iter().enumerate() {
                let to = corners[(index + 1) % corners.len()];
                if (from[1] <= y) != (to[1] <= y) {
                    crossings.push(from[0] + (y - from[1]) / (to[1] - from[1]) * (to[0] - from[0]));
                }
            }
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                let columns = fine_range(pair[0].max(self.clip.left), pair[1].min(self.clip.right));
                columns.for_each(|column| self.touch(column, row, ink));
            }
        }
    }

    /// A line through points; non-finite points interrupt it.
    pub(crate) fn line(&mut self, points: &[Point], pen: &Pen) {
        self.stroke += 1;
        let mut walked = 0.0;
        for pair in points.windows(2) {
            if pair.iter().flatten().all(|coordinate| coordinate.is_finite()) {
                if let Some([from, to]) = clip(pair[0], pair[1], self.clip.grown(pen.width)) {
                    self.dashes(from, to, pen, walked);
                    walked += distance(from, to);
                }
            } else {
                walked = 0.0;
            }
        }
    }

    /// A filled circle; none where the centre is non-finite.
    pub(crate) fn dot(&mut self, centre: Point, radius: f64, ink: Ink) {
        self.stroke += 1;
        if centre.iter().all(|coordinate| coordinate.is_finite())
            && self.clip.grown(radius).contains(centre)
        {
            self.capsule(centre, centre, radius, ink);
        }
    }

    /// Fills `area`, given in whole pixels of the paper, with the colour that `colour_of` gives for
    /// each of its pixels (column, row).
    pub(crate) fn bitmap(&mut self, area: Rect, colour_of: impl Fn(usize, usize) -> Rgb) {
        let (left, top) = (area.left as usize, area.top as usize);
        for row in 0..area.height() as usize {
            let colours = (0..area.width() as usize).map(|column| colour_of(column, row));
            let line = colours.flat_map(|colour| [colour; FINER]).collect::<Vec<_>>();
            let line = line.as_flattened();
            for fine_row in (top + row) * FINER..(top + row + 1) * FINER {
                let start = (fine_row * self.width + left) * FINER * 3;
                self.fine[start..start + line.len()].copy_from_slice(line);
            }
        }
    }

    /// Writes a label.
    pub(crate) fn text(&mut self, label: &Label<'_>) -> Result<()> {
        let size = ((self.width * FINER) as u32, (self.height * FINER) as u32);
        text::draw(&mut self.fine, size, FINER as f64, label)
    }

    /// The picture as a PNG file, 8 bits of red, green and blue.
    pub(crate) fn into_png(self) -> Result<Vec<u8>> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Balanced);
        let mut writer = encoder.write_header().map_err(png_error)?;
        writer.write_image_data(&self.averaged()).map_err(png_error)?;
        writer.finish().map_err(png_error)?;
        Ok(file)
    }

    fn averaged(&self) -> Vec<u8> {
        let count = (FINER * FINER) as u16;
        let mut sums = vec![0; self.width * FINER * 3];
        let mut pixels = Vec::with_capacity(self.width * self.height * 3);
        for rows in self.fine.chunks_exact(sums.len() * FINER) {
            sums.fill(0);
            for row in rows.chunks_exact(sums.len()) {
                sums.iter_mut().zip(row).for_each(|(sum, part)| *sum += u16::from(*part));
            }
            for fine in sums.chunks_exact(FINER * 3) {
                let mut total = [count / 2; 3];
                for pixel in fine.chunks_exact(3) {
                    total.iter_mut().zip(pixel).for_each(|(total, part)| *total += part);
                }
                pixels.extend_from_slice(&total.map(|total| (total / count) as u8));
            }
        }
        pixels
    }

    /// The dashes of a line from `from` to `to` whose pattern began `walked` pixels before.
    fn dashes(&mut self, from: Point, to: Point, pen: &Pen, walked: f64) {
        let length = distance(from, to);
        let period: f64 = pen.dash.iter().sum();
        if pen.dash.is_empty() || length == 0.0 {
            return self.capsule(from, to, 0.5 * pen.width, pen.ink);
        }
        let at = |t: f64| {
            let share = t.clamp(0.0, length) / length;
            [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])]
        };
        let mut start = -(walked % period);
        while start < length {
            for dash in pen.dash.chunks_exact(2) {
                if start + dash[0] > 0.0 && start < length {
                    self.capsule(at(start), at(start + dash[0]), 0.5 * pen.width, pen.ink);
                }
                start += dash[0] + dash[1];
            }
        }
    }

    /// Everything within `radius` of the stretch from `from` to `to`.
    fn capsule(&mut self, from: Point, to: Point, radius: f64, ink: Ink) {
        let along = [to[0] - from[0], to[1] - from[1]];
        let length2 = along[0] * along[0] + along[1] * along[1];
        let steep = along[1].abs() > along[0].abs();
        let (main, cross) = if steep { (1, 0) } else { (0, 1) };
        let slope = if along[main] == 0.0 { 0.0 } else { along[cross] / along[main] };
        let reach = radius * (1.0 + slope * slope).sqrt();
        let low = from[main].min(to[main]) - radius;
        let high = from[main].max(to[main]) + radius;
        for first in fine_range(low, high) {
            let a = fine_centre(first);
            let nearest = a.clamp(from[main].min(to[main]), from[main].max(to[main]));
            let middle = from[cross] + slope * (nearest - from[main]);
            for second in fine_range(middle - reach, middle + reach) {
                let b = fine_centre(second);
                let (x, y) = if steep { (b, a) } else { (a, b) };
                let t = (x - from[0]) * along[0] + (y - from[1]) * along[1];
                let share = if length2 == 0.0 { 0.0 } else { (t / length2).clamp(0.0, 1.0) };
                let foot = [from[0] + share * along[0], from[1] + share * along[1]];
                if distance([x, y], foot) <= radius && self.clip.contains([x, y]) {
                    let (column, row) = if steep { (second, first) } else { (first, second) };
                    self.touch(column, row, ink);
                }
            }
        }
    }

    /// Inks a fine pixel; a transparent stroke inks it only once.
    fn touch(&mut self, column: usize, row: usize, ink: Ink) {
        let index = row * self.width * FINER + column;
        let pixel = &mut self.fine[3 * index..3 * index + 3];
        if ink.opacity == 1.0 {
            pixel.copy_from_slice(&ink.colour);
        } else if self.touched[index] != self.stroke {
            self.touched[index] = self.stroke;
            for (below, above) in pixel.iter_mut().zip(ink.colour) {
                let mixed =
                    f64::from(*below) * (1.0 - ink.opacity) + f64::from(above) * ink.opacity;
                *below = mixed.round() as u8;
            }
        }
    }
}

/// The fine pixels whose centres lie between two coordinates.
fn fine_range(low: f64, high: f64) -> std::ops::Range<usize> {
    let index = |edge: f64| (edge * FINER as f64 - 0.5).ceil().max(0.0) as usize;
    index(low)..index(high)
}

fn fine_centre(index: usize) -> f64 {
    (index as f64 + 0.5) / FINER as f64
}

fn png_error(error: png::EncodingError) -> Error {
    Error::Output { what: "PNG".to_string(), reason: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLACK: Ink = Ink { colour: [0, 0, 0], opacity: 1.0 };
    const HALF: Ink = Ink { colour: [0, 0, 0], opacity: 0.5 };

    fn red(canvas: &Canvas, column: usize, row: usize) -> u8 {
        canvas.averaged()[(row * canvas.width + column) * 3]
    }

    #[test]
    fn rectangles_on_whole_pixels_are_sharp() {
        let mut canvas = Canvas::new(12, 10);
        canvas.rect(Rect::new(3.0, 2.0, 4.0, 5.0), BLACK);
        for row in 0..10 {
            for column in 0..12 {
                let expected =
                    if (3..7).contains(&column) && (2..7).contains(&row) { 0 } else { 255 };
                assert_eq!(red(&canvas, column, row), expected, "{column} {row}");
            }
        }
    }

    #[test]
    fn a_line_that_crosses_itself_is_evenly_dark() {
        let mut canvas = Canvas::new(20, 20);
        let pen = Pen { ink: HALF, width: 3.0, dash: &[] };
        canvas.line(&[[2.0, 10.0], [18.0, 10.0], [10.0, 18.0], [10.0, 2.0]], &pen);
        let shades: Vec<u8> = canvas.fine.clone();
        assert!(shades.iter().all(|&shade| shade == 255 || shade == 128));
        assert_eq!(red(&canvas, 10, 10), 128);
    }

    #[test]
    fn a_slanted_line_covers_its_length_times_its_width() {
        let mut canvas = Canvas::new(100, 100);
        canvas.line(&[[20.0, 20.0], [80.0, 70.0]], &Pen { ink: BLACK, width: 2.0, dash: &[] });
        let covered: f64 =
            canvas.averaged().chunks(3).map(|pixel| 1.0 - f64::from(pixel[0]) / 255.0).sum();
        let expected = 2.0 * 60.0f64.hypot(50.0) + std::f64::consts::PI;
        assert!((covered / expected - 1.0).abs() < 0.02, "{covered} {expected}");
    }

    #[test]
    fn dashes_cover_their_share_of_the_line() {
        let mut canvas = Canvas::new(400, 20);
        let pen = Pen { ink: BLACK, width: 1.0, dash: &[9.0, 6.0] };
        canvas.line(&[[0.0, 10.5], [100.0, 10.5], [400.0, 10.5]], &pen);
        let covered: f64 =
            canvas.averaged().chunks(3).map(|pixel| 1.0 - f64::from(pixel[0]) / 255.0).sum();
        assert!((covered / 400.0 - 0.64).abs() < 0.06, "{covered}");
    }

    #[test]
    fn nothing_is_drawn_outside_the_clip_however_far_the_line_goes() {
        let mut canvas = Canvas::new(20, 20);
        canvas.clip_to(Rect::new(5.0, 5.0, 10.0, 10.0));
        let pen = Pen { ink: BLACK, width: 2.0, dash: &[3.0, 3.0] };
        canvas.line(&[[-1e6, 9.0], [1e6, 11.0], [f64::NAN, 0.0], [1.0, 1.0]], &pen);
        canvas.line(&[[-1e300, 9.0], [1e300, 1e300], [f64::INFINITY, 0.0]], &pen);
        canvas.dot([1e12, 1e12], 3.0, BLACK);
        canvas.area(&[[-1e9, -1e9], [1e9, -1e9], [1e9, 7.0], [f64::INFINITY, 7.0]], BLACK);
        assert_eq!(red(&canvas, 4, 10), 255);
        assert_eq!(red(&canvas, 15, 10), 255);
        assert!((5..15).any(|column| red(&canvas, column, 10) < 128));
    }
}
