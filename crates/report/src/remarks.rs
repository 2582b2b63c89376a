//! Remarks on results that need care: light that was lost, missed or counted more than once.
//!
//! They are part of the record; the pages decide where to show them.

use crate::by_light::remark_on_weathers;
use lumiduct_base::number::{format_percent, format_with_error};
use lumiduct_core::measure::{LostPaths, Measure, Measures, Status};
use lumiduct_core::scene::{CountedLight, Emitter, Place, Scene, Seeing, Sensor, SensorKind};
use lumiduct_core::transport::GROUPS;

/// Share of the flux cut by the bounce limit above which there is a remark, 1.
const CUT_SHARE: f64 = 1e-3;

/// Remarks that the results ask for.
pub fn remarks(measures: &Measures, scene: &Scene) -> Vec<String> {
    let mut remarks = Vec::new();
    let value = |name: &str| measures.values.get(name).map_or(0.0, |measure| measure.value);
    if value("balance.leaked") > 0.0 {
        remarks.push("light leaked through holes in the geometry: see balance.leaked".to_owned());
    }
    let cut = value("balance.cut") / measures.source_flux;
    if cut > CUT_SHARE {
        remarks.push(format!(
            "{} of the light was cut by the bounce limit: see balance.cut; raise run.bounce_limit, or add \
                the losses of walls and media",
            format_percent(cut)
        ));
    }
    for paths in &measures.sensor_paths {
        let sensor = &paths.sensor;
        remarks.extend(paths.lost.and_then(|lost| remark_on_lost_paths(sensor, lost)));
        let (flux, other) =
            (value(&format!("{sensor}.flux")), value(&format!("{sensor}.flux_other_side")));
        let outside = value(&format!("{sensor}.flux_outside_aim"));
        if flux == 0.0 && outside == 0.0 && other > 0.0 {
            remarks.push(remark_on_other_side(sensor, scene));
        }
        if outside > flux {
            remarks.push(format!(
                "sensor `{sensor}` counts only light from its aim, and more reaches it from elsewhere: see \
                    {sensor}.flux_outside_aim; aim at everything that lights it"
            ));
        }
        let own = measures.values.get(&format!("{sensor}.flux"));
        if own.is_some_and(|own| own.status == Status::Contradicted) {
            remarks.push(format!(
                "photons of the same run found more light on sensor `{sensor}` than its gather paths, which \
                    rarely meet one of the sources: use `--estimator forward` or `mix`"
            ));
        }
    }
    remarks.extend(remark_on_weathers(measures));
    remarks.extend(measures.accounts.iter().filter_map(|account| account.warning.clone()));
    remarks
}

/// Errors by which the counted light must exceed what was emitted or entered for a remark, 1.
const CLEARLY: f64 = 4.0;
/// Relative excess required in any case, 1: rounding of sums.
const ROUNDING: f64 = 1e-9;

/// Remarks on sensors that count more light than was emitted, as it passes them more than once or fluorescence has more lumens.
pub fn remarks_on_passages(scene: &Scene, measures: &Measures) -> Vec<String> {
    let gains = |(name, line): (&String, &Measure)| {
        name.starts_with("balance.converted.") && -line.value > CLEARLY * line.std_error
    };
    let gains = scene.fluoresces() && measures.values.iter().any(gains);
    let remark = |sensor: &Sensor| {
        let name = &sensor.name;
        let is_above = |what: &&str| {
            measures.values.get(&format!("{name}.{what}")).is_some_and(|share| {
                share.value > 1.0 + ROUNDING && share.value - 1.0 > CLEARLY * share.total_error()
            })
        };
        let what = ["efficiency", "transmission"].into_iter().find(is_above)?;
        let way_out = match &sensor.kind {
            SensorKind::Surface(surface)
                if matches!(surface.seeing, Seeing::All) && sensor.aim.is_empty() =>
            {
                format!("; to count each path once, write passage = \"first\" in sensors.{name}")
            }
            SensorKind::Surface(_) | SensorKind::Goniometer(_) => String::new(),
        };
        let value = &measures.values[&format!("{name}.{what}")];
        let value = format_with_error(value.value, value.std_error);
        if gains {
            return Some(format!("`{name}.{what}` is {value}"));
        }
        Some(format!(
            "the {what} of sensor `{name}` is {value}, above 1: light passes the sensor more than once and is \
                counted each time{way_out}"
        ))
    };
    let remarks: Vec<String> = scene.sensors.iter().filter_map(remark).collect();
    if !gains || remarks.is_empty() {
        return remarks;
    }
    vec![format!(
        "{}: these compare lumens, and fluorescence emits more of them than it absorbs; `radiant_efficiency` compares \
            watts. Light that passes a sensor more than once is counted each time",
        remarks.join(", ")
    )]
}

