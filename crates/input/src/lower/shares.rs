//! Shares of light by wavelength, and what can be wrong with them.

use crate::keys::Key;
use crate::lower::context::{Context, FinishTable};
use crate::lower::finishes::{Least, SUM_TOLERANCE};
use crate::lower::spectra::is_spectral;
use crate::spec::spectrum::{ShareSpec, ShareTableSpec};
use lumiduct_base::number::format_value;
use lumiduct_core::optics::{
    Finish, REFERENCE_WAVELENGTH, ScatterLaw, SpectralFinish, SpectralShare,
};
use lumiduct_files::spectral::SpectralColumn;

impl Context<'_> {
    /// A finish that reflects and transmits these shares of light.
    pub(super) fn with_shares(
        &mut self,
        scatter: ScatterLaw,
        shares: [&ShareSpec; 2],
        least: Least,
        key: &Key,
    ) -> Option<Finish> {
        if let [ShareSpec::Constant(reflectance), ShareSpec::Constant(transmittance)] = shares {
            let shares = [*reflectance, *transmittance];
            self.check_sum(key, shares, least)?;
            return Some(Finish::with_shares(scatter, shares));
        }
        let [reflectance, transmittance] = shares;
        let reflectance = self.share(reflectance, &key.field("reflectance"));
        let transmittance = self.share(transmittance, &key.field("transmittance"));
        let (reflectance, transmittance) = (reflectance?, transmittance?);
        self.check_sums([&reflectance, &transmittance], least, key)?;
        Some(Finish::Spectral(Box::new(SpectralFinish { scatter, reflectance, transmittance })))
    }

    fn share(&mut self, spec: &ShareSpec, key: &Key) -> Option<SpectralShare> {
        let (rows, field) = match spec {
            ShareSpec::Constant(share) => return Some(SpectralShare::Constant(*share)),
            ShareSpec::Table(ShareTableSpec::ByNm(rows)) => (rows.clone(), key.field("by_nm")),
            ShareSpec::Table(ShareTableSpec::Csv(file)) => {
                let field = key.field("csv");
                (self.read_by_wavelength(file, SpectralColumn::Second, &field)?.rows, field)
            }
        };
        if let Some([nm, share]) = rows.iter().find(|[_, share]| !(0.0..=1.0).contains(share)) {
            let message = format!("is {} at {} nm", format_value(*share), format_value(*nm));
            return self.refuse(
                &field,
                message,
                "expected 0 to 1; a share in percent is divided by 100",
            );
        }
        let table = self.spectral_table(rows, &field)?;
        let wavelength = (!is_spectral(self.spec)).then_some(REFERENCE_WAVELENGTH);
        if wavelength.is_some() {
            self.problems
                .warning(key, "no source has a spectrum: its value at 555 nm applies")
                .hint("give every source a `spectrum`");
        }
        self.finish_tables.push(FinishTable { key: key.clone(), range: table.range(), wavelength });
        Some(SpectralShare::Table(table))
    }

    /// Notes shares with an impossible sum; between rows they are linear, so that rows are enough.
    fn check_sums(&mut self, shares: [&SpectralShare; 2], least: Least, key: &Key) -> Option<()> {
        let rows = shares.iter().filter_map(|share| share.table()).flat_map(|table| table.rows());
        let sums = rows.map(|[nm, _]| (shares.map(|share| share.at(*nm)).iter().sum::<f64>(), *nm));
        let (sum, nm) = sums.fold((0.0, 0.0), |most, own| if own.0 > most.0 { own } else { most });
        if sum > 1.0 + SUM_TOLERANCE {
            let nm = format_value(nm);
            let message =
                format!("reflectance and transmittance add up to {} at {nm} nm", format_value(sum));
            return self.refuse(key, message, "expected at most 1 at every wavelength");
        }
        // The message for shares that are 0 at every wavelength.
        self.check_sum(key, [sum.min(1.0), 0.0], least)
    }
}
