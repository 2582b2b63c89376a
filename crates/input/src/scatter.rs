//! Finishes with microfacets, haze and tables: from the spec to the BSDF.
//!
//! Knows no keys and no problems. The checks use it to compute what a haze scatters.

use crate::spec::finish::{AbgSpec, GgxSpec, HarveySpec, HazeSheetSpec, HazeSidesSpec};
use lumiduct_core::optics::{
    AngleTable, Bsdf, FacetKind, Haze, HazeBase, HazeLaw, HazeSides, Microfacet,
};

pub(crate) fn ggx(spec: &GgxSpec) -> Bsdf {
    let facets = match (spec.reflectance, spec.metal) {
        (Some(reflectance), _) => FacetKind::Mirror { reflectance },
        (None, Some(metal)) => FacetKind::Metal { n: metal.n, k: metal.k },
        (None, None) => FacetKind::Interface,
    };
    Bsdf::Microfacet(Microfacet::new(spec.roughness, facets))
}

pub(crate) fn abg(spec: &AbgSpec) -> HazeLaw {
    HazeLaw::Abg { a: spec.a, b: spec.b, g: spec.g }
}

pub(crate) fn harvey(spec: &HarveySpec) -> HazeLaw {
    HazeLaw::Harvey { b0: spec.b0, shoulder: spec.l, slope: spec.s }
}

pub(crate) fn haze(law: HazeLaw, sheet: &HazeSheetSpec) -> Bsdf {
    let base = match (sheet.reflectance, sheet.transmittance) {
        (None, None) => HazeBase::Interface,
        (reflectance, transmittance) => HazeBase::Sheet {
            reflectance: reflectance.unwrap_or(0.0),
            transmittance: transmittance.unwrap_or(0.0),
            scatters: sides(sheet),
        },
    };
    Bsdf::Haze(Box::new(Haze::new(law, base)))
}

/// The sides to which a sheet scatters.
pub(crate) fn sides(sheet: &HazeSheetSpec) -> HazeSides {
    match sheet.scatters {
        None | Some(HazeSidesSpec::Both) => HazeSides::Both,
        Some(HazeSidesSpec::Reflected) => HazeSides::Reflected,
        Some(HazeSidesSpec::Transmitted) => HazeSides::Transmitted,
    }
}

/// A table of as many values, 1, as angles, deg.
pub(crate) fn table(angles_deg: &[f64], values: &[f64]) -> AngleTable {
    let rows = angles_deg.iter().zip(values);
    AngleTable::new(rows.map(|(angle, value)| [angle.to_radians(), *value]).collect())
}
