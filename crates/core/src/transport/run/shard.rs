//! One of several parts of a job, each for a separate machine.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;

/// Part `number`, from 1, of `count` about equal parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    number: u64,
    count: u64,
}

impl Shard {
    /// The whole job.
    pub const WHOLE: Self = Self { number: 1, count: 1 };
    /// Largest number of parts.
    pub(crate) const MOST: u64 = 1 << 20;

    /// Part `number` of `count`; `None` where there is no such part.
    pub fn new(number: u64, count: u64) -> Option<Self> {
        let is_one = (1..=Self::MOST).contains(&count) && (1..=count).contains(&number);
        is_one.then_some(Self { number, count })
    }

    /// The indices of this part among `things`; every index is in exactly one part.
    pub fn of(self, things: u64) -> Range<u64> {
        let edge =
            |part: u64| (u128::from(things) * u128::from(part) / u128::from(self.count)) as u64;
        edge(self.number - 1)..edge(self.number)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}/{}", self.number, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_thing_is_in_exactly_one_part() {
        for things in [0, 1, 7, 128, u64::MAX] {
            for count in [1, 2, 3, 16] {
                let parts: Vec<_> = (1..=count)
                    .map(|number| Shard::new(number, count).unwrap().of(things))
                    .collect();
                assert_eq!(parts[0].start, 0);
                assert!(parts.windows(2).all(|pair| pair[0].end == pair[1].start));
                assert_eq!(parts[parts.len() - 1].end, things);
            }
        }
        assert_eq!(Shard::new(0, 4).or(Shard::new(5, 4)).or(Shard::new(1, 0)), None);
    }
}
