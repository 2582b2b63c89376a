//! Patterns of holes, dots and patches on faces.

pub(super) mod ground;
pub(crate) mod layout;

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::patterns::ground::PatternGround;
use crate::spec::pattern::{ElementSpec, PatternSpec};
use crate::spec::sheet::{SheetCommon, SheetSpec};
use lumiduct_core::scene::FaceId;
use lumiduct_core::scene::pattern::{ElementField, ElementOutline, HoleWall, Pattern};

impl<'a> Context<'a> {
    /// Places the patterns on their faces.
    pub(super) fn lower_patterns(&mut self) {
        for (name, spec) in &self.spec.patterns {
            let key = Key::of(&["patterns", name]);
            if let Some(pattern) = self.pattern(name, spec, &key) {
                self.builder.add_pattern(pattern);
            }
        }
    }

    fn pattern(&mut self, name: &str, spec: &'a PatternSpec, key: &Key) -> Option<Pattern> {
        let finish = self.finish(&spec.finish, &key.field("finish"));
        let ground = self.ground(&spec.on, &key.field("on"))?;
        self.may_build(key)?;
        let finish = finish?;
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
            let thickness = wall.thickness;
            let message = format!(
                "{thickness} does not fit a tube of radius {radius}: the face is the middle of its wall"
            );
            let hint = "make the wall thinner than the radius, or the tube wider";
            return self.refuse(&key.field("wall_mm"), message, hint);
        }
        let pattern =
            Pattern { name: name.to_owned(), face: ground.face, field, front, back, wall };
        self.is_clear(pattern.face, &pattern.field, key).then_some(pattern)
    }

    /// Whether the elements of a field do not overlap and lie on their face.
    pub(super) fn check_field(
        &mut self,
        field: &ElementField,
        ground: &PatternGround,
        on: &str,
        key: &Key,
    ) -> Option<()> {
        if let Some(row) = field.first_overlap() {
            let size = field.outline.size(field.rows.place(row));
            let place = field.rows.place(row) - ground.rect.min.y;
            let message = format!(
                "elements overlap, as at {place:.4} mm along `{on}`: there they are {:.4} mm across and {:.4} mm long",
                size.x, size.y
            );
            let hint = "make them smaller, or the pitch larger";
            return self.refuse(&key.field("element"), message, hint);
        }
        if let Some((row, beyond)) = field.first_outside(ground.rect) {
            let (place, size) = (field.rows.place(row) - ground.rect.min.y, ground.size());
            let message =
                format!("an element {place:.4} mm along `{on}` reaches {beyond:.4} mm beyond it");
            let hint = format!("the face is {:.4} mm across and {:.4} mm along", size.x, size.y);
            return self.refuse(&key.field("layout"), message, hint);
        }
        Some(())
    }

    fn field(
        &mut self,
        spec: &PatternSpec,
        ground: &PatternGround,
        key: &Key,
    ) -> Option<ElementField> {
        let outline = match &spec.element {
            ElementSpec::Circle(circle) => {
                let place = key.field("element").field("circle").field("diameter_mm");
                let diameter = self.along(&circle.diameter_mm, ground, &place);
                diameter.map(|diameter| ElementOutline::Circle { diameter })
            }
            ElementSpec::Rectangle(r) => {
                Some(ElementOutline::Rectangle { width: r.width_mm, length: r.length_mm })
            }
        };
        let layout = self.rows_and_columns(&spec.layout, ground, &key.field("layout"));
        let (outline, (rows, columns)) = outline.zip(layout)?;
        Some(ElementField { rows, columns, outline, period: ground.period() })
    }

    /// Whether a field does not overlap the patterns and reliefs already on its face.
    pub(super) fn is_clear(&mut self, face: FaceId, field: &ElementField, key: &Key) -> bool {
        let scene = self.builder.scene();
        let patterns = scene.patterns.iter().filter(|other| other.face == face);
        let patterns = patterns.map(|other| ("pattern", &other.name, &other.field));
        let reliefs = scene.reliefs.iter().filter(|other| other.wall == face);
        let reliefs = reliefs.map(|other| ("relief", &other.name, &other.field));
        let met = patterns.chain(reliefs).find_map(|(what, name, other)| {
            let (few, many) =
                if field.count() <= other.count() { (field, other) } else { (other, field) };
            few.first_met(many).map(|at| (what, name.clone(), at))
        });
        let Some((what, other, at)) = met else { return true };
        let (x, y) = (at.x, at.y);
        let message =
            format!("overlaps the {what} `{other}` at ({x:.4}, {y:.4}) mm of the unrolled face");
        self.problems.error(key, message).hint("move one of them, or leave elements out");
        false
    }
}