/// Remarks on sensors whose flux is less certain than its error says, as the rays of a source are a sample of the light of a lamp.
pub fn remarks_on_ray_sets(scene: &Scene, measures: &Measures) -> Vec<String> {
    let lit = || scene.sources.iter().filter(|source| source.is_lit());
    let per_ray = lit().filter_map(|source| Some(source.flux / source.emitter.effective_rays()?));
    let per_ray = per_ray.fold(0.0, f64::max);
    // A fit gives a cell light of neighbouring rays, too.
    let has_rays = lit().any(|source| matches!(source.emitter, Emitter::Rays { .. }));
    let has_fit = lit().any(|source| matches!(source.emitter, Emitter::Fitted { .. }));
    let not_in_errors = if has_fit {
        "include neither this nor the detail that a fit to the rays averages out"
    } else {
        "do not include this"
    };
    let remark = |sensor: &Sensor| {
        let flux = measures.values.get(&format!("{}.flux", sensor.name))?;
        // Rays that reach the sensor with probability p have a flux of variance Φ² p (1 - p) / N, which is at most Φ / N times the flux; of
        // several sources, the largest Φ / N and the whole flux are still a bound.
        let of_rays = (per_ray * flux.value).sqrt();
        (of_rays > flux.std_error).then(|| {
            let share = of_rays / flux.value;
            let cells = match sensor.cells() {
                1 => String::new(),
                _ if !has_rays => String::new(),
                count => {
                    let of_cell = share * (count as f64).sqrt();
                    format!(" (a cell with the mean flux: {})", format_percent(of_cell))
                }
            };
            format!(
                "as an estimate for the lamp, `{}.flux` has a standard error of up to {}{cells}, because the rays are a sample of the \
                    lamp's light; the stated errors {not_in_errors}",
                sensor.name,
                format_percent(share),
            )
        })
    };
    scene.sensors.iter().filter_map(remark).collect()
}

/// A remark on a sensor that counted nothing while light met its other side. Light that leaves a
/// solid inward was reflected or let in there: that is not light from the other side.
fn remark_on_other_side(name: &str, scene: &Scene) -> String {
    let kind = scene.sensors.iter().find(|sensor| sensor.name == name).map(|sensor| &sensor.kind);
    match kind {
        Some(SensorKind::Surface(surface))
            if surface.counts == CountedLight::Leaving && surface.place == Place::Face =>
        {
            format!(
                "sensor `{name}` counts light that leaves its face, and none did: all light that met the \
                    face was reflected or entered there; see {name}.flux_other_side"
            )
        }
        Some(SensorKind::Surface(_) | SensorKind::Goniometer(_)) | None => {
            format!("sensor `{name}` was lit on its other side only: turn its axis, or set `side`")
        }
    }
}

/// A remark where a noticeable share of the gather paths of a sensor was lost.
fn remark_on_lost_paths(sensor: &str, lost: LostPaths) -> Option<String> {
    let LostPaths { cut, leaked } = lost;
    (cut + leaked > CUT_SHARE).then(|| {
        format!(
            "{} of the throughput of gather paths from sensor `{sensor}` was cut by the bounce limit and {} \
                was lost through holes in the geometry; the light they would have met is missing; raise \
                run.bounce_limit, or repair the geometry",
            format_percent(cut),
            format_percent(leaked)
        )
    })
}

/// A remark where a run traced noticeably more paths than requested.
pub fn remark_on_paths(asked: Option<u64>, traced: u64) -> Option<String> {
    let asked = asked.filter(|&asked| traced > asked + asked / 10)?;
    Some(format!(
        "{traced} paths were traced although {asked} were requested: a run ends with whole batches, often {GROUPS}, each \
            with at least one path from each source, or with a wave of passes, each with all of its photons and gather paths"
    ))
}
