//! Fresnel's equations for a plane interface, for s and p polarised and for unpolarised light.
//!
//! Source: Born & Wolf, Principles of Optics, 7th ed., section 1.5 (dielectrics) and 14.2 (metals).

use glam::DVec3;

/// Reflectances for light polarised perpendicular (s) and parallel (p) to the plane of incidence;
/// 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polarised {
    /// Reflectance of s-polarised light.
    pub s: f64,
    /// Reflectance of p-polarised light.
    pub p: f64,
}

impl Polarised {
    /// Reflectance of unpolarised light, (s + p)/2.
    #[inline]
    pub fn unpolarised(self) -> f64 {
        0.5 * (self.s + self.p)
    }

    /// Reflectance of light with this share of s, 1.
    #[inline]
    pub(crate) fn of(self, s_share: f64) -> f64 {
        s_share * self.s + (1.0 - s_share) * self.p
    }
}

/// Cosine of the refracted angle by Snell's law, or `None` under total internal reflection.
/// `cos_i` is the cosine of incidence in the medium of index `n_i`, in 0..=1.
#[inline]
pub(crate) fn cos_transmitted(cos_i: f64, n_i: f64, n_t: f64) -> Option<f64> {
    let eta = n_i / n_t;
    let sin2_t = eta * eta * (1.0 - cos_i * cos_i).max(0.0);
    (sin2_t < 1.0).then(|| (1.0 - sin2_t).sqrt())
}

/// Reflectances of a lossless dielectric interface (Born & Wolf 1.5.2, eq. 21a and 35), 1 under total reflection.
pub fn dielectric(cos_i: f64, n_i: f64, n_t: f64) -> Polarised {
    match cos_transmitted(cos_i, n_i, n_t) {
        None => Polarised { s: 1.0, p: 1.0 },
        Some(cos_t) => dielectric_refracting(cos_i, cos_t, n_i, n_t),
    }
}

/// Like [`dielectric`], for a known refracted angle.
#[inline]
pub(crate) fn dielectric_refracting(cos_i: f64, cos_t: f64, n_i: f64, n_t: f64) -> Polarised {
    let (s_less, s_sum) = (n_i * cos_i - n_t * cos_t, n_i * cos_i + n_t * cos_t);
    let (p_less, p_sum) = (n_t * cos_i - n_i * cos_t, n_t * cos_i + n_i * cos_t);
    // One division for both, since it is on the critical path of a bounce.
    let inverse = 1.0 / (s_sum * p_sum);
    let (s, p) = (s_less * p_sum * inverse, p_less * s_sum * inverse);
    Polarised { s: s * s, p: p * p }
}

/// Reflectances of a metal of complex index `n + i k` met from a dielectric of index `n_i`
/// (Born & Wolf 14.2, eq. 9 to 14, written with the real and imaginary part of n cos θ).
pub fn conductor(cos_i: f64, n_i: f64, n: f64, k: f64) -> Polarised {
    let (n, k) = (n / n_i, k / n_i);
    let sin2 = 1.0 - cos_i * cos_i;
    // a² and b²: real and imaginary part of sqrt((n + ik)² - sin²), squared.
    let real = n * n - k * k - sin2;
    let modulus = (real * real + 4.0 * n * n * k * k).sqrt();
    let a = (0.5 * (modulus + real)).max(0.0).sqrt();
    let s =
        (modulus + cos_i * cos_i - 2.0 * a * cos_i) / (modulus + cos_i * cos_i + 2.0 * a * cos_i);
    let tan2_sin2 = modulus * cos_i * cos_i + sin2 * sin2;
    let cross = 2.0 * a * cos_i * sin2;
    let p = s * (tan2_sin2 - cross) / (tan2_sin2 + cross);
    Polarised { s, p }
}

/// Angle of incidence at which p-polarised light is not reflected, rad.
pub fn brewster_angle(n_i: f64, n_t: f64) -> f64 {
    (n_t / n_i).atan()
}

/// Smallest angle of total internal reflection, rad; `None` when the second medium is the denser one.
pub fn critical_angle(n_i: f64, n_t: f64) -> Option<f64> {
    (n_t < n_i).then(|| (n_t / n_i).asin())
}

/// Direction mirrored at a unit normal, whichever way that points.
#[inline]
pub(crate) fn mirrored(dir: DVec3, normal: DVec3) -> DVec3 {
    dir - 2.0 * dir.dot(normal) * normal
}

/// Refracted direction; `normal` points against `dir`.
#[inline]
pub(crate) fn refracted(dir: DVec3, normal: DVec3, cos_i: f64, cos_t: f64, eta: f64) -> DVec3 {
    eta * dir + (eta * cos_i - cos_t) * normal
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Transmittance of a clear plate of index 1.49 at an angle of incidence, with all orders: (1 -
    /// R)/(1 + R), the mean of both polarisations, and the value for light that is unpolarised at
    /// each of the two faces.
    fn plate(cos_i: f64) -> [f64; 2] {
        let through = |r: f64| (1.0 - r) / (1.0 + r);
        let face = dielectric(cos_i, 1.0, 1.49);
        [0.5 * (through(face.s) + through(face.p)), through(face.unpolarised())]
    }

    #[test]
    fn what_the_unpolarised_mean_costs_is_what_the_docs_say() {
        let [kept, mean] = plate(75f64.to_radians().cos());
        assert!((kept / mean - 1.036).abs() < 5e-4, "{kept}, {mean}");
        // Under Lambertian light, like a rod with two polished ends: the mean over sin²θ.
        let cos = |i: u32| (1.0 - (f64::from(i) + 0.5) / 1e4).sqrt();
        let [kept, mean] = [0, 1].map(|way| (0..10_000).map(|i| plate(cos(i))[way]).sum::<f64>());
        assert!((kept / mean - 1.007).abs() < 5e-4, "{kept}, {mean}");
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(5), ..ProptestConfig::default() })]

        #[test]
        fn reflectance_is_the_same_from_both_sides(cos_i in 0.001..1.0f64, n_t in 1.0..3.0f64) {
            let cos_t = cos_transmitted(cos_i, 1.0, n_t).unwrap();
            let (out, back) = (dielectric(cos_i, 1.0, n_t), dielectric(cos_t, n_t, 1.0));
            prop_assert!((out.s - back.s).abs() < 1e-9 && (out.p - back.p).abs() < 1e-9);
            prop_assert!((0.0..=1.0).contains(&out.s) && (0.0..=1.0).contains(&out.p));
        }

        #[test]
        fn a_metal_without_absorption_is_a_dielectric(cos_i in 0.001..1.0f64, n_t in 1.01..3.0f64) {
            let (metal, glass) = (conductor(cos_i, 1.0, n_t, 0.0), dielectric(cos_i, 1.0, n_t));
            prop_assert!((metal.s - glass.s).abs() < 1e-9 && (metal.p - glass.p).abs() < 1e-9);
        }

        #[test]
        fn refraction_obeys_snell_and_stays_in_the_plane(angle in 0.0..1.5f64, n_t in 1.0..3.0f64) {
            let dir = DVec3::new(angle.sin(), 0.0, -angle.cos());
            let cos_t = cos_transmitted(angle.cos(), 1.0, n_t).unwrap();
            let out = refracted(dir, DVec3::Z, angle.cos(), cos_t, 1.0 / n_t);
            prop_assert!((out.length() - 1.0).abs() < 1e-12);
            prop_assert!((n_t * out.x - angle.sin()).abs() < 1e-12 && out.y == 0.0 && out.z < 0.0);
        }
    }
}
