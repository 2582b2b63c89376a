//! Paths in rows and bounce by bounce end in the same places.

mod scenes;

use crate::optics::REFERENCE_WAVELENGTH;
use crate::rng::{Dimension, Sampler};
use crate::scene::{Inside, Ray, RowReach, Scene, SolidId, StartSurfaces};
use crate::transport::walk::event::{Carries, Event, Observer};
use crate::transport::walk::path::Path;
use crate::transport::walk::walk;
use glam::DVec3;
use lumiduct_base::math::{cosine_hemisphere, disk};
use scenes::{
    RADIUS, bar, duct, duct_of_faces, frame, glass_prism, mirror_prism, mirror_prism_of_faces,
    perforated, rod, tube,
};
use std::ops::ControlFlow;

const PATHS: u64 = 500;
const LIMIT: u32 = 4000;
const MOST_FACES: usize = 8;

/// What becomes of a path.
#[derive(Debug, Default)]
struct Fate<const JUMPS: bool, const BACK: bool> {
    events: usize,
    end: Option<(Ray, f64, u32)>,
    by_face: [f64; MOST_FACES],
    in_medium: f64,
    /// Throughput that arrives at the first face and that leaves it.
    passed: [f64; 2],
}

impl<const JUMPS: bool, const BACK: bool> Observer for Fate<JUMPS, BACK> {
    const CARRIES: Carries = if BACK { Carries::Radiance } else { Carries::Flux };

    fn roulette_below(&self) -> f64 {
        0.0
    }

    fn allows_jumps(&self) -> bool {
        JUMPS
    }

    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        self.events += 1;
        match event {
            Event::Travel(segment) if segment.length.is_finite() => {
                self.in_medium += segment.throughput - segment.arriving;
            }
            Event::Depart(vertex, departure) => {
                let face = vertex.interface.acting.face;
                self.by_face[face.index()] += vertex.throughput - departure.throughput;
                if face.index() == 0 {
                    self.passed[0] += vertex.throughput;
                    self.passed[1] += departure.throughput;
                }
            }
            Event::Jump(jump) => {
                for (face, absorbed) in jump.absorbed_by_faces {
                    self.by_face[face.index()] += absorbed;
                }
                self.in_medium += jump.absorbed_in_medium;
                self.passed[0] += jump.arriving;
                self.passed[1] += jump.leaving;
            }
            Event::Escaped(_) => self.end = Some((path.ray, path.throughput, path.depth)),
            _ => {}
        }
        ControlFlow::Continue(())
    }
}

fn start((scene, inside): (&Scene, &Inside), ray: Ray) -> Path {
    Path {
        ray,
        throughput: 1.0,
        wavelength: REFERENCE_WAVELENGTH,
        band: 0,
        stokes: None,
        source: None,
        medium: scene.medium_in(inside),
        inside: inside.clone(),
        on: StartSurfaces::default(),
        depth: 0,
    }
}

fn fate<const JUMPS: bool, const BACK: bool>(
    (scene, inside): (&Scene, &Inside),
    (index, limit): (u64, u32),
) -> Fate<JUMPS, BACK> {
    let mut sampler = Sampler::for_path(3, 0, index);
    let at = disk(sampler.pair(Dimension::EmitPosition));
    let dir = cosine_hemisphere(sampler.pair(Dimension::EmitDirection));
    let at = frame().point_to_world(0.999 * RADIUS * at + 0.01 * DVec3::Z);
    let path = start((scene, inside), Ray::new(at, frame().to_world(dir)));
    let mut fate = Fate::default();
    walk(scene, path, limit, &mut sampler, &mut fate);
    fate
}

/// Events with jumps over those without.
fn assert_same_fates<const BACK: bool>(scene: &Scene, inside: &Inside) -> f64 {
    let (mut with, mut without) = (0, 0);
    for index in 0..PATHS {
        let jumped = fate::<true, BACK>((scene, inside), (index, LIMIT));
        let stepped = fate::<false, BACK>((scene, inside), (index, LIMIT));
        (with, without) = (with + jumped.events, without + stepped.events);
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9;
        let mut by_face = jumped.by_face.iter().zip(stepped.by_face);
        assert!(by_face.all(|(a, b)| near(*a, b)), "{jumped:?} {stepped:?}");
        assert!(near(jumped.in_medium, stepped.in_medium), "{jumped:?} {stepped:?}");
        let (Some((ray, throughput, depth)), Some((ray_0, throughput_0, depth_0))) =
            (jumped.end, stepped.end)
        else {
            assert_eq!(jumped.end.is_some(), stepped.end.is_some());
            continue;
        };
        assert!(ray.origin().distance(ray_0.origin()) < 1e-9, "{ray:?} {ray_0:?}");
        assert!(ray.dir().distance(ray_0.dir()) < 1e-9, "{ray:?} {ray_0:?}");
        assert!((throughput / throughput_0 - 1.0).abs() < 1e-9 || throughput < 1e-200);
        assert_eq!(depth, depth_0);
    }
    with as f64 / without as f64
}

