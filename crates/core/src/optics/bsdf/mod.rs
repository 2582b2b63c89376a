//! Measured scatter: tables of a distribution function over patches of directions, and a sheet with tables for both sides.

mod cumulative;
pub(crate) mod sheet;
pub(crate) mod table;
