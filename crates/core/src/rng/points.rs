//! Randomised Sobol points for the first numbers of the paths of a batch.
//!
//! The points of a batch fill the cube evenly, so that their mean has less variance than that of independent ones. Each
//! batch has a scramble and a shift of its own: every point is uniform, and batches are independent.

use crate::rng::{Fresh, Numbers, Sampler, unit};
use rand_core::Rng;
use smallvec::SmallVec;
use std::f64::consts::SQRT_2;

/// Dimensions of a point: the start of a path, and its first choices at interfaces.
const DIMENSIONS: usize = 8;
/// Binary digits of a coordinate.
const DIGITS: usize = 64;

/// Primitive polynomials by degree and inner coefficients, and the first direction numbers, of all dimensions after the
/// first: Joe & Kuo, SIAM J. Sci. Comput. 30 (2008) 2635, table new-joe-kuo-6.21201.
const SOBOL: [(usize, u64, &[u64]); DIMENSIONS - 1] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
];

/// The points of a batch, one after the other.
#[derive(Debug, Clone)]
pub(crate) struct Points {
    /// By binary digit of the index and dimension: the columns of the scrambled generator matrices, the first digit of a
    /// coordinate highest.
    columns: Vec<[u64; DIMENSIONS]>,
    next: [u64; DIMENSIONS],
    /// Index of the next point, in the order of the Gray code (Antonov & Saleev, USSR Comput. Math. Math. Phys. 19
    /// (1979) 252).
    index: u64,
}

impl Points {
    /// The first `count` points of batch `index` of `stream` under `seed`: Sobol's, with a random linear matrix scramble and
    /// a digital shift (Matoušek, J. Complexity 14 (1998) 527).
    pub(crate) fn of_batch((seed, stream, index): (u64, u64, u64), count: u64) -> Self {
        let Fresh(mut random) = Sampler::for_path(seed, stream, index).numbers;
        let needed = (u64::BITS - count.leading_zeros()) as usize;
        let mut columns = vec![[0; DIMENSIONS]; needed];
        for dimension in 0..DIMENSIONS {
            let scramble: SmallVec<[u64; 16]> =
                (0..needed).map(|digit| lower_triangle(digit, random.next_u64())).collect();
            for (column, plain) in columns.iter_mut().zip(directions(dimension, needed)) {
                column[dimension] = times(&scramble, plain);
            }
        }
        Self { columns, next: std::array::from_fn(|_| random.next_u64()), index: 0 }
    }

    /// About as many points as asked, at least one, that fill the cube most evenly: a power of two.
    pub(crate) fn even_count(about: u64) -> u64 {
        let about = about.max(1);
        let below = 1 << about.ilog2();
        if about as f64 > SQRT_2 * below as f64 { 2 * below } else { below }
    }

    /// The numbers of a path: the coordinates of the next point, and then those of `sampler`.
    #[inline]
    pub(crate) fn lead<'p>(&mut self, sampler: &'p mut Sampler) -> Sampler<Leading<'p>> {
        let point = self.next;
        self.index += 1;
        if let Some(column) = self.columns.get(self.index.trailing_zeros() as usize) {
            for (coordinate, digits) in self.next.iter_mut().zip(column) {
                *coordinate ^= digits;
            }
        }
        Sampler::of(Leading { point, used: 0, fresh: &mut sampler.numbers })
    }
}

/// The coordinates of a point, then fresh numbers.
#[derive(Debug)]
pub(crate) struct Leading<'f> {
    point: [u64; DIMENSIONS],
    used: usize,
    fresh: &'f mut Fresh,
}

impl Numbers for Leading<'_> {
    #[inline]
    fn next(&mut self) -> f64 {
        let Some(digits) = self.point.get(self.used) else { return self.fresh.next() };
        self.used += 1;
        unit(*digits)
    }
}

/// The first columns of Sobol's generator matrix of a dimension: direction numbers, by their recurrence (Bratley & Fox, ACM
/// Trans. Math. Softw. 14 (1988) 88, eq. 2).
fn directions(dimension: usize, needed: usize) -> SmallVec<[u64; 16]> {
    let first = |digit: usize| 1u64 << (DIGITS - 1 - digit);
    let mut columns: SmallVec<[u64; 16]> = SmallVec::new();
    for digit in 0..needed {
        columns.push(match dimension.checked_sub(1).and_then(|place| SOBOL.get(place)) {
            // Van der Corput: the digits of the index, mirrored at the point.
            None => first(digit),
            Some((_, _, numbers)) if digit < numbers.len() => numbers[digit] * first(digit),
            Some(&(degree, inner, _)) => {
                let before = columns[digit - degree];
                let between = (1..degree).filter(|step| inner >> (degree - 1 - step) & 1 == 1);
                between.fold(before ^ (before >> degree), |sum, step| sum ^ columns[digit - step])
            }
        });
    }
    columns
}

/// The column of a random lower triangular matrix with ones on its diagonal, for a digit.
fn lower_triangle(digit: usize, random: u64) -> u64 {
    let diagonal = 1 << (DIGITS - 1 - digit);
    diagonal | (random & (diagonal - 1))
}

