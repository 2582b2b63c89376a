//! Shares of the light of a path among the techniques that can find it.
//!
//! The balance heuristic (Veach & Guibas, SIGGRAPH 1995) divides light by the densities with which
//! the techniques sample a path. A density is given as the etendue that one sample of the technique
//! represents, its reciprocal; infinite for a technique that cannot find the path.

/// A way of finding light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Technique {
    /// A photon that a sensor counts, F.
    Photon,
    /// A photon that is joined to a sensor, FC.
    JoinedPhoton,
    /// A gather path that meets emission, B.
    GatherPath,
    /// A gather path that is joined to a source, BC.
    JoinedGatherPath,
    /// A photon and a record, VM.
    Pair,
}

impl Technique {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::Photon, Self::JoinedPhoton, Self::GatherPath, Self::JoinedGatherPath, Self::Pair];
}

/// How the light of a path is divided among the techniques that can find it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sharing {
    /// In proportion to their densities.
    #[default]
    Balanced,
    /// One of them counts, in full, the paths that another can find, and no others: to compare both.
    Only {
        /// The one that counts.
        counts: Technique,
        /// The one whose paths it counts.
        of: Technique,
    },
}

/// The etendues that weight a path, mm² sr.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Etendues {
    /// Of one photon, where the path starts: `1/(N p_e)`.
    pub(crate) photon: f64,
    /// Of one photon that is joined to the sensor at the last vertex.
    pub(crate) photon_joined: f64,
    /// Of one gather path, where the path ends: `1/(M p_g)`.
    pub(crate) gather: f64,
    /// The same; infinite if gather paths cannot meet the source.
    pub(crate) gather_met: f64,
    /// Of one gather path that is joined to the source at the first vertex.
    pub(crate) gather_joined: f64,
    /// G/q of the windows of records at all vertices that may have one.
    pub(crate) windows: f64,
}

impl Etendues {
    /// Those of light that only photons find.
    pub(crate) const PHOTON_ALONE: Self = Self {
        photon: 1.0,
        photon_joined: f64::INFINITY,
        gather: f64::INFINITY,
        gather_met: f64::INFINITY,
        gather_joined: f64::INFINITY,
        windows: 0.0,
    };

    /// From those of a photon and of a gather path, and what joining them to the sensor and to the source multiplies these by;
    /// `meets_source` if gather paths can meet the source.
    pub(crate) fn new(
        [photon, gather]: [f64; 2],
        meets_source: bool,
        [to_sensor, to_source]: [f64; 2],
        windows: f64,
    ) -> Self {
        Self {
            photon,
            photon_joined: photon * to_sensor,
            gather,
            gather_met: if meets_source { gather } else { f64::INFINITY },
            gather_joined: gather * to_source,
            windows,
        }
    }

    /// The share that a technique counts of a path that it has found, 1.
    pub(crate) fn share(&self, technique: Technique, sharing: Sharing) -> f64 {
        match sharing {
            Sharing::Balanced => {
                let all: f64 = Technique::ALL.iter().map(|&one| self.density(one)).sum();
                self.density(technique) / all
            }
            Sharing::Only { counts, of } => {
                f64::from(u8::from(counts == technique && self.density(of) > 0.0))
            }
        }
    }

    /// The share of a pair at a record with this G/q, one of those of the path, 1.
    pub(crate) fn share_of_pair(&self, window: f64, sharing: Sharing) -> f64 {
        if window > 0.0 {
            self.share(Technique::Pair, sharing) * window / self.windows
        } else {
            0.0
        }
    }

    /// Samples of a technique per etendue, 1/(mm² sr).
    fn density(&self, technique: Technique) -> f64 {
        match technique {
            Technique::Photon => 1.0 / self.photon,
            Technique::JoinedPhoton => 1.0 / self.photon_joined,
            Technique::GatherPath => 1.0 / self.gather_met,
            Technique::JoinedGatherPath => 1.0 / self.gather_joined,
            Technique::Pair => self.windows / (self.photon * self.gather),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NEVER: f64 = f64::INFINITY;

    #[test]
    fn a_path_that_only_one_technique_finds_is_all_its_own() {
        let nothing = Etendues {
            photon: NEVER,
            photon_joined: NEVER,
            gather: 3.0,
            gather_met: NEVER,
            gather_joined: NEVER,
            windows: 0.0,
        };
        let by_photon = Etendues { photon: 2.0, ..nothing };
        assert_eq!(by_photon.share(Technique::Photon, Sharing::Balanced), 1.0);
        let met = Etendues { gather_met: 3.0, windows: 5.0, ..nothing };
        let share = |technique| met.share(technique, Sharing::Balanced);
        assert_eq!(Technique::ALL.map(share), [0.0, 0.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn shares_are_the_balance_heuristic_and_add_up_to_one() {
        for (photon, gather) in [(1.0, 1.0), (3e-6, 20.0), (1e3, 4e-9)] {
            for [photon_joined, gather_joined] in
                [[NEVER, NEVER], [photon, NEVER], [1e-3 * photon, 1e5 * gather], [7.0, 1e-12]]
            {
                for (windows, gather_met) in
                    [(0.0, gather), (1.0, gather), (1e-9, NEVER), (1e9, gather)]
                {
                    let etendues = Etendues {
                        photon,
                        photon_joined,
                        gather,
                        gather_met,
                        gather_joined,
                        windows,
                    };
                    let own = Technique::ALL.map(|one| etendues.share(one, Sharing::Balanced));
                    assert!((own.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{etendues:?}: {own:?}");
                    // In proportion to their densities.
                    let sum: f64 = Technique::ALL.map(|one| etendues.density(one)).iter().sum();
                    for (share, technique) in own.into_iter().zip(Technique::ALL) {
                        let expected = etendues.density(technique) / sum;
                        assert!((share - expected).abs() < 1e-12, "{etendues:?}: {own:?}");
                    }
                    // Records of a path divide the share of pairs.
                    let parts = [0.3, 0.7]
                        .map(|part| etendues.share_of_pair(part * windows, Sharing::Balanced));
                    assert!((parts.iter().sum::<f64>() - own[4]).abs() < 1e-12, "{parts:?}");
                }
            }
        }
    }

    #[test]
    fn a_technique_alone_counts_the_paths_of_another_in_full() {
        let etendues = Etendues {
            photon: 2.0,
            photon_joined: 0.5,
            gather: 3.0,
            gather_met: 3.0,
            gather_joined: NEVER,
            windows: 0.0,
        };
        let share = |counts, of| etendues.share(counts, Sharing::Only { counts, of });
        assert_eq!(share(Technique::Photon, Technique::JoinedPhoton), 1.0);
        assert_eq!(share(Technique::Photon, Technique::JoinedGatherPath), 0.0);
        let other = Sharing::Only { counts: Technique::Photon, of: Technique::Photon };
        assert_eq!(etendues.share(Technique::GatherPath, other), 0.0);
    }
}
