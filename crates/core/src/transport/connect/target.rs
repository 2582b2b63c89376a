//! The choice of one target among several, for a vertex that is joined to it.

use glam::DVec3;

/// What a vertex can be joined to.
pub(super) trait Joinable {
    /// What a connection with a vertex can carry, roughly; only ratios matter.
    fn importance(&self, vertex: DVec3) -> f64;
}

/// The importance of all targets together: that of one over it is its chance.
pub(super) fn total_importance(targets: &[impl Joinable], vertex: DVec3) -> f64 {
    targets.iter().map(|one| one.importance(vertex)).sum()
}

/// A target chosen in proportion to its importance; `draw` is asked for a number of [0, 1) if there are several.
pub(super) fn choose<T: Joinable>(
    targets: &[T],
    vertex: DVec3,
    draw: impl FnOnce() -> f64,
) -> Option<&T> {
    if let [only] = targets {
        return Some(only);
    }
    let mut left = draw() * total_importance(targets, vertex);
    targets.iter().find(|one| {
        left -= one.importance(vertex);
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
        let chosen = |share| choose(&targets, DVec3::ZERO, || share).copied();
        assert_eq!(chosen(0.24), Some(1.0));
        assert_eq!(chosen(0.25), Some(3.0));
        assert_eq!(chosen(0.999), Some(3.0));
    }

    #[test]
    fn one_target_needs_no_draw_and_none_gives_none() {
        let drawn = || unreachable!("nothing to choose");
        assert_eq!(choose(&[2.0], DVec3::ZERO, drawn), Some(&2.0));
        assert_eq!(choose::<f64>(&[], DVec3::ZERO, || 0.5), None);
    }
}
