//! The health of a mesh, as a page: what prevents its use as a solid, and how its facets affect
//! light; and how many triangles the solids of a scene have.

use lumiduct_base::mesh::{CopiedBody, Defects, FaceSize, MeshAssembly, MeshHealth, WhyJoined};
use lumiduct_base::number::format_value;
use lumiduct_core::scene::mesh::MeshBody;
use lumiduct_core::scene::{Scene, SolidId};
use std::fmt::Write;

/// Bounces for which the drift of a faceted wall is reported.
const DRIFT_BOUNCES: [f64; 3] = [10.0, 100.0, 1000.0];

/// Triangles, and the time of a path over that in an exact sweep, 1: the first four measured with the bent rod of docs/cad.md, the last two from
/// the time to the next triangle of larger rods (docs/speed.md).
const MEASURED_TIMES: [[f64; 2]; 6] = [
    [656.0, 1.7],
    [2156.0, 1.9],
    [6266.0, 2.1],
    [20_136.0, 2.4],
    [100_800.0, 3.4],
    [979_600.0, 5.8],
];

/// The report on a mesh, lengths in mm.
pub fn mesh_report(name: &str, mesh: &MeshAssembly, health: &MeshHealth) -> String {
    let (bounds, number) = (mesh.bounds(), |value: f64| format_value(value));
    let size = bounds.max - bounds.min;
    let verdict = if health.is_sound() { "a closed solid" } else { "NOT a solid" };
    let mut text = format!(
        "{name}: {verdict}, {} triangles, {} vertices, {} connected\n\nbox     [{}, {}, {}] to [{}, {}, {}] mm, {} x {} x {} mm\n",
        mesh.triangle_count(),
        mesh.vertex_count(),
        if health.shells == 1 {
            "all".to_owned()
        } else {
            format!("{} parts, each", health.shells)
        },
        number(bounds.min.x),
        number(bounds.min.y),
        number(bounds.min.z),
        number(bounds.max.x),
        number(bounds.max.y),
        number(bounds.max.z),
        number(size.x),
        number(size.y),
        number(size.z),
    );
    let volume = number(health.signed_volume_mm3);
    // Writing to a string cannot fail, here and below.
    _ = writeln!(text, "area    {} mm²\nvolume  {volume} mm³", number(health.area_mm2));
    if health.signed_volume_mm3 < 0.0 {
        _ = writeln!(text, "        negative: inside out; flip the orientation of the triangles");
    }
    text.push_str("\nface                    triangles   area, mm²\n");
    for (face, FaceSize { triangles, area_mm2 }) in mesh.faces() {
        _ = writeln!(text, "{face:22} {triangles:>10}   {}", number(area_mm2));
    }
    for CopiedBody { body, places } in &mesh.copied {
        _ = writeln!(
            text,
            "\n{} copies share {} triangles of `{}`",
            places.len(),
            body.triangles.len(),
            body.faces.join("`, `")
        );
    }
    for (why, nodes) in &mesh.joined {
        _ = writeln!(text, "\n{nodes} of the copies do not share triangles: {}", why_joined(*why));
    }
    text.push_str("\nmust be none\n");
    defects(&mut text, "open edges", &health.open_edges);
    defects(&mut text, "edges of more than two triangles", &health.crowded_edges);
    defects(&mut text, "edges with one side flipped", &health.inconsistent_edges);
    text.push_str("\nshould be none\n");
    defects(&mut text, "normals that point to the back", &health.opposed_normals);
    defects(&mut text, "triangles without area", &health.degenerate_triangles);
    defects(&mut text, "slivers", &health.slivers);
    text.push_str("\ncurved walls\n");
    facets(&mut text, health);
    cost(&mut text, mesh);
    text
}

/// How many triangles a solid has, and how many of its bodies are copies; nothing for one without any.
pub(crate) fn triangles_of(scene: &Scene, solid: SolidId) -> String {
    let own = || scene.mesh_bodies().filter(|body| body.solid == solid);
    let count: usize = own().map(MeshBody::triangle_count).sum();
    match (count, own().filter(|body| body.is_copy()).count()) {
        (0, _) => String::new(),
        (count, 0) => format!(", {count} triangles"),
        (count, copies) => format!(", {count} triangles, {copies} copies"),
    }
}

