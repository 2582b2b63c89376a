//! The scenes: curved guides, grazing light, low indices, rough walls, rims, corners, media; small and large windows.

use lumiduct_core::plan::Request;

/// A scene, how its truth is known, and the paths of a run.
pub(crate) struct Row {
    pub(crate) name: &'static str,
    pub(crate) what: &'static str,
    pub(crate) source: Source,
    pub(crate) truth: Reference,
    pub(crate) paths: u64,
}

/// Where a scene is from.
pub(crate) enum Source {
    /// A file of this name in `scenes`.
    Shipped,
    /// Its text without the head.
    Text(fn() -> String),
}

/// How the flux on the first sensor is known.
pub(crate) enum Reference {
    /// By a long run: benches/truths.rs.
    Known,
    /// By this unbiased estimator.
    Traced(Request),
}

pub(crate) const ROWS: [Row; 20] = [
    Row {
        name: "remote_cell_sun",
        what: "mirror tube, sun",
        source: Source::Shipped,
        truth: Reference::Known,
        paths: 700_000,
    },
    Row {
        name: "remote_cell_rod",
        what: "solid rod, sun",
        source: Source::Shipped,
        truth: Reference::Known,
        paths: 700_000,
    },
    Row {
        name: "remote_cell_long",
        what: "long mirror tube",
        source: Source::Shipped,
        truth: Reference::Known,
        paths: 200_000,
    },
    Row {
        name: "remote_cell_scatter",
        what: "wall that scatters by 1 deg",
        source: Source::Shipped,
        truth: Reference::Known,
        paths: 700_000,
    },
    Row {
        name: "grazing",
        what: "luminance at 84 deg, rod",
        source: Source::Text(|| GRAZING.to_owned()),
        truth: Reference::Traced(Request::Backward),
        paths: 3_000_000,
    },
    Row {
        name: "low_index",
        what: "index 1.33, glued emitter",
        source: Source::Text(|| LOW_INDEX.to_owned()),
        truth: Reference::Traced(Request::Mix),
        paths: 2_000_000,
    },
    Row {
        name: "rough_exit",
        what: "rough exit, 0.3 deg source",
        source: Source::Text(|| ROUGH_EXIT.to_owned()),
        truth: Reference::Traced(Request::Mix),
        paths: 2_000_000,
    },
    Row {
        name: "rim",
        what: "small mirror, cut windows",
        source: Source::Text(|| RIM.to_owned()),
        truth: Reference::Traced(Request::Mix),
        paths: 3_000_000,
    },
    Row {
        name: "rod",
        what: "short rod, LED",
        source: Source::Text(|| guide(CYLINDER)),
        truth: Reference::Traced(Request::Mix),
        paths: 2_000_000,
    },
    Row {
        name: "square_rod",
        what: "rectangular rod",
        source: Source::Text(|| guide(SQUARE)),
        truth: Reference::Traced(Request::Mix),
        paths: 2_000_000,
    },
    Row {
        name: "taper",
        what: "rod that widens",
        source: Source::Text(|| guide(TAPER)),
        truth: Reference::Traced(Request::Mix),
        paths: 2_000_000,
    },
    Row {
        name: "bent_rod",
        what: "rod, bend of 90 deg",
        source: Source::Text(|| guide(BEND)),
        truth: Reference::Traced(Request::Mix),
        paths: 2_000_000,
    },
    Row {
        name: "mitred_corner",
        what: "rod, corner of 60 deg",
        source: Source::Text(|| guide(CORNER)),
        truth: Reference::Traced(Request::Mix),
        paths: 2_000_000,
    },
    Row {
        name: "dome",
        what: "rod with a dome and a bubble",
        source: Source::Text(|| guide(DOME).replace("pipe.exit\"]", "dome.surface\"]")),
        truth: Reference::Traced(Request::Mix),
        paths: 2_000_000,
    },
    Row {
        name: "mirror_bend",
        what: "mirror tube, bend of 90 deg",
        source: Source::Text(|| MIRROR_BEND.to_owned()),
        truth: Reference::Traced(Request::Mix),
        paths: 1_500_000,
    },
    Row {
        name: "duct",
        what: "square mirror duct, its corner",
        source: Source::Text(|| DUCT.to_owned()),
        truth: Reference::Traced(Request::Mix),
        paths: 1_500_000,
    },
    Row {
        name: "turbid_rod",
        what: "rod with particles",
        source: Source::Text(|| guide(CYLINDER).replace("_per_mm = 0.002", TURBID)),
        truth: Reference::Traced(Request::Mix),
        paths: 1_500_000,
    },
    Row {
        name: "white_corner",
        what: "white duct",
        source: Source::Text(|| DUCT.replace("specular", "lambertian")),
        truth: Reference::Traced(Request::Mix),
        paths: 1_500_000,
    },
    Row {
        name: "two_sizes",
        what: "tubes of 1 and 20 mm, rough",
        source: Source::Text(|| TWO_SIZES.to_owned()),
        truth: Reference::Traced(Request::Mix),
        paths: 1_500_000,
    },
    Row {
        name: "mesh",
        what: "light guide from a mesh",
        source: Source::Text(|| {
            guide("[solids.pipe.mesh]\nfile = 'MESH'\nunit = \"m\"\nmedium = \"acrylic\"").replace(
                "MESH",
                concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/meshes/lightguide.glb"),
            )
        }),
        truth: Reference::Traced(Request::Mix),
        paths: 150_000,
    },
];

