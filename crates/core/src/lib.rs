//! The physics of Lumiduct, independent of any file format: light goes in, numbers with error bars
//! come out.
//!
//! ```text
//! Scene -> Run -> Findings (Readings of each estimator) -> Estimate -> Measures with errors
//! ```
//!
//! Lengths are millimetres, angles radians, solid angles steradians, flux lumens (watts in radiometric runs), wavelengths
//! nanometres. +z of a local frame is the normal; directions are unit vectors. Layers from the bottom up: [`rng`],
//! [`tally`] and [`plan`]; [`optics`]; [`scene`]; [`transport`]; [`measure`].
//!
//! A Lambertian disk of radius 5 mm lights a black disk of the same size, 10 mm in front of it. The share of its flux
//! that arrives is the form factor of the two, 3 - √8:
//!
//! ```
//! use glam::DVec3;
//! use lumiduct_base::{math::Frame, units::FluxUnit};
//! use lumiduct_core::{measure, optics::*, plan::*, scene::shape::*, scene::*, transport::Run};
//!
//! let mm = |z| Frame::WORLD.shifted(DVec3::new(0.0, 0.0, z));
//! let disk = |z| Shape::Flat(Flat::new(mm(z), Region::Annulus { inner: 0.0, outer: 5.0 }));
//! let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
//! let black = Some(builder.add_finish("black", Finish::Absorber));
//! let pieces = vec![FacePiece::whole(disk(10.0))];
//! builder.add_face(FaceSpec { name: "screen".into(), owner: Owner::Sheet, front: black, back: black, pieces });
//! let emitter = Emitter::surface(vec![disk(0.0)], EmitSide::Front, None);
//! builder.add_source(Source {
//!     name: "led".into(), flux: 2.0 /* lm */, emitter, emission: Emission::Lambertian,
//!     start: StartSolids::Outside, on: Vec::new(), spectrum: None, elevation: None, sun: None,
//! });
//! let scene = builder.build();
//! let plan = RunPlan {
//!     estimator: Request::Forward, sensor_estimators: Vec::new(), gather: GatherPlan::default(), seed: 1,
//!     bounce_limit: 100, batch_paths: None, stop: StopRules { paths: Some(100_000), ..StopRules::default() },
//! };
//! let mut run = Run::new(&scene, &plan);
//! while !run.is_complete() { run.next_wave(); }
//! let absorbed = &measure::measure(&scene, &run.findings()).values["balance.absorbed.screen"];
//! let expected = 2.0 * (3.0 - 8_f64.sqrt()); // lm
//! assert!((absorbed.value - expected).abs() < 4.0 * absorbed.std_error && absorbed.std_error < 0.01);
//! ```

pub mod colour;
pub mod measure;
pub mod optics;
pub mod plan;
pub mod rng;
pub mod scene;
pub mod tally;
pub mod transport;
