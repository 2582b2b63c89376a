//! Sheets with scatter from files: what photons, gather paths and joins find behind them.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

mod traced;

use glam::{DVec2, DVec3};
use lumiduct_base::math::{DirectionPatches, RingPatches};
use lumiduct_core::plan::Request;
use lumiduct_input::Settings;
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;

/// The window of the scene `daylight_window_bsdf`.
const REDIRECTING: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/scatter/redirecting.xml");
/// Shares of the window: straight on, up where light came down, and by Lambert's law.
const STRAIGHT: f64 = 0.40;
const REDIRECTED: f64 = 0.35;
const DIFFUSE: f64 = 0.05;
/// Shares that its front, the outside, and its back reflect by Lambert's law.
const REFLECTED: [f64; 2] = [0.10, 0.15];

/// The Klems half basis.
fn klems_half() -> (RingPatches, [usize; 7]) {
    let angles = [0.0f64, 6.5, 19.5, 32.5, 45.5, 58.5, 71.5, 90.0].map(f64::to_radians);
    let sectors = [1, 8, 12, 16, 20, 12, 8];
    (RingPatches::new(&angles, sectors.to_vec()).unwrap(), sectors)
}

/// The patch whose light goes up where that of another goes down.
fn mirrored(rings: &RingPatches, patch: usize) -> usize {
    let [ring, sector] = rings.ring_and_sector(patch);
    let count = rings.sectors(ring);
    rings.first(ring) + (count - sector) % count
}

/// The transmission of the window from patch to patch, 1/sr.
fn transmission(rings: &RingPatches, from: usize, to: usize) -> f64 {
    let solid = rings.projected(rings.ring_and_sector(to)[0]);
    let share = |patch: usize, share: f64| if patch == to { share / solid } else { 0.0 };
    DIFFUSE / PI + share(from, STRAIGHT) + share(mirrored(rings, from), REDIRECTED)
}

fn redirecting_xml() -> String {
    let (rings, sectors) = klems_half();
    let count = sectors.iter().sum::<usize>();
    let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
        <!-- A made-up light-redirecting glazing, written by tests/scatter.rs: 40 % goes straight on, 35 % up where it came down and\n\
        the other way round, 5 % leaves by Lambert's law; by it 10 % are reflected outside and 15 % inside. -->\n\
        <WindowElement>\n<Optical>\n<Layer>\n\
        <Material><Name>light-redirecting glazing</Name></Material>\n\
        <DataDefinition><IncidentDataStructure>Columns</IncidentDataStructure></DataDefinition>\n"
        .to_owned();
    for direction in
        ["Transmission Front", "Transmission Back", "Reflection Front", "Reflection Back"]
    {
        let reflected = REFLECTED[usize::from(direction.ends_with("Back"))];
        let is_through = direction.starts_with('T');
        let kind = if is_through { "BTDF" } else { "BRDF" };
        _ = writeln!(
            text,
            "<WavelengthData>\n<Wavelength unit=\"Integral\">Visible</Wavelength>\n<WavelengthDataBlock>\n\
             <WavelengthDataDirection>{direction}</WavelengthDataDirection>\n\
             <ColumnAngleBasis>LBNL/Klems Half</ColumnAngleBasis>\n<RowAngleBasis>LBNL/Klems Half</RowAngleBasis>\n\
             <ScatteringDataType>{kind}</ScatteringDataType>\n<ScatteringData>"
        );
        for to in 0..count {
            for from in 0..count {
                let value =
                    if is_through { transmission(&rings, from, to) } else { reflected / PI };
                _ = write!(text, "{value:.5},");
            }
            text.push('\n');
        }
        text.push_str("</ScatteringData>\n</WavelengthDataBlock>\n</WavelengthData>\n");
    }
    text + "</Layer>\n</Optical>\n</WindowElement>\n"
}

#[test]
fn the_file_of_the_scene_is_what_it_says() {
    let (path, text) = (Path::new(REDIRECTING), redirecting_xml());
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(path, &text).unwrap();
    }
    assert!(std::fs::read_to_string(path).unwrap() == text, "UPDATE_GOLDEN=1 writes {REDIRECTING}");
}

/// A window of 1 m that a sky of 1000 lx, the same all over, lights from the south, and cells behind it.
fn room(sensor: &str) -> String {
    format!(
        r#"
[finishes.window.scatter_file]
file = {REDIRECTING:?}

# A frame without depth, on whose port the sky starts.
[sheets.frame.tube]
profile = {{ rectangle = {{ width_mm = 1000, height_mm = 1000 }} }}
path = [{{ straight_mm = 0.1 }}]
finish = "black"
at = {{ position_mm = [0, -0.1, 0], axis = [0, 1, 0], x_axis = [-1, 0, 0] }}

[sheets.window.rectangle]
width_mm = 1000
height_mm = 1000
finish = "window"
at = {{ position_mm = [0, 0, 0], axis = [0, -1, 0], x_axis = [1, 0, 0] }}

[sources.sky.sky]
model = "uniform"
horizontal_illuminance_lx = 1000
aim = "frame.entry"

[sensors.cell]
plane = {{ rectangle = {{ width_mm = 80, height_mm = 80 }} }}
at = {{ {sensor} }}
aim = ["window.surface"]
"#
    )
}

