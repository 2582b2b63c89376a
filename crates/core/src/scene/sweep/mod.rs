//! A cross-section carried along straight legs, bends and corners: the exact surfaces of rods, tubes and ducts.
//!
//! Every piece is a quadric, a torus or a plane, never an approximation: a circle sweeps cylinders,
//! cones and tori; an edge of a polygon sweeps planes, and about a bend axis in its own plane a
//! cylinder, a cone or a plane again. A sweep knows only geometry. Its caller decides whether it is
//! a solid (parts and ports are its faces) or a hollow duct (the parts alone), and sets the
//! finishes of its faces.

mod chart;
mod check;
mod faceted;
mod leg;
mod path;
mod prisms;
mod profile;
mod round;
mod smooth;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod volume;
mod wall;

pub use leg::{CornerKind, Leg, SweepError, SweepProblem};
pub use prisms::{OutlineError, PrismNumber, Prisms};
pub use profile::{Profile, ProfileError};
pub use wall::{Wall, WallPart};

use crate::scene::shape::{Flat, Region, Shape};
pub use chart::{Sector, Trapezoid, WallChart};
use lumiduct_base::math::Frame;

/// The surfaces of a swept profile.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// The walls, from the entry to the exit; every front is outside.
    pub parts: Vec<WallPart>,
    /// The cross-sections at the entry and at the exit.
    pub ports: [Port; 2],
    /// Length of the path, mm; through a corner it is measured along both centre lines to the point
    /// where they meet.
    pub length: f64,
    /// Length of the profile's outline at the entry, mm.
    pub perimeter: f64,
    /// Enclosed volume, mm³.
    pub volume: f64,
}

/// An end of a sweep.
#[derive(Debug, Clone)]
pub struct Port {
    /// The origin is on the path, z points out of the sweep.
    pub frame: Frame,
    /// The cross-section; its front is outside.
    pub shape: Shape,
}

/// Carries `profile` along `legs`, starting in `frame` toward its z with the profile's x and y along the frame's.
///
/// The frame rotates only about the bend axes, so that `toward` of each leg refers to the section
/// as it arrives there.
///
/// # Errors
///
/// `SweepError` with the leg at fault: a length, a scale or an angle is out of range, a bend is too tight for the
/// profile, a straight part is too short for its corners, the path closes on itself or runs through itself. Without
/// a leg if there are none.
pub fn sweep(frame: Frame, profile: &Profile, legs: &[Leg]) -> Result<Sweep, SweepError> {
    let path = path::trace(frame, profile, legs)?;
    check::check(profile, &path)?;
    let parts = match profile {
        Profile::Circle { radius } => round::parts(*radius, &path),
        Profile::Polygon { points } => faceted::parts(points, &path),
    };
    let [_, mirrored] = profile.regions(1.0);
    let [at_exit, _] = profile.regions(path.exit.scale);
    // The entry looks back along the path: turned by half a turn about x.
    let entry = Frame { y: -frame.y, z: -frame.z, ..frame };
    Ok(Sweep {
        parts,
        ports: [port(entry, mirrored), port(path.exit.frame, at_exit)],
        length: path.exit.along,
        perimeter: profile.perimeter(),
        volume: volume::volume(profile, &path),
    })
}

fn port(frame: Frame, region: Region) -> Port {
    Port { frame, shape: Shape::Flat(Flat::new(frame, region)) }
}
