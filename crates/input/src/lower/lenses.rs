//! Lenses: two spherical or flat faces and the edge between them.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::surfaces::{BodySurfaces, Ends, NamedFace, disk_facing};
use crate::spec::solid::{LensFaceSpec, LensSpec};
use lumiduct_base::math::Frame;
use lumiduct_base::number::{format_least_length, format_length};
use lumiduct_core::scene::shape::{Cylinder, Shape, Sphere};

/// A spherical face as given in the file.
struct Curved {
    key: Key,
    /// Radius of curvature, mm: positive where the centre is further along the axis.
    radius: f64,
}

impl Context<'_> {
    /// The faces of a lens.
    pub(super) fn lens_surfaces(
        &mut self,
        lens: &LensSpec,
        frame: Frame,
        key: &Key,
    ) -> Option<BodySurfaces> {
        let rim = 0.5 * lens.diameter_mm;
        let entry = self.curved(lens, rim, Ends::Entry, key);
        let exit = self.curved(lens, rim, Ends::Exit, key);
        let (entry, exit) = (entry?, exit?);
        for Curved { key, radius } in [&entry, &exit].into_iter().flatten() {
            if radius.abs() < rim {
                let [size, wanted] = [radius.abs(), rim].map(format_length);
                let message =
                    format!("a sphere of radius {size} mm does not reach the rim at {wanted} mm");
                let hint = format!("make it at least {}", format_least_length(rim));
                return self.refuse(key, message, hint);
            }
        }
        let thickness = lens.thickness_mm;
        let radius = |face: Option<Curved>| face.map(|face| face.radius);
        let (entry, entry_edge) = lens_end(frame, 0.0, radius(entry), rim, Ends::Entry);
        let (exit, exit_edge) = lens_end(frame, thickness, radius(exit), rim, Ends::Exit);
        let edge = exit_edge - entry_edge;
        // The rim of a hemisphere meets its flat side: any remaining edge is rounding.
        let no_edge = 1e-12 * lens.diameter_mm;
        if edge < -no_edge {
            let least = format_least_length(thickness - edge);
            let beyond = format_length(-edge);
            let message = format!("the two ends cross before the rim, by {beyond} mm");
            let hint =
                format!("make it at least {least}, or the diameter smaller or the ends flatter");
            return self.refuse(&key.field("thickness_mm"), message, hint);
        }
        let mut faces = vec![NamedFace::end("entry", entry), NamedFace::end("exit", exit)];
        if edge > no_edge {
            let wall = Cylinder::new(frame.shifted(entry_edge * frame.z), rim, edge);
            faces.push(NamedFace::wall("wall", Shape::Cylinder(wall)));
        }
        Some(BodySurfaces { faces, volume: None })
    }

    /// One end of a lens: `Some(None)` where it is flat, `None` after an error.
    fn curved(
        &mut self,
        lens: &LensSpec,
        rim: f64,
        end: Ends,
        key: &Key,
    ) -> Option<Option<Curved>> {
        let (name, face, old_name, old, convex_sign) = match end {
            Ends::Entry => ("entry", lens.entry, "entry_radius_mm", lens.entry_radius_mm, 1.0),
            Ends::Exit => ("exit", lens.exit, "exit_radius_mm", lens.exit_radius_mm, -1.0),
        };
        let old_key = key.field(old_name);
        match (face, old) {
            (_, None) => {}
            (_, Some(0.0)) => {
                let message = "is 0, expected a positive or negative radius";
                return self.refuse(&old_key, message, "omit it for a flat end");
            }
            (Some(_), Some(_)) => {
                return self.refuse(&old_key, format!("repeats what `{name}` says"), "remove it");
            }
            (None, Some(radius)) => {
                let word = if radius * convex_sign > 0.0 { "convex" } else { "concave" };
                let size = radius.abs();
                self.problems
                    .warning(&old_key, "is an old key whose sign gives the direction of the bulge")
                    .hint(format!(
                        "write {name} = {{ {word}_radius_mm = {size} }}, which is equivalent"
                    ));
            }
        }
        self.may_build(key)?;
        let Some(face) = face else {
            return Some(old.map(|radius| Curved { key: old_key, radius }));
        };
        let key = key.field(name).field(face.name());
        let (size, is_convex) = match face {
            LensFaceSpec::ConvexRadiusMm(radius) => (radius, true),
            LensFaceSpec::ConcaveRadiusMm(radius) => (radius, false),
            LensFaceSpec::DomeHeightMm(sag) => (radius_of_cap(sag, rim), true),
            LensFaceSpec::DishDepthMm(sag) => (radius_of_cap(sag, rim), false),
        };
        if let LensFaceSpec::DomeHeightMm(sag) | LensFaceSpec::DishDepthMm(sag) = face
            && sag > rim
        {
            let [sag, most] = [sag, rim].map(format_length);
            let message = format!("{sag} mm on a rim of {most} mm is more than half a sphere");
            return self.refuse(&key, message, format!("make it at most {most}"));
        }
        let radius = if (end == Ends::Entry) == is_convex { size } else { -size };
        Some(Some(Curved { key, radius }))
    }
}

/// Radius, mm, of the sphere whose cap is `sag` mm high over a rim of radius `rim` mm: rim² = sag (2 R - sag).
fn radius_of_cap(sag: f64, rim: f64) -> f64 {
    // Rounding must not make an exact hemisphere miss its rim.
    (0.5 * (rim * rim / sag + sag)).max(rim)
}

/// One end of a lens with its vertex at `vertex` on the axis, and where it meets the rim.
fn lens_end(frame: Frame, vertex: f64, radius: Option<f64>, rim: f64, end: Ends) -> (Shape, f64) {
    let Some(radius) = radius else { return (disk_facing(frame, vertex, rim, end), vertex) };
    let size = radius.abs();
    let sag = rim * rim / (size + (size * size - rim * rim).sqrt());
    let center = frame.shifted((vertex + radius) * frame.z);
    // Seen from the centre, the vertex lies opposite to the axis for a positive radius.
    let (shape, edge) = if radius > 0.0 {
        (Sphere::zone(center, size, -size, sag - size), vertex + sag)
    } else {
        (Sphere::zone(center, size, size - sag, size), vertex - sag)
    };
    // Convex ends face away from their centre, as a sphere does.
    let convex = (end == Ends::Entry) == (radius > 0.0);
    (Shape::Sphere(if convex { shape } else { shape.inward() }), edge)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cap_of_a_height_reaches_its_rim() {
        for (sag, rim) in [(0.4, 2.0), (2.0, 2.0), (1e-9, 3.0), (2.9, 3.0)] {
            let radius = radius_of_cap(sag, rim);
            let height = rim * rim / (radius + (radius * radius - rim * rim).sqrt());
            assert!(radius >= rim && (height / sag - 1.0).abs() < 1e-7, "{sag} {rim}: {height}");
        }
    }
}
