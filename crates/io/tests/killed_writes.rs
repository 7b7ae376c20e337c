//! A process that ends at any step of a write leaves the old file or the new one, and what else it left goes with the next run.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::{
    env, fs,
    path::Path,
    process::{self, Command, Stdio},
};

use arabesque_io::file::{Step, Target, abandon_writing};

/// Tells the process that is to die where it writes, and after which step it ends.
const ORDER: &str = "ARABESQUE_TEST_DIES";

/// The same for a process that is ended.
const ENDED: &str = "ARABESQUE_TEST_ENDS";

/// Three chunks and a bit.
const NEW_BYTES: usize = (3 << 20) + 5;

fn new_content() -> Vec<u8> {
    (0..NEW_BYTES).map(|k| (k % 251) as u8).collect()
}

/// Writes as ordered and ends in the middle of it, without cleaning up; does nothing where nobody ordered it.
#[test]
fn the_process_that_dies() {
    let Ok(order) = env::var(ORDER) else { return };
    let (step, path) = order.split_once(' ').unwrap();
    let (last, mut step) = (step.parse::<usize>().unwrap(), 0);
    let mut target = Target::new(path).unwrap();
    if path.ends_with("kept") {
        target = target.keeping_copy();
    }
    let written = target.write_watched(&new_content(), &mut |_| {
        step += 1;
        if step == last { std::process::abort() } else { Ok(()) }
    });
    written.unwrap();
}

/// Whether the process died at this step, rather than coming to the end.
fn dies(step: usize, path: &Path) -> bool {
    let status = Command::new(env::current_exe().unwrap())
        .args(["--exact", "the_process_that_dies"])
        .env(ORDER, format!("{step} {}", path.to_str().unwrap()))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .unwrap();
    !status.success()
}

/// Only in a process of its own: what other tests write at the same time would go too.
#[test]
fn who_ends_the_process_cleans_up() {
    let Ok(path) = env::var(ENDED) else {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.svg"), "old").unwrap();
        let status = Command::new(env::current_exe().unwrap())
            .args(["--exact", "who_ends_the_process_cleans_up"])
            .env(ENDED, folder.path().join("a.svg"))
            .stdout(Stdio::null())
            .status()
            .unwrap();
        assert_eq!(status.code(), Some(7));
        assert_eq!(names(folder.path()), ["a.svg"]);
        assert_eq!(fs::read_to_string(folder.path().join("a.svg")).unwrap(), "old");
        return;
    };
    let target = Target::new(&path).unwrap();
    let _ = target.write_watched(&new_content(), &mut |step| {
        if step == Step::Dressed {
            abandon_writing();
            process::exit(7);
        }
        Ok(())
    });
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Kills a write to a file of this name at every step; `old` is what lies there.
fn killed_at_every_step(name: &str, old: Option<&str>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    let (mut step, mut old_left, mut new_left) = (0, 0, 0);
    loop {
        step += 1;
        for name in names(folder.path()) {
            fs::remove_file(folder.path().join(name)).unwrap();
        }
        if let Some(old) = old {
            fs::write(&path, old).unwrap();
        }
        if !dies(step, &path) {
            break;
        }
        match fs::read(&path).ok() {
            Some(content) if content == new_content() => new_left += 1,
            content => {
                assert_eq!(content.as_deref(), old.map(str::as_bytes), "step {step}");
                old_left += 1;
            }
        }
        // Whoever writes there next finds the place as it was, with copies that were asked for and nothing else.
        let before = fs::read(&path).ok();
        let _target = Target::new(path.to_str().unwrap()).unwrap();
        assert_eq!(fs::read(&path).ok(), before);
        let left = names(folder.path());
        assert!(left.iter().all(|n| n.starts_with(name)), "step {step}: {left:?}");
        if let Some(copy) = left.iter().find(|n| n.ends_with(".orig")) {
            assert_eq!(Some(&*fs::read_to_string(folder.path().join(copy)).unwrap()), old, "step {step}");
        }
    }
    assert_eq!((step, old_left, new_left), (10, 8, 1));
    assert_eq!(fs::read(&path).unwrap(), new_content());
}

#[test]
fn a_killed_write_leaves_the_old_file_or_the_new_one() {
    killed_at_every_step("out.svg", Some("old"));
}

#[test]
fn a_killed_write_leaves_no_file_or_the_new_one() {
    killed_at_every_step("out.svg", None);
}

#[test]
fn a_killed_write_leaves_the_old_file_under_one_name_at_least() {
    killed_at_every_step("kept", Some("old"));
}
