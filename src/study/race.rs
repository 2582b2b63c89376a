//! Combinations of choices that race for the designs of a search: in every lap each has as many, and the better half goes on, with those that
//! equal it (sequential halving: Karnin, Koren & Somekh, ICML (2013) 1238).

use crate::study::score::{DesignStanding, Goal};
use lumiduct_input::{Domain, Parameter, Setting};

/// A setting for each parameter with choices.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ChoiceSet {
    /// The place of the parameter among all, and its setting.
    settings: Vec<(usize, Setting)>,
}

impl ChoiceSet {
    /// All combinations, those of the last parameter next to each other; one without any setting where nothing is to choose.
    pub(crate) fn all(parameters: &[Parameter]) -> Vec<Self> {
        let mut all = vec![Self { settings: Vec::new() }];
        for (place, parameter) in parameters.iter().enumerate() {
            let Domain::Levels(levels) = &parameter.domain else { continue };
            let with = |own: &Self, level: &Setting| {
                let further = std::iter::once((place, level.clone()));
                Self { settings: own.settings.iter().cloned().chain(further).collect() }
            };
            all = all
                .iter()
                .flat_map(|own| levels.iter().map(move |level| with(own, level)))
                .collect();
        }
        all
    }

    /// Whether a design, by its settings, is of this combination.
    pub(crate) fn is_of(&self, settings: &[Setting]) -> bool {
        self.settings.iter().all(|(place, own)| settings.get(*place) == Some(own))
    }

    /// Sets the choices of a design.
    pub(crate) fn set(&self, settings: &mut [Setting]) {
        for (place, own) in &self.settings {
            if let Some(setting) = settings.get_mut(*place) {
                *setting = own.clone();
            }
        }
    }
}

/// A design that was measured.
pub(crate) struct KnownDesign {
    pub(crate) settings: Vec<Setting>,
    pub(crate) standing: DesignStanding,
}

/// The race.
pub(crate) struct Race {
    combinations: Vec<ChoiceSet>,
    /// Those that still run, the best first.
    running: Vec<usize>,
    laps_left: usize,
    /// Designs of all combinations in the whole race.
    most: usize,
    /// Designs of each combination in the first lap, at least; fewer where `most` has not enough for all.
    first: usize,
    /// Designs that each of those that run may have had up to now.
    designs: usize,
}

impl Race {
    /// A race for a number of designs, in which each combination has at least a `first` number, as far as `most` allows.
    pub(crate) fn new(parameters: &[Parameter], most: usize, first: usize) -> Self {
        Self::of(ChoiceSet::all(parameters), most, first)
    }

    fn of(combinations: Vec<ChoiceSet>, most: usize, first: usize) -> Self {
        let running: Vec<usize> = (0..combinations.len()).collect();
        // Until a single one runs, and a lap for that.
        let laps_left = 1 + running.len().next_power_of_two().ilog2() as usize;
        let first = first.min(most / running.len());
        Self { combinations, running, laps_left, most, first, designs: 0 }
    }

    pub(crate) fn combination(&self, number: usize) -> &ChoiceSet {
        &self.combinations[number]
    }

    /// Whether a lap that has begun is the last.
    pub(crate) fn is_last_lap(&self) -> bool {
        self.laps_left == 1
    }

    /// The combinations of the next lap, each with the most designs that it may have had after it, where `used` are designs of all
    /// combinations: laps share what is left equally. `None` at the end.
    pub(crate) fn next_lap(&mut self, used: usize) -> Option<Vec<(usize, usize)>> {
        if self.laps_left == 0 {
            return None;
        }
        let left = self.most.saturating_sub(used);
        let share = left / (self.laps_left * self.running.len());
        self.designs = (self.designs + share).max(self.first);
        // What equal shares leave at the end is for the best.
        let extra = if self.laps_left == 1 { left - share * self.running.len() } else { 0 };
        let most = |place: usize| self.designs + usize::from(place < extra);
        Some(self.running.iter().enumerate().map(|(place, own)| (*own, most(place))).collect())
    }

    /// Ends a lap with all designs so far: the half of the combinations with the lowest scores goes on, and any that equal the last
    /// of them. Early designs often do, as where the first steps of all combinations pass and cost the same.
    pub(crate) fn end_lap(&mut self, known: &[KnownDesign]) {
        let best = |number: &usize| {
            let own = known.iter().filter(|own| self.combinations[*number].is_of(&own.settings));
            own.map(|own| own.standing.score(&Goal::One(0))).fold(f64::INFINITY, f64::min)
        };
        let mut ranked: Vec<(f64, usize)> =
            self.running.iter().map(|number| (best(number), *number)).collect();
        // Equal ones stay in their order.
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let half = ranked.len().div_ceil(2);
        let last = ranked[half - 1].0;
        let ties = ranked[half..].iter().take_while(|(score, _)| *score == last).count();
        ranked.truncate(half + ties);
        self.running = ranked.into_iter().map(|(_, number)| number).collect();
        self.laps_left -= 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Designs of each combination after a race, if every design of a combination has the same score.
    fn raced(scores: &[f64], most: usize, first: usize) -> Vec<usize> {
        let combination =
            |number: usize| ChoiceSet { settings: vec![(0, Setting::Number(number as f64))] };
        let mut race = Race::of((0..scores.len()).map(combination).collect(), most, first);
        let (mut known, mut had) = (Vec::new(), vec![0; scores.len()]);
        while let Some(lap) = race.next_lap(known.len()) {
            for (number, most) in lap {
                for _ in had[number]..most {
                    let settings = vec![Setting::Number(number as f64)];
                    let standing = DesignStanding::Fails(scores[number]);
                    known.push(KnownDesign { settings, standing });
                }
                had[number] = had[number].max(most);
            }
            race.end_lap(&known);
        }
        had
    }

    #[test]
    fn the_better_half_of_combinations_goes_on_with_those_that_equal_it() {
        assert_eq!(raced(&[0.4, 0.1, 0.3, 0.2], 80, 2), [6, 48, 6, 20]);
        assert_eq!(raced(&[0.1, 0.3, 0.3, 0.4], 80, 2), [25, 25, 24, 6]);
        assert_eq!(raced(&[0.2; 4], 83, 2), [21, 21, 21, 20]);
        assert_eq!(raced(&[f64::INFINITY; 2], 10, 2), [5, 5]);
        assert_eq!(raced(&[0.7], 9, 2), [9]);
        assert_eq!(raced(&[0.7], 4, 5), [4], "never more than it may trace");
        assert_eq!(raced(&[0.1, 0.2, 0.3, 0.4], 10, 5).iter().sum::<usize>(), 10);
        assert!(raced(&[0.1, 0.2, 0.3, 0.4], 3, 5).iter().sum::<usize>() <= 4, "one each at least");
    }

    #[test]
    fn every_combination_has_a_simplex_before_one_is_dropped() {
        // The fewest designs that a study may give: those of a simplex and one more for each combination.
        for combinations in [2, 3, 5, 8, 14, 32] {
            let scores: Vec<f64> = (0..combinations).map(f64::from).collect();
            let most = combinations as usize * 3;
            let had = raced(&scores, most, 2);
            assert!(had.iter().all(|own| *own >= 2), "{had:?}");
            assert_eq!(had.iter().sum::<usize>(), most, "{had:?}");
        }
    }
}
