//! From a scene file to validated, typed specs.
//!
//! The file becomes a tree that knows its places. The tree is validated against the schema and
//! becomes a `SceneSpec`, which one pass checks and lowers, topic by topic. Every problem is noted
//! on the way and all are returned together. This crate knows geometry and optics only as far as the
//! lowering of a spec needs them.
//!
//! A scene with a mistake, then the same with an override that mends it:
//!
//! ```
//! use lumiduct_input::{Settings, load};
//!
//! let scene = r#"
//! lumiduct = 1
//! title = "Disk"
//! [sources.led.disk]
//! radius_mm = 5
//! flux_lm = -1
//! [run]
//! paths = 1000
//! "#;
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("disk.toml");
//! std::fs::write(&path, scene)?;
//!
//! let error = load(&path, &Settings::default()).unwrap_err().to_string();
//! assert!(error.contains("disk.toml:6: `sources.led.disk.flux_lm`"), "{error}");
//! let mended = Settings { overrides: vec!["sources.led.disk.flux_lm=2.5".into()], ..Settings::default() };
//! assert_eq!(load(&path, &mended)?.scene.sources[0].flux, 2.5); // lm
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::collections::BTreeSet;
use std::path::Path;

use crate::keys::{Key, Places};
use crate::lower::Lowered;
use crate::lower::context::Scope;
use crate::problems::Problems;
use crate::spec::{FORMAT_VERSION, SceneSpec};
use crate::texts::Texts;
use crate::tree::{Node, SyntaxError, Value};
use crate::validate::Completeness;
use lumiduct_base::error::{Diagnostic, DiagnosticKind, Error, Result};
use lumiduct_files::mesh::no_scene;
use serde_json::Value as Json;

pub(crate) mod convert;
pub mod diagnostic;
pub mod editor_schema;
mod export;
mod gather;
pub(crate) mod include;
mod job;
pub mod keys;
pub mod library;
mod list;
mod lower;
mod outline;
pub(crate) mod overrides;
mod own_library;
pub mod problems;
mod project;
mod rewrite;
mod scatter;
pub mod schema;
pub(crate) mod spec;
mod study;
pub(crate) mod texts;
pub(crate) mod tree;
pub mod validate;

pub use export::{Exports, LuminaireExport, RayExport};
pub use job::{Job, Settings, load};
pub use list::list;
pub use outline::Outline;
pub use project::Project;
pub use rewrite::{Move, rewritten_scene};
pub use scatter::measured_sheet;
pub use spec::optimise::Vary;
pub use spec::study::{Best, Keep, Ranking, Samples, SearchPlan, Tolerance};
pub use study::{
    Cost, DESIGN_COLUMN, Domain, LATEST_PER_RANGE, LawKind, LightTarget, OTHER_COLUMNS,
    Optimisation, OptimisationKind, Parameter, PatternFeedback, Plan, Setting, Study,
    StudySettings, Tie, column, load_optimisation, load_study,
};

/// A scene that was read without errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The content of the files.
    pub spec: SceneSpec,
    /// Its places; also contains the texts of all files.
    pub places: Places,
    /// The scene file, byte for byte.
    pub text: String,
    /// Remarks that do not stop a run.
    pub warnings: Vec<Diagnostic>,
}

/// A scene with the problems found so far.
#[derive(Debug)]
pub(crate) struct Draft {
    /// The content of the files. A key with an error is left out, and so is an entry that is
    /// meaningless without it.
    pub spec: SceneSpec,
    /// Its places; also contains the texts of all files.
    pub places: Places,
    /// The scene file, byte for byte.
    pub text: String,
    /// The problems.
    pub problems: Problems,
    /// After a syntax error, names may seem missing that are only hidden.
    completeness: Completeness,
}

impl Draft {
    /// Checks the spec and lowers it as far as asked for.
    pub(crate) fn lower(&mut self, scope: Scope) -> Option<Lowered> {
        match self.completeness {
            Completeness::Whole => {
                lower::lower(&self.spec, &self.places, scope, &mut self.problems)
            }
            Completeness::Broken => None,
        }
    }
}

