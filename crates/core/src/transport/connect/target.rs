//! The choice of one target among several, for a vertex that is joined to it.
//!
//! Targets are kept in a binary tree, so the cost of a choice grows with the logarithm of their number (Conty Estevez & Kulla,
//! "Importance sampling of many lights with adaptive tree splitting", Proc. ACM Comput. Graph. Interact. Tech. 1 (2018) 25). Up
//! to eight targets are chosen in proportion to their importance, more than eight approximately so. In either case
//! [`Targets::chance`] is the exact probability of the choice.

use glam::DVec3;
use std::ops::Range;

/// Largest number of targets in a leaf.
const LEAF: usize = 8;

/// What a vertex can be joined to.
pub(super) trait Joinable {
    /// Its number in the scene, among its kind.
    fn number(&self) -> usize;

    /// What a connection with it can carry.
    fn importance(&self) -> Importance;
}

/// What a connection with a vertex can carry, roughly: `anywhere + strength / d²`; only ratios matter.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Importance {
    /// The part that does not depend on the position of the vertex.
    pub(super) anywhere: f64,
    /// Factor of 1/d², with the distance d from the centre in mm.
    pub(super) strength: f64,
    /// Centre of a ball around the target, mm.
    pub(super) center: DVec3,
    /// Radius of the ball, mm; d is at least this.
    pub(super) reach: f64,
}

/// Targets that are chosen by chances.
#[derive(Debug)]
pub(super) struct Targets<T> {
    /// In the order of the leaves, so that the targets of every node are neighbours.
    all: Vec<(T, Importance)>,
    /// Index into `all`, by number in the scene.
    places: Vec<Option<usize>>,
    root: Subtree,
    /// Fraction of the choices that are uniform, 1; the others go by importance.
    evenly: f64,
}

/// A node of the tree, with all targets below it.
#[derive(Debug)]
struct Subtree {
    places: Range<usize>,
    importance: Importance,
    children: Option<Box<[Subtree; 2]>>,
}

impl<T: Joinable> Targets<T> {
    /// A tree of targets. A fraction `evenly` of the choices, 1, is uniform.
    pub(super) fn new(targets: impl Iterator<Item = T>, evenly: f64) -> Self {
        let mut all: Vec<(T, Importance)> = targets
            .map(|target| {
                let importance = target.importance();
                (target, importance)
            })
            .collect();
        let root = Subtree::new(&mut all, 0);
        let count = all.iter().map(|(target, _)| target.number() + 1).max();
        let mut places = vec![None; count.unwrap_or(0)];
        for (place, (target, _)) in all.iter().enumerate() {
            places[target.number()] = Some(place);
        }
        Self { all, places, root, evenly }
    }

    /// Number of targets.
    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    /// The target with a number of the scene.
    pub(super) fn numbered(&self, number: usize) -> Option<&T> {
        self.place(number).map(|place| &self.all[place].0)
    }

    fn place(&self, number: usize) -> Option<usize> {
        *self.places.get(number)?
    }

    /// The chance that a target is chosen among all, 1.
    pub(super) fn chance(&self, target: &T, vertex: DVec3) -> f64 {
        let Some(place) = self.place(target.number()) else { return 0.0 };
        if self.len() == 1 {
            return 1.0;
        }
        let (mut node, mut share) = (&self.root, 1.0);
        while let Some(children) = &node.children {
            let chosen = usize::from(!children[0].places.contains(&place));
            share *= shares(children, vertex)[chosen];
            node = &children[chosen];
        }
        let importance = |place: usize| self.all[place].1.at(vertex);
        let total = node.places.clone().map(importance).sum::<f64>();
        self.mixed(1, share * share_of(importance(place), total, node.places.len()))
    }

