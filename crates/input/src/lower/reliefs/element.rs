//! The elements of a relief, and whether they are possible.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::reliefs::wall::Wall;
use crate::spec::pattern::AlongSpec;
use crate::spec::relief::{CourseSpec, ReliefElementSpec};
use lumiduct_core::scene::pattern::{ElementField, TableAlong};
use lumiduct_core::scene::relief::{CapSize, Element, ElementForm, Way, WedgeSpan};

/// The common keys of a groove and a ridge.
struct WedgeKeys<'s> {
    height: &'s AlongSpec,
    /// The key of the height.
    height_key: &'static str,
    angle_deg: Option<f64>,
    flank_angles_deg: Option<[f64; 2]>,
    length_mm: Option<f64>,
    course: CourseSpec,
    way: Way,
}

/// The common keys of a dimple and a bump.
struct CapKeys<'s> {
    radius: Option<&'s AlongSpec>,
    diameter: Option<&'s AlongSpec>,
    height: &'s AlongSpec,
    height_key: &'static str,
}

impl Context<'_> {
    pub(super) fn relief_element(
        &mut self,
        spec: &ReliefElementSpec,
        wall: &Wall,
        key: &Key,
    ) -> Option<Element> {
        let (form, way) = match spec {
            ReliefElementSpec::Dimple(dimple) => {
                let keys = CapKeys {
                    radius: dimple.radius_mm.as_ref(),
                    diameter: dimple.diameter_mm.as_ref(),
                    height: &dimple.depth_mm,
                    height_key: "depth_mm",
                };
                (self.cap(&keys, wall, &key.field("dimple"))?, Way::Into)
            }
            ReliefElementSpec::Bump(bump) => {
                let keys = CapKeys {
                    radius: bump.radius_mm.as_ref(),
                    diameter: bump.diameter_mm.as_ref(),
                    height: &bump.height_mm,
                    height_key: "height_mm",
                };
                (self.cap(&keys, wall, &key.field("bump"))?, Way::OutOf)
            }
            ReliefElementSpec::Groove(groove) => {
                let keys = WedgeKeys {
                    height: &groove.depth_mm,
                    height_key: "depth_mm",
                    angle_deg: groove.angle_deg,
                    flank_angles_deg: groove.flank_angles_deg,
                    length_mm: groove.length_mm,
                    course: groove.course,
                    way: Way::Into,
                };
                (self.wedge(&keys, wall, &key.field("groove"))?, Way::Into)
            }
            ReliefElementSpec::Ridge(ridge) => {
                let keys = WedgeKeys {
                    height: &ridge.height_mm,
                    height_key: "height_mm",
                    angle_deg: ridge.angle_deg,
                    flank_angles_deg: ridge.flank_angles_deg,
                    length_mm: ridge.length_mm,
                    course: ridge.course,
                    way: Way::OutOf,
                };
                (self.wedge(&keys, wall, &key.field("ridge"))?, Way::OutOf)
            }
            ReliefElementSpec::Pyramid(pyramid) => {
                let key = key.field("pyramid");
                let height =
                    self.along(&pyramid.height_mm, &wall.unrolled, &key.field("height_mm"))?;
                self.require_flat(wall, &key)?;
                let (width, length) = (pyramid.width_mm, pyramid.length_mm);
                (ElementForm::Pyramid { width, length, height }, Way::OutOf)
            }
            ReliefElementSpec::Pit(pit) => {
                let key = key.field("pit");
                let height = self.along(&pit.depth_mm, &wall.unrolled, &key.field("depth_mm"))?;
                self.require_flat(wall, &key)?;
                let (width, length) = (pit.width_mm, pit.length_mm);
                (ElementForm::Pyramid { width, length, height }, Way::Into)
            }
        };
        Some(Element { form, way, round: wall.unrolled.radius })
    }

    fn require_flat(&mut self, wall: &Wall, key: &Key) -> Option<()> {
        if wall.unrolled.radius.is_some() {
            self.problems
                .error(key, "pyramids stand on flat walls, and this one is round")
                .hint("a round wall takes dimples, bumps, grooves, and ridges as rings");
            return None;
        }
        Some(())
    }

    fn cap(&mut self, keys: &CapKeys<'_>, wall: &Wall, key: &Key) -> Option<ElementForm> {
        let height = self.along(keys.height, &wall.unrolled, &key.field(keys.height_key))?;
        let size = match (keys.radius, keys.diameter) {
            (Some(radius), _) => {
                CapSize::Sphere(self.along(radius, &wall.unrolled, &key.field("radius_mm"))?)
            }
            (None, Some(diameter)) => {
                CapSize::Opening(self.along(diameter, &wall.unrolled, &key.field("diameter_mm"))?)
            }
            // Validated: one of the two is given.
            (None, None) => return None,
        };
        Some(ElementForm::Cap { size, height })
    }

    fn wedge(&mut self, keys: &WedgeKeys<'_>, wall: &Wall, key: &Key) -> Option<ElementForm> {
        let height: TableAlong =
            self.along(keys.height, &wall.unrolled, &key.field(keys.height_key))?;
        let angles = match (keys.angle_deg, keys.flank_angles_deg) {
            (Some(angle), _) => [90.0 - 0.5 * angle; 2],
            (None, Some(flanks)) => self.flanks(flanks, &key.field("flank_angles_deg"))?,
            // Validated: one of the two is given.
            (None, None) => return None,
        };
        let slopes =
            angles.map(|angle| if angle == 90.0 { 0.0 } else { 1.0 / angle.to_radians().tan() });
        let is_round = wall.unrolled.radius.is_some();
        let span = match (keys.course, keys.length_mm) {
            (CourseSpec::Ring, _) if !is_round => {
                self.problems.error(&key.field("course"), "a ring needs a round wall").hint(
                    "a flat wall takes grooves and ridges across the guide: leave `course` out",
                );
                return None;
            }
            (CourseSpec::Ring | CourseSpec::Straight, Some(_)) if is_round => {
                self.problems
                    .error(&key.field("length_mm"), "the wall is round: it ends the groove itself")
                    .hint("leave `length_mm` out");
                return None;
            }
            (CourseSpec::Straight, None) if is_round && keys.way == Way::OutOf => {
                self.problems
                    .error(key, "a straight ridge has no foot on a round wall")
                    .hint("course = \"ring\" puts it all around");
                return None;
            }
            (CourseSpec::Ring, _) => WedgeSpan::Ring,
            (CourseSpec::Straight, Some(length)) => WedgeSpan::Within(length),
            (CourseSpec::Straight, None) => WedgeSpan::Through(wall.unrolled.size().x),
        };
        Some(ElementForm::Wedge { height, slopes, span })
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
            self.problems
                .error(key, "two upright flanks do not meet")
                .hint("make one of them lean");
            return None;
        }
        Some(flanks)
    }

    /// Whether the elements of every row are possible: at most half a ball, and not through the
    /// axis of a rod.
    pub(super) fn check_heights(
        &mut self,
        element: &Element,
        field: &ElementField,
        wall: &Wall,
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
                self.problems
                    .error(
                        key,
                        format!(
                            "the {name} {at:.4} mm along `{on}` is {height:.4} mm {deep}, more than half of its ball of radius {:.4} mm",
                            cap.radius
                        ),
                    )
                    .hint(format!("keep the {depth} at or below half the diameter, or below the radius of the sphere"));
                return None;
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
            self.problems
                .error(
                    key,
                    format!("{at:.4} mm along `{on}` it is as wide as the rod, whose radius is {radius:.4} mm"),
                )
                .hint("make the sphere smaller");
            return None;
        }
        Some(())
    }
}
