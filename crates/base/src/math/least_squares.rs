//! Linear regression on a few inputs.

/// Result of a regression.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastSquares {
    /// One for each input.
    pub coefficients: Vec<f64>,
    /// Their standard errors, from the residuals.
    pub std_errors: Vec<f64>,
    /// Share of the variance that the fit explains, 1.
    pub r_squared: f64,
}

/// Fits `values` by a linear combination of input columns; all have zero mean, so no constant is
/// needed. Uses the normal equations, which are well conditioned for standardised inputs. `None`
/// where inputs are linearly dependent or there are no more values than unknowns.
pub fn least_squares(inputs: &[Vec<f64>], values: &[f64]) -> Option<LeastSquares> {
    let (count, unknowns) = (values.len(), inputs.len());
    if unknowns == 0 || count <= unknowns + 1 {
        return None;
    }
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // The matrix augmented by the right side and the unit matrix; the latter becomes the inverse.
    let mut rows: Vec<Vec<f64>> = (0..unknowns)
        .map(|row| {
            let products = inputs.iter().map(|input| dot(&inputs[row], input));
            let unit = (0..unknowns).map(|column| f64::from(u8::from(column == row)));
            products.chain([dot(&inputs[row], values)]).chain(unit).collect()
        })
        .collect();
    let scale = rows.iter().enumerate().map(|(i, row)| row[i]).fold(0.0, f64::max);
    solve_rows(&mut rows, SINGULAR * scale)?;
    let coefficients: Vec<f64> = rows.iter().map(|row| row[unknowns]).collect();
    let left_over: f64 = (0..count)
        .map(|place| {
            let fit: f64 =
                inputs.iter().zip(&coefficients).map(|(input, own)| own * input[place]).sum();
            (values[place] - fit).powi(2)
        })
        .sum();
    // The mean takes one more degree of freedom.
    let variance = left_over / (count - unknowns - 1) as f64;
    let diagonal = rows.iter().enumerate().map(|(place, row)| row[unknowns + 1 + place]);
    Some(LeastSquares {
        std_errors: diagonal.map(|own| (own * variance).sqrt()).collect(),
        coefficients,
        r_squared: 1.0 - left_over / dot(values, values),
    })
}

/// A pivot below this share of the largest counts as zero, 1.
const SINGULAR: f64 = 1e-12;

/// Solves linear equations by Gauss-Jordan elimination with pivots from the rows below: rows begin with those of a square
/// matrix, and what follows becomes the solutions, one for each further column. `None` where no pivot is above `least`.
pub fn solve_rows(rows: &mut [Vec<f64>], least: f64) -> Option<()> {
    for step in 0..rows.len() {
        let best = (step..rows.len())
            .max_by(|&a, &b| rows[a][step].abs().total_cmp(&rows[b][step].abs()))?;
        rows.swap(step, best);
        let pivot = rows[step][step];
        if pivot.abs() <= least {
            return None;
        }
        rows[step].iter_mut().for_each(|value| *value /= pivot);
        let own = rows[step].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(place, _)| *place != step) {
            let factor = row[step];
            row.iter_mut().zip(&own).for_each(|(value, own)| *value -= factor * own);
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_is_found_exactly_and_noise_is_told_by_the_errors() {
        let inputs = vec![vec![-1.0, 1.0, -1.0, 1.0, 0.0], vec![-1.0, -1.0, 1.0, 1.0, 0.0]];
        let plane: Vec<f64> = (0..5).map(|i| 2.0 * inputs[0][i] - 0.5 * inputs[1][i]).collect();
        let fit = least_squares(&inputs, &plane).unwrap();
        assert!(
            (fit.coefficients[0] - 2.0).abs() < 1e-14 && (fit.coefficients[1] + 0.5).abs() < 1e-14
        );
        assert!((fit.r_squared - 1.0).abs() < 1e-14 && fit.std_errors[0] < 1e-7);
        // A bump that both inputs are blind to: variance (4 · 0.1²) / 2 over 4 for each coefficient.
        let bumped: Vec<f64> =
            plane.iter().zip([0.1, -0.1, -0.1, 0.1, 0.0]).map(|(a, b)| a + b).collect();
        let fit = least_squares(&inputs, &bumped).unwrap();
        assert!((fit.std_errors[0] - (0.04f64 / 2.0 / 4.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_cannot_be_told_apart_is_not_told() {
        let input = vec![-1.0, 0.0, 1.0, 0.0, 0.0];
        assert_eq!(least_squares(&[input.clone(), input.clone()], &input), None);
        assert_eq!(least_squares(&[vec![1.0, -1.0]], &[1.0, -1.0]), None);
    }
}
