//! Laws of errors: bias falls with the window as predicted, depths agree, and light is neither
//! created nor lost.

use crate::trial::{Comparison, Gathering, SIGMAS, Way, bias_allowance, findings, load, measures};
use lumiduct_core::measure::{self, Measure};
use lumiduct_core::plan::{GatherPlan, RunPlan};
use lumiduct_core::scene::SensorId;
use lumiduct_core::transport::{Findings, Orders, Run};
use std::f64::consts::{FRAC_1_SQRT_2, PI};
use std::time::Duration;

/// A guide and its lamp, without absorption.
const ROD: &str = r#"
[media.acrylic]
index = 1.49
[solids.guide.cylinder]
radius_mm = 2
length_mm = 12
medium = "acrylic"
[sources.led.disk]
radius_mm = 1
at = { face = "guide.entry", gap_mm = 0.1 }
flux_lm = 10
[sensors]
exit = { plane = {}, on = "guide.exit", counts = "leaving", entering = "guide.entry" }
all = { goniometer = { c_step_deg = 360, gamma_step_deg = 90 } }
"#;

const TUBE: &str = r#"
[finishes.mirror]
specular = { reflectance = 1 }
[sheets.guide.tube]
profile = { circle = { radius_mm = 3 } }
path = [{ straight_mm = 20 }]
finish = "mirror"
[sources.led.disk]
radius_mm = 2
flux_lm = 10
[sensors]
exit = { plane = {}, on = "guide.exit", counts = "incident", side = "back" }
all = { goniometer = { c_step_deg = 360, gamma_step_deg = 90 } }
"#;

/// A black tube of radius 5 mm and length 50 mm, a lamp at its one end and an open window at the other, and a sensor.
fn under_a_tube(sensor: &str) -> String {
    format!(
        r#"
[sheets.tube.tube]
profile = {{ circle = {{ radius_mm = 5 }} }}
path = [{{ straight_mm = 50 }}]
finish = "black"
[sheets.window.disk]
radius_mm = 5
finish = "open"
at = {{ position_mm = [0, 0, 50] }}
[sources.lamp.disk]
radius_mm = 5
luminance_cd_m2 = 1000
emission = {{ cone_half_angle_deg = 8 }}
[sensors]
{sensor}
"#
    )
}

fn gather(depth: u32) -> Way {
    let (records, photons) = (3000, 6000);
    Way::Gather(Gathering { radius_mm: 0.4, angle_deg: 5.0, records, photons, depth })
}

#[test]
fn shallow_and_deep_records_agree() {
    for (what, text) in [("rod", ROD), ("mirror tube", TUBE)] {
        let [shallow, deep] = [2, 8].map(|depth| measures(text, gather(depth)));
        let [shallow, deep] = [&shallow, &deep].map(|found| found.values["exit.flux"].clone());
        let apart = (shallow.value - deep.value).abs();
        let noise = shallow.std_error.hypot(deep.std_error);
        let bias = bias_allowance(&shallow, deep.value).max(bias_allowance(&deep, deep.value));
        println!(
            "{what}: {shallow} at D = 2, {deep} at D = 8, {:.2} sigmas apart, bias allowance {:.2} %",
            apart / noise,
            100.0 * bias / deep.value
        );
        assert!(apart <= SIGMAS * noise + bias, "{what}: {shallow} and {deep}");
        assert!(noise < 0.02 * deep.value, "{what}: noise that lets anything pass, {noise}");
    }
}

#[test]
fn guides_without_loss_lose_and_make_no_light() {
    let mut comparison = Comparison::default();
    for (what, text) in [("rod", ROD), ("mirror tube", TUBE)] {
        for way in [Way::Forward, Way::Backward, Way::Mixed, gather(0), gather(2), gather(8)] {
            let found = measures(text, way);
            let what = format!("{what}, {}", way.name());
            comparison.add(&format!("{what}, all"), &found.values["all.flux"], 10.0, 1e-9);
            let exit = &found.values["exit.efficiency"];
            if exit.value > 1.0 + SIGMAS * exit.std_error + bias_allowance(exit, 1.0) {
                comparison.fail(format!("{what}: {exit} of the light"));
            }
        }
    }
    comparison.assert("lossless", 10);
}

/// E1 of a gather run.
fn second_order(text: &str, gathering: Gathering, name: &str) -> Measure {
    let way = Way::Gather(gathering);
    let job = load(text, way);
    let found = findings(&job, way);
    let stages = &found.of_sensor(SensorId::new(0)).unwrap().stages;
    let second = Orders::of(&stages.last().unwrap().counts).second;
    let second = Findings::forward(second.clone());
    measure::value_of(&job.scene, &second, name).unwrap()
}

