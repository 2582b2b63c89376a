//! Tables over the horizontal and vertical angles of goniometers of types A and B.

use crate::luminaire::intensities::between;

/// Largest angle of types A and B, deg (LM-63-2002, sections 5.14 and 5.15).
const LAST_ANGLE: f64 = 90.0;
/// Difference of directions that is no more than rounding, deg.
const ROUNDING: f64 = 1e-9;

/// Intensities over horizontal and vertical angles of type A or B, which increase. Between them they are linear in both angles, and
/// outside of them zero.
#[derive(Debug)]
pub(crate) struct FrontTable {
    pub(crate) horizontal_deg: Vec<f64>,
    pub(crate) vertical_deg: Vec<f64>,
    /// Vertical angles of one horizontal angle after the other, cd.
    candela: Vec<f64>,
}

/// What is wrong with the angles of a table of type A or B, if something is.
pub(crate) fn problem_of_angles(horizontal_deg: &[f64], vertical_deg: &[f64]) -> Option<String> {
    for (name, angles) in [("horizontal", horizontal_deg), ("vertical", vertical_deg)] {
        let [first, .., last] = angles else {
            return Some(format!("one {name} angle, expected two or more for type A or B"));
        };
        if *first < -LAST_ANGLE || *last > LAST_ANGLE {
            return Some(format!(
                "{name} angles from {first} to {last}, expected -90 or 0 to 90 for type A or B"
            ));
        }
    }
    let [first, last] = [horizontal_deg[0], horizontal_deg[horizontal_deg.len() - 1]];
    (first > 0.0 || last <= 0.0).then(|| {
        format!("horizontal angles from {first} to {last}, expected -90 or, by symmetry, 0 to 90")
    })
}

impl FrontTable {
    /// A table of angles without a problem.
    pub(crate) fn new(horizontal_deg: Vec<f64>, vertical_deg: Vec<f64>, candela: Vec<f64>) -> Self {
        Self { horizontal_deg, vertical_deg, candela }
    }

    /// What is assumed beyond its angles.
    pub(crate) fn dark_remark(&self) -> String {
        let ends = |angles: &[f64]| format!("{}° to {}°", angles[0], angles[angles.len() - 1]);
        let [horizontal, vertical] = [ends(&self.horizontal_deg), ends(&self.vertical_deg)];
        format!(
            "beyond horizontal angles of {horizontal} and vertical angles of {vertical} the light is taken as 0"
        )
    }

    /// Whether it gives one side of the vertical plane through C0, and the other side is its mirror image: horizontal angles begin at 0
    /// (LM-63-2002, section 5.15).
    pub(crate) fn is_symmetric(&self) -> bool {
        self.horizontal_deg[0] == 0.0
    }

    /// Intensities of one horizontal angle by its place, cd.
    pub(crate) fn column(&self, place: usize) -> &[f64] {
        let angles = self.vertical_deg.len();
        &self.candela[place * angles..(place + 1) * angles]
    }

    /// Intensities of any horizontal angle within the table, cd.
    pub(crate) fn column_at(&self, horizontal_deg: f64) -> Vec<f64> {
        let (place, share) = between(&self.horizontal_deg, horizontal_deg);
        let next = self.column((place + 1).min(self.horizontal_deg.len() - 1));
        let mixed = |(a, b): (&f64, &f64)| a * (1.0 - share) + b * share;
        self.column(place).iter().zip(next).map(mixed).collect()
    }

    /// Intensity, cd.
    pub(crate) fn at(&self, horizontal_deg: f64, vertical_deg: f64) -> f64 {
        let horizontal = if self.is_symmetric() { horizontal_deg.abs() } else { horizontal_deg };
        let (Some(horizontal), Some(vertical)) =
            (within(&self.horizontal_deg, horizontal), within(&self.vertical_deg, vertical_deg))
        else {
            return 0.0;
        };
        let (place, share) = between(&self.vertical_deg, vertical);
        let next = (place + 1).min(self.vertical_deg.len() - 1);
        let of = |column: usize| {
            let own = self.column(column);
            own[place] * (1.0 - share) + own[next] * share
        };
        let (column, share) = between(&self.horizontal_deg, horizontal);
        of(column) * (1.0 - share) + of((column + 1).min(self.horizontal_deg.len() - 1)) * share
    }

    /// The largest intensity, cd.
    pub(crate) fn peak(&self) -> f64 {
        self.candela.iter().copied().fold(0.0, f64::max)
    }
}

/// An angle within the range of others, moved by no more than rounding; `None` outside of it.
fn within(angles: &[f64], angle: f64) -> Option<f64> {
    let (first, last) = (angles[0], angles[angles.len() - 1]);
    let is_inside = angle >= first - ROUNDING && angle <= last + ROUNDING;
    is_inside.then(|| angle.clamp(first, last))
}
