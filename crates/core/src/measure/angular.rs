//! Goniometers: intensity by direction, beam and field angles, and flux by zones.
//!
//! Intensity is flux over solid angle, a mean over each cell of the goniometric sphere (type C: γ
//! from the pole, C about it). The nominal γ of a cell halves its solid angle, cos γ = (cos γ₁ +
//! cos γ₂)/2. Cells are treated as independent, which overestimates the errors of large shares of
//! the flux rather than underestimating them.

#[cfg(test)]
mod tests;

use crate::measure::cell_colours::CellColours;
use crate::measure::evidence::{Evidence, status_by_error};
use crate::measure::light::LightSelection;
use crate::measure::noisy::{Noisy, WeightedValue};
use crate::measure::{ColourTable, Measure, Status, beam, uniformity};
use crate::scene::{Goniometer, SensorId};
use indexmap::IndexMap;
use ndarray::Array2;
use serde::Serialize;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Width of the zones over which flux is summed, deg.
const ZONE_DEG: usize = 10;
/// Rings have their own names up to this number.
const NAMED_RINGS: usize = 180;
/// Planes C0-C180 and C90-C270 are evaluated from this number of sectors on.
const SECTORS_FOR_PLANES: usize = 4;
/// Shares of the maximum that bound the beam and the field (ANSI/IES LS-1; CIE S 017: half of the maximum).
const BEAM: f64 = 0.5;
const FIELD: f64 = 0.1;

/// Intensity measured by a goniometer, cell by cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IntensityTable {
    /// Name of the sensor.
    pub sensor: String,
    /// Light group whose light it is; `None` for the light of all sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light: Option<String>,
    /// Number of weathers whose light is summed; if there are several, they never shine together.
    pub weathers: usize,
    /// Unit of intensity, such as `cd`.
    pub unit: String,
    /// Rings (γ, from the pole) by sectors (C), in `unit`.
    pub values: Array2<f64>,
    /// Standard errors, same layout.
    pub std_errors: Array2<f64>,
    /// Indicators of bias, same layout; `None` for unbiased estimates.
    pub biases: Option<Array2<f64>>,
    /// Colours of the cells, of all light, where it has spectra; they are tables of their own.
    #[serde(skip)]
    pub colours: Option<ColourTable>,
    /// Edges of the rings, deg.
    pub gamma_deg: Vec<f64>,
    /// Edges of the sectors, deg.
    pub c_deg: Vec<f64>,
    /// Nominal γ of each ring, deg.
    pub ring_gamma_deg: Vec<f64>,
    /// Mean intensity over C of each ring, in `unit`.
    pub ring_values: Vec<f64>,
    /// Their standard errors.
    pub ring_std_errors: Vec<f64>,
    /// The curves in the planes C0-C180 and C90-C270; none with fewer than four sectors.
    pub planes: Vec<PlaneCurve>,
    /// Radius of the sphere, mm; `None` for the far field.
    pub radius_mm: Option<f64>,
}

/// Intensity in a plane through the pole.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlaneCurve {
    /// C of its first half, deg; the second lies opposite.
    pub c_deg: f64,
    /// γ of each ring, from the pole; negative in the second half; ascending, deg.
    pub gamma_deg: Vec<f64>,
    /// Intensity, in the unit of the table.
    pub values: Vec<f64>,
    /// Standard errors, same layout.
    pub std_errors: Vec<f64>,
}

/// Flux per cell of a sphere with its standard error, lm or W.
struct SphereFlux<'a> {
    goniometer: &'a Goniometer,
    flux: Vec<(f64, f64)>,
    /// Flux of one count, lm or W.
    count: f64,
}

impl<'a> SphereFlux<'a> {
    fn of(
        evidence: &Evidence<'_>,
        id: SensorId,
        goniometer: &'a Goniometer,
        light: LightSelection,
    ) -> Self {
        let flux = evidence.cell_flux(id, light, 0..goniometer.cells());
        let count = evidence.count_flux(&flux);
        Self { goniometer, flux, count }
    }

    /// Flux over some rings and sectors.
    fn flux(&self, rings: std::ops::Range<usize>, sectors: &[usize]) -> Noisy {
        let all = rings.flat_map(|ring| sectors.iter().map(move |&sector| (ring, sector)));
        let cells = all.map(|(ring, sector)| self.flux[ring * self.goniometer.c_cells + sector]);
        let (sum, variance) = cells.fold((0.0, 0.0), |(sum, variance), (mean, error)| {
            (sum + mean, variance + error * error)
        });
        Noisy { value: sum, std_error: variance.sqrt(), count: self.count }
    }

    /// Mean intensity of a ring over some sectors.
    fn intensity(&self, ring: usize, sectors: &[usize]) -> Noisy {
        let flux = self.flux(ring..ring + 1, sectors);
        let cell = self.goniometer.solid_angle(ring * self.goniometer.c_cells);
        let over = 1.0 / (cell * sectors.len() as f64);
        Noisy {
            value: flux.value * over,
            std_error: flux.std_error * over,
            count: flux.count * over,
        }
    }

