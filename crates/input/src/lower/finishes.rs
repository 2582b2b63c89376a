//! Finishes: names, references and inline tables.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::scatter;
use crate::spec::finish::{
    FinishRef, FinishSpec, GaussianSpec, GrainSpec, PrismFilmSpec, PrismSideSpec,
};
use lumiduct_core::optics::{AngleTable, Bsdf, FilmFace, FilmMake, Gaussian, Grain, PrismFilm};
use lumiduct_core::scene::FinishId;

impl Context<'_> {
    /// Adds the named finishes, the predefined ones first; a definition of the same name wins.
    pub(super) fn lower_finishes(&mut self) {
        for (name, bsdf) in
            [("polished", Bsdf::Smooth), ("black", Bsdf::Absorber), ("open", Bsdf::Open)]
        {
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

    /// The finish that light from behind meets: a different one for films.
    pub(super) fn behind(&mut self, finish: FinishId) -> FinishId {
        if let Some(behind) = self.behind.get(&finish) {
            return *behind;
        }
        let front = &self.builder.scene().finishes[finish.index()];
        let behind = match front.bsdf.from_behind() {
            None => finish,
            Some(bsdf) => {
                let name = format!("{}, from behind", front.name);
                self.builder.add_finish(&name, bsdf)
            }
        };
        self.behind.insert(finish, behind);
        behind
    }

    /// The finish behind one where the file may give it; the back of a film is the film.
    pub(super) fn declared_behind(
        &mut self,
        front: Option<FinishId>,
        declared: Option<&FinishRef>,
        key: &Key,
    ) -> Option<FinishId> {
        let film = front.map(|front| self.behind(front)).filter(|behind| Some(*behind) != front);
        match declared {
            Some(_) if film.is_some() => {
                self.problems
                    .error(key, "a prism film has no other finish behind it")
                    .hint("leave this out: light from behind meets the same film");
                None
            }
            Some(declared) => self.finish(declared),
            None => film,
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
            FinishSpec::Ggx(spec) => scatter::ggx(spec),
            FinishSpec::Abg(spec) => scatter::haze(scatter::abg(spec), &spec.sheet),
            FinishSpec::Harvey(spec) => scatter::haze(scatter::harvey(spec), &spec.sheet),
            FinishSpec::Tabulated(spec) => Bsdf::Tabulated {
                reflectance: scatter::table(&spec.angles_deg, &spec.reflectance),
                transmittance: spec.transmittance.as_ref().map_or_else(
                    || AngleTable::constant(0.0),
                    |values| scatter::table(&spec.angles_deg, values),
                ),
            },
            FinishSpec::Coated(spec) => {
                Bsdf::Coated { reflectance: scatter::table(&spec.angles_deg, &spec.reflectance) }
            }
            FinishSpec::PrismFilm(film) => prism_film(film),
            FinishSpec::Mixture(parts) => Bsdf::Mixture(
                parts
                    .iter()
                    .map(|part| (part.weight, self.referenced(&part.finish, depth + 1)))
                    .collect(),
            ),
        }
    }

    /// The finish of a part of a mixture. A mixture of itself was refused by the validation; the
    /// depth limit is a safeguard.
    fn referenced(&self, reference: &FinishRef, depth: usize) -> Bsdf {
        /// Deeper nesting of mixtures is treated as a mixture that contains itself.
        const DEEPEST: usize = 16;
        match reference {
            FinishRef::Inline(spec) if depth <= DEEPEST => self.bsdf(spec, depth),
            FinishRef::Name(name) if depth <= DEEPEST => match self.spec.finishes.get(name) {
                Some(spec) => self.bsdf(spec, depth),
                None => self.finishes.get(name).map_or(Bsdf::Absorber, |id| {
                    self.builder.scene().finishes[id.index()].bsdf.clone()
                }),
            },
            FinishRef::Inline(_) | FinishRef::Name(_) => Bsdf::Absorber,
        }
    }
}

fn prism_film(spec: &PrismFilmSpec) -> Bsdf {
    let make = FilmMake {
        index: spec.index,
        prism_angle: spec.prism_angle_deg.to_radians(),
        pitch: spec.pitch_mm,
        base: spec.base_mm,
        absorption: spec.absorption_per_mm,
        rounded: spec.rounded_share,
        run: match spec.run {
            GrainSpec::Along => Grain::Along,
            GrainSpec::Around => Grain::Around,
        },
    };
    let face = match spec.prisms {
        PrismSideSpec::Behind => FilmFace::Flat,
        PrismSideSpec::Before => FilmFace::Prisms,
    };
    Bsdf::PrismFilm { film: Box::new(PrismFilm::new(&make)), face }
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
