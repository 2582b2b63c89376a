//! Methods of searching for a design, on functions with noise: the tables of docs/study_format.md.
//!
//! `cargo run --release --manifest-path benches/search/Cargo.toml`. Every function maps shares of ranges, 0 to 1, to a true value
//! and to margins of checks, which are measured with noise. Printed is the lowest true value among those of the first 40 and of
//! all 80 designs that truly pass, the median over searches with their own seeds.

mod front;

use basin::{
    BoundedCmaEs, BoxBounds, ConstraintDescription, ConstraintSet, Constraints, CostFunction,
    DenseMatrix, Executor, Gbnm, PointState,
};
use egobox_ego::EgorBuilder;
use ndarray::{Array2, ArrayView2};
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::cell::RefCell;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::rc::Rc;

/// Designs of a search, and those after which it is looked at first.
const DESIGNS: usize = 80;
const FEW: usize = 40;
/// Searches of a method; fewer of the one that takes seconds for each.
const SEARCHES: u64 = 41;
const SLOW_SEARCHES: u64 = 9;
/// Standard deviation of measured values and margins.
const NOISE: f64 = 0.01;
/// Edge of the first simplex, and standard deviation of the first population, as shares of the ranges.
const FIRST_EDGE: f64 = 0.25;
const FIRST_SPREAD: f64 = 0.3;

/// A function to minimise.
struct Function {
    name: &'static str,
    parameters: usize,
    /// What shares of the ranges give: the value to be low, and by how much checks are failed.
    of: fn(&[f64]) -> Outcome,
}

/// What a design gives.
struct Outcome {
    value: f64,
    /// Margins of its checks, negative where it fails.
    margins: Vec<f64>,
}

const FUNCTIONS: [Function; 3] = [
    Function { name: "valley of Rosenbrock in 2 dimensions, ln(1 + f)", parameters: 2, of: valley },
    Function { name: "length of a bent pipe (3 parameters), two checks", parameters: 3, of: pipe },
    Function { name: "bowl of condition 100 with ripples, 6 dimensions", parameters: 6, of: bowl },
];

/// Rosenbrock, Comput. J. 3 (1960) 175, with the minimum 0 at (1, 1).
fn valley(shares: &[f64]) -> Outcome {
    // No corner of the first simplex lies near the minimum.
    let [x, y] = [4.4 * shares[0] - 2.6, 4.4 * shares[1] - 1.7];
    let value = 100.0 * (y - x * x).powi(2) + (1.0 - x).powi(2);
    Outcome { value: value.ln_1p(), margins: vec![] }
}

/// Length over 100 mm of two legs of 2 to 42 mm and a bend of radius 3 to 23 mm in between. Light is lost in a tight bend and
/// along the way; it becomes even along the second leg and the bend.
fn pipe(shares: &[f64]) -> Outcome {
    let [first, second] = [2.0 + 40.0 * shares[0], 2.0 + 40.0 * shares[1]];
    let radius = 3.0 + 20.0 * shares[2];
    let length = first + second + FRAC_PI_2 * radius;
    let efficiency = (1.0 - (-radius / 5.0).exp()) * (-length / 400.0).exp();
    let evenness = 1.0 - 0.6 * (-second / 6.0).exp() - 0.3 * (-first / 8.0).exp();
    Outcome { value: length / 100.0, margins: vec![efficiency - 0.6, evenness - 0.7] }
}

/// A quadratic bowl with curvatures from 1 to 100, off the middle, with ripples.
fn bowl(shares: &[f64]) -> Outcome {
    let terms = shares.iter().enumerate().map(|(place, share)| {
        let off = share - 0.3 - 0.08 * place as f64;
        let curvature = 100f64.powf(place as f64 / (shares.len() - 1) as f64);
        0.1 * curvature * off * off + 0.01 * (1.0 - (TAU * 4.0 * off).cos())
    });
    Outcome { value: terms.sum(), margins: vec![] }
}

/// A search in progress: what it has measured.
struct Search {
    function: &'static Function,
    noise: Xoshiro256PlusPlus,
    /// True values of designs that pass, in order; infinite for others.
    found: Vec<f64>,
}

impl Search {
    fn new(function: &'static Function, seed: u64) -> Self {
        Self { function, noise: Xoshiro256PlusPlus::seed_from_u64(seed), found: Vec::new() }
    }

    /// The score of a design, of the form of `plan.search` but without its error margin and with absolute shortfalls: below 1 for
    /// those that pass, above for others.
    fn score(&mut self, shares: &[f64]) -> f64 {
        let Outcome { value, margins } = (self.function.of)(shares);
        let mut measured =
            |true_value: f64| true_value + NOISE * self.noise.sample::<f64, _>(StandardNormal);
        let shortfall: f64 = margins.iter().map(|margin| (-measured(*margin)).max(0.0)).sum();
        let value_found = measured(value);
        let passes = margins.iter().all(|margin| *margin >= 0.0);
        self.found.push(if passes { value } else { f64::INFINITY });
        if shortfall > 0.0 { 1.0 + shortfall } else { value_found / (1.0 + value_found.abs()) }
    }

