//! Lengths of one shape that have an order.

use crate::input::check::{Scene, require_order};
use crate::input::keys::Key;
use crate::input::problems::Problems;
use crate::input::spec::sheet::SheetSpec;
use crate::input::spec::solid::SolidSpec;
use crate::input::spec::source::SourceSpec;
use crate::input::spec::sweep::ParaboloidSpec;

pub(crate) fn check(scene: Scene<'_>, problems: &mut Problems) {
    for (name, solid) in &scene.spec.solids {
        let key = Key::of(&["solids", name, solid.kind()]);
        match solid {
            SolidSpec::Paraboloid(solid) => check_paraboloid(&key, &solid.shape, problems),
            SolidSpec::Lens(solid) => {
                check_radius(&key, "entry_radius_mm", solid.shape.entry_radius_mm, problems);
                check_radius(&key, "exit_radius_mm", solid.shape.exit_radius_mm, problems);
            }
            SolidSpec::Sweep(_)
            | SolidSpec::Cylinder(_)
            | SolidSpec::Box(_)
            | SolidSpec::Tube(_)
            | SolidSpec::Sphere(_)
            | SolidSpec::CompoundParabolic(_)
            | SolidSpec::Mesh(_) => {}
        }
    }
    for (name, sheet) in &scene.spec.sheets {
        check_sheet(&Key::of(&["sheets", name, sheet.kind()]), sheet, problems);
    }
    for (name, source) in &scene.spec.sources {
        if let SourceSpec::Disk(disk) = source {
            let key = Key::of(&["sources", name, source.kind()]);
            let (inner, outer) = (disk.shape.inner_radius_mm, disk.shape.radius_mm);
            require_order(&key, ("inner_radius_mm", inner), ("radius_mm", outer), problems);
        }
    }
}

fn check_sheet(key: &Key, sheet: &SheetSpec, problems: &mut Problems) {
    match sheet {
        SheetSpec::Annulus(sheet) => {
            let (inner, outer) = (sheet.shape.inner_radius_mm, sheet.shape.outer_radius_mm);
            require_order(key, ("inner_radius_mm", inner), ("outer_radius_mm", outer), problems);
        }
        SheetSpec::ParabolicCylinder(sheet) => {
            let (min, max) = (sheet.shape.x_min_mm, sheet.shape.x_max_mm);
            require_order(key, ("x_min_mm", min), ("x_max_mm", max), problems);
        }
        SheetSpec::Paraboloid(sheet) => check_paraboloid(key, &sheet.shape, problems),
        SheetSpec::Disk(_)
        | SheetSpec::Rectangle(_)
        | SheetSpec::SphericalCap(_)
        | SheetSpec::Tube(_)
        | SheetSpec::CompoundParabolic(_) => {}
    }
}

fn check_paraboloid(key: &Key, shape: &ParaboloidSpec, problems: &mut Problems) {
    require_order(
        key,
        ("hole_radius_mm", shape.hole_radius_mm),
        ("radius_mm", shape.radius_mm),
        problems,
    );
}

fn check_radius(key: &Key, name: &str, radius: Option<f64>, problems: &mut Problems) {
    if radius == Some(0.0) {
        problems
            .error(&key.field(name), "is 0, expected a positive or negative radius")
            .hint("omit it for a flat end");
    }
}
