//! Fluxes of scenes on their first sensor by long unbiased runs.

/// The flux on the first sensor of a scene, lm.
pub(crate) struct Truth {
    pub(crate) scene: &'static str,
    pub(crate) flux: f64,
    pub(crate) std_error: f64,
}

/// Unless noted: `lumiduct run scenes/NAME.toml --estimator backward --paths 60M` with the seeds
/// named, means weighted by variance.
pub(crate) const TRUTHS: [Truth; 7] = [
    // Seeds 20261, 20262, 20263: 0.10938(28); --time 600s, seed 20401: 0.109825(171).
    Truth { scene: "remote_cell_sun", flux: 0.10971, std_error: 0.00015 },
    // Seeds 20261, 20262: 0.035457(154), 0.034725(172); 16M with seed 7: 0.03447(30); 4M with seeds 101 to 124: 0.03510(13).
    Truth { scene: "remote_cell_long", flux: 0.035070, std_error: 0.000082 },
    // Seeds 20261, 20262, 20263; 30M with seed 7, 80M with seed 20264; forward with 400M and seed 20270: 0.14020(25);
    // --time 600s, seed 20401: 0.14081(31).
    Truth { scene: "remote_cell_rod", flux: 0.14044, std_error: 0.00020 },
    // `cargo bench --bench connected`, seed 20261.
    Truth { scene: "remote_cell_scatter", flux: 0.011507, std_error: 0.000023 },
    // 24M, seed 20281.
    Truth { scene: "remote_cell_led", flux: 0.0031524, std_error: 0.0000071 },
    // --time 280s, seed 20291.
    Truth { scene: "remote_cell_bend", flux: 0.00596, std_error: 0.00017 },
    // The image contains the whole exit, so its flux is that of remote_cell_scatter.
    Truth { scene: "luminance_image_scatter", flux: 0.011507, std_error: 0.000023 },
];
