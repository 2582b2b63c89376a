//! `report.html` on a phone: 390 CSS pixels and touch input.

use crate::{Report, driver, figure};
use serde_json::Value;

const WIDTH: u32 = 390;
/// Smallest readable font size, CSS pixels.
const LEAST_LETTERS: f64 = 11.0;

/// Sizes of all letters in drawings, as they are on the screen.
const LETTERS: &str = "[...document.querySelectorAll('svg text')].map((text) => {
    const svg = text.ownerSVGElement;
    const scale = svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;
    return scale * parseFloat(getComputedStyle(text).fontSize);
})";

#[test]
fn a_phone_shows_letters_that_can_be_read_and_tables_in_boxes_that_scroll() {
    let Some(program) = driver::find() else { return };
    let report = Report::new();
    let page = report.open(&program);
    page.on_phone(WIDTH, 844);
    // Drawings follow the width of the window.
    let widest = "Math.max(...[...document.querySelectorAll('figure svg')].map((e) => e.getBoundingClientRect().right))";
    page.expect(&format!("{widest} <= {WIDTH}"));
    page.expect(&format!("document.documentElement.scrollWidth <= {WIDTH}"));
    page.expect(&format!("{LETTERS}.length > 50"));
    let letters = page.ask(LETTERS);
    for size in letters.as_array().unwrap() {
        assert!(size.as_f64().unwrap() >= LEAST_LETTERS, "{letters}");
    }
    let outside = "[...document.querySelectorAll('figure svg text')].filter((text) => {
        const [own, all] = [text, text.ownerSVGElement].map((e) => e.getBoundingClientRect());
        return own.left < all.left - 1 || own.right > all.right + 1 || own.bottom > all.bottom + 1;
    }).map((text) => text.textContent)";
    assert_eq!(page.ask(outside), Value::Array(Vec::new()), "letters that are cut off");
    let boxes = "[...document.querySelectorAll('.table')]";
    let scrolls = format!("{boxes}.filter((e) => e.scrollWidth > e.clientWidth)");
    assert!(page.ask(&format!("{scrolls}.length")).as_u64() > Some(0));
    let is_own = format!("{boxes}.every((e) => getComputedStyle(e).overflowX === 'auto')");
    assert_eq!(page.ask(&is_own), true);
    page.picture(&report.path("phone.png"));
    page.expect_no_complaints();
}

#[test]
fn a_finger_scrolls_over_maps_and_draws_sections_when_asked_to() {
    let Some(program) = driver::find() else { return };
    let report = Report::new();
    let page = report.open(&program);
    page.on_phone(WIDTH, 844);
    page.expect(&format!("document.documentElement.scrollWidth <= {WIDTH}"));
    let map = figure("illuminance", 0);
    let image = format!("{map}.querySelector('image')");
    let section = format!("{map}.querySelector('.section svg').textContent");
    let before = page.text(&section);

    page.place(&image, [0.5, 0.5]);
    let from = page.ask("scrollY").as_f64().unwrap();
    page.stroke(&image, [0.5, 0.9], [0.5, 0.1]);
    page.expect(&format!("scrollY > {from} + 50"));
    assert_eq!(page.text(&section), before, "scrolling has drawn a section");

    let button = format!("{map}.querySelector('button.touch')");
    assert_ne!(page.text(&format!("getComputedStyle({button}).display")), "none");
    page.ask(&format!("{button}.click()"));
    assert_eq!(page.ask(&format!("{button}.ariaPressed")), "true");
    page.place(&image, [0.5, 0.5]);
    let from = page.ask("scrollY");
    page.stroke(&image, [0.3, 0.2], [0.6, 0.8]);
    page.expect(&format!("{section} !== {}", serde_json::to_string(&before).unwrap()));
    assert_eq!(page.ask("scrollY"), from, "drawing has scrolled the page");
    page.expect_no_complaints();
}
