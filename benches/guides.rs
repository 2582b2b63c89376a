//! The guides of the benchmark scenes (DESIGN section 6), built without a scene file.

use glam::DVec3;
use lumiduct_base::math::{Aabb, Frame};
use lumiduct_base::mesh::TriangleMesh;
use lumiduct_base::units::FluxUnit;
use lumiduct_core::optics::{Finish, Medium};
use lumiduct_core::scene::mesh::Mesh;
use lumiduct_core::scene::shape::{ChartRect, Cylinder, Flat, Region, Shape};
use lumiduct_core::scene::{
    Builder, CountedLight, Emission, EmitSide, Emitter, FaceId, FacePiece, FaceSpec, Goniometer,
    Grid, Owner, Passage, Place, Scene, Seeing, Sensor, SensorKind, Sides, Solid, SolidId, Source,
    StartSolids, SurfaceSensor,
};
use std::f64::consts::TAU;

/// Cells of every map, in each direction.
pub(crate) const MAP_CELLS: usize = 32;
/// Rings of a far field, 2 degrees each.
pub(crate) const FAR_RINGS: usize = 90;

/// A hollow mirror cylinder, black outside, its entry filled by a Lambertian disk.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tube {
    pub(crate) radius: f64,
    pub(crate) length: f64,
    pub(crate) reflectance: f64,
}

/// A solid in air before a smaller Lambertian disk at z = -gap.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rod {
    pub(crate) section: Section,
    pub(crate) length: f64,
    pub(crate) index: f64,
    pub(crate) source_radius: f64,
    pub(crate) source_at: [f64; 2],
    pub(crate) gap: f64,
}

/// Cross-section of a rod.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Section {
    /// Round, of this radius, mm.
    Round(f64),
    /// Square, of this half side, mm.
    Square(f64),
}

pub(crate) const B1_P10: Tube = Tube { radius: 5.0, length: 100.0, reflectance: 0.95 };
pub(crate) const B1_P10_R99: Tube = Tube { reflectance: 0.99, ..B1_P10 };
pub(crate) const B1_P100: Tube = Tube { radius: 5.0, length: 1000.0, reflectance: 0.95 };
pub(crate) const B1_P100_R99: Tube = Tube { reflectance: 0.99, ..B1_P100 };
pub(crate) const B2: Rod = Rod {
    section: Section::Round(1.5),
    length: 60.0,
    index: 1.49,
    source_radius: 0.5,
    source_at: [0.0, 0.0],
    gap: 0.2,
};
pub(crate) const B2_L600: Rod = Rod { length: 600.0, ..B2 };
pub(crate) const B4: Rod = Rod {
    section: Section::Square(2.0),
    length: 40.0,
    index: 1.49,
    source_radius: 0.25,
    source_at: [1.0, 0.6],
    gap: 0.1,
};

/// Facets around a rod of triangles and rings along it: 20,022 triangles, 100,800, and 979,600.
pub(crate) const RODS: [[u32; 2]; 3] = [[141, 70], [224, 224], [620, 789]];

/// The scene of a tube; its one sensor is on the open exit.
pub(crate) fn tube_scene(tube: &Tube) -> Scene {
    let mut builder = in_air();
    let mirror = Finish::Specular { reflectance: tube.reflectance, transmittance: 0.0 };
    let mirror = builder.add_finish("mirror", mirror);
    let black = builder.add_finish("black", Finish::Absorber);
    builder.add_face(FaceSpec {
        name: "tube.wall".into(),
        owner: Owner::Sheet,
        front: Some(black),
        back: Some(mirror),
        pieces: vec![wall(tube.radius, tube.length)],
    });
    let port = builder.add_face(FaceSpec {
        name: "tube.exit".into(),
        owner: Owner::Port,
        front: None,
        back: None,
        pieces: vec![FacePiece::whole(disk(DVec3::new(0.0, 0.0, tube.length), tube.radius))],
    });
    add_source(&mut builder, DVec3::ZERO, tube.radius);
    add_exit_sensor(&mut builder, port, Place::Port, tube.radius);
    builder.build()
}