/// Compares E1 in three windows, each smaller by √2, with its expected value, and its bias with
/// half of the previous one.
fn follows(
    what: &str,
    text: &str,
    name: &str,
    window: Gathering,
    truth: f64,
    law: impl Fn(Gathering) -> f64,
) {
    let mut comparison = Comparison::default();
    let mut biases = Vec::new();
    for step in 0..3 {
        let size = FRAC_1_SQRT_2.powi(step);
        let window = Gathering {
            radius_mm: size * window.radius_mm,
            angle_deg: size * window.angle_deg,
            ..window
        };
        let found = second_order(text, window, name);
        let expected = law(window);
        comparison.add(&format!("{what}, window {step}"), &found, expected, 1e-6 * expected);
        biases.push((found.value - truth, found.std_error));
        println!("{what}, window {step}: bias {:+.2} %", 100.0 * (found.value / truth - 1.0));
    }
    for pair in biases.windows(2) {
        let [(wide, noise), (narrow, narrow_noise)] = [pair[0], pair[1]];
        let room = 4.0 * (0.5 * noise).hypot(narrow_noise) + 0.1 * narrow.abs();
        if (0.5 * wide - narrow).abs() > room || narrow.abs() < 4.0 * narrow_noise {
            comparison
                .fail(format!("{what}: biases {wide:.3} and {narrow:.3} ± {narrow_noise:.3}"));
        }
    }
    comparison.assert(what, 3);
}

/// Under a small Lambertian disk of radius a and exitance M at height h, at distance s from its axis, illuminance is
/// M/2 (1 - (s² + h² - a²)/√((s² + h² + a²)² - 4 s² a²)) (Foote, Bull. Bureau of Standards 12 (1915) 583).
#[test]
fn bias_of_the_position_estimate_is_the_mean_over_its_window() {
    let (lamp, height) = (2.0, 3.0);
    let text = r#"
[finishes.white]
lambertian = { reflectance = 1 }
[sheets.screen.disk]
radius_mm = 20
finish = "white"
[sources.lamp.disk]
radius_mm = 2
luminance_cd_m2 = 1000
at = { position_mm = [0, 0, 3], axis = [0, 0, -1] }
[sensors]
eye = { luminance = { disk = { radius_mm = 0.01 }, cells = [1, 1], acceptance_half_angle_deg = 0.5, directions = [{ theta_deg = 0, phi_deg = 0 }] }, at = { position_mm = [0, 0, 5], axis = [0, 0, -1] } }
"#;
    // L = ρ E/π, and M = π L of the lamp.
    let luminance = |s2: f64| {
        let sum: f64 = s2 + height * height + lamp * lamp;
        500.0 * (1.0 - (sum - 2.0 * lamp * lamp) / (sum * sum - 4.0 * s2 * lamp * lamp).sqrt())
    };
    // By area: s² is uniform within the window; the sensor sees less than 0.06 mm of the screen.
    let law = |window: Gathering| {
        let steps = 1000;
        let place =
            |step: i32| (f64::from(step) + 0.5) / f64::from(steps) * window.radius_mm.powi(2);
        (0..steps).map(|step| luminance(place(step))).sum::<f64>() / f64::from(steps)
    };
    let window =
        Gathering { depth: 0, radius_mm: 1.4, angle_deg: 5.0, records: 4, photons: 10_000 };
    follows("position", text, "eye.luminance_avg.0", window, luminance(0.0), law);
}

/// A wide lamp of intensity cos^p about its normal has the luminance L₀ cos^(p-1), and its exitance is 2π L₀/(p + 1).
/// The mean over a cone about the normal is L₀ (1 - cos^p θ)/(p (1 - cos θ)).
#[test]
fn bias_of_the_angle_estimate_is_the_mean_over_its_cone() {
    let power = 80.0;
    let text = r#"
[finishes.mirror]
specular = { reflectance = 1 }
[sheets.screen.rectangle]
width_mm = 6
height_mm = 6
finish = "mirror"
at = { axis = [1, 0, -1] }
[sources.lamp.disk]
radius_mm = 6
flux_lm = 1
emission = { cosine_power = 80 }
at = { position_mm = [10, 0, 0], axis = [-1, 0, 0] }
[sensors]
eye = { luminance = { disk = { radius_mm = 1 }, cells = [1, 1], acceptance_half_angle_deg = 0.1, directions = [{ theta_deg = 0, phi_deg = 0 }] }, at = { position_mm = [0, 0, -5], axis = [0, 0, 1] } }
"#;
    let normal = 1e6 / (PI * 36.0) * (power + 1.0) / (2.0 * PI);
    let law = |window: Gathering| {
        let cos = window.angle_deg.to_radians().cos();
        normal * (1.0 - cos.powf(power)) / (power * (1.0 - cos))
    };
    let window =
        Gathering { depth: 0, radius_mm: 1.5, angle_deg: 5.0, records: 100, photons: 100_000 };
    follows("angle", text, "eye.luminance_avg.0", window, normal, law);
}

