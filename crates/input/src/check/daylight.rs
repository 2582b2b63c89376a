//! The sun and the sky: each gives the place of the sun exactly once, and up and north are valid.

use crate::check::scene::Scene;
use crate::keys::Key;
use crate::problems::Problems;
use crate::spec::daylight::{SkyModelSpec, SunPlaceSpec, WhenSpec};
use crate::spec::source::SourceSpec;
use glam::DVec3;
use lumiduct_base::math::Frame;
use lumiduct_core::optics::sun::{Date, Misread, read_time};

pub(crate) fn check(scene: Scene<'_>, problems: &mut Problems) {
    check_world(scene, problems);
    for (name, source) in &scene.spec.sources {
        let key = Key::of(&["sources", name, source.kind()]);
        match source {
            SourceSpec::Sun(sun) => check_place(&key, &sun.place, problems),
            SourceSpec::Sky(sky) => {
                check_need(&key, sky.model, &sky.place, problems);
                check_place(&key, &sky.place, problems);
            }
            SourceSpec::Point(_)
            | SourceSpec::Disk(_)
            | SourceSpec::Rectangle(_)
            | SourceSpec::Sphere(_)
            | SourceSpec::Line(_)
            | SourceSpec::Cylinder(_)
            | SourceSpec::Face(_)
            | SourceSpec::Volume(_) => {}
        }
    }
}

/// Whether a sky is brighter about the sun.
fn needs_sun(model: SkyModelSpec) -> bool {
    match model {
        SkyModelSpec::Uniform | SkyModelSpec::Overcast | SkyModelSpec::CieType(1 | 3 | 5) => false,
        SkyModelSpec::Clear | SkyModelSpec::CieType(_) => true,
    }
}

fn check_need(key: &Key, model: SkyModelSpec, place: &SunPlaceSpec, problems: &mut Problems) {
    let SunPlaceSpec { elevation_deg, azimuth_deg, when } = place;
    let is_given = elevation_deg.is_some() || when.is_some();
    if needs_sun(model) && !is_given {
        problems
            .error(&key.field("model"), "is brighter about the sun, and nothing says where that is")
            .hint("give `elevation_deg` and `azimuth_deg`, or `when`");
    }
    if elevation_deg.is_some() && when.is_some() {
        problems
            .error(&key.field("when"), "the sun has an `elevation_deg` already")
            .hint("give `when`, or `elevation_deg` and `azimuth_deg`");
    }
    if !needs_sun(model) && (is_given || azimuth_deg.is_some()) {
        let given = if elevation_deg.is_some() {
            "elevation_deg"
        } else if when.is_some() {
            "when"
        } else {
            "azimuth_deg"
        };
        problems
            .error(&key.field(given), "this sky is the same on all sides and has no sun")
            .hint("remove it; the sun's disk is a source of its own, `sun`");
    }
}

fn check_place(key: &Key, place: &SunPlaceSpec, problems: &mut Problems) {
    let Some(when) = &place.when else { return };
    if place.azimuth_deg.is_some() {
        problems
            .error(&key.field("azimuth_deg"), "the azimuth follows from `when`")
            .hint("remove it");
    }
    let WhenSpec { date, time, .. } = when;
    let key = key.field("when");
    let mut judge = |name: &str, text: &str, misread: Option<Misread>, form: &str| {
        if let Some(reason) = misread {
            problems
                .error(&key.field(name), format!("`{}` {reason}", text.escape_debug()))
                .hint(form);
        }
    };
    judge("date", date, Date::read(date).err(), "write it as \"2026-06-21\": year, month, day");
    judge("time", time, read_time(time).err(), "write it as \"14:30\" or \"14:30:15\"");
}

/// Up and north must not be parallel.
fn check_world(scene: Scene<'_>, problems: &mut Problems) {
    let [up, north] = [scene.spec.up, scene.spec.north].map(DVec3::from);
    for (name, direction) in [("up", up), ("north", north)] {
        if direction.try_normalize().is_none() {
            let message = "a direction of length zero";
            problems.error(&Key::of(&[name]), message).hint("for example [0, 0, 1]");
            return;
        }
    }
    if Frame::from_axis_and_x(DVec3::ZERO, up, north).is_none() {
        // `north` may be omitted in the file.
        let name = if scene.places.has(&Key::of(&["north"])) { "north" } else { "up" };
        problems
            .error(&Key::of(&[name]), "`up` and `north` are parallel")
            .hint("give `north` a level direction");
    }
}
