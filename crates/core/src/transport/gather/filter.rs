//! The filter before an index of records.

use crate::transport::stop::Pace;

/// Bits for each entry of an index.
const FILTER_BITS: usize = 4;

/// A Bloom filter (Bloom, Commun. ACM 13 (1970) 422) of cells. The bits of a cell share a word, so
/// a query costs one access.
#[derive(Debug)]
pub(super) struct Filter {
    /// Their number is a power of two.
    words: Vec<u64>,
}

impl Filter {
    /// A filter of cells, by their hashes; `None` if it was stopped.
    pub(super) fn new(hashes: impl ExactSizeIterator<Item = u64>, pace: &Pace<'_>) -> Option<Self> {
        let bits = (FILTER_BITS * hashes.len()).next_power_of_two();
        let mut words = vec![0; bits.div_ceil(64)];
        for hash in hashes {
            let (word, bits) = Self::place(hash, words.len());
            words[word] |= bits;
            if pace.spend(1).is_break() {
                return None;
            }
        }
        Some(Self { words })
    }

    /// The word of a cell, out of `words`, and its bits.
    #[inline(always)]
    fn place(hash: u64, words: usize) -> (usize, u64) {
        let bit = |from: u32| 1u64 << ((hash >> from) & 63);
        // Bits that the buckets do not use come first: the filter is finer than they are.
        ((hash >> 26) as usize & (words - 1), bit(46) | bit(52) | bit(58))
    }

    /// Whether it may hold a cell.
    #[inline(always)]
    pub(super) fn may_hold(&self, hash: u64) -> bool {
        let (word, bits) = Self::place(hash, self.words.len());
        self.words[word] & bits == bits
    }
}
