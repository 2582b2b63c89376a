//! The page of a check: the scene in three dimensions before anything is traced, and the axes of its faces.

use crate::drawing::{NameMark, Role, drawing};
use crate::html::data;
use crate::html::frame::{Page, render};
use crate::local_axes::{LocalAxes, local_axes};
use crate::page::{Block, PagePart, Plots, Standing, table};
use glam::DVec3;
use lumiduct_base::error::Result;
use lumiduct_base::number::format_value;
use lumiduct_core::scene::{Owner, Scene};
use lumiduct_core::transport::Track;

/// Most solids and sheets with a name in the picture.
const MOST_NAMES: usize = 40;
/// What the tables of axes mean.
const AXES_WORDS: &str = "u and v are the coordinates of maps, patterns and cells on a face, in mm; n is the normal of its front. \
The origin is the point with u = v = 0 or, if that is outside the face, the nearest point of the face.";

/// The page of a check. `listed` is the contents of the scene, line by line.
///
/// # Errors
///
/// `Error::Output` if the template of pages cannot be filled in.
pub fn check_page(title: &str, scene: &Scene, tracks: &[Track], listed: &str) -> Result<String> {
    let mut plots = Plots::default();
    let mut drawing = drawing(scene, tracks);
    drawing.marks.splice(0..0, names(scene));
    let axes = local_axes(scene);
    let mut plot = data::scene(&drawing);
    plot["axes"] = data::axes(&drawing, &axes);
    let label = format!("the scene with {} paths, coloured by their end", drawing.paths.len());
    let mut blocks = vec![plots.add(label, plot, None)];
    if !drawing.remarks.is_empty() {
        let text = format!("The picture is simplified: {}.", drawing.remarks.join("; "));
        blocks.push(Block::Words { text });
    }
    let rows = axes.iter().map(row).collect();
    let head = ["face or sensor", "origin, mm", "u", "v", "n", "u from, to", "v from, to"];
    let axes = vec![Block::Words { text: AXES_WORDS.into() }, table(&head, rows)];
    let items = listed.lines().map(str::to_owned).collect();
    let page = Page {
        title: title.to_owned(),
        masthead: None,
        description: None,
        verdict: "Scene check: nothing was measured".into(),
        standing: Standing::Open,
        parts: vec![
            PagePart { title: "Scene".into(), blocks },
            PagePart { title: "Contents".into(), blocks: vec![Block::List { items }] },
            PagePart { title: "Local axes".into(), blocks: axes },
        ],
        footer: format!("lumiduct {}", env!("CARGO_PKG_VERSION")),
    };
    render(&page, &plots)
}

/// The names of solids and sheets, each at the middle of its box.
fn names(scene: &Scene) -> Vec<NameMark> {
    // The body of a source has the name of the source, which is already in the picture.
    let is_source = |name: &str| scene.sources.iter().any(|source| source.name == name);
    let bodies = scene.bodies().into_iter().filter(|body| !is_source(&body.name));
    let mut marks = Vec::new();
    for body in bodies.take(MOST_NAMES) {
        let role = match scene.owner(body.faces[0]) {
            Owner::Solid(_) => Role::Solid,
            Owner::Sheet | Owner::Port => Role::Sheet,
        };
        marks.push(NameMark { name: body.name, role, at: body.bounds.center() + scene.origin });
    }
    marks
}

fn row(axes: &LocalAxes) -> Vec<String> {
    let origin = axes.origin.to_array().map(format_value).join(", ");
    let range = |axis: usize| {
        axes.rect.map_or(String::new(), |rect| {
            [rect.min[axis], rect.max[axis]].map(format_value).join(" to ")
        })
    };
    let [u, v, normal] = [axes.u, axes.v, axes.normal].map(direction);
    vec![axes.name.clone(), origin, u, v, normal, range(0), range(1)]
}

/// A direction: `+x`, or its components.
fn direction(direction: DVec3) -> String {
    let parts = direction.to_array();
    match parts.iter().position(|part| part.abs() > 1.0 - 1e-9) {
        Some(axis) => {
            let sign = if parts[axis] > 0.0 { '+' } else { '-' };
            format!("{sign}{}", ["x", "y", "z"][axis])
        }
        None => parts.map(|part| format!("{part:.3}")).join(", "),
    }
}
