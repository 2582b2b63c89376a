//! Mirrors, diffusers and Gaussian sheets whose shares depend on the wavelength: at each wavelength they are those of
//! constant shares.

use crate::colour::SpectralTable;
use crate::optics::finish::gaussian_sheet::GaussianSheet;
use crate::optics::finish::lambertian::Lambertian;
use crate::optics::finish::model::{FinishModel, Spread};
use crate::optics::finish::specular::Specular;
use crate::optics::{
    FaceMueller, Gaussian, Incidence, REFERENCE_WAVELENGTH, Scattered, Shares, Side,
};
use crate::rng::{Numbers, Sampler};
use glam::DVec3;

/// A share of light, 0..=1.
#[derive(Debug, Clone, PartialEq)]
pub enum SpectralShare {
    /// The same at every wavelength.
    Constant(f64),
    /// By wavelength.
    Table(SpectralTable),
}

impl SpectralShare {
    /// The share at a wavelength, nm.
    pub fn at(&self, nm: f64) -> f64 {
        match self {
            Self::Constant(share) => *share,
            Self::Table(table) => table.at(nm),
        }
    }

    /// Its table, if it depends on the wavelength.
    pub fn table(&self) -> Option<&SpectralTable> {
        match self {
            Self::Constant(_) => None,
            Self::Table(table) => Some(table),
        }
    }

    /// The largest share, 1.
    fn largest(&self) -> f64 {
        match self {
            Self::Constant(share) => *share,
            Self::Table(table) => table.rows().iter().map(|[_, share]| *share).fold(0.0, f64::max),
        }
    }
}

/// Where a finish with shares that do not depend on the angle sends light.
#[derive(Debug, Clone, PartialEq)]
pub enum ScatterLaw {
    /// Into the mirrored direction and straight on.
    Specular,
    /// By Lambert's law.
    Lambertian,
    /// About the mirrored and the straight direction.
    Gaussian(Gaussian),
}

/// A finish with shares by wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralFinish {
    /// Where it sends light.
    pub scatter: ScatterLaw,
    /// Share that is reflected.
    pub reflectance: SpectralShare,
    /// Share that is transmitted; at every wavelength at most 1 with the reflectance.
    pub transmittance: SpectralShare,
}

impl SpectralFinish {
    /// Its shares at a wavelength, nm.
    fn at(&self, nm: f64) -> Shares {
        Shares { reflected: self.reflectance.at(nm), transmitted: self.transmittance.at(nm) }
    }

    fn met(&self, incidence: &Incidence) -> Shares {
        self.at(incidence.wavelength)
    }
}

/// The answer of the finish with some shares to a question of [`FinishModel`].
macro_rules! ask {
    ($spectral:expr, $shares:expr, $finish:ident => $answer:expr) => {{
        let shares = $shares;
        match &$spectral.scatter {
            ScatterLaw::Specular => {
                let $finish = Specular { shares };
                $answer
            }
            ScatterLaw::Lambertian => {
                let $finish = Lambertian { shares };
                $answer
            }
            ScatterLaw::Gaussian(lobe) => {
                let $finish = GaussianSheet { lobe, shares };
                $answer
            }
        }
    }};
}

impl FinishModel for SpectralFinish {
    fn shares(&self, incidence: &Incidence) -> Shares {
        self.met(incidence)
    }

    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        ask!(self, self.met(incidence), finish => finish.scatter(incidence, sampler))
    }

    fn scatter_radiance(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        ask!(self, self.met(incidence), finish => finish.scatter_radiance(incidence, sampler))
    }

    fn scatter_toward(
        &self,
        side: Side,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        ask!(self, self.met(incidence), finish => finish.scatter_toward(side, incidence, sampler))
    }

    fn evaluate(&self, incidence: &Incidence, out: DVec3) -> f64 {
        ask!(self, self.met(incidence), finish => finish.evaluate(incidence, out))
    }

    fn mueller(&self, incidence: &Incidence, side: Side) -> Option<FaceMueller> {
        ask!(self, self.met(incidence), finish => finish.mueller(incidence, side))
    }

    fn width(&self) -> Option<f64> {
        ask!(self, self.at(REFERENCE_WAVELENGTH), finish => finish.width())
    }

    fn spread(&self) -> Spread {
        ask!(self, self.at(REFERENCE_WAVELENGTH), finish => finish.spread())
    }

    fn only_mirrors(&self, incidence: &Incidence) -> bool {
        ask!(self, self.met(incidence), finish => finish.only_mirrors(incidence))
    }

    fn mirrors_alike(&self, incidence: &Incidence) -> bool {
        ask!(self, self.met(incidence), finish => finish.mirrors_alike(incidence))
    }

    fn passes_straight(&self) -> bool {
        // Of the wavelengths that are transmitted most.
        let shares = Shares { reflected: 0.0, transmitted: self.transmittance.largest() };
        ask!(self, shares, finish => finish.passes_straight())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Finish;
    use crate::optics::finish::testing::{assert_sound, incidence};

    fn table(rows: [[f64; 2]; 2]) -> SpectralTable {
        SpectralTable::new(rows.to_vec()).unwrap()
    }

    fn filter(scatter: ScatterLaw) -> Finish {
        Finish::Spectral(Box::new(SpectralFinish {
            scatter,
            reflectance: SpectralShare::Table(table([[450.0, 0.9], [650.0, 0.1]])),
            transmittance: SpectralShare::Table(table([[450.0, 0.0], [650.0, 0.8]])),
        }))
    }

    fn kinds() -> [ScatterLaw; 3] {
        let lobe = Gaussian::new(0.2);
        [ScatterLaw::Specular, ScatterLaw::Lambertian, ScatterLaw::Gaussian(lobe)]
    }

    #[test]
    fn photons_and_gather_paths_follow_it() {
        kinds().map(filter).iter().for_each(assert_sound);
    }

    #[test]
    fn shares_are_those_of_the_wavelength() {
        for scatter in kinds() {
            let finish = filter(scatter.clone());
            for (nm, reflected, transmitted) in
                [(400.0, 0.9, 0.0), (500.0, 0.7, 0.2), (650.0, 0.1, 0.8), (780.0, 0.1, 0.8)]
            {
                let met = Incidence { wavelength: nm, ..incidence(0.4, [1.0, 1.0]) };
                let found = finish.shares(&met);
                assert!((found.reflected - reflected).abs() < 1e-12, "{nm}: {found:?}");
                assert!((found.transmitted - transmitted).abs() < 1e-12, "{nm}: {found:?}");
                let alike =
                    Finish::with_shares(scatter.clone(), [found.reflected, found.transmitted]);
                let out = DVec3::new(0.3, 0.2, 0.5).normalize();
                assert_eq!(finish.evaluate(&met, out), alike.evaluate(&met, out));
            }
            assert_eq!(finish.passes_straight(), scatter != ScatterLaw::Lambertian);
            let passes_blue = SpectralFinish {
                scatter: scatter.clone(),
                reflectance: SpectralShare::Constant(0.0),
                transmittance: SpectralShare::Table(table([[450.0, 0.8], [500.0, 0.0]])),
            };
            assert_eq!(passes_blue.passes_straight(), scatter != ScatterLaw::Lambertian);
            let blue = Incidence { wavelength: 450.0, ..incidence(0.4, [1.0, 1.0]) };
            assert_eq!(finish.only_mirrors(&blue), scatter == ScatterLaw::Specular);
        }
    }
}
