//! Parts of one run, traced on several machines and merged to exactly the report of the whole run.

use crate::pipeline::output::{Output, output_dir};
use crate::pipeline::snapshot::{self, SnapshotKind};
use crate::pipeline::stop::Stop;
use crate::pipeline::{FinishedRun, compose, prepare, recipe};
use lumiduct_base::error::{Error, Result};
use lumiduct_core::transport::{Activity, Interrupt, Run, Shard, Slice, StopSignal, Unsliceable};
use lumiduct_input::{Job, Settings};
use lumiduct_report::{
    self as report, Existing, Folder, FolderLock, Pictures, Recipe, expect_file,
};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Name of the file of a part in its folder.
const NAME: &str = "slice.bin";

/// A part of a run on disk: the run it belongs to, and what was counted.
#[derive(Serialize, Deserialize)]
struct RunPart {
    recipe: Recipe,
    /// The scene file as the user named it.
    scene: String,
    settings: Settings,
    slice: Slice,
}

/// Which part of a run is wanted, and where.
#[derive(Debug, Clone)]
pub struct SliceOptions {
    /// The part.
    pub shard: Shard,
    /// Its folder; `reports/NAME.KofN` when none is given.
    pub dir: Option<PathBuf>,
    /// What to do with an existing part.
    pub existing: Existing,
}

/// A part of a run that was traced.
#[derive(Debug)]
pub struct SliceWritten {
    /// Title of the scene.
    pub title: String,
    /// Its batches, of `of`; `None` where the user stopped it, and nothing was written.
    pub batches: Option<Range<u64>>,
    /// Batches of the whole run.
    pub of: u64,
    /// Its folder.
    pub dir: PathBuf,
}

/// Traces a part of the run of a scene; `watch` receives the share done, 0..=1.
///
/// # Errors
///
/// As [`prepare`]. Also [`Error::Usage`] if the end of the run is not a number of paths, if it gathers in stages,
/// or if an existing part is to be kept; [`Error::Io`] if the part cannot be written.
pub fn run_slice(
    scene: &Path,
    settings: &Settings,
    options: &SliceOptions,
    interrupt: &Interrupt,
    watch: &mut dyn FnMut(f64),
) -> Result<SliceWritten> {
    let job = prepare(scene, settings)?;
    expect_fixed_end(&job)?;
    let dir = options.dir.clone().unwrap_or_else(|| {
        let part = options.shard.to_string().replace('/', "of");
        Path::new("reports").join(format!("{}.{part}", job.name))
    });
    let path = dir.join(NAME);
    if path.exists() && options.existing == Existing::Keep {
        return Err(Error::Usage(format!(
            "{} exists; use --overwrite to replace it, or -o for another folder",
            path.display()
        )));
    }
    expect_file(&path)?;
    interrupt.begin(Activity::Tracing);
    let signal = StopSignal::new(interrupt, None);
    let nothing =
        |of| SliceWritten { title: job.title.clone(), batches: None, of, dir: dir.clone() };
    let Some(run) = Run::start(&job.scene, &job.run, &signal, &mut |_| ()) else {
        return Ok(nothing(0));
    };
    let of = run.sliceable_batches().map_err(refusal)?;
    let batches = run.batches_of_part(options.shard, of);
    let count = (batches.end - batches.start).max(1) as f64;
    let slice = run.slice(batches.clone(), of, &mut |done| watch(done as f64 / count));
    let Some(slice) = slice else { return Ok(nothing(of)) };
    let title = job.title.clone();
    let scene = scene.to_string_lossy().into_owned();
    let part = RunPart { recipe: recipe(&job), scene, settings: settings.clone(), slice };
    interrupt.begin(Activity::Writing);
    snapshot::write(&path, SnapshotKind::Slice, &part)?;
    Ok(SliceWritten { title, batches: Some(batches), of, dir })
}

/// Whether a folder contains a part of a run.
pub fn has_slice(dir: &Path) -> bool {
    dir.join(NAME).is_file()
}