    fn all_sectors(&self) -> Vec<usize> {
        (0..self.goniometer.c_cells).collect()
    }

    /// Mean intensity over C of each ring.
    fn curve(&self) -> Vec<Noisy> {
        let all = self.all_sectors();
        (0..self.goniometer.gamma_cells).map(|ring| self.intensity(ring, &all)).collect()
    }

    /// The intensity of each ring in a half-plane: from the sector it lies in, or from both where
    /// it lies between two.
    fn half_plane(&self, c: f64) -> Vec<Noisy> {
        let sectors = self.goniometer.c_cells;
        let place = (c / TAU * sectors as f64).rem_euclid(sectors as f64);
        // Rounding may put a plane that lies on an edge a few ulp off it.
        let on_edge = (place - place.round()).abs() < 1e-9;
        let at = if on_edge {
            let edge = place.round() as usize % sectors;
            vec![edge, (edge + sectors - 1) % sectors]
        } else {
            vec![place as usize]
        };
        (0..self.goniometer.gamma_cells).map(|ring| self.intensity(ring, &at)).collect()
    }
}

/// The curve in the plane of C, rad, and the half opposite.
fn plane_curve(sphere: &SphereFlux<'_>, c: f64) -> PlaneCurve {
    let gammas = ring_gammas(sphere.goniometer.gamma_cells);
    let [ahead, behind] = [sphere.half_plane(c), sphere.half_plane(c + PI)];
    let second = gammas.iter().map(|gamma| -gamma).zip(behind).rev();
    let line: Vec<(f64, Noisy)> = second.chain(gammas.iter().copied().zip(ahead)).collect();
    PlaneCurve {
        c_deg: c.to_degrees(),
        gamma_deg: line.iter().map(|(gamma, _)| gamma.to_degrees()).collect(),
        values: line.iter().map(|(_, ring)| ring.value).collect(),
        std_errors: line.iter().map(|(_, ring)| ring.std_error).collect(),
    }
}

/// C of the planes to evaluate, rad; none for a goniometer with few sectors.
fn planes(goniometer: &Goniometer) -> &'static [f64] {
    if goniometer.c_cells >= SECTORS_FOR_PLANES { &[0.0, FRAC_PI_2] } else { &[] }
}

/// Nominal γ of each ring, rad.
fn ring_gammas(rings: usize) -> Vec<f64> {
    let edge = |ring: usize| (PI * ring as f64 / rings as f64).cos();
    (0..rings).map(|ring| (0.5 * (edge(ring) + edge(ring + 1))).acos()).collect()
}

/// The intensities of some light on a goniometer.
pub(crate) fn table(
    evidence: &Evidence<'_>,
    id: SensorId,
    goniometer: &Goniometer,
    light: LightSelection,
) -> IntensityTable {
    let sphere = SphereFlux::of(evidence, id, goniometer, light);
    let (rings, sectors) = (goniometer.gamma_cells, goniometer.c_cells);
    let cells = |f: fn(Noisy) -> f64| {
        Array2::from_shape_fn((rings, sectors), |(ring, c)| f(sphere.intensity(ring, &[c])))
    };
    let edges = |to: f64, bins: usize| (0..=bins).map(|i| to * i as f64 / bins as f64).collect();
    let curve = sphere.curve();
    IntensityTable {
        sensor: evidence.scene.sensors[id.index()].name.clone(),
        light: light.name(evidence.scene).map(str::to_owned),
        weathers: light.weathers(evidence.scene),
        unit: evidence.scene.unit.intensity().to_owned(),
        values: cells(|cell| cell.value),
        std_errors: cells(|cell| cell.std_error),
        biases: None,
        colours: None,
        gamma_deg: edges(180.0, rings),
        c_deg: edges(360.0, sectors),
        ring_gamma_deg: ring_gammas(rings).into_iter().map(f64::to_degrees).collect(),
        ring_values: curve.iter().map(|ring| ring.value).collect(),
        ring_std_errors: curve.iter().map(|ring| ring.std_error).collect(),
        planes: planes(goniometer).iter().map(|c| plane_curve(&sphere, *c)).collect(),
        radius_mm: goniometer.radius,
    }
}

/// Gives the table of all light the colours of its cells; how even these are, by the last part of the names of these measures.
pub(crate) fn add_colours(
    evidence: &Evidence<'_>,
    id: SensorId,
    goniometer: &Goniometer,
    table: &mut IntensityTable,
) -> IndexMap<String, Measure> {
    let Some(colours) = CellColours::of(evidence, id, 0..goniometer.cells()) else {
        return IndexMap::new();
    };
    table.colours = Some(colours.table(goniometer.c_cells));
    let sphere = SphereFlux::of(evidence, id, goniometer, LightSelection::All);
    let level = |cell| sphere.intensity(cell / goniometer.c_cells, &[cell % goniometer.c_cells]);
    let levels: Vec<_> = (0..goniometer.cells()).map(|cell| Some(level(cell))).collect();
    colours.spread(evidence, &levels).into()
}

