//! Runs in parts, and killed runs: both must give exactly the bytes of the whole.

use crate::*;
use std::process::{Command as Process, Stdio};
use std::thread::sleep;
use std::time::Duration;

#[test]
fn parts_of_a_run_make_the_report_of_the_whole() {
    let place = Place::new();
    for estimator in ["forward", "backward", "mix", "gather --schedule fixed"] {
        let run = format!("run rod.toml --estimator {estimator} --overwrite");
        place.good(&format!("{run} -o whole"));
        for part in ["3/3", "1/3", "2/3"] {
            let folder = part.replace('/', "of");
            place.good(&format!("{run} --shard {part} --threads {} -o {folder}", part.len()));
        }
        place.good("merge 2of3 3of3 1of3 -o merged --overwrite");
        assert_eq!(contents(&place.path("whole")), contents(&place.path("merged")), "{estimator}");
    }
}

#[test]
fn more_parts_than_batches_leave_some_empty() {
    let place = Place::new();
    let few = "run rod.toml -D run.batches=16";
    place.good(&format!("{few} -o whole"));
    for part in 1..=20 {
        place.good(&format!("{few} --shard {part}/20 -o parts/{part} -q"));
    }
    let parts: Vec<String> = (1..=20).map(|part| format!("parts/{part}")).collect();
    place.good(&format!("merge {} -o merged", parts.join(" ")));
    assert_eq!(contents(&place.path("whole")), contents(&place.path("merged")));
}

#[test]
fn parts_that_do_not_make_a_whole_are_refused_with_the_reason() {
    let place = Place::new();
    for part in ["1/2", "2/2"] {
        place.good(&format!("run rod.toml --shard {part} -o {}", part.replace('/', "of")));
    }
    place.good("run rod.toml --shard 2/2 --seed 7 -o other");
    assert!(place.bad(2, "merge 1of2 -o merged").contains("a part is missing"));
    assert!(place.bad(2, "merge 2of2 -o merged").contains("a part is missing"));
    assert!(place.bad(2, "merge 1of2 1of2 2of2 -o merged").contains("another part also holds"));
    assert!(place.bad(2, "merge 1of2 other -o merged").contains("a different seed"));
    assert!(place.bad(2, "merge 1of2 nowhere -o merged").contains("nowhere holds no part"));
    assert!(place.bad(2, "run rod.toml --shard 1/2 -o 1of2").contains("--overwrite"));
    let said = place.bad(2, "run rod.toml --shard 1/2 --target 1% -o x");
    assert!(said.contains("--paths"), "{said}");
    let said = place.bad(2, "run rod.toml --shard 1/2 --estimator gather -o x");
    assert!(said.contains("fixed"), "{said}");
    for wrong in ["0/2", "3/2", "1", "1/0"] {
        place.bad(2, &format!("run rod.toml --shard {wrong}"));
    }

    let slice = place.path("1of2").join("slice.bin");
    let bytes = fs::read(&slice).unwrap();
    fs::write(&slice, &bytes[..bytes.len() / 2]).unwrap();
    assert!(place.bad(2, "merge 1of2 2of2 -o merged").contains("cut off"));
    fs::write(&slice, bytes).unwrap();
    let scene = fs::read_to_string(place.path("rod.toml")).unwrap();
    fs::write(place.path("rod.toml"), scene.replace("length_mm = 10", "length_mm = 11")).unwrap();
    assert!(place.bad(2, "merge 1of2 2of2 -o merged").contains("a different scene"));
    assert!(!place.path("merged").exists());
}

