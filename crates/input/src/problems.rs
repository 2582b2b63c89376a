//! The problems of a scene, collected so that all are reported together.

use crate::keys::{Key, Places};
use crate::texts::{Origin, Texts};
use lumiduct_base::error::{Diagnostic, DiagnosticKind, Error, Result};

/// Most problems that are reported; a file with more is entirely wrong.
pub(crate) const MAX_PROBLEMS: usize = 1000;

/// All problems found so far.
#[derive(Debug, Default)]
pub struct Problems {
    list: Vec<Problem>,
    /// The last one beyond the limit.
    spare: Option<Problem>,
    left_out: usize,
    errors: usize,
    /// Wrong keys from before rules were checked, and the tables of entries that have them.
    wrong: Vec<Key>,
    doubtful: Vec<Key>,
    /// The last one that was dropped as an echo.
    dropped: Option<Problem>,
}

/// One thing that is wrong or odd.
#[derive(Debug)]
pub struct Problem {
    kind: DiagnosticKind,
    key: Key,
    /// The place, if it is not that of the key's value.
    origin: Option<Origin>,
    message: String,
    hint: Option<String>,
}

impl Problem {
    fn new(kind: DiagnosticKind, key: &Key, message: String) -> Self {
        Self { kind, key: key.clone(), origin: None, message, hint: None }
    }

    /// The key it refers to.
    pub(crate) fn key(&self) -> &Key {
        &self.key
    }

    /// The place, where it is not that of the key's value.
    pub(crate) fn origin(&self) -> Option<&Origin> {
        self.origin.as_ref()
    }

    /// What to do about it.
    pub fn hint(&mut self, hint: impl Into<String>) -> &mut Self {
        self.hint = Some(hint.into());
        self
    }

    /// The place, where it is not that of the key's value.
    pub fn at(&mut self, origin: &Origin) -> &mut Self {
        self.origin = Some(origin.clone());
        self
    }
}

impl Problems {
    /// Notes an error at a key.
    pub fn error(&mut self, key: &Key, message: impl Into<String>) -> &mut Problem {
        self.push(Problem::new(DiagnosticKind::Error, key, message.into()))
    }

    /// Notes an error that holds whatever becomes of the other keys of its table.
    pub(crate) fn certain_error(&mut self, key: &Key, message: impl Into<String>) -> &mut Problem {
        self.keep(Problem::new(DiagnosticKind::Error, key, message.into()))
    }

    /// Notes a warning at a key.
    pub fn warning(&mut self, key: &Key, message: impl Into<String>) -> &mut Problem {
        self.push(Problem::new(DiagnosticKind::Warning, key, message.into()))
    }

    fn push(&mut self, problem: Problem) -> &mut Problem {
        let is_echo = |table: &Key| *table == problem.key || *table == problem.key.parent();
        if self.doubtful.iter().any(is_echo) {
            return self.dropped.insert(problem);
        }
        self.keep(problem)
    }

    fn keep(&mut self, problem: Problem) -> &mut Problem {
        self.errors += usize::from(problem.kind == DiagnosticKind::Error);
        if self.list.len() >= MAX_PROBLEMS {
            self.left_out += 1;
            return self.spare.insert(problem);
        }
        self.list.push(problem);
        let last = self.list.len() - 1;
        &mut self.list[last]
    }

    /// The keys of the errors, in the order in which they were noted.
    pub(crate) fn error_keys(&self) -> impl Iterator<Item = &Key> {
        let errors = self.list.iter().filter(|problem| problem.kind == DiagnosticKind::Error);
        errors.map(Problem::key)
    }

    /// From here on, rules are checked that span several keys. What is noted of a table of an entry
    /// that has a wrong key, or of another key in it, is dropped: it may hold once that one is
    /// corrected.
    pub(crate) fn expect_echoes(&mut self) {
        self.wrong = self.error_keys().cloned().collect();
        let tables = self.wrong.iter().map(Key::parent);
        self.doubtful = tables.filter(|table| table.segments().len() > 1).collect();
    }

    /// Whether no key at `key` or inside it was wrong before rules were checked.
    pub(crate) fn is_whole(&self, key: &Key) -> bool {
        self.left_out == 0 && !self.wrong.iter().any(|wrong| wrong.is_within(key))
    }

    /// Whether nothing is wrong so far.
    pub fn is_free_of_errors(&self) -> bool {
        self.errors == 0
    }

    /// Adds problems found elsewhere, except echoes of known ones.
    pub(crate) fn append(&mut self, other: Self, is_echo: impl Fn(&Problem) -> bool) {
        for problem in other.list.into_iter().chain(other.spare) {
            if !is_echo(&problem) {
                self.push(problem);
            }
        }
        self.left_out += other.left_out.saturating_sub(1);
    }

