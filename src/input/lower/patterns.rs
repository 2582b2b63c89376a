//! Patterns of holes, dots and patches on faces.

use crate::input::keys::Key;
use crate::input::lower::Context;
use crate::input::spec::pattern::{
    AlongSpec, ElementSpec, GridSpec, HexagonalSpec, LawSpec, LayoutSpec, PatternSpec, RowSpec,
};
use crate::input::spec::sheet::{SheetCommon, SheetSpec};
use crate::math::circle;
use crate::scene::pattern::{Along, Columns, Field, Graded, HoleWall, Outline, Pattern, Rows};
use crate::scene::shape::{ChartRect, Region, Shape};
use crate::scene::sweep::WallChart;
use crate::scene::{FaceId, Patch};
use glam::DVec2;
use std::f64::consts::{SQRT_2, TAU};

/// Pieces by which a power law is drawn.
const PIECES: u32 = 256;
/// Deviation from a whole number of columns around a tube that is taken as rounding, 1.
const WHOLE: f64 = 1e-6;
/// Rows that a pattern may have.
const MOST_ROWS: f64 = 1e7;

/// A face as a pattern sees it.
#[derive(Debug, Clone, Copy)]
struct Ground {
    face: FaceId,
    rect: ChartRect,
    /// Radius of a round face that closes on itself, mm.
    radius: Option<f64>,
}

impl Ground {
    fn size(&self) -> DVec2 {
        self.rect.max - self.rect.min
    }

