//! Rays of sensors for the files of a report.

use crate::pipeline::version::VERSION;
use glam::DVec3;
use lumiduct_core::measure::Measures;
use lumiduct_core::transport::{CountedRay, RayCollection, counted_rays};
use lumiduct_files::rays::FileRay;
use lumiduct_input::{Job, RayExport};
use lumiduct_report::MeasuredRays;

/// The rays of a report, and remarks on sensors that have too few of them.
pub(super) fn rays(job: &Job, measures: &Measures) -> (Vec<MeasuredRays>, Vec<String>) {
    let mut remarks = Vec::new();
    let mut all = Vec::new();
    for export in &job.exports.rays {
        let name = &job.scene.sensors[export.sensor.index()].name;
        let rays = of_sensor(
            job,
            export,
            measures.values.get(&format!("{name}.flux")).map(|flux| flux.value),
        );
        if rays.len() < export.count {
            let (found, asked) = (rays.len(), export.count);
            let file = if found == 0 {
                "no ray file is written"
            } else {
                "its ray files contain only these"
            };
            remarks.push(format!(
                "`{name}` counted {found} of the {asked} rays requested, after 256 photons for each: {file}"
            ));
        }
        if !rays.is_empty() {
            all.push(MeasuredRays {
                sensor: name.clone(),
                formats: export.formats.clone(),
                unit: job.scene.unit,
                rays,
                origin: [
                    format!("{} (scene {})", job.title, job.hash),
                    format!("Lumiduct {VERSION}"),
                ],
            });
        }
    }
    (all, remarks)
}

/// Rays that carry the flux that the run has measured, if it has; their own sum has more noise.
fn of_sensor(job: &Job, export: &RayExport, flux: Option<f64>) -> Vec<FileRay> {
    let asked = RayCollection {
        sensor: export.sensor,
        count: export.count,
        seed: job.run.seed,
        bounce_limit: job.run.bounce_limit,
    };
    let rays = counted_rays(&job.scene, &asked);
    let sum: f64 = rays.iter().map(|ray| ray.flux).sum();
    let scale = flux.filter(|flux| *flux > 0.0).map_or(1.0, |flux| flux / sum);
    let in_file = |ray: &CountedRay| FileRay {
        position_mm: single(ray.point + job.scene.origin),
        direction: single(ray.dir),
        flux: (scale * ray.flux) as f32,
    };
    rays.iter().map(in_file).collect()
}

fn single(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}
