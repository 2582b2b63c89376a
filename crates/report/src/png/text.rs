//! Lettering: measures and draws text in the built-in font.
//!
//! The only module of the program that uses plotters. The font is `DejaVu` Sans cut down to Latin, Greek, Cyrillic
//! and the symbols of physics (`font/`); system fonts are never used, so pictures are the same
//! everywhere.

use crate::png::palette::Rgb;
use lumiduct_base::error::{Error, Result};
use lumiduct_base::number::shorten;
use plotters::backend::BitMapBackend;
use plotters::prelude::{DrawingBackend, RGBColor};
use plotters::style::{FontDesc, FontFamily, FontStyle, FontTransform, TextStyle, register_font};
use std::sync::OnceLock;

const FAMILY: &str = "lumiduct";
static REGULAR: &[u8] = include_bytes!("font/lumiduct-regular.ttf");
static BOLD: &[u8] = include_bytes!("font/lumiduct-bold.ttf");

/// Ascent plus descent of the font, in em: the library takes this height, not the em.
const LINE_HEIGHT_EM: f64 = 2384.0 / 2048.0;
/// Height of capitals and digits, in em.
const CAP_HEIGHT_EM: f64 = 1493.0 / 2048.0;

/// A size and weight of letters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Font {
    /// Size of the em, pixels.
    pub(crate) size: f64,
    /// Thickness of the strokes.
    pub(crate) weight: Weight,
}

/// Thickness of the strokes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Weight {
    /// For everything but titles.
    Regular,
    /// For titles.
    Bold,
}

/// Titles.
pub(crate) const TITLE: Font = Font { size: 19.0, weight: Weight::Bold };
/// Subtitles, axis labels and legends.
pub(crate) const LABEL: Font = Font { size: 15.0, weight: Weight::Regular };
/// Numbers at axes, remarks.
pub(crate) const TICK: Font = Font { size: 14.0, weight: Weight::Regular };

/// Where a text lies relative to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    /// It begins there.
    Left,
    /// It is centred there.
    Centre,
    /// It ends there.
    Right,
}

/// Which way a text runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Direction {
    /// From left to right.
    Level,
    /// From bottom to top.
    Upward,
}

/// A line of text and its place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Label<'a> {
    /// What is written.
    pub(crate) text: &'a str,
    /// Point of the baseline, pixels from the upper left corner.
    pub(crate) at: [f64; 2],
    /// Size and weight.
    pub(crate) font: Font,
    /// Which point of the baseline that is.
    pub(crate) align: Align,
    /// Which way it runs.
    pub(crate) direction: Direction,
    /// Its colour.
    pub(crate) colour: Rgb,
}

impl Font {
    /// Height of capitals and digits, pixels.
    pub(crate) fn cap_height(self) -> f64 {
        CAP_HEIGHT_EM * self.size
    }

    /// Distance of two baselines, pixels.
    pub(crate) fn line_step(self) -> f64 {
        (1.35 * self.size).round()
    }

    /// Width of a text, pixels.
    pub(crate) fn width(self, text: &str) -> Result<f64> {
        // Measured large: the library gives whole pixels.
        const MAGNIFIED: f64 = 16.0;
        let font = self.description(MAGNIFIED)?;
        let (_, (width, _)) = font.layout_box(&printable(text)).map_err(font_error)?;
        Ok(f64::from(width) / MAGNIFIED)
    }

    /// The text, with its middle removed if it is wider than `width` pixels.
    pub(crate) fn fit(self, text: &str, width: f64) -> Result<String> {
        let mut fitting = text.to_string();
        let mut letters = text.chars().count();
        while self.width(&fitting)? > width && letters > 1 {
            let share = width / self.width(&fitting)?;
            letters = ((letters as f64 * share) as usize).clamp(1, letters - 1);
            fitting = shorten(text, letters);
        }
        Ok(fitting)
    }

    /// The text in lines of at most `width` pixels, broken between words; text beyond `most` lines
    /// is cut.
    pub(crate) fn wrap(self, text: &str, width: f64, most: usize) -> Result<Vec<String>> {
        let mut lines: Vec<String> = Vec::new();
        for word in text.split_whitespace() {
            match lines.last() {
                None => lines.push(word.to_string()),
                Some(line) => {
                    let longer = format!("{line} {word}");
                    if self.width(&longer)? <= width || lines.len() == most {
                        lines.pop();
                        lines.push(longer);
                    } else {
                        lines.push(word.to_string());
                    }
                }
            }
        }
        lines.into_iter().map(|line| self.fit(&line, width)).collect()
    }