    /// Length once around, mm.
    fn period(&self) -> Option<f64> {
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
        if let Some(row) = field.first_overlap() {
            let place = field.rows.place(row) - ground.rect.min.y;
            self.problems
                .error(
                    &key.field("element"),
                    format!("elements overlap {place:.4} mm along `{}`", spec.on),
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
                        "an element {place:.4} mm along `{}` reaches {beyond:.4} mm beyond it",
                        spec.on
                    ),
                )
                .hint(format!("the face is {:.4} mm across and {:.4} mm along", size.x, size.y));
            return None;
        }
        let pattern =
            Pattern { name: name.to_owned(), face: ground.face, field, front, back, wall };
        self.is_clear(&pattern, key).then_some(pattern)
    }

    /// The face of a pattern: one whose chart is not stretched.
    fn ground(&mut self, name: &str, key: &Key) -> Option<Ground> {
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
        let radius = match &patches[0].shape {
            Shape::Cylinder(wall) if wall.is_closed() => Some((rect.max.x - rect.min.x) / TAU),
            _ => None,
        };
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
        let key = key.field("layout");
        let (rows, columns) = match &spec.layout {
            LayoutSpec::Row(row) => self.row(row, ground, &key.field("row"))?,
            LayoutSpec::Grid(grid) => self.grid(grid, 0.0, ground, &key.field("grid"))?,
            LayoutSpec::Staggered(grid) => self.grid(grid, 0.5, ground, &key.field("staggered"))?,
            LayoutSpec::Hexagonal(hexagonal) => {
                self.grid(&rows_of(hexagonal), 0.5, ground, &key.field("hexagonal"))?
            }
        };
        if rows.count() == 0 || columns.count == 0 {
            let size = ground.size();
            self.problems
                .error(&key, "no element fits on the face")
                .hint(format!("it is {:.4} mm across and {:.4} mm along", size.x, size.y));
            return None;
        }
        Some(Field { rows, columns, outline, period: ground.period() })
    }

    fn row(&mut self, spec: &RowSpec, ground: &Ground, key: &Key) -> Option<(Rows, Columns)> {
        let middle = 0.5 * (ground.rect.min.x + ground.rect.max.x);
        let first = match (spec.around_deg, spec.across_mm, ground.radius) {
            (Some(_), Some(_), _) => {
                self.problems.error(
                    &key.field("around_deg"),
                    "stands beside across_mm, expected one of them",
                );
                return None;
            }
            (Some(around), None, Some(radius)) => radius * around.to_radians(),
            (Some(_), None, None) => {
                self.problems
                    .error(&key.field("around_deg"), "the face is not round")
                    .hint("use across_mm, counted from the middle of the face");
                return None;
            }
            (None, across, _) => middle + across.unwrap_or(0.0),
        };
        let columns = Columns { first, pitch: 1.0, count: 1, shift: 0.0 };
        let start = ground.rect.min.y;
        let rows = match (&spec.positions_mm, &spec.pitch_mm) {
            (Some(positions), _) => {
                if let Some(at) = positions.windows(2).position(|pair| pair[0] >= pair[1]) {
                    self.problems.error(
                        &key.field("positions_mm").index(at + 1),
                        "is not above the one before it",
                    );
                    return None;
                }
                Rows::Listed(positions.iter().map(|position| start + position).collect())
            }
            (None, Some(pitch)) => {
                let along =
                    self.range(spec.along_mm, ground, Axis::Along, &key.field("along_mm"))?;
                self.rows(pitch, along, ground, &key.field("pitch_mm"))?
            }
            // Validated: one of the two is given.
            (None, None) => return None,
        };
        Some((rows, columns))
    }

    fn grid(
        &mut self,
        spec: &GridSpec,
        stagger: f64,
        ground: &Ground,
        key: &Key,
    ) -> Option<(Rows, Columns)> {
        let along = self.range(spec.along_mm, ground, Axis::Along, &key.field("along_mm"))?;
        let rows = self.rows(&spec.pitch_mm, along, ground, &key.field("pitch_mm"))?;
        let pitch = spec.across_pitch_mm;
        let shift = stagger * pitch;
        if let (Some(period), None) = (ground.period(), spec.across_mm) {
            let fit = period / pitch;
            let count = fit.round().max(1.0);
            if (fit - count).abs() > WHOLE * count {
                self.problems
                    .error(
                        key,
                        format!(
                            "columns {pitch} mm apart do not close: {fit:.4} of them fit around"
                        ),
                    )
                    .hint(format!("{count} of {:.6} mm do", period / count));
                return None;
            }
            let columns = Columns { first: 0.5 * pitch, pitch, count: count as usize, shift };
            return Some((rows, columns));
        }
        let across = self.range(spec.across_mm, ground, Axis::Across, &key.field("across_mm"))?;
        let width = across[1] - across[0] - shift;
        let count = (width / pitch * (1.0 + WHOLE)).floor().max(0.0);
        let first = across[0] + 0.5 * (width - (count - 1.0) * pitch);
        Some((rows, Columns { first, pitch, count: count as usize, shift }))
    }

    /// As many rows as fit into a part of the face, centred.
    fn rows(
        &mut self,
        pitch: &AlongSpec,
        [from, to]: [f64; 2],
        ground: &Ground,
        key: &Key,
    ) -> Option<Rows> {
        let along = self.along(pitch, ground, key)?;
        if (to - from) / along.smallest() > MOST_ROWS {
            self.problems.error(key, format!("makes more than {MOST_ROWS} rows"));
            return None;
        }
        Some(match pitch {
            AlongSpec::Same(pitch) => {
                let count = ((to - from) / pitch * (1.0 + WHOLE)).floor();
                let first = from + 0.5 * (to - from - (count - 1.0) * pitch);
                Rows::Even { first, pitch: *pitch, count: count as usize }
            }
            AlongSpec::Table(_) | AlongSpec::Law(_) => Rows::Graded(Graded::new(&along, from, to)),
        })
    }

    /// A length along the face, in its chart.
    fn along(&mut self, spec: &AlongSpec, ground: &Ground, key: &Key) -> Option<Along> {
        let start = ground.rect.min.y;
        match spec {
            AlongSpec::Same(length) => Some(Along::constant(*length)),
            AlongSpec::Table(knots) => {
                if let Some(at) = knots.iter().position(|knot| knot[1].is_nan() || knot[1] <= 0.0) {
                    self.problems.error(
                        &key.index(at),
                        format!("{} is out of range, expected above 0", knots[at][1]),
                    );
                    return None;
                }
                let along = Along::table(knots.clone());
                if along.is_none() {
                    self.problems.error(key, "the places of the table do not increase");
                }
                along.map(|along| along.shifted(start))
            }
            AlongSpec::Law(law) => {
                Along::table(law_knots(law, ground.size().y)).map(|along| along.shifted(start))
            }
        }
    }

    /// A part of the face in its chart, across or along.
    fn range(
        &mut self,
        given: Option<[f64; 2]>,
        ground: &Ground,
        axis: Axis,
        key: &Key,
    ) -> Option<[f64; 2]> {
        let ChartRect { min, max } = ground.rect;
        let (whole, origin) = match axis {
            Axis::Along => ([min.y, max.y], min.y),
            Axis::Across => ([min.x, max.x], 0.5 * (min.x + max.x)),
        };
        let Some(given) = given else { return Some(whole) };
        let range = given.map(|place| origin + place);
        let least = 1e-9 * (whole[1] - whole[0]);
        if range[0] >= range[1] || range[0] < whole[0] - least || range[1] > whole[1] + least {
            let [from, to] = whole.map(|place| place - origin);
            self.problems.error(
                key,
                format!(
                    "[{}, {}] is no part of the face, which goes from {from:.4} to {to:.4} mm",
                    given[0], given[1]
                ),
            );
            return None;
        }
        Some(range)
    }

    /// Whether a pattern shares no place with those that lie on its face already.
    fn is_clear(&mut self, pattern: &Pattern, key: &Key) -> bool {
        let scene = self.builder.scene();
        let others = scene.faces[pattern.face.index()].patterns.iter();
        let met = others.map(|&other| &scene.patterns[other]).find_map(|other| {
            let (few, many) = if pattern.field.count() <= other.field.count() {
                (&pattern.field, &other.field)
            } else {
                (&other.field, &pattern.field)
            };
            let shared = first_shared(few, many).or_else(|| first_shared(many, few));
            shared.map(|at| (other.name.clone(), at))
        });
        let Some((other, at)) = met else { return true };
        self.problems
            .error(
                key,
                format!(
                    "overlaps the pattern `{other}` at ({:.4}, {:.4}) mm of the unrolled face",
                    at.x, at.y
                ),
            )
            .hint("move one of them, or leave elements out");
        false
    }
}