/// Reference case ES-01: at the exit of a black tube of radius a and length 10 a, under a
/// Lambertian disk that fills its entry, L is that of the disk within atan(1/10); a wider cone
/// dilutes it by the ratio of solid angles. The lamp omits light steeper than 8 deg, which cannot
/// reach the exit.
#[test]
fn a_cone_wider_than_the_light_dilutes_it_by_the_ratio_of_solid_angles() {
    let text = &under_a_tube(
        r#"eye = { luminance = { disk = { radius_mm = 0.2 }, cells = [1, 1], acceptance_half_angle_deg = 0.05, directions = [{ theta_deg = 0, phi_deg = 0 }] }, at = { position_mm = [0, 0, 51], axis = [0, 0, -1] } }
"#,
    );
    let mut comparison = Comparison::default();
    for (angle_deg, ratio) in
        [(5.0, 1.0), (8.0, 0.509951176), (10.0, 0.3266672661), (20.0, 0.08229191609)]
    {
        let window =
            Gathering { depth: 0, radius_mm: 0.4, angle_deg, records: 20, photons: 50_000 };
        let found = second_order(text, window, "eye.luminance_avg.0");
        comparison.add(&format!("ES-01 at {angle_deg} deg"), &found, 1000.0 * ratio, 0.0);
        if found.std_error > 0.015 * found.value {
            comparison.fail(format!("{found} is too noisy to tell"));
        }
    }
    comparison.assert("ES-01", 4);
}

/// The lamp at the far end of a black tube is seen within 6 deg.
#[test]
fn photons_of_the_run_contradict_windows_that_are_wider_than_the_light() {
    let text = &under_a_tube(
        r#"eye = { luminance = { disk = { radius_mm = 0.5 }, cells = [1, 1], acceptance_half_angle_deg = 1.5, directions = [{ theta_deg = 0, phi_deg = 0 }] }, at = { position_mm = [0, 0, 51], axis = [0, 0, -1] } }
"#,
    );
    let off = |angle_deg| {
        let window =
            Gathering { depth: 0, radius_mm: 0.4, angle_deg, records: 500, photons: 50_000 };
        measures(text, Way::Gather(window)).accounts[0].off_photons.unwrap()
    };
    let (narrow, wide) = (off(3.0), off(40.0));
    assert!(narrow.abs() < 4.0 && wide < -4.0, "{narrow} and {wide} errors");
}

/// The automatic angle is three quarters of the half-width of the light at the records: of the emission where a
/// source fills the guide, of the source as seen from there where it does not.
#[test]
fn automatic_windows_fit_the_light() {
    let lamp = |radius_mm: f64, emission: &str| {
        let text = format!(
            "[finishes.mirror]\nspecular = {{ reflectance = 0.99 }}\n[sheets.tube.tube]\n\
             profile = {{ circle = {{ radius_mm = 5 }} }}\npath = [{{ straight_mm = 200 }}]\nfinish = \"mirror\"\n\
             [sources.lamp.disk]\nradius_mm = {radius_mm}\nflux_lm = 1\nemission = {emission}\n[sensors]\n\
             spot = {{ plane = {{ disk = {{ radius_mm = 1 }} }}, \
             at = {{ position_mm = [0, 0, 250], axis = [0, 0, -1] }}, aim = [\"tube.exit\"] }}\n"
        );
        let job = load(&text, Way::Gather(Gathering::to_depth(2)));
        let plan = RunPlan { gather: GatherPlan::default(), ..job.run.clone() };
        let mut run = Run::new(&job.scene, &plan);
        run.next_piece();
        run.findings().gathering().next().unwrap().1.window
    };
    let sun = lamp(5.0, "{ cone_half_angle_deg = 0.5 }");
    assert!((sun.theta_max.to_degrees() - 0.375).abs() < 1e-9, "{sun:?}");
    assert!((sun.radius - 1.5).abs() < 1e-6, "0.3 of the inradius: {sun:?}");
    let wide = lamp(5.0, "\"lambertian\"");
    assert!((wide.theta_max.to_degrees() - 4.5).abs() < 1e-9, "at most: {wide:?}");
    let led = lamp(0.5, "\"lambertian\"");
    assert!((led.radius - 0.375).abs() < 1e-6, "three quarters of the source's radius: {led:?}");
    // Seen from 100 to 200 mm.
    let seen = (led.theta_max / 0.75).tan();
    assert!((0.5 / 200.0..0.5 / 100.0).contains(&seen), "{led:?}");
}

