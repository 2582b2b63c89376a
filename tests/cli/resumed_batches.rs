//! Batches cut short, resumed, run in parts, and side by side: the same bytes.

use crate::batches::{STUDY, study};
use crate::*;
use std::process::{Command as Process, Stdio};
use std::thread::sleep;
use std::time::Duration;

/// All files of a batch, including those of its designs.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = contents(folder);
    for (name, bytes) in contents(&folder.join("designs")) {
        all.insert(format!("designs/{name}"), bytes);
    }
    all
}

#[test]
fn results_do_not_depend_on_threads_jobs_or_parts() {
    let place = study(STUDY);
    place.good("batch study.toml -o whole --threads 1 --jobs 1");
    place.good("batch study.toml -o other --threads 3 --jobs 5");
    assert_eq!(results(&place.path("whole")), results(&place.path("other")));
    for part in ["1/4", "2/4", "3/4", "4/4"] {
        let folder = part.replace('/', "of");
        let said = place.good(&format!("batch study.toml --shard {part} -o {folder}"));
        assert!(said.contains("lumiduct merge"), "{said}");
    }
    assert!(place.bad(2, "merge 1of4 2of4 4of4 -o merged").contains("a part is missing"));
    let own = place.bad(2, "merge 4of4 2of4 1of4 3of4 -o 1of4 --overwrite");
    assert!(own.contains("is one of the parts"), "{own}");
    place.good("merge 4of4 2of4 1of4 3of4 -o merged");
    assert_eq!(results(&place.path("whole")), results(&place.path("merged")));
}

#[test]
fn a_killed_batch_goes_on_without_repeating_designs_to_the_same_bytes() {
    let text = STUDY.replace("paths = 20_000", "paths = 300_000");
    let place = study(&text);
    place.good("batch study.toml -o whole");
    let designs = place.path("cut").join("designs");
    let done = || {
        fs::read_dir(&designs).map_or(0, |entries| {
            let records = entries.flatten().map(|entry| entry.file_name().into_string().unwrap());
            records.filter(|name| name.ends_with(".json") && !name.starts_with('.')).count()
        })
    };
    let mut child = Process::new(env!("CARGO_BIN_EXE_lumiduct"))
        .current_dir(place.0.path())
        .args(["batch", "study.toml", "-o", "cut", "--jobs", "2"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while done() < 2 && child.try_wait().unwrap().is_none() {
        sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let kept = done();
    assert!((2..6).contains(&kept), "{kept} designs were done when the batch was killed");
    let stamp = |name: &str| fs::metadata(designs.join(name)).unwrap().modified().unwrap();
    let first = names(&designs).into_iter().find(|name| name.ends_with(".json")).unwrap();
    let before = stamp(&first);
    // The leftovers of a kill in the middle of a write.
    fs::write(designs.join(".lumiduct-half"), "{").unwrap();

    assert!(place.bad(2, "batch study.toml -o cut").contains("--resume"));
    assert!(place.bad(2, "batch study.toml -o cut --resume --seed 9").contains("another study"));
    place.good("batch study.toml -o cut --resume");
    assert_eq!(stamp(&first), before, "a design that was done was computed again");
    assert_eq!(results(&place.path("whole")), results(&place.path("cut")));
    assert!(place.good("batch study.toml -o cut --resume").contains("identical to the byte"));
}

#[test]
fn two_batches_are_not_at_work_in_one_folder() {
    let place = study(&STUDY.replace("paths = 20_000", "paths = 2_000_000"));
    let start = |more: &str| {
        Process::new(env!("CARGO_BIN_EXE_lumiduct"))
            .current_dir(place.0.path())
            .args(["batch", "study.toml", "-o", "out"])
            .args(more.split_whitespace())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap()
    };
    let mut first = start("");
    while !place.path("out/batch.json").exists() && first.try_wait().unwrap().is_none() {
        sleep(Duration::from_millis(2));
    }
    for more in ["", "--resume", "--overwrite"] {
        let said = place.bad(2, &format!("batch study.toml -o out {more}"));
        assert!(said.contains("another run or batch is using"), "{more}: {said}");
    }
    first.kill().unwrap();
    first.wait().unwrap();
    // Whichever of two opens a new folder first, the other is refused.
    for _ in 0..5 {
        _ = fs::remove_dir_all(place.path("out"));
        let mut pair = [start(""), start("")];
        let refused = loop {
            let codes = pair.each_mut().map(|child| child.try_wait().unwrap());
            if let Some(code) = codes.into_iter().flatten().next() {
                break code;
            }
            sleep(Duration::from_millis(2));
        };
        assert_eq!(refused.code(), Some(2));
        for child in &mut pair {
            _ = child.kill();
            child.wait().unwrap();
        }
    }
}

#[test]
fn a_record_that_is_no_record_is_named() {
    let place = study(STUDY);
    place.good("batch study.toml -o out");
    let record = place.path("out").join("designs/0003.json");
    fs::write(&record, "{").unwrap();
    assert!(place.bad(2, "batch study.toml -o out --resume").contains("0003.json"));
    fs::remove_file(&record).unwrap();
    place.good("batch study.toml -o out --resume");
    fs::write(place.path("out").join("mine.txt"), "mine").unwrap();
    place.good("batch study.toml -o out --overwrite");
    assert_eq!(fs::read_to_string(place.path("out").join("mine.txt")).unwrap(), "mine");
    fs::create_dir(place.path("full")).unwrap();
    fs::write(place.path("full").join("mine.txt"), "mine").unwrap();
    assert!(place.bad(2, "batch study.toml -o full").contains("not results of a batch"));
    assert_eq!(names(&place.path("full")), ["mine.txt"]);
}

#[test]
fn what_a_kill_left_half_written_is_in_nobodys_way() {
    let place = study(STUDY);
    for command in
        ["batch study.toml -o cut --resume", "run rod.toml -o run --resume", "run rod.toml -o run"]
    {
        let folder = place.path(command.split_whitespace().nth(3).unwrap());
        _ = fs::remove_dir_all(&folder);
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join(".lumiduct-half"), "{").unwrap();
        place.good(command);
    }
    assert!(names(&place.path("cut")).iter().all(|name| !name.starts_with('.')));
}

#[test]
fn a_full_disk_ends_a_batch_with_the_file_it_met_and_resume_completes_it() {
    let place = study(STUDY);
    place.good("batch study.toml -o whole");
    // No file may grow beyond 24 blocks of 512 bytes: writes fail as on a full disk, and records are smaller than pages.
    let command = "trap '' XFSZ; ulimit -f 24; exec \"$0\" batch study.toml -o cut";
    let output = Process::new("sh")
        .current_dir(place.0.path())
        .args(["-c", command, env!("CARGO_BIN_EXE_lumiduct")])
        .output()
        .unwrap();
    assert_eq!(code(&output), 3, "{}", errors(&output));
    assert!(errors(&output).contains(".png: File too large"), "{}", errors(&output));
    assert!(!place.path("cut/study.json").exists());
    place.good("batch study.toml -o cut --resume");
    assert_eq!(results(&place.path("whole")), results(&place.path("cut")));
}
