//! Combinations of choices that race for the designs of a search: in every lap each has as many, and the better half goes on (sequential
//! halving: Karnin, Koren & Somekh, ICML (2013) 1238).

use lumiduct_input::{Domain, Parameter, Setting};

/// A setting for each parameter with choices.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ChoiceSet {
    /// The place of the parameter among all, and its setting.
    settings: Vec<(usize, Setting)>,
}

impl ChoiceSet {
    /// All combinations, those of the last parameter next to each other; one without any setting where nothing is to choose.
    fn all(parameters: &[Parameter]) -> Vec<Self> {
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
pub(crate) struct ScoredDesign {
    pub(crate) settings: Vec<Setting>,
    pub(crate) score: f64,
}

/// The race.
pub(crate) struct Race {
    combinations: Vec<ChoiceSet>,
    /// Those that still run.
    running: Vec<usize>,
    laps_left: usize,
    /// Designs of all combinations in the whole race.
    most: usize,
    /// Designs that each of those that run may have had up to now.
    designs: usize,
}

/// A lap of the race.
pub(crate) struct Lap {
    /// The combinations that run it.
    pub(crate) entrants: Vec<usize>,
    /// Most designs of each of them, earlier laps included.
    pub(crate) designs: usize,
}

impl Race {
    /// A race for a number of designs.
    pub(crate) fn new(parameters: &[Parameter], most: usize) -> Self {
        let combinations = ChoiceSet::all(parameters);
        let running: Vec<usize> = (0..combinations.len()).collect();
        // Until a single one runs, and a lap for that.
        let laps_left = 1 + running.len().next_power_of_two().ilog2() as usize;
        Self { combinations, running, laps_left, most, designs: 0 }
    }

    pub(crate) fn combination(&self, number: usize) -> &ChoiceSet {
        &self.combinations[number]
    }

    /// The next lap after a number of designs of all combinations: laps share what is left equally; `None` at the end.
    pub(crate) fn next_lap(&mut self, used: usize) -> Option<Lap> {
        if self.laps_left == 0 {
            return None;
        }
        self.designs += self.most.saturating_sub(used) / (self.laps_left * self.running.len());
        Some(Lap { entrants: self.running.clone(), designs: self.designs })
    }

    /// Ends a lap with all designs so far: the half of the combinations with the lowest scores goes on.
    pub(crate) fn end_lap(&mut self, known: &[ScoredDesign]) {
        let best = |number: &usize| {
            let own = known.iter().filter(|own| self.combinations[*number].is_of(&own.settings));
            own.map(|own| own.score).fold(f64::INFINITY, f64::min)
        };
        let mut ranked: Vec<(f64, usize)> =
            self.running.iter().map(|number| (best(number), *number)).collect();
        // Equal ones stay in their order.
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        ranked.truncate(ranked.len().div_ceil(2));
        self.running = ranked.into_iter().map(|(_, number)| number).collect();
        self.laps_left -= 1;
    }
}
