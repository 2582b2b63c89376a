//! What keeps a part of a wall from being plain.

use crate::optics::{Finish, Medium};
use crate::scene::shape::{Cylinder, Flat, Region, Shape, Sphere};
use crate::scene::{
    Builder, CountedLight, Emission, Emitter, FaceId, FacePiece, FaceSpec, Goniometer, Grid, Owner,
    Passage, Place, PrimId, Seeing, Sensor, SensorKind, Sides, Source, StartSolids, SurfaceSensor,
};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Frame, circle};
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

/// Whether walls from each corner to the next are a leg.
fn are_leg(corners: &[[f64; 2]]) -> bool {
    are_leg_with(corners, None)
}

/// The same with one wall that faces the other way.
fn are_leg_with(corners: &[[f64; 2]], turned: Option<usize>) -> bool {
    let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
    for (index, pair) in corners.windows(2).enumerate() {
        let [a, b] = [pair[0], pair[1]].map(DVec2::from);
        let (middle, normal) = ((0.5 * (a + b)).extend(0.0), (b - a).perp().extend(0.0));
        let normal = if turned == Some(index) { -normal } else { normal };
        let wall = Frame::from_axis_and_x(middle, normal, DVec3::Z).unwrap();
        let region = Region::Rectangle { half_x: LENGTH, half_y: 0.5 * a.distance(b) };
        add(&mut builder, Owner::Sheet, Shape::Flat(Flat::new(wall, region)));
    }
    let scene = builder.build();
    let has_leg = |wall: usize| scene.plain_leg(PrimId::new(wall)).is_some();
    let found: Vec<bool> = (0..corners.len() - 1).map(has_leg).collect();
    assert!(found.iter().all(|own| *own == found[0]), "{found:?}");
    found[0]
}

#[test]
fn walls_over_a_convex_polygon_are_a_leg() {
    let ring = |sides: u32, turns: u32| -> Vec<[f64; 2]> {
        let share = |side: u32| f64::from(side * turns % sides) / f64::from(sides);
        (0..=sides).map(|side| circle(share(side)).to_array()).collect()
    };
    for sides in [3, 5, 6, 8, 12] {
        assert!(are_leg(&ring(sides, 1)), "{sides} sides");
    }
    assert!(are_leg(&[[0.0, 0.0], [3.0, 0.0], [2.0, 1.0], [0.5, 1.0], [0.0, 0.0]]));
    assert!(!are_leg(&ring(13, 1)), "too many sides");
    assert!(!are_leg(&ring(5, 2)), "a star");
    let notched = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [2.0, 1.0], [0.0, 0.0]];
    assert!(!are_leg(&notched), "a corner inward");
    assert!(!are_leg(&notched[..3]), "two walls alone");
    let square = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0], [0.0, 0.0]];
    assert!(are_leg(&square));
    for turned in 0..4 {
        assert!(!are_leg_with(&square, Some(turned)), "wall {turned} of a square faces outward");
    }
    assert!(!are_leg_with(&ring(6, 1), Some(2)), "a wall of a hexagon faces outward");
}

#[test]
fn a_round_wall_is_plain_under_sensors_that_count_no_light_within() {
    let watched = |counts, sides, aim| {
        let kind = SensorKind::Surface(SurfaceSensor {
            faces: vec![FaceId::new(0)],
            place: Place::Face,
            counts,
            sides,
            passage: Passage::Every,
            grid: Grid::Polar { radius: 1.0, rings: 1, sectors: 1 },
            areas: vec![1.0],
            covered: vec![1.0],
            seeing: Seeing::All,
            frame: None,
        });
        let sensor = Sensor { name: "wall".into(), kind, aim, entering: None };
        parts(|builder| _ = builder.add_sensor(sensor))
    };
    for counts in [CountedLight::Incident, CountedLight::Leaving] {
        assert_eq!(watched(counts, Sides::Front, Vec::new()), [[0, 50]]);
        assert!(watched(counts, Sides::Back, Vec::new()).is_empty());
        assert!(watched(counts, Sides::Both, Vec::new()).is_empty());
        assert!(watched(counts, Sides::Front, vec![FaceId::new(0)]).is_empty(), "an aim");
    }
}
