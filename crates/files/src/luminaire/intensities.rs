//! A distribution of luminous intensity over half-planes about a vertical axis, interpolated between measured directions.

use crate::luminaire::error::{LuminaireError, MAX_ANGLES, MOST_CANDELA};
use lumiduct_base::math::linear_over_ring;

/// Symmetry of a distribution, and so the range of its planes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaneSymmetry {
    /// About the vertical axis: one plane.
    Rotational,
    /// About the planes C0-C180 and C90-C270: planes from 0° to 90°.
    Quadrants,
    /// About the plane C0-C180: planes from 0° to 180°.
    AboutC0,
    /// About the plane C90-C270: planes from 90° to 270°.
    AboutC90,
    /// None: planes from 0° to below 360°.
    None,
}

impl PlaneSymmetry {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rotational => "rotational",
            Self::Quadrants => "four equal quadrants",
            Self::AboutC0 => "about the plane C0-C180",
            Self::AboutC90 => "about the plane C90-C270",
            Self::None => "none",
        }
    }

    /// First and last plane, deg.
    fn range(self) -> [f64; 2] {
        match self {
            Self::Rotational => [0.0, 0.0],
            Self::Quadrants => [0.0, 90.0],
            Self::AboutC0 => [0.0, 180.0],
            Self::AboutC90 => [90.0, 270.0],
            Self::None => [0.0, 360.0],
        }
    }

    /// How many times its planes make the whole circle.
    fn copies(self) -> f64 {
        match self {
            Self::Rotational | Self::None => 1.0,
            Self::AboutC0 | Self::AboutC90 => 2.0,
            Self::Quadrants => 4.0,
        }
    }

    /// The plane within its range that equals a plane from 0° to 360°, deg.
    pub(crate) fn folded(self, plane: f64) -> f64 {
        match self {
            Self::Rotational => 0.0,
            Self::Quadrants => {
                let half = plane.rem_euclid(180.0);
                half.min(180.0 - half)
            }
            Self::AboutC0 => plane.min(360.0 - plane),
            Self::AboutC90 if plane < 90.0 => 180.0 - plane,
            Self::AboutC90 if plane > 270.0 => 540.0 - plane,
            Self::AboutC90 | Self::None => plane,
        }
    }
}

/// Luminous intensities by C plane and angle γ, as of a goniometer of type C (CIE 121:1996): γ is 0° at the nadir and 180° at
/// the zenith. Between them they are linear in both angles; below the first and above the last angle they are zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Intensities {
    symmetry: PlaneSymmetry,
    planes_deg: Vec<f64>,
    angles_deg: Vec<f64>,
    /// Plane by plane, cd.
    candela: Vec<f64>,
}

impl Intensities {
    /// Intensities in cd, plane by plane, at these planes of the symmetry and angles in degrees.
    ///
    /// # Errors
    ///
    /// [`LuminaireError::NoDistribution`] if planes or angles do not increase or leave their range, or if an intensity is negative
    /// or not finite.
    pub fn new(
        symmetry: PlaneSymmetry,
        planes_deg: Vec<f64>,
        angles_deg: Vec<f64>,
        candela: Vec<f64>,
    ) -> Result<Self, LuminaireError> {
        let refuse = |problem: String| Err(LuminaireError::NoDistribution(problem));
        for (name, angles) in [("planes", &planes_deg), ("angles", &angles_deg)] {
            if angles.is_empty() || angles.len() > MAX_ANGLES {
                return refuse(format!("{} {name}, expected 1 to {MAX_ANGLES}", angles.len()));
            }
            if let Some(angle) = angles.iter().find(|angle| !angle.is_finite()) {
                return refuse(format!("{angle} among the {name}"));
            }
            if let Some(pair) = angles.windows(2).find(|pair| pair[0] >= pair[1]) {
                return refuse(format!(
                    "{name} must increase, and {} follows {}",
                    pair[1], pair[0]
                ));
            }
        }
        let [first, last] = symmetry.range();
        let ends = [planes_deg[0], planes_deg[planes_deg.len() - 1]];
        let fits = match symmetry {
            PlaneSymmetry::None => ends[0] == first && ends[1] < last,
            PlaneSymmetry::Rotational
            | PlaneSymmetry::Quadrants
            | PlaneSymmetry::AboutC0
            | PlaneSymmetry::AboutC90 => ends == [first, last],
        };
        if !fits {
            let [from, to] = ends;
            return refuse(format!(
                "planes from {from} to {to} do not fit the symmetry, {}",
                symmetry.name()
            ));
        }
        if !angles_deg.iter().all(|angle| (0.0..=180.0).contains(angle)) {
            return refuse("an angle lies outside of 0 to 180".to_owned());
        }
        if candela.len() != planes_deg.len() * angles_deg.len() {
            let [planes, angles] = [planes_deg.len(), angles_deg.len()];
            return refuse(format!(
                "{} intensities for {planes} planes of {angles} angles",
                candela.len()
            ));
        }
        if let Some(value) = candela.iter().find(|value| !(0.0..=MOST_CANDELA).contains(*value)) {
            return refuse(format!("an intensity of {value} cd"));
        }
        Ok(Self { symmetry, planes_deg, angles_deg, candela })
    }

