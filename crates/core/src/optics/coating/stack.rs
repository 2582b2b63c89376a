//! A stack of thin layers by material and thickness, at any wavelength and angle.

use crate::optics::coating::complex::Complex;
use crate::optics::coating::matrix::{self, Film};
use crate::optics::coating::mueller::mueller;
use crate::optics::{FaceMueller, Incidence, IndexLaw, Shares, Side, fresnel};
use std::f64::consts::TAU;

/// A thin layer.
#[derive(Debug, Clone, PartialEq)]
pub struct ThinLayer {
    /// Refractive index by wavelength, 1.
    pub index: IndexLaw,
    /// Extinction coefficient k by wavelength, the imaginary part of the index, 0 or more, 1.
    pub extinction: IndexLaw,
    /// Thickness, nm.
    pub thickness: f64,
}

impl ThinLayer {
    fn film(&self, wavelength: f64) -> Film {
        Film {
            index: Complex::new(self.index.at(wavelength), -self.extinction.at(wavelength)),
            thickness: TAU * self.thickness / wavelength,
        }
    }

    fn is_clear(&self) -> bool {
        self.extinction == IndexLaw::Constant(0.0)
    }
}

/// Thin layers on each other, in the order in which light meets them.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerStack {
    layers: Vec<ThinLayer>,
    /// The wavelength at which it acts on all light, nm; `None` for that of the light.
    wavelength: Option<f64>,
    is_clear: bool,
    is_symmetric: bool,
}

impl LayerStack {
    /// A stack. `wavelength`, nm, applies to light of any wavelength, if given.
    pub fn new(layers: Vec<ThinLayer>, wavelength: Option<f64>) -> Self {
        let is_clear = layers.iter().all(ThinLayer::is_clear);
        let is_symmetric = layers.iter().eq(layers.iter().rev());
        Self { layers, wavelength, is_clear, is_symmetric }
    }

    /// The stack as light from the other side meets it; `None` if that is the same.
    pub fn reversed(&self) -> Option<Self> {
        let turned = || self.layers.iter().rev().cloned().collect();
        (!self.is_symmetric).then(|| Self { layers: turned(), ..self.clone() })
    }

    /// Its action on polarised light that leaves to a side.
    pub(crate) fn mueller(&self, incidence: &Incidence, side: Side) -> FaceMueller {
        let wavelength = self.wavelength.unwrap_or(incidence.wavelength);
        let films = self.layers.iter().map(|layer| layer.film(wavelength));
        let Incidence { index_from, index_to, .. } = *incidence;
        mueller(films, incidence.cos(), (index_from, Complex::real(index_to)), side)
    }

    /// Shares of light that arrives, 1.
    pub fn shares(&self, incidence: &Incidence) -> Shares {
        self.shares_of(self.layers.iter(), incidence)
    }

    /// Shares of light that leaves against the direction of `incidence`: reflected light arrived from there, transmitted light
    /// from the other side, where it met the same stack.
    pub(crate) fn shares_of_leaving(&self, incidence: &Incidence) -> Shares {
        let own = self.shares(incidence);
        if self.is_symmetric {
            return own;
        }
        // A stack transmits the same both ways.
        let Shares { transmitted, .. } = self.shares_of(self.layers.iter().rev(), incidence);
        Shares { transmitted, ..own }
    }

