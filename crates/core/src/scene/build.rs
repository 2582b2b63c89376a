//! Putting a scene together: tables first, then the whole.

use crate::optics::{Finish, Medium};
use crate::plan::Polarisation;
use crate::scene::crossing::convex::{Convex, ConvexSolids};
use crate::scene::mesh::{Mesh, MeshBody, MeshPlace};
use crate::scene::pattern::Pattern;
use crate::scene::relief::surfaces::surfaces;
use crate::scene::relief::{PatchCut, Relief, ReliefWall, Trim};
use crate::scene::{
    Accel, COINCIDENCE, Face, FaceId, FacePiece, FinishId, LightGroups, MediumId, MeshPieces,
    NamedFinish, Owner, Patch, PieceRange, PrimId, Scene, Sensor, SensorId, SensorKind, Solid,
    SolidId, Source, SourceId, SourceSpectra,
};
use glam::DVec3;
use lumiduct_base::math::Aabb;
use lumiduct_base::units::FluxUnit;
use std::collections::HashMap;
use std::sync::Arc;

/// Surfaces of a relief overlap by this many ulp of the largest coordinate where they meet:
/// rounding of a point on a ray and of the test for the side of an edge.
const LAP_ULP: f64 = 8.0;

/// Collects the parts of a scene. Coordinates are relative to `origin` in the user's coordinates.
#[derive(Debug)]
pub struct Builder {
    scene: Scene,
}

/// A face to be added.
#[derive(Debug)]
pub struct FaceSpec {
    /// Dotted name.
    pub name: String,
    /// Its owner.
    pub owner: Owner,
    /// Finish met from the front.
    pub front: Option<FinishId>,
    /// Finish met from the back.
    pub back: Option<FinishId>,
    /// The smooth pieces it consists of.
    pub pieces: Vec<FacePiece>,
}

impl Builder {
    /// An empty scene about `origin` [mm of the user's coordinates], in a medium.
    pub fn new(origin: DVec3, surroundings: Medium, unit: FluxUnit) -> Self {
        let scene = Scene {
            origin,
            bounds: Aabb::EMPTY,
            unit,
            polarisation: Polarisation::Ignored,
            media: vec![surroundings],
            surroundings: MediumId::new(0),
            finishes: Vec::new(),
            solids: Vec::new(),
            faces: Vec::new(),
            patterns: Vec::new(),
            reliefs: Vec::new(),
            patches: Vec::new(),
            meshes: Vec::new(),
            copies: Vec::new(),
            first_of_copies: 0,
            ports: Vec::new(),
            sources: Vec::new(),
            spectra: SourceSpectra::default(),
            light: LightGroups::default(),
            sensors: Vec::new(),
            tolerance: 0.0,
            accel: Accel::new([0; 2], |_| Aabb::EMPTY, 0.0),
            convex: Vec::new(),
            loose: Vec::new(),
            legs: Vec::new(),
        };
        Self { scene }
    }

    /// What has been added so far.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Adds a medium.
    pub fn add_medium(&mut self, medium: Medium) -> MediumId {
        self.scene.media.push(medium);
        MediumId::new(self.scene.media.len() - 1)
    }

    /// Adds a finish.
    pub fn add_finish(&mut self, name: &str, finish: Finish) -> FinishId {
        self.scene.finishes.push(NamedFinish { name: name.to_owned(), finish });
        FinishId::new(self.scene.finishes.len() - 1)
    }

    /// Adds a solid; its faces follow.
    pub fn add_solid(&mut self, solid: Solid) -> SolidId {
        self.scene.solids.push(solid);
        SolidId::new(self.scene.solids.len() - 1)
    }

    /// Adds a face with its pieces.
    pub fn add_face(&mut self, spec: FaceSpec) -> FaceId {
        let face = FaceId::new(self.scene.faces.len());
        let table = match spec.owner {
            Owner::Solid(_) | Owner::Sheet => &mut self.scene.patches,
            Owner::Port => &mut self.scene.ports,
        };
        let first = table.len();
        let mut bounds = Aabb::EMPTY;
        for piece in spec.pieces {
            bounds = bounds.union(piece.shape.bounds());
            let FacePiece { shape, smooth, chart, trim } = piece;
            table.push(Patch { shape, face, owner: spec.owner, smooth, chart, trim });
        }
        let range = first..table.len();
        let extent = match spec.owner {
            Owner::Solid(_) | Owner::Sheet => PieceRange::Patches(range),
            Owner::Port => PieceRange::Ports(range),
        };
        self.grow(spec.owner, bounds);
        self.scene.faces.push(Face {
            name: spec.name,
            owner: spec.owner,
            front: spec.front,
            back: spec.back,
            patterns: Vec::new(),
            extent,
        });
        face
    }

