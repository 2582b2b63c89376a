//! Names and titles of users never act as commands on a terminal, in a spreadsheet or on a page.

use crate::*;

#[test]
fn control_characters_of_a_title_are_refused_with_their_line() {
    let place = Place::new();
    for title in ["\\u001b[31mred", "evil \u{202e}txt.exe"] {
        let scene = SCENE.replace("Short rod", title);
        fs::write(place.path("rod.toml"), scene).unwrap();
        let said = place.bad(2, "run rod.toml");
        assert!(said.contains("rod.toml:2") && said.contains("control character U+"), "{said}");
        assert!(!said.contains(['\u{1b}', '\u{202e}']), "{said:?}");
        let listed = place.good("list .");
        assert!(!listed.contains(['\u{1b}', '\u{202e}']), "{listed:?}");
    }
    assert_eq!(place.names(), ["rod.toml"]);
}

#[test]
fn tags_of_a_description_are_text_on_every_page() {
    let place = Place::new();
    let scene =
        SCENE.replace("Short rod\"", "<b>rod\"\ndescription = \"<script>x</script> 1 < 2\"");
    fs::write(place.path("rod.toml"), scene).unwrap();
    place.good("run rod.toml -o out -q");
    let page = fs::read_to_string(place.path("out/report.md")).unwrap();
    assert!(page.starts_with("# &lt;b>rod"), "{page}");
    assert!(page.contains("&lt;script>x&lt;/script> 1 < 2"), "{page}");
    place.good("run rod.toml -o other -q -D description=<i>other</i>");
    place.good("diff out other -o difference -q --sigmas 100");
    let page = fs::read_to_string(place.path("difference/diff.md")).unwrap();
    assert!(page.contains("&lt;i>other&lt;/i>") && !page.contains("<i>"), "{page}");
}

#[test]
fn control_characters_of_the_command_line_never_reach_the_terminal() {
    let place = Place::new();
    for arguments in
        ["run rod.toml --pa\u{1b}[31mths 2", "run rod.toml --paths \u{9b}31m", "\u{1b}c"]
    {
        let said = place.bad(2, arguments);
        assert!(!said.contains(['\u{1b}', '\u{9b}']) && said.contains("\\u{"), "{said:?}");
    }
}

#[cfg(unix)]
#[test]
fn a_list_passes_by_pipes_and_devices() {
    let place = Place::new();
    let pipe = place.path("pipe.toml");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    std::os::unix::fs::symlink("/dev/zero", place.path("zero.toml")).unwrap();
    let listed = place.good("list .");
    assert!(listed.contains("Short rod") && !listed.contains("pipe.toml"), "{listed}");
    assert!(!listed.contains("zero.toml"), "{listed}");
}

#[cfg(unix)]
#[test]
fn output_that_cannot_be_a_folder_is_a_mistake_of_the_command_line() {
    let place = Place::new();
    std::os::unix::fs::symlink(place.path("nowhere"), place.path("link")).unwrap();
    let long = "x".repeat(300);
    for output in ["link", "rod.toml/below", &long] {
        let said = place.bad(2, &format!("run rod.toml -o {output}"));
        assert!(said.contains("cannot be made a folder"), "{said}");
    }
}

#[test]
fn files_that_cannot_be_made_are_mistakes_of_the_command_line() {
    let place = Place::new();
    let long = "x".repeat(300);
    let compare = "compare rod.toml --estimators forward --sensor exit --truth-file none.csv";
    for (arguments, words) in [
        (format!("check rod.toml -o {long}.png"), "too long"),
        (format!("check rod.toml -o new/{long}/a.png"), "too long"),
        ("check rod.toml -o rod.toml/a.png".into(), "rod.toml is a file"),
        ("check rod.toml -o .".into(), "is not a regular file"),
        ("check rod.toml --html -o a.html".into(), "is the name of the page"),
        (format!("run rod.toml --junit {long}"), "too long"),
        (format!("run rod.toml --junit new/{long}/a.xml"), "too long"),
        ("run rod.toml --shard 1/2 -o rod.toml".into(), "rod.toml is a file"),
        (format!("run rod.toml --shard 1/2 -o {long}"), "too long"),
        (compare.into(), "none.csv: cannot be read"),
        (format!("run {long}.toml"), "cannot be read"),
    ] {
        let said = place.bad(2, &arguments);
        assert!(said.contains(words), "{arguments}: {said}");
    }
    assert_eq!(place.names(), ["rod.toml"], "nothing is traced or made first");
    fs::create_dir_all(place.path("out/summary.json")).unwrap();
    for arguments in ["diff out out", "run rod.toml -o out --overwrite"] {
        assert!(place.bad(2, arguments).contains("summary.json: Is a directory"), "{arguments}");
    }
}