/// The measures of some light on the sphere, by the last part of their dotted names; zones and
/// single rings for all light only.
pub(crate) fn measures(
    evidence: &Evidence<'_>,
    id: SensorId,
    goniometer: &Goniometer,
    light: LightSelection,
) -> IndexMap<String, Measure> {
    let scene = evidence.scene;
    let sphere = SphereFlux::of(evidence, id, goniometer, light);
    let curve = sphere.curve();
    let unit = scene.unit.intensity();
    let [most, axis] = if light.is_dark(scene) {
        [evidence.no_light(unit), evidence.no_light(unit)]
    } else {
        [largest(evidence, &sphere), single(evidence, curve[0], unit)]
    };
    let from = light.suffix(scene);
    let mut out = IndexMap::new();
    out.insert(format!("intensity_max{from}"), most);
    out.insert(format!("intensity_axis{from}"), axis);
    let angles = angles(evidence, &sphere, &curve).into_iter();
    out.extend(angles.map(|(name, angle)| (format!("{name}{from}"), angle)));
    match light {
        LightSelection::All => zones(evidence, &sphere, &curve, &mut out),
        LightSelection::Group(_) => {}
    }
    out
}

/// Flux by zones, and the intensity of single rings.
fn zones(
    evidence: &Evidence<'_>,
    sphere: &SphereFlux<'_>,
    curve: &[Noisy],
    out: &mut IndexMap<String, Measure>,
) {
    let unit = evidence.scene.unit;
    let rings = curve.len();
    if (rings * ZONE_DEG).is_multiple_of(180) {
        let per_zone = rings * ZONE_DEG / 180;
        for zone in 0..180 / ZONE_DEG {
            let flux = sphere.flux(zone * per_zone..(zone + 1) * per_zone, &sphere.all_sectors());
            let name = format!("zonal_flux.{}-{}", zone * ZONE_DEG, (zone + 1) * ZONE_DEG);
            out.insert(name, single(evidence, flux, unit.flux()));
        }
    }
    if rings <= NAMED_RINGS {
        for (ring, intensity) in curve.iter().enumerate() {
            out.insert(format!("ring.{ring}"), single(evidence, *intensity, unit.intensity()));
        }
    }
}

/// Rings and sectors ordered so that neighbours in the list are neighbours on the sphere. The order
/// starts around the pole, where cells are small and most beams have their light.
pub(crate) fn sphere_cells(rings: usize, sectors: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..rings * sectors).map(move |place| (place / sectors, place % sectors))
}

/// The largest intensity of any cell, corrected for noise.
fn largest(evidence: &Evidence<'_>, sphere: &SphereFlux<'_>) -> Measure {
    let Goniometer { c_cells, gamma_cells, .. } = *sphere.goniometer;
    let cells: Vec<WeightedValue> = sphere_cells(gamma_cells, c_cells)
        .map(|(ring, sector)| WeightedValue {
            read: sphere.intensity(ring, &[sector]),
            weight: sphere.goniometer.solid_angle(ring * c_cells),
        })
        .collect();
    let found = uniformity::largest(&cells, evidence.readings.batch_count());
    found.measure(evidence, evidence.scene.unit.intensity())
}

/// Beam and field angle on the mean curve over C, and in the planes C0-C180 and C90-C270.
fn angles(
    evidence: &Evidence<'_>,
    sphere: &SphereFlux<'_>,
    curve: &[Noisy],
) -> Vec<(String, Measure)> {
    let gammas = ring_gammas(curve.len());
    let mut out = Vec::new();
    let mut profiles = vec![(String::new(), curve.to_vec(), curve.to_vec())];
    for c in planes(sphere.goniometer) {
        let name = format!(".c{:.0}", c.to_degrees());
        profiles.push((name, sphere.half_plane(*c), sphere.half_plane(c + PI)));
    }
    for (name, share) in [("beam_angle", BEAM), ("field_angle", FIELD)] {
        for (plane, ahead, behind) in &profiles {
            let found = beam::full_angle(&gammas, [ahead, behind], share);
            let measure = match found {
                Some(angle) => Measure {
                    bias: Some(angle.bias.to_degrees()),
                    ..evidence.measure(
                        angle.value.to_degrees(),
                        angle.std_error.to_degrees(),
                        "deg",
                        angle.status,
                    )
                },
                None => evidence.measure(0.0, f64::INFINITY, "deg", Status::NoSignal),
            };
            out.push((format!("{name}{plane}"), measure));
        }
    }
    out
}

/// A value as a measure; where nothing was counted, its error is one count.
fn single(evidence: &Evidence<'_>, found: Noisy, unit: &str) -> Measure {
    let status = status_by_error(found.value, found.std_error);
    let std_error = if status == Status::NoSignal { found.count } else { found.std_error };
    evidence.measure(found.value, std_error, unit, status)
}