/// Merges the parts of a run and writes the report of the whole. The scene is read again, from
/// where the parts found it or from `scene`.
///
/// # Errors
///
/// As [`prepare`]. Also [`Error::Usage`] if a part is missing, damaged, of another run, or has batches of another
/// part, or if the folder is not free; [`Error::Io`] if a file cannot be read or written; [`Error::Output`] if the
/// report cannot be composed.
pub fn merge_slices(
    dirs: &[PathBuf],
    scene: Option<&Path>,
    output: &Output,
) -> Result<FinishedRun> {
    let mut parts: Vec<(PathBuf, RunPart)> = Vec::new();
    for dir in dirs {
        let path = dir.join(NAME);
        parts.push((path.clone(), snapshot::read(&path, SnapshotKind::Slice)?));
    }
    parts.sort_by_key(|(_, part)| (part.slice.batches.start, part.slice.batches.end));
    let Some((first_path, first)) = parts.first() else {
        return Err(Error::Usage("there are no parts to merge".into()));
    };
    let scene = scene.map_or_else(|| PathBuf::from(&first.scene), Path::to_path_buf);
    if !scene.is_file() {
        return Err(Error::Usage(format!(
            "{} is a part of a run of {}, and there is no such file here; give its path with --scene",
            first_path.display(),
            scene.display()
        )));
    }
    let job = prepare(&scene, &first.settings)?;
    expect_same(
        &recipe(&job),
        &first.recipe,
        &format!("{} as it is now", scene.display()),
        first_path,
    )?;
    for (path, part) in &parts {
        expect_same(&first.recipe, &part.recipe, &first_path.display().to_string(), path)?;
    }
    expect_all(&parts)?;
    let lock = FolderLock::take(&output_dir(&scene, output))?;
    let folder = Folder::open(lock, output.existing, Some(&recipe(&job)))?;
    let mut run = Run::new(&job.scene, &job.run);
    let slices = parts.into_iter().map(|(_, part)| part.slice).collect();
    run.restore(run.state_of_slices(slices));
    let stop = Stop::complete(&job.run.stop);
    let report = compose(&job, &run.findings(), stop)?;
    let written = folder.write(&report::files(&report, &job.text, Pictures::Drawn)?)?;
    let dir = folder.path().to_path_buf();
    let (luminaire, warnings) = (None, job.warnings);
    Ok(FinishedRun { report, written, stop, dir, luminaire, warnings })
}

fn expect_same(wanted: &Recipe, found: &Recipe, of: &str, path: &Path) -> Result<()> {
    if found == wanted {
        return Ok(());
    }
    let what = wanted.difference_of(found);
    Err(Error::Usage(format!("{} does not match {of}: it belongs to {what}", path.display())))
}

/// Makes sure that every batch is in exactly one part.
fn expect_all(parts: &[(PathBuf, RunPart)]) -> Result<()> {
    let mut next = 0;
    for (path, part) in parts {
        let Range { start, end } = part.slice.batches;
        if start < next && end > start {
            return Err(Error::Usage(format!(
                "{} holds batches that another part also holds: {start} to {}",
                path.display(),
                next - 1
            )));
        }
        if start > next {
            return Err(Error::Usage(format!(
                "a part is missing: no part holds batches {next} to {} of {}",
                start - 1,
                part.slice.of
            )));
        }
        next = next.max(end);
    }
    match parts.last() {
        Some((_, part)) if next < part.slice.of => Err(Error::Usage(format!(
            "a part is missing: no part holds batches {next} to {} of {}",
            part.slice.of - 1,
            part.slice.of
        ))),
        Some(_) | None => Ok(()),
    }
}

/// Refuses runs whose end depends on their results or on the clock.
fn expect_fixed_end(job: &Job) -> Result<()> {
    let stop = &job.run.stop;
    let is_fixed = stop.paths.is_some() && stop.target.is_none() && stop.time.is_none();
    if is_fixed { Ok(()) } else { Err(refusal(Unsliceable::OpenEnd)) }
}

fn refusal(why: Unsliceable) -> Error {
    Error::Usage(match why {
        Unsliceable::OpenEnd => {
            "a part of a run needs a fixed number of paths, which a target or a time \
            leaves open: give --paths"
                .into()
        }
        Unsliceable::Stages => {
            "gathering in stages chooses its windows from the results of the whole run, \
            which a part does not have: use --schedule fixed, or --estimator forward, backward or \
                                mix"
            .into()
        }
    })
}