    /// The least true value among the first designs.
    fn least(&self, designs: usize) -> f64 {
        self.found.iter().take(designs).copied().fold(f64::INFINITY, f64::min)
    }
}

/// A search as basin sees it.
#[derive(Clone)]
struct Problem {
    search: Rc<RefCell<Search>>,
    sides: [Vec<f64>; 2],
}

/// The search has all its designs.
#[derive(Debug)]
struct Full;

impl std::fmt::Display for Full {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(to, "all designs are measured")
    }
}

impl std::error::Error for Full {}

impl Constraints for Problem {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;

    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        let [low, high] = &self.sides;
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(low), Some(high)))
    }
}

impl CostFunction for Problem {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Full;

    fn cost(&self, shares: &Vec<f64>) -> Result<f64, Full> {
        let mut search = self.search.borrow_mut();
        if search.found.len() == DESIGNS { Err(Full) } else { Ok(search.score(shares)) }
    }
}

/// A way to search.
struct Method {
    name: &'static str,
    searches: u64,
    run: fn(&'static Function, u64) -> Search,
}

const METHODS: [Method; 4] = [
    Method { name: "simplex with restarts", searches: SEARCHES, run: simplex },
    Method { name: "CMA-ES", searches: SEARCHES, run: evolution },
    Method { name: "efficient global optimisation", searches: SLOW_SEARCHES, run: global },
    Method { name: "random", searches: SEARCHES, run: random },
];

fn problem(function: &'static Function, seed: u64) -> Problem {
    let search = Rc::new(RefCell::new(Search::new(function, seed)));
    let sides = [0.0, 1.0].map(|side| vec![side; function.parameters]);
    Problem { search, sides }
}

/// The search of a problem, which ended with the error `Full` after its last design.
fn take_search(problem: &Problem, is_full: bool) -> Search {
    assert!(is_full, "the search gave up");
    let empty = Search::new(problem.search.borrow().function, 0);
    problem.search.replace(empty)
}

fn simplex(function: &'static Function, seed: u64) -> Search {
    let own = problem(function, seed);
    let method = Gbnm::new(seed).with_initial_simplex_fraction(FIRST_EDGE);
    let start = PointState::new(vec![0.5; function.parameters]);
    take_search(&own, Executor::new(own.clone(), method, start).run().is_err())
}

fn evolution(function: &'static Function, seed: u64) -> Search {
    let own = problem(function, seed);
    let method = BoundedCmaEs::<Vec<f64>, DenseMatrix>::new(seed, FIRST_SPREAD);
    let start = vec![0.5; function.parameters];
    let executor = Executor::from_start(own.clone(), method, start);
    take_search(&own, executor.run().is_err())
}

fn global(function: &'static Function, seed: u64) -> Search {
    let search = std::sync::Arc::new(std::sync::Mutex::new(Search::new(function, seed)));
    let own = std::sync::Arc::clone(&search);
    let measure = move |designs: &ArrayView2<f64>| {
        let mut search = own.lock().expect("no search panics");
        let scores = designs.rows().into_iter().map(|row| search.score(&row.to_vec()));
        let scores: Vec<f64> = scores.collect();
        Array2::from_shape_vec((scores.len(), 1), scores).expect("a column")
    };
    let sides = Array2::from_shape_fn((function.parameters, 2), |(_, side)| side as f64);
    let first = 2 * function.parameters + 1;
    let found = EgorBuilder::optimize(measure)
        .configure(|config| config.n_doe(first).max_iters(DESIGNS - first).seed(seed))
        .min_within(&sides)
        .expect("the settings are valid")
        .run();
    drop(found.expect("the search ends"));
    let mut search = search.lock().expect("no search panics");
    std::mem::replace(&mut search, Search::new(function, 0))
}

fn random(function: &'static Function, seed: u64) -> Search {
    let mut search = Search::new(function, seed);
    let mut numbers = Xoshiro256PlusPlus::seed_from_u64(!seed);
    for _ in 0..DESIGNS {
        let shares: Vec<f64> = (0..function.parameters).map(|_| numbers.random()).collect();
        search.score(&shares);
    }
    search
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    println!("| function | {} |", METHODS.map(|method| method.name).join(" | "));
    println!("|---|--:|--:|--:|--:|");
    for function in &FUNCTIONS {
        let cell = |method: &Method| {
            let searches: Vec<Search> =
                (1..=method.searches).map(|seed| (method.run)(function, seed)).collect();
            let [few, all] = [FEW, DESIGNS]
                .map(|designs| median(searches.iter().map(|own| own.least(designs)).collect()));
            format!("{few:.3}, {all:.3}")
        };
        println!(
            "| {} | {} |",
            function.name,
            METHODS.iter().map(cell).collect::<Vec<_>>().join(" | ")
        );
    }
    println!();
    front::print();
}
