//! Shares of the light of a path among the techniques that can find it.
//!
//! The balance heuristic (Veach & Guibas, SIGGRAPH 1995) divides light by the densities with which
//! the techniques sample a path. A density is given as the etendue that one sample of the technique
//! represents, its reciprocal; infinite for a technique that cannot find the path.

/// The etendues that weight a path, mm² sr.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Etendues {
    /// Of one photon that is counted, where the path starts: `1/(N p_e)`.
    pub(crate) photon: f64,
    /// Of one photon that is joined to the sensor at the last vertex.
    pub(crate) photon_joined: f64,
    /// Of one gather path that meets emission, where the path ends: `1/(M p_g)`.
    pub(crate) gather: f64,
    /// Of one gather path that is joined to the source at the first vertex.
    pub(crate) gather_joined: f64,
    /// Etendue of the window at the record over the probability of the lobe there, G/q; 0 for
    /// paths without a record.
    pub(crate) window: f64,
}

impl Etendues {
    /// Those of a path that no technique joins.
    pub(crate) fn unjoined(photon: f64, gather: f64, window: f64) -> Self {
        let never = f64::INFINITY;
        Self { photon, photon_joined: never, gather, gather_joined: never, window }
    }

    /// The share of a photon that the sensor counts, 1.
    pub(crate) fn forward(&self) -> f64 {
        let Self { photon, photon_joined, gather, gather_joined, window } = *self;
        let others = ratios(photon, [photon_joined, gather, gather_joined]);
        1.0 / (1.0 + others + window / gather)
    }

    /// The share of a photon that is joined to the sensor, 1.
    pub(crate) fn forward_joined(&self) -> f64 {
        let Self { photon, photon_joined, gather, gather_joined, window } = *self;
        let others = ratios(photon_joined, [photon, gather, gather_joined]);
        1.0 / (1.0 + others + photon_joined / photon * window / gather)
    }

    /// The share of a gather path that meets emission, 1.
    pub(crate) fn backward(&self) -> f64 {
        self.mirrored().forward()
    }

    /// The share of a gather path that is joined to the source, 1.
    pub(crate) fn backward_joined(&self) -> f64 {
        self.mirrored().forward_joined()
    }

    /// The share of a photon and a record together, 1.
    pub(crate) fn pair(&self) -> f64 {
        let Self { photon, photon_joined, gather, gather_joined, window } = *self;
        if window == 0.0 {
            return 0.0;
        }
        let own = photon / window * gather;
        1.0 / (1.0 + ratios(own, [photon, photon_joined, gather, gather_joined]))
    }

    /// The same path seen from its other end.
    fn mirrored(&self) -> Self {
        let Self { photon, photon_joined, gather, gather_joined, window } = *self;
        Self {
            photon: gather,
            photon_joined: gather_joined,
            gather: photon,
            gather_joined: photon_joined,
            window,
        }
    }
}

/// The densities of other techniques over the own: eq. (21).
fn ratios<const N: usize>(own: f64, others: [f64; N]) -> f64 {
    others.iter().filter(|other| other.is_finite()).map(|other| own / other).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The shares of all techniques.
    fn shares(etendues: &Etendues) -> [f64; 5] {
        let Etendues { photon_joined, gather_joined, .. } = *etendues;
        let if_finite = |etendue: f64, share: f64| if etendue.is_finite() { share } else { 0.0 };
        [
            etendues.forward(),
            if_finite(photon_joined, etendues.forward_joined()),
            etendues.backward(),
            if_finite(gather_joined, etendues.backward_joined()),
            etendues.pair(),
        ]
    }

    #[test]
    fn a_path_that_only_one_technique_finds_is_all_its_own() {
        let never = f64::INFINITY;
        assert_eq!(Etendues::unjoined(2.0, never, 0.0).forward(), 1.0);
        let met = Etendues::unjoined(never, 3.0, 0.0);
        assert_eq!((met.backward(), met.forward()), (1.0, 0.0));
    }

    #[test]
    fn shares_are_the_balance_heuristic_and_add_up_to_one() {
        let never = f64::INFINITY;
        for (photon, gather) in [(1.0, 1.0), (3e-6, 20.0), (1e3, 4e-9)] {
            for [photon_joined, gather_joined] in
                [[never, never], [photon, never], [1e-3 * photon, 1e5 * gather], [7.0, 1e-12]]
            {
                for window in [0.0, 1.0, 1e-9, 1e9] {
                    let etendues =
                        Etendues { photon, photon_joined, gather, gather_joined, window };
                    let own = shares(&etendues);
                    assert!((own.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{etendues:?}: {own:?}");
                    // In proportion to their densities.
                    let pair = window / (photon * gather);
                    let densities = [
                        1.0 / photon,
                        1.0 / photon_joined,
                        1.0 / gather,
                        1.0 / gather_joined,
                        pair,
                    ];
                    let sum: f64 = densities.iter().sum();
                    for (share, density) in own.into_iter().zip(densities) {
                        assert!((share - density / sum).abs() < 1e-12, "{etendues:?}: {own:?}");
                    }
                }
            }
        }
    }
}