/// The product of a matrix, given by its first columns, and a vector of no further digits, over the field of two elements.
fn times(columns: &[u64], vector: u64) -> u64 {
    let digits = columns.iter().enumerate();
    let set = digits.filter(|(digit, _)| vector >> (DIGITS - 1 - digit) & 1 == 1);
    set.fold(0, |sum, (_, column)| sum ^ column)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Dimension;

    /// Points of a batch.
    fn points(batch: u64, count: u64) -> Vec<[f64; DIMENSIONS]> {
        let mut points = Points::of_batch((5, 1, batch), count);
        let mut sampler = Sampler::for_path(0, 0, 0);
        (0..count)
            .map(|_| {
                let mut leading = points.lead(&mut sampler);
                std::array::from_fn(|_| leading.one(Dimension::EmitPosition))
            })
            .collect()
    }

    #[test]
    fn plain_points_are_those_of_joe_and_kuo() {
        // The first of their program's output, without the origin.
        let published = [
            [0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25],
            [0.25, 0.75, 0.75],
            [0.375, 0.375, 0.625],
            [0.875, 0.875, 0.125],
            [0.625, 0.125, 0.875],
            [0.125, 0.625, 0.375],
        ];
        let mut digits = [0; 3];
        for (index, expected) in (1u32..).zip(published) {
            for (dimension, own) in digits.iter_mut().enumerate() {
                *own ^= directions(dimension, 3)[index.trailing_zeros() as usize];
            }
            assert_eq!(digits.map(unit), expected, "{index}");
        }
    }

    #[test]
    fn every_interval_of_a_power_of_two_holds_one_point_of_each_dimension() {
        for (dimension, batch) in (0..DIMENSIONS).flat_map(|own| [(own, 0), (own, 1)]) {
            let mut cells: Vec<u32> =
                points(batch, 256).iter().map(|point| (point[dimension] * 256.0) as u32).collect();
            cells.sort_unstable();
            assert!(cells.iter().copied().eq(0..256), "dimension {dimension}");
        }
    }

    #[test]
    fn the_first_pair_fills_every_rectangle_of_the_grid_evenly() {
        let all = points(3, 256);
        for columns in [1u32, 2, 8, 16, 64, 256] {
            let mut counts = vec![0; 256];
            for point in &all {
                let rows = 256 / columns;
                let column = (point[0] * f64::from(columns)) as u32;
                let row = (point[1] * f64::from(rows)) as u32;
                counts[(column * rows + row) as usize] += 1;
            }
            assert!(counts.iter().all(|count| *count == 1), "{columns} columns");
        }
    }

    #[test]
    fn batches_are_independent_and_their_points_uniform() {
        // A single coordinate over batches: mean 1/2 and variance 1/12, and no correlation between dimensions.
        const BATCHES: u64 = 4000;
        let firsts: Vec<[f64; DIMENSIONS]> =
            (0..BATCHES).map(|batch| points(batch, 8)[5]).collect();
        let mean = |of: &dyn Fn(&[f64; DIMENSIONS]) -> f64| {
            firsts.iter().map(of).sum::<f64>() / BATCHES as f64
        };
        let sigma = (1.0 / 12.0 / BATCHES as f64).sqrt();
        for dimension in 0..DIMENSIONS {
            let own = mean(&|point| point[dimension] - 0.5);
            assert!(own.abs() < 4.0 * sigma, "{dimension}: {own}");
            let with = (dimension + 1) % DIMENSIONS;
            let both = mean(&|point| (point[dimension] - 0.5) * (point[with] - 0.5));
            assert!(both.abs() < 4.0 / 12.0 / (BATCHES as f64).sqrt(), "{dimension}: {both}");
        }
    }

    #[test]
    fn an_even_count_is_the_nearest_power_of_two() {
        assert_eq!(
            [0, 1, 2, 3, 5, 6, 90, 91, 4096].map(Points::even_count),
            [1, 1, 2, 4, 4, 8, 64, 128, 4096]
        );
    }

    #[test]
    fn numbers_beyond_a_point_are_fresh() {
        let mut points = Points::of_batch((1, 1, 1), 4);
        let mut sampler = Sampler::for_path(2, 3, 4);
        let mut leading = points.lead(&mut sampler);
        for _ in 0..DIMENSIONS {
            leading.one(Dimension::EmitPosition);
        }
        let beyond = leading.one(Dimension::EmitPosition);
        assert_eq!(beyond, Sampler::for_path(2, 3, 4).one(Dimension::EmitPosition));
    }

    #[test]
    fn the_mean_of_a_smooth_function_gains_a_hundredfold() {
        // Variance over batches of 256 points of a product over four dimensions, against independent points.
        let value =
            |point: &[f64; DIMENSIONS]| point[..4].iter().map(|u| 1.5 * u.sqrt()).product::<f64>();
        let means: Vec<f64> = (0..64)
            .map(|batch| points(batch, 256).iter().map(value).sum::<f64>() / 256.0)
            .collect();
        let mean = means.iter().sum::<f64>() / 64.0;
        let variance = means.iter().map(|own| (own - mean).powi(2)).sum::<f64>() / 63.0;
        // Independent points: E f² = (9/8)^4, so the variance of f is 0.602.
        let independent = ((9.0_f64 / 8.0).powi(4) - 1.0) / 256.0;
        assert!((mean - 1.0).abs() < 1e-3, "{mean}");
        assert!(100.0 * variance < independent, "{variance} {independent}");
    }
}
