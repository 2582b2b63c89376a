//! Work, counted instead of timed: the same on every machine, so that choices based on it are
//! reproducible.
//!
//! The constants are nanoseconds on one thread of the machine of benches/results/2026-11-24.md, in typical scenes:
//! plain tubes and rods take less, meshes, bends and prism film up to four times as much. A choice depends on their ratios alone.

use crate::transport::Readings;

/// Per photon path, and per segment of one.
const PHOTON_PATH: f64 = 340.0;
pub(crate) const OF_PHOTON_SEGMENT: f64 = 90.0;
/// Per gather path, and per segment of one.
const GATHER_PATH: f64 = 1200.0;
const GATHER_SEGMENT: f64 = 120.0;
/// Per place that a vertex is joined to, or found not to be.
const JOIN: f64 = 180.0;
/// Per gather record, made and indexed; per segment of a photon, looked up in the filter; per photon that passes the filter;
/// per photon that a record takes.
const RECORD: f64 = 3600.0;
const FILTER: f64 = 60.0;
const LOOK_UP: f64 = 400.0;
const PAIR: f64 = 160.0;

/// Work of a pass in addition to tracing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct RecordWork {
    /// Records made.
    pub(crate) records: u64,
    /// Photons that may have met one.
    pub(crate) look_ups: u64,
    /// Photons that have met one, among those.
    pub(crate) near: u64,
    /// Photons taken, counted for each record that took them.
    pub(crate) pairs: u64,
}

/// Work of photon paths.
pub(crate) fn of_photons(readings: &Readings) -> f64 {
    PHOTON_PATH * readings.paths() as f64 + OF_PHOTON_SEGMENT * readings.segments as f64
}

/// Work of photon segments that are looked up in the filter of records.
pub(crate) fn of_filtered(segments: u64) -> f64 {
    FILTER * segments as f64
}

/// Work of a photon path with this many segments.
pub(crate) fn of_photon_path(segments: f64) -> f64 {
    PHOTON_PATH + OF_PHOTON_SEGMENT * segments
}

/// Work of a gather path with this many segments.
pub(crate) fn of_gather_path(segments: f64) -> f64 {
    GATHER_PATH + GATHER_SEGMENT * segments
}

/// Work of a gather path with this many segments that ends in a record.
pub(crate) fn of_recorded_path(segments: f64) -> f64 {
    of_gather_path(segments) + RECORD
}

/// Work of this many gather paths, and of what photons and they are joined to.
pub(crate) fn of_gather_paths(paths: u64, readings: &Readings) -> f64 {
    GATHER_PATH * paths as f64
        + GATHER_SEGMENT * readings.segments as f64
        + JOIN * readings.joins as f64
}

/// Work of records.
pub(crate) fn of_records(work: RecordWork) -> f64 {
    let RecordWork { records, look_ups, near: _, pairs } = work;
    RECORD * records as f64 + LOOK_UP * look_ups as f64 + PAIR * pairs as f64
}
