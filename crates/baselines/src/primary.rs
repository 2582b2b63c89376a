//! Recorded random numbers of a path that a Markov chain varies: primary sample space.
//!
//! Kelemen, Szirmay-Kalos, Antal & Csonka, A Simple and Robust Mutation Strategy for the Metropolis
//! Light Transport Algorithm, Computer Graphics Forum 21 (2002) 531. A number is varied only when a
//! path draws it, so that a path may draw any number of them. This module does not know what a path
//! does with the numbers.

use lumiduct_core::rng::{Dimension, Numbers, Sampler};

/// Least and largest size of a small step, 1 (Kelemen et al. 2002).
const LEAST_STEP: f64 = 1.0 / 1024.0;
const LARGEST_STEP: f64 = 1.0 / 64.0;

/// How a proposal is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mutation {
    /// Redraws all numbers.
    Large,
    /// Perturbs each number a little.
    Small,
}

/// The numbers of a chain's state, and of its proposal while a path draws them.
#[derive(Debug, Clone)]
pub(crate) struct Primary {
    own: Sampler,
    numbers: Vec<Number>,
    /// Steps since the start of the chain, including the proposal.
    step: u64,
    /// The last large step that was accepted or is being proposed.
    anew: u64,
    mutation: Mutation,
    next: usize,
    /// What restores a rejected proposal: the previous numbers, and the last large step.
    changed: Vec<(usize, Number)>,
    known: usize,
    anew_before: u64,
}

/// A number and the last step up to which it was varied.
#[derive(Debug, Clone, Copy)]
struct Number {
    value: f64,
    step: u64,
}

impl Primary {
    /// A chain that draws its own random numbers from `own`. Its first proposal must be a large
    /// step.
    pub(crate) fn new(own: Sampler) -> Self {
        Self {
            own,
            numbers: Vec::new(),
            step: 0,
            anew: 0,
            mutation: Mutation::Large,
            next: 0,
            changed: Vec::new(),
            known: 0,
            anew_before: 0,
        }
    }

    /// Begins a proposal: a path may then draw its numbers.
    pub(crate) fn propose(&mut self, mutation: Mutation) {
        self.step += 1;
        self.mutation = mutation;
        self.next = 0;
        self.changed.clear();
        self.known = self.numbers.len();
        self.anew_before = self.anew;
        if mutation == Mutation::Large {
            self.anew = self.step;
        }
    }

    /// Restores the state before the proposal. A proposal that is not rejected is the new state.
    pub(crate) fn reject(&mut self) {
        for (place, number) in self.changed.drain(..) {
            self.numbers[place] = number;
        }
        self.numbers.truncate(self.known);
        self.anew = self.anew_before;
        self.step -= 1;
    }

    /// A number of the chain's own in [0, 1), for its decisions.
    pub(crate) fn decide(&mut self) -> f64 {
        self.own.one(Dimension::Resampling)
    }

    /// A step whose size has the density 1/size between its bounds, wrapped around the ends of [0,
    /// 1).
    fn small_step(&mut self, value: f64) -> f64 {
        let size = LARGEST_STEP * (LEAST_STEP / LARGEST_STEP).powf(self.decide());
        let moved = if self.decide() < 0.5 { value + size } else { value - size };
        let wrapped = moved - moved.floor();
        // Subtracting the floor of a tiny negative number gives 1.
        if wrapped < 1.0 { wrapped } else { 0.0 }
    }
}

/// The numbers of the proposal, in the order in which a path draws them.
impl Numbers for &mut Primary {
    fn next(&mut self) -> f64 {
        let place = self.next;
        self.next += 1;
        let number = match self.numbers.get(place) {
            Some(number) => {
                self.changed.push((place, *number));
                *number
            }
            // As if it had existed since before the first large step.
            None => Number { value: 0.0, step: 0 },
        };
        let mut varied = number;
        if number.step < self.anew || number.step == 0 {
            varied = Number { value: self.decide(), step: self.anew };
        }
        // Steps since then in which no path drew it; rejected steps have been undone.
        while varied.step < self.step {
            varied.value = self.small_step(varied.value);
            varied.step += 1;
        }
        match self.numbers.get_mut(place) {
            Some(number) => *number = varied,
            None => self.numbers.push(varied),
        }
        varied.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chain() -> Primary {
        Primary::new(Sampler::for_path(3, 0, 0))
    }

    fn ask(mut primary: &mut Primary, count: usize) -> Vec<f64> {
        (0..count).map(|_| primary.next()).collect()
    }

    #[test]
    fn a_small_step_moves_every_number_a_little_and_a_rejected_one_is_undone() {
        let mut primary = chain();
        primary.propose(Mutation::Large);
        let first = ask(&mut primary, 20);
        primary.propose(Mutation::Small);
        let second = ask(&mut primary, 25);
        for (a, b) in first.iter().zip(&second) {
            let apart = (a - b).abs().min(1.0 - (a - b).abs());
            assert!((LEAST_STEP..=LARGEST_STEP * (1.0 + 1e-9)).contains(&apart), "{a} {b}");
        }
        let values = |primary: &Primary| -> Vec<f64> {
            primary.numbers.iter().map(|number| number.value).collect()
        };
        for mutation in [Mutation::Large, Mutation::Small] {
            primary.propose(mutation);
            ask(&mut primary, 30);
            primary.reject();
            assert_eq!(values(&primary), second);
        }
        primary.propose(Mutation::Large);
        assert!(ask(&mut primary, 25).iter().zip(&second).all(|(a, b)| (a - b).abs() > 1e-12));
    }

    #[test]
    fn numbers_that_no_path_asked_for_since_a_large_step_are_made_anew_and_then_varied() {
        let mut primary = chain();
        primary.propose(Mutation::Large);
        let before = ask(&mut primary, 3);
        primary.propose(Mutation::Large);
        ask(&mut primary, 1);
        primary.propose(Mutation::Small);
        let after = ask(&mut primary, 3);
        assert!((before[2] - after[2]).abs() > LARGEST_STEP);
        assert!(primary.numbers.iter().all(|number| number.step == 3));
    }

    #[test]
    fn accepted_proposals_stay_uniform() {
        let mut primary = chain();
        let mut bins = [0u32; 10];
        let n = 200_000u32;
        for step in 0..n {
            primary.propose(if step % 3 == 0 { Mutation::Large } else { Mutation::Small });
            // Only the large steps are independent of each other.
            let value = (&mut primary).next();
            if step % 3 == 2 {
                bins[(value * 10.0) as usize] += 1;
            }
        }
        let expected = f64::from(n / 3) / 10.0;
        let chi2: f64 = bins.iter().map(|&b| (f64::from(b) - expected).powi(2) / expected).sum();
        // 99.9 % point of chi-square with 9 degrees of freedom: 27.9.
        assert!(chi2 < 27.9, "chi-square {chi2}");
    }
}
