//! Rays of a file that fit into memory.

use crate::rays::{FileRay, RayFileError, RayReader, RaySetInfo};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;

/// Rays of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct RaySample {
    /// The rays, in the order of the file.
    pub rays: Vec<FileRay>,
    /// What the file says; its flux is the sum over all of its rays.
    pub info: RaySetInfo,
    /// What was assumed and what is not used: sentences without a full stop.
    pub remarks: Vec<String>,
}

/// Reads a whole file, checks every ray, and keeps at most `most` of them, each with the same probability.
///
/// # Errors
///
/// As [`RayReader::open`]; [`RayFileError::Violated`] at the first ray that is not one; [`RayFileError::NoLight`] if all fluxes are 0.
pub fn sample(path: &Path, most: usize, seed: u64) -> Result<RaySample, RayFileError> {
    sampled(RayReader::open(path)?, most, seed)
}

/// Reservoir sampling, algorithm R (J. S. Vitter, ACM Trans. Math. Softw. 11 (1985) 37).
pub(crate) fn sampled(
    mut reader: RayReader,
    most: usize,
    seed: u64,
) -> Result<RaySample, RayFileError> {
    let (mut info, mut remarks) = (reader.info().clone(), reader.remarks().to_vec());
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut kept: Vec<(u64, FileRay)> = Vec::new();
    let mut sum = 0.0;
    for (index, ray) in (0..).zip(&mut reader) {
        let ray = ray?;
        sum += f64::from(ray.flux);
        if kept.len() < most {
            kept.push((index, ray));
        } else {
            // 2⁻⁶⁴ times the count is the error of the probabilities.
            let place = ((u128::from(random.next_u64()) * u128::from(index + 1)) >> 64) as usize;
            if let Some(kept) = kept.get_mut(place) {
                *kept = (index, ray);
            }
        }
    }
    if sum <= 0.0 {
        return Err(RayFileError::NoLight);
    }
    remarks.extend(info.remark_on_flux(sum));
    info.flux = sum;
    kept.sort_unstable_by_key(|(index, _)| *index);
    Ok(RaySample { rays: kept.into_iter().map(|(_, ray)| ray).collect(), info, remarks })
}