/// Illuminance of a point behind the window, lx: the integral over window and sky of its three phases, sky, window and view (G. Ward
/// et al., Simulating the daylight performance of complex fenestration systems using bidirectional scattering distribution functions
/// within Radiance, Leukos 7(4), 2011, eq. 1).
fn expected(point: DVec3, normal: DVec3) -> f64 {
    let (rings, sectors) = klems_half();
    let patches = DirectionPatches::Rings(rings.clone());
    let count = sectors.iter().sum::<usize>();
    // Illuminance of the window through each patch: a luminance of 1000 lx/π where light comes down. Patches about the horizon
    // are half dark, the one about the normal too.
    let sky = |patch: usize| {
        let u = |n: usize| [(n / 50) as f64 + 0.5, (n % 50) as f64 + 0.5].map(|at| at / 50.0);
        let down = (0..2500).filter(|n| patches.direction(patch, u(*n)).y < 0.0).count();
        1000.0 / PI * patches.projected(patch) * down as f64 / 2500.0
    };
    let sky: Vec<f64> = (0..count).map(sky).collect();
    // Luminance of the window toward each patch.
    let luminance: Vec<f64> = (0..count)
        .map(|to| (0..count).map(|from| transmission(&rings, from, to) * sky[from]).sum())
        .collect();
    let steps = 400;
    let mut sum = 0.0;
    for n in 0..steps * steps {
        let at = |n: usize| 1000.0 * ((n as f64 + 0.5) / f64::from(steps as u32) - 0.5);
        let from = DVec3::new(at(n / steps), 0.0, at(n % steps));
        let way = point - from;
        let dir = way.normalize();
        // x of the file points to the right as seen from inside, where light goes to +y.
        let patch = patches.patch(DVec2::new(dir.dot(DVec3::NEG_X), dir.z));
        let cosines = dir.y * (-dir.dot(normal)).max(0.0);
        sum += luminance[patch] * cosines / way.length_squared();
    }
    sum * (1000.0 / f64::from(steps as u32)).powi(2)
}

#[test]
fn each_side_of_a_sheet_is_that_of_the_file() {
    let beam = |y: f64, toward: f64| {
        let beam = format!(
            "[sources.beam.disk]\nradius_mm = 1\nflux_lm = 10\nemission = \"collimated\"\n\
             at = {{ position_mm = [0, {y}, 0], axis = [0, {toward}, 0] }}\n"
        );
        let sensor = format!("position_mm = [0, {y}, 0], axis = [0, {toward}, 0]");
        let lit = room(&sensor).split_once("[sources").map(|(window, rest)| {
            let (_, sensors) = rest.split_once("[sensors").unwrap();
            format!("{window}{beam}[sensors{sensors}")
        });
        let settings = Settings { paths: Some(200_000), ..Settings::default() };
        let text = lit
            .unwrap()
            .replace("width_mm = 80, height_mm = 80", "width_mm = 4000, height_mm = 4000");
        traced::measures(&traced::load(&text, &settings)).values["cell.efficiency"].clone()
    };
    // All reflected light but that beyond the edge of a square of 4 m at 0.5 m.
    for (found, reflected) in [beam(-500.0, 1.0), beam(500.0, -1.0)].into_iter().zip(REFLECTED) {
        let share = found.value / reflected;
        assert!((0.93..0.96).contains(&share) && found.std_error < 0.01 * reflected, "{found:?}");
    }
}

#[test]
fn desk_and_ceiling_behind_a_window_see_the_three_phases() {
    for (point, normal) in [
        (DVec3::new(0.0, 1500.0, -900.0), DVec3::Z),
        (DVec3::new(0.0, 1500.0, 900.0), DVec3::NEG_Z),
        (DVec3::new(-700.0, 1000.0, 100.0), DVec3::NEG_Y),
    ] {
        let expected = expected(point, normal);
        let [p, n] = [point, normal].map(|v| v.to_array());
        let text = room(&format!("position_mm = {p:?}, axis = {n:?}"));
        for estimator in [Request::Forward, Request::Backward, Request::Mix, Request::Gather] {
            let (paths, most) = match estimator {
                Request::Forward => (4_000_000, 0.05),
                Request::Gather => (200_000, 0.08),
                _ => (60_000, 0.02),
            };
            let estimator = Some(estimator);
            let settings = Settings { paths: Some(paths), estimator, ..Settings::default() };
            let found = traced::measures(&traced::load(&text, &settings));
            let cell = &found.values["cell.illuminance_avg"];
            let error = cell.std_error.hypot(cell.bias.unwrap_or(0.0));
            assert!(
                (cell.value - expected).abs() < 4.5 * error + 2e-3 * expected,
                "{estimator:?} at {point}: {cell:?}, expected {expected}"
            );
            assert!(error < most * expected, "{estimator:?}: {cell:?}, expected {expected}");
        }
    }
}
