//! Stacks of thin layers, and what can be wrong with their materials.

use crate::keys::Key;
use crate::lower::context::{Context, FinishTable};
use crate::lower::laws::{index_table, whole_nm};
use crate::lower::spectra::is_spectral;
use crate::spec::coating::{
    ExtinctionSpec, ExtinctionTableSpec, LayerIndexSpec, LayerSpec, StackSpec,
};
use lumiduct_base::number::format_value;
use lumiduct_core::colour::SpectralTable;
use lumiduct_core::optics::{Finish, IndexLaw, LayerStack, REFERENCE_WAVELENGTH, ThinLayer};
use lumiduct_files::spectral::SpectralColumn;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Refractive indices of thin layers, metals included, 1.
const INDICES: RangeInclusive<f64> = 0.01..=10.0;
/// Extinction coefficients, 1; those of metals in visible light are below 9.
const EXTINCTIONS: RangeInclusive<f64> = 0.0..=20.0;

impl Context<'_> {
    pub(super) fn stack(&mut self, spec: &StackSpec, key: &Key) -> Option<Finish> {
        let wavelength = self.wavelength_of_stack(spec, key);
        // All layers are looked at, whatever is wrong with the first.
        let layers: Vec<Option<ThinLayer>> = spec
            .layers
            .iter()
            .enumerate()
            .map(|(at, layer)| self.layer(layer, wavelength, &key.field("layers").index(at)))
            .collect();
        let layers = layers.into_iter().collect::<Option<_>>()?;
        Some(Finish::Stack(Arc::new(LayerStack::new(layers, wavelength))))
    }

    /// The wavelength at which a stack acts on all light, nm; `None` in a scene with spectra.
    fn wavelength_of_stack(&mut self, spec: &StackSpec, key: &Key) -> Option<f64> {
        let field = key.field("wavelength_nm");
        match (is_spectral(self.spec), spec.wavelength_nm) {
            (false, Some(wavelength)) => Some(wavelength),
            (false, None) => {
                let message =
                    format!("no source has a spectrum: it acts as at {REFERENCE_WAVELENGTH} nm");
                self.problems
                    .warning(key, message)
                    .hint("give every source a `spectrum`, or the stack a `wavelength_nm`");
                Some(REFERENCE_WAVELENGTH)
            }
            (true, Some(_)) => {
                let message =
                    "the sources have spectra: a stack acts at the wavelength of each path";
                self.refuse(&field, message, "remove this")
            }
            (true, None) => None,
        }
    }

    fn layer(&mut self, spec: &LayerSpec, wavelength: Option<f64>, key: &Key) -> Option<ThinLayer> {
        let [index_key, extinction_key] = ["index", "extinction"].map(|name| key.field(name));
        let index = match &spec.index {
            LayerIndexSpec::Constant(index) => Some(IndexLaw::Constant(*index)),
            LayerIndexSpec::Law(law) => self.index_law_within(INDICES, law, &index_key),
        };
        let extinction = self.extinction(&spec.extinction, &extinction_key);
        let (index, extinction) = (index?, extinction?);
        for (law, key) in [(&index, &index_key), (&extinction, &extinction_key)] {
            if let Some(range) = index_table(law).map(SpectralTable::range) {
                self.finish_tables.push(FinishTable { key: key.clone(), range, wavelength });
            }
        }
        let at_stack = wavelength.map(|nm| (nm, index.at(nm)));
        // Not a number beyond a pole of the law.
        if let Some((nm, value)) = at_stack.filter(|(_, value)| !INDICES.contains(value)) {
            let message =
                format!("makes the index {} at {} nm", format_value(value), format_value(nm));
            let (least, most) = (INDICES.start(), INDICES.end());
            let hint = format!("expected {least} to {most} at the wavelength of the stack");
            return self.refuse(&index_key, message, hint);
        }
        let mut places: Vec<f64> = whole_nm().chain(wavelength).collect();
        places.retain(|nm| index.at(*nm) < 1.0 && extinction.at(*nm) == 0.0);
        if let Some(nm) = places.first() {
            let value = format_value(index.at(*nm));
            let message =
                format!("{value} is below 1 without an extinction, expected 1 or more at {nm} nm");
            return self.refuse(&index_key, message, "metals have an `extinction` above 0");
        }
        Some(ThinLayer { index, extinction, thickness: spec.thickness_nm })
    }

    fn extinction(&mut self, spec: &ExtinctionSpec, key: &Key) -> Option<IndexLaw> {
        let (rows, key) = match spec {
            ExtinctionSpec::Constant(extinction) => return Some(IndexLaw::Constant(*extinction)),
            ExtinctionSpec::Table(ExtinctionTableSpec::ByNm(rows)) => {
                (rows.clone(), key.field("by_nm"))
            }
            ExtinctionSpec::Table(ExtinctionTableSpec::Csv(file)) => {
                let key = key.field("csv");
                let found = self.read_by_wavelength(file, SpectralColumn::Named(&["k"]), &key)?;
                (found.rows, key)
            }
        };
        if let Some([nm, value]) = rows.iter().find(|[_, value]| !EXTINCTIONS.contains(value)) {
            let message = format!("is {} at {} nm", format_value(*value), format_value(*nm));
            return self.refuse(&key, message, "expected 0 to 20: layers do not amplify light");
        }
        Some(IndexLaw::Table(self.spectral_table(rows, &key)?))
    }
}
