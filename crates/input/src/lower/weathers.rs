//! Weathers: which sources of daylight shine together, and which never do.
//!
//! A sun and its skies are one weather; another position of the sun is another weather, and so is
//! an overcast sky. Does not know how a weather is named.

use crate::keys::Key;
use crate::spec::daylight::{SkyModelSpec, SkySpec};
use glam::DVec3;
use lumiduct_core::scene::SourceId;

/// Suns whose unit vectors are closer than this are one sun: below a second of arc.
const SAME_SUN: f64 = 1e-6;

/// A daylight source by the light it shines together with.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Daylight {
    /// The sun's disk, toward this unit vector.
    Sun(DVec3),
    /// A sky.
    Sky {
        /// Toward the sun, for a sky that is brighter around it.
        sun: Option<DVec3>,
        model: SkyModelSpec,
        /// Zenith luminance and horizontal illuminance; exactly one of them is given.
        amount: [Option<f64>; 2],
    },
}

impl Daylight {
    pub(super) fn of_sky(spec: &SkySpec, sun: Option<DVec3>) -> Self {
        let model = match spec.model {
            SkyModelSpec::Uniform => SkyModelSpec::CieType(5),
            SkyModelSpec::Clear => SkyModelSpec::CieType(12),
            other @ (SkyModelSpec::Overcast | SkyModelSpec::CieType(_)) => other,
        };
        let amount = [spec.zenith_luminance_cd_m2, spec.horizontal_illuminance_lx];
        Self::Sky { sun, model, amount }
    }

    fn sun(&self) -> Option<DVec3> {
        match self {
            Self::Sun(sun) => Some(*sun),
            Self::Sky { sun, .. } => *sun,
        }
    }

    fn has_sun_of(&self, other: &Self) -> bool {
        self.sun().zip(other.sun()).is_some_and(|(a, b)| a.distance(b) < SAME_SUN)
    }

    /// Whether two of a kind shine in the same weather.
    fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Sun(_), Self::Sun(_)) => self.has_sun_of(other),
            (
                Self::Sky { model, amount, sun },
                Self::Sky { model: other_model, amount: other_amount, .. },
            ) => {
                let same_sun = sun.is_none() || self.has_sun_of(other);
                model == other_model && amount == other_amount && same_sun
            }
            (Self::Sun(_), Self::Sky { .. }) | (Self::Sky { .. }, Self::Sun(_)) => false,
        }
    }
}

/// What determines the light group of a source.
#[derive(Debug)]
pub(super) struct Member {
    pub(super) source: SourceId,
    /// The key `group`, with its place.
    pub(super) group: Option<(String, Key)>,
    pub(super) daylight: Option<Daylight>,
}

/// The light group of a source with its key.
pub(super) fn group(name: Option<&String>, source: &Key) -> Option<(String, Key)> {
    name.cloned().map(|name| (name, source.field("group")))
}

/// Daylight sources by their weather; those of one group in the scene file are one weather.
pub(super) fn weathers(members: &[Member]) -> Vec<Vec<&Member>> {
    let daylight = |member: &Member| member.daylight.clone();
    let mut skies: Vec<Vec<&Member>> = Vec::new();
    let mut suns: Vec<Vec<&Member>> = Vec::new();
    for member in members {
        let own = match daylight(member) {
            Some(Daylight::Sun(_)) => &mut suns,
            Some(Daylight::Sky { .. }) => &mut skies,
            None => continue,
        };
        let is_like = |weather: &&mut Vec<&Member>| {
            daylight(weather[0]).zip(daylight(member)).is_some_and(|(a, b)| a.is_like(&b))
        };
        match own.iter_mut().find(is_like) {
            Some(weather) => weather.push(member),
            None => own.push(vec![member]),
        }
    }
    let mut weathers = skies;
    for sun in suns {
        let has_sun = |weather: &&mut Vec<&Member>| {
            daylight(weather[0])
                .zip(daylight(sun[0]))
                .is_some_and(|(sky, sun)| sky.has_sun_of(&sun))
        };
        let mut about = weathers.iter_mut().filter(has_sun);
        match (about.next(), about.next()) {
            (Some(sky), None) => sky.extend(sun),
            // Two skies with one sun are two weathers, and it is undefined to which the sun
            // belongs.
            (None, _) | (Some(_), Some(_)) => weathers.push(sun),
        }
    }
    let mut joined: Vec<Vec<&Member>> = Vec::new();
    for weather in weathers {
        let shares = |other: &Vec<&Member>| {
            other.iter().any(|a| {
                weather.iter().any(|b| a.group_name().is_some() && a.group_name() == b.group_name())
            })
        };
        let (same, mut others): (Vec<_>, Vec<_>) = joined.into_iter().partition(shares);
        let mut all: Vec<&Member> = same.into_iter().flatten().chain(weather).collect();
        all.sort_by_key(|member| member.source.index());
        others.push(all);
        joined = others;
    }
    joined.sort_by_key(|weather| weather[0].source.index());
    joined
}

impl Member {
    fn group_name(&self) -> Option<&str> {
        self.group.as_ref().map(|(name, _)| name.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sun(degrees: f64) -> DVec3 {
        DVec3::new(degrees.to_radians().cos(), 0.0, degrees.to_radians().sin())
    }

    fn sky(sun: Option<DVec3>, model: SkyModelSpec) -> Daylight {
        Daylight::Sky { sun, model, amount: [None, Some(1e4)] }
    }

    fn of(daylight: Vec<(Option<&str>, Option<Daylight>)>) -> Vec<Vec<usize>> {
        let members: Vec<Member> = daylight
            .into_iter()
            .enumerate()
            .map(|(index, (group, daylight))| Member {
                source: SourceId::new(index),
                group: group.map(|name| (name.to_owned(), Key::root())),
                daylight,
            })
            .collect();
        let indices = |weather: &Vec<&Member>| weather.iter().map(|m| m.source.index()).collect();
        weathers(&members).iter().map(indices).collect()
    }

    #[test]
    fn a_sun_and_the_sky_about_it_are_one_weather_and_an_overcast_sky_is_another() {
        let clear = SkyModelSpec::CieType(12);
        let found = of(vec![
            (None, Some(sky(None, SkyModelSpec::Overcast))),
            (None, Some(sky(Some(sun(50.0)), clear))),
            (None, None),
            (None, Some(Daylight::Sun(sun(50.0)))),
            (None, Some(Daylight::Sun(sun(20.0)))),
            (None, Some(sky(None, SkyModelSpec::Overcast))),
        ]);
        assert_eq!(found, [vec![0, 5], vec![1, 3], vec![4]]);
    }

    #[test]
    fn daylight_of_one_group_is_one_weather_whatever_it_is() {
        let found = of(vec![
            (Some("haze"), Some(sky(None, SkyModelSpec::CieType(5)))),
            (Some("haze"), Some(Daylight::Sun(sun(20.0)))),
            (None, Some(sky(None, SkyModelSpec::Overcast))),
        ]);
        assert_eq!(found, [vec![0, 1], vec![2]]);
    }

    #[test]
    fn a_sun_under_two_skies_belongs_to_neither() {
        let found = of(vec![
            (None, Some(sky(Some(sun(50.0)), SkyModelSpec::CieType(12)))),
            (None, Some(sky(Some(sun(50.0)), SkyModelSpec::CieType(9)))),
            (None, Some(Daylight::Sun(sun(50.0)))),
        ]);
        assert_eq!(found, [[0], [1], [2]]);
    }
}
