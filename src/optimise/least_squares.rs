//! Changes of openings that correct the light of zones best, within bounds: least squares, smooth along the face.

/// Weight of the differences of neighbours in a change, relative to a squared deviation of the light, 1.
const EVEN_CHANGE: f64 = 0.01;
/// Weight of a change itself: of all that correct the light as well, the smallest is taken.
const SMALL_CHANGE: f64 = 0.001;
/// Weight of second differences of the openings: light that falls beside its openings hardly shows those that alternate, so noise would
/// make them do so.
const SMOOTH_OPENINGS: f64 = 0.003;
/// Rounds over all points, and the change below which they end early.
const MOST_ROUNDS: usize = 1000;
const SMALLEST_CHANGE: f64 = 1e-10;
/// A change beyond its bound that counts as wanted, 1.
const WANTED_BEYOND: f64 = 0.01;

/// A problem: zones that lack light, points whose openings may change.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepProblem<'a> {
    /// Change of the logarithm of the light of each zone by that of the openings at each point.
    pub(crate) response: &'a [Vec<f64>],
    /// Wanted change of the logarithm of the light of each zone, but for a common term; `None` where a zone does not count.
    pub(crate) lack: &'a [Option<f64>],
    /// Openings at the points, as logarithms.
    pub(crate) openings: &'a [f64],
    /// Least and greatest change at each point.
    pub(crate) bounds: &'a [[f64; 2]],
}

/// The change at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OpeningChange {
    /// The logarithm of the ratio of new to old openings.
    pub(crate) change: f64,
    /// Whether the light needs more than the bounds allow.
    pub(crate) is_held: bool,
}

/// The best changes, docs/optimise.md equation (3). Coordinates are minimised in turn, which ends at the only minimum of a convex
/// function within bounds. After each round all of them move together: a common change costs next to nothing, so coordinates alone would
/// need thousands of rounds to find it.
pub(crate) fn best_changes(problem: StepProblem<'_>) -> Vec<OpeningChange> {
    let count = problem.openings.len();
    let sum = squares(problem);
    let mut changes = vec![0.0; count];
    for _ in 0..MOST_ROUNDS {
        let mut largest = 0.0_f64;
        for place in 0..count {
            let [least, most] = problem.bounds[place];
            let new = (changes[place] + sum.step(&changes, place)).max(least).min(most);
            largest = largest.max((new - changes[place]).abs());
            changes[place] = new;
        }
        let common = sum.common_step(&changes, problem.bounds);
        changes.iter_mut().for_each(|own| *own += common);
        if largest.max(common.abs()) < SMALLEST_CHANGE {
            break;
        }
    }
    let held = |place: usize| sum.step(&changes, place).abs() > WANTED_BEYOND;
    (0..count).map(|place| OpeningChange { change: changes[place], is_held: held(place) }).collect()
}

/// A sum of squares as a function of the changes x: x·Qx − 2 l·x, but for a constant.
struct SumOfSquares {
    quadratic: Vec<Vec<f64>>,
    linear: Vec<f64>,
}

impl SumOfSquares {
    /// Half of the falling slope along a coordinate.
    fn fall(&self, changes: &[f64], place: usize) -> f64 {
        let row: f64 = self.quadratic[place].iter().zip(changes).map(|(one, own)| one * own).sum();
        self.linear[place] - row
    }

    /// The way to the minimum along a coordinate.
    fn step(&self, changes: &[f64], place: usize) -> f64 {
        self.fall(changes, place) / self.quadratic[place][place]
    }

    /// The way to the minimum along the change that is the same at all points, as far as the bounds of all allow.
    fn common_step(&self, changes: &[f64], bounds: &[[f64; 2]]) -> f64 {
        let fall: f64 = (0..changes.len()).map(|place| self.fall(changes, place)).sum();
        let curvature: f64 = self.quadratic.iter().flatten().sum();
        let pairs = changes.iter().zip(bounds);
        let [least, most] = pairs
            .fold([f64::NEG_INFINITY, f64::INFINITY], |[least, most], (own, [low, high])| {
                [least.max(low - own), most.min(high - own)]
            });
        (fall / curvature).max(least).min(most)
    }
}

