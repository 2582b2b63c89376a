//! House rules: layers use only those below them, no circles of modules, children never use
//! `super::`, and the files that the repository promises exist.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "layers/graph.rs"]
mod graph;
mod package;
mod skip;

use graph::{Graph, circles};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Sources of all crates. Their manifests define which crates they can use.
const CRATES: [&str; 7] = [
    "crates/base/src",
    "crates/core/src",
    "crates/files/src",
    "crates/baselines/src",
    "crates/input/src",
    "crates/report/src",
    "src",
];

/// The crates of this workspace that each crate may use.
const MAY_USE: [(&str, &[&str]); 8] = [
    ("crates/base", &[]),
    ("crates/files", &["base"]),
    ("crates/core", &["base"]),
    ("crates/baselines", &["base", "core"]),
    ("crates/input", &["base", "core", "files"]),
    ("crates/report", &["base", "core", "files", "input"]),
    ("xtask", &["input"]),
    (".", &["base", "baselines", "core", "files", "input", "report"]),
];

/// The folders of `core` from the bottom: each may use those on lines before its own.
const CORE: [&[&str]; 5] =
    [&["colour", "plan", "rng", "tally"], &["optics"], &["scene"], &["transport"], &["measure"]];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs")
            && path.file_stem().is_some_and(|stem| stem != "tests")
        {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// Lines of a file before its tests, without comments.
fn code(path: &Path) -> Vec<(usize, String)> {
    let text = std::fs::read_to_string(path).unwrap();
    text.lines()
        .enumerate()
        .take_while(|(_, line)| !line.ends_with("mod tests {"))
        .map(|(number, line)| (number + 1, line.split("//").next().unwrap_or_default().to_owned()))
        .collect()
}

/// A manifest below the root of the repository.
fn manifest(folder: &str) -> toml::Table {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).join("Cargo.toml");
    std::fs::read_to_string(path).unwrap().parse().unwrap()
}

#[test]
fn a_crate_uses_only_those_below_it() {
    if package::is_without_reports() {
        return;
    }
    let mut crates: Vec<_> = MAY_USE.map(|(folder, _)| folder.to_owned()).to_vec();
    crates.sort();
    assert_eq!(crates, manifest_list("default-members"));
    for (folder, may_use) in MAY_USE {
        let manifest = manifest(folder);
        let used = manifest["dependencies"].as_table().unwrap().keys();
        let own: Vec<_> = used.filter_map(|name| name.strip_prefix("lumiduct-")).collect();
        assert_eq!(own, may_use, "{folder}");
    }
}

#[test]
fn folders_of_core_use_only_those_below_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let graph = Graph::of_crate(&root.join("crates/core/src"));
    let layer = |names: &[String]| {
        let top = names.first()?.as_str();
        let layer = CORE.iter().position(|folders| folders.contains(&top));
        assert!(layer.is_some(), "`{top}` has no layer");
        layer
    };
    let arrows = graph.arrows();
    let upward: Vec<_> = arrows
        .iter()
        .filter(|((from, to), _)| layer(from) < layer(to))
        .map(|((from, to), items)| format!("{} -> {}: {items:?}", from.join("::"), to.join("::")))
        .collect();
    assert!(upward.is_empty(), "{upward:#?}");
}

#[test]
fn input_makes_scenes_and_plans_but_traces_nothing() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for path in sources(&root.join("crates/input/src")) {
        for (line, text) in code(&path) {
            assert!(!text.contains("lumiduct_core::transport"), "{}:{line}", path.display());
        }
    }
}

#[test]
fn a_type_name_means_one_thing() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for folder in CRATES {
        for (name, module) in Graph::of_crate(&root.join(folder)).types() {
            places.entry(name.clone()).or_default().push(format!("{folder}: {module}"));
        }
    }
    assert!(places.len() > 500, "{} types", places.len());
    places.retain(|_, modules| modules.len() > 1);
    assert!(places.is_empty(), "names of several types: {places:#?}");
}

