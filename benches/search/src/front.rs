//! Searches for a front of two objectives: the second table of docs/study_format.md.
//!
//! Printed is the area of costs that the designs beat, over that which the true front beats, below a point a little above its ends.

use crate::{Full, NOISE, median};
use basin::{
    BoundedCmaEs, BoxBounds, ConstraintDescription, ConstraintSet, Constraints, CostFunction,
    DenseMatrix, Executor, Gbnm, PointState,
};
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::cell::RefCell;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::rc::Rc;

/// Designs of the searches.
const DESIGNS: [usize; 2] = [60, 120];
/// Searches of each method.
const SEARCHES: u64 = 41;
/// As in the program: designs of a direction for each corner of a simplex, and the edge of the first one.
const DESIGNS_PER_CORNER: usize = 4;
const FIRST_EDGE: f64 = 0.25;
/// Standard deviation of the first population of CMA-ES.
const FIRST_SPREAD: f64 = 0.15;
/// Weight of the sum of all objectives.
const SUM_WEIGHT: f64 = 0.05;
/// Random designs that stand for all where the front is not known in closed form.
const MANY: usize = 3_000_000;

/// Two costs to minimise; a margin of exactly 0 means that there is no check.
struct Function {
    name: &'static str,
    parameters: usize,
    /// What shares of the ranges give: both costs, and by how much a check is failed.
    of: fn(&[f64]) -> ([f64; 2], f64),
    /// Beyond it nothing counts.
    corner: [f64; 2],
    /// The second cost on the front by the first, where it is known.
    front: Option<fn(f64) -> f64>,
}

const FUNCTIONS: [Function; 4] = [
    Function {
        name: "length and loss of a bent pipe (3 parameters), a check",
        parameters: 3,
        of: pipe,
        corner: [1.2, 1.0],
        front: None,
    },
    Function {
        name: "ZDT1 with a bowl, 4 parameters: the front bulges",
        parameters: 4,
        of: |shares| zdt(shares, 0.5),
        corner: [1.1, 1.1],
        front: Some(|x| 1.0 - x.sqrt()),
    },
    Function {
        name: "ZDT2 with a bowl, 4 parameters: it is hollow",
        parameters: 4,
        of: |shares| zdt(shares, 2.0),
        corner: [1.1, 1.1],
        front: Some(|x| 1.0 - x * x),
    },
    Function {
        name: "two bowls with ripples, 4 parameters",
        parameters: 4,
        of: bowls,
        corner: [1.1, 1.1],
        front: None,
    },
];

/// The pipe of the other table: its length over 100 mm, and the light that is lost.
fn pipe(shares: &[f64]) -> ([f64; 2], f64) {
    let [first, second] = [2.0 + 40.0 * shares[0], 2.0 + 40.0 * shares[1]];
    let radius = 3.0 + 20.0 * shares[2];
    let length = first + second + FRAC_PI_2 * radius;
    let efficiency = (1.0 - (-radius / 5.0).exp()) * (-length / 400.0).exp();
    let evenness = 1.0 - 0.6 * (-second / 6.0).exp() - 0.3 * (-first / 8.0).exp();
    ([length / 100.0, 1.0 - efficiency], evenness - 0.7)
}

/// Zitzler, Deb and Thiele, Evol. Comput. 8 (2000) 173, with a bowl about 0.3 as the distance from the front.
fn zdt(shares: &[f64], power: f64) -> ([f64; 2], f64) {
    let off: f64 = shares[1..].iter().map(|share| (share - 0.3).powi(2)).sum();
    let g = 1.0 + 9.0 * off / (shares.len() - 1) as f64;
    ([shares[0], g * (1.0 - (shares[0] / g).powf(power))], 0.0)
}

fn bowls(shares: &[f64]) -> ([f64; 2], f64) {
    let bowl = |center: f64| -> f64 {
        let terms = shares.iter().enumerate().map(|(place, share)| {
            let off = share - center - 0.05 * place as f64;
            (1.0 + place as f64) * off * off + 0.01 * (1.0 - (TAU * 4.0 * off).cos())
        });
        terms.sum()
    };
    ([bowl(0.2), bowl(0.6)], 0.0)
}

/// A design that was measured.
struct Design {
    shares: Vec<f64>,
    /// Costs with noise, or by how much its check fails.
    measured: Result<[f64; 2], f64>,
    /// True costs, if it truly passes.
    truth: Option<[f64; 2]>,
}