    fn shares_of<'a>(
        &self,
        layers: impl DoubleEndedIterator<Item = &'a ThinLayer>,
        incidence: &Incidence,
    ) -> Shares {
        let Incidence { index_from, index_to, s_share, .. } = *incidence;
        let (cos, wavelength) = (incidence.cos(), self.wavelength.unwrap_or(incidence.wavelength));
        let films = layers.map(|layer| layer.film(wavelength));
        let shares = matrix::shares(films, cos, [index_from, index_to]).of(s_share);
        debug_assert!(!shares.reflected.is_nan(), "{self:?} at {wavelength} nm");
        // Rounding makes no light and, in clear stacks, loses none.
        let reflected = shares.reflected.min(1.0);
        // By the same rule as refracted directions.
        let refracts = fresnel::cos_transmitted(cos, index_from, index_to).is_some();
        match (refracts, self.is_clear) {
            (false, true) => Shares { reflected: 1.0, transmitted: 0.0 },
            (false, false) => Shares { reflected, transmitted: 0.0 },
            (true, true) => Shares { reflected, transmitted: 1.0 - reflected },
            (true, false) => {
                Shares { reflected, transmitted: shares.transmitted.min(1.0 - reflected) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::SpectralTable;
    use crate::optics::REFERENCE_WAVELENGTH;
    use glam::DVec3;

    fn incidence(angle: f64, [index_from, index_to]: [f64; 2]) -> Incidence {
        let (dir, normal) = (DVec3::new(angle.sin(), 0.0, -angle.cos()), DVec3::Z);
        let (wavelength, grain) = (REFERENCE_WAVELENGTH, DVec3::ZERO);
        let s_share = Incidence::UNPOLARISED;
        Incidence { dir, normal, index_from, index_to, wavelength, grain, s_share }
    }

    fn layer(index: f64, extinction: f64, thickness: f64) -> ThinLayer {
        let [index, extinction] = [index, extinction].map(IndexLaw::Constant);
        ThinLayer { index, extinction, thickness }
    }

    #[test]
    fn a_stack_acts_at_the_wavelength_of_the_light_or_at_its_own() {
        let quarter =
            |wavelength| LayerStack::new(vec![layer(1.38, 0.0, 550.0 / 4.0 / 1.38)], wavelength);
        let at = |stack: &LayerStack, wavelength| {
            stack.shares(&Incidence { wavelength, ..incidence(0.0, [1.0, 1.52]) }).reflected
        };
        let (least, bare) = (0.012_600_8, (0.52f64 / 2.52).powi(2));
        assert!((at(&quarter(None), 550.0) - least).abs() < 1e-6);
        // At half the wavelength it is a half wave, which is absent.
        assert!((at(&quarter(None), 275.0) - bare).abs() < 1e-12);
        assert!((at(&quarter(Some(550.0)), 275.0) - least).abs() < 1e-6);
    }

    #[test]
    fn layers_follow_their_laws() {
        let table = |rows| IndexLaw::Table(SpectralTable::new(rows).unwrap());
        let metal = ThinLayer {
            index: table(vec![[400.0, 0.5], [700.0, 1.8]]),
            extinction: table(vec![[400.0, 4.9], [700.0, 8.3]]),
            thickness: 1e4,
        };
        let stack = LayerStack::new(vec![metal], None);
        for (wavelength, n, k) in [(400.0, 0.5, 4.9), (550.0, 1.15, 6.6), (700.0, 1.8, 8.3)] {
            let met = Incidence { wavelength, ..incidence(0.6, [1.0, 1.0]) };
            let known = fresnel::conductor(0.6f64.cos(), 1.0, n, k).unpolarised();
            assert!((stack.shares(&met).reflected - known).abs() < 1e-12, "{wavelength}");
        }
    }

    #[test]
    fn the_order_of_layers_counts_for_reflection_only() {
        let stack = LayerStack::new(vec![layer(2.3, 0.0, 60.0), layer(0.96, 6.69, 20.0)], None);
        let turned = stack.reversed().unwrap();
        assert_eq!(turned.reversed().as_ref(), Some(&stack));
        let met = incidence(0.5, [1.0, 1.0]);
        let (one, other) = (stack.shares(&met), turned.shares(&met));
        assert!((one.reflected - other.reflected).abs() > 0.05, "{one:?}, {other:?}");
        assert!((one.transmitted - other.transmitted).abs() < 1e-12, "{one:?}, {other:?}");
        assert!(
            one.sum() < 0.9
                && LayerStack::new(vec![layer(1.4, 0.0, 9.0)], None).reversed().is_none()
        );
    }

    #[test]
    fn light_that_leaves_came_through_the_same_stack() {
        let front = LayerStack::new(vec![layer(2.3, 0.0, 60.0), layer(0.96, 6.69, 8.0)], None);
        let back = front.reversed().unwrap();
        let inside = (0.6f64.sin() / 1.5).asin();
        let (above, below) = (incidence(0.6, [1.0, 1.5]), incidence(inside, [1.5, 1.0]));
        let seen = back.shares_of_leaving(&above);
        assert!((seen.transmitted - back.shares(&below).transmitted).abs() < 1e-12, "{seen:?}");
        // With the layers in the wrong order it would be another share.
        assert!((seen.transmitted - back.shares(&above).transmitted).abs() > 0.01, "{seen:?}");
    }
}
