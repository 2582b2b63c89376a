//! Finishes: names, references and tables in place.

use crate::input::lower::Context;
use crate::input::spec::finish::{FinishRef, FinishSpec, GaussianSpec};
use crate::optics::{Bsdf, Gaussian};
use crate::scene::FinishId;

impl Context<'_> {
    /// Adds the named finishes, the predefined ones first; a definition of the same name wins.
    pub(super) fn lower_finishes(&mut self) {
        for (name, bsdf) in [("polished", Bsdf::Smooth), ("black", Bsdf::Absorber), ("open", Bsdf::Open)] {
            let id = self.builder.add_finish(name, bsdf);
            self.finishes.insert(name.to_owned(), id);
        }
        for (name, spec) in &self.spec.finishes {
            let bsdf = self.bsdf(spec, 0);
            let id = self.builder.add_finish(name, bsdf);
            self.finishes.insert(name.clone(), id);
        }
    }

    /// The finish of a reference. Unknown names were found by the validation.
    pub(super) fn finish(&mut self, reference: &FinishRef) -> Option<FinishId> {
        match reference {
            FinishRef::Name(name) => self.finishes.get(name).copied(),
            FinishRef::Inline(spec) => {
                let bsdf = self.bsdf(spec, 0);
                Some(self.builder.add_finish("in place", bsdf))
            }
        }
    }

    fn bsdf(&self, spec: &FinishSpec, depth: usize) -> Bsdf {
        match spec {
            FinishSpec::Smooth(_) => Bsdf::Smooth,
            FinishSpec::Specular(s) => {
                Bsdf::Specular { reflectance: s.reflectance, transmittance: s.transmittance }
            }
            FinishSpec::Metal(metal) => Bsdf::Metal { n: metal.n, k: metal.k },
            FinishSpec::Absorber(_) => Bsdf::Absorber,
            FinishSpec::Open(_) => Bsdf::Open,
            FinishSpec::Lambertian(s) => {
                Bsdf::Lambertian { reflectance: s.reflectance, transmittance: s.transmittance }
            }
            FinishSpec::Gaussian(spec) => gaussian(spec),
            FinishSpec::Mixture(parts) => Bsdf::Mixture(
                parts.iter().map(|part| (part.weight, self.referenced(&part.finish, depth + 1))).collect(),
            ),
        }
    }

    /// The finish of a part of a mixture. A mixture of itself was refused by the validation; the depth is a backstop.
    fn referenced(&self, reference: &FinishRef, depth: usize) -> Bsdf {
        /// Deeper mixtures of mixtures cannot be told from one that contains itself.
        const DEEPEST: usize = 16;
        match reference {
            FinishRef::Inline(spec) if depth <= DEEPEST => self.bsdf(spec, depth),
            FinishRef::Name(name) if depth <= DEEPEST => match self.spec.finishes.get(name) {
                Some(spec) => self.bsdf(spec, depth),
                None => self
                    .finishes
                    .get(name)
                    .map_or(Bsdf::Absorber, |id| self.builder.scene().finishes[id.index()].bsdf.clone()),
            },
            FinishRef::Inline(_) | FinishRef::Name(_) => Bsdf::Absorber,
        }
    }
}

fn gaussian(spec: &GaussianSpec) -> Bsdf {
    let lobe = Gaussian::new(spec.sigma_deg.to_radians());
    match (spec.reflectance, spec.transmittance) {
        (None, None) => Bsdf::GaussianDielectric { lobe },
        (reflectance, transmittance) => Bsdf::GaussianSheet {
            lobe,
            reflectance: reflectance.unwrap_or(0.0),
            transmittance: transmittance.unwrap_or(0.0),
        },
    }
}
