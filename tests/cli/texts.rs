//! Names and titles of users never act upon a terminal, a spreadsheet or a page.

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
