//! Light groups: those of the scene file, and those of daylight that shines in one weather.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::names::check_name;
use crate::lower::weathers::{Member, weathers};
use indexmap::IndexMap;
use lumiduct_core::scene::{LightGroup, LightGroups, SourceId};

/// Most letters of the joined names of several sources; a longer name becomes the first and the
/// number of others.
const MOST_JOINED: usize = 64;

impl Context<'_> {
    /// Makes the light groups of all sources.
    pub(super) fn lower_light_groups(&mut self) {
        let members = std::mem::take(&mut self.members);
        self.check_group_names(&members);
        let mut groups: IndexMap<String, Vec<SourceId>> = IndexMap::new();
        for member in &members {
            if let Some((name, _)) = &member.group {
                groups.entry(name.clone()).or_default().push(member.source);
            }
        }
        let weathers = weathers(&members);
        for weather in &weathers {
            let own: Vec<SourceId> =
                weather.iter().filter(|m| m.group.is_none()).map(|m| m.source).collect();
            let has_others = own.len() < members.len();
            if own.len() > 1 && has_others {
                let name = self.weather_name(weather);
                if self.is_taken(&name) || groups.contains_key(&name) {
                    self.note_taken(&name, own[0]);
                }
                groups.insert(name, own);
            }
        }
        let is_lit =
            |member: &&Member| self.builder.scene().sources[member.source.index()].is_lit();
        let lit = weathers.iter().filter(|weather| weather.iter().copied().any(|m| is_lit(&m)));
        let names = lit.map(|weather| self.weather_name(weather)).collect();
        let groups = groups.into_iter().map(|(name, sources)| LightGroup { name, sources });
        self.builder.set_light(LightGroups::new(groups.collect(), names));
    }

    /// Groups and sources share one name space, as measures distinguish them by name only.
    fn check_group_names(&mut self, members: &[Member]) {
        for member in members {
            let Some((name, key)) = &member.group else { continue };
            let is_wrong = check_name(name, key, self.problems).is_some();
            if !is_wrong && self.builder.scene().sources.iter().any(|source| source.name == *name) {
                let hint = "sources and light groups share their names: give the group another one";
                self.problems
                    .error(key, format!("`{name}` is already the name of a source"))
                    .hint(hint);
            }
        }
    }

    /// The groups of a weather's sources, or the names of its sources.
    fn weather_name(&self, weather: &[&Member]) -> String {
        let mut names: Vec<&str> = Vec::new();
        for member in weather {
            let source = &self.builder.scene().sources[member.source.index()].name;
            let name = member.group.as_ref().map_or(source.as_str(), |(group, _)| group);
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let joined = names.join("_and_");
        // A list of many sources is too long for the name of a column.
        match names.as_slice() {
            [first, others @ ..] if joined.len() > MOST_JOINED => {
                format!("{first}_and_{}_more", others.len())
            }
            _ => joined,
        }
    }

    fn note_taken(&mut self, name: &str, source: SourceId) {
        let source = &self.builder.scene().sources[source.index()].name;
        let message = format!(
            "belongs to a weather whose light group would be `{name}`, but that name is taken"
        );
        self.problems
            .error(&Key::of(&["sources", source]), message)
            .hint("give them a `group` with a name of your own");
    }
}
