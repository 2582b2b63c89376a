//! Partial sums over batches in a fixed binary tree over their index.
//!
//! The sum has the same bits whichever thread counted a batch and in whatever pieces they came; and
//! only as many partial sums are kept as the number of batches has binary digits.

use crate::transport::Readings;
use serde::{Deserialize, Serialize};

/// A sum that can be added to the one that follows directly.
pub trait Merge: Clone {
    /// Number of batches that it covers.
    fn batch_count(&self) -> u64;
    /// The first of them.
    fn first_batch(&self) -> u64;
    /// Adds the batches that follow directly.
    fn merge(self, later: &Self) -> Self;
}

impl Merge for Readings {
    fn batch_count(&self) -> u64 {
        Self::batch_count(self)
    }

    fn first_batch(&self) -> u64 {
        self.batches.start
    }

    fn merge(self, later: &Self) -> Self {
        Self::merge(self, later)
    }
}

/// Partial sums of batches, larger ones first.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Sums<T> {
    nodes: Vec<T>,
}

impl<T> Default for Sums<T> {
    fn default() -> Self {
        Self { nodes: Vec::new() }
    }
}

impl<T: Merge> Sums<T> {
    /// The sums from the nodes of the tree over all batches in their order, as [`fold_aligned`] makes them.
    pub(crate) fn of_nodes(nodes: impl IntoIterator<Item = T>) -> Self {
        let mut aligned = Vec::new();
        nodes.into_iter().for_each(|node| fold_aligned(&mut aligned, node));
        Self { nodes: aligned }
    }

    /// Adds the next batch.
    pub fn push(&mut self, batch: T) {
        fold(&mut self.nodes, batch);
    }

    /// Batches so far.
    pub(crate) fn batches(&self) -> u64 {
        self.nodes.iter().map(T::batch_count).sum()
    }

    /// The sum over all batches; `None` before the first.
    pub fn total(&self) -> Option<T> {
        let mut partial = self.nodes.iter().rev();
        let mut sum = partial.next()?.clone();
        // The right edge of the tree: smaller subtrees join the larger ones on their left.
        for left in partial {
            sum = left.clone().merge(&sum);
        }
        Some(sum)
    }
}

/// Adds a node to the partial sums of a tree, each of which covers a power of two of batches, larger ones first;
/// neighbours that cover equally many become one.
fn fold<T: Merge>(partial: &mut Vec<T>, mut node: T) {
    while let Some(left) = partial.pop_if(|left| left.batch_count() == node.batch_count()) {
        node = left.merge(&node);
    }
    partial.push(node);
}

/// Adds a node to partial sums that may start anywhere: neighbours become one only if they are the
/// two halves of a node of the tree over all batches. Any split of the batches into slices
/// therefore gives the same nodes.
pub(crate) fn fold_aligned<T: Merge>(partial: &mut Vec<T>, mut node: T) {
    while let Some(left) = partial.pop_if(|left| {
        left.batch_count() == node.batch_count()
            && left.first_batch().is_multiple_of(2 * left.batch_count())
    }) {
        node = left.merge(&node);
    }
    partial.push(node);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sum whose bits depend on the order of its additions.
    #[derive(Debug, Clone, PartialEq)]
    struct Trace {
        first: u64,
        count: u64,
        text: String,
    }

    impl Merge for Trace {
        fn batch_count(&self) -> u64 {
            self.count
        }

        fn first_batch(&self) -> u64 {
            self.first
        }

        fn merge(self, later: &Self) -> Self {
            let text = format!("({}{})", self.text, later.text);
            Self { first: self.first, count: self.count + later.count, text }
        }
    }

    fn batch(first: u64) -> Trace {
        Trace { first, count: 1, text: format!("{first},") }
    }

    #[test]
    fn any_slices_of_the_batches_make_the_same_sum() {
        for total in [1, 7, 8, 13, 32] {
            let mut whole = Sums::default();
            (0..total).for_each(|index| whole.push(batch(index)));
            for parts in [1, 2, 3, 5, 16] {
                let edge = |part: u64| total * part / parts;
                let nodes = (0..parts).flat_map(|part| {
                    let mut nodes = Vec::new();
                    (edge(part)..edge(part + 1))
                        .for_each(|index| fold_aligned(&mut nodes, batch(index)));
                    nodes
                });
                let merged = Sums::of_nodes(nodes);
                assert_eq!(merged.total(), whole.total(), "{total} batches in {parts} slices");
            }
        }
    }
}
