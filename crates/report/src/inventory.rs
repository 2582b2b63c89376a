//! The contents of a scene: media, finishes, solids, faces, sources and sensors with their sizes
//! and places.
//!
//! One description for `check`, `report.md` and the page. The content of the scene file is given in
//! its own words; areas, volumes and etendues are computed from the scene.

use crate::mesh::triangles_of;
use glam::DVec3;
use lumiduct_base::number::format_value;
use lumiduct_core::colour::VISIBLE;
use lumiduct_core::optics::{CoefficientLaw, IndexLaw, Medium, REFERENCE_WAVELENGTH};
use lumiduct_core::scene::{
    Face, FaceId, MediumId, Owner, Scene, Seeing, Sensor, SensorKind, SolidId, Source, SunAngles,
};
use lumiduct_input::{Outline, library};
use std::collections::BTreeSet;
use std::fmt::Write;

/// Entries of a list that are shown.
const SHOWN: usize = 40;

/// Head of columns that are not labelled in a line of text.
const WHAT: &str = "what";
const WHAT_IT_DOES: &str = "what it does";

/// Everything that is in a scene, list by list.
#[derive(Debug, Clone, Default)]
pub struct Inventory {
    /// The lists that are not empty.
    pub lists: Vec<Listing>,
}

/// A list of things of one kind.
#[derive(Debug, Clone)]
pub struct Listing {
    /// What its entries are called: `solid`.
    pub what: &'static str,
    /// Heads of the columns; the first is that of the name.
    pub head: Vec<&'static str>,
    /// The entries that are shown.
    pub rows: Vec<Vec<String>>,
    /// Number of all entries.
    pub count: usize,
}

impl Listing {
    /// A list of `count` entries, where only the shown ones are put into words.
    fn new<const N: usize>(
        what: &'static str,
        head: [&'static str; N],
        count: usize,
        rows: impl Iterator<Item = [String; N]>,
    ) -> Self {
        let rows: Vec<[String; N]> = rows.take(SHOWN).collect();
        let kept: Vec<usize> = (0..N)
            .filter(|&column| column == 0 || rows.iter().any(|row| !row[column].is_empty()))
            .collect();
        let pick = |row: &[String; N]| kept.iter().map(|&column| row[column].clone()).collect();
        Self {
            what,
            head: kept.iter().map(|&column| head[column]).collect(),
            rows: rows.iter().map(pick).collect(),
            count,
        }
    }

    /// How many entries are not shown, in words; `None` where all are.
    pub(crate) fn left_out(&self) -> Option<String> {
        let more = self.count.saturating_sub(self.rows.len());
        (more > 0).then(|| format!("The first {} of {}.", self.rows.len(), self.count))
    }
}

impl Inventory {
    /// What is in a scene; `outline` is what its file says.
    pub fn of(scene: &Scene, outline: &Outline) -> Self {
        let lists = [
            media(scene),
            finishes(scene, outline),
            solids(scene, outline),
            sheets(scene, outline),
            faces(scene),
            patterns(scene, outline),
            reliefs(scene, outline),
            sources(scene, outline),
            sensors(scene, outline),
        ];
        Self { lists: lists.into_iter().filter(|list| list.count > 0).collect() }
    }

    /// A line for each entry: `solid rod: shape cylinder, radius 2 mm; medium acrylic`.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for list in &self.lists {
            for row in &list.rows {
                let cells = list.head.iter().zip(row).skip(1).filter(|(_, cell)| !cell.is_empty());
                let told: Vec<String> =
                    cells.map(|(head, cell)| format!("{head} {cell}")).collect();
                _ = writeln!(text, "{} {}: {}", list.what, row[0], told.join("; "));
            }
            if let Some(left_out) = list.left_out() {
                _ = writeln!(text, "{}s: {left_out}", list.what);
            }
        }
        text
    }
}