    /// A target chosen by its chance; `draw` is asked for a number of [0, 1) unless there is exactly one.
    pub(super) fn choose(&self, vertex: DVec3, draw: impl FnOnce() -> f64) -> Option<&T> {
        if let [(only, _)] = &self.all[..] {
            return Some(only);
        }
        let (mut node, mut share, mut left) = (&self.root, 1.0, draw());
        while let Some(children) = &node.children {
            let of_children = shares(children, vertex).map(|of_child| share * of_child);
            let low = self.mixed(children[0].places.len(), of_children[0]);
            let chosen = usize::from(left >= low);
            left -= if chosen == 1 { low } else { 0.0 };
            (node, share) = (&children[chosen], of_children[chosen]);
        }
        let leaf = &self.all[node.places.clone()];
        let total: f64 = leaf.iter().map(|(_, one)| one.at(vertex)).sum();
        let chosen = leaf.iter().find(|(_, one)| {
            left -= self.mixed(1, share * share_of(one.at(vertex), total, leaf.len()));
            left < 0.0
        });
        chosen.map(|(target, _)| target)
    }

    /// The probability that one of `count` targets is chosen, which together have this share of the importance, 1.
    fn mixed(&self, count: usize, share: f64) -> f64 {
        self.evenly * count as f64 / self.len() as f64 + (1.0 - self.evenly) * share
    }
}

/// Shares of two nodes in what both can carry, 1.
fn shares(nodes: &[Subtree; 2], vertex: DVec3) -> [f64; 2] {
    let [low, high] = nodes.each_ref().map(|node| node.importance.at(vertex));
    [low, high].map(|one| share_of(one, low + high, 2))
}

/// Share of one of some nodes or targets in what all can carry, 1; equal where none can carry anything.
fn share_of(importance: f64, total: f64, count: usize) -> f64 {
    if total > 0.0 { importance / total } else { 1.0 / count as f64 }
}

impl Subtree {
    /// The node of these targets, the first of which has the index `first`; sorts them into the order of its leaves.
    fn new<T>(targets: &mut [(T, Importance)], first: usize) -> Self {
        let importance = Importance::of_all(targets.iter().map(|(_, one)| one));
        let places = first..first + targets.len();
        let children = (targets.len() > LEAF).then(|| {
            let centers = || targets.iter().map(|(_, one)| one.center);
            let low = centers().fold(DVec3::INFINITY, DVec3::min);
            let axis = (centers().fold(DVec3::NEG_INFINITY, DVec3::max) - low).max_position();
            targets.sort_by(|(_, a), (_, b)| a.center[axis].total_cmp(&b.center[axis]));
            let (low, high) = targets.split_at_mut(targets.len() / 2);
            let middle = first + low.len();
            Box::new([Self::new(low, first), Self::new(high, middle)])
        });
        Self { places, importance, children }
    }
}

impl Importance {
    /// At a vertex.
    fn at(&self, vertex: DVec3) -> f64 {
        if self.strength == 0.0 {
            return self.anywhere;
        }
        let square = vertex.distance_squared(self.center).max(self.reach * self.reach);
        self.anywhere + self.strength / square
    }

