//! Rays from one format to another, streamed.

use glam::DVec3;
use lumiduct_base::error::{Error, Result};
use lumiduct_base::math::Aabb;
use lumiduct_base::number::format_value;
use lumiduct_files::rays::{
    FileRay, RayFileError, RayFormat, RayReader, RaySample, RaySetInfo, sample, write,
};
use lumiduct_report::{Existing, write_streamed};
use std::fmt::Write;
use std::path::Path;

/// Relative rounding of a flux in a header, 1.
const ROUNDING: f64 = 1e-5;

type Streamed<T> = std::result::Result<T, RayFileError>;

/// Writes the file, with a number of rays and a seed only so many of them, and describes the rays.
pub(super) fn converted(
    from: &Path,
    to: Option<&Path>,
    subset: Option<(u64, u64)>,
    existing: Existing,
) -> Result<String> {
    let format = match to {
        Some(to) => Some(RayFormat::of(to).map_err(|error| wrong(to, error))?),
        None => None,
    };
    let in_source = |error| wrong(from, error);
    let (mut info, mut remarks, rays) = match subset {
        Some((count, seed)) => {
            let most = usize::try_from(count).unwrap_or(usize::MAX);
            let RaySample { rays, mut info, remarks } =
                sample(from, most, seed).map_err(in_source)?;
            info.count = rays.len() as u64;
            (info.clone(), remarks, Some(scaled(rays, info.flux)))
        }
        None => {
            let reader = RayReader::open(from).map_err(in_source)?;
            (reader.info().clone(), reader.remarks().to_vec(), None)
        }
    };
    let open = || -> Streamed<Box<dyn Iterator<Item = Streamed<FileRay>> + '_>> {
        match &rays {
            Some(rays) => Ok(Box::new(rays.iter().copied().map(Ok))),
            None => Ok(Box::new(RayReader::open(from)?)),
        }
    };
    let extent = open().and_then(Extent::of).map_err(in_source)?;
    remarks.extend(info.remark_on_flux(extent.flux));
    let stated = std::mem::replace(&mut info.flux, extent.flux);
    let mut text = description(&info, stated, &extent);
    for remark in remarks {
        _ = writeln!(text, "remark: {remark}");
    }
    if let (Some(to), Some(format)) = (to, format) {
        let mut lost = Vec::new();
        write_streamed(to, existing, |file| {
            let written = open().and_then(|rays| write(file, format, &info, rays));
            lost = written.map_err(|error| wrong(to, error))?;
            Ok(())
        })?;
        for remark in lost {
            _ = writeln!(text, "remark: {remark}");
        }
        _ = writeln!(text, "written: {} ({format} file)", to.display());
    }
    Ok(text)
}

fn wrong(path: &Path, error: RayFileError) -> Error {
    Error::Usage(format!("{}: {error}", path.display()))
}

/// Rays that carry a flux together.
fn scaled(mut rays: Vec<FileRay>, flux: f64) -> Vec<FileRay> {
    let sum: f64 = rays.iter().map(|ray| f64::from(ray.flux)).sum();
    for ray in &mut rays {
        ray.flux = (f64::from(ray.flux) * flux / sum) as f32;
    }
    rays
}

/// What all rays have together.
struct Extent {
    starts: Aabb,
    /// Sum of the directions, each times its flux.
    direction: DVec3,
    flux: f64,
    flux_range: [f32; 2],
}

impl Extent {
    fn of(rays: impl Iterator<Item = Streamed<FileRay>>) -> Streamed<Self> {
        let mut all = Self {
            starts: Aabb::EMPTY,
            direction: DVec3::ZERO,
            flux: 0.0,
            flux_range: [f32::INFINITY, 0.0],
        };
        for ray in rays {
            let FileRay { position_mm, direction, flux } = ray?;
            let double = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
            all.starts = all.starts.union(Aabb::of([double(position_mm)]));
            all.direction += f64::from(flux) * double(direction);
            all.flux += f64::from(flux);
            all.flux_range = [all.flux_range[0].min(flux), all.flux_range[1].max(flux)];
        }
        if all.flux > 0.0 { Ok(all) } else { Err(RayFileError::NoLight) }
    }
}

/// Rays in a few lines.
fn description(info: &RaySetInfo, stated: f64, extent: &Extent) -> String {
    let unit = info.unit.flux();
    let mut text = format!("rays: {}\n", info.count);
    for (kind, own) in &info.texts {
        _ = writeln!(text, "{}: {own}", kind.name());
    }
    _ = write!(text, "flux: {} {unit}", format_value(extent.flux));
    if stated > 0.0 && (stated / extent.flux - 1.0).abs() > ROUNDING {
        _ = write!(text, ", {} {unit} in the header", format_value(stated));
    }
    if let Some(luminous) = info.luminous_flux_lm {
        _ = write!(text, ", {} lm in the header", format_value(luminous));
    }
    let [least, most] = extent.flux_range.map(|flux| format_value(f64::from(flux)));
    _ = writeln!(text, "; of a ray {least} to {most} {unit}");
    let (min, max) = (extent.starts.min.to_array(), extent.starts.max.to_array());
    let sides = [("x", 0), ("y", 1), ("z", 2)].map(|(name, axis)| {
        format!("{name} {} to {}", format_value(min[axis]), format_value(max[axis]))
    });
    _ = writeln!(text, "starts: {} mm", sides.join(", "));
    let mean = extent.direction / extent.flux;
    let mean = mean.to_array().map(format_value).join(", ");
    _ = writeln!(text, "mean direction: {mean}");
    text
}
