//! Links, pipes, devices, rights and room: what a file system has in store.

use std::{
    fs,
    io::{self, Write},
    os::unix::{
        fs::{MetadataExt, PermissionsExt, chown, symlink},
        process::CommandExt,
    },
    process::{Command, Stdio},
};

use crate::common::{self, Folder, stderr};

/// Says why a test does not test everything here.
fn skipped(reason: &str) {
    let _ = writeln!(io::stderr(), "skipped: {reason}");
}

fn is_root() -> bool {
    tempfile::tempdir().is_ok_and(|folder| fs::metadata(folder.path()).unwrap().uid() == 0)
}

/// Runs a line of the shell in the folder, in which `$A` is the program; returns its exit code and what it said.
fn shell(folder: &Folder, shell: &str, line: &str) -> (Option<i32>, String) {
    let mut command = Command::new(shell);
    command.args(["-c", line]).env("A", env!("CARGO_BIN_EXE_arabesque")).current_dir(folder.path("."));
    let output = command.stdin(Stdio::null()).output().unwrap();
    (output.status.code(), stderr(&output))
}

#[test]
fn places_that_are_none_are_told_before_the_work() {
    let folder = Folder::new();
    symlink("nowhere/at/all", folder.path("dangling.svg")).unwrap();
    symlink("round.svg", folder.path("round.svg")).unwrap();
    let _socket = std::os::unix::net::UnixListener::bind(folder.path("socket.svg")).unwrap();
    for (out, words) in [
        ("dangling.svg", "leads nowhere"),
        ("round.svg", "round.svg"),
        ("socket.svg", "a socket"),
        ("new-folder/", "a folder"),
        (".", "a folder"),
    ] {
        let message = folder.fails(1, &format!("fill missing.svg --size 80x80 --format svg -o {out}"));
        assert!(message.contains("cannot write the result") && message.contains(words), "{message}");
    }
    for line in [
        "fill missing.svg --size 80x80 -o",
        "fill missing.svg --size 80x80 --variations 2 -o",
        "inspect missing.svg -o",
    ] {
        let output = folder.command(line).arg("").output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        assert!(stderr(&output).contains("empty name"), "{}", stderr(&output));
    }
}

#[test]
fn a_closed_or_full_standard_output_is_told() {
    let folder = Folder::new();
    for line in [
        "$A fill missing.svg --size 80x80 -o - >&-",
        "$A fill missing.svg --size 80x80 -o /dev/stdout >&-",
        "$A fill leaves.svg --size 80x80 -o a.svg --json >&-",
        "$A inspect leaves.svg >&-",
        "$A inspect leaves.svg --json >&-",
        "$A man >&-",
        "$A completions bash >&-",
        "$A fill leaves.svg --size 80x80 -o - >/dev/full",
        "$A fill leaves.svg --size 80x80 -o /dev/full --format svg",
        "$A inspect leaves.svg >/dev/full",
        "$A fill --help >/dev/full",
        "$A man >/dev/full",
    ] {
        let (code, message) = shell(&folder, "sh", line);
        assert_eq!(code, Some(1), "{line}: {message}");
        assert!(message.contains("standard output") || message.contains("/dev/full"), "{line}: {message}");
    }
    // To throw a result away is no mistake, however the null device was opened.
    for line in ["$A inspect leaves.svg 1<>/dev/null", "$A fill leaves.svg --size 80x80 -o - 1<>/dev/null"] {
        assert_eq!(shell(&folder, "sh", line).0, Some(0), "{line}");
    }
    assert_eq!(shell(&folder, "sh", "$A fill leaves.svg --size 80x80 -o - >/dev/null").0, Some(0));
    // Of a text people read as much as they like.
    assert_eq!(shell(&folder, "sh", "exec 3>&1; { $A man; echo $? >&3; } | true").1, "");
}

#[test]
fn names_of_standard_output_are_standard_output() {
    let folder = Folder::new();
    for out in ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"] {
        let (code, message) =
            shell(&folder, "sh", &format!("$A fill leaves.svg --size 80x80 -o {out} --format svg >got.svg"));
        assert_eq!(code, Some(0), "{message}");
        assert!(folder.text("got.svg").starts_with("<?xml") && folder.text("got.svg").ends_with("</svg>\n"));
    }
}

