//! Finishes: names, references, tables in place, and the BSDF of each kind.

use crate::keys::Key;
use crate::library;
use crate::lower::context::Context;
use crate::spec::PREDEFINED_FINISHES;
use crate::spec::finish::{
    FinishRef, FinishSpec, GaussianSpec, GgxSpec, GrainSpec, MixturePartSpec, PrismFilmSpec,
    PrismSideSpec,
};
use crate::spec::spectrum::ShareSpec;
use indexmap::{IndexMap, IndexSet};
use lumiduct_core::optics::{
    FacetKind, FilmFace, FilmMake, Finish, Gaussian, Grain, Microfacet, PrismFilm, ScatterLaw,
};
use lumiduct_core::scene::FinishId;

/// Rounding error allowed for a sum of decimal fractions.
pub(super) const SUM_TOLERANCE: f64 = 1e-12;
/// Most mixtures inside each other: the number of their parts may double with each.
const DEEPEST: usize = 16;

/// The least sum of reflectance and transmittance.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Least {
    Zero,
    AboveZero,
}

/// Named finishes that are being looked at, and those found to contain themselves.
#[derive(Default)]
struct OpenMixtures<'a> {
    open: Vec<&'a str>,
    endless: IndexSet<&'a str>,
}

impl<'a> Context<'a> {
    /// Adds the named finishes, the predefined ones first; a definition of the same name wins.
    pub(super) fn lower_finishes(&mut self) {
        let predefined = [Finish::Smooth, Finish::Absorber, Finish::Open];
        for (name, finish) in PREDEFINED_FINISHES.into_iter().zip(predefined) {
            let id = self.builder.add_finish(name, finish);
            self.finishes.insert(name.to_owned(), id);
        }
        let mut mixing = OpenMixtures::default();
        for (name, spec) in &self.spec.finishes {
            if let Some(finish) = self.named(name, spec, &mut mixing) {
                let id = self.builder.add_finish(name, finish);
                self.finishes.insert(name.clone(), id);
            } else {
                self.finishes.shift_remove(name);
            }
        }
        for name in self.spec.finishes.keys().filter(|name| mixing.endless.contains(name.as_str()))
        {
            let message = "this mixture contains itself, directly or through another mixture";
            self.problems.certain_error(&Key::of(&["finishes", name]), message);
        }
    }

    /// The finish of a reference.
    pub(super) fn finish(&mut self, reference: &'a FinishRef, key: &Key) -> Option<FinishId> {
        match reference {
            FinishRef::Name(name) => {
                let own = self.finishes.get(name).copied();
                let finish = own.or_else(|| self.listed_finish(name, key));
                if finish.is_none() {
                    let listed = library::finishes().keys().map(String::as_str);
                    let known: Vec<&str> = PREDEFINED_FINISHES.into_iter().chain(listed).collect();
                    self.require_known(["finish", "finishes"], name, &known, key);
                }
                finish
            }
            FinishRef::Inline(spec) => {
                let finish = self.resolve(spec, key, &mut OpenMixtures::default())?;
                Some(self.builder.add_finish("in place", finish))
            }
        }
    }

    /// A finish of the library, unless the scene has one of this name.
    fn listed_finish(&mut self, name: &str, key: &Key) -> Option<FinishId> {
        let known = library::finishes().get(name)?;
        if self.names("finishes").contains(name) {
            return None;
        }
        self.meshes.add(known.keys.as_bytes());
        let finish = self.resolve(&known.spec, key, &mut OpenMixtures::default())?;
        let id = self.builder.add_finish(name, finish);
        self.finishes.insert(name.to_owned(), id);
        Some(id)
    }