/// Reads a scene file and checks its keys and names. Each override is `key=value`, as after `-D` on the command line.
///
/// # Errors
///
/// [`Error::Input`] with all problems: the file, or a sensor file that it includes, cannot be read; the syntax is
/// broken; a key, a value or an override does not fit the schema; a name is not defined.
pub fn read(path: &Path, overrides: &[String]) -> Result<Loaded> {
    let mut draft = draft(path, overrides)?;
    draft.lower(Scope::Keys);
    let Draft { spec, places, text, problems, .. } = draft;
    let warnings = problems.finish(&places)?;
    Ok(Loaded { spec, places, text, warnings })
}

/// Reads a scene file as far as it fits the schema, so that further problems can be found in the valid part.
/// Fails only if there is nothing to continue with: the file cannot be read or is of another
/// format.
pub(crate) fn draft(path: &Path, overrides: &[String]) -> Result<Draft> {
    let mut sources = Texts::default();
    let mut problems = Problems::default();
    if let Some(why) = no_scene(path).filter(|_| path.is_file()) {
        return Err(unreadable(path, &why));
    }
    let scene = sources.add_file(path).map_err(|reason| unreadable(path, &reason.to_string()))?;
    let (mut root, mut breaks) = tree::parse(&sources, scene);
    let text = sources.get(scene).text().to_owned();

    let overrides = overrides::read(overrides, &mut sources, &mut problems);
    let (early, late): (Vec<_>, Vec<_>) = overrides.iter().partition(|one| one.names_a_file());
    early.into_iter().for_each(|one| overrides::apply(one, &mut root, &mut problems));
    breaks.extend(include::join_sensor_files(&mut root, &mut sources, &mut problems));
    let (library, errors) = own_library::join(&mut root, &mut sources, &mut problems);
    breaks.extend(errors);
    late.into_iter().for_each(|one| overrides::apply(one, &mut root, &mut problems));

    if is_other_kind(&root, &mut problems) {
        return Err(Error::Input(problems.into_diagnostics(&Places::new(root, sources))));
    }
    note_differences(&root, &schema::json_schema(), &sources, &breaks, &mut problems);
    note_breaks(&breaks, &mut problems);
    let mut spec = convert::scene(&root, &mut problems);
    library.leave_out_unnamed(&root, &mut spec);
    let places = Places::new(root, sources);
    Ok(Draft { spec, places, text, problems, completeness: completeness(&breaks) })
}

fn unreadable(path: &Path, reason: &str) -> Error {
    Error::Input(vec![Diagnostic {
        kind: DiagnosticKind::Error,
        file: Some(path.to_path_buf()),
        line: None,
        span: None,
        key: String::new(),
        message: reason.into(),
        hint: None,
    }])
}

/// Whether the file is a study or of another version, so that this schema does not apply.
fn is_other_kind(root: &Node, problems: &mut Problems) -> bool {
    match root.get("lumiduct") {
        None if root.get("lumiduct_study").is_some() => {
            let command = if root.get("optimise").is_some() { "optimise" } else { "batch" };
            problems
                .error(&Key::of(&["lumiduct_study"]), "this is a study, not a scene")
                .hint(format!("run it with `lumiduct {command}`"));
            true
        }
        Some(Node { value: Value::Integer(version), origin })
            if *version != i64::from(FORMAT_VERSION) =>
        {
            let message =
                format!("format version {version} is not known, expected {FORMAT_VERSION}");
            problems.error(&Key::of(&["lumiduct"]), message).at(origin);
            true
        }
        Some(_) | None => false,
    }
}

fn note_breaks(breaks: &[SyntaxError], problems: &mut Problems) {
    for error in breaks {
        let key = if error.key.is_empty() { Key::root() } else { Key::of(&[&error.key]) };
        problems.error(&key, error.message.clone()).at(&error.origin);
    }
}

fn completeness(breaks: &[SyntaxError]) -> Completeness {
    if breaks.is_empty() { Completeness::Whole } else { Completeness::Broken }
}

/// Validates the tree against the schema, and drops problems in a line with a syntax error.
fn note_differences(
    root: &Node,
    schema: &Json,
    sources: &Texts,
    breaks: &[SyntaxError],
    problems: &mut Problems,
) {
    let mut found = Problems::default();
    validate::validate(root, schema, sources, completeness(breaks), &mut found);
    let line = |origin: &texts::Origin| {
        (origin.source, sources.get(origin.source).line(origin.span.start))
    };
    let broken: BTreeSet<_> = breaks.iter().map(|error| line(&error.origin)).collect();
    problems.append(found, |problem| {
        problem.origin().is_some_and(|origin| broken.contains(&line(origin)))
    });
}