/// A guide of some millimetres with an LED before its entry and a cell behind its exit.
fn guide(solid: &str) -> String {
    format!(
        r#"
[media.acrylic]
index = 1.49
absorption_per_mm = 0.002
{solid}
[sources.led.disk]
radius_mm = 1
flux_lm = 10
at = {{ face = "pipe.entry", gap_mm = 0.2 }}
[sensors]
cell = {{ plane = {{ rectangle = {{ width_mm = 1, height_mm = 1 }} }}, at = {{ face = "pipe.exit", gap_mm = 4, offset_mm = [1, 0] }}, aim = ["pipe.exit"] }}
"#
    )
}

const CYLINDER: &str = r#"
[solids.pipe.cylinder]
radius_mm = 1.5
length_mm = 20
medium = "acrylic"
"#;

const SQUARE: &str = r#"
[solids.pipe.sweep]
profile = { rectangle = { width_mm = 3, height_mm = 2.5 } }
path = [{ straight_mm = 20 }]
medium = "acrylic"
"#;

const TAPER: &str = r#"
[solids.pipe.cylinder]
radius_mm = 1.5
end_radius_mm = 2.2
length_mm = 20
medium = "acrylic"
"#;

const BEND: &str = r#"
[solids.pipe.sweep]
profile = { circle = { radius_mm = 1.5 } }
path = [{ straight_mm = 3 }, { bend_deg = 90, radius_mm = 6 }, { straight_mm = 3 }]
medium = "acrylic"
"#;

const CORNER: &str = r#"
[solids.pipe.sweep]
profile = { rectangle = { width_mm = 3, height_mm = 3 } }
path = [{ straight_mm = 3 }, { corner_deg = 60, fold_mirror = true }, { straight_mm = 3 }]
medium = "acrylic"
"#;

const DOME: &str = r#"
[media.glue]
index = 1.41
[solids.pipe.cylinder]
radius_mm = 1.5
length_mm = 8
medium = "acrylic"
priority = 1
[solids.dome.sphere]
radius_mm = 1.5
medium = "glue"
at = { position_mm = [0, 0, 8] }
[solids.bubble.sphere]
radius_mm = 0.5
medium = "air"
priority = 2
at = { position_mm = [0.4, 0, 4] }
"#;

const TURBID: &str = "_per_mm = 0.002\nscattering = { per_mm = 0.02, anisotropy = 0.9 }";

const GRAZING: &str = r#"
[media.glass]
index = 1.5
[solids.rod.cylinder]
radius_mm = 3
length_mm = 30
medium = "glass"
[sources.led.disk]
radius_mm = 2.5
at = { face = "rod.entry" }
contact = "air"
flux_lm = 100
[sensors.view]
on = "rod.exit"
counts = "leaving"
luminance = { cells = [1, 1], directions = [{ theta_deg = 84, phi_deg = 0 }], acceptance_half_angle_deg = 2.5 }
"#;