/// A search in progress.
struct Search {
    function: &'static Function,
    noise: Xoshiro256PlusPlus,
    designs: Vec<Design>,
    /// Weights of the costs, and their scales: the lowest and the span; `None` for the first cost alone.
    aim: Option<([f64; 2], [[f64; 2]; 2])>,
    most: usize,
}

impl Search {
    fn new(function: &'static Function, seed: u64) -> Self {
        let noise = Xoshiro256PlusPlus::seed_from_u64(seed);
        Self { function, noise, designs: Vec::new(), aim: None, most: usize::MAX }
    }

    /// The place of a design, which is measured if it is a new one.
    fn place_of(&mut self, shares: &[f64]) -> Result<usize, Full> {
        let rounded = |share: &f64| (share.clamp(0.0, 1.0) * 1e4).round() / 1e4;
        let shares: Vec<f64> = shares.iter().map(rounded).collect();
        if let Some(place) = self.designs.iter().position(|own| own.shares == shares) {
            return Ok(place);
        }
        if self.designs.len() >= self.most {
            return Err(Full);
        }
        let (costs, margin) = (self.function.of)(&shares);
        let mut noisy = |value: f64| value + NOISE * self.noise.sample::<f64, _>(StandardNormal);
        let found = if margin == 0.0 { 0.0 } else { noisy(margin) };
        let measured = if found < 0.0 { Err(-found) } else { Ok(costs.map(&mut noisy)) };
        let truth = (margin >= 0.0).then_some(costs);
        self.designs.push(Design { shares, measured, truth });
        Ok(self.designs.len() - 1)
    }

    fn score(&self, place: usize) -> f64 {
        let cost = match (&self.designs[place].measured, &self.aim) {
            (Err(shortfall), _) => return 1.0 + shortfall,
            (Ok([first, _]), None) => *first,
            (Ok(costs), Some((weights, scales))) => {
                let scaled = [0, 1].map(|own| (costs[own] - scales[own][0]) / scales[own][1]);
                let worst = (weights[0] * scaled[0]).max(weights[1] * scaled[1]);
                worst + SUM_WEIGHT * (scaled[0] + scaled[1])
            }
        };
        cost / (1.0 + cost.abs())
    }

    /// Turns to another direction; where its search starts: at the best design for it, but for the ends of the front in the middle.
    fn turn_to(&mut self, weights: [f64; 2]) -> Vec<f64> {
        let passing: Vec<[f64; 2]> =
            self.designs.iter().filter_map(|own| own.measured.as_ref().ok().copied()).collect();
        let is_end = weights.contains(&1.0);
        // One end alone has no span.
        let known = if is_end { passing } else { front_of(&passing) };
        let scale = |own: usize| {
            let low = known.iter().map(|costs| costs[own]).fold(f64::INFINITY, f64::min);
            let high = known.iter().map(|costs| costs[own]).fold(f64::NEG_INFINITY, f64::max);
            [low, if high > low { high - low } else { 1.0 }]
        };
        if !known.is_empty() {
            self.aim = Some((weights, [scale(0), scale(1)]));
        }
        let best = (0..self.designs.len())
            .min_by(|one, other| self.score(*one).total_cmp(&self.score(*other)));
        let middle = || vec![0.5; self.function.parameters];
        best.filter(|_| !is_end).map_or_else(middle, |own| self.designs[own].shares.clone())
    }
}

fn front_of(all: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted = all.to_vec();
    sorted.sort_by(|one, other| one[0].total_cmp(&other[0]).then(one[1].total_cmp(&other[1])));
    let mut least = f64::INFINITY;
    sorted.retain(|costs| {
        let is_on = costs[1] < least;
        least = least.min(costs[1]);
        is_on
    });
    sorted
}

/// The area between some costs and a corner that they beat.
fn beaten(all: &[[f64; 2]], corner: [f64; 2]) -> f64 {
    let (mut area, mut above) = (0.0, corner[1]);
    for [x, y] in front_of(all).into_iter().filter(|own| own[0] < corner[0] && own[1] < corner[1]) {
        area += (corner[0] - x) * (above - y);
        above = y;
    }
    area
}

