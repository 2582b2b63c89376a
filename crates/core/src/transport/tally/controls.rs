//! Control variates: what chance has decided at faces, beyond what was to be expected.
//!
//! A photon is either reflected or transmitted. With its throughput w and the chance T of transmission, given that it is not
//! absorbed, the *surprise* of such a choice is w (1 - T) if it is transmitted and -w T if not; its mean is zero, whatever came
//! before. So the mean of F - Σ βⱼ Cⱼ is that of F, with F the flux on a sensor and Cⱼ the sum of the surprises of one kind:
//! those of light from one source at one side of a face, or at roulette. Surprises of different choices are uncorrelated, as
//! each has a mean of zero given all before it, so βⱼ = Cov(F, Cⱼ)/Var(Cⱼ) leaves the least variance (docs/theory.md,
//! eq. 39). The slopes β come from blocks of paths; there are so many blocks that noise of the slopes hardly counts. What is best for
//! independent blocks need not be best for the evenly spread points of a batch (Hickernell, Lemieux & Owen, Stat. Sci. 20
//! (2005) 1), so the groups of batches decide whether a sensor is adjusted (`adjusted`).

use crate::transport::tally::layout::{CONTROLS, Layout};
use serde::{Deserialize, Serialize};
use std::mem;

/// Products that the blocks may cost per path, if all surprises of a block are of this many kinds.
const PRODUCTS_PER_PATH: usize = 8;
const KINDS_OF_BLOCK: usize = 16;
/// Paths of a block, at least and at most.
const BLOCK_PATHS: [usize; 2] = [16, 1 << 15];

/// Products of surprises with the scalars of sensors, summed over blocks of paths and centred for each source of a batch.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Controls {
    /// Independent blocks: one less for each source of a batch.
    pub(super) blocks: u64,
    /// For every kind of surprise, the sum of squares.
    pub(super) squares: Vec<f64>,
    /// For every kind of surprise, the sums of its products with each scalar; nothing where it has not happened.
    pub(super) products: Vec<Vec<f64>>,
}

impl Controls {
    /// Adds those of the batches that follow.
    pub(crate) fn merge(&mut self, later: &Self) {
        self.blocks += later.blocks;
        add_all(&mut self.squares, &later.squares);
        self.products.resize_with(self.products.len().max(later.products.len()), Vec::new);
        self.products.iter_mut().zip(&later.products).for_each(|(own, later)| add_all(own, later));
    }

    /// Adds the products of surprises with scalars, times a factor.
    fn add_products(&mut self, layout: &Layout, [from, to]: [&[f64]; 2], factor: f64) {
        let slots = layout.sensor_slots();
        self.squares.resize(CONTROLS, 0.0);
        self.products.resize(CONTROLS, Vec::new());
        let both = self.squares.iter_mut().zip(&mut self.products);
        for ((square, products), slot) in both.zip(layout.control_slots()) {
            let surprise = to[slot] - from[slot];
            if surprise != 0.0 {
                *square += factor * surprise * surprise;
                products.resize(slots.len(), 0.0);
                let flux = to[slots.clone()].iter().zip(&from[slots.clone()]);
                let pairs = products.iter_mut().zip(flux);
                pairs.for_each(|(sum, (to, from))| *sum += factor * surprise * (to - from));
            }
        }
    }
}

/// Adds numbers one by one to others; a list that is too short is filled up with zeros.
fn add_all(own: &mut Vec<f64>, others: &[f64]) {
    own.resize(own.len().max(others.len()), 0.0);
    own.iter_mut().zip(others).for_each(|(own, other)| *own += other);
}

/// Blocks of the paths of a source in a batch.
#[derive(Debug)]
pub(crate) struct Blocks {
    /// Paths of a block.
    pub(super) size: usize,
    /// Paths of the block in progress.
    traced: usize,
    /// The scalars before the source, and before the block.
    before_source: Vec<f64>,
    before_block: Vec<f64>,
    /// Not centred yet.
    controls: Controls,
}

impl Blocks {
    /// No path yet, with these scalars.
    pub(crate) fn new(layout: &Layout, scalars: &[f64]) -> Self {
        let [least, most] = BLOCK_PATHS;
        let products = KINDS_OF_BLOCK * layout.sensor_slots().len();
        Self {
            size: (products / PRODUCTS_PER_PATH).next_power_of_two().clamp(least, most),
            traced: 0,
            before_source: scalars.to_vec(),
            before_block: scalars.to_vec(),
            controls: Controls::default(),
        }
    }

    /// Counts a path, after which the scalars are these.
    #[inline]
    pub(crate) fn count_path(&mut self, layout: &Layout, scalars: &[f64]) {
        self.traced += 1;
        if self.traced == self.size {
            self.end_block(layout, scalars);
        }
    }

    fn end_block(&mut self, layout: &Layout, scalars: &[f64]) {
        self.controls.add_products(layout, [&self.before_block, scalars], 1.0);
        self.controls.blocks += 1;
        self.before_block.copy_from_slice(scalars);
        self.traced = 0;
    }

    /// Ends a source: all its products, less those of the means. A block that is not full does not count.
    pub(crate) fn end_source(&mut self, layout: &Layout, scalars: &[f64]) -> Controls {
        let mut controls = mem::take(&mut self.controls);
        if controls.blocks > 0 {
            let factor = -1.0 / controls.blocks as f64;
            controls.add_products(layout, [&self.before_source, &self.before_block], factor);
            controls.blocks -= 1;
        }
        self.before_source.copy_from_slice(scalars);
        self.before_block.copy_from_slice(scalars);
        self.traced = 0;
        controls
    }
}