#[test]
fn paths_end_in_the_same_place_with_and_without_jumps() {
    let outside = Inside::default();
    let in_rod: Inside = [SolidId::new(0)].into_iter().collect();
    for events in [
        assert_same_fates::<false>(&tube(), &outside),
        assert_same_fates::<true>(&tube(), &outside),
        assert_same_fates::<false>(&perforated(), &outside),
        assert_same_fates::<true>(&perforated(), &outside),
        assert_same_fates::<false>(&rod(), &in_rod),
        assert_same_fates::<true>(&rod(), &in_rod),
        assert_same_fates::<false>(&duct(), &outside),
        assert_same_fates::<true>(&duct(), &outside),
        assert_same_fates::<false>(&duct_of_faces(), &outside),
        assert_same_fates::<true>(&duct_of_faces(), &outside),
        assert_same_fates::<false>(&bar(), &in_rod),
        assert_same_fates::<true>(&bar(), &in_rod),
        assert_same_fates::<false>(&mirror_prism(), &outside),
        assert_same_fates::<true>(&mirror_prism(), &outside),
        assert_same_fates::<false>(&mirror_prism_of_faces(), &outside),
        assert_same_fates::<true>(&mirror_prism_of_faces(), &outside),
        assert_same_fates::<false>(&glass_prism(), &in_rod),
        assert_same_fates::<true>(&glass_prism(), &in_rod),
    ] {
        assert!(events < 0.5, "jumps leave {events} of all events");
    }
}

#[test]
fn light_that_passes_a_round_wall_is_summed_over_the_bounces_of_a_row() {
    let (scene, outside) = (tube(), Inside::default());
    for index in 0..PATHS {
        let jumped = fate::<true, false>((&scene, &outside), (index, LIMIT));
        let stepped = fate::<false, false>((&scene, &outside), (index, LIMIT));
        for (a, b) in jumped.passed.iter().zip(stepped.passed) {
            assert!((a - b).abs() <= 1e-9 * b.max(1.0), "{jumped:?} {stepped:?}");
        }
    }
}

/// What is left of a path in short rows that follow each other, as between the corners of a ring, where roulette acts.
#[derive(Debug, Default)]
struct InShortRows(Option<f64>);

impl Observer for InShortRows {
    fn allows_jumps(&self) -> bool {
        true
    }

    fn limit_row(&self, _: &Path, reach: &mut RowReach) {
        reach.end_after(6);
    }

    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        if matches!(event, Event::Roulette(_)) {
            self.0.get_or_insert(path.throughput);
        }
        ControlFlow::Continue(())
    }
}

#[test]
fn roulette_ends_rows_that_follow_each_other_where_hardly_anything_is_left() {
    let (scene, inside) = (duct(), Inside::default());
    for index in 0..PATHS {
        let mut sampler = Sampler::for_path(3, 0, index);
        let across = std::f64::consts::TAU * sampler.one(Dimension::EmitDirection);
        // Almost across the axis: thousands of bounces to the end.
        let dir = DVec3::new(across.cos(), across.sin(), 1e-3);
        let ray = Ray::new(frame().point_to_world(DVec3::Z), frame().to_world(dir.normalize()));
        let mut found = InShortRows::default();
        walk(&scene, start((&scene, &inside), ray), LIMIT, &mut sampler, &mut found);
        assert!(found.0.expect("roulette acts before the end") < 1e-6, "{found:?}");
    }
}

#[test]
fn a_jump_ends_at_the_bounce_limit() {
    let outside = Inside::default();
    let scenes =
        |index| [tube(), duct(), duct_of_faces(), mirror_prism()].map(|scene| (index, scene));
    for (index, scene) in (0..100).flat_map(scenes) {
        let fates = [1, 2, 7].map(|limit| fate::<true, false>((&scene, &outside), (index, limit)));
        let steps = [1, 2, 7].map(|limit| fate::<false, false>((&scene, &outside), (index, limit)));
        for (jumped, stepped) in fates.iter().zip(&steps) {
            for (a, b) in jumped.by_face.iter().zip(stepped.by_face) {
                assert!((a - b).abs() < 1e-12, "{jumped:?} {stepped:?}");
            }
        }
    }
}