#[test]
fn what_is_no_regular_file_is_no_input() {
    let folder = Folder::new();
    if !Command::new("mkfifo").arg(folder.path("pipe.svg")).status().is_ok_and(|s| s.success()) {
        return skipped("no mkfifo here");
    }
    symlink("/dev/zero", folder.path("zero.svg")).unwrap();
    let _socket = std::os::unix::net::UnixListener::bind(folder.path("socket.svg")).unwrap();
    fs::create_dir(folder.path("folder.svg")).unwrap();
    folder.write("strip.png", common::strip());
    for (file, words) in [
        ("pipe.svg", "a named pipe"),
        ("zero.svg", "a device"),
        ("/dev/null", "a device"),
        ("socket.svg", "a socket"),
        ("folder.svg", "a folder"),
    ] {
        for line in [
            format!("fill {file} --size 80x80 -o a.svg"),
            format!("fill leaves.svg --domain {file} -o a.svg"),
            format!("fill leaves.svg --size 80x80 --keep {file} -o a.svg"),
            format!("fill leaves.svg --size 80x80 --scale {file} -o a.svg"),
            format!("ribbon strip.png --along {file} -o a.svg"),
            format!("run {file} -o a.svg"),
            format!("inspect {file}"),
        ] {
            let message = folder.fails(3, &line);
            assert!(message.contains(words) && message.contains(file), "{line}: {message}");
        }
    }
    // And where nobody reads, nothing is written.
    let message = folder.fails(1, "fill leaves.svg --size 80x80 -o pipe.svg");
    assert!(message.contains("nobody reads"), "{message}");
}

#[test]
fn what_the_caller_opened_is_read_once() {
    let folder = Folder::new();
    // Too large to travel in a recipe as a file does, and cannot be read again.
    folder
        .write("large.svg", common::ring().replace("</svg>", &format!("<desc>{}</desc></svg>", "x".repeat(1_100_000))));
    folder.ok("fill leaves.svg --domain ring.svg -o a.svg");
    for line in [
        "$A fill leaves.svg --domain /dev/stdin -o b.svg <ring.svg",
        "cat ring.svg | $A fill leaves.svg --domain /dev/stdin -o c.svg",
        "cat large.svg | $A fill leaves.svg --domain - --variations 2 -o d.svg",
        "$A fill leaves.svg --domain /dev/fd/7 -o e.svg 7<ring.svg",
    ] {
        let (code, message) = shell(&folder, "sh", line);
        assert_eq!(code, Some(0), "{line}: {message}");
    }
    let drawn = |name: &str| common::drawn(&folder.text(name)).to_owned();
    for name in ["b.svg", "c.svg", "d-1.svg", "e.svg"] {
        assert!(drawn(name) == drawn("a.svg"), "{name}");
    }
    if Command::new("bash").args(["-c", "true"]).status().is_err() {
        return skipped("no bash here");
    }
    for file in ["ring.svg", "large.svg"] {
        let (code, message) = shell(&folder, "bash", &format!("$A fill leaves.svg --domain <(cat {file}) -o p.svg"));
        assert_eq!(code, Some(0), "{message}");
        assert!(drawn("p.svg") == drawn("a.svg"));
        folder.ok("run p.svg -o again.svg");
        assert!(folder.read("p.svg") == folder.read("again.svg"));
    }
}

#[test]
fn a_missing_file_is_told_with_what_wanted_it() {
    let folder = Folder::new();
    for (line, words) in [
        ("fill gone.svg --size 80x80", "exemplar gone.svg: no such file"),
        ("fill leaves.svg --domain gone.svg", "--domain gone.svg: no such file"),
        ("fill leaves.svg --domain gone.svg#id", "--domain gone.svg: no such file"),
        ("fill leaves.svg --size 80x80 --keep gone.svg", "--keep gone.svg: no such file"),
        ("fill leaves.svg --size 80x80 --avoid gone.svg", "--avoid gone.svg: no such file"),
        ("fill leaves.svg --size 80x80 --orient gone.svg", "--orient gone.svg: no such file"),
        ("fill leaves.svg --size 80x80 --scale gone.png", "--scale gone.png: no such file"),
        ("fill leaves.svg --size 80x80 --density gone.png", "--density gone.png: no such file"),
        ("fill leaves.svg --redo gone.svg#a", "--redo gone.svg: no such file"),
        ("fill leaves.svg --from gone.svg#a --to 1,1,40,40", "--from gone.svg: no such file"),
        ("ribbon gone.png --along ring.svg", "exemplar gone.png: no such file"),
        ("ribbon leaves.svg --along gone.svg", "--along gone.svg: no such file"),
        ("run gone.toml", "recipe gone.toml: no such file"),
    ] {
        let message = folder.fails(3, &format!("{line} -o a.svg"));
        assert!(message.contains(words), "{line}: {message}");
    }
}

