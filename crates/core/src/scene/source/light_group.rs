//! Light groups: sources whose light is also measured together.

use crate::scene::{LightGroupId, SourceId};

/// Sources that are measured together, in addition to each one separately.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LightGroup {
    /// Name, which no source has.
    pub name: String,
    /// Its sources, ascending.
    pub sources: Vec<SourceId>,
}

/// The light groups of a scene, and the weathers that its daylight belongs to.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LightGroups {
    groups: Vec<LightGroup>,
    weathers: Vec<String>,
    /// Groups of each source, ascending; nothing for sources after the last one with a group.
    of_sources: Vec<Vec<LightGroupId>>,
}

impl LightGroups {
    /// The groups of the scene file, then those of different weathers; and the names of the
    /// weathers that shine, no two of which shine at the same time.
    pub fn new(groups: Vec<LightGroup>, weathers: Vec<String>) -> Self {
        let mut of_sources: Vec<Vec<LightGroupId>> = Vec::new();
        for (index, group) in groups.iter().enumerate() {
            for source in &group.sources {
                let known = of_sources.len().max(source.index() + 1);
                of_sources.resize_with(known, Vec::new);
                of_sources[source.index()].push(LightGroupId::new(index));
            }
        }
        Self { groups, weathers, of_sources }
    }

    /// All groups.
    pub(crate) fn groups(&self) -> &[LightGroup] {
        &self.groups
    }

    /// A group.
    pub(crate) fn group(&self, id: LightGroupId) -> &LightGroup {
        &self.groups[id.index()]
    }

    /// The ids of all groups.
    pub(crate) fn ids(&self) -> impl Iterator<Item = LightGroupId> + use<> {
        (0..self.groups.len()).map(LightGroupId::new)
    }

    /// Names of the weathers that shine; no two of them shine at the same time.
    pub(crate) fn weathers(&self) -> &[String] {
        &self.weathers
    }

    /// The groups of a source; most have none.
    #[inline]
    pub(crate) fn of(&self, source: SourceId) -> &[LightGroupId] {
        self.of_sources.get(source.index()).map_or(&[], Vec::as_slice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_source_knows_all_of_its_groups() {
        let group = |name: &str, sources: &[usize]| LightGroup {
            name: name.into(),
            sources: sources.iter().map(|&source| SourceId::new(source)).collect(),
        };
        let light = LightGroups::new(vec![group("a", &[1, 3]), group("b", &[3])], Vec::new());
        let of = |source| light.of(SourceId::new(source)).iter().map(|id| id.index());
        let found: Vec<Vec<usize>> = (0..5).map(|source| of(source).collect()).collect();
        assert_eq!(found, [vec![], vec![0], vec![], vec![0, 1], vec![]]);
        assert_eq!(light.group(LightGroupId::new(1)).name, "b");
    }
}
