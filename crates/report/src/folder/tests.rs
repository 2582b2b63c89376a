use super::*;
use lumiduct_core::plan::{GatherPlan, Request, RunPlan, StopRules};

fn file(name: &str, text: &str) -> OutputFile {
    OutputFile { name: name.into(), bytes: text.into() }
}

fn recipe(seed: u64) -> Recipe {
    let stop = StopRules { paths: Some(20), ..StopRules::default() };
    let (estimator, gather) = (Request::Forward, GatherPlan::default());
    let sensor_estimators = Vec::new();
    let plan = RunPlan {
        estimator,
        sensor_estimators,
        gather,
        seed,
        bounce_limit: 9,
        batch_paths: None,
        stop,
    };
    Recipe::new("e9a5", &plan)
}

fn summary(seed: u64, partial: bool) -> String {
    let identity = recipe(seed);
    serde_json::json!({ "run": { "partial": partial, "identity": identity } }).to_string()
}

fn open(path: &Path, existing: Existing, recipe: Option<&Recipe>) -> Result<Folder> {
    Folder::open(FolderLock::take(path)?, existing, recipe)
}

fn names(path: &Path) -> Vec<String> {
    let entries = fs::read_dir(path).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_report_is_not_replaced_unless_asked_and_other_files_stay() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("report");
    let open = |existing| open(&path, existing, Some(&recipe(1)));
    open(Existing::Keep).unwrap().write(&[file("a.csv", "1"), file("old.csv", "1")]).unwrap();
    assert!(matches!(open(Existing::Keep), Err(Error::Usage(_))));
    fs::write(path.join("notes.txt"), "mine").unwrap();
    let written = open(Existing::Replace).unwrap().write(&[file("a.csv", "2")]).unwrap();
    assert_eq!(written, Written::New);
    assert_eq!(fs::read_to_string(path.join("a.csv")).unwrap(), "2");
    // A changed file is restored, and the manifest stays.
    fs::write(path.join("a.csv"), "3").unwrap();
    open(Existing::Replace).unwrap().write(&[file("a.csv", "2")]).unwrap();
    assert_eq!(fs::read_to_string(path.join("a.csv")).unwrap(), "2");
    assert_eq!(fs::read_to_string(path.join("notes.txt")).unwrap(), "mine");
    // Two runs leave one report, and no temporary file.
    assert_eq!(names(&path), ["a.csv", "manifest.json", "notes.txt"]);
}

#[test]
fn a_report_of_the_same_recipe_may_be_run_again_and_must_come_out_the_same() {
    let dir = tempfile::tempdir().unwrap();
    let open = |recipe: Option<&Recipe>| open(dir.path(), Existing::Keep, recipe);
    let files = [file("summary.json", &summary(1, false)), file("a.csv", "1")];
    open(None).unwrap().write(&files).unwrap();
    assert_eq!(open(Some(&recipe(1))).unwrap().write(&files).unwrap(), Written::Same);
    assert!(open(Some(&recipe(2))).is_err() && open(None).is_err());

    let other = [file("new.csv", "3"), file("a.csv", "2")];
    let written = open(Some(&recipe(1))).unwrap().write(&other).unwrap();
    assert_eq!(written, Written::Nothing { differing: vec!["a.csv".into()] });
    assert_eq!(fs::read_to_string(dir.path().join("a.csv")).unwrap(), "1");
    let own = ["a.csv", "manifest.json", "summary.json"];
    assert_eq!(names(dir.path()), own, "a file was written in spite of it");
    // Without its manifest it is not a report.
    fs::remove_file(dir.path().join("manifest.json")).unwrap();
    assert!(open(Some(&recipe(1))).unwrap_err().to_string().contains("not a complete report"));
}

#[test]
fn a_partial_report_and_an_older_one_are_not_run_over() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("partial");
    let files = [file("summary.json", &summary(1, true))];
    open(&path, Existing::Keep, None).unwrap().write(&files).unwrap();
    let said = open(&path, Existing::Keep, Some(&recipe(1))).unwrap_err().to_string();
    assert!(said.contains("run that was stopped"), "{said}");
    fs::write(path.join("summary.json"), r#"{"run": {"version": "0.1.0"}}"#).unwrap();
    let said = open(&path, Existing::Keep, Some(&recipe(1))).unwrap_err().to_string();
    assert!(said.contains("by an older version"), "{said}");
}

#[test]
fn files_of_a_run_that_was_killed_while_they_took_their_places_go_away() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("notes.txt"), "mine").unwrap();
    let files = [file("a.csv", "1"), file("summary.json", &summary(1, false))];
    open(dir.path(), Existing::Replace, None).unwrap().write(&files).unwrap();
    // A second run was killed after its first file: its list and a staged file remain, and no
    // manifest.
    let list = Manifest::of(&files).file(REPLACING).unwrap();
    fs::write(dir.path().join(REPLACING), &list.bytes).unwrap();
    fs::write(dir.path().join(".lumiduct-x1y2"), "half").unwrap();
    fs::write(dir.path().join("a.csv"), "2").unwrap();
    fs::remove_file(dir.path().join(MANIFEST)).unwrap();
    fs::remove_file(dir.path().join("notes.txt")).unwrap();
    let folder = open(dir.path(), Existing::Keep, Some(&recipe(1))).unwrap();
    assert!(names(dir.path()).is_empty(), "{:?}", names(dir.path()));
    assert_eq!(folder.write(&files).unwrap(), Written::New);
    assert_eq!(names(dir.path()), ["a.csv", "manifest.json", "summary.json"]);
}

#[test]
fn a_file_beside_the_report_stays_unless_it_may_be_replaced() {
    let dir = tempfile::tempdir().unwrap();
    let read = || fs::read_to_string(dir.path().join("timing.csv")).unwrap();
    let folder = |existing| open(dir.path(), existing, None).unwrap();
    folder(Existing::Keep).write_beside("timing.csv", b"1").unwrap();
    Folder { existing: Existing::Keep, ..folder(Existing::Replace) }
        .write_beside("timing.csv", b"2")
        .unwrap();
    assert_eq!(read(), "1");
    folder(Existing::Replace).write_beside("timing.csv", b"2").unwrap();
    assert_eq!(read(), "2");
}

#[test]
fn a_single_file_is_replaced_only_when_asked_or_when_it_is_the_same() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("new").join("a.png");
    write_whole(&path, b"1", Existing::Keep).unwrap();
    write_whole(&path, b"1", Existing::Keep).unwrap();
    assert!(matches!(write_whole(&path, b"2", Existing::Keep), Err(Error::Usage(_))));
    write_whole(&path, b"2", Existing::Replace).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"2");
}

#[test]
fn a_file_in_the_way_of_the_folder_is_an_error() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("report");
    fs::write(&path, "a file").unwrap();
    let long = dir.path().join("x".repeat(300));
    for path in [&path, &path.join("below"), &long] {
        let refused = open(path, Existing::Keep, None);
        assert!(matches!(refused, Err(Error::Usage(_))), "{}", path.display());
    }
    #[cfg(unix)]
    {
        let link = dir.path().join("link");
        std::os::unix::fs::symlink(dir.path().join("nowhere"), &link).unwrap();
        assert!(matches!(open(&link, Existing::Keep, None), Err(Error::Usage(_))));
    }
}
