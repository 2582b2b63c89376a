//! Keys that the schema does not know, and what was probably meant.

use crate::keys::KeySegment;
use crate::problems::{name_hint, nearest};
use crate::schema;
use crate::validate::{At, Entries, Walk, wording};

/// Suffixes of other units that a user may have written.
const FOREIGN_UNITS: [&str; 36] = [
    "mm", "cm", "dm", "m", "um", "nm", "in", "inch", "inches", "ft", "mm2", "m2", "deg", "degree",
    "degrees", "rad", "radians", "mrad", "lm", "lumen", "w", "mw", "watt", "cd", "mcd", "nits",
    "nit", "cd_m2", "per_mm", "per_cm", "per_m", "s", "sec", "ms", "min", "h",
];

/// The amount of light that only one kind of source takes, and that kind.
const CANDELA: &str = "intensity_cd";
const POINT: &str = "point";

impl Walk<'_> {
    /// Notes a key that is not among the known ones of the table at `table`.
    pub(crate) fn unknown_key(
        &mut self,
        known: Vec<&str>,
        table: &At<'_>,
        at: &At<'_>,
        name: &str,
    ) {
        let hint = self.key_hint(&known, table, name);
        let problem = self.problems.error(&at.to_key(), "unknown key").hint(hint);
        if let Some(origin) = at.key {
            problem.at(origin);
        }
    }

    fn key_hint(&self, known: &[&str], table: &At<'_>, name: &str) -> String {
        if let Some(right) = other_unit(name, known.iter().copied()) {
            let key = table.to_key();
            if right == CANDELA
                && let Some(KeySegment::Field(kind)) = key.segments().last()
                && kind != POINT
            {
                return format!(
                    "candela are for a `{POINT}`: a `{kind}` takes `flux_lm`, or `luminance_cd_m2` if it has an area"
                );
            }
            let unit = schema::unit(right).map(|unit| format!(", in {unit}")).unwrap_or_default();
            return format!("the key is `{right}`{unit}");
        }
        let other_form = table.forms.iter().find(|form| form["properties"].get(name).is_some());
        if let Some(marker) = other_form.and_then(|form| schema::marker(form, table.forms)) {
            return format!("`{name}` is used with `{marker}`");
        }
        if table.outer.is_some_and(|outer| outer.contains_key(name))
            && nearest(name, known.iter().copied()).is_none()
        {
            let around =
                table.around.map(|(around, _)| around.to_key().to_string()).unwrap_or_default();
            let around = if around.is_empty() {
                "at the top of the file".into()
            } else {
                format!("in `{around}`")
            };
            return format!("`{name}` belongs one level up, {around}");
        }
        if known.is_empty() {
            return "this table takes no keys".into();
        }
        name_hint(name, known.iter().copied())
    }

    /// Notes a word that is not among the expected ones.
    pub(crate) fn unknown_word(&self, word: &str, words: &[&str], kinds: &[&str]) -> String {
        if kinds.contains(&word) {
            return format!("write it as a table: {{ {word} = ... }}");
        }
        match nearest(word, words.iter().copied()) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => format!("known words: {}", wording::list(words.iter().copied())),
        }
    }
}

/// The known key that is the same except for its unit: `radius_mm` for `radius_cm` or `radius`.
fn other_unit<'a>(name: &str, mut known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let stem = stem(name);
    known.find(|candidate| {
        schema::unit(candidate).is_some() && self::stem(candidate) == stem && *candidate != name
    })
}

fn stem(key: &str) -> &str {
    let ending = |unit: &&str| key.strip_suffix(*unit)?.strip_suffix('_');
    FOREIGN_UNITS.iter().filter_map(ending).min_by_key(|stem| stem.len()).unwrap_or(key)
}

/// The known key that was most likely meant by an unknown one.
fn meant<'a>(name: &str, known: impl Iterator<Item = &'a str> + Clone) -> Option<&'a str> {
    other_unit(name, known.clone()).or_else(|| nearest(name, known))
}

/// Whether a key is missing only because it is misspelt, which is reported at its place.
pub(crate) fn is_misspelt<'a>(
    missing: &str,
    entries: &Entries,
    known: impl Iterator<Item = &'a str> + Clone,
) -> bool {
    let is_unknown = |name: &&String| !known.clone().any(|known| known == *name);
    entries.keys().filter(is_unknown).any(|name| meant(name, known.clone()) == Some(missing))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_in_another_unit_leads_to_the_right_one() {
        let known = ["radius_mm", "bend_deg", "absorption_per_mm", "luminance_cd_m2", "sides"];
        for (name, right) in [
            ("radius_cm", "radius_mm"),
            ("radius", "radius_mm"),
            ("bend_rad", "bend_deg"),
            ("absorption_per_m", "absorption_per_mm"),
            ("absorption_mm", "absorption_per_mm"),
            ("luminance_nits", "luminance_cd_m2"),
        ] {
            assert_eq!(other_unit(name, known.into_iter()), Some(right), "{name}");
        }
        assert_eq!(other_unit("side", known.into_iter()), None);
    }
}