/// Why copies do not share their triangles, in words.
fn why_joined(why: WhyJoined) -> &'static str {
    match why {
        WhyJoined::Few => "they are few, and one tree over all is searched faster",
        WhyJoined::Touching => "by their boxes they may touch another part",
        WhyJoined::Open => "their mesh is not closed by itself",
        WhyJoined::Distorted => "they stretch or shear their mesh",
        WhyJoined::Tiny => "they are far smaller than another copy",
    }
}

/// What tracing it takes.
fn cost(text: &mut String, mesh: &MeshAssembly) {
    let megabytes = mesh.memory_bytes() as f64 / 1e6;
    _ = writeln!(text, "\ncost\n  memory  about {megabytes:.1} MB");
    // How much copies add depends on how many of them light meets.
    if mesh.copied.is_empty() {
        let ratio = time_over_sweep(mesh.mesh.triangles.len() as f64);
        _ = writeln!(
            text,
            "  time    about {ratio:.1} times that of an exact sweep with bends; straight sweeps are faster still"
        );
    }
}

/// Time of a path in a bent rod of this many triangles over that in an exact sweep, 1, interpolated.
fn time_over_sweep(triangles: f64) -> f64 {
    let place = MEASURED_TIMES.partition_point(|[count, _]| *count < triangles);
    let upper = place.clamp(1, MEASURED_TIMES.len() - 1);
    let [[low, from], [high, to]] = [MEASURED_TIMES[upper - 1], MEASURED_TIMES[upper]];
    let share = (triangles / low).ln() / (high / low).ln();
    (from + share * (to - from)).max(1.0)
}

fn defects(text: &mut String, what: &str, defects: &Defects) {
    _ = write!(text, "  {what:34} {}", defects.count);
    if let Some(at) = defects.first {
        let [x, y, z] = at.to_array().map(format_value);
        _ = write!(text, ", the first at [{x}, {y}, {z}] mm");
    }
    text.push('\n');
}

/// How coarse the facets of curved walls are, and how that affects light.
fn facets(text: &mut String, health: &MeshHealth) {
    match (&health.facets, health.sagitta_mm) {
        (None, None) => text.push_str("  none: all facets are flat faces\n"),
        (None, Some(sagitta)) => {
            _ = writeln!(
                text,
                "  smoothed by normals; facets lie up to {} mm from the surface that the normals describe",
                format_value(sagitta)
            );
        }
        (Some(facets), _) => {
            _ = writeln!(
                text,
                "  {:.1} % of the area is flat facets, {:.0} per turn: light drifts as it is reflected",
                100.0 * facets.area_share,
                facets.per_turn()
            );
            for bounces in DRIFT_BOUNCES {
                _ = match facets.skew_drift(bounces) {
                    Some(drift) => writeln!(
                        text,
                        "  {bounces:>5} bounces: skewness drifts by about {:.2} %",
                        100.0 * drift
                    ),
                    None => writeln!(text, "  {bounces:>5} bounces: skewness is lost"),
                };
            }
            text.push_str("  export vertex normals, or use a sweep\n");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumiduct_base::mesh::bodies::{Normals, icosphere};

    #[test]
    fn copies_with_triangles_of_their_own_are_counted_with_the_reason() {
        let mut assembly = MeshAssembly::from(icosphere(1.0, 1, Normals::None));
        assembly.joined = [(WhyJoined::Touching, 3), (WhyJoined::Tiny, 1)].into_iter().collect();
        let text = mesh_report("balls.glb", &assembly, &assembly.health());
        for words in [
            "\n3 of the copies do not share triangles: by their boxes they may touch another part\n",
            "\n1 of the copies do not share triangles: they are far smaller than another copy\n",
        ] {
            assert!(text.contains(words), "{text}");
        }
    }
}