    /// The symmetry.
    pub fn symmetry(&self) -> PlaneSymmetry {
        self.symmetry
    }

    /// Planes within the range of the symmetry, deg.
    pub fn planes_deg(&self) -> &[f64] {
        &self.planes_deg
    }

    /// Angles γ, deg.
    pub fn angles_deg(&self) -> &[f64] {
        &self.angles_deg
    }

    /// Intensities of a plane by its place, cd.
    pub fn plane(&self, place: usize) -> &[f64] {
        let angles = self.angles_deg.len();
        &self.candela[place * angles..(place + 1) * angles]
    }

    /// The largest intensity, cd.
    pub fn peak(&self) -> f64 {
        self.candela.iter().copied().fold(0.0, f64::max)
    }

    /// Intensity in any direction, cd: plane C and angle γ, deg.
    pub fn at(&self, plane_deg: f64, angle_deg: f64) -> f64 {
        let angles = &self.angles_deg;
        if !(angles[0]..=angles[angles.len() - 1]).contains(&angle_deg) {
            return 0.0;
        }
        let (place, share) = between(angles, angle_deg);
        let of_plane = |plane: usize| {
            let own = self.plane(plane);
            own[place] + share * (own[(place + 1).min(own.len() - 1)] - own[place])
        };
        let plane = self.symmetry.folded(plane_deg.rem_euclid(360.0));
        let planes = &self.planes_deg;
        let last = planes[planes.len() - 1];
        // Without symmetry the first plane follows the last.
        if plane > last {
            let share = (plane - last) / (planes[0] + 360.0 - last);
            return of_plane(planes.len() - 1) * (1.0 - share) + of_plane(0) * share;
        }
        let (place, share) = between(planes, plane);
        let next = (place + 1).min(planes.len() - 1);
        of_plane(place) * (1.0 - share) + of_plane(next) * share
    }

    /// Luminous flux, lm: the exact integral of the interpolated intensities.
    pub fn flux(&self) -> f64 {
        self.flux_between(0.0, 180.0)
    }

    /// Luminous flux of the zone between two angles γ in degrees, lm.
    pub fn flux_between(&self, from_deg: f64, to_deg: f64) -> f64 {
        let planes = &self.planes_deg;
        let widths: Vec<f64> = match self.symmetry {
            PlaneSymmetry::Rotational => vec![360.0],
            PlaneSymmetry::None => {
                let (first, last) = (planes[0], planes[planes.len() - 1]);
                let before = |place: usize| {
                    place.checked_sub(1).map_or(last - 360.0, |before| planes[before])
                };
                let after = |place: usize| planes.get(place + 1).copied().unwrap_or(first + 360.0);
                (0..planes.len()).map(|place| 0.5 * (after(place) - before(place))).collect()
            }
            PlaneSymmetry::Quadrants | PlaneSymmetry::AboutC0 | PlaneSymmetry::AboutC90 => {
                let at = |place: usize| planes[place.min(planes.len() - 1)];
                let width = |place: usize| 0.5 * (at(place + 1) - at(place.saturating_sub(1)));
                (0..planes.len()).map(|place| self.symmetry.copies() * width(place)).collect()
            }
        };
        let of_plane = |(place, width): (usize, &f64)| {
            let segments = self.angles_deg.windows(2).zip(self.plane(place).windows(2));
            let zone = segments.map(|(angles, ends)| {
                let cut = [angles[0].max(from_deg), angles[1].min(to_deg)];
                if cut[0] >= cut[1] {
                    return 0.0;
                }
                let at = |angle: f64| {
                    ends[0] + (ends[1] - ends[0]) * (angle - angles[0]) / (angles[1] - angles[0])
                };
                linear_over_ring(cut.map(f64::to_radians), cut.map(at))
            });
            width.to_radians() * zone.sum::<f64>()
        };
        widths.iter().enumerate().map(of_plane).sum()
    }

    /// The planes of the whole circle, from 0 to below 360, deg; one under rotational symmetry.
    pub fn circle(&self) -> Vec<f64> {
        let copies = |plane: f64| match self.symmetry {
            PlaneSymmetry::Rotational | PlaneSymmetry::None => vec![plane],
            PlaneSymmetry::AboutC0 => vec![plane, 360.0 - plane],
            // C0 is among them, even if the file leaves it out.
            PlaneSymmetry::AboutC90 => vec![plane, 540.0 - plane, 0.0],
            PlaneSymmetry::Quadrants => vec![plane, 180.0 - plane, 180.0 + plane, 360.0 - plane],
        };
        let mut all: Vec<f64> = self.planes_deg.iter().flat_map(|plane| copies(*plane)).collect();
        all.iter_mut().for_each(|plane| *plane = plane.rem_euclid(360.0));
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }
}

