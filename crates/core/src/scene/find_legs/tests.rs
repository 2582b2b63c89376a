//! What keeps a part of a wall from being plain.

use crate::optics::{Finish, Medium};
use crate::scene::shape::{Cylinder, Flat, Region, Shape, Sphere};
use crate::scene::{
    Builder, Emission, Emitter, FaceId, FacePiece, FaceSpec, Goniometer, Owner, PrimId, Sensor,
    SensorKind, Source, StartSolids,
};
use glam::DVec3;
use lumiduct_base::math::Frame;
use lumiduct_base::units::FluxUnit;

const RADIUS: f64 = 2.0;
const LENGTH: f64 = 50.0;

fn at(x: f64, z: f64) -> Frame {
    Frame::WORLD.shifted(DVec3::new(x, 0.0, z))
}

fn tube(x: f64, radius: f64) -> Shape {
    Shape::Cylinder(Cylinder::new(at(x, 0.0), radius, LENGTH))
}

fn disk(z: f64, radius: f64) -> Shape {
    Shape::Flat(Flat::new(at(0.0, z), Region::Annulus { inner: 0.0, outer: radius }))
}

fn add(builder: &mut Builder, owner: Owner, shape: Shape) -> FaceId {
    let finish = Some(builder.add_finish("mirror", Finish::Metal { n: 1.0, k: 7.0 }));
    builder.add_face(FaceSpec {
        name: "wall".into(),
        owner,
        front: finish,
        back: finish,
        pieces: vec![FacePiece::whole(shape)],
    })
}

/// The plain parts of a tube among other things, mm along it, rounded.
fn parts(others: impl FnOnce(&mut Builder)) -> Vec<[i64; 2]> {
    let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
    add(&mut builder, Owner::Sheet, tube(0.0, RADIUS));
    others(&mut builder);
    let scene = builder.build();
    let leg = scene.plain_leg(PrimId::new(0));
    let spans = leg.map_or(&[][..], |leg| &leg.spans);
    spans.iter().map(|span| span.map(|z| z.round() as i64)).collect()
}

#[test]
fn a_wall_is_plain_where_nothing_else_touches_it_or_its_inside() {
    let whole = vec![[0, 50]];
    let with = |owner, shape| parts(|builder| _ = add(builder, owner, shape));
    assert_eq!(parts(|_| ()), whole);
    assert_eq!(with(Owner::Sheet, disk(50.0, RADIUS)), whole, "a window in the exit");
    assert_eq!(with(Owner::Port, disk(60.0, 9.0)), whole, "a sensor beyond the exit");
    assert_eq!(with(Owner::Port, disk(20.0, 0.1)), [[0, 20], [20, 50]], "a sensor within");
    assert_eq!(with(Owner::Sheet, tube(0.0, 1.1 * RADIUS)), whole, "a tube around");
    assert_eq!(with(Owner::Sheet, tube(2.5 * RADIUS, RADIUS)), whole, "a tube beside");
    assert!(with(Owner::Sheet, tube(0.0, RADIUS)).is_empty(), "a second wall in the same place");
    assert!(with(Owner::Sheet, tube(1.0, 0.5)).is_empty(), "a tube within");
    assert!(with(Owner::Sheet, tube(2.0 * RADIUS, RADIUS)).is_empty(), "a tube that touches");
    let ball = Shape::Sphere(Sphere::zone(at(0.5, 30.0), 1.0, -1.0, 1.0));
    assert_eq!(with(Owner::Sheet, ball), [[0, 29], [31, 50]]);
}

#[test]
fn sources_and_sensors_on_the_way_are_not_jumped_over() {
    let lit = parts(|builder| {
        builder.add_source(Source {
            name: "led".into(),
            flux: 1.0,
            emitter: Emitter::Point(at(0.0, 10.0)),
            emission: Emission::Isotropic,
            start: StartSolids::Outside,
            on: Vec::new(),
            spectrum: None,
            elevation: None,
            sun: None,
        });
    });
    assert_eq!(lit, [[0, 10], [10, 50]]);
    let seen = |radius| {
        parts(|builder| {
            let goniometer =
                Goniometer { frame: at(0.0, 25.0), c_cells: 1, gamma_cells: 4, radius };
            builder.add_sensor(Sensor {
                name: "sphere".into(),
                kind: SensorKind::Goniometer(goniometer),
                aim: Vec::new(),
                entering: None,
            });
        })
    };
    assert_eq!(seen(None), [[0, 50]], "a far field");
    assert_eq!(seen(Some(26.0)), [[0, 50]], "a sphere around");
    assert!(seen(Some(25.0)).is_empty(), "a sphere through the wall");
    let entered = parts(|builder| {
        builder.add_sensor(Sensor {
            name: "far".into(),
            kind: SensorKind::Goniometer(Goniometer {
                frame: at(0.0, 25.0),
                c_cells: 1,
                gamma_cells: 4,
                radius: None,
            }),
            aim: Vec::new(),
            entering: Some(FaceId::new(0)),
        });
    });
    assert!(entered.is_empty(), "light that enters through the wall counts");
}