#[test]
fn the_longest_names_work() {
    let folder = Folder::new();
    let name = format!("{}.svg", "n".repeat(251));
    folder.ok(&format!("fill leaves.svg --size 80x80 -o {name}"));
    folder.ok(&format!("fill {name} --size 80x80 -o {name} --force"));
    assert_eq!(folder.names().iter().filter(|n| n.contains(".orig")).count(), 1);
    let (code, message) = shell(&folder, "sh", &format!("$A fill leaves.svg --size 80x80 -o n{name}"));
    assert_eq!(code, Some(1), "{message}");
}

#[test]
fn a_result_has_the_permissions_and_the_owner_of_what_it_replaces() {
    let folder = Folder::new();
    let again = || folder.ok("fill leaves.svg --size 80x80 -o a.svg");
    let metadata = || fs::metadata(folder.path("a.svg")).unwrap();
    let (code, message) = shell(&folder, "sh", "umask 027; $A fill leaves.svg --size 80x80 -o a.svg");
    assert_eq!(code, Some(0), "{message}");
    assert_eq!(metadata().mode() & 0o777, 0o640);
    for mode in [0o600, 0o664, 0o444 | 0o200] {
        fs::set_permissions(folder.path("a.svg"), fs::Permissions::from_mode(mode)).unwrap();
        again();
        assert_eq!(metadata().mode() & 0o777, mode);
    }
    if chown(folder.path("a.svg"), Some(12_345), Some(12_346)).is_err() {
        return skipped("files can be given to others by root alone");
    }
    again();
    assert_eq!((metadata().uid(), metadata().gid()), (12_345, 12_346));
}

#[test]
fn a_folder_without_rights_is_told_before_the_work() {
    let folder = Folder::new();
    fs::create_dir(folder.path("locked")).unwrap();
    fs::write(folder.path("locked/old.svg"), "").unwrap();
    for path in ["locked", "."] {
        fs::set_permissions(folder.path(path), fs::Permissions::from_mode(0o555)).unwrap();
    }
    for out in ["locked/a.svg", "locked/old.svg"] {
        let mut command = folder.command(&format!("fill missing.svg --size 80x80 -o {out}"));
        if is_root() {
            command.uid(65_534).gid(65_534);
        }
        let Ok(output) = command.output() else { return skipped("nobody may not run the program here") };
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        assert!(stderr(&output).contains("cannot write the result"), "{}", stderr(&output));
    }
    fs::set_permissions(folder.path("."), fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn a_full_disk_leaves_the_old_file_and_nothing_else() {
    let folder = Folder::new();
    fs::create_dir(folder.path("small")).unwrap();
    let mount =
        Command::new("mount").args(["-t", "tmpfs", "-o", "size=16k", "tmpfs"]).arg(folder.path("small")).output();
    if !mount.is_ok_and(|output| output.status.success()) {
        return skipped("no file system can be mounted here");
    }
    folder.ok("fill leaves.svg --size 40x40 -o small/a.svg");
    let before = folder.read("small/a.svg");
    let output = folder.run("fill leaves.svg --size 300x300 --iterations 0 -o small/a.svg");
    let names: Vec<_> = fs::read_dir(folder.path("small")).unwrap().map(|e| e.unwrap().file_name()).collect();
    let after = folder.read("small/a.svg");
    Command::new("umount").arg(folder.path("small")).status().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("cannot write the result"), "{}", stderr(&output));
    assert!(after == before && names == ["a.svg"], "{names:?}");
}

#[test]
fn links_that_were_planted_are_not_followed() {
    let folder = Folder::new();
    folder.write("precious", "precious");
    // Names that temporary files had, or could have.
    for name in [".a.svg.part", ".a.svg.1.part", ".arabesque-a.svg.part", "a.svg.part", "a.svg.orig", "a.svg.tmp"] {
        symlink("precious", folder.path(name)).unwrap();
    }
    folder.ok("fill leaves.svg --size 80x80 -o a.svg");
    folder.ok("fill a.svg --size 80x80 -o a.svg --force");
    assert_eq!(folder.text("precious"), "precious");
    assert!(folder.path("a.svg.orig").is_symlink() && !folder.path("a.svg.orig.1").is_symlink());
}
