use super::*;
use crate::root;
use lumiduct_input as input;

#[test]
fn the_pages_in_docs_are_current() {
    for (page, markdown) in pages() {
        let found = std::fs::read_to_string(root().join(page)).unwrap();
        assert!(found == markdown, "{page} is not current: run `cargo xtask manual`");
    }
}

#[test]
fn every_key_and_kind_of_the_schema_is_on_the_page() {
    for (page, schema) in [
        (markdown(), schema::json_schema()),
        (study_markdown(), schema::study_schema()),
        (optimise_markdown(), schema::optimisation_schema()),
    ] {
        for (name, definition) in schema["$defs"].as_object().unwrap() {
            let tables = options(definition).into_iter().chain([definition]);
            for key in tables
                .filter_map(|table| table["properties"].as_object())
                .flat_map(|keys| keys.keys())
            {
                let is_there =
                    page.contains(&format!("`{key}`")) || page.contains(&format!(".{key}`"));
                assert!(is_there, "{name}.{key}");
            }
        }
    }
}

#[test]
fn limits_of_arrays_of_tables_are_on_the_page() {
    let page = markdown();
    for row in [
        "| `layers` | array of [layer](#layer), 1 to 200 items |",
        "- `mixture`: array of [mixture part](#mixture-part), at least 1 item. ",
        "| `check` | array of [`check`](#check) |",
    ] {
        assert!(page.contains(row), "{row}");
    }
}

#[test]
fn every_link_leads_to_one_heading() {
    for page in pages().map(|(_, markdown)| markdown) {
        let headings: Vec<_> = page
            .lines()
            .filter(|line| line.starts_with('#'))
            .map(|line| anchor(line.trim_start_matches(['#', ' '])))
            .collect();
        let links: Vec<_> =
            page.split("](#").skip(1).filter_map(|rest| rest.split(')').next()).collect();
        assert!(links.len() > 5);
        for link in links {
            assert_eq!(headings.iter().filter(|heading| *heading == link).count(), 1, "{link}");
        }
    }
}

#[test]
fn the_worked_example_is_a_good_scene() {
    let example = TEMPLATE.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("example.toml");
    std::fs::write(&path, example).unwrap();
    let loaded = input::read(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert!(loaded.warnings.is_empty());
}

#[test]
fn the_worked_example_of_a_study_is_a_good_study() {
    let example = STUDY_TEMPLATE.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("example.toml");
    let scenes = root().join("scenes").display().to_string();
    std::fs::write(
        &path,
        example.replace("\"../led_indicator.toml\"", &format!("\"{scenes}/led_indicator.toml\"")),
    )
    .unwrap();
    let study = input::load_study(&path, &input::StudySettings::default());
    assert!(study.unwrap_or_else(|error| panic!("{error}")).warnings.is_empty());
}

#[test]
fn the_worked_example_of_an_optimisation_is_a_good_one() {
    let example = OPTIMISE_TEMPLATE.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("example.toml");
    let scenes = root().join("scenes").display().to_string();
    let text = example.replace("\"../line", &format!("\"{scenes}/line"));
    std::fs::write(&path, text).unwrap();
    let study = input::load_optimisation(&path, &input::StudySettings::default());
    assert!(study.unwrap_or_else(|error| panic!("{error}")).warnings.is_empty());
}