    /// The warnings, in the order of the files.
    ///
    /// # Errors
    ///
    /// [`Error::Input`] if there is an error: errors and warnings, in the same order.
    pub fn finish(self, places: &Places) -> Result<Vec<Diagnostic>> {
        let has_error = self.errors > 0;
        let diagnostics = self.into_diagnostics(places);
        if has_error { Err(Error::Input(diagnostics)) } else { Ok(diagnostics) }
    }

    /// Everything in the order of the files.
    pub(crate) fn into_diagnostics(self, places: &Places) -> Vec<Diagnostic> {
        let place = |problem: &Problem| {
            problem.origin.clone().or_else(|| places.value(&problem.key).cloned())
        };
        let mut placed: Vec<_> =
            self.list.into_iter().map(|problem| (place(&problem), problem)).collect();
        placed.sort_by_key(|(origin, _)| origin.as_ref().map(|o| (o.source, o.span.start)));
        let mut diagnostics: Vec<_> = placed
            .into_iter()
            .map(|(origin, problem)| diagnostic(problem, origin, places.sources()))
            .collect();
        if self.left_out > 0 {
            diagnostics.push(Diagnostic {
                kind: DiagnosticKind::Error,
                file: None,
                line: None,
                span: None,
                key: String::new(),
                message: format!(
                    "only the first {MAX_PROBLEMS} problems are shown, {} more follow",
                    self.left_out
                ),
                hint: None,
            });
        }
        diagnostics
    }
}

fn diagnostic(problem: Problem, origin: Option<Origin>, sources: &Texts) -> Diagnostic {
    let source = origin.as_ref().map(|origin| sources.get(origin.source));
    let line =
        source.zip(origin.as_ref()).and_then(|(source, origin)| source.line(origin.span.start));
    Diagnostic {
        kind: problem.kind,
        file: source.map(|source| source.label()),
        line,
        span: origin.map(|origin| origin.span),
        key: problem.key.to_string(),
        message: problem.message,
        hint: problem.hint,
    }
}

/// The known name that a user most likely meant; `None` if none is close.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = name.to_lowercase();
    let rate = |candidate: &str| {
        let distance = strsim::damerau_levenshtein(&name, candidate);
        let longest = name.chars().count().max(candidate.chars().count());
        // A third of the letters may be wrong; a long common beginning excuses a wrong end (reflectivity, reflectance).
        let is_close = distance <= (longest / 3).max(1) && distance < longest;
        let begins_alike = longest > 6 && strsim::jaro_winkler(&name, candidate) > 0.8;
        (is_close || begins_alike).then_some(distance)
    };
    // The cost grows with the product of the lengths; none of our names is this long.
    if name.chars().count() > 100 {
        return None;
    }
    let rated = known.into_iter().filter(|candidate| candidate.len() <= 400);
    rated
        .filter_map(|candidate| Some((rate(candidate)?, candidate)))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, c)| c)
}

/// The hint for an unknown name: the closest one, or all.
pub fn name_hint<'a>(name: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> String {
    if let Some(near) = nearest(name, known.clone()) {
        return format!("did you mean `{near}`?");
    }
    let known: Vec<_> = known.into_iter().collect();
    let shown = known.iter().take(MAX_NAMES).copied().collect::<Vec<_>>().join(", ");
    match known.len() {
        0 => "there are none".into(),
        count if count > MAX_NAMES => {
            format!("known names: {shown}, and {} more", count - MAX_NAMES)
        }
        _ => format!("known names: {shown}"),
    }
}

/// The hint for an unknown face: the closest name, and all faces.
pub(crate) fn face_hint<'a>(
    name: &str,
    known: impl IntoIterator<Item = &'a str> + Clone,
) -> String {
    let list = name_hint("", known.clone()).replacen("known names", "faces", 1);
    match nearest(name, known) {
        Some(near) => format!("did you mean `{near}`? {list}"),
        None => list,
    }
}

/// Most names that a hint lists.
const MAX_NAMES: usize = 12;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_found_through_slips_and_synonyms() {
        let known = ["radius_mm", "length_mm", "reflectance", "sweep", "at"];
        for (slip, meant) in
            [("raduis_mm", "radius_mm"), ("Sweep", "sweep"), ("reflectivity", "reflectance")]
        {
            assert_eq!(nearest(slip, known), Some(meant));
        }
        assert_eq!(nearest("colour", known), None);
        assert_eq!(nearest(&"a".repeat(1_000_000), known), None);
    }

    #[test]
    fn a_flood_of_problems_is_cut_and_counted() {
        let mut problems = Problems::default();
        for i in 0..MAX_PROBLEMS + 500 {
            problems.error(&Key::root().index(i), "wrong");
        }
        let node = crate::tree::Node {
            origin: Origin { source: Texts::default().add_argument(""), span: 0..0 },
            value: crate::tree::Value::Datetime,
        };
        let diagnostics = problems.into_diagnostics(&Places::new(node, Texts::default()));
        assert_eq!(diagnostics.len(), MAX_PROBLEMS + 1);
        assert!(diagnostics[MAX_PROBLEMS].message.contains("500 more"));
    }
}