    /// The finishes of a table of faces.
    pub(super) fn declared(
        &mut self,
        faces: &'a IndexMap<String, FinishRef>,
        key: &Key,
    ) -> IndexMap<&'a str, Option<FinishId>> {
        faces.iter().map(|(face, of)| (face.as_str(), self.finish(of, &key.field(face)))).collect()
    }

    /// The finish that light from behind meets: a different one for films, scatter files and stacks of layers.
    pub(super) fn behind(&mut self, finish: FinishId) -> FinishId {
        if let Some(behind) = self.behind.get(&finish) {
            return *behind;
        }
        let front = &self.builder.scene().finishes[finish.index()];
        let behind = match front.finish.from_behind() {
            None => finish,
            Some(finish) => {
                let name = format!("{}, from behind", front.name);
                self.builder.add_finish(&name, finish)
            }
        };
        self.behind.insert(finish, behind);
        behind
    }

    /// The finish behind one where the scene may give it; the back of a film, a scatter file or a stack is its own.
    pub(super) fn declared_behind(
        &mut self,
        front: Option<FinishId>,
        declared: Option<FinishId>,
        key: &Key,
    ) -> Option<FinishId> {
        let own = front.map(|front| self.behind(front)).filter(|behind| Some(*behind) != front);
        let is_whole = |front: FinishId| {
            self.builder.scene().finishes[front.index()].finish.is_of_both_sides()
        };
        if declared.is_some() && front.is_some_and(is_whole) {
            let hint = "remove this: light from behind meets the other side of the same sheet";
            let message =
                "a prism film, a scatter file or a stack of layers has no other finish behind it";
            return self.refuse(key, message, hint);
        }
        declared.or(own)
    }

    fn named(
        &mut self,
        name: &'a str,
        spec: &'a FinishSpec,
        mixing: &mut OpenMixtures<'a>,
    ) -> Option<Finish> {
        if let Some(known) = self.named_finishes.get(name) {
            return known.clone();
        }
        mixing.open.push(name);
        let finish = self.resolve(spec, &Key::of(&["finishes", name]), mixing);
        mixing.open.pop();
        self.named_finishes.insert(name.to_owned(), finish.clone());
        finish
    }

    fn resolve(
        &mut self,
        spec: &'a FinishSpec,
        key: &Key,
        mixing: &mut OpenMixtures<'a>,
    ) -> Option<Finish> {
        match spec {
            FinishSpec::Smooth(_) => Some(Finish::Smooth),
            FinishSpec::Specular(s) => {
                let (key, shares) = (key.field("specular"), [&s.reflectance, &s.transmittance]);
                self.with_shares(ScatterLaw::Specular, shares, Least::Zero, &key)
            }
            FinishSpec::Metal(metal) => Some(Finish::Metal { n: metal.n, k: metal.k }),
            FinishSpec::Absorber(_) => Some(Finish::Absorber),
            FinishSpec::Open(_) => Some(Finish::Open),
            FinishSpec::Lambertian(s) => {
                let (key, shares) = (key.field("lambertian"), [&s.reflectance, &s.transmittance]);
                self.with_shares(ScatterLaw::Lambertian, shares, Least::AboveZero, &key)
            }
            FinishSpec::Gaussian(spec) => self.gaussian(spec, &key.field("gaussian")),
            FinishSpec::Ggx(spec) => self.ggx(spec, &key.field("ggx")),
            FinishSpec::Abg(spec) => self.abg(spec, &key.field("abg")),
            FinishSpec::Harvey(spec) => self.harvey(spec, &key.field("harvey")),
            FinishSpec::Tabulated(spec) => self.tabulated(spec, &key.field("tabulated")),
            FinishSpec::Coated(spec) => {
                let (angles, shares) = (&spec.angles_deg, &spec.reflectance);
                let key = key.field("coated");
                let [reflectance] = self.table(angles, [("reflectance", shares)], &key)?;
                Some(Finish::Coated { reflectance })
            }
            FinishSpec::Stack(spec) => self.stack(spec, &key.field("stack")),
            FinishSpec::PrismFilm(film) => Some(prism_film(film)),
            FinishSpec::ScatterFile(spec) => self.scatter_file(spec, &key.field("scatter_file")),
            FinishSpec::Mixture(parts) => self.mixture(parts, &key.field("mixture"), mixing),
        }
    }

    /// Notes reflectance and transmittance with an impossible sum.
    pub(super) fn check_sum(
        &mut self,
        key: &Key,
        [reflectance, transmittance]: [f64; 2],
        least: Least,
    ) -> Option<()> {
        let sum = reflectance + transmittance;
        if sum > 1.0 + SUM_TOLERANCE {
            let message = format!(
                "reflectance {reflectance} and transmittance {transmittance} add up to {sum}, expected at most 1"
            );
            self.problems.error(key, message);
            return None;
        }
        if sum == 0.0 && least == Least::AboveZero {
            let message = "reflectance and transmittance are both 0, expected a sum above 0";
            let hint = "a finish that absorbs everything is `absorber = {}`";
            return self.refuse(key, message, hint);
        }
        Some(())
    }

    fn gaussian(&mut self, spec: &GaussianSpec, key: &Key) -> Option<Finish> {
        let lobe = Gaussian::new(spec.sigma_deg.to_radians());
        if let (None, None) = (&spec.reflectance, &spec.transmittance) {
            return Some(Finish::GaussianDielectric { lobe });
        }
        let none = ShareSpec::default();
        let shares =
            [&spec.reflectance, &spec.transmittance].map(|own| own.as_ref().unwrap_or(&none));
        self.with_shares(ScatterLaw::Gaussian(lobe), shares, Least::AboveZero, key)
    }

    fn ggx(&mut self, spec: &GgxSpec, key: &Key) -> Option<Finish> {
        let facets = match (spec.reflectance, spec.metal) {
            (Some(_), Some(_)) => {
                let message = "facets take a metal or a reflectance, not both";
                self.problems.error(&key.field("metal"), message);
                return None;
            }
            (Some(reflectance), None) => FacetKind::Mirror { reflectance },
            (None, Some(metal)) => FacetKind::Metal { n: metal.n, k: metal.k },
            (None, None) => FacetKind::Interface,
        };
        Some(Finish::Microfacet(Microfacet::new(spec.roughness, facets)))
    }

    fn mixture(
        &mut self,
        parts: &'a [MixturePartSpec],
        key: &Key,
        mixing: &mut OpenMixtures<'a>,
    ) -> Option<Finish> {
        let part = |(index, part): (usize, &'a MixturePartSpec)| {
            let key = key.index(index).field("finish");
            Some((part.weight, self.part(&part.finish, &key, mixing)?))
        };
        // All parts are looked at, whatever is wrong with the first.
        let made: Vec<Option<(f64, Finish)>> = parts.iter().enumerate().map(part).collect();
        let mixture = Finish::Mixture(made.into_iter().collect::<Option<_>>()?);
        if depth(&mixture) > DEEPEST {
            let message = format!("mixtures are more than {DEEPEST} deep in each other");
            self.problems.error(key, message);
            return None;
        }
        Some(mixture)
    }

    fn part(
        &mut self,
        reference: &'a FinishRef,
        key: &Key,
        mixing: &mut OpenMixtures<'a>,
    ) -> Option<Finish> {
        let name = match reference {
            FinishRef::Inline(spec) => return self.resolve(spec, key, mixing),
            FinishRef::Name(name) => name.as_str(),
        };
        if mixing.open.contains(&name) || mixing.endless.contains(name) {
            mixing.endless.extend(mixing.open.iter().copied());
            return None;
        }
        match self.spec.finishes.get_key_value(name) {
            // The finishes in between would be looked at one inside the other.
            Some(_) if mixing.open.len() > DEEPEST => {
                let message = format!("mixtures are more than {DEEPEST} deep in each other");
                self.problems.error(key, message);
                None
            }
            Some((name, spec)) => self.named(name, spec, mixing),
            None => {
                let finish = self.finish(reference, key)?;
                Some(self.builder.scene().finishes[finish.index()].finish.clone())
            }
        }
    }
}

/// How many mixtures are inside each other.
fn depth(finish: &Finish) -> usize {
    let Finish::Mixture(parts) = finish else { return 0 };
    1 + parts.iter().map(|(_, part)| depth(part)).max().unwrap_or(0)
}

fn prism_film(spec: &PrismFilmSpec) -> Finish {
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
    Finish::PrismFilm { film: Box::new(PrismFilm::new(&make)), face }
}
