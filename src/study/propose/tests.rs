use super::*;
use indexmap::IndexMap;
use lumiduct_input::{Best, Ranking};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::SplitMix64;

fn parameter(name: &str, [from, to]: [f64; 2], nominal: f64) -> Parameter {
    Parameter {
        name: name.to_owned(),
        unit: None,
        ties: Vec::new(),
        domain: Domain::Uniform { from, to },
        choices: IndexMap::new(),
        nominal: Setting::Number(nominal),
        whole: false,
        tolerance: None,
    }
}

fn plan(designs: u32, seed: u64) -> SearchPlan {
    SearchPlan {
        designs,
        seed,
        cost: IndexMap::new(),
        objectives: Vec::new(),
        least_gain: None,
        samples: None,
    }
}

/// Costs of designs by a function of their settings, and these settings in their order.
struct Formula<Of> {
    of: Of,
    designs: Vec<Vec<Setting>>,
}

impl<Of: FnMut(&[Setting]) -> DesignStanding> DesignMeter for Formula<Of> {
    fn measure(&mut self, design: &Design) -> std::result::Result<DesignStanding, ProposalStop> {
        self.designs.push(design.settings.clone());
        assert_eq!(design.number, self.designs.len());
        Ok((self.of)(&design.settings))
    }

    fn is_settled(&self, _next: &Design) -> bool {
        false
    }
}

/// The settings of the designs of a search in their order.
fn proposed(
    parameters: &[Parameter],
    plan: &SearchPlan,
    of: impl FnMut(&[Setting]) -> DesignStanding,
) -> Vec<Vec<Setting>> {
    let formula = Formula { of, designs: Vec::new() };
    let (end, Formula { designs, .. }) =
        propose(parameters, plan, formula).unwrap_or_else(|error| panic!("{error}"));
    let ProposalEnd::Complete(count) = end else { panic!("it was not stopped") };
    assert_eq!(count, designs.len());
    designs
}

fn numbers(settings: &[Setting]) -> Vec<f64> {
    settings.iter().map(|own| own.number().unwrap()).collect()
}

/// The designs of a search for the least of a function, in their order.
fn searched(
    parameters: &[Parameter],
    plan: &SearchPlan,
    mut of: impl FnMut(&[f64]) -> f64,
) -> Vec<Vec<f64>> {
    let of = |settings: &[Setting]| DesignStanding::Passes(vec![of(&numbers(settings))]);
    proposed(parameters, plan, of).iter().map(|own| numbers(own)).collect()
}

#[test]
fn a_curved_valley_is_followed_in_spite_of_noise() {
    // Rosenbrock, Comput. J. 3 (1960) 175: 0 at (1, 1). Here with noise of 0.01, which the search does not see as such.
    let valley = |x: &[f64]| ((1.0 - x[0]).powi(2) + 100.0 * (x[1] - x[0] * x[0]).powi(2)).ln_1p();
    let sides = [parameter("x", [-2.0, 2.0], -1.2), parameter("y", [-1.0, 3.0], 1.0)];
    for seed in 1..=5 {
        let mut random = SplitMix64::seed_from_u64(seed);
        // Variance 1 by the sum of twelve.
        let mut noise =
            || (0..12).map(|_| random.next_u64() as f64 / 2f64.powi(64)).sum::<f64>() - 6.0;
        let mut values = Vec::new();
        let designs = searched(&sides, &plan(160, seed), |x| {
            values.push(valley(x) + 0.01 * noise());
            *values.last().unwrap()
        });
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let best = values.iter().position(|value| *value == least).unwrap();
        assert!(valley(&designs[best]) < 0.3, "seed {seed}: {:?}", designs[best]);
        assert!((designs[0][0] + 1.2).abs() < 1e-9, "it begins at the scene");
        assert!(designs.iter().all(|own| own[0].abs() <= 2.0 && (own[1] - 1.0).abs() <= 2.0));
    }
}

