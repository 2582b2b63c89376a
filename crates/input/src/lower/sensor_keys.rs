//! The keys of a sensor: whether they go with each other and with its kind, and how they divide it.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::spec::sensor::{PassageSpec, PlaneSpec, SensorKindSpec, SensorSpec};
use crate::spec::sweep::AreaSpec;
use lumiduct_core::scene::shape::Region;

/// Most cells of a sensor.
const MAX_CELLS: f64 = 1e8;

/// How a sensor is divided.
#[derive(Clone, Copy)]
pub(super) enum Division {
    Cells([u32; 2]),
    Rings(u32, u32),
}

impl Context<'_> {
    /// Notes keys that do not go with each other or with the kind of the sensor.
    pub(super) fn check_keys(&mut self, spec: &SensorSpec, kind: SensorKindSpec<'_>, key: &Key) {
        let (on, absorbing) = (spec.on.is_some(), spec.absorbing);
        let mut note = |is_wrong: bool, name: &str, message: &str, hint: &str| {
            if is_wrong {
                self.problems.error(&key.field(name), message).hint(hint);
            }
        };
        let message = "a sensor is `at` a position or `on` a face, not both";
        note(on && spec.at.is_some(), "at", message, "remove `at` or `on`");
        let hint = "add counts = \"leaving\" or counts = \"incident\"";
        note(on && spec.counts.is_none(), "on", "a sensor `on` a face needs `counts`", hint);
        let message = "a sensor `on` a face is lit through that face, and takes no `aim`";
        note(on && spec.aim.is_some(), "aim", message, "remove `aim`");
        let message = "is only for a sensor `on` a face";
        note(!on && spec.counts.is_some(), "counts", message, "add `on` or remove `counts`");
        let is_first = spec.passage == PassageSpec::First;
        // A goniometer is a sphere, and an image looks along its axis: they have no face and no
        // side, and absorb no light.
        let free = match kind {
            SensorKindSpec::Plane(_) => {
                // First passages are defined for a surface that light can meet from anywhere.
                let message = "a sensor with an `aim` counts every passage";
                let hint = "remove `passage` or `aim`";
                note(is_first && spec.aim.is_some(), "passage", message, hint);
                let message = "a sensor `on` a face does not absorb; the finish of the face does";
                let hint = "give the face the finish \"black\"";
                note(absorbing && on, "absorbing", message, hint);
                return;
            }
            SensorKindSpec::Luminance(_) => None,
            SensorKindSpec::Goniometer(_) => Some("a `goniometer`"),
            SensorKindSpec::Image(_) => Some("an `image`"),
        };
        let message = format!("\"first\" is for a `plane` only, found with `{}`", kind.name());
        note(is_first, "passage", &message, "remove `passage`");
        let Some(what) = free else {
            if absorbing {
                let message = "is for a `plane` only, found with `luminance`";
                self.problems.error(&key.field("absorbing"), message);
            }
            return;
        };
        for (is_given, name) in
            [(on, "on"), (spec.side.is_some(), "side"), (absorbing, "absorbing")]
        {
            let message = format!("cannot be combined with {what}");
            note(is_given, name, &message, &format!("remove `{name}`"));
        }
    }

    /// The area that a sensor gives itself: a rectangle or a disk.
    pub(super) fn region(
        &mut self,
        spec: &SensorSpec,
        area: &AreaSpec,
        key: &Key,
    ) -> Option<Region> {
        let rectangle = area
            .rectangle
            .map(|r| Region::Rectangle { half_x: 0.5 * r.width_mm, half_y: 0.5 * r.height_mm });
        let disk = area.disk.map(|disk| Region::Annulus { inner: 0.0, outer: disk.radius_mm });
        if spec.on.is_some() {
            for (name, given) in [("rectangle", rectangle), ("disk", disk)] {
                if given.is_some() {
                    let message =
                        format!("a sensor `on` a face has the area of the face, not a {name}");
                    self.problems.error(&key.field(name), message).hint(format!("remove `{name}`"));
                }
            }
            return None;
        }
        match (rectangle, disk) {
            (Some(_), Some(_)) => {
                let message = "takes exactly one of `rectangle`, `disk`, found both";
                self.problems.error(&key.field("disk"), message);
                None
            }
            (None, None) => {
                let message = "needs exactly one of `rectangle`, `disk`, or `on` beside it";
                let hint = "such as rectangle = { width_mm = 10, height_mm = 10 }";
                self.refuse(key, message, hint)
            }
            (one, other) => one.or(other),
        }
    }

    /// Notes too many cells.
    pub(super) fn check_cells(&mut self, cells: f64, key: &Key) -> Option<()> {
        if cells > MAX_CELLS {
            let message =
                format!("the sensor has {cells:.3e} cells, expected at most {MAX_CELLS:.0e}");
            self.problems.error(key, message);
        }
        (cells <= MAX_CELLS).then_some(())
    }

    pub(super) fn division(&mut self, plane: &PlaneSpec, key: &Key) -> Option<Division> {
        match (plane.cells, plane.rings, plane.sectors) {
            // Without a division it is one cell.
            (None, None, None) => Some(Division::Cells([1, 1])),
            (Some([nx, ny]), None, None) => {
                self.check_cells(f64::from(nx) * f64::from(ny), &key.field("cells"))?;
                Some(Division::Cells([nx, ny]))
            }
            (None, Some(rings), sectors) => {
                let (sectors, key) = (sectors.unwrap_or(1), key.field("rings"));
                let good = self.check_cells(f64::from(rings) * f64::from(sectors), &key);
                if plane.area.rectangle.is_some() {
                    let hint = "give `cells`, or a `disk`";
                    return self.refuse(&key, "rings do not fit a rectangle", hint);
                }
                good.map(|()| Division::Rings(rings, sectors))
            }
            (None, None, Some(_)) => {
                let message = "needs `rings` beside it";
                self.refuse(&key.field("sectors"), message, "rings = 1 makes plain sectors")
            }
            (Some(_), Some(_), _) | (Some(_), None, Some(_)) => {
                let name = if plane.rings.is_some() { "rings" } else { "sectors" };
                let message = "takes `cells`, or `rings` and `sectors`, not both";
                self.problems.error(&key.field(name), message);
                None
            }
        }
    }

    /// The number of steps in a full range, if it is whole.
    pub(super) fn steps(&mut self, step: f64, full: f64, key: &Key) -> Option<f64> {
        let count = full / step;
        // Steps such as 0.1 are not exact in binary; 1e-9 of the range is far below any real step.
        if (count - count.round()).abs() <= 1e-9 * count {
            return Some(count);
        }
        let (fewer, more) = (full / count.floor(), full / count.ceil());
        self.refuse(key, format!("{step} does not divide {full}"), format!("{more} and {fewer} do"))
    }
}