/// Tubes of 20 and 1 mm side by side, each with a lamp and a sensor of its own.
#[test]
fn every_sensor_has_the_window_of_its_guide() {
    let tube = |name: &str, radius_mm: f64, x_mm: f64| {
        let (length, from, size) = (10.0 * radius_mm, 14.0 * radius_mm, 0.5 * radius_mm);
        format!(
            "[sheets.{name}.tube]\nprofile = {{ circle = {{ radius_mm = {radius_mm} }} }}\npath = [{{ straight_mm = {length} }}]\n\
             finish = \"mirror\"\nat = {{ position_mm = [{x_mm}, 0, 0] }}\n\
             [sources.lamp_{name}.disk]\nradius_mm = {radius_mm}\nflux_lm = 1\nemission = {{ cone_half_angle_deg = 3 }}\n\
             at = {{ face = \"{name}.entry\" }}\n\
             [sensors.at_{name}]\nplane = {{ disk = {{ radius_mm = {size} }} }}\naim = [\"{name}.exit\"]\n\
             at = {{ position_mm = [{x_mm}, 0, {from}], axis = [0, 0, -1] }}\n"
        )
    };
    let [wide, narrow] = [tube("wide", 20.0, 0.0), tube("narrow", 1.0, 100.0)];
    let text = format!("[finishes.mirror]\nspecular = {{ reflectance = 0.97 }}\n{wide}{narrow}");
    let job = load(&text, Way::Gather(Gathering::to_depth(2)));
    let gather = GatherPlan { records: Some(400), photons: Some(400), ..GatherPlan::default() };
    let mut run = Run::new(&job.scene, &RunPlan { gather, ..job.run.clone() });
    run.next_piece();
    let findings = run.findings();
    let groups: Vec<_> = findings.gathering().collect();
    let [(first, wide), (second, narrow)] = groups[..] else { panic!("{groups:?}") };
    assert_eq!((first, second), (&[SensorId::new(0)][..], &[SensorId::new(1)][..]));
    assert!((wide.window.radius - 6.0).abs() < 1e-6, "{wide:?}");
    assert!((narrow.window.radius - 0.3).abs() < 1e-6, "{narrow:?}");
    assert_eq!((wide.gather_paths, narrow.gather_paths), (200, 200));
    // Of a run of limited time, a checkpoint keeps the size of a pass over all groups.
    let mut timed = RunPlan { gather: GatherPlan::default(), ..job.run.clone() };
    timed.stop.time = Some(Duration::from_secs(60));
    let again = run.state().plan(&timed).gather;
    assert_eq!((again.photons, again.records), (Some(400), Some(400)));
}

/// Light that enters a rod from air fills a cone of asin(1/n) inside. Seen under 84 deg through the other end, the axis of a
/// window is asin(1/n) - asin(sin 84 deg/n) = 0.28 deg inside this cone; without this limit the window would be 4.5 deg wide.
#[test]
fn windows_fit_the_edge_of_the_aperture() {
    let rod = |theta_deg: f64| {
        let text = format!(
            "[media.glass]\nindex = 1.5\n[solids.rod.cylinder]\nradius_mm = 3\nlength_mm = 30\nmedium = \"glass\"\n\
             [sources.led.disk]\nradius_mm = 2.5\nat = {{ face = \"rod.entry\" }}\ncontact = \"air\"\nflux_lm = 1\n\
             [sensors.eye]\non = \"rod.exit\"\ncounts = \"leaving\"\nluminance = {{ cells = [1, 1], \
             directions = [{{ theta_deg = {theta_deg}, phi_deg = 0 }}], acceptance_half_angle_deg = 0.1 }}\n"
        );
        let job = load(&text, Way::Gather(Gathering::to_depth(2)));
        let gather = GatherPlan { records: Some(100), photons: Some(100), ..GatherPlan::default() };
        let mut run = Run::new(&job.scene, &RunPlan { gather, ..job.run.clone() });
        run.next_piece();
        run.findings().gathering().next().unwrap().1.window.theta_max
    };
    let margin =
        |theta_deg: f64| (1.0_f64 / 1.5).asin() - (theta_deg.to_radians().sin() / 1.5).asin();
    let found = rod(84.0);
    assert!((margin(84.1)..margin(83.9)).contains(&found), "{found}, not {}", margin(84.0));
    assert_eq!(rod(10.0), 4.5_f64.to_radians(), "the upper limit");
}
