//! Finishes by a law of haze, and by tables against the angle.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::finishes::{Least, SUM_TOLERANCE};
use crate::lower::laws::whole_nm;
use crate::spec::finish::{AbgSpec, HarveySpec, HazeSheetSpec, HazeSidesSpec, TabulatedSpec};
use lumiduct_base::number::format_value;
use lumiduct_core::optics::{
    AngleTable, Finish, Haze, HazeBase, HazeLaw, HazeSides, Medium, integrated_scatter,
};

impl Context<'_> {
    pub(super) fn abg(&mut self, spec: &AbgSpec, key: &Key) -> Option<Finish> {
        self.haze(HazeLaw::Abg { a: spec.a, b: spec.b, g: spec.g }, &spec.sheet, "a", key)
    }

    pub(super) fn harvey(&mut self, spec: &HarveySpec, key: &Key) -> Option<Finish> {
        let law = HazeLaw::Harvey { b0: spec.b0, shoulder: spec.l, slope: spec.s };
        self.haze(law, &spec.sheet, "b0", key)
    }

    /// Haze that scatters no more light than there is; `strength` is the key that scales it.
    fn haze(
        &mut self,
        law: HazeLaw,
        sheet: &HazeSheetSpec,
        strength: &str,
        key: &Key,
    ) -> Option<Finish> {
        let hint = format!("lower `{strength}`");
        let base = match (sheet.reflectance, sheet.transmittance) {
            (None, None) => self.hazy_interface(law, sheet, hint, key)?,
            (reflectance, transmittance) => {
                let shares = [reflectance, transmittance].map(|share| share.unwrap_or(0.0));
                self.hazy_sheet(law, shares, sheet, &hint, key)?
            }
        };
        Some(Finish::Haze(Box::new(Haze::new(law, base))))
    }

    fn hazy_sheet(
        &mut self,
        law: HazeLaw,
        [reflectance, transmittance]: [f64; 2],
        sheet: &HazeSheetSpec,
        hint: &str,
        key: &Key,
    ) -> Option<HazeBase> {
        let mut good = self.check_sum(key, [reflectance, transmittance], Least::AboveZero);
        let scatters = match sheet.scatters {
            None | Some(HazeSidesSpec::Both) => HazeSides::Both,
            Some(HazeSidesSpec::Reflected) => HazeSides::Reflected,
            Some(HazeSidesSpec::Transmitted) => HazeSides::Transmitted,
        };
        let all = integrated_scatter(law, 1.0);
        for (name, share, other) in [
            ("reflectance", reflectance, HazeSides::Transmitted),
            ("transmittance", transmittance, HazeSides::Reflected),
        ] {
            if scatters != other && share > 0.0 && all > share + SUM_TOLERANCE {
                let found = format_value(all);
                let message = format!(
                    "total integrated scatter is {found} at normal incidence, expected at most the {name} of {share}"
                );
                good = self.refuse(key, message, hint);
            }
        }
        good.map(|()| HazeBase::Sheet { reflectance, transmittance, scatters })
    }

    fn hazy_interface(
        &mut self,
        law: HazeLaw,
        sheet: &HazeSheetSpec,
        hint: String,
        key: &Key,
    ) -> Option<HazeBase> {
        if sheet.scatters.is_some() {
            self.problems.error(
                &key.field("scatters"),
                "an interface of two media scatters to both sides; expected a reflectance or a transmittance beside it",
            );
        }
        // Into the densest medium that may be on either side.
        let highest = |medium: &Medium| whole_nm().map(|nm| medium.index(nm)).fold(1.0, f64::max);
        let index = self.builder.scene().media.iter().map(highest).fold(1.0, f64::max);
        let all = 2.0 * integrated_scatter(law, index);
        if all > 1.0 {
            let found = format_value(all);
            let message = format!(
                "scatters {found} of the light at normal incidence to two sides of index {index}, expected at most 1"
            );
            return self.refuse(key, message, hint);
        }
        sheet.scatters.is_none().then_some(HazeBase::Interface)
    }

    pub(super) fn tabulated(&mut self, spec: &TabulatedSpec, key: &Key) -> Option<Finish> {
        let (angles, reflected) = (&spec.angles_deg, &spec.reflectance);
        let Some(transmitted) = &spec.transmittance else {
            let [reflectance] = self.table(angles, [("reflectance", reflected)], key)?;
            let transmittance = AngleTable::constant(0.0);
            return Some(Finish::Tabulated { reflectance, transmittance });
        };
        let columns = [("reflectance", reflected), ("transmittance", transmitted)];
        let tables = self.table(angles, columns, key);
        let mut rows = angles.iter().zip(reflected.iter().zip(transmitted));
        let beyond = rows
            .find(|(_, (reflected, transmitted))| *reflected + *transmitted > 1.0 + SUM_TOLERANCE);
        if let Some((angle, (reflected, transmitted))) = beyond {
            let sum = reflected + transmitted;
            let message = format!(
                "reflectance and transmittance at {angle} deg add up to {sum}, expected at most 1"
            );
            self.problems.error(key, message);
            return None;
        }
        tables.map(|[reflectance, transmittance]| Finish::Tabulated { reflectance, transmittance })
    }

    /// Columns of a table against angles that increase from 0 to 90 deg: nothing is extrapolated.
    pub(super) fn table<const N: usize>(
        &mut self,
        angles: &[f64],
        columns: [(&str, &Vec<f64>); N],
        key: &Key,
    ) -> Option<[AngleTable; N]> {
        let place = key.field("angles_deg");
        let mut good = Some(());
        if let Some(index) = angles.windows(2).position(|pair| pair[1] <= pair[0]) {
            let (before, after) = (angles[index], angles[index + 1]);
            let message = format!("{after} comes after {before}, expected angles that increase");
            self.problems.error(&place.index(index + 1), message);
            good = None;
        } else if let (Some(first), Some(last)) = (angles.first(), angles.last())
            && (*first != 0.0 || *last != 90.0)
        {
            let message = format!("go from {first} to {last}, expected 0 to 90");
            good = self.refuse(&place, message, "also give the values at 0 and at 90 deg");
        }
        for (name, values) in columns {
            if values.len() != angles.len() {
                let message = format!("{} values for {} angles", values.len(), angles.len());
                self.problems.error(&key.field(name), message);
                good = None;
            }
        }
        good.map(|()| columns.map(|(_, values)| angle_table(angles, values)))
    }
}

/// A table of as many values, 1, as angles, deg.
fn angle_table(angles_deg: &[f64], values: &[f64]) -> AngleTable {
    let rows = angles_deg.iter().zip(values);
    AngleTable::new(rows.map(|(angle, value)| [angle.to_radians(), *value]).collect())
}
