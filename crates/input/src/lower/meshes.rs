//! Solids from mesh files: read, examined, placed.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::spec::solid::{MeshNormals, MeshSpec, MeshUnit};
use indexmap::IndexMap;
use lumiduct_base::math::Frame;
use lumiduct_base::mesh::{Defects, MeshHealth, TriangleMesh, health};
use lumiduct_core::optics::FinishModel;
use lumiduct_core::scene::mesh::Mesh;
use lumiduct_core::scene::{FinishId, SolidId};
use lumiduct_files::mesh::{self, LengthUnit};

/// Bounces for which the drift of a faceted wall is reported.
const DRIFT_BOUNCES: u32 = 100;

impl Context<'_> {
    /// Reads a mesh and examines it; problems with it are noted at its key.
    pub(super) fn read_mesh(
        &mut self,
        spec: &MeshSpec,
        key: &Key,
    ) -> Option<(TriangleMesh, MeshHealth)> {
        let file = key.field("file");
        self.may_build(&file)?;
        let path = self.places.folder(&file).join(&spec.file);
        let unit = match spec.unit {
            MeshUnit::Mm => LengthUnit::Millimetre,
            MeshUnit::Cm => LengthUnit::Centimetre,
            MeshUnit::M => LengthUnit::Metre,
            MeshUnit::Inch => LengthUnit::Inch,
        };
        let mut mesh = match mesh::read(&path, unit) {
            Ok(mesh) => mesh,
            Err(error) => {
                self.problems.error(&file, format!("`{}`: {error}", spec.file));
                return None;
            }
        };
        self.meshes.add_mesh(&mesh);
        if spec.normals == MeshNormals::Facet {
            mesh.normals = None;
        }
        let health = health(&mesh);
        self.note_defects(spec, &health, &file);
        Some((mesh, health))
    }

    /// Notes defects and coarseness of a mesh.
    fn note_defects(&mut self, spec: &MeshSpec, health: &MeshHealth, key: &Key) {
        let name = &spec.file;
        let defects = [
            (health.open_edges, "open edges: it is not closed"),
            (health.crowded_edges, "edges with more than two triangles"),
            (health.inconsistent_edges, "edges whose two triangles face opposite sides"),
        ];
        for (Defects { count, first }, what) in defects {
            if let Some(at) = first {
                let place = format!("the first at [{:.4}, {:.4}, {:.4}] mm", at.x, at.y, at.z);
                self.problems.error(key, format!("`{name}` has {count} {what}, {place}")).hint(
                    "repair the mesh: a solid needs a closed surface that faces outward everywhere",
                );
            }
        }
        if health.open_edges.count == 0 && health.signed_volume_mm3 < 0.0 {
            let volume = health.signed_volume_mm3;
            let message = format!("`{name}` is inside out: its volume is {volume:.4} mm³");
            self.problems.error(key, message).hint("flip the orientation of its triangles");
        }
        let remarks = [
            (health.degenerate_triangles, "triangles without area"),
            (health.slivers, "slivers: triangles too thin for a reliable normal"),
            (health.opposed_normals, "triangles with normals that point backward"),
        ];
        for (Defects { count, .. }, what) in remarks.iter().filter(|(defects, _)| defects.count > 0)
        {
            self.problems
                .warning(key, format!("`{name}` has {count} {what}"))
                .hint("run `lumiduct mesh FILE` to see where");
        }
        if let Some(facets) = &health.facets {
            let drift = 100.0 * facets.skew_drift(f64::from(DRIFT_BOUNCES));
            self.problems
                .warning(
                    key,
                    format!(
                        "`{name}` looks curved but its facets are flat: {:.0} per turn, so skew rays drift by about \
                         {drift:.1} % in {DRIFT_BOUNCES} bounces",
                        facets.per_turn()
                    ),
                )
                .hint("export vertex normals, or use a sweep");
        }
    }

    /// The finishes outside and inside the faces of a mesh, in their order.
    pub(super) fn mesh_finishes(
        &mut self,
        name: &str,
        mesh: &TriangleMesh,
        declared: &IndexMap<&str, Option<FinishId>>,
        key: &Key,
    ) -> Vec<[Option<FinishId>; 2]> {
        let known: Vec<&str> = mesh.faces.iter().map(String::as_str).collect();
        let mut finishes = vec![[None; 2]; known.len()];
        for (&face, &finish) in declared {
            let has_grain =
                |finish: FinishId| self.builder.scene().finishes[finish.index()].finish.has_grain();
            if finish.is_some_and(has_grain) {
                let message = "a prism film, or a scatter file that depends on a direction along the face, cannot be put on a mesh: a mesh has no direction along the guide";
                self.problems.error(&key.field(face), message).hint("use a sweep or a tube");
            }
            match known.iter().position(|name| *name == face) {
                Some(index) => {
                    let outside = finish.map(|finish| self.behind(finish));
                    finishes[index] = [outside, finish];
                }
                None => self.note_no_face(name, face, &known, key),
            }
        }
        finishes
    }

    /// Adds a mesh as the boundary of a solid.
    pub(super) fn add_mesh(
        &mut self,
        name: &str,
        solid: SolidId,
        mesh: &TriangleMesh,
        finishes: &[[Option<FinishId>; 2]],
        frame: &Frame,
    ) {
        let faces = self.builder.add_mesh(name, solid, Mesh::new(mesh, frame), finishes);
        for (face, id) in mesh.faces.iter().zip(faces) {
            self.faces.insert(format!("{name}.{face}"), vec![id]);
        }
    }
}