fn media(scene: &Scene) -> Listing {
    let rows = scene.media.iter().map(|medium| {
        let scattering = medium.turbidity().map_or(String::new(), |own| {
            format!("{}, anisotropy {}", by_wavelength(&own.coefficient), own.anisotropy)
        });
        let fluorescence = medium.fluorescence().map_or(String::new(), |fluorescence| {
            let [first, last] = VISIBLE.map(|end| end as u32);
            let at = |nm: &u32| fluorescence.absorption_law().at(f64::from(*nm));
            let peak = (first + 1..=last).max_by(|a, b| at(a).total_cmp(&at(b))).unwrap_or(last);
            format!(
                "absorbs up to {} /mm, at {peak} nm, quantum yield {}, emits about {} nm",
                format_value(at(&peak)),
                fluorescence.quantum_yield(),
                format_value(fluorescence.emission().mean_wavelength())
            )
        });
        let absorption = by_wavelength(medium.absorption_law());
        [medium.name().to_owned(), index(medium), absorption, scattering, fluorescence]
    });
    let head = ["medium", "index", "absorption", "scattering", "fluorescence"];
    Listing::new("medium", head, scene.media.len(), rows)
}

/// The refractive index of a medium in words.
fn index(medium: &Medium) -> String {
    let law = medium.index_law();
    match law {
        IndexLaw::Constant(index) => index.to_string(),
        IndexLaw::Cauchy(_) | IndexLaw::Sellmeier(_) | IndexLaw::Powers(_) | IndexLaw::Table(_) => {
            format!(
                "{} at {REFERENCE_WAVELENGTH} nm, Abbe number {}",
                format_value(law.at(REFERENCE_WAVELENGTH)),
                format_value(law.abbe_number())
            )
        }
    }
}

/// A coefficient of a medium in words.
fn by_wavelength(law: &CoefficientLaw) -> String {
    let at = |nm: f64| format_value(law.at(nm));
    match law {
        CoefficientLaw::Constant(coefficient) => format!("{coefficient} /mm"),
        CoefficientLaw::Table(_) => {
            format!("{}, {} and {} /mm at 450, 550 and 650 nm", at(450.0), at(550.0), at(650.0))
        }
    }
}

/// The finishes of faces and patterns; those without a name are listed by their place.
fn finishes(scene: &Scene, outline: &Outline) -> Listing {
    let of_faces = scene.faces.iter().flat_map(|face| [face.front, face.back]).flatten();
    let of_patterns = scene.patterns.iter().flat_map(|pattern| [pattern.front, pattern.back]);
    let used: BTreeSet<usize> = of_faces.chain(of_patterns).map(|id| id.index()).collect();
    let rows: Vec<[String; 3]> = used
        .into_iter()
        .filter_map(|index| {
            let name = &scene.finishes[index].name;
            let words = match outline.entry("finishes", name, &[]) {
                told if !told.is_empty() => told,
                _ => predefined(name).map(str::to_owned).or_else(|| listed(name))?,
            };
            let sheets = scene.finishes[index].finish.measured_sheets();
            let checks: Vec<String> = sheets.iter().map(|own| own.checks.to_string()).collect();
            Some([name.clone(), words, checks.join("; ")])
        })
        .collect();
    Listing::new("finish", ["finish", WHAT_IT_DOES, "checked"], rows.len(), rows.into_iter())
}

/// The effect of finishes that need no definition.
fn predefined(name: &str) -> Option<&'static str> {
    match name {
        "polished" => Some("smooth: reflects and refracts by Fresnel's equations"),
        "black" => Some("absorbs all light"),
        "open" => Some("lets all light pass"),
        _ => None,
    }
}

/// The keys and the source of a finish of the library.
fn listed(name: &str) -> Option<String> {
    let entry = library::finishes().get(name)?;
    Some(format!("{}, of the library: {}", entry.keys, entry.source))
}

fn solids(scene: &Scene, outline: &Outline) -> Listing {
    let rows = scene.solids.iter().enumerate().map(|(index, solid)| {
        let size = solid.bounds.max - solid.bounds.min;
        let priority = if solid.priority == 0 { String::new() } else { solid.priority.to_string() };
        [
            solid.name.clone(),
            outline.entry("solids", &solid.name, &["medium", "at", "priority"])
                + &triangles_of(scene, SolidId::new(index)),
            place(outline, "solids", &solid.name),
            scene.media[solid.medium.index()].name().to_owned(),
            priority,
            solid.volume.map_or(String::new(), |volume| format!("{} mm³", format_value(volume))),
            format!("{} mm", sides(size)),
        ]
    });
    let head = ["solid", "shape", "place", "medium", "priority", "volume", "box around it"];
    Listing::new("solid", head, scene.solids.len(), rows)
}

