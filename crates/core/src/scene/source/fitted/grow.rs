//! How a density tree is grown from rays and pruned by rays held back: a density estimation tree (P. Ram and A. Gray, Density
//! estimation trees, KDD 2011).

use crate::rng::{Dimension, Sampler, stream};

/// Coordinates in the cube, from 0 to 1.
pub(super) type Coordinates = [f64; 4];

/// A ray as a point of the cube.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed {
    pub(super) at: [f32; 4],
    pub(super) flux: f32,
    /// Not used for the cuts: it tells which of them are worth it.
    pub(super) is_held: bool,
}

/// A tree of cuts, not yet pruned.
#[derive(Debug, Clone)]
pub(super) struct Grown {
    /// Share of the light, 1.
    pub(super) share: f64,
    /// Mean squares of the density's relative deviations within the box along position and along direction, 1.
    squares: [f64; 2],
    /// `None` for a box that no penalty leaves cut.
    pub(super) cut: Option<Box<BoxCut>>,
}

/// A cut across one axis, into a lower and an upper part.
#[derive(Debug, Clone)]
pub(super) struct BoxCut {
    pub(super) axis: usize,
    pub(super) at: f64,
    /// For each penalty, whether it is worth it.
    is_worth: [bool; PENALTIES.len()],
    pub(super) parts: [Grown; 2],
}

/// Of a box, cut as each penalty has it.
#[derive(Debug, Clone, Copy)]
struct Scores {
    /// -∫ f² and the penalty, for the density f of the rays that decide on cuts.
    cost: [f64; PENALTIES.len()],
    /// ∫ f² - 2 Σ f over the rays held back: the integrated squared error but for a constant.
    risk: [f64; PENALTIES.len()],
}

/// Penalties on boxes, in units of the variance of their share over their volume. 2 makes the cost of given boxes the expectation of
/// the risk; boxes that are chosen by the same rays need more. The rays held back find the penalty of least risk of a tree.
const PENALTIES: [f64; 10] = [1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0];
/// Places along each axis at which a box may be cut, one step apart and shifted at random.
const PLACES: usize = 16;
/// A box with fewer rays is not cut.
const FEWEST: f64 = 8.0;
/// The narrowest side of a box that is cut: the coordinates of rays are in single precision.
const NARROWEST: f64 = 1.0 / (1 << 18) as f64;
/// Chi-square, with one degree of freedom, from which on two parts of a box differ for sure: 1 in 2000 for one place.
const DIFFERENT: f64 = 12.0;
/// Boxes with more rays are cut on several threads.
const MANY: usize = 10_000;

/// A box of the cube.
#[derive(Debug, Clone, Copy)]
struct CubePart {
    from: Coordinates,
    to: Coordinates,
    /// The parts of box n are 2n and 2n + 1, without what overflows.
    number: u64,
}

/// Sums over rays.
#[derive(Debug, Clone, Copy, Default)]
struct FluxSums {
    flux: f64,
    squares: f64,
}

/// What all boxes of a tree share.
#[derive(Debug)]
struct Growth {
    /// Number of the tree: each has cuts of its own, so that borders are smooth in the mean of trees.
    tree: u64,
    /// All rays that decide on cuts.
    own: FluxSums,
    /// Those held back.
    held: FluxSums,
}

/// Grows and prunes a tree of rays.
pub(super) fn grow(rays: &mut [Placed], tree: u64) -> Grown {
    let [own, held] = FluxSums::of_both(rays);
    let whole = CubePart { from: [0.0; 4], to: [1.0; 4], number: 1 };
    let (grown, scores) = Growth { tree, own, held }.grow_in(rays, &whole);
    let best = (1..PENALTIES.len())
        .fold(0, |best, other| if scores.risk[other] < scores.risk[best] { other } else { best });
    // What sampling leaves in single boxes is lost in the sum over many of them that a sensor sees; what is smoothed away is not.
    let finer = 0.5 * PENALTIES[best];
    grown.pruned(PENALTIES.partition_point(|penalty| *penalty <= finer).saturating_sub(1))
}

