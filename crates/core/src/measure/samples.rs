//! Scenes and readings made by hand, for the tests of this layer.

use crate::optics::{Finish, Medium};
use crate::scene::shape::{ChartRect, Flat, Region, Shape};
use crate::scene::{
    Builder, CountedLight, Emission, EmitSide, Emitter, FacePiece, FaceSpec, Goniometer, Grid,
    LightGroup, LightGroups, Owner, Passage, Pixels, Place, Scene, Seeing, Sensor, SensorKind,
    Sides, Source, SourceId, StartSolids, SurfaceSensor, Views,
};
use crate::transport::{Findings, Layout, Readings};
use glam::{DVec2, DVec3};
use lumiduct_base::math::Frame;
use lumiduct_base::units::FluxUnit;

/// A scene with a black sheet `wall.surface` and the named sources and sensors; surface sensors are ports of their own.
pub(crate) fn scene(sources: &[(&str, f64)], sensors: Vec<(&str, SensorKind)>) -> Scene {
    let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
    let black = builder.add_finish("black", Finish::Absorber);
    let wall = Flat::new(Frame::WORLD, Region::Rectangle { half_x: 1.0, half_y: 1.0 });
    let wall = builder.add_face(FaceSpec {
        name: "wall.surface".into(),
        owner: Owner::Sheet,
        front: Some(black),
        back: Some(black),
        pieces: vec![FacePiece::whole(Shape::Flat(wall))],
    });
    for (name, flux) in sources {
        let disk = Flat::new(Frame::WORLD, Region::Annulus { inner: 0.0, outer: 1.0 });
        builder.add_source(Source {
            name: (*name).into(),
            flux: *flux,
            emitter: Emitter::surface(vec![Shape::Flat(disk)], EmitSide::Front, None),
            emission: Emission::Lambertian,
            start: StartSolids::Outside,
            on: Vec::new(),
            spectrum: None,
            elevation: None,
            sun: None,
        });
    }
    for (name, kind) in sensors {
        builder.add_sensor(Sensor {
            name: name.into(),
            kind,
            aim: vec![wall],
            entering: Some(wall),
        });
    }
    builder.build()
}

/// A one-sided sensor of `size` mm with these cells.
pub(crate) fn rectangle(size: f64, nu: usize, nv: usize) -> SensorKind {
    let half = DVec2::splat(0.5 * size);
    let grid = Grid::Cartesian { rect: ChartRect { min: -half, max: half }, nu, nv };
    SensorKind::Surface(surface(grid, |rect| rect.area()))
}

/// A disk of `radius` mm under square cells.
pub(crate) fn disk(radius: f64, cells: usize) -> SensorKind {
    let half = DVec2::splat(radius);
    let grid = Grid::Cartesian { rect: ChartRect { min: -half, max: half }, nu: cells, nv: cells };
    let shape = Flat::new(Frame::WORLD, Region::Annulus { inner: 0.0, outer: radius });
    SensorKind::Surface(surface(grid, |rect| Shape::Flat(shape.clone()).area_in(rect)))
}

/// A disk of `radius` mm in rings and sectors.
pub(crate) fn rings(radius: f64, rings: usize, sectors: usize) -> SensorKind {
    let grid = Grid::Polar { radius, rings, sectors };
    SensorKind::Surface(surface(grid, |_| 0.0))
}

/// A luminance sensor: a rectangle with views of these projected solid angles, in sr.
pub(crate) fn luminance(size: f64, nu: usize, nv: usize, projected: &[f64]) -> SensorKind {
    match rectangle(size, nu, nv) {
        SensorKind::Surface(mut surface) => {
            surface.seeing = Seeing::Views(Views {
                directions: vec![DVec3::Z; projected.len()],
                half_angle: 0.1,
                projected: projected.to_vec(),
            });
            SensorKind::Surface(surface)
        }
        SensorKind::Goniometer(_) => unreachable!("a rectangle is a surface"),
    }
}

/// An image through a square aperture of 1 mm.
pub(crate) fn image(columns: usize, rows: usize) -> SensorKind {
    match rectangle(1.0, 1, 1) {
        SensorKind::Surface(mut surface) => {
            surface.seeing =
                Seeing::Pixels(Box::new(Pixels::new(&Frame::WORLD, [columns, rows], 0.01)));
            SensorKind::Surface(surface)
        }
        SensorKind::Goniometer(_) => unreachable!("a rectangle is a surface"),
    }
}

/// A far-field goniometer.
pub(crate) fn goniometer(c_cells: usize, gamma_cells: usize) -> SensorKind {
    SensorKind::Goniometer(Goniometer { frame: Frame::WORLD, c_cells, gamma_cells, radius: None })
}

fn surface(grid: Grid, area_in: impl Fn(ChartRect) -> f64) -> SurfaceSensor {
    let areas = grid.cell_areas(&area_in);
    SurfaceSensor {
        covered: grid.cell_cover(area_in),
        faces: Vec::new(),
        place: Place::Port,
        counts: CountedLight::Incident,
        sides: Sides::Front,
        passage: Passage::Every,
        grid,
        areas,
        seeing: Seeing::All,
        frame: None,
    }
}

/// Readings of some batches of 1000 paths, each filled in by `fill`, which receives the number of
/// the batch.
pub(crate) fn readings(
    scene: &Scene,
    batches: u64,
    mut fill: impl FnMut(u64, &Layout, &mut Readings),
) -> Findings {
    let layout = Layout::new(scene);
    let mut all: Option<Readings> = None;
    for index in 0..batches {
        let mut batch = Readings::of_batch(scene, &layout, 1, 1000, index);
        fill(index, &layout, &mut batch);
        batch.close_batch();
        all = Some(match all {
            None => batch,
            Some(sum) => sum.merge(&batch),
        });
    }
    Findings::forward(all.expect("tests ask for at least one batch"))
}

/// Light groups with these names and sources.
pub(crate) fn light_groups(groups: &[(&str, &[usize])]) -> LightGroups {
    let group = |(name, sources): &(&str, &[usize])| LightGroup {
        name: (*name).into(),
        sources: sources.iter().map(|&source| SourceId::new(source)).collect(),
    };
    LightGroups::new(groups.iter().map(group).collect(), Vec::new())
}

/// Adds to a scalar of a batch.
pub(crate) fn add(batch: &mut Readings, slot: usize, flux: f64) {
    batch.groups[0].sums[slot] += flux;
}