fn sheets(scene: &Scene, outline: &Outline) -> Listing {
    let mut names: Vec<&str> = Vec::new();
    for face in scene.faces.iter().filter(|face| face.owner == Owner::Sheet) {
        let name = face.name.split('.').next().unwrap_or_default();
        if names.last() != Some(&name) {
            names.push(name);
        }
    }
    let rows = names.iter().map(|name| {
        let finish = outline.field("sheets", name, "finish");
        [
            (*name).to_owned(),
            outline.entry("sheets", name, &["at", "finish"]),
            place(outline, "sheets", name),
            finish,
        ]
    });
    Listing::new("sheet", ["sheet", "shape", "place", "finish"], names.len(), rows)
}

/// Where the file puts something.
fn place(outline: &Outline, section: &str, name: &str) -> String {
    match outline.field(section, name, "at") {
        nothing if nothing.is_empty() => "at the origin".to_owned(),
        told => told,
    }
}

/// Faces by name; neighbours of one owner, finish and area share a row.
fn faces(scene: &Scene) -> Listing {
    let finish = |face: &Face| {
        let name = |id: Option<lumiduct_core::scene::FinishId>| {
            id.map_or("polished", |id| scene.finishes[id.index()].name.as_str())
        };
        match face.owner {
            Owner::Port => String::new(),
            Owner::Solid(_) | Owner::Sheet if face.front == face.back => name(face.back).to_owned(),
            Owner::Solid(_) | Owner::Sheet => {
                format!("{} in front, {} behind", name(face.front), name(face.back))
            }
        }
    };
    let mut rows: Vec<([String; 4], Owner)> = Vec::new();
    for (index, face) in scene.faces.iter().enumerate() {
        let kind = match face.owner {
            Owner::Solid(_) => "of a solid",
            Owner::Sheet => "sheet",
            Owner::Port => "open",
        };
        let area = format!("{} mm²", format_value(scene.face_area(FaceId::new(index))));
        let row = [face.name.clone(), kind.to_owned(), area, finish(face)];
        let same =
            rows.last_mut().filter(|(own, owner)| *owner == face.owner && own[1..] == row[1..]);
        if let Some((own, _)) = same {
            own[0] += &format!(", {}", face.name);
            continue;
        }
        // Only the number of further ones matters.
        if rows.len() > SHOWN {
            break;
        }
        rows.push((row, face.owner));
    }
    let count = if rows.len() > SHOWN { scene.faces.len() } else { rows.len() };
    let head = ["face", WHAT, "area", "finish"];
    Listing::new("face", head, count, rows.into_iter().map(|(row, _)| row))
}

fn patterns(scene: &Scene, outline: &Outline) -> Listing {
    let rows = scene.patterns.iter().map(|pattern| {
        let (count, area) = (pattern.field.count(), pattern.field.area());
        let share = 100.0 * area / scene.face_area(pattern.face);
        [
            pattern.name.clone(),
            scene.faces[pattern.face.index()].name.clone(),
            outline.entry("patterns", &pattern.name, &["on", "finish"]),
            count.to_string(),
            format!("{} mm², {share:.3} % of the face", format_value(area)),
            scene.finishes[pattern.back.index()].name.clone(),
        ]
    });
    let head = ["pattern", "on", "shape", "elements", "area", "finish"];
    Listing::new("pattern", head, scene.patterns.len(), rows)
}