    /// That of several targets together, with a ball that contains theirs.
    fn of_all<'a>(targets: impl Iterator<Item = &'a Self> + Clone) -> Self {
        let near = || targets.clone().filter(|one| one.strength > 0.0);
        let anywhere = targets.clone().map(|one| one.anywhere).sum();
        let low = near().map(|one| one.center - one.reach).reduce(DVec3::min);
        let high = near().map(|one| one.center + one.reach).reduce(DVec3::max);
        let (Some(low), Some(high)) = (low, high) else {
            return Self { anywhere, ..Self::default() };
        };
        Self {
            anywhere,
            strength: near().map(|one| one.strength).sum(),
            center: 0.5 * (low + high),
            reach: 0.5 * (high - low).length(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Dimension, Sampler};

    #[derive(Debug, Clone, Copy, PartialEq)]
    struct Ball(usize, f64, DVec3);

    impl Joinable for Ball {
        fn number(&self) -> usize {
            self.0
        }

        fn importance(&self) -> Importance {
            Importance { strength: self.1, center: self.2, reach: 1.0, ..Importance::default() }
        }
    }

    /// Balls of these strengths around the origin.
    fn targets(strengths: &[f64], evenly: f64) -> Targets<Ball> {
        let ball = |(number, &strength)| Ball(number, strength, DVec3::ZERO);
        Targets::new(strengths.iter().enumerate().map(ball), evenly)
    }

    fn chosen(targets: &Targets<Ball>, drawn: f64) -> Option<usize> {
        targets.choose(DVec3::ZERO, || drawn).map(|one| one.0)
    }

    fn chances(targets: &Targets<Ball>) -> Vec<f64> {
        let of_number = |number| targets.chance(targets.numbered(number).unwrap(), DVec3::ZERO);
        (0..targets.len()).map(of_number).collect()
    }

    #[test]
    fn targets_are_chosen_in_proportion_to_their_importance() {
        let targets = targets(&[1.0, 3.0, 0.0], 0.0);
        assert_eq!([0.24, 0.25, 0.999].map(|drawn| chosen(&targets, drawn)), [0, 1, 1].map(Some));
        assert_eq!(chances(&targets), [0.25, 0.75, 0.0]);
    }

    #[test]
    fn an_even_share_gives_targets_of_no_importance_a_chance() {
        let targets = targets(&[1.0, 3.0, 0.0], 0.6);
        let chances = chances(&targets);
        assert!((chances.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!((chances[2] - 0.2).abs() < 1e-12, "{chances:?}");
        assert_eq!([0.799, 0.801].map(|drawn| chosen(&targets, drawn)), [1, 2].map(Some));
    }

    #[test]
    fn one_target_needs_no_draw_and_none_gives_none() {
        let drawn = || unreachable!("nothing to choose");
        let one = |targets: &Targets<Ball>| targets.choose(DVec3::ZERO, drawn).map(|one| one.0);
        assert_eq!(one(&targets(&[2.0], 0.0)), Some(0));
        assert_eq!(chosen(&targets(&[], 0.0), 0.5), None);
        assert_eq!(targets(&[], 0.0).numbered(0), None);
    }

    #[test]
    fn targets_that_can_carry_nothing_are_chosen_alike() {
        for count in [3, 20] {
            let chances = chances(&targets(&vec![0.0; count], 0.0));
            assert!((chances.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{chances:?}");
        }
    }

    #[test]
    fn many_targets_are_chosen_as_often_as_their_chances_say() {
        let mut sampler = Sampler::for_path(7, 0, 0);
        let mut one = || sampler.one(Dimension::Resampling);
        let balls: Vec<Ball> = (0..100)
            .map(|i| Ball(2 * i, 0.1 + one(), 50.0 * DVec3::new(one(), one(), 0.2 * one())))
            .collect();
        let vertex = DVec3::new(10.0, 30.0, 2.0);
        for evenly in [0.0, 0.5] {
            let targets = Targets::new(balls.iter().copied(), evenly);
            assert!(balls.iter().all(|ball| targets.numbered(ball.0) == Some(ball)));
            assert_eq!(targets.numbered(1), None);
            let chances: Vec<f64> = balls.iter().map(|ball| targets.chance(ball, vertex)).collect();
            assert!((chances.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            // Every chance is the length of the interval of draws that choose the target.
            let draws = 200_000;
            let mut counts = vec![0; 100];
            for draw in 0..draws {
                let share = (f64::from(draw) + 0.5) / f64::from(draws);
                counts[targets.choose(vertex, || share).unwrap().0 / 2] += 1;
            }
            for (count, chance) in counts.iter().zip(&chances) {
                assert!((f64::from(*count) - chance * f64::from(draws)).abs() < 1.0 + 1e-6);
            }
            // Chances follow the importance: not far from those of the list without a tree.
            let total: f64 = balls.iter().map(|ball| ball.importance().at(vertex)).sum();
            let far = |(ball, chance): (&Ball, &f64)| {
                let alone = targets.mixed(1, ball.importance().at(vertex) / total);
                (chance / alone).max(alone / chance)
            };
            let farthest = balls.iter().zip(&chances).map(far).fold(0.0, f64::max);
            assert!(farthest < 4.0, "{farthest}");
        }
    }
}