impl Grown {
    /// Number of boxes.
    pub(super) fn boxes(&self) -> usize {
        self.cut.as_ref().map_or(1, |cut| cut.parts.iter().map(Self::boxes).sum())
    }

    /// Mean squares of the density's relative deviations within boxes along position and along direction, over the light, 1.
    pub(super) fn variation(&self) -> [f64; 2] {
        let Some(cut) = &self.cut else { return self.squares.map(|square| self.share * square) };
        let [lower, upper] = cut.parts.each_ref().map(Self::variation);
        [lower[0] + upper[0], lower[1] + upper[1]]
    }

    /// Without cuts that are not worth a penalty.
    fn pruned(self, penalty: usize) -> Self {
        let cut = self.cut.filter(|cut| cut.is_worth[penalty]).map(|mut cut| {
            cut.parts = cut.parts.map(|part| part.pruned(penalty));
            cut
        });
        Self { cut, ..self }
    }
}

impl Growth {
    fn grow_in(&self, rays: &mut [Placed], cell: &CubePart) -> (Grown, Scores) {
        let [own, held] = FluxSums::of_both(rays);
        let share = (own.flux + held.flux) / (self.own.flux + self.held.flux);
        let mut grown = Grown { share, squares: deviations(rays, cell), cut: None };
        let whole = self.scores(own, held, cell);
        let cut = (own.count() >= FEWEST).then(|| self.cut(rays, cell, own)).flatten();
        let Some((axis, at)) = cut else { return (grown, whole) };
        let [below, above] = cell.cut(axis, at);
        let middle = partition(rays, |ray| f64::from(ray.at[axis]) < at);
        let (lower, upper) = rays.split_at_mut(middle);
        let (lower, upper) = if lower.len().max(upper.len()) > MANY {
            rayon::join(|| self.grow_in(lower, &below), || self.grow_in(upper, &above))
        } else {
            (self.grow_in(lower, &below), self.grow_in(upper, &above))
        };
        let (parts, of_parts) = ([lower.0, upper.0], [lower.1, upper.1]);
        let sum = |of: fn(&Scores) -> &[f64; PENALTIES.len()], penalty: usize| {
            of(&of_parts[0])[penalty] + of(&of_parts[1])[penalty]
        };
        let is_worth = std::array::from_fn(|penalty| {
            sum(|scores| &scores.cost, penalty) < whole.cost[penalty]
        });
        let best = |of: fn(&Scores) -> &[f64; PENALTIES.len()]| {
            std::array::from_fn(|penalty| {
                if is_worth[penalty] { sum(of, penalty) } else { of(&whole)[penalty] }
            })
        };
        let scores =
            Scores { cost: best(|scores| &scores.cost), risk: best(|scores| &scores.risk) };
        if is_worth.contains(&true) {
            grown.cut = Some(Box::new(BoxCut { axis, at, is_worth, parts }));
        }
        (grown, scores)
    }

    /// Of a box that is not cut.
    fn scores(&self, own: FluxSums, held: FluxSums, cell: &CubePart) -> Scores {
        let share_of =
            |part: FluxSums, all: FluxSums| if all.flux > 0.0 { part.flux / all.flux } else { 0.0 };
        let [own, held] = [share_of(own, self.own), share_of(held, self.held)];
        let volume = cell.volume();
        let variance = if own > 0.0 { own / self.own.count() } else { 0.0 };
        Scores {
            cost: PENALTIES.map(|penalty| (penalty * variance - own * own) / volume),
            risk: [own * (own - 2.0 * held) / volume; PENALTIES.len()],
        }
    }

