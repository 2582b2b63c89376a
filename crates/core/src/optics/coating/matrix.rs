//! The characteristic matrices of films at one wavelength and one angle, docs/theory.md eq. (36).
//!
//! Every film keeps β = n sin θ, so that n cos θ is q = sqrt(N² - β²) with N = n - ik, where the wave depends on time by
//! exp(iωt). With the phase δ = 2π q d/λ and the admittance η = q (s) or N²/q (p), in units of that of free space, the
//! fields B and C on the near side of a film follow from those on its far side by the matrix
//! [[cos δ, i sin δ/η], [iη sin δ, cos δ]].

use crate::optics::Shares;
use crate::optics::coating::complex::Complex;

/// Phases below this have a sine by its series, whose next term is δ⁴/120; rad.
const SMALL_PHASE: f64 = 1e-4;
/// Squared fields beyond this are scaled down, so that no number of films makes them infinite.
const LARGE_FIELD: f64 = 1e60;

/// A film at one wavelength.
#[derive(Debug, Clone, Copy)]
pub(super) struct Film {
    /// Refractive index n - ik, 1.
    pub(super) index: Complex,
    /// Thickness in units of λ/2π, 1.
    pub(super) thickness: f64,
}

/// What leaves for light polarised perpendicular (s) and parallel (p) to the plane of incidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PolarisedShares {
    pub(super) s: Shares,
    pub(super) p: Shares,
}

impl PolarisedShares {
    /// Of light with this share of s, 1.
    pub(super) fn of(self, s_share: f64) -> Shares {
        self.s.scaled(s_share).plus(self.p.scaled(1.0 - s_share))
    }
}

/// Shares of light from a medium of index `from` that meets films in this order, before a medium of index `to`; `cos` is the
/// cosine of incidence. Nothing is transmitted under total reflection.
pub(super) fn shares(
    films: impl DoubleEndedIterator<Item = Film>,
    cos: f64,
    [from, to]: [f64; 2],
) -> PolarisedShares {
    let StackFields { s, p, beyond } = fields(films, cos, (from, Complex::real(to)));
    let normal = from * cos;
    PolarisedShares {
        s: s.shares([normal, 1.0], beyond.re),
        p: p.shares([from * from, normal], to * to * beyond.re),
    }
}

/// Fields before films of both polarisations, and q of the medium behind.
pub(super) struct StackFields {
    pub(super) s: WaveFields,
    pub(super) p: WaveFields,
    pub(super) beyond: Complex,
}

/// The fields before films in front of a medium, which may absorb.
pub(super) fn fields(
    films: impl DoubleEndedIterator<Item = Film>,
    cos: f64,
    (from, to): (f64, Complex),
) -> StackFields {
    let normal = from * cos;
    // q² from N², rather than through β², so that nothing cancels between equal indices.
    let normal_squared =
        |square: Complex| square - Complex::real(from * from) + Complex::real(normal * normal);
    let beyond = normal_squared(to * to).decaying_root();
    // Fields in the last medium: 1 and η, for p times q.
    let mut s = WaveFields::new(Complex::real(1.0), beyond);
    let mut p = WaveFields::new(beyond, to * to);
    for Film { index, thickness } in films.rev() {
        let square = index * index;
        let own = normal_squared(square);
        let phase = FilmPhase::new(own.decaying_root().scaled(thickness));
        // sin δ/q.
        let sine = phase.sinc.scaled(thickness);
        let (over, times) = (sine * own, sine * square);
        s = s.before(&phase, sine, over);
        p = p.before(&phase, over * square.inverse(), times);
    }
    StackFields { s, p, beyond }
}

/// The phase δ of a film; both functions are divided by exp(-Im δ), or thick metal would overflow.
struct FilmPhase {
    cos: Complex,
    /// sin δ/δ.
    sinc: Complex,
    /// Square of what they are divided by, inverse: exp(2 Im δ), 1.
    decay_squared: f64,
}