/// Starts a run and kills it as soon as a file exists.
fn kill_when(place: &Place, arguments: &str, is_time: impl Fn() -> bool) {
    let mut child = Process::new(env!("CARGO_BIN_EXE_lumiduct"))
        .current_dir(place.0.path())
        .args(arguments.split_whitespace())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while !is_time() && child.try_wait().unwrap().is_none() {
        sleep(Duration::from_millis(2));
    }
    // SIGKILL, unless it has ended by itself.
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn a_killed_run_goes_on_from_its_checkpoint_to_the_same_bytes() {
    let place = Place::new();
    // The rounds of a gather run depend on its findings, so all of them must be in the checkpoint.
    for run in [
        "run rod.toml --paths 3M --estimator forward",
        "run rod.toml --estimator gather --paths 600k --depth 0 --radius-mm 1 --angle-deg 20 --photons 2k --records 500",
    ] {
        place.good(&format!("{run} -o whole --overwrite"));
        _ = fs::remove_dir_all(place.path("cut"));
        let checkpoint = place.path("cut").join("checkpoint.bin");
        let mut killed = 0;
        for _ in 0..3 {
            let before = fs::read(&checkpoint).ok();
            let is_new = || fs::read(&checkpoint).ok().is_some_and(|now| Some(now) != before);
            kill_when(&place, &format!("{run} -o cut --checkpoint 0.001s --resume"), is_new);
            killed += usize::from(checkpoint.exists());
        }
        assert!(killed > 0, "{run} was never killed between its start and its end");
        if checkpoint.exists() {
            assert!(place.bad(2, &format!("{run} -o cut")).contains("--resume"));
            let other = place.bad(2, &format!("{run} --seed 5 -o cut --resume"));
            assert!(other.contains("a different seed"), "{other}");
        }
        place.good(&format!("{run} -o cut --resume"));
        assert_eq!(contents(&place.path("whole")), contents(&place.path("cut")), "{run}");
        assert!(names(&place.path("cut")).iter().all(|name| !name.starts_with('.')));
    }
}

#[test]
fn a_checkpoint_that_was_cut_off_is_refused_with_the_reason() {
    let place = Place::new();
    let run = "run rod.toml --paths 3M -o cut";
    let checkpoint = place.path("cut").join("checkpoint.bin");
    kill_when(&place, &format!("{run} --checkpoint 0.001s"), || checkpoint.exists());
    let bytes = fs::read(&checkpoint).unwrap();
    fs::write(&checkpoint, &bytes[..bytes.len() - 1]).unwrap();
    assert!(place.bad(2, &format!("{run} --resume")).contains("cut off"));
    fs::write(&checkpoint, "lumiduct slice 1\n").unwrap();
    assert!(place.bad(2, &format!("{run} --resume")).contains("does not begin"));
    place.good(&format!("{run} --overwrite"));
    assert!(!checkpoint.exists());
}

#[test]
fn the_commands_for_gnu_parallel_in_the_docs_do_what_they_say() {
    let found = Process::new("parallel").arg("--version").output();
    if !found.is_ok_and(|output| output.status.success()) {
        assert!(std::env::var_os("LUMIDUCT_PARALLEL").is_none(), "GNU parallel is not here");
        skip::report("GNU parallel is not on the path");
        return;
    }
    let docs = include_str!("../../docs/cluster.md");
    let section = docs.split("## GNU parallel").nth(1).unwrap();
    let commands = section.split("```sh\n").nth(1).unwrap().split("```").next().unwrap();
    let commands = commands
        .replace("scenes/led_indicator.toml", "rod.toml")
        .replace("seq 1 16", "seq 1 4")
        .replace("/16", "/4");
    let place = Place::new();
    let folder = Path::new(env!("CARGO_BIN_EXE_lumiduct")).parent().unwrap().to_path_buf();
    let path = std::env::var_os("PATH").unwrap();
    let path = std::env::join_paths(std::iter::once(folder).chain(std::env::split_paths(&path)));
    let output = Process::new("bash")
        .args(["-euc", &commands])
        .current_dir(place.0.path())
        .env("PATH", path.unwrap())
        // GNU parallel asks to be cited on a terminal, and waits for an answer where there is none.
        .env("PARALLEL", "--will-cite")
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", errors(&output));
    place.good("run rod.toml -o whole");
    assert_eq!(contents(&place.path("whole")), contents(&place.path("reports/whole")));
}
