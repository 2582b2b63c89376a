//! Patterns of holes, dots and patches on faces.

pub(super) mod ground;
mod layout;
mod overlap;

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::patterns::ground::Ground;
use crate::spec::pattern::{ElementSpec, PatternSpec};
use crate::spec::sheet::{SheetCommon, SheetSpec};
use lumiduct_core::scene::pattern::{ElementField, ElementOutline, HoleWall, Pattern};

impl Context<'_> {
    /// Places the patterns on their faces.
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
        // The finish that a plain sheet names is that of its front; for solids and ducts, that of
        // the inside.
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

    /// Whether the elements of a field do not overlap and lie on their face.
    pub(super) fn check_field(
        &mut self,
        field: &ElementField,
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

    fn field(&mut self, spec: &PatternSpec, ground: &Ground, key: &Key) -> Option<ElementField> {
        let outline = match &spec.element {
            ElementSpec::Circle(circle) => {
                let place = key.field("element").field("circle").field("diameter_mm");
                ElementOutline::Circle {
                    diameter: self.along(&circle.diameter_mm, ground, &place)?,
                }
            }
            ElementSpec::Rectangle(r) => {
                ElementOutline::Rectangle { width: r.width_mm, length: r.length_mm }
            }
        };
        let layout = key.field("layout");
        let (rows, columns) = self.rows_and_columns(&spec.layout, ground, &layout)?;
        Some(ElementField { rows, columns, outline, period: ground.period() })
    }
}