/// The sum of squares of a problem.
fn squares(problem: StepProblem<'_>) -> SumOfSquares {
    let count = problem.openings.len();
    let mut quadratic = vec![vec![0.0; count]; count];
    let mut linear = vec![0.0; count];
    let mut add = |weight: f64, row: &[f64], value: f64| {
        for (place, own) in row.iter().enumerate().filter(|own| *own.1 != 0.0) {
            linear[place] += weight * own * value;
            quadratic[place]
                .iter_mut()
                .zip(row)
                .for_each(|(sum, other)| *sum += weight * own * other);
        }
    };
    for (row, lack) in centred(problem) {
        add(1.0, &row, lack);
    }
    let mut unit = vec![0.0; count];
    for place in 0..count {
        unit[place] = 1.0;
        add(SMALL_CHANGE, &unit, 0.0);
        if place + 1 < count {
            unit[place + 1] = -1.0;
            add(EVEN_CHANGE, &unit, 0.0);
        }
        if place + 2 < count {
            (unit[place + 1], unit[place + 2]) = (-2.0, 1.0);
            let bend: f64 = unit.iter().zip(problem.openings).map(|(one, own)| one * own).sum();
            add(SMOOTH_OPENINGS, &unit, -bend);
        }
        unit.fill(0.0);
    }
    SumOfSquares { quadratic, linear }
}

/// Rows of the zones that count and their lack of light, both about their mean: only ratios of the light matter.
fn centred(problem: StepProblem<'_>) -> Vec<(Vec<f64>, f64)> {
    let pairs = problem.response.iter().zip(problem.lack);
    let mut rows: Vec<(Vec<f64>, f64)> =
        pairs.filter_map(|(row, lack)| Some((row.clone(), (*lack)?))).collect();
    let count = rows.len().max(1) as f64;
    let mean = rows.iter().map(|own| own.1).sum::<f64>() / count;
    rows.iter_mut().for_each(|own| own.1 -= mean);
    for place in 0..problem.openings.len() {
        let mean = rows.iter().map(|own| own.0[place]).sum::<f64>() / count;
        rows.iter_mut().for_each(|own| own.0[place] -= mean);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDE: [[f64; 2]; 4] = [[-9.0, 9.0]; 4];

    fn identity() -> Vec<Vec<f64>> {
        (0..4).map(|zone| (0..4).map(|at| f64::from(u8::from(at == zone))).collect()).collect()
    }

    fn changes(
        response: &[Vec<f64>],
        lack: [Option<f64>; 4],
        bounds: [[f64; 2]; 4],
    ) -> Vec<OpeningChange> {
        best_changes(StepProblem { response, lack: &lack, openings: &[1.0; 4], bounds: &bounds })
    }

    #[test]
    fn openings_change_by_the_lack_of_light_about_a_mean_of_0() {
        let found = changes(&identity(), [-0.3, -0.1, 0.1, 0.3].map(Some), WIDE);
        for (own, lack) in found.iter().zip([-0.3, -0.1, 0.1, 0.3]) {
            assert!((own.change / lack - 1.0).abs() < 0.05 && !own.is_held, "{found:?}");
        }
    }

    #[test]
    fn where_openings_are_held_the_others_come_down_to_them() {
        let bounds = [[-9.0, 9.0], [-9.0, 9.0], [-9.0, 9.0], [-9.0, 0.0]];
        let found = changes(&identity(), [-0.3, -0.1, 0.1, 0.3].map(Some), bounds);
        // The light is met, so nothing is held from it.
        assert!(found[3].change == 0.0 && !found[3].is_held, "{found:?}");
        assert!((found[0].change + 0.6).abs() < 0.05, "{found:?}");
        // At both bounds: the rest cannot follow.
        let found = changes(&identity(), [-0.3, -0.1, 0.1, 0.3].map(Some), [[-0.1, 0.0]; 4]);
        assert!(found[3].is_held && found[0].is_held, "{found:?}");
    }

    #[test]
    fn light_that_falls_beside_its_openings_is_corrected_there() {
        let mut response = identity();
        (response[1][0], response[1][1]) = (0.7, 0.3);
        let found = changes(&response, [0.0, 0.2, 0.0, 0.0].map(Some), WIDE);
        let light = |zone: usize| -> f64 {
            response[zone].iter().zip(&found).map(|(one, own)| one * own.change).sum()
        };
        // The light of zone 1 shows three tenths of its own openings alone: all of the correction would take a change of 0.67, whose
        // unevenness costs more than the light gains. One step makes more than half of it.
        let made = light(1) - light(0);
        assert!(made > 0.1 && made < 0.2, "{found:?}");
        assert!(found[1].change > 0.25 && found[0].change < -0.05, "{found:?}");
    }

    #[test]
    fn zones_that_do_not_count_do_not_pull() {
        let found = changes(&identity(), [Some(0.0), Some(0.0), Some(0.0), None], WIDE);
        assert!(found.iter().all(|own| own.change.abs() < 1e-9), "{found:?}");
    }
}