/// Rows of a table of the glossary, cell by cell.
fn glossary(heading: &str) -> Vec<Vec<String>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("docs/glossary.md")).unwrap();
    let section = text.split("\n## ").find(|section| section.starts_with(heading)).unwrap();
    let rows = section.lines().filter(|line| line.starts_with('|')).skip(2);
    let cells = rows.map(|row| row.trim_matches('|').split('|'));
    cells.map(|row| row.map(|cell| cell.trim().to_owned()).collect()).collect()
}

#[test]
fn the_glossary_defines_each_term_once() {
    let mut terms: Vec<String> =
        ["Photometry", "Scene", "Paths", "Estimators and runs", "Units of work"]
            .into_iter()
            .flat_map(glossary)
            .flat_map(|row| row[0].split(", ").map(str::to_owned).collect::<Vec<_>>())
            .collect();
    assert!(terms.len() > 40, "{} terms", terms.len());
    terms.sort();
    let twice: Vec<_> = terms.windows(2).filter(|pair| pair[0] == pair[1]).collect();
    assert!(twice.is_empty(), "{twice:?}");
}

#[test]
fn prose_and_code_avoid_the_words_that_the_glossary_replaces() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files: Vec<PathBuf> =
        CRATES.iter().flat_map(|folder| sources(&root.join(folder))).collect();
    let pages = ["docs", "xtask/templates"].map(|folder| root.join(folder));
    let pages = pages.iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten();
    let pages = pages.map(|entry| entry.unwrap().path());
    files.extend(pages.filter(|page| page.extension().is_some_and(|ending| ending == "md")));
    files.extend(["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(|page| root.join(page)));
    files.retain(|file| !file.ends_with("glossary.md"));
    let avoided = glossary("Avoided");
    assert!(avoided.len() > 5, "{avoided:?}");
    let mut found = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap().to_lowercase();
        for row in &avoided {
            found.extend(text.contains(&row[0]).then(|| format!("{}: {}", file.display(), row[0])));
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn no_folder_has_a_circle_of_modules() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    for folder in CRATES {
        let arrows = Graph::of_crate(&root.join(folder)).arrows();
        assert!(!arrows.is_empty(), "{folder} has no modules that use each other");
        found.extend(circles(&arrows).into_iter().map(|circle| format!("{folder}: {circle}")));
    }
    assert!(found.is_empty(), "circles of modules:\n{}", found.join("\n"));
}

#[test]
fn a_circle_through_a_re_export_is_found() {
    let folder = tempfile::tempdir().unwrap();
    for (name, code) in [
        ("lib.rs", "mod a;\nmod b;\npub use b::B;"),
        ("a.rs", "use crate::B;\npub struct A(B);"),
        ("b.rs", "pub struct B;\n#[cfg(test)]\nmod tests { use crate::a::A; }"),
    ] {
        std::fs::write(folder.path().join(name), code).unwrap();
    }
    assert!(circles(&Graph::of_crate(folder.path()).arrows()).is_empty());
    std::fs::write(folder.path().join("b.rs"), "pub struct B(crate::a::A);").unwrap();
    assert_eq!(circles(&Graph::of_crate(folder.path()).arrows()), [": a -> b -> a"]);
}

#[test]
fn every_source_file_is_short() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["src", "crates", "tests", "examples", "benches", "xtask"];
    // A crate that is packaged alone has not all of them.
    let folders = folders.map(|folder| root.join(folder)).into_iter().filter(|path| path.is_dir());
    let files: Vec<PathBuf> = folders.flat_map(|folder| sources(&folder)).collect();
    assert!(files.len() > 30, "{} files", files.len());
    let lines = |path: &PathBuf| std::fs::read_to_string(path).unwrap().lines().count();
    let long: Vec<_> = files.iter().filter(|path| lines(path) > 400).collect();
    assert!(long.is_empty(), "over 400 lines: {long:#?}");
}

#[test]
fn children_do_not_reach_up() {
    let mut wrong = Vec::new();
    for folder in ["src", "crates"] {
        for path in sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)) {
            for (line, text) in code(&path) {
                // `pub(super)` names a visibility, not a path.
                if text.contains("super::") {
                    wrong.push(format!("{}:{line}", path.display()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "`super::` outside tests:\n{}", wrong.join("\n"));
}

/// Entries of a list in the manifest of the workspace.
fn manifest_list(name: &str) -> Vec<String> {
    let manifest = manifest(".");
    let list = manifest["workspace"][name].as_array().unwrap();
    list.iter().map(|entry| entry.as_str().unwrap().to_owned()).collect()
}

#[test]
fn a_bare_command_does_all_crates() {
    if package::is_without_reports() {
        return;
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut members = vec![".".to_owned()];
    for member in manifest_list("members") {
        match member.strip_suffix("/*") {
            None => members.push(member),
            Some(folder) => {
                for entry in std::fs::read_dir(root.join(folder)).unwrap() {
                    let name = entry.unwrap().file_name().into_string().unwrap();
                    members.push(format!("{folder}/{name}"));
                }
            }
        }
    }
    members.sort();
    assert_eq!(members, manifest_list("default-members"));
}

#[test]
fn every_scene_has_a_report_and_a_check() {
    if package::is_without_reports() {
        return;
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for entry in std::fs::read_dir(root.join("scenes")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            assert!(
                root.join("reports").join(&name).join("report.md").is_file(),
                "no report of {name}"
            );
            assert!(
                std::fs::read_to_string(&path).unwrap().contains("[[check]]"),
                "no check in {name}"
            );
        }
    }
}

#[test]
fn every_example_that_a_scene_names_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut named = 0;
    for entry in std::fs::read_dir(root.join("scenes")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        for rest in text.split("--example ").skip(1) {
            let name: String =
                rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let example = root.join("examples").join(&name).with_extension("rs");
            assert!(example.is_file(), "{}: no example `{name}`", path.display());
            named += 1;
        }
    }
    assert!(named > 0, "no scene names an example");
}

/// Pictures on the project page, by their reports.
const PICTURES: [&str; 3] = [
    "led_indicator/exit.illuminance.png",
    "luminance_image_scatter/camera.luminance.png",
    "studies/led_pipe_length/response.exit.efficiency.png",
];

/// Path of a picture on the project page.
fn picture_of_the_page(picture: &str) -> PathBuf {
    let name = picture.rsplit('/').next().unwrap();
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/pictures").join(name)
}

#[test]
fn pictures_of_the_readme_lie_in_the_package() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = std::fs::read_to_string(root.join("README.md")).unwrap();
    assert!(!readme.contains("](reports/"), "reports are no part of the package");
    for picture in PICTURES.map(picture_of_the_page) {
        let name = picture.strip_prefix(root).unwrap().display();
        assert!(readme.contains(&format!("]({name})")) && picture.is_file(), "{name} is not shown");
    }
    let files = std::fs::read_dir(root.join("docs/pictures")).unwrap();
    let sizes = files.map(|file| file.unwrap().metadata().unwrap().len());
    assert!(sizes.sum::<u64>() < 1_000_000, "pictures of the package are larger than 1 MB");
}

#[test]
fn pictures_of_the_readme_are_those_of_the_reports() {
    if package::is_without_reports() {
        return;
    }
    for picture in PICTURES {
        let own = picture_of_the_page(picture);
        let reports = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports");
        let committed = std::fs::read(reports.join(picture)).unwrap();
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            std::fs::write(&own, &committed).unwrap();
        }
        let same = std::fs::read(&own).unwrap() == committed;
        assert!(
            same,
            "{} is not that of reports/{picture}: run this test with UPDATE_GOLDEN=1",
            own.display()
        );
    }
}