const LOW_INDEX: &str = r#"
[media.water]
index = 1.33
[solids.rod.cylinder]
radius_mm = 2
length_mm = 40
medium = "water"
[sources.led.disk]
radius_mm = 1
at = { face = "rod.entry" }
flux_lm = 10
[sensors]
cell = { plane = { rectangle = { width_mm = 1, height_mm = 1 } }, at = { face = "rod.exit", gap_mm = 5 }, aim = ["rod.exit"] }
"#;

const ROUGH_EXIT: &str = r#"
[media.glass]
index = 1.5
[finishes.rough]
gaussian = { sigma_deg = 5 }
[solids.rod.cylinder]
radius_mm = 3
length_mm = 30
medium = "glass"
faces = { exit = "rough" }
[sources.sun.disk]
radius_mm = 3
at = { face = "rod.entry" }
contact = "air"
flux_lm = 100
emission = { cone_half_angle_deg = 0.3 }
tilt_deg = 20
[sensors]
cell = { plane = { rectangle = { width_mm = 2, height_mm = 2 } }, at = { face = "rod.exit", gap_mm = 10 }, aim = ["rod.exit"] }
"#;

const RIM: &str = r#"
[sheets]
plate = { disk = { radius_mm = 2, finish = { specular = { reflectance = 0.9 } } } }
[sources.lamp.rectangle]
width_mm = 12
height_mm = 12
flux_lm = 10
at = { position_mm = [-6, 0, 6], axis = [1, 0, -1] }
[sensors]
cell = { plane = { rectangle = { width_mm = 3, height_mm = 3 } }, at = { position_mm = [6, 0, 6], axis = [-1, 0, -1] }, aim = ["plate.surface"] }
"#;

const MIRROR_BEND: &str = r#"
[finishes.mirror]
specular = { reflectance = 0.95 }
[sheets.tube.tube]
profile = { circle = { radius_mm = 5 } }
path = [{ straight_mm = 20 }, { bend_deg = 90, radius_mm = 15 }, { straight_mm = 20 }]
finish = "mirror"
[sources.lamp.disk]
radius_mm = 4
at = { face = "tube.entry" }
flux_lm = 100
emission = { cone_half_angle_deg = 10 }
[sensors]
cell = { plane = { rectangle = { width_mm = 2, height_mm = 2 } }, at = { face = "tube.exit", gap_mm = 10 }, aim = ["tube.exit"] }
"#;

const DUCT: &str = r#"
[finishes]
wall = { specular = { reflectance = 0.9 } }
[sheets.duct.tube]
profile = { rectangle = { width_mm = 4, height_mm = 4 } }
path = [{ straight_mm = 20 }]
finish = "wall"
[sources.lamp.rectangle]
width_mm = 4
height_mm = 4
flux_lm = 10
[sensors]
corner = { plane = { rectangle = { width_mm = 0.8, height_mm = 0.8 } }, at = { position_mm = [1.6, 1.6, 20], axis = [0, 0, -1] }, side = "front" }
"#;

const TWO_SIZES: &str = r#"
[finishes.mirror]
gaussian = { sigma_deg = 1, reflectance = 0.97 }
[sheets.wide.tube]
profile = { circle = { radius_mm = 20 } }
path = [{ straight_mm = 200 }]
finish = "mirror"
[sheets.narrow.tube]
profile = { circle = { radius_mm = 1 } }
path = [{ straight_mm = 20 }]
finish = "mirror"
at = { position_mm = [100, 0, 0] }
[sources.a.disk]
radius_mm = 20
at = { face = "wide.entry" }
flux_lm = 100
emission = { cone_half_angle_deg = 3 }
tilt_deg = 20
[sources.b.disk]
radius_mm = 1
at = { face = "narrow.entry" }
flux_lm = 100
emission = { cone_half_angle_deg = 3 }
tilt_deg = 20
[sensors.small]
plane = { rectangle = { width_mm = 2, height_mm = 2 } }
at = { position_mm = [102, 0, 28], axis = [-0.3, 0, -0.954] }
aim = ["narrow.exit"]
[sensors.big]
plane = { rectangle = { width_mm = 20, height_mm = 20 } }
at = { position_mm = [20, 0, 280], axis = [-0.3, 0, -0.954] }
aim = ["wide.exit"]
"#;
