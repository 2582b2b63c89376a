//! Solids from mesh files: read, examined, placed.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::spec::solid::{MeshNormals, MeshSpec, MeshUnit};
use indexmap::IndexMap;
use lumiduct_base::math::Frame;
use lumiduct_base::mesh::{
    CopiedBody, Defects, MAX_SHOWN_TRIANGLES, MeshAssembly, MeshHealth, TriangleMesh,
};
use lumiduct_core::optics::FinishModel;
use lumiduct_core::scene::mesh::{Mesh, MeshBody, MeshPlace};
use lumiduct_core::scene::{FaceId, FinishId, SolidId};
use lumiduct_files::mesh::{self, LengthUnit};

/// Bounces for which the drift of a faceted wall is reported.
const DRIFT_BOUNCES: u32 = 100;

impl Context<'_> {
    /// Reads a mesh and examines it; problems with it are noted at its key.
    pub(super) fn read_mesh(
        &mut self,
        spec: &MeshSpec,
        key: &Key,
    ) -> Option<(MeshAssembly, MeshHealth)> {
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
        let bodies = self.builder.scene().mesh_bodies();
        let others: usize = bodies.map(MeshBody::triangle_count).sum();
        if others as u64 + mesh.triangle_count() > MAX_SHOWN_TRIANGLES {
            let most = MAX_SHOWN_TRIANGLES / 1_000_000;
            let message =
                format!("the meshes of the scene have more than {most} million triangles");
            self.problems.error(&file, message).hint("export coarser meshes with smooth normals");
            return None;
        }
        self.meshes.add_assembly(&mesh);
        if spec.normals == MeshNormals::Facet {
            mesh.drop_normals();
        }
        let health = mesh.health();
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
            let drift = match facets.skew_drift(f64::from(DRIFT_BOUNCES)) {
                Some(drift) => format!("drift by about {:.1} %", 100.0 * drift),
                None => "lose their skewness".to_owned(),
            };
            let turn = facets.per_turn();
            let message = format!(
                "`{name}` looks curved but its facets are flat: {turn:.0} per turn, so skew rays {drift} in {DRIFT_BOUNCES} bounces"
            );
            self.problems.warning(key, message).hint("export vertex normals, or use a sweep");
        }
    }

    /// The finishes outside and inside the faces of a mesh, by their names.
    pub(super) fn mesh_finishes(
        &mut self,
        name: &str,
        mesh: &MeshAssembly,
        declared: &IndexMap<&str, Option<FinishId>>,
        key: &Key,
    ) -> MeshFinishes {
        let mut finishes: MeshFinishes =
            mesh.faces().into_keys().map(|face| (face.to_owned(), [None; 2])).collect();
        for (&face, &finish) in declared {
            let has_grain =
                |finish: FinishId| self.builder.scene().finishes[finish.index()].finish.has_grain();
            if finish.is_some_and(has_grain) {
                let message = "a prism film, or a scatter file that depends on a direction along the face, cannot be put on a mesh: a mesh has no direction along the guide";
                self.problems.error(&key.field(face), message).hint("use a sweep or a tube");
            }
            match finishes.get_mut(face) {
                Some(own) => *own = [finish.map(|finish| self.behind(finish)), finish],
                None => {
                    let known: Vec<&str> = finishes.keys().map(String::as_str).collect();
                    self.note_no_face(name, face, &known, key);
                }
            }
        }
        finishes
    }

    /// Adds a mesh as the boundary of a solid.
    pub(super) fn add_mesh(
        &mut self,
        name: &str,
        solid: SolidId,
        MeshAssembly { mesh, copied, .. }: MeshAssembly,
        finishes: &MeshFinishes,
        frame: &Frame,
    ) {
        let of = |mesh: &TriangleMesh| -> Vec<_> {
            mesh.faces.iter().map(|face| finishes[face.as_str()]).collect()
        };
        let mut faces: Vec<FaceId> = Vec::new();
        if !mesh.triangles.is_empty() {
            let finishes = of(&mesh);
            let own = Mesh::moved(mesh, frame);
            faces.extend(self.builder.add_mesh(name, solid, own, &finishes));
        }
        for CopiedBody { body, places } in copied {
            let finishes = of(&body);
            let own = Mesh::moved(body, &Frame::WORLD);
            let places = places.iter().map(|place| MeshPlace::new(place, frame)).collect();
            let added = self.builder.add_mesh_copies(name, solid, (own, places), &finishes);
            faces.extend(added);
        }
        for face in faces {
            let name = self.builder.scene().faces[face.index()].name.clone();
            self.faces.insert(name, vec![face]);
        }
    }
}

/// The finishes outside and inside each face of a mesh.
pub(super) type MeshFinishes = IndexMap<String, [Option<FinishId>; 2]>;
