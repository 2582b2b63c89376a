//! Where the sun stands, and which way is up.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::spec::daylight::{SkyModelSpec, SunPlaceSpec, WhenSpec};
use glam::DVec3;
use lumiduct_core::optics::sun::{Date, Misread, Observation, read_time, sun_position};
use lumiduct_core::scene::SunAngles;

/// Default azimuth of a sun, deg: south.
pub(super) const SOUTH_DEG: f64 = 180.0;

/// A position of the sun above the horizon.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sun {
    /// rad
    pub(super) elevation: f64,
    /// From north, clockwise, rad.
    pub(super) azimuth: f64,
    /// Toward the sun, unit vector in the frame with x east, y north, z up.
    pub(super) toward: DVec3,
}

impl Sun {
    pub(super) fn angles(&self) -> SunAngles {
        SunAngles { elevation: self.elevation, azimuth: self.azimuth }
    }

    pub(super) fn new(elevation_deg: f64, azimuth_deg: f64) -> Self {
        let (elevation, azimuth) = (elevation_deg.to_radians(), azimuth_deg.to_radians());
        let level = elevation.cos() * DVec3::new(azimuth.sin(), azimuth.cos(), 0.0);
        Self { elevation, azimuth, toward: level.with_z(elevation.sin()) }
    }
}

impl Context<'_> {
    /// Notes directions of `up` and `north` that make no frame.
    pub(super) fn check_directions_of_sky(&mut self) {
        for (name, direction) in [("up", self.spec.up), ("north", self.spec.north)] {
            if DVec3::from(direction).try_normalize().is_none() {
                let message = "a direction of length zero";
                self.problems.error(&Key::of(&[name]), message).hint("for example [0, 0, 1]");
                return;
            }
        }
        if self.sky_frame().is_none() {
            // `north` may be omitted in the file.
            let name = if self.places.has(&Key::of(&["north"])) { "north" } else { "up" };
            self.problems
                .error(&Key::of(&[name]), "`up` and `north` are parallel")
                .hint("give `north` a level direction");
        }
    }

    /// Notes a sky without the sun that it needs, with one that it does not have, or with two.
    pub(super) fn check_need(&mut self, model: SkyModelSpec, place: &SunPlaceSpec, key: &Key) {
        let SunPlaceSpec { elevation_deg, azimuth_deg, when } = place;
        let given = [
            ("elevation_deg", elevation_deg.is_some()),
            ("when", when.is_some()),
            ("azimuth_deg", azimuth_deg.is_some()),
        ];
        let is_placed = elevation_deg.is_some() || when.is_some();
        if needs_sun(model) && !is_placed {
            let message = "is brighter near the sun, but the position of the sun is not given";
            let hint = "give `elevation_deg` and `azimuth_deg`, or `when`";
            self.problems.error(&key.field("model"), message).hint(hint);
        }
        if elevation_deg.is_some() && when.is_some() {
            let hint = "give `when`, or `elevation_deg` and `azimuth_deg`";
            self.problems
                .error(&key.field("when"), "the sun has an `elevation_deg` already")
                .hint(hint);
        }
        if let Some((name, _)) = given.iter().find(|(_, given)| *given && !needs_sun(model)) {
            let message = "this sky does not depend on the position of the sun";
            let hint = "remove it; the sun's disk is a source of its own, `sun`";
            self.problems.error(&key.field(name), message).hint(hint);
        }
    }

    /// The position of the sun; an error if below the horizon.
    pub(super) fn sun(&mut self, place: &SunPlaceSpec, key: &Key) -> Option<Sun> {
        let Some(when) = &place.when else {
            return Some(Sun::new(place.elevation_deg?, place.azimuth_deg.unwrap_or(SOUTH_DEG)));
        };
        if place.azimuth_deg.is_some() {
            self.problems
                .error(&key.field("azimuth_deg"), "the azimuth follows from `when`")
                .hint("remove it");
        }
        let key = key.field("when");
        let WhenSpec { date, time, utc_offset_h, latitude_deg, longitude_deg } = when;
        let mut read = |name: &str, text: &str, misread: Misread, form: &str| {
            let message = format!("`{}` {misread}", text.escape_debug());
            self.problems.error(&key.field(name), message).hint(form);
        };
        let form = "write it as \"2026-06-21\": year, month, day";
        let day = Date::read(date).map_err(|misread| read("date", date, misread, form)).ok();
        let form = "write it as \"14:30\" or \"14:30:15\"";
        let hours = read_time(time).map_err(|misread| read("time", time, misread, form)).ok();
        self.may_build(&key)?;
        let days = day?.days() + (hours? - utc_offset_h) / 24.0;
        let (latitude_deg, longitude_deg) = (*latitude_deg, *longitude_deg);
        let position = sun_position(Observation { days, latitude_deg, longitude_deg });
        if position.elevation_deg <= 0.0 {
            let elevation = position.elevation_deg;
            let message = format!(
                "the sun is below the horizon at this time and place, at {elevation:.1} deg"
            );
            let hint =
                "check `utc_offset_h`, and the signs of latitude (north +) and longitude (east +)";
            return self.refuse(&key, message, hint);
        }
        Some(Sun::new(position.elevation_deg, position.azimuth_deg))
    }
}

/// Whether a sky is brighter about the sun.
fn needs_sun(model: SkyModelSpec) -> bool {
    match model {
        SkyModelSpec::Uniform | SkyModelSpec::Overcast | SkyModelSpec::CieType(1 | 3 | 5) => false,
        SkyModelSpec::Clear | SkyModelSpec::CieType(_) => true,
    }
}