impl FilmPhase {
    fn new(phase: Complex) -> Self {
        let (sin, cos) = phase.re.sin_cos();
        let exponent = 2.0 * phase.im;
        // 1 - exp(2 Im δ); most films are clear.
        let (decay_squared, one_minus_decay_squared) =
            if exponent == 0.0 { (1.0, 0.0) } else { (exponent.exp(), -exponent.exp_m1()) };
        let sum = 1.0 + decay_squared;
        let sinc = if phase.norm_squared() < SMALL_PHASE * SMALL_PHASE {
            let series = Complex::real(1.0) - (phase * phase).scaled(1.0 / 6.0);
            series.scaled(decay_squared.sqrt())
        } else {
            Complex::new(0.5 * sum * sin, -0.5 * one_minus_decay_squared * cos) * phase.inverse()
        };
        Self {
            cos: Complex::new(0.5 * sum * cos, 0.5 * one_minus_decay_squared * sin),
            sinc,
            decay_squared,
        }
    }
}

/// Tangential fields B and C of one polarisation, up to a common factor.
pub(super) struct WaveFields {
    electric: Complex,
    magnetic: Complex,
    /// Square of the factor between these fields and those of a film before which they would be 1 and η, 1.
    scale: f64,
}

impl WaveFields {
    fn new(electric: Complex, magnetic: Complex) -> Self {
        Self { electric, magnetic, scale: 1.0 }
    }

    /// The fields on the near side of a film, whose matrix has i times these numbers beside the cosines.
    fn before(&self, phase: &FilmPhase, sine_over: Complex, sine_times: Complex) -> Self {
        let electric = phase.cos * self.electric + (sine_over * self.magnetic).times_i();
        let magnetic = (sine_times * self.electric).times_i() + phase.cos * self.magnetic;
        let scale = self.scale * phase.decay_squared;
        let size = electric.norm_squared() + magnetic.norm_squared();
        if size < LARGE_FIELD {
            return Self { electric, magnetic, scale };
        }
        let factor = 1.0 / size.sqrt();
        Self {
            electric: electric.scaled(factor),
            magnetic: magnetic.scaled(factor),
            scale: scale * factor * factor,
        }
    }

    /// Difference and sum of the fields before a medium of admittance `a/b`, whose ratio is the reflected amplitude.
    pub(super) fn differences(&self, [a, b]: [f64; 2]) -> [Complex; 2] {
        let (electric, magnetic) = (self.electric.scaled(a), self.magnetic.scaled(b));
        [electric - magnetic, electric + magnetic]
    }

