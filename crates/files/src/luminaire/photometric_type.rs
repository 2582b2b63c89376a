//! Photometric types of LM-63: which axes the angles of a file refer to.
//!
//! By the definitions of LM-63-2002 (section 3), with the direction to C0 and horizontal as the *photometric horizontal*:
//! type C has angles γ from the nadir in planes about the vertical axis, counter-clockwise as seen from above. In type A, planes
//! about the vertical axis go clockwise, and vertical angles start at the horizon: -90 is the nadir. In type B, planes share a
//! horizontal axis, which lies across the luminaire, along C90; the vertical angle 0 is the nadir and 90 the photometric
//! horizontal. LM-75 names the same points (90X 0Y), (90H 0V) and (90V 270L), as quoted by the glTF extension `EXT_lights_ies`.

/// What the angles of a file refer to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PhotometricType {
    /// Planes about the vertical axis, and angles from the nadir.
    C,
    /// Planes about a horizontal axis.
    B,
    /// Planes about the vertical axis, and angles from the horizon.
    A,
}

impl PhotometricType {
    /// That of its number in a file (LM-63-2002, section 5.9).
    pub(crate) fn of_number(number: f64) -> Option<Self> {
        match number {
            1.0 => Some(Self::C),
            2.0 => Some(Self::B),
            3.0 => Some(Self::A),
            _ => None,
        }
    }
}