/// An axis of a face.
#[derive(Debug, Clone, Copy)]
enum Axis {
    Along,
    Across,
}

/// Elements that are looked at for an overlap with another pattern, from the first on.
const PROBED: usize = 200_000;
/// Points of an outline that are looked at, beside its centre.
const RIM: u32 = 12;

/// A place that is in elements of both, if one is found: at the centres and rims of those of the first.
fn first_shared(few: &Field, many: &Field) -> Option<DVec2> {
    let Columns { first, pitch, count, shift } = few.columns;
    let elements =
        (0..few.rows.count()).flat_map(|row| (0..count).map(move |column| (row, column)));
    elements.take(PROBED).find_map(|(row, column)| {
        let place = few.rows.place(row);
        let from = if row % 2 == 1 { first + shift } else { first };
        let center = DVec2::new(from + column as f64 * pitch, place);
        let half = 0.5 * few.outline.size(place);
        let reach = match &few.outline {
            Outline::Circle { .. } => 1.0,
            // To the corners.
            Outline::Rectangle { .. } => SQRT_2,
        };
        let rim = (0..RIM).map(|i| {
            let on_rim = reach * circle((f64::from(i) + 0.5) / f64::from(RIM));
            center + 0.999 * half * on_rim.clamp(DVec2::NEG_ONE, DVec2::ONE)
        });
        std::iter::once(center).chain(rim).find(|at| many.contains(*at))
    })
}

/// Whether lengths on a patch are those of its chart.
fn is_unrolled_truly(patch: &Patch) -> bool {
    let keeps_lengths = match &patch.chart {
        None => true,
        Some(WallChart::Along { scale, .. }) => (scale.abs() - DVec2::ONE).length() < WHOLE,
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

/// The rows and columns of elements with six neighbours.
fn rows_of(spec: &HexagonalSpec) -> GridSpec {
    GridSpec {
        across_pitch_mm: spec.pitch_mm,
        pitch_mm: AlongSpec::Same(0.75f64.sqrt() * spec.pitch_mm),
        across_mm: spec.across_mm,
        along_mm: spec.along_mm,
    }
}

fn law_knots(law: &LawSpec, length: f64) -> Vec<[f64; 2]> {
    (0..=PIECES)
        .map(|i| {
            let share = f64::from(i) / f64::from(PIECES);
            [share * length, law.from_mm + (law.to_mm - law.from_mm) * share.powf(law.power)]
        })
        .collect()
}
