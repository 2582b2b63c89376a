//! Which way is up in a picture by default.

use lumiduct_core::scene::{Emission, Scene, Source};

/// Cosine of the angle to −z within which a source shines down: 60 degrees.
const DOWN: f64 = 0.5;

/// Whether +z is up: there is daylight, or all sources shine down.
pub(super) fn is_lit_from_above(scene: &Scene) -> bool {
    let is_daylight =
        |source: &Source| source.emitter.is_far() || matches!(source.emission, Emission::Sky(_));
    let shines_down = |source: &Source| {
        let is_all_around = matches!(source.emission, Emission::Isotropic);
        !is_all_around && source.emitter.axis().is_some_and(|axis| axis.z < -DOWN)
    };
    scene.sources.iter().any(is_daylight)
        || !scene.sources.is_empty() && scene.sources.iter().all(shines_down)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::tests::scene_of;

    fn is_upright(sources: &str) -> bool {
        is_lit_from_above(&scene_of(&format!(
            "[solids.rod.cylinder]\nradius_mm = 1\nlength_mm = 20\nmedium = \"pc\"\n{sources}"
        )))
    }

    #[test]
    fn light_that_comes_down_says_where_up_is() {
        let down = "[sources.lamp.disk]\nradius_mm = 1\nat = { position_mm = [0, 0, 30], axis = [0, 0.3, -1] }\nflux_lm = 1\n";
        let up =
            "[sources.led.disk]\nradius_mm = 1\nat = { position_mm = [0, 0, -1] }\nflux_lm = 1\n";
        let sky = "[sources.sky.sky]\nmodel = \"overcast\"\nhorizontal_illuminance_lx = 10_000\naim = \"rod\"\n";
        assert!(is_upright(down) && is_upright(sky));
        assert!(!is_upright(up));
        // Sources that shine both ways leave it open; daylight decides it.
        assert!(!is_upright(&format!("{down}{up}")) && is_upright(&format!("{up}{sky}")));
        // A ball or a bare point leaves it open, too.
        let ball = "[sources.ball.sphere]\nradius_mm = 1\nat = { position_mm = [0, 0, 30], axis = [0, 0, -1] }\nflux_lm = 1\n";
        let point = "[sources.lamp.point]\nat = { position_mm = [0, 0, 30], axis = [0, 0, -1] }\nflux_lm = 1\nemission = \"isotropic\"\n";
        assert!(!is_upright(ball) && !is_upright(point));
    }
}
