use super::*;
use crate::rng::{Dimension, Sampler};
use crate::transport::StopSignal;
use lumiduct_base::math::uniform_sphere;
use std::collections::HashSet;

/// Records on the cylinder of radius 5 mm about z, all on one surface.
fn records(count: u32) -> Vec<Indexed> {
    (0..count)
        .map(|record| {
            let mut sampler = Sampler::for_path(11, 1, u64::from(record));
            let [turn, along] = sampler.pair(Dimension::GatherPosition);
            let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
            let normal = DVec3::new(cos, sin, 0.0);
            let point = 5.0 * normal + 20.0 * along * DVec3::Z;
            let dir = uniform_sphere(sampler.pair(Dimension::GatherDirection));
            Indexed { record, surface: 0, band: 0, point, normal: Some(normal), dir }
        })
        .collect()
}

/// A photon in the place of a record.
fn key_of(&Indexed { surface, band, point, dir, .. }: &Indexed) -> PhotonKey {
    PhotonKey { surface, band, point, dir }
}

fn indexed(records: impl Iterator<Item = Indexed>, window: Window) -> Index {
    Index::new(records, window, &Pace::new(&StopSignal::default())).unwrap()
}

#[test]
fn a_look_up_finds_each_record_that_a_scan_finds_once() {
    let window = Window { radius: 1.2, theta_max: 0.4 };
    let all = records(3000);
    let index = indexed(all.iter().copied(), window);
    let mut pairs = 0;
    for photon in records(6000).split_off(3000) {
        let near = |record: &&Indexed| {
            record.point.distance(photon.point) <= window.radius
                && record.dir.distance(photon.dir) <= window.chord()
        };
        let scanned: Vec<u32> = all.iter().filter(near).map(|record| record.record).collect();
        let mut found = Vec::new();
        let key = key_of(&photon);
        index.visit(&[key], |_, record| found.push(record));
        let other = PhotonKey { band: 1, ..key };
        index.visit(&[other], |_, record| panic!("{record} takes light of another band"));
        found.sort_unstable();
        assert!(found.windows(2).all(|two| two[0] != two[1]), "{found:?}");
        assert!(scanned.iter().all(|record| found.contains(record)), "{scanned:?}, {found:?}");
        assert!(scanned.is_empty() || index.may_hold(&key));
        pairs += scanned.len();
    }
    assert!(pairs > 1000, "{pairs}");
}

#[test]
fn a_filter_lets_few_photons_through_that_meet_nothing() {
    let window = Window { radius: 0.3, theta_max: 0.05 };
    let (records, strangers) = (records(500), records(20_500).split_off(500));
    let index = indexed(records.iter().copied(), window);
    let mut cells = HashSet::new();
    for record in &records {
        index.lattice.each_cell(record, window, |hash| _ = cells.insert(hash));
    }
    let is_alone = |own: &&Indexed| !cells.contains(&index.lattice.hash(&key_of(own)));
    let alone: Vec<&Indexed> = strangers.iter().filter(is_alone).collect();
    let through = alone.iter().filter(|own| index.may_hold(&key_of(own))).count();
    assert!(alone.len() > strangers.len() / 2, "{}", alone.len());
    // Three bits of 64 in a word with at least FILTER_BITS for each entry: (1 - e^(-3/4))^3, Bloom, CACM 13 (1970) 422.
    assert!(through < alone.len() / 6, "{through} of {}", alone.len());
}

#[test]
fn cells_are_centred_on_whole_multiples() {
    assert_eq!(cell_of(DVec3::new(-0.6, 0.4, 2.6), 1.0), [-1, 0, 3]);
    assert_eq!(cell_of(DVec3::new(-1e6, 1e6, -0.4), 2.0), [-2_000_000, 2_000_000, -1]);
}
