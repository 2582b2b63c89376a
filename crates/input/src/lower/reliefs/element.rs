//! The elements of a relief, and whether they are possible.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::reliefs::wall::UnrolledReliefWall;
use crate::spec::pattern::AlongSpec;
use crate::spec::relief::{
    CapSpec, CourseSpec, DepthSpec, HeightSpec, PyramidSpec, ReliefElementSpec, WedgeSpec,
};
use lumiduct_core::scene::pattern::{ElementField, TableAlong};
use lumiduct_core::scene::relief::{CapSize, Element, ElementForm, Way, WedgeSpan};

/// How far an element goes into or out of its wall.
trait ReliefExtent {
    const KEY: &str;
    const WAY: Way;
    fn length(&self) -> &AlongSpec;
}

impl ReliefExtent for DepthSpec {
    const KEY: &str = "depth_mm";
    const WAY: Way = Way::Into;
    fn length(&self) -> &AlongSpec {
        &self.depth_mm
    }
}

impl ReliefExtent for HeightSpec {
    const KEY: &str = "height_mm";
    const WAY: Way = Way::OutOf;
    fn length(&self) -> &AlongSpec {
        &self.height_mm
    }
}

impl Context<'_> {
    pub(super) fn relief_element(
        &mut self,
        spec: &ReliefElementSpec,
        wall: &UnrolledReliefWall,
        key: &Key,
    ) -> Option<Element> {
        let (form, way) = match spec {
            ReliefElementSpec::Dimple(spec) => self.cap(spec, wall, &key.field("dimple")),
            ReliefElementSpec::Bump(spec) => self.cap(spec, wall, &key.field("bump")),
            ReliefElementSpec::Groove(spec) => self.wedge(spec, wall, &key.field("groove")),
            ReliefElementSpec::Ridge(spec) => self.wedge(spec, wall, &key.field("ridge")),
            ReliefElementSpec::Pyramid(spec) => self.pyramid(spec, wall, &key.field("pyramid")),
            ReliefElementSpec::Pit(spec) => self.pyramid(spec, wall, &key.field("pit")),
        }?;
        Some(Element { form, way, round: wall.unrolled.radius })
    }

    fn height<E: ReliefExtent>(
        &mut self,
        extent: &E,
        wall: &UnrolledReliefWall,
        key: &Key,
    ) -> Option<TableAlong> {
        self.along(extent.length(), &wall.unrolled, &key.field(E::KEY))
    }

    fn pyramid<E: ReliefExtent>(
        &mut self,
        spec: &PyramidSpec<E>,
        wall: &UnrolledReliefWall,
        key: &Key,
    ) -> Option<(ElementForm, Way)> {
        let height = self.height(&spec.extent, wall, key)?;
        if wall.unrolled.radius.is_some() {
            let message = "pyramids need a flat wall, and this one is round";
            let hint = "a round wall takes dimples, bumps, grooves, and ridges as rings";
            return self.refuse(key, message, hint);
        }
        Some((
            ElementForm::Pyramid { width: spec.width_mm, length: spec.length_mm, height },
            E::WAY,
        ))
    }

    fn cap<E: ReliefExtent>(
        &mut self,
        spec: &CapSpec<E>,
        wall: &UnrolledReliefWall,
        key: &Key,
    ) -> Option<(ElementForm, Way)> {
        let height = self.height(&spec.extent, wall, key)?;
        let size = match (&spec.radius_mm, &spec.diameter_mm) {
            (Some(radius), _) => {
                CapSize::Sphere(self.along(radius, &wall.unrolled, &key.field("radius_mm"))?)
            }
            (None, Some(diameter)) => {
                CapSize::Opening(self.along(diameter, &wall.unrolled, &key.field("diameter_mm"))?)
            }
            // Validated: one of the two is given.
            (None, None) => return None,
        };
        Some((ElementForm::Cap { size, height }, E::WAY))
    }

    fn wedge<E: ReliefExtent>(
        &mut self,
        spec: &WedgeSpec<E>,
        wall: &UnrolledReliefWall,
        key: &Key,
    ) -> Option<(ElementForm, Way)> {
        let height = self.height(&spec.extent, wall, key)?;
        let angles = match (spec.angle_deg, spec.flank_angles_deg) {
            (Some(angle), _) => [90.0 - 0.5 * angle; 2],
            (None, Some(flanks)) => self.flanks(flanks, &key.field("flank_angles_deg"))?,
            // Validated: one of the two is given.
            (None, None) => return None,
        };
        let slopes =
            angles.map(|angle| if angle == 90.0 { 0.0 } else { 1.0 / angle.to_radians().tan() });
        let is_round = wall.unrolled.radius.is_some();
        let span = match (spec.course, spec.length_mm) {
            (CourseSpec::Ring, _) if !is_round => {
                let hint =
                    "a flat wall takes grooves and ridges across the guide: leave `course` out";
                return self.refuse(&key.field("course"), "a ring needs a round wall", hint);
            }
            (CourseSpec::Ring | CourseSpec::Straight, Some(_)) if is_round => {
                let message = "the wall is round: it ends the groove itself";
                return self.refuse(&key.field("length_mm"), message, "leave `length_mm` out");
            }
            (CourseSpec::Straight, None) if is_round && E::WAY == Way::OutOf => {
                let message = "a straight ridge has no foot on a round wall";
                return self.refuse(key, message, "course = \"ring\" puts it all around");
            }
            (CourseSpec::Ring, _) => WedgeSpan::Ring,
            (CourseSpec::Straight, Some(length)) => WedgeSpan::Within(length),
            (CourseSpec::Straight, None) => WedgeSpan::Through(wall.unrolled.size().x),
        };
        Some((ElementForm::Wedge { height, slopes, span }, E::WAY))
    }

    fn flanks(&mut self, flanks: [f64; 2], key: &Key) -> Option<[f64; 2]> {
        for (i, angle) in flanks.into_iter().enumerate() {
            if angle.is_nan() || angle <= 0.0 || angle > 90.0 {
                self.problems.error(
                    &key.index(i),
                    format!("{angle} is out of range, expected above 0, at most 90"),
                );
                return None;
            }
        }
        if flanks[0] + flanks[1] >= 180.0 {
            let message = "two upright flanks do not meet";
            return self.refuse(key, message, "make one of them lean");
        }
        Some(flanks)
    }

    /// Whether the elements of every row are possible: at most half a ball, and not through the
    /// axis of a rod.
    pub(super) fn check_heights(
        &mut self,
        element: &Element,
        field: &ElementField,
        wall: &UnrolledReliefWall,
        on: &str,
        key: &Key,
    ) -> Option<()> {
        let what = match element.way {
            Way::Into => ("dimple", "deep", "depth"),
            Way::OutOf => ("bump", "high", "height"),
        };
        for row in 0..field.rows.count() {
            let place = field.rows.place(row);
            let at = place - wall.unrolled.rect.min.y;
            let height = element.height(place);
            if let Some(cap) = element.cap(place)
                && height > cap.radius.min(cap.rim) * (1.0 + 1e-12)
            {
                let (name, deep, depth) = what;
                let message = format!(
                    "the {name} {at:.4} mm along `{on}` is {height:.4} mm {deep}, more than half of its ball of radius {:.4} mm",
                    cap.radius
                );
                let hint = format!(
                    "keep the {depth} at or below half the diameter, or below the radius of the sphere"
                );
                return self.refuse(key, message, hint);
            }
            if let Some(radius) = wall.unrolled.radius {
                self.check_round(element, place, radius, at, on, key)?;
            }
        }
        Some(())
    }

    fn check_round(
        &mut self,
        element: &Element,
        place: f64,
        radius: f64,
        at: f64,
        on: &str,
        key: &Key,
    ) -> Option<()> {
        let height = element.height(place);
        if element.way == Way::Into && height >= radius {
            self.problems.error(
                key,
                format!(
                    "{at:.4} mm along `{on}` it is {height:.4} mm deep and reaches the axis of the rod, whose radius is {radius:.4} mm"
                ),
            );
            return None;
        }
        let size = element.size(place);
        if element.cap(place).is_some() && size.x >= std::f64::consts::PI * radius {
            let message = format!(
                "{at:.4} mm along `{on}` it is as wide as the rod, whose radius is {radius:.4} mm"
            );
            return self.refuse(key, message, "make the sphere smaller");
        }
        Some(())
    }
}