/// The area that the true front beats.
fn whole(function: &Function) -> f64 {
    let costs: Vec<[f64; 2]> = match function.front {
        Some(front) => {
            (0..=10_000).map(|step| f64::from(step) / 1e4).map(|x| [x, front(x)]).collect()
        }
        None => {
            let mut numbers = Xoshiro256PlusPlus::seed_from_u64(0);
            let mut design = || (0..function.parameters).map(|_| numbers.random()).collect();
            let many = (0..MANY).map(|_| -> Vec<f64> { design() });
            let found = many.map(|shares| (function.of)(&shares));
            found.filter(|(_, margin)| *margin >= 0.0).map(|(costs, _)| costs).collect()
        }
    };
    beaten(&costs, function.corner)
}

/// A direction of a search as basin sees it.
#[derive(Clone)]
struct Problem {
    search: Rc<RefCell<Search>>,
    sides: [Vec<f64>; 2],
}

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
        let place = search.place_of(shares)?;
        Ok(search.score(place))
    }
}

/// The ends of the front first, each with twice the designs of others, then from the middle outward.
fn directions(parameters: usize, designs: usize) -> Vec<[f64; 2]> {
    let steps = (designs / (DESIGNS_PER_CORNER * (parameters + 1))).saturating_sub(1).max(2);
    let mut shares: Vec<usize> = (0..=steps).rev().collect();
    let largest = |own: usize| own.max(steps - own);
    shares.sort_by_key(|own| if largest(*own) == steps { 0 } else { largest(*own) });
    let share = |own: usize| own as f64 / steps as f64;
    shares.into_iter().map(|own| [share(own), share(steps - own)]).collect()
}

/// A search with a method for each direction: of a problem, from a place, with a seed.
fn in_directions(
    function: &'static Function,
    (seed, designs): (u64, usize),
    method: fn(Problem, Vec<f64>, u64),
) -> Search {
    let search = Rc::new(RefCell::new(Search::new(function, seed)));
    let sides = [0.0, 1.0].map(|side| vec![side; function.parameters]);
    let problem = Problem { search: Rc::clone(&search), sides };
    let directions = directions(function.parameters, designs);
    let weight = |own: &[f64; 2]| if own.contains(&1.0) { 2 } else { 1 };
    for (place, weights) in directions.iter().enumerate() {
        let start = {
            let mut search = search.borrow_mut();
            let (known, rest) =
                (search.designs.len(), directions[place..].iter().map(weight).sum::<usize>());
            search.most = known + (designs - known) * weight(weights) / rest;
            search.turn_to(*weights)
        };
        method(problem.clone(), start, seed + place as u64);
    }
    search.replace(Search::new(function, 0))
}

fn simplex(problem: Problem, start: Vec<f64>, seed: u64) {
    let method = Gbnm::new(seed).with_initial_simplex_fraction(FIRST_EDGE);
    // It ends with an error, when all designs are measured.
    _ = Executor::new(problem, method, PointState::new(start)).max_cost_evals(10_000).run();
}

fn evolution(problem: Problem, start: Vec<f64>, seed: u64) {
    let method = BoundedCmaEs::<Vec<f64>, DenseMatrix>::new(seed, FIRST_SPREAD);
    _ = Executor::from_start(problem, method, start).run();
}

fn random(function: &'static Function, seed: u64, designs: usize) -> Search {
    let mut search = Search::new(function, seed);
    let mut numbers = Xoshiro256PlusPlus::seed_from_u64(!seed);
    for _ in 0..designs {
        let shares: Vec<f64> = (0..function.parameters).map(|_| numbers.random()).collect();
        _ = search.place_of(&shares);
    }
    search
}

/// Prints the table.
pub fn print() {
    println!("| two costs, each about 1 | simplex in directions | CMA-ES in directions | random |");
    println!("|---|--:|--:|--:|");
    for function in &FUNCTIONS {
        let whole = whole(function);
        let cell = |run: &dyn Fn(u64, usize) -> Search| {
            let share = |seed: u64, designs: usize| {
                let search = run(seed, designs);
                assert!(search.designs.len() <= designs);
                let found: Vec<[f64; 2]> =
                    search.designs.iter().filter_map(|own| own.truth).collect();
                beaten(&found, function.corner) / whole
            };
            let medians = DESIGNS
                .map(|designs| median((1..=SEARCHES).map(|seed| share(seed, designs)).collect()));
            medians.map(|own| format!("{own:.2}")).join(", ")
        };
        let cells = [
            cell(&|seed, designs| in_directions(function, (seed, designs), simplex)),
            cell(&|seed, designs| in_directions(function, (seed, designs), evolution)),
            cell(&|seed, designs| random(function, seed, designs)),
        ];
        println!("| {} | {} |", function.name, cells.join(" | "));
    }
}