fn reliefs(scene: &Scene, outline: &Outline) -> Listing {
    let rows = scene.reliefs.iter().map(|relief| {
        [
            relief.name.clone(),
            scene.faces[relief.wall.index()].name.clone(),
            // The relief is the last part of the name of its face.
            outline.entry("reliefs", relief.name.rsplit('.').next().unwrap_or_default(), &["on"]),
            relief.field.count().to_string(),
            format!("up to {} mm", format_value(relief.height())),
            format!("{} mm³", format_value(relief.volume())),
        ]
    });
    let head = ["relief", "on", "shape", "elements", "height", "volume"];
    Listing::new("relief", head, scene.reliefs.len(), rows)
}

fn sources(scene: &Scene, outline: &Outline) -> Listing {
    let unit = scene.unit.flux();
    let rows = scene.sources.iter().map(|source| {
        let area = source.emitter.area();
        [
            source.name.clone(),
            format!("{} {unit}", format_value(source.flux)),
            outline.entry("sources", &source.name, &["at", "flux_lm", "flux_w", "group"]),
            source_place(scene, source, outline),
            area.map_or(String::new(), |area| format!("{} mm²", format_value(area))),
            etendue(scene, source)
                .map_or(String::new(), |etendue| format!("{} mm² sr", format_value(etendue))),
        ]
    });
    let head = ["source", "flux", "shape and emission", "place", "area", "etendue"];
    Listing::new("source", head, scene.sources.len(), rows)
}

/// Where the file puts a source, its middle, and the position of the sun.
fn source_place(scene: &Scene, source: &Source, outline: &Outline) -> String {
    let middle = (!source.emitter.is_far()).then(|| {
        let bounds = source.emitter.bounds();
        format!("middle at {}", point(0.5 * (bounds.min + bounds.max) + scene.origin))
    });
    let told = outline.field("sources", &source.name, "at");
    let sun = source.sun.map(|SunAngles { elevation, azimuth }| {
        let [elevation, azimuth] = [elevation, azimuth].map(f64::to_degrees);
        format!("sun {elevation:.2} deg above the horizon, azimuth {azimuth:.2} deg")
    });
    [Some(told).filter(|told| !told.is_empty()), middle, sun]
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join(", ")
}

/// Etendue G = n² A Ω (projected) of a source that has an area, mm² sr.
fn etendue(scene: &Scene, source: &Source) -> Option<f64> {
    let extent = source.projected_extent()?;
    let index = scene.media[MediumId::index(scene.surroundings)].index(REFERENCE_WAVELENGTH);
    Some(index * index * extent)
}

fn sensors(scene: &Scene, outline: &Outline) -> Listing {
    let rows = scene.sensors.iter().map(|sensor| {
        let told = outline.entry("sensors", &sensor.name, &["at", "on", "file"]);
        let place = ["on", "at"].map(|key| outline.field("sensors", &sensor.name, key));
        let place = match place.map(|told| Some(told).filter(|told| !told.is_empty())) {
            [Some(face), _] => format!("on {face}"),
            [None, Some(told)] => told,
            [None, None] => "at the origin".to_owned(),
        };
        [sensor.name.clone(), kind(sensor), told, place, sensor.cells().to_string()]
    });
    let head = ["sensor", WHAT, "settings", "place", "cells"];
    Listing::new("sensor", head, scene.sensors.len(), rows)
}

/// What a sensor is, and how large.
fn kind(sensor: &Sensor) -> String {
    match &sensor.kind {
        SensorKind::Surface(surface) => {
            let kind = match &surface.seeing {
                Seeing::All => "plane of ",
                Seeing::Views(_) => "luminance over ",
                Seeing::Pixels(_) => "image through ",
            };
            format!("{kind}{} mm²", format_value(surface.area()))
        }
        SensorKind::Goniometer(goniometer) => match goniometer.radius {
            Some(radius) => format!("goniometer of radius {} mm", format_value(radius)),
            None => "far-field goniometer".into(),
        },
    }
}

/// A place in the user's coordinates.
fn point(at: DVec3) -> String {
    // Hides the rounding of computed places.
    let place = at.to_array().map(|x| format_value((1e6 * x).round() / 1e6));
    format!("[{}] mm", place.join(", "))
}

fn sides(size: DVec3) -> String {
    size.to_array().map(|side| format_value((1e6 * side).round() / 1e6)).join(" x ")
}