    /// Shares before a medium of admittance `a/b`; `passing` is the real part of the last admittance, times the same factor
    /// as the first fields, 0 under total reflection.
    pub(super) fn shares(&self, [a, b]: [f64; 2], passing: f64) -> Shares {
        let [less, sum] = self.differences([a, b]).map(Complex::norm_squared);
        // Along the face.
        if sum == 0.0 {
            return Shares { reflected: 1.0, transmitted: 0.0 };
        }
        Shares { reflected: less / sum, transmitted: 4.0 * a * b * passing * self.scale / sum }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::fresnel;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Aluminium at 550 nm, n and k (Rakić, Appl. Opt. 34 (1995) 4755, rounded).
    const ALUMINIUM: [f64; 2] = [0.96, 6.69];

    /// A film of an optical thickness at normal incidence, waves.
    fn clear(index: f64, waves: f64) -> Film {
        Film { index: Complex::real(index), thickness: 2.0 * PI * waves / index }
    }

    fn absorbing([n, k]: [f64; 2], thickness: f64) -> Film {
        Film { index: Complex::new(n, -k), thickness }
    }

    fn of(films: &[Film], cos: f64, indices: [f64; 2]) -> PolarisedShares {
        shares(films.iter().copied(), cos, indices)
    }

    fn both(shares: PolarisedShares) -> [Shares; 2] {
        [shares.s, shares.p]
    }

    #[test]
    fn without_films_it_is_the_interface_of_fresnel() {
        for indices in [[1.0, 1.52], [1.52, 1.0], [1.33, 1.3]] {
            for cos in [1e-9, 1e-3, 0.2, 0.5, 0.7, 0.75, 0.9, 1.0] {
                let found = of(&[], cos, indices);
                let known = fresnel::dielectric(cos, indices[0], indices[1]);
                for (found, known) in [(found.s, known.s), (found.p, known.p)] {
                    assert!((found.reflected - known).abs() < 1e-12, "{indices:?}, {cos}");
                    assert!(
                        (found.transmitted - (1.0 - known)).abs() < 1e-12,
                        "{indices:?}, {cos}"
                    );
                }
            }
        }
    }

    #[test]
    fn equal_media_without_films_pass_all_light() {
        for cos in [1e-9, 0.01, 0.7, 1.0] {
            for shares in both(of(&[], cos, [1.5, 1.5])) {
                assert!((shares.transmitted - 1.0).abs() < 1e-12, "{cos}: {shares:?}");
            }
        }
    }

    #[test]
    fn a_quarter_wave_reflects_by_its_formula_and_a_half_wave_is_absent() {
        // Born & Wolf, 7th ed., 1.6.4: MgF2 on glass reflects 1.26 %.
        let (index, glass) = (1.38f64, 1.52);
        let known = ((glass - index * index) / (glass + index * index)).powi(2);
        for shares in both(of(&[clear(index, 0.25)], 1.0, [1.0, glass])) {
            assert!((shares.reflected - known).abs() < 1e-14, "{shares:?}");
            assert!((shares.transmitted - (1.0 - known)).abs() < 1e-14, "{shares:?}");
        }
        assert!((known - 0.012_600_8).abs() < 1e-7);
        let bare = both(of(&[], 1.0, [1.0, glass]));
        for (half, bare) in both(of(&[clear(2.3, 0.5)], 1.0, [1.0, glass])).iter().zip(bare) {
            assert!((half.reflected - bare.reflected).abs() < 1e-14, "{half:?}");
        }
    }

    #[test]
    fn a_quarter_wave_stack_reflects_by_its_formula() {
        let (high, low, glass) = (2.35f64, 1.46f64, 1.52f64);
        for pairs in [1, 3, 8] {
            // High, low, ..., high, from either side.
            let films: Vec<Film> = (0..2 * pairs + 1)
                .map(|i| if i % 2 == 0 { clear(high, 0.25) } else { clear(low, 0.25) })
                .collect();
            // The admittance seen from air, Macleod, chapter 5: (nH/nL)^(2N) nH²/ns.
            let admittance = (high / low).powi(2 * pairs) * high * high / glass;
            let known = ((1.0 - admittance) / (1.0 + admittance)).powi(2);
            for shares in both(of(&films, 1.0, [1.0, glass])) {
                assert!((shares.reflected - known).abs() < 1e-12, "{pairs}: {shares:?}, {known}");
            }
        }
    }

    #[test]
    fn thick_metal_is_the_metal_of_fresnel() {
        let [n, k] = ALUMINIUM;
        // The thicker one decays by far more than a number can hold.
        for thickness in [10.0, 1e5] {
            for cos in [1e-6, 0.1, 0.5, 0.9, 1.0] {
                for from in [1.0, 1.5] {
                    let found = of(&[absorbing(ALUMINIUM, thickness)], cos, [from, 1.0]);
                    let known = fresnel::conductor(cos, from, n, k);
                    for (found, known) in [(found.s, known.s), (found.p, known.p)] {
                        assert!(
                            (found.reflected - known).abs() < 1e-12,
                            "{cos}: {found:?}, {known}"
                        );
                        assert!(found.transmitted < 1e-50, "{cos}: {found:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn light_tunnels_through_a_gap_beyond_the_critical_angle() {
        // Frustrated total reflection of s-polarised light, Born & Wolf, 1.6: with p = n cos θ and the decay q of the gap,
        // 1/T = 1 + ((p² + q²)/(2pq) sinh(2πqd/λ))².
        let (cos, gap) = (0.5f64, 0.8);
        let p = 1.5 * cos;
        let q = (1.5f64.powi(2) * (1.0 - cos * cos) - 1.0).sqrt();
        let known = 1.0 / (1.0 + ((p * p + q * q) / (2.0 * p * q) * f64::sinh(q * gap)).powi(2));
        let films = [Film { index: Complex::real(1.0), thickness: gap }];
        let found = of(&films, cos, [1.5, 1.5]).s;
        assert!((found.transmitted - known).abs() < 1e-13, "{found:?}, {known}");
        assert!(known > 0.1 && known < 0.9);
    }

    #[test]
    fn metal_takes_light_under_total_reflection() {
        // Kretschmann's arrangement: 50 nm of silver between glass and air, at 633 nm; p-polarised light vanishes near 43 deg.
        let silver = absorbing([0.06, 4.28], 2.0 * PI * 50.0 / 633.0);
        let at = |deg: f64| of(&[silver], deg.to_radians().cos(), [1.515, 1.0]);
        let least = (4200..4500).map(|i| at(f64::from(i) / 100.0).p.reflected).fold(1.0, f64::min);
        assert!(least < 0.3, "{least}");
        assert_eq!(at(44.0).p.transmitted, 0.0);
        assert!(at(43.0).s.reflected > 0.9);
    }

    #[test]
    fn many_films_at_their_critical_angle_stay_finite() {
        let cos = (1.0 - (1.0 / 1.5f64).powi(2)).sqrt();
        let films = vec![Film { index: Complex::real(1.0), thickness: 1500.0 }; 200];
        for shares in both(of(&films, cos, [1.5, 1.5])) {
            assert!((shares.reflected + shares.transmitted - 1.0).abs() < 1e-6, "{shares:?}");
        }
    }

    fn films() -> impl Strategy<Value = Vec<Film>> {
        let film = (0.1..4.0f64, 0.0..6.0f64, 0.0..8.0f64, any::<bool>());
        prop::collection::vec(film, 0..8).prop_map(|films| {
            let made = films.into_iter().map(|(n, k, thickness, is_clear)| {
                let index = if is_clear { [1.0 + n, 0.0] } else { [n, k] };
                absorbing(index, if is_clear { thickness } else { 0.1 * thickness })
            });
            made.collect()
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(36), ..ProptestConfig::default() })]

        #[test]
        fn no_stack_makes_light_and_clear_ones_lose_none(
            films in films(), cos in 1e-4..1.0f64, from in 1.0..2.5f64, to in 1.0..2.5f64
        ) {
            let is_clear = films.iter().all(|film| film.index.im == 0.0);
            for shares in both(of(&films, cos, [from, to])) {
                prop_assert!(shares.reflected >= 0.0 && shares.transmitted >= 0.0);
                prop_assert!(shares.sum() <= 1.0 + 1e-9, "{shares:?}");
                prop_assert!(!is_clear || (shares.sum() - 1.0).abs() < 1e-9, "{shares:?}");
            }
        }

        #[test]
        fn a_stack_lets_the_same_share_through_both_ways(
            films in films(), cos in 1e-3..1.0f64, from in 1.0..2.5f64, to in 1.0..2.5f64
        ) {
            if let Some(cos_t) = fresnel::cos_transmitted(cos, from, to) {
                let there = of(&films, cos, [from, to]);
                let back = shares(films.iter().rev().copied(), cos_t, [to, from]);
                for (there, back) in both(there).iter().zip(both(back)) {
                    prop_assert!((there.transmitted - back.transmitted).abs() < 1e-9, "{there:?}, {back:?}");
                }
            }
        }

        #[test]
        fn films_of_one_index_are_one_film(
            n in 0.5..3.0f64, k in 0.0..3.0f64, one in 0.01..3.0f64, two in 0.01..3.0f64, cos in 1e-3..1.0f64
        ) {
            let (parts, whole) = ([absorbing([n, k], one), absorbing([n, k], two)], [absorbing([n, k], one + two)]);
            let (parts, whole) = (of(&parts, cos, [1.5, 1.0]), of(&whole, cos, [1.5, 1.0]));
            for (parts, whole) in both(parts).iter().zip(both(whole)) {
                prop_assert!((parts.reflected - whole.reflected).abs() < 1e-10);
                prop_assert!((parts.transmitted - whole.transmitted).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn at_grazing_incidence_all_light_is_reflected() {
        let films = [clear(1.38, 0.25), absorbing(ALUMINIUM, 0.1)];
        for cos in [0.0, 1e-300, FRAC_PI_2.cos()] {
            for shares in both(of(&films, cos, [1.0, 1.0])) {
                assert!((shares.reflected - 1.0).abs() < 1e-12, "{cos}: {shares:?}");
            }
        }
        assert_eq!(of(&[], 0.0, [1.2, 1.2]).s.reflected, 1.0);
    }
}
