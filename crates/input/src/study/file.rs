//! A study file as it is read, before its scene is known.

use crate::keys::{Key, Places};
use crate::problems::Problems;
use crate::spec::optimise::{LightTargetSpec, OptimisationSpec, OptimiseSpec};
use crate::spec::study::{PlanSpec, STUDY_FORMAT_VERSION, StudySpec};
use crate::texts::{TextId, Texts};
use crate::tree::{self, Node, Value};
use crate::{convert, note_breaks, note_differences, schema, unreadable};
use lumiduct_base::error::{Error, Result};
use std::path::{Path, PathBuf};

/// A study file that was read, with the problems found so far.
pub(super) struct StudyDraft<Spec> {
    pub(super) spec: Spec,
    pub(super) places: Places,
    /// The table that it refers to: of designs, or of wanted light.
    pub(super) table: Option<TextId>,
    pub(super) problems: Problems,
}

/// Kinds of studies: what is done with the designs of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum StudyKind {
    /// Those of a plan are compared.
    Plan,
    /// One is found.
    Optimisation,
}

/// Reads a study file and the table it refers to.
pub(super) fn read(path: &Path) -> Result<StudyDraft<StudySpec>> {
    let mut reading = Reading::start(path, StudyKind::Plan, &schema::study_schema())?;
    let spec = convert::study(&reading.root, &mut reading.problems);
    let file = spec.as_ref().and_then(designs_file);
    reading.finish(spec, file, path)
}

/// Reads an optimisation and the table of light that it refers to.
pub(super) fn read_optimisation(path: &Path) -> Result<StudyDraft<OptimisationSpec>> {
    let mut reading =
        Reading::start(path, StudyKind::Optimisation, &schema::optimisation_schema())?;
    let spec = convert::optimisation(&reading.root, &mut reading.problems);
    let file = spec.as_ref().and_then(profile_file);
    reading.finish(spec, file, path)
}

/// A study file whose keys are checked.
struct Reading {
    root: Node,
    sources: Texts,
    problems: Problems,
}

impl Reading {
    fn start(path: &Path, kind: StudyKind, schema: &serde_json::Value) -> Result<Self> {
        let (mut sources, mut problems) = (Texts::default(), Problems::default());
        let source =
            sources.add_file(path).map_err(|reason| unreadable(path, &reason.to_string()))?;
        let (root, breaks) = tree::parse(&sources, source);
        if is_other_kind(&root, kind, &mut problems) {
            return Err(Error::Input(problems.into_diagnostics(&Places::new(root, sources))));
        }
        note_differences(&root, schema, &sources, &breaks, &mut problems);
        note_breaks(&breaks, &mut problems);
        Ok(Self { root, sources, problems })
    }

    /// Reads the table at a key, and ends.
    fn finish<Spec>(
        self,
        spec: Option<Spec>,
        file: Option<(Key, String)>,
        path: &Path,
    ) -> Result<StudyDraft<Spec>> {
        let Self { root, mut sources, mut problems } = self;
        let table = file.and_then(|(key, file)| {
            let file: PathBuf = path.parent().unwrap_or(Path::new("")).join(file);
            match sources.add_file(&file) {
                Ok(source) => Some(source),
                Err(reason) => {
                    problems.error(&key, format!("{}: {reason}", file.display()));
                    None
                }
            }
        });
        let places = Places::new(root, sources);
        match spec {
            Some(spec) => Ok(StudyDraft { spec, places, table, problems }),
            None => Err(Error::Input(problems.into_diagnostics(&places))),
        }
    }
}

/// The file with the designs of a study, and its key.
fn designs_file(spec: &StudySpec) -> Option<(Key, String)> {
    match &spec.plan {
        PlanSpec::List(own) => Some((Key::of(&["plan", "list", "file"]), own.file.clone())),
        PlanSpec::Grid
        | PlanSpec::OneAtATime
        | PlanSpec::LatinHypercube(_)
        | PlanSpec::Sobol(_)
        | PlanSpec::Tolerance(_)
        | PlanSpec::Search(_) => None,
    }
}

/// The file with the wanted light of an optimisation, and its key.
fn profile_file(spec: &OptimisationSpec) -> Option<(Key, String)> {
    let OptimiseSpec::PatternFeedback(own) = &spec.optimise;
    match &own.target {
        LightTargetSpec::Uniform => None,
        LightTargetSpec::Profile(own) => {
            let key = Key::of(&["optimise", "pattern_feedback", "target", "profile", "file"]);
            Some((key, own.file.clone()))
        }
    }
}

/// Whether a file is not a study of this kind and version, so that this schema does not apply.
fn is_other_kind(root: &Node, kind: StudyKind, problems: &mut Problems) -> bool {
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
        (Some(_), _) => match (kind, root.get("optimise"), root.get("plan")) {
            (StudyKind::Plan, Some(node), None) => {
                problems
                    .error(&Key::of(&["optimise"]), "this study finds a design, it has no plan")
                    .hint("run it with `lumiduct optimise`")
                    .at(&node.origin);
                true
            }
            (StudyKind::Optimisation, None, Some(node)) => {
                problems
                    .error(&Key::of(&["plan"]), "this study has a plan, and nothing to optimise")
                    .hint("run it with `lumiduct batch`")
                    .at(&node.origin);
                true
            }
            (StudyKind::Plan | StudyKind::Optimisation, _, _) => false,
        },
        (None, None) => false,
    }
}
