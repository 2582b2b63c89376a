//! Reliefs on walls of solids: dimples, bumps, grooves, ridges, pyramids.

mod element;
mod room;
mod wall;

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::reliefs::wall::UnrolledReliefWall;
use crate::spec::pattern::LayoutSpec;
use crate::spec::relief::ReliefSpec;
use lumiduct_core::scene::pattern::{ElementField, ElementOutline};
use lumiduct_core::scene::relief::{Relief, WedgeSpan};

/// Most elements of a relief: each has its own surfaces.
const MOST_ELEMENTS: u64 = 1_000_000;

impl<'a> Context<'a> {
    /// Adds the reliefs to their solids.
    pub(super) fn lower_reliefs(&mut self) {
        for (name, spec) in &self.spec.reliefs {
            let key = Key::of(&["reliefs", name]);
            _ = self.lower_relief(name, spec, &key);
        }
    }

    fn lower_relief(&mut self, name: &str, spec: &'a ReliefSpec, key: &Key) -> Option<()> {
        let finish = spec.finish.as_ref();
        let inside = finish.map(|finish| self.finish(finish, &key.field("finish")));
        let wall = self.wall(&spec.on, &key.field("on"))?;
        let body = spec.on.split('.').next().unwrap_or_default();
        let name = format!("{body}.{name}");
        if self.faces.contains_key(&name) {
            let message = format!("`{name}` is already a face of the solid");
            return self.refuse(key, message, "give the relief another name");
        }
        self.may_build(key)?;
        let finishes = match inside {
            None => [None; 2],
            Some(inside) => [Some(self.behind(inside?)), inside],
        };
        let relief = self.relief(name.clone(), spec, &wall, key)?;
        let sides = self.sides(&relief, &key.field("element"))?;
        self.has_room(&relief, &spec.on, key)?;
        let id = self.builder.add_relief(relief, &sides, finishes);
        self.faces.insert(name, vec![id]);
        Some(())
    }

    fn relief(
        &mut self,
        name: String,
        spec: &ReliefSpec,
        wall: &UnrolledReliefWall,
        key: &Key,
    ) -> Option<Relief> {
        let layout = key.field("layout");
        let Some(element) = self.relief_element(&spec.element, wall, &key.field("element")) else {
            _ = self.rows_and_columns(&spec.layout, &wall.unrolled, &layout);
            return None;
        };
        if element.span() == Some(WedgeSpan::Ring) {
            self.require_plain_row(&spec.layout, &layout)?;
        }
        let (rows, columns) = self.rows_and_columns(&spec.layout, &wall.unrolled, &layout)?;
        let field = ElementField {
            rows,
            columns,
            outline: ElementOutline::Relief(Box::new(element.clone())),
            period: wall.unrolled.period(),
        };
        if field.count() > MOST_ELEMENTS {
            let count = field.count();
            let message = format!("makes {count} elements, expected at most {MOST_ELEMENTS}");
            let hint = "each element has its own surfaces; the dots of a pattern need none";
            return self.refuse(&layout, message, hint);
        }
        self.check_heights(&element, &field, wall, &spec.on, &key.field("element"))?;
        self.check_field(&field, &wall.unrolled, &spec.on, key)?;
        self.is_clear(wall.unrolled.face, &field, key)
            .then(|| Relief::new(name, wall.unrolled.face, element, field, wall.ground))
    }

    /// Rings go all around, so a row of them has no position across.
    fn require_plain_row(&mut self, layout: &LayoutSpec, key: &Key) -> Option<()> {
        let is_plain = match layout {
            LayoutSpec::Row(row) => row.around_deg.is_none() && row.across_mm.is_none(),
            LayoutSpec::Grid(_) | LayoutSpec::Staggered(_) | LayoutSpec::Hexagonal(_) => false,
        };
        if !is_plain {
            let message = "rings go all around, expected a `row` without a position around";
            let hint = "row = { pitch_mm = ... } or row = { positions_mm = [...] }";
            return self.refuse(key, message, hint);
        }
        Some(())
    }
}