    /// Adds a closed mesh to the boundary of a solid. `finishes` has those outside and inside of each of its
    /// faces; a face's name is `prefix` followed by its name in the mesh.
    pub fn add_mesh(
        &mut self,
        prefix: &str,
        solid: SolidId,
        mesh: Mesh,
        finishes: &[[Option<FinishId>; 2]],
    ) -> Vec<FaceId> {
        let owner = Owner::Solid(solid);
        let number = self.scene.meshes.len();
        let names = face_names(prefix, &mesh);
        let own = |face| MeshPieces { own: Some((number, face)), copies: Vec::new() };
        let faces: Vec<FaceId> = names
            .into_iter()
            .zip(finishes)
            .enumerate()
            .map(|(face, (name, finishes))| self.mesh_face(name, owner, *finishes, own(face)))
            .collect();
        // The number of the first triangle is known once all patches are added.
        let body = MeshBody::new(mesh, solid, faces.clone());
        self.grow(owner, body.bounds());
        self.scene.meshes.push(body);
        faces
    }

    /// Adds copies of a closed mesh, which share its triangles, to the boundary of a solid. Faces of the solid that have the same names
    /// grow by theirs.
    pub fn add_mesh_copies(
        &mut self,
        prefix: &str,
        solid: SolidId,
        (mesh, places): (Mesh, Vec<MeshPlace>),
        finishes: &[[Option<FinishId>; 2]],
    ) -> Vec<FaceId> {
        let owner = Owner::Solid(solid);
        let first = self.scene.copies.len();
        let bodies = first..first + places.len();
        let of_solid = self.scene.faces.iter().enumerate().filter(|(_, face)| face.owner == owner);
        let known: HashMap<String, FaceId> =
            of_solid.map(|(index, face)| (face.name.clone(), FaceId::new(index))).collect();
        let mut faces = Vec::new();
        let names = face_names(prefix, &mesh).into_iter();
        for (index, (name, finishes)) in names.zip(finishes).enumerate() {
            let copies = (bodies.clone(), index);
            let known = known.get(&name).copied();
            match known.map(|face| (face, &mut self.scene.faces[face.index()].extent)) {
                Some((face, PieceRange::Mesh(pieces))) => {
                    pieces.copies.push(copies);
                    if let Some((own, face)) = pieces.own {
                        self.scene.meshes[own].forget_plane(face);
                    }
                    faces.push(face);
                }
                Some((_, PieceRange::Patches(_) | PieceRange::Ports(_))) | None => {
                    let pieces = MeshPieces { own: None, copies: vec![copies] };
                    faces.push(self.mesh_face(name, owner, *finishes, pieces));
                }
            }
        }
        let copies: Vec<MeshBody> = MeshBody::copies(mesh, places, solid, faces.clone()).collect();
        self.grow(owner, copies.iter().map(MeshBody::bounds).fold(Aabb::EMPTY, Aabb::union));
        self.scene.copies.extend(copies);
        faces
    }

    fn mesh_face(
        &mut self,
        name: String,
        owner: Owner,
        [front, back]: [Option<FinishId>; 2],
        pieces: MeshPieces,
    ) -> FaceId {
        let (patterns, extent) = (Vec::new(), PieceRange::Mesh(pieces));
        self.scene.faces.push(Face { name, owner, front, back, patterns, extent });
        FaceId::new(self.scene.faces.len() - 1)
    }

    fn grow(&mut self, owner: Owner, bounds: Aabb) {
        if let Owner::Solid(solid) = owner {
            let solid = &mut self.scene.solids[solid.index()];
            solid.bounds = solid.bounds.union(bounds);
        }
        self.scene.bounds = self.scene.bounds.union(bounds);
    }

    /// Adds a pattern to the face that it names.
    pub fn add_pattern(&mut self, pattern: Pattern) {
        self.scene.faces[pattern.face.index()].patterns.push(self.scene.patterns.len());
        self.scene.patterns.push(pattern);
    }

    /// Makes a relief part of the solid of its wall; `sides` are the patches that its grooves cut
    /// through at their ends, by their numbers. Its elements form a separate face with the given
    /// finishes, front and back.
    pub fn add_relief(
        &mut self,
        relief: Relief,
        sides: &[(usize, ReliefWall)],
        [front, back]: [Option<FinishId>; 2],
    ) -> FaceId {
        let (wall, owner) = (relief.wall, self.scene.owner(relief.wall));
        let size = self.scene.bounds.largest_coordinate();
        let pieces = relief.pieces(LAP_ULP * f64::EPSILON * size);
        let relief = Arc::new(relief);
        if let Owner::Solid(solid) = owner {
            let volume = &mut self.scene.solids[solid.index()].volume;
            *volume = volume.map(|volume| volume + relief.volume());
        }
        let mut cut = |index: usize, cut: PatchCut| {
            let trim = &mut self.scene.patches[index].trim;
            let mut cuts = trim.take().map_or_else(Vec::new, |trim| trim.cuts.clone());
            cuts.push(cut);
            *trim = Some(Arc::new(Trim { cuts }));
        };
        if let PieceRange::Patches(range) = &self.scene.faces[wall.index()].extent {
            range.clone().for_each(|index| cut(index, PatchCut::Wall(Arc::clone(&relief))));
        }
        for (index, ground) in sides {
            cut(*index, PatchCut::Side { relief: Arc::clone(&relief), side: *ground });
        }
        let name = relief.name.clone();
        self.scene.reliefs.push(relief);
        self.add_face(FaceSpec { name, owner, front, back, pieces })
    }

