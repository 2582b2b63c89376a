//! Indices into the tables of a scene, one type each.

use serde::{Deserialize, Serialize};

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        pub struct $name(u32);

        impl $name {
            /// The id of entry `index` of its table.
            #[inline]
            pub const fn new(index: usize) -> Self {
                Self(index as u32)
            }

            /// The entry in its table.
            #[inline]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    )*};
}

ids! {
    /// A medium.
    MediumId,
    /// A solid.
    SolidId,
    /// A named face of a solid, a sheet, or an open port.
    FaceId,
    /// A finish.
    FinishId,
    /// A source.
    SourceId,
    /// A light group.
    LightGroupId,
    /// A sensor.
    SensorId,
    /// Something a ray can hit: a patch, or a triangle of a mesh (numbered after the patches).
    PrimId,
}

/// A smooth surface: tangent-continuous pieces of a face, or of a mesh, share one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct SmoothId(u64);

impl SmoothId {
    /// The surface `smooth` of a face or a mesh.
    #[inline]
    pub(crate) const fn of(owner: u32, smooth: u32) -> Self {
        Self((owner as u64) << 32 | smooth as u64)
    }
}
