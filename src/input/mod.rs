//! From a scene file to validated, typed specs.

pub mod keys;
pub mod problems;
pub mod schema;
pub mod sources;
pub mod spec;
pub mod tree;
pub mod validate;