/// The scene of a rod with exact faces: a sensor on the exit, and for a round rod the far field.
pub(crate) fn rod_scene(rod: &Rod) -> Scene {
    let (mut builder, solid) = with_rod(rod);
    let face = |name: &str, pieces: Vec<FacePiece>| FaceSpec {
        name: format!("rod.{name}"),
        owner: Owner::Solid(solid),
        front: None,
        back: None,
        pieces,
    };
    let (entry, exit, walls) = match rod.section {
        Section::Round(radius) => {
            let end = Region::Annulus { inner: 0.0, outer: radius };
            (end.clone(), end, vec![wall(radius, rod.length)])
        }
        Section::Square(half) => {
            let end = Region::Rectangle { half_x: half, half_y: half };
            (end.clone(), end, square_walls(half, rod.length))
        }
    };
    let back = Frame::from_axis(DVec3::ZERO, -DVec3::Z);
    let ahead = Frame::WORLD.shifted(DVec3::new(0.0, 0.0, rod.length));
    builder.add_face(face("entry", vec![FacePiece::whole(Shape::Flat(Flat::new(back, entry)))]));
    builder.add_face(face("wall", walls));
    let exit =
        builder.add_face(face("exit", vec![FacePiece::whole(Shape::Flat(Flat::new(ahead, exit)))]));
    add_rod_light(&mut builder, rod, exit);
    builder.build()
}

/// The scene of a rod whose faces are triangles; a sensor on the exit, and the far field.
pub(crate) fn mesh_scene(rod: &Rod, mesh: Mesh) -> Scene {
    let (mut builder, solid) = with_rod(rod);
    let finishes = vec![[None; 2]; mesh.face_names().count()];
    let faces = builder.add_mesh("rod", solid, mesh, &finishes);
    let exit =
        faces.into_iter().find(|face| builder.scene().faces[face.index()].name == "rod.exit");
    add_rod_light(&mut builder, rod, exit.expect("the rod has an exit"));
    builder.build()
}

/// A closed round rod along z, of `around` facets with smooth normals, its wall cut into `along` rings;
/// faces `wall`, `entry`, `exit`. 2 around (along + 1) triangles.
pub(crate) fn rod_mesh(radius: f64, length: f64, around: u32, along: u32) -> TriangleMesh {
    let mut positions = vec![DVec3::ZERO, length * DVec3::Z];
    let outward = |side: u32| {
        let (sin, cos) = (TAU * f64::from(side % around) / f64::from(around)).sin_cos();
        DVec3::new(cos, sin, 0.0)
    };
    for ring in 0..=along {
        let z = length * f64::from(ring) / f64::from(along);
        positions.extend((0..around).map(|side| radius * outward(side) + z * DVec3::Z));
    }
    let vertex = |ring: u32, side: u32| 2 + ring * around + side % around;
    let mut mesh = TriangleMesh {
        positions,
        triangles: Vec::new(),
        normals: Some(Vec::new()),
        face_of: Vec::new(),
        faces: ["wall", "entry", "exit"].map(String::from).into(),
    };
    let mut add = |face: u32, triangle: [u32; 3], normals: [DVec3; 3]| {
        mesh.triangles.push(triangle);
        mesh.normals.get_or_insert_default().push(normals);
        mesh.face_of.push(face);
    };
    for side in 0..around {
        let (here, next) = (outward(side), outward(side + 1));
        for ring in 0..along {
            let [a, b] = [vertex(ring, side), vertex(ring, side + 1)];
            let [d, c] = [vertex(ring + 1, side), vertex(ring + 1, side + 1)];
            add(0, [a, b, c], [here, next, next]);
            add(0, [a, c, d], [here, next, here]);
        }
        add(1, [0, vertex(0, side + 1), vertex(0, side)], [-DVec3::Z; 3]);
        add(2, [1, vertex(along, side), vertex(along, side + 1)], [DVec3::Z; 3]);
    }
    mesh
}

