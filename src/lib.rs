//! Photometric sensor data for light tubes and light guides.
//!
//! Light reaches the exit of a guide after tens or hundreds of specular bounces. Lumiduct follows
//! it on exact surfaces in f64 and counts it on virtual sensors: flux, efficiency, illuminance
//! maps, uniformity, intensity and luminance, each with an error bar, together with a flux balance
//! that closes.
//!
//! The flow, top to bottom in [`crate::pipeline`]:
//!
//! ```text
//! scene file -> Scene -> paths -> readings -> measures with uncertainty -> report
//! ```
//!
//! A scene in a file, and one of its measures:
//!
//! ```
//! use lumiduct::{Interrupt, Settings, load, measure, trace};
//! use std::path::Path;
//!
//! let settings = Settings { paths: Some(20_000), ..Settings::default() };
//! let job = load(Path::new("scenes/led_indicator.toml"), &settings)?;
//! let traced = trace(&job, &Interrupt::default(), &mut |_| {})?;
//! let measures = measure(&job.scene, &traced.findings);
//! let efficiency = &measures.values["exit.efficiency"];
//! assert!(0.0 < efficiency.value && efficiency.value < 1.0 && efficiency.std_error < 0.01);
//! # Ok::<(), lumiduct::Error>(())
//! ```
//!
//! The same as a report in a folder, read back; a changed key of the scene is a `key=value`:
//!
//! ```
//! use lumiduct::pipeline::Output;
//! use lumiduct::{Interrupt, Settings, read_report, run_one};
//! use lumiduct_report::{Existing, diff::Content};
//!
//! let settings = Settings {
//!     overrides: vec!["finishes.mirror.specular.reflectance=1".into()],
//!     paths: Some(20_000),
//!     ..Settings::default()
//! };
//! let folder = tempfile::tempdir()?;
//! let output = Output::new(Some(folder.path().to_path_buf()), Existing::Keep);
//! let scene = "scenes/mirror_tube.toml".as_ref();
//! run_one(scene, &settings, &output, &Interrupt::default(), &mut |_| {})?;
//!
//! let report = read_report(folder.path())?;
//! let Content::Run(run) = &report.content else { unreachable!("it is no study") };
//! let flux = &run.measures["exit.flux"];
//! assert_eq!((flux.value.round(), flux.unit.as_ref()), (1.0, "lm")); // a perfect mirror loses nothing
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! This crate is the program and a small facade; the parts are
//! `lumiduct-base`, `lumiduct-core`, `lumiduct-files`, `lumiduct-input` and `lumiduct-report`.
//!
//! Inside, lengths are millimetres, angles radians, solid angles steradians, flux lumens (watts in radiometric runs),
//! wavelengths nanometres. +z of a local frame is the normal; directions are unit vectors. Units of files and reports
//! are part of the names there.

pub mod cli;
pub mod optimise;
pub mod pipeline;
pub mod study;

pub use lumiduct_base::error::{Diagnostic, Error, Result};
pub use lumiduct_core::measure::{Measure, Measures, Status, measure};
pub use lumiduct_core::transport::Interrupt;
pub use lumiduct_input::{Job, Settings, load};
pub use lumiduct_report::diff::read as read_report;
pub use pipeline::{check, run_one, trace};
