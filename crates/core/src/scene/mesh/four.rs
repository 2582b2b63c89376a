//! Four triangles at once: which of them a line crosses.
//!
//! The same operations on the same numbers as for one triangle ([`TriangleLine::passes`]), so that the answers are the same to the
//! last bit, in four lanes. Of some 18 triangles that a search looks at one is crossed.

use crate::scene::crossing::tree::{LEAF, Leaf, NONE};
use crate::scene::mesh::TriangleLine;
use crate::scene::shape::Toward;
use glam::DVec3;
use lumiduct_base::mesh::TriangleMesh;
use wide::f64x4;

/// Corners of up to four triangles by corner and axis; not numbers where there are fewer.
#[derive(Debug, Clone)]
pub(super) struct FourTriangles {
    corners: [[f64x4; 3]; 3],
}

const _: () = assert!(LEAF == 4, "a lane for each triangle");

impl FourTriangles {
    /// The triangles of a leaf.
    pub(super) fn of(mesh: &TriangleMesh, leaf: &Leaf) -> Self {
        let mut corners = [[f64x4::splat(f64::NAN); 3]; 3];
        let own = leaf.iter().take_while(|triangle| **triangle != NONE);
        for (lane, triangle) in own.enumerate() {
            for (corner, own) in corners.iter_mut().zip(mesh.corners(*triangle as usize)) {
                for (axis, own) in corner.iter_mut().zip(own.to_array()) {
                    axis.as_mut_array()[lane] = own;
                }
            }
        }
        Self { corners }
    }

    /// The corners of the triangle in a lane.
    #[inline(always)]
    pub(super) fn corners(&self, lane: usize) -> [DVec3; 3] {
        let at = |corner: usize| {
            DVec3::from_array(
                [0, 1, 2].map(|axis: usize| self.corners[corner][axis].as_array()[lane]),
            )
        };
        [at(0), at(1), at(2)]
    }
}

/// A line that crosses triangles one way, prepared for four at once.
#[derive(Debug, Clone)]
pub(super) struct LineOfFour {
    origin: [f64x4; 3],
    /// Two directions across the line; with it they form a right-handed frame for crossings out of the mesh, and a left-handed one for
    /// crossings into it.
    across: [[f64x4; 3]; 2],
}

impl LineOfFour {
    /// A line that crosses triangles in this direction.
    #[inline]
    pub(super) fn new(line: &TriangleLine, toward: Toward) -> Self {
        let [x, y] = line.across;
        let y = match toward {
            Toward::Front => y,
            Toward::Back => -y,
        };
        Self { origin: lanes(line.origin), across: [lanes(x), lanes(y)] }
    }

    /// A bit for each of four triangles that the line crosses.
    #[inline(always)]
    pub(super) fn crossed(&self, four: &FourTriangles) -> u32 {
        let [a, b, c] = &four.corners;
        let (a, b, c) = (self.seen(a), self.seen(b), self.seen(c));
        let (bc, ca, ab) = (side(b, c), side(c, a), side(a, b));
        let least = bc.fast_min(ca).fast_min(ab);
        let most = bc.fast_max(ca).fast_max(ab);
        (least.simd_ge(f64x4::ZERO) & most.simd_gt(f64x4::ZERO)).to_bitmask()
    }

    #[inline(always)]
    fn seen(&self, [x, y, z]: &[f64x4; 3]) -> [f64x4; 2] {
        let [ox, oy, oz] = self.origin;
        let (x, y, z) = (*x - ox, *y - oy, *z - oz);
        let along = |[dx, dy, dz]: [f64x4; 3]| x * dx + y * dy + z * dz;
        [along(self.across[0]), along(self.across[1])]
    }
}

/// Positive where the origin is to the left of the way from p to q.
#[inline(always)]
fn side([px, py]: [f64x4; 2], [qx, qy]: [f64x4; 2]) -> f64x4 {
    px * qy - py * qx
}

#[inline]
fn lanes(vector: DVec3) -> [f64x4; 3] {
    vector.to_array().map(f64x4::splat)
}