#[test]
fn the_second_design_is_not_the_first_again() {
    // 10 is no whole step of this range.
    let length = parameter("length", [1.0, 20.0], 10.0);
    let designs = searched(&[length], &plan(6, 1), |x| (x[0] - 4.0).powi(2));
    assert_eq!(designs[0], [10.0]);
    assert!((designs[1][0] - 10.0).abs() > 0.1, "{designs:?}");
}

#[test]
fn whole_numbers_are_each_tried_once_and_then_it_ends() {
    let whole = Parameter { whole: true, ..parameter("n", [1.0, 5.0], 4.0) };
    let mut designs = searched(&[whole], &plan(50, 1), |x| (x[0] - 2.0).powi(2));
    assert_eq!(designs[0], [4.0]);
    designs.sort_by(|a, b| a[0].total_cmp(&b[0]));
    assert!(designs.windows(2).all(|pair| pair[0] != pair[1]) && designs.len() <= 5);
    assert!(designs.contains(&vec![2.0]), "{designs:?}");
}

fn colour(names: &[&str]) -> Parameter {
    let levels = names.iter().map(|own| Setting::Choice((*own).to_owned())).collect();
    Parameter {
        domain: Domain::Levels(levels),
        nominal: Setting::AsInScene,
        ..parameter("colour", [0.0, 1.0], 0.5)
    }
}

#[test]
fn the_best_choice_is_found_and_gets_most_of_the_designs() {
    let colours = ["red", "green", "blue"];
    let parameters = [colour(&colours), parameter("x", [0.0, 1.0], 0.5)];
    let designs = proposed(&parameters, &plan(60, 1), |settings| {
        let [Setting::Choice(colour), Setting::Number(x)] = settings else {
            panic!("{settings:?}")
        };
        let least = [("red", 0.5), ("green", 0.0), ("blue", 0.2)];
        let least = least.iter().find(|own| own.0 == colour).unwrap().1;
        DesignStanding::Passes(vec![least + (x - 0.3).powi(2)])
    });
    assert_eq!(designs.len(), 60);
    // Three laps of 20 designs: of 6, 10 and 20 each, as far as they divide.
    let of = |colour: &str| designs.iter().filter(|own| own[0].to_string() == colour).count();
    assert_eq!(colours.map(of), [6, 38, 16]);
}

/// A plan for the front of two objectives.
fn front_plan(designs: u32, seed: u64) -> SearchPlan {
    let objective = |name: &str| Ranking { measure: name.to_owned(), best: Best::Lowest };
    SearchPlan { objectives: ["a", "b"].map(objective).into(), ..plan(designs, seed) }
}

/// The area that the designs of a front beat within a square of side 1.1, over that of all points of a curve.
fn beaten(costs: &[[f64; 2]], curve: impl Fn(f64) -> f64) -> f64 {
    let area = |costs: &[[f64; 2]]| {
        let of = |x: f64| {
            let best = costs.iter().filter(|own| own[0] <= x).map(|own| own[1]);
            (1.1 - best.fold(1.1, f64::min)).max(0.0)
        };
        (0..2200).map(|step| of((f64::from(step) + 0.5) / 2000.0)).sum::<f64>()
    };
    let ideal: Vec<[f64; 2]> =
        (0..=2000).map(|step| f64::from(step) / 2000.0).map(|x| [x, curve(x)]).collect();
    area(costs) / area(&ideal)
}

