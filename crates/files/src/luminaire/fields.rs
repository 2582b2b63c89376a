//! Numbers of a luminaire file, one after the other, each with its range.

use crate::luminaire::error::LuminaireError;
use crate::luminaire::text::whole;
use std::ops::RangeInclusive;

/// What reads the numbers of a file in its order.
pub(crate) trait NumberReader {
    /// The next number, which the file calls `what`: a finite one.
    fn next(&mut self, what: &str) -> Result<f64, LuminaireError>;

    /// The error of the last number.
    fn wrong(&self, problem: String) -> LuminaireError;

    /// The next number, above 0.
    fn positive(&mut self, what: &str, most: f64) -> Result<f64, LuminaireError> {
        let value = self.next(what)?;
        if value > 0.0 && value <= most {
            return Ok(value);
        }
        Err(self.wrong(format!("{what} is {value}, expected a number above 0, up to {most:e}")))
    }

    /// The next number, within a range.
    fn within(&mut self, what: &str, range: RangeInclusive<f64>) -> Result<f64, LuminaireError> {
        let value = self.next(what)?;
        if range.contains(&value) {
            return Ok(value);
        }
        let (least, most) = range.into_inner();
        Err(self.wrong(format!("{what} is {value}, expected {least:e} to {most:e}")))
    }

    /// The next number, a whole one within a range.
    fn count(&mut self, what: &str, range: RangeInclusive<usize>) -> Result<usize, LuminaireError> {
        let value = self.next(what)?;
        let count = whole(value).and_then(|count| usize::try_from(count).ok());
        let [least, most] = [range.start(), range.end()];
        let wrong = || self.wrong(format!("{what} is {value}, expected {least} to {most}"));
        count.filter(|count| range.contains(count)).ok_or_else(wrong)
    }

    /// The next numbers, angles that increase, deg.
    fn angles(&mut self, count: usize, what: &str) -> Result<Vec<f64>, LuminaireError> {
        let mut angles: Vec<f64> = Vec::new();
        for _ in 0..count {
            let angle = self.next(what)?;
            if let Some(before) = angles.last().filter(|before| **before >= angle) {
                let problem = format!("{what} of {angle} follows {before}: they must increase");
                return Err(self.wrong(problem));
            }
            angles.push(angle);
        }
        Ok(angles)
    }

    /// The next numbers, intensities.
    fn intensities(&mut self, count: usize) -> Result<Vec<f64>, LuminaireError> {
        let mut values = Vec::new();
        for _ in 0..count {
            let value = self.next("an intensity")?;
            if value < 0.0 {
                return Err(self.wrong(format!("an intensity is {value}, expected 0 or more")));
            }
            values.push(value);
        }
        Ok(values)
    }
}
