//! Which light of a sensor is measured: all of it, or that of a light group.

#[cfg(test)]
mod tests;

use crate::scene::{LightGroupId, Scene, SensorId};
use crate::transport::Layout;

/// What precedes the name of a source or light group in the name of a measure.
const FROM: &str = ".from.";

/// Which light is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LightSelection {
    /// That of all sources.
    All,
    /// That of the sources of a light group.
    Group(LightGroupId),
}

impl LightSelection {
    /// All light, then the light of every group.
    pub(crate) fn each(scene: &Scene) -> impl Iterator<Item = Self> + use<> {
        std::iter::once(Self::All).chain(scene.light.ids().map(Self::Group))
    }

    /// The light of a measure, by its name.
    pub(crate) fn of_measure(scene: &Scene, name: &str) -> Self {
        let named = |own: &Self| {
            let end = own.suffix(scene);
            !end.is_empty() && name.ends_with(&end)
        };
        Self::each(scene).find(named).unwrap_or(Self::All)
    }

    /// Name of the group; `None` for all light.
    pub(crate) fn name(self, scene: &Scene) -> Option<&str> {
        match self {
            Self::All => None,
            Self::Group(id) => Some(&scene.light.group(id).name),
        }
    }

    /// The end of the names of its measures: `.from.GROUP`, or nothing.
    pub(crate) fn suffix(self, scene: &Scene) -> String {
        self.name(scene).map_or(String::new(), |name| format!("{FROM}{name}"))
    }

    /// The scalars that make up its flux on a sensor.
    pub(crate) fn flux_slots(self, scene: &Scene, layout: &Layout, id: SensorId) -> Vec<usize> {
        match self {
            Self::All => layout.flux_slots(id),
            Self::Group(group) => {
                let sources = scene.light.group(group).sources.iter();
                sources.map(|&source| layout.sensor_flux(id, source)).collect()
            }
        }
    }

    /// Whether it is the light of a group that emits nothing: its zeros are exact, and no path is
    /// needed to know them.
    pub(crate) fn is_dark(self, scene: &Scene) -> bool {
        match self {
            Self::All => false,
            Self::Group(id) => scene.flux_of(&scene.light.group(id).sources) == 0.0,
        }
    }

    /// Number of weathers whose light it sums; the daylight of a group is of one weather.
    pub(crate) fn weathers(self, scene: &Scene) -> usize {
        let all = scene.light.weathers().len();
        match self {
            Self::All => all,
            Self::Group(_) => all.min(1),
        }
    }
}
