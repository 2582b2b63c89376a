//! How far a finish spreads light about its discrete directions, for the choice of windows.

use crate::optics::Bsdf;

/// Below this standard deviation, rad, scatter is narrow: within twice this the solid angle is 0.13
/// sr, 2 % of a half space, so light must still be searched near a discrete direction.
const NARROW: f64 = 0.1;

/// How far a finish spreads light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Spread {
    /// Into discrete directions only, or nowhere.
    Discrete,
    /// About them, with this standard deviation in rad, less than 0.1.
    Narrow(f64),
    /// Over a large part of the half space.
    Broad,
}

impl Bsdf {
    /// Standard deviation of scatter about discrete directions, rad; `None` without any. For a
    /// mixture it is that of the narrowest such part, since a window must resolve it.
    pub fn width(&self) -> Option<f64> {
        match self {
            Self::GaussianSheet { lobe, .. } | Self::GaussianDielectric { lobe } => {
                Some(lobe.sigma())
            }
            Self::Smooth
            | Self::Specular { .. }
            | Self::Metal { .. }
            | Self::Absorber
            | Self::Open
            | Self::Tabulated { .. }
            | Self::Coated { .. }
            | Self::PrismFilm { .. }
            | Self::Haze(_)
            | Self::Lambertian { .. } => None,
            Self::Microfacet(rough) => Some(rough.spread()),
            Self::Mixture(parts) => {
                parts.iter().filter_map(|(_, part)| part.width()).reduce(f64::min)
            }
        }
    }

    /// How far the finish spreads light. A mixture is as broad as its broadest part, whatever its
    /// weight: it can also have discrete directions and narrower lobes.
    pub fn kind(&self) -> Spread {
        match self {
            Self::GaussianSheet { lobe, .. } | Self::GaussianDielectric { lobe }
                if lobe.sigma() < NARROW =>
            {
                Spread::Narrow(lobe.sigma())
            }
            Self::Microfacet(rough) if rough.spread() < NARROW => Spread::Narrow(rough.spread()),
            // The tails of haze reach over the half space; undisturbed light is separated by its
            // lobe.
            Self::GaussianSheet { .. }
            | Self::GaussianDielectric { .. }
            | Self::Microfacet(_)
            | Self::Haze(_)
            | Self::Lambertian { .. } => Spread::Broad,
            Self::Smooth
            | Self::Specular { .. }
            | Self::Metal { .. }
            | Self::Absorber
            | Self::Open
            | Self::Tabulated { .. }
            | Self::Coated { .. }
            | Self::PrismFilm { .. } => Spread::Discrete,
            Self::Mixture(parts) => {
                parts.iter().map(|(_, part)| part.kind()).fold(Spread::Discrete, Spread::broader)
            }
        }
    }
}

impl Spread {
    fn broader(self, other: Self) -> Self {
        match (self, other) {
            (Self::Broad, _) | (_, Self::Broad) => Self::Broad,
            (Self::Narrow(a), Self::Narrow(b)) => Self::Narrow(a.max(b)),
            (Self::Discrete, other) => other,
            (Self::Narrow(_), Self::Discrete) => self,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Gaussian;

    fn rough(sigma: f64) -> Bsdf {
        Bsdf::GaussianDielectric { lobe: Gaussian::new(sigma) }
    }

    #[test]
    fn a_mixture_is_as_broad_as_its_broadest_part_and_resolved_by_its_narrowest() {
        let diffuse = Bsdf::Lambertian { reflectance: 0.5, transmittance: 0.0 };
        let two = Bsdf::Mixture(vec![(1.0, rough(0.05)), (1.0, Bsdf::Smooth), (1.0, rough(0.02))]);
        assert_eq!((two.kind(), two.width()), (Spread::Narrow(0.05), Some(0.02)));
        let all = Bsdf::Mixture(vec![(1.0, diffuse), (1.0, two)]);
        assert_eq!((all.kind(), all.width()), (Spread::Broad, Some(0.02)));
        let none = Bsdf::Mixture(vec![(1.0, Bsdf::Smooth), (1.0, Bsdf::Absorber)]);
        assert_eq!((none.kind(), none.width()), (Spread::Discrete, None));
    }

    #[test]
    fn gaussian_scatter_is_narrow_up_to_a_tenth_of_a_radian() {
        assert_eq!(rough(0.099).kind(), Spread::Narrow(0.099));
        assert_eq!((rough(0.1).kind(), rough(0.1).width()), (Spread::Broad, Some(0.1)));
    }
}