/// The place of the last of some increasing numbers that is not above a value within their range, and the share of the way
/// to the next, 1.
pub(crate) fn between(numbers: &[f64], value: f64) -> (usize, f64) {
    let place = numbers.partition_point(|number| *number <= value).saturating_sub(1);
    match numbers.get(place + 1) {
        Some(next) => (place, (value - numbers[place]) / (next - numbers[place])),
        None => (place, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cosine(step: f64) -> Intensities {
        let angles: Vec<f64> = (0..=(90.0 / step) as u32).map(|n| step * f64::from(n)).collect();
        let candela =
            angles.iter().map(|angle| 1000.0 * angle.to_radians().cos().max(0.0)).collect();
        Intensities::new(PlaneSymmetry::Rotational, vec![0.0], angles, candela).unwrap()
    }

    #[test]
    fn a_lambertian_table_has_the_flux_of_its_interpolation() {
        // Linear interpolation every 10° loses 0.25 % of π · 1000 cd: 3133.59342 lm.
        assert!((cosine(10.0).flux() - 3133.59342).abs() < 3e-4);
        // The law behind the table has π · 1000 cd.
        assert!((cosine(0.1).flux() / 3141.592654 - 1.0).abs() < 1e-6);
        assert!((cosine(10.0).at(77.0, 15.0) - 962.250_186_9).abs() < 1e-6);
        let zones = [0.0, 13.0, 40.0, 90.0]
            .windows(2)
            .map(|z| cosine(10.0).flux_between(z[0], z[1]))
            .sum::<f64>();
        assert!((zones - cosine(10.0).flux()).abs() < 1e-9);
        assert_eq!(cosine(10.0).at(0.0, 91.0), 0.0, "above the last angle");
    }

    #[test]
    fn every_symmetry_gives_the_flux_and_the_values_of_all_of_its_planes() {
        // A distribution with the symmetry, sampled in its range and over the whole circle.
        for symmetry in [PlaneSymmetry::Quadrants, PlaneSymmetry::AboutC0, PlaneSymmetry::AboutC90]
        {
            let [first, last] = symmetry.range();
            let of = |plane: f64| 100.0 + symmetry.folded(plane.rem_euclid(360.0));
            let planes: Vec<f64> =
                (0..=6).map(|n| first + (last - first) * f64::from(n) / 6.0).collect();
            let angles = vec![0.0, 60.0, 180.0];
            let values = |planes: &[f64]| planes.iter().flat_map(|c| [of(*c); 3]).collect();
            let part = Intensities::new(symmetry, planes.clone(), angles.clone(), values(&planes))
                .unwrap();
            let circle = part.circle();
            let whole =
                Intensities::new(PlaneSymmetry::None, circle.clone(), angles, values(&circle))
                    .unwrap();
            assert!((part.flux() / whole.flux() - 1.0).abs() < 1e-12, "{symmetry:?}");
            for plane in (0..72).map(|n| 5.0 * f64::from(n)) {
                let both = [part.at(plane, 20.0), whole.at(plane, 20.0)];
                assert!((both[0] - both[1]).abs() < 1e-9, "{symmetry:?} at {plane}: {both:?}");
            }
        }
    }

    #[test]
    fn what_is_no_distribution_is_refused() {
        let new = |planes: &[f64], angles: &[f64], value: f64| {
            let candela = vec![value; planes.len() * angles.len()];
            Intensities::new(PlaneSymmetry::None, planes.to_vec(), angles.to_vec(), candela)
        };
        assert!(new(&[0.0, 90.0], &[0.0, 90.0], 1.0).is_ok());
        for (planes, angles, value) in [
            (&[0.0, 0.0][..], &[0.0, 90.0][..], 1.0),
            (&[10.0], &[0.0, 90.0], 1.0),
            (&[0.0, 360.0], &[0.0, 90.0], 1.0),
            (&[0.0], &[90.0, 0.0], 1.0),
            (&[0.0], &[0.0, 190.0], 1.0),
            (&[0.0], &[0.0, f64::NAN], 1.0),
            (&[0.0], &[0.0, 90.0], -1.0),
            (&[0.0], &[0.0, 90.0], f64::NAN),
            (&[], &[0.0, 90.0], 1.0),
        ] {
            assert!(new(planes, angles, value).is_err(), "{planes:?} {angles:?} {value}");
        }
    }
}
