//! Patterns of holes, dots and patches on faces.

mod layout;
mod overlap;

use crate::keys::Key;
use crate::lower::Context;
use crate::spec::pattern::{ElementSpec, PatternSpec};
use crate::spec::sheet::{SheetCommon, SheetSpec};
use glam::DVec2;
use lumiduct_core::scene::pattern::{Field, HoleWall, Outline, Pattern};
use lumiduct_core::scene::shape::{ChartRect, Region, Shape};
use lumiduct_core::scene::sweep::WallChart;
use lumiduct_core::scene::{FaceId, Patch};
use std::f64::consts::TAU;

/// Deviation from a stretch of 1 that is taken as rounding, 1.
const ROUNDING: f64 = 1e-6;

/// A face as a pattern sees it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ground {
    pub(super) face: FaceId,
    pub(super) rect: ChartRect,
    /// Radius of a round face that closes on itself, mm.
    pub(super) radius: Option<f64>,
}

impl Ground {
    pub(super) fn size(&self) -> DVec2 {
        self.rect.max - self.rect.min
    }

    /// Length once around, mm.
    pub(super) fn period(&self) -> Option<f64> {
        self.radius.map(|radius| TAU * radius)
    }
}

impl Context<'_> {
    /// Lays the patterns on their faces.
    pub(super) fn lower_patterns(&mut self) {
        for (name, spec) in &self.spec.patterns {
            let key = Key::of(&["patterns", name]);
            if let Some(pattern) = self.pattern(name, spec, &key) {
                self.builder.add_pattern(pattern);
            }
        }
    }

    fn pattern(&mut self, name: &str, spec: &PatternSpec, key: &Key) -> Option<Pattern> {
        let ground = self.ground(&spec.on, &key.field("on"))?;
        let finish = self.finish(&spec.finish)?;
        // The finish that a plain sheet names is that of its front; of solids and ducts, that of the inside.
        let owner = spec.on.split('.').next().unwrap_or_default();
        let sheet = self.spec.sheets.get(owner).map(SheetSpec::common);
        let (front, back) = match sheet {
            Some(SheetCommon::Sheet(_)) => (finish, self.behind(finish)),
            Some(SheetCommon::Duct(_)) | None => (self.behind(finish), finish),
        };
        let bore = self.finishes.get("black").copied();
        let wall = spec.wall_mm.zip(bore).map(|(thickness, bore)| HoleWall { thickness, bore });
        let field = self.field(spec, &ground, key)?;
        self.check_field(&field, &ground, &spec.on, key)?;
        if let (Some(wall), Some(radius)) = (wall, ground.radius)
            && wall.thickness >= radius
        {
            self.problems
                .error(
                    &key.field("wall_mm"),
                    format!("{} does not fit a tube of radius {radius}: the face is the middle of its wall", wall.thickness),
                )
                .hint("make the wall thinner than the radius, or the tube wider");
            return None;
        }
        let pattern =
            Pattern { name: name.to_owned(), face: ground.face, field, front, back, wall };
        self.is_clear(pattern.face, &pattern.field, key).then_some(pattern)
    }

    /// Whether the elements of a field keep clear of each other and lie on their face.
    pub(super) fn check_field(
        &mut self,
        field: &Field,
        ground: &Ground,
        on: &str,
        key: &Key,
    ) -> Option<()> {
        if let Some(row) = field.first_overlap() {
            let size = field.outline.size(field.rows.place(row));
            let place = field.rows.place(row) - ground.rect.min.y;
            self.problems
                .error(
                    &key.field("element"),
                    format!(
                        "elements overlap, as at {place:.4} mm along `{on}`: there they are {:.4} mm across and {:.4} mm long",
                        size.x, size.y
                    ),
                )
                .hint("make them smaller, or the pitch larger");
            return None;
        }
        if let Some((row, beyond)) = field.first_outside(ground.rect) {
            let (place, size) = (field.rows.place(row) - ground.rect.min.y, ground.size());
            self.problems
                .error(
                    &key.field("layout"),
                    format!(
                        "an element {place:.4} mm along `{on}` reaches {beyond:.4} mm beyond it"
                    ),
                )
                .hint(format!("the face is {:.4} mm across and {:.4} mm along", size.x, size.y));
            return None;
        }
        Some(())
    }

    /// The face of a pattern: one whose chart is not stretched.
    pub(super) fn ground(&mut self, name: &str, key: &Key) -> Option<Ground> {
        let faces = self.faces_named(name, key)?;
        let [face] = faces[..] else {
            self.problems
                .error(key, format!("`{name}` stands for {} faces, expected one", faces.len()))
                .hint("name one of them, such as `wall_plus_x`");
            return None;
        };
        let scene = self.builder.scene();
        let patches = scene.face_patches(face);
        let (true, Some(rect)) =
            (!patches.is_empty() && patches.iter().all(is_unrolled_truly), scene.face_rect(face))
        else {
            self.problems
                .error(
                    key,
                    format!(
                        "`{name}` is neither a flat rectangle nor the wall of a straight round tube or rod"
                    ),
                )
                .hint("a pattern needs a face that unrolls without being stretched");
            return None;
        };
        let is_round = matches!(&patches[0].shape, Shape::Cylinder(wall) if wall.is_closed());
        let radius = is_round.then(|| (rect.max.x - rect.min.x) / TAU);
        Some(Ground { face, rect, radius })
    }

    fn field(&mut self, spec: &PatternSpec, ground: &Ground, key: &Key) -> Option<Field> {
        let outline = match &spec.element {
            ElementSpec::Circle(circle) => {
                let place = key.field("element").field("circle").field("diameter_mm");
                Outline::Circle { diameter: self.along(&circle.diameter_mm, ground, &place)? }
            }
            ElementSpec::Rectangle(r) => {
                Outline::Rectangle { width: r.width_mm, length: r.length_mm }
            }
        };
        let layout = key.field("layout");
        let (rows, columns) = self.rows_and_columns(&spec.layout, ground, &layout)?;
        Some(Field { rows, columns, outline, period: ground.period() })
    }
}

/// Whether lengths on a patch are those of its chart.
fn is_unrolled_truly(patch: &Patch) -> bool {
    let keeps_lengths = match &patch.chart {
        None => true,
        Some(WallChart::Along { scale, .. }) => (scale.abs() - DVec2::ONE).length() < ROUNDING,
        Some(WallChart::Across { .. } | WallChart::Trapezoid { .. } | WallChart::Sector { .. }) => {
            false
        }
    };
    let is_whole = match &patch.shape {
        Shape::Flat(flat) => matches!(flat.region(), Region::Rectangle { .. }),
        Shape::Cylinder(_) => true,
        Shape::Cone(_)
        | Shape::Torus(_)
        | Shape::Sphere(_)
        | Shape::Paraboloid(_)
        | Shape::ParabolicCylinder(_)
        | Shape::CompoundParabola(_) => false,
    };
    keeps_lengths && is_whole
}