    fn description(self, scale: f64) -> Result<FontDesc<'static>> {
        register()?;
        let style = match self.weight {
            Weight::Regular => FontStyle::Normal,
            Weight::Bold => FontStyle::Bold,
        };
        Ok(FontDesc::new(FontFamily::Name(FAMILY), self.drawn_height(scale), style))
    }

    /// The height passed to the library: a whole, even number, so that its rounding moves no glyph.
    fn drawn_height(self, scale: f64) -> f64 {
        (LINE_HEIGHT_EM * self.size * scale / 2.0).round() * 2.0
    }
}

/// Draws a label into RGB pixels of a picture enlarged `scale` times.
pub(crate) fn draw(
    pixels: &mut [u8],
    size: (u32, u32),
    scale: f64,
    label: &Label<'_>,
) -> Result<()> {
    let font = label.font.description(scale)?;
    // The library puts the baseline half its height below the point.
    let half = label.font.drawn_height(scale) / 2.0;
    let width = label.font.width(label.text)?;
    let shift = match label.align {
        Align::Left => 0.0,
        Align::Centre => -0.5 * width,
        Align::Right => -width,
    };
    let [x, y] = label.at;
    let (font, x, y) = match label.direction {
        Direction::Level => (font, (x + shift) * scale, y * scale - half),
        Direction::Upward => {
            (font.transform(FontTransform::Rotate270), x * scale - half, (y - shift) * scale)
        }
    };
    let [red, green, blue] = label.colour;
    let colour = RGBColor(red, green, blue);
    let style = TextStyle::from(font).color(&colour);
    BitMapBackend::with_buffer(pixels, size)
        .draw_text(&printable(label.text), &style, (x.round() as i32, y.round() as i32))
        .map_err(font_error)
}

/// The text without line breaks and other characters without a glyph.
fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

fn register() -> Result<()> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let good = REGISTERED.get_or_init(|| {
        register_font(FAMILY, FontStyle::Normal, REGULAR).is_ok()
            && register_font(FAMILY, FontStyle::Bold, BOLD).is_ok()
    });
    if *good { Ok(()) } else { Err(font_error("the built-in font is not readable")) }
}

fn font_error(reason: impl std::fmt::Display) -> Error {
    Error::Output { what: "lettering of a picture".to_string(), reason: reason.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A text in black at (100, 30) in a picture of 200 by 40.
    fn drawn(text: &str, align: Align) -> Vec<u8> {
        let mut pixels = vec![255; 200 * 40 * 3];
        let at = [100.0, 30.0];
        let label =
            Label { text, at, font: TITLE, align, direction: Direction::Level, colour: [0, 0, 0] };
        draw(&mut pixels, (200, 40), 1.0, &label).unwrap();
        pixels
    }

    /// First and last column that a text blackens.
    fn columns(text: &str, align: Align) -> (usize, usize) {
        let pixels = drawn(text, align);
        let dark: Vec<usize> =
            (0..200).filter(|x| (0..40).any(|y| pixels[(y * 200 + x) * 3] < 128)).collect();
        (dark[0], dark[dark.len() - 1])
    }

    #[test]
    fn the_font_has_every_sign_that_reports_need() {
        let (blank, missing) = (drawn(" ", Align::Left), drawn("\u{1F600}", Align::Left));
        assert_ne!(blank, missing);
        for sign in "²³·×±−°µμΩ⁻⁰¹²⁴⁵⁶⁷⁸⁹…–→≥≤σγΦΔθäßéñżЖя".chars()
        {
            let pixels = drawn(&sign.to_string(), Align::Left);
            assert!(pixels != missing && pixels != blank, "{sign}");
        }
    }

    #[test]
    fn alignment_puts_the_text_on_its_side_of_the_point() {
        let (first, last) = columns("HHHH", Align::Left);
        assert!((100..=103).contains(&first) && last > 140, "{first} {last}");
        let (first, last) = columns("HHHH", Align::Right);
        assert!((96..=100).contains(&last) && first < 60, "{first} {last}");
        let (first, last) = columns("HHHH", Align::Centre);
        assert!((first as f64 + last as f64 - 200.0).abs() <= 3.0, "{first} {last}");
    }

    #[test]
    fn glyphs_keep_the_white_space_before_them() {
        // A bar has 5 of its 6.4 pixels as white space, half on either side.
        let (first, _) = columns("|", Align::Left);
        assert!(first >= 102, "{first}");
    }

    #[test]
    fn long_texts_are_broken_and_then_cut() {
        let text = "forward estimator, two million paths, seed 1, stopped by relative error";
        let lines = LABEL.wrap(text, 300.0, 2).unwrap();
        assert_eq!(lines.len(), 2);
        assert_eq!(lines.join(" "), text);
        let lines = LABEL.wrap(text, 200.0, 2).unwrap();
        assert_eq!(lines.len(), 2);
        assert!(lines[1].contains('…'));
        for line in lines {
            assert!(LABEL.width(&line).unwrap() <= 200.0);
        }
        assert!(LABEL.wrap("", 300.0, 2).unwrap().is_empty());
    }
}
