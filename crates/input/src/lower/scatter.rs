//! Scatter of sheets from files: read and made finishes.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::scatter::measured_sheet;
use crate::spec::finish::{ScatterFileSideSpec, ScatterFileSpec};
use lumiduct_core::optics::{Finish, SheetSide};
use lumiduct_files::scatter::{self, BsdfMatrix, ScatterFile};
use std::sync::Arc;

impl Context<'_> {
    pub(super) fn scatter_file(&mut self, spec: &ScatterFileSpec, key: &Key) -> Option<Finish> {
        let key = key.field("file");
        self.may_build(&key)?;
        let path = self.places.folder(&key).join(&spec.file);
        let file = match scatter::read(&path) {
            Ok(file) => file,
            Err(error) => {
                self.problems.error(&key, format!("`{}`: {error}", spec.file));
                return None;
            }
        };
        self.add_scatter_to_hash(&file);
        let (sheet, remarks) = match measured_sheet(file, spec.turn_deg.to_radians()) {
            Ok(made) => made,
            Err(problem) => {
                self.problems.error(&key, format!("`{}`: {problem}", spec.file));
                return None;
            }
        };
        for remark in remarks {
            self.problems.warning(&key, format!("`{}`: {remark}", spec.file));
        }
        let met = match spec.side {
            ScatterFileSideSpec::Front => SheetSide::Front,
            ScatterFileSideSpec::Back => SheetSide::Back,
        };
        Some(Finish::MeasuredSheet { sheet: Arc::new(sheet), met })
    }

    /// The hash of the scene contains what is used of the file.
    fn add_scatter_to_hash(&mut self, file: &ScatterFile) {
        for side in [&file.front, &file.back] {
            for matrix in [&side.reflection, &side.transmission] {
                self.meshes.add(&[u8::from(matrix.is_some())]);
                let Some(BsdfMatrix { pairs, values, .. }) = matrix else { continue };
                let [incident, leaving] = pairs.counts();
                let sizes = (0..incident).map(|patch| pairs.incident_projected(patch));
                let sizes = sizes.chain((0..leaving).map(|patch| pairs.leaving_projected(patch)));
                let all = sizes.chain(values.iter().copied());
                all.for_each(|number| self.meshes.add(&number.to_le_bytes()));
            }
        }
    }
}
