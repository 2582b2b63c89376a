//! Lengths of one shape that must be ordered.

use crate::check::scene::Scene;
use crate::keys::Key;
use crate::problems::Problems;
use crate::spec::sheet::SheetSpec;
use crate::spec::solid::{LensSpec, SolidSpec};
use crate::spec::source::SourceSpec;
use crate::spec::sweep::{LegSpec, ParaboloidSpec, SweepSpec};

pub(crate) fn check(scene: Scene<'_>, problems: &mut Problems) {
    for (name, solid) in &scene.spec.solids {
        let key = Key::of(&["solids", name, solid.kind()]);
        match solid {
            SolidSpec::Paraboloid(solid) => check_paraboloid(&key, &solid.shape, problems),
            SolidSpec::Lens(solid) => {
                check_lens(&key, &solid.shape, problems);
            }
            SolidSpec::Sweep(solid) => check_corners(&key, &solid.shape, problems),
            SolidSpec::Cylinder(_)
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
        | SheetSpec::CompoundParabolic(_) => {}
        SheetSpec::Tube(sheet) => check_corners(key, &sheet.shape, problems),
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

/// Checks the old keys of a lens, which cannot be mixed with the new ones.
fn check_lens(key: &Key, lens: &LensSpec, problems: &mut Problems) {
    let ends = [
        ("entry", lens.entry.is_some(), "entry_radius_mm", lens.entry_radius_mm, 1.0),
        ("exit", lens.exit.is_some(), "exit_radius_mm", lens.exit_radius_mm, -1.0),
    ];
    for (name, is_given, old_name, old, convex_sign) in ends {
        let Some(radius) = old else { continue };
        let old_key = key.field(old_name);
        if radius == 0.0 {
            problems
                .error(&old_key, "is 0, expected a positive or negative radius")
                .hint("omit it for a flat end");
        } else if is_given {
            problems.error(&old_key, format!("says again what `{name}` says")).hint("remove it");
        } else {
            let word = if radius * convex_sign > 0.0 { "convex" } else { "concave" };
            let size = radius.abs();
            problems
                .warning(&old_key, "is an old key, whose sign says which way the face bulges")
                .hint(format!("write {name} = {{ {word}_radius_mm = {size} }}, which is the same"));
        }
    }
}

/// The old name of a fold mirror.
fn check_corners(key: &Key, sweep: &SweepSpec, problems: &mut Problems) {
    for (index, leg) in sweep.path.iter().enumerate() {
        let LegSpec::Corner(corner) = leg else { continue };
        let Some(mitred) = corner.mitred else { continue };
        let old_key = key.field("path").index(index).field("mitred");
        if corner.fold_mirror.is_some() {
            problems.error(&old_key, "says again what `fold_mirror` says").hint("remove it");
        } else {
            problems
                .warning(&old_key, "is the old name of `fold_mirror`")
                .hint(format!("write fold_mirror = {mitred}, which is the same"));
        }
    }
}

/// Notes an error unless `small < large`; both are keys of the table at `table`.
fn require_order(table: &Key, small: (&str, f64), large: (&str, f64), problems: &mut Problems) {
    let ((small_key, small), (large_key, large)) = (small, large);
    if small >= large {
        problems.error(
            &table.field(small_key),
            format!("{small} is not below `{large_key}`, which is {large}"),
        );
    }
}