    /// Sets the medium outside every solid; the default is the one given to [`Builder::new`].
    pub fn set_surroundings(&mut self, medium: MediumId) {
        self.scene.surroundings = medium;
    }

    /// Sets what becomes of the polarisation of light; by default it is ignored. Only estimators for which
    /// [`follows_polarisation`](crate::plan::Estimator::follows_polarisation) is true may then be asked for.
    pub fn set_polarisation(&mut self, polarisation: Polarisation) {
        self.scene.polarisation = polarisation;
    }

    /// Adds a source.
    pub fn add_source(&mut self, source: Source) -> SourceId {
        self.scene.bounds = self.scene.bounds.union(source.emitter.bounds());
        self.scene.sources.push(source);
        SourceId::new(self.scene.sources.len() - 1)
    }

    /// Sets the sources that are measured together.
    pub fn set_light(&mut self, light: LightGroups) {
        self.scene.light = light;
    }

    /// Adds a sensor whose faces have been added.
    pub fn add_sensor(&mut self, sensor: Sensor) -> SensorId {
        if let SensorKind::Goniometer(goniometer) = &sensor.kind {
            self.scene.bounds = self.scene.bounds.union(goniometer.bounds());
        }
        self.scene.sensors.push(sensor);
        SensorId::new(self.scene.sensors.len() - 1)
    }

    /// The scene, ready to be traced.
    pub fn build(self) -> Scene {
        let mut scene = self.scene;
        let patches = scene.patches.len();
        let mut surfaces = patches;
        for body in scene.meshes.iter_mut().chain(&mut scene.copies) {
            body.first = surfaces;
            surfaces += body.number_limit();
        }
        scene.first_of_copies = scene.copies.first().map_or(surfaces, |copy| copy.first);
        scene.tolerance = COINCIDENCE * scene.bounds.diagonal();
        scene.spectra = SourceSpectra::new(&scene.sources);
        let reach = scene.bounds.largest_coordinate();
        for body in scene.meshes.iter_mut().chain(&mut scene.copies) {
            body.set_reach(reach);
        }
        let bounds = |index: usize| match scene.patches.get(index) {
            Some(patch) => patch.shape.bounds(),
            None => scene.mesh_body(index - patches).bounds(),
        };
        scene.accel = Accel::new([patches, scene.mesh_bodies().count()], bounds, reach);
        if let Accel::Scan(_) = scene.accel {
            let solids = (0..scene.solids.len()).map(SolidId::new);
            let room = ConvexSolids {
                patches: &scene.patches,
                diagonal: scene.bounds.diagonal(),
                tolerance: scene.tolerance,
            };
            scene.convex = solids.filter_map(|solid| Convex::of(&room, solid)).collect();
        }
        let convex: Vec<PrimId> = scene.convex.iter().flat_map(Convex::faces).collect();
        scene.loose = (0..scene.patches.len()).map(PrimId::new).collect();
        scene.loose.retain(|prim| !convex.contains(prim));
        scene.legs = scene.plain_legs();
        scene
    }
}

/// Names of the faces of a mesh in the scene.
fn face_names(prefix: &str, mesh: &Mesh) -> Vec<String> {
    mesh.face_names().map(|name| format!("{prefix}.{name}")).collect()
}

impl Relief {
    /// The surfaces of all elements.
    fn pieces(&self, lap: f64) -> Vec<FacePiece> {
        let mut pieces = Vec::new();
        let round = self.element.round.map(|_| {
            let cut = PatchCut::Round { ground: self.ground, way: self.element.way, lap };
            Arc::new(Trim { cuts: vec![cut] })
        });
        for (place, at) in self.field.places() {
            for made in surfaces(&self.element, place, &self.ground, at, lap) {
                let smooth = pieces.len() as u32;
                let trim = round.clone().filter(|_| made.is_trimmed);
                pieces.push(FacePiece { shape: made.shape, smooth, chart: None, trim });
            }
        }
        pieces
    }
}