    /// Where to cut: where the parts differ most, or, if they do not differ for sure, about the middle of the longest side, as a density that
    /// depends on several coordinates at once may look even along each. `None` for a box that is too narrow.
    fn cut(&self, rays: &[Placed], cell: &CubePart, own: FluxSums) -> Option<(usize, f64)> {
        let mut sampler = Sampler::for_path(self.tree, stream::CUTS, cell.number);
        let shift = 0.25 + 0.5 * sampler.one(Dimension::Resampling);
        let mut by_place = [[0.0; PLACES + 1]; 4];
        for ray in rays.iter().filter(|ray| !ray.is_held) {
            for (axis, by_place) in by_place.iter_mut().enumerate() {
                let place = cell.within(axis, ray.at[axis]) * PLACES as f64 + 1.0 - shift;
                by_place[(place as usize).min(PLACES)] += f64::from(ray.flux);
            }
        }
        let mut best = (DIFFERENT, None);
        for (axis, by_place) in by_place.iter().enumerate() {
            if cell.side(axis) < NARROWEST {
                continue;
            }
            let mut below = 0.0;
            for (place, flux) in by_place[..PLACES].iter().enumerate() {
                below += flux;
                let even = (place as f64 + shift) / PLACES as f64;
                let share = below / own.flux;
                let square = own.count() * (share - even).powi(2) / (even * (1.0 - even));
                if square > best.0 {
                    best = (square, Some((axis, even)));
                }
            }
        }
        let longest = || {
            let longer = |best, axis| if cell.side(axis) > cell.side(best) { axis } else { best };
            let longest = (1..4).fold(0, longer);
            let even = 0.25 + 0.5 * sampler.one(Dimension::Resampling);
            (cell.side(longest) >= NARROWEST).then_some((longest, even))
        };
        let (axis, even) = best.1.or_else(longest)?;
        Some((axis, cell.from[axis] + even * cell.side(axis)))
    }
}

/// Mean square of the relative deviations within a box along position and direction, from the difference of its halves without what
/// chance adds; of a density that is linear along an axis, the mean square is 4/3 of the square of that difference.
fn deviations(rays: &[Placed], cell: &CubePart) -> [f64; 2] {
    let all = FluxSums::of(rays, |_| true);
    let pairs = all.flux * all.flux - all.squares;
    if pairs <= 1e-9 * all.squares {
        return [0.0; 2];
    }
    let along = |axis: usize| {
        let middle = 0.5 * (cell.from[axis] + cell.to[axis]);
        let lower = FluxSums::of(rays, |ray| f64::from(ray.at[axis]) < middle).flux;
        let difference = all.flux - 2.0 * lower;
        4.0 / 3.0 * (difference * difference - all.squares) / pairs
    };
    [along(0) + along(1), along(2) + along(3)]
}

/// Moves what is wanted to the front, and says how many that are.
fn partition(rays: &mut [Placed], is_wanted: impl Fn(&Placed) -> bool) -> usize {
    let mut wanted = 0;
    for place in 0..rays.len() {
        if is_wanted(&rays[place]) {
            rays.swap(wanted, place);
            wanted += 1;
        }
    }
    wanted
}

impl CubePart {
    fn volume(&self) -> f64 {
        (0..4).map(|axis| self.side(axis)).product()
    }

    fn side(&self, axis: usize) -> f64 {
        self.to[axis] - self.from[axis]
    }

    /// Where in its side a coordinate lies, 0 to 1.
    fn within(&self, axis: usize, at: f32) -> f64 {
        (f64::from(at) - self.from[axis]) / self.side(axis)
    }

    fn cut(&self, axis: usize, at: f64) -> [Self; 2] {
        let (mut below, mut above) = (*self, *self);
        below.to[axis] = at;
        above.from[axis] = at;
        below.number = self.number.wrapping_mul(2);
        above.number = below.number.wrapping_add(1);
        [below, above]
    }
}

impl FluxSums {
    /// Over the rays that decide on cuts, and over those held back.
    fn of_both(rays: &[Placed]) -> [Self; 2] {
        [false, true].map(|is_held| Self::of(rays, |ray| ray.is_held == is_held))
    }

    fn of(rays: &[Placed], is_wanted: impl Fn(&Placed) -> bool) -> Self {
        rays.iter().filter(|ray| is_wanted(ray)).fold(Self::default(), |sums, ray| {
            let flux = f64::from(ray.flux);
            Self { flux: sums.flux + flux, squares: sums.squares + flux * flux }
        })
    }

    /// Number of equal rays with the same variance.
    fn count(&self) -> f64 {
        if self.squares > 0.0 { self.flux * self.flux / self.squares } else { 0.0 }
    }
}
