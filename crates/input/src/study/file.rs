//! A study file as it is read, before its scene is known.

use crate::keys::{Key, Places};
use crate::problems::Problems;
use crate::spec::study::{PlanSpec, STUDY_FORMAT_VERSION, StudySpec};
use crate::texts::{TextId, Texts};
use crate::tree::{self, Node, Value};
use crate::{convert, note_breaks, note_differences, schema, unreadable};
use lumiduct_base::error::{Error, Result};
use std::path::{Path, PathBuf};

/// A study file that was read, with the problems found so far.
pub(super) struct StudyDraft {
    pub(super) spec: StudySpec,
    pub(super) places: Places,
    /// The table of designs.
    pub(super) table: Option<TextId>,
    pub(super) problems: Problems,
}

/// Reads a study file and the table it refers to.
pub(super) fn read(path: &Path) -> Result<StudyDraft> {
    let (mut sources, mut problems) = (Texts::default(), Problems::default());
    let source = sources.add_file(path).map_err(|reason| unreadable(path, &reason.to_string()))?;
    let (root, breaks) = tree::parse(&sources, source);
    if is_other_kind(&root, &mut problems) {
        return Err(Error::Input(problems.into_diagnostics(&Places::new(root, sources))));
    }
    note_differences(&root, &schema::study_schema(), &sources, &breaks, &mut problems);
    note_breaks(&breaks, &mut problems);
    let spec = convert::study(&root, &mut problems);
    let table = spec.as_ref().and_then(|spec| table_file(spec, path));
    let table = table.and_then(|file| match sources.add_file(&file) {
        Ok(source) => Some(source),
        Err(reason) => {
            let message = format!("{}: {reason}", file.display());
            problems.error(&Key::of(&["plan", "list", "file"]), message);
            None
        }
    });
    let places = Places::new(root, sources);
    match spec {
        Some(spec) => Ok(StudyDraft { spec, places, table, problems }),
        None => Err(Error::Input(problems.into_diagnostics(&places))),
    }
}

/// The file with the designs of a study.
fn table_file(spec: &StudySpec, study: &Path) -> Option<PathBuf> {
    match &spec.plan {
        PlanSpec::List(own) => Some(study.parent().unwrap_or(Path::new("")).join(&own.file)),
        PlanSpec::Grid
        | PlanSpec::OneAtATime
        | PlanSpec::LatinHypercube(_)
        | PlanSpec::Sobol(_)
        | PlanSpec::Tolerance(_) => None,
    }
}

/// Whether a file is not a study of this version, so that this schema does not apply.
fn is_other_kind(root: &Node, problems: &mut Problems) -> bool {
    match (root.get("lumiduct_study"), root.get("lumiduct")) {
        (Some(Node { value: Value::Integer(version), origin }), _)
            if *version != i64::from(STUDY_FORMAT_VERSION) =>
        {
            let message =
                format!("format version {version} is not known, expected {STUDY_FORMAT_VERSION}");
            problems.error(&Key::of(&["lumiduct_study"]), message).at(origin);
            true
        }
        (None, Some(node)) => {
            problems
                .error(&Key::of(&["lumiduct"]), "this is a scene, not a study")
                .hint("trace it with `lumiduct run`")
                .at(&node.origin);
            true
        }
        (Some(_), _) | (None, None) => false,
    }
}