#[test]
fn fronts_are_found_where_they_bulge_and_where_they_are_hollow() {
    // The fronts of Zitzler, Deb and Thiele, Evol. Comput. 8 (2000) 173, functions 1 and 2, in four parameters.
    let sides = ["x", "p", "q", "r"].map(|name| parameter(name, [0.0, 1.0], 0.5));
    for (power, least) in [(0.5, 0.8), (2.0, 0.6)] {
        for seed in 1..=5 {
            let mut costs = Vec::new();
            let designs = proposed(&sides, &front_plan(120, seed), |settings| {
                let x = numbers(settings);
                let off: f64 = x[1..].iter().map(|own| (own - 0.3).powi(2)).sum();
                let g = 1.0 + 3.0 * off;
                costs.push([x[0], g * (1.0 - (x[0] / g).powf(power))]);
                DesignStanding::Passes(costs[costs.len() - 1].to_vec())
            });
            assert_eq!(numbers(&designs[0]), [0.5; 4], "it begins at the scene");
            assert_eq!(designs.len(), 120);
            let share = beaten(&costs, |x| 1.0 - x.powf(power));
            assert!(share > least, "power {power}, seed {seed}: {share}");
        }
    }
}

#[test]
fn every_combination_of_choices_has_as_many_designs_of_a_front() {
    let parameters = [colour(&["red", "blue"]), parameter("x", [0.0, 1.0], 0.5)];
    let designs = proposed(&parameters, &front_plan(40, 1), |settings| {
        let x = settings[1].number().unwrap();
        DesignStanding::Passes(vec![x, 1.0 - x])
    });
    let of = |colour: &str| designs.iter().filter(|own| own[0].to_string() == colour).count();
    assert_eq!(["red", "blue"].map(of), [20, 20]);
    let spread = designs.iter().map(|own| own[1].number().unwrap());
    assert!(spread.clone().any(|x| x < 0.01) && spread.clone().any(|x| x > 0.99));
}

#[test]
fn a_front_is_looked_for_even_if_nothing_passes() {
    let sides = [parameter("x", [0.0, 1.0], 0.5)];
    let designs = proposed(&sides, &front_plan(20, 1), |settings| {
        DesignStanding::Fails(0.1 + (settings[0].number().unwrap() - 0.2).abs())
    });
    let least = designs.iter().map(|own| (own[0].number().unwrap() - 0.2).abs());
    assert!(least.fold(1.0, f64::min) < 0.02);
}

/// A meter that is settled once it has so many designs of the choice of the next.
struct Settling {
    after: usize,
    designs: Vec<Vec<Setting>>,
}

impl DesignMeter for Settling {
    fn measure(&mut self, design: &Design) -> std::result::Result<DesignStanding, ProposalStop> {
        self.designs.push(design.settings.clone());
        let least = if design.settings[0].to_string() == "red" { 0.0 } else { 0.5 };
        let x = design.settings[1].number().unwrap();
        Ok(DesignStanding::Passes(vec![least + (x - 0.3).powi(2)]))
    }

    fn is_settled(&self, next: &Design) -> bool {
        let own = self.designs.iter().filter(|own| own[0] == next.settings[0]);
        own.count() >= self.after
    }
}

#[test]
fn a_search_that_gains_nothing_ends_in_its_last_lap_only() {
    let parameters = [colour(&["red", "blue"]), parameter("x", [0.0, 1.0], 0.5)];
    let counts = |after: usize| {
        let meter = Settling { after, designs: Vec::new() };
        let (end, meter) = propose(&parameters, &plan(60, 1), meter).unwrap_or_else(|_| panic!());
        let count =
            |colour: &str| meter.designs.iter().filter(|own| own[0].to_string() == colour).count();
        assert!(matches!(end, ProposalEnd::Complete(all) if all == meter.designs.len()));
        ["red", "blue"].map(count)
    };
    // A lap of 15 designs each, then 30 for the better one.
    assert_eq!(counts(100), [45, 15]);
    assert_eq!(counts(20), [20, 15]);
    assert_eq!(counts(3), [15, 15], "the first lap is traced whole");
}

#[test]
fn a_direction_starts_at_the_best_whole_number() {
    let whole = Parameter { whole: true, ..parameter("n", [1.0, 300.0], 150.0) };
    for value in [1.0, 2.0, 17.0, 299.0, 300.0] {
        let setting = Setting::Number(value);
        assert_eq!(super::setting(&whole, start_share(&whole, &setting)), setting);
    }
}
