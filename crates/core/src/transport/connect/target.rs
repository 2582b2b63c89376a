//! The choice of one target among several, for a vertex that is joined to it.

use glam::DVec3;

/// What a vertex can be joined to.
pub(super) trait Joinable {
    /// What a connection with a vertex can carry, roughly; only ratios matter.
    fn importance(&self, vertex: DVec3) -> f64;
}

/// The importance of all targets together.
pub(super) fn total_importance(targets: &[impl Joinable], vertex: DVec3) -> f64 {
    targets.iter().map(|one| one.importance(vertex)).sum()
}

/// The chance that a target is chosen among all, 1: a share `evenly` of it is the same for all, the rest in proportion to
/// its importance.
pub(super) fn chance<T: Joinable>(targets: &[T], target: &T, vertex: DVec3, evenly: f64) -> f64 {
    if targets.len() == 1 {
        return 1.0;
    }
    mixed(target.importance(vertex) / total_importance(targets, vertex), targets.len(), evenly)
}

fn mixed(share: f64, count: usize, evenly: f64) -> f64 {
    evenly / count as f64 + (1.0 - evenly) * share
}

/// A target chosen by its chance; `draw` is asked for a number of [0, 1) if there are several.
pub(super) fn choose<T: Joinable>(
    targets: &[T],
    vertex: DVec3,
    evenly: f64,
    draw: impl FnOnce() -> f64,
) -> Option<&T> {
    if let [only] = targets {
        return Some(only);
    }
    let total = total_importance(targets, vertex);
    let mut left = draw();
    targets.iter().find(|one| {
        left -= mixed(one.importance(vertex) / total, targets.len(), evenly);
        left < 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Joinable for f64 {
        fn importance(&self, _: DVec3) -> f64 {
            *self
        }
    }

    #[test]
    fn targets_are_chosen_in_proportion_to_their_importance() {
        let targets = [1.0, 3.0, 0.0];
        let chosen = |share| choose(&targets, DVec3::ZERO, 0.0, || share).copied();
        assert_eq!(chosen(0.24), Some(1.0));
        assert_eq!(chosen(0.25), Some(3.0));
        assert_eq!(chosen(0.999), Some(3.0));
        let chances = targets.map(|one| chance(&targets, &one, DVec3::ZERO, 0.0));
        assert_eq!(chances, [0.25, 0.75, 0.0]);
    }

    #[test]
    fn an_even_share_gives_targets_of_no_importance_a_chance() {
        let targets = [1.0, 3.0, 0.0];
        let chances = targets.map(|one| chance(&targets, &one, DVec3::ZERO, 0.6));
        assert!((chances.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!((chances[2] - 0.2).abs() < 1e-12, "{chances:?}");
        let chosen = |share| choose(&targets, DVec3::ZERO, 0.6, || share).copied();
        assert_eq!(chosen(0.799), Some(3.0));
        assert_eq!(chosen(0.801), Some(0.0));
    }

    #[test]
    fn one_target_needs_no_draw_and_none_gives_none() {
        let drawn = || unreachable!("nothing to choose");
        assert_eq!(choose(&[2.0], DVec3::ZERO, 0.0, drawn), Some(&2.0));
        assert_eq!(choose::<f64>(&[], DVec3::ZERO, 0.0, || 0.5), None);
    }
}