fn in_air() -> Builder {
    Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen)
}

fn with_rod(rod: &Rod) -> (Builder, SolidId) {
    let mut builder = in_air();
    let medium = builder.add_medium(Medium::new("pmma", rod.index, 0.0));
    let solid = builder.add_solid(Solid {
        name: "rod".into(),
        medium,
        priority: 0,
        bounds: Aabb::EMPTY,
        volume: None,
    });
    (builder, solid)
}

fn wall(radius: f64, length: f64) -> FacePiece {
    FacePiece::whole(Shape::Cylinder(Cylinder::new(Frame::WORLD, radius, length)))
}

fn disk(center: DVec3, radius: f64) -> Shape {
    let region = Region::Annulus { inner: 0.0, outer: radius };
    Shape::Flat(Flat::new(Frame::WORLD.shifted(center), region))
}

fn square_walls(half: f64, length: f64) -> Vec<FacePiece> {
    [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y]
        .into_iter()
        .map(|outward| {
            let middle = half * outward + 0.5 * length * DVec3::Z;
            let frame = Frame::from_axis_and_x(middle, outward, DVec3::Z)
                .expect("the walls are parallel to z");
            let region = Region::Rectangle { half_x: 0.5 * length, half_y: half };
            FacePiece::whole(Shape::Flat(Flat::new(frame, region)))
        })
        .collect()
}

fn add_source(builder: &mut Builder, center: DVec3, radius: f64) {
    builder.add_source(Source {
        name: "led".into(),
        flux: 1.0,
        emitter: Emitter::surface(vec![disk(center, radius)], EmitSide::Front, Some(Frame::WORLD)),
        emission: Emission::Lambertian,
        start: StartSolids::Outside,
        on: Vec::new(),
        spectrum: None,
        elevation: None,
        sun: None,
    });
}

fn add_rod_light(builder: &mut Builder, rod: &Rod, exit: FaceId) {
    let [x, y] = rod.source_at;
    add_source(builder, DVec3::new(x, y, -rod.gap), rod.source_radius);
    let (Section::Round(half) | Section::Square(half)) = rod.section;
    add_exit_sensor(builder, exit, Place::Face, half);
    if let Section::Round(_) = rod.section {
        builder.add_sensor(Sensor {
            name: "far".into(),
            kind: SensorKind::Goniometer(Goniometer {
                frame: Frame::WORLD,
                c_cells: 1,
                gamma_cells: FAR_RINGS,
                radius: None,
            }),
            aim: Vec::new(),
            entering: None,
        });
    }
}

fn add_exit_sensor(builder: &mut Builder, face: FaceId, place: Place, half: f64) {
    let square = Region::Rectangle { half_x: half, half_y: half };
    let rect: ChartRect = Shape::Flat(Flat::new(Frame::WORLD, square)).chart_bounds();
    let grid = Grid::Cartesian { rect, nu: MAP_CELLS, nv: MAP_CELLS };
    let area_in = |rect| builder.scene().face_area_in(face, rect);
    let areas = grid.cell_areas(area_in);
    let covered = grid.cell_cover(|rect| builder.scene().face_charted_in(face, rect));
    // Light passes an open exit and arrives from behind; it leaves a solid to the front.
    let (counts, sides) = match place {
        Place::Port => (CountedLight::Incident, Sides::Back),
        Place::Face => (CountedLight::Leaving, Sides::Front),
    };
    builder.add_sensor(Sensor {
        name: "exit".into(),
        kind: SensorKind::Surface(SurfaceSensor {
            faces: vec![face],
            place,
            counts,
            sides,
            passage: Passage::Every,
            grid,
            areas,
            covered,
            seeing: Seeing::All,
            frame: None,
        }),
        aim: Vec::new(),
        entering: None,
    });
}
