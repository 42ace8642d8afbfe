//! Folders that refuse files, disks without room, and names that are no plain text.

#![cfg(unix)]

use crate::common::quake::rooms;
use crate::common::{Folder, Run};
use std::ffi::{OsStr, OsString};
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::PermissionsExt;
use std::process::Command;

const SIGHTLINES: &str = env!("CARGO_BIN_EXE_sightlines");
const VIS: &str = env!("CARGO_BIN_EXE_sightlines-vis");

/// What every command that writes a file starts from, in a folder that an output may be in too.
fn inputs() -> Folder {
    let folder = Folder::with_tower();
    let office = Folder::with_office();
    for name in ["office.geojson", "office.pvs"] {
        folder.write(name, office.read(name));
    }
    folder.write("maps.wad", crate::common::wad(&["MAP01"]));
    let map = rooms(4, 3);
    folder.write("map.bsp", map.bsp);
    folder.write("map.prt", map.prt);
    folder.run(&["pack", "office.pvs", "-o", "office.pvz"]).expect(0);
    folder
}

/// Commands with the name of a file that they write last; they write nothing else.
const COMMANDS: [&[&str]; 17] = [
    &["build", "office.geojson", "-o", "out.pvs"],
    &["build", "tower.glb", "-o", "out.pvs"],
    &["reject", "maps.wad", "-o", "out.wad"],
    &["vis", "map.bsp", "-o", "out.bsp"],
    &["walk", "office.pvs", "--random", "5", "-o", "out.svg"],
    &["pack", "office.pvs", "-o", "out.pvz"],
    &["unpack", "office.pvz", "-o", "out.pvs"],
    &["export", "office.pvs", "-o", "out.json"],
    &["explain", "office.pvs", "0", "0", "--draw", "out.svg"],
    &["draw", "office.pvs", "-o", "out.svg"],
    &["view", "office.pvs", "-o", "out.html"],
    &["multifocal", "tower.glb", "--volume", "0,0,0,1,1,1", "--plane", "x=9", "-o", "out.png"],
    &[
        "light",
        "tower.glb",
        "--eye",
        "9,1.7,5",
        "--look-at",
        "5,1,5",
        "--light",
        "4,2,4,5,2.2,5",
        "--size",
        "16x16",
        "-o",
        "out.png",
    ],
    &[
        "render",
        "tower.glb",
        "--eye",
        "9,1.7,5",
        "--look-at",
        "5,1,5",
        "--method",
        "zbuffer",
        "--size",
        "16x16",
        "-o",
        "out.png",
    ],
    &["simplify", "tower.glb", "--volume", "9,1,5,9.5,1.5,5.5", "-o", "out.glb"],
    &["strip", "tower.glb", "--from", "tower.pvs", "--effort", "0", "-o", "out.glb"],
    &["generate", "tower", "--floors", "1", "-o", "out.glb"],
];

/// Runs a program for which each file is full before its first byte.
fn without_room(folder: &Folder, program: &str, args: &[&str]) -> Run {
    // The signal of a file that is too large would end the process; ignored, it is the error that a full disk gives.
    let script = "trap '' XFSZ; ulimit -f 0; exec \"$@\"";
    folder.run_command(Command::new("sh").args(["-c", script, "sh", program]).args(args))
}

/// A run that fails, with a last line that names a file, for a reason.
fn assert_refused(run: Run, name: &str, why: &str, args: &[&str]) {
    let Run { err, .. } = run.expect(2);
    let start = format!("error: {name}: cannot be written: ");
    let last = err.lines().last().unwrap_or_default();
    assert!(last.starts_with(&start) && last.contains(why), "{args:?}: {err}");
}

/// Each command that writes a file fails on a full disk, and leaves the old file as it was, and nothing beside it.
#[test]
fn a_full_disk_destroys_nothing() {
    let folder = inputs();
    let names = folder.names();
    for args in COMMANDS {
        let out = args.last().expect("an output");
        folder.write(out, "precious");
        assert_refused(without_room(&folder, SIGHTLINES, args), out, "File too large", args);
        assert_eq!(folder.read(out), b"precious", "{args:?}");
        fs::remove_file(folder.path(out)).expect("a file");
        assert_eq!(folder.names(), names, "{args:?}");
        // There is nothing wrong with the command.
        let run = folder.run(args);
        assert!(run.code == 0 && folder.path(out).is_file(), "{args:?}: {}", run.err);
        fs::remove_file(folder.path(out)).expect("a file");
    }
    // Maps that are replaced.
    let map = folder.read("map.bsp");
    for (program, args) in [(SIGHTLINES, &["vis", "map.bsp"][..]), (VIS, &["map"]), (VIS, &["map.map", "-fast"])] {
        assert_refused(without_room(&folder, program, args), "map.bsp", "File too large", args);
        assert_eq!((folder.read("map.bsp"), folder.names()), (map.clone(), names.clone()), "{args:?}");
    }
    // A state that finds no room is reported, and is no reason to stop before the map is written.
    let run = without_room(&folder, VIS, &["-save-after", "0", "map"]).expect(2);
    assert!(
        run.err.contains("map.bsp.state: cannot be written: ") && run.err.contains("cannot go on from there"),
        "{}",
        run.err
    );
    assert_eq!((folder.read("map.bsp"), folder.names()), (map, names));
}

/// The same on a disk that is really full: a small one in memory, where that can be had.
#[test]
fn a_disk_without_room_destroys_nothing() {
    let folder = Folder::new();
    let map = rooms(12, 10);
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &map.prt);
    fs::create_dir(folder.path("full")).expect("a folder");
    let script = "mount -t tmpfs -o size=512k none full 2>/dev/null || exit 77
        cp map.bsp map.prt full && cd full || exit 78
        cat /dev/zero > filler 2>/dev/null
        before=$(ls -A)
        \"$@\"; code=$?
        cmp map.bsp ../map.bsp && [ \"$(ls -A)\" = \"$before\" ] || exit 79
        exit $code";
    for (program, args) in [(SIGHTLINES, &["vis", "map.bsp"][..]), (VIS, &["map"])] {
        let mut own = Command::new("unshare");
        own.args(if is_root() { &["-m"][..] } else { &["-r", "-m"] });
        own.args(["sh", "-c", script, "sh", program]).args(args).env("LC_ALL", "C").current_dir(folder.path("."));
        let output = match own.output() {
            Ok(output) if output.status.code() != Some(77) && output.status.code() != Some(1) => output,
            _ => {
                eprintln!("SKIPPED a_disk_without_room_destroys_nothing: no disk in memory can be had here");
                return;
            }
        };
        let err = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{err}");
        assert!(err.starts_with("error: map.bsp: cannot be written: No space left on device"), "{err}");
    }
}

fn is_root() -> bool {
    Command::new("id").arg("-u").output().is_ok_and(|id| id.stdout == b"0\n")
}

/// A program, for whoever is not the owner of everything; `None` if there is no way.
fn as_nobody(folder: &Folder, program: &str) -> Option<Vec<OsString>> {
    if !is_root() {
        return Some(vec![program.into()]);
    }
    // Where the program was built may be closed to others.
    let copy = folder.path(if program == VIS { "sightlines-vis" } else { "sightlines" });
    fs::copy(program, &copy).expect("a copy");
    fs::set_permissions(folder.path("."), PermissionsExt::from_mode(0o755)).expect("it is ours");
    let setpriv = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", "--"].map(OsString::from);
    let works = Command::new(&setpriv[0]).args(&setpriv[1..]).arg(&copy).arg("--version").output();
    works.is_ok_and(|output| output.status.success()).then(|| setpriv.into_iter().chain([copy.into()]).collect())
}

/// Each command that writes a file fails at once in a folder that refuses files; also the programs whose map is there.
#[test]
fn a_folder_that_refuses_files_is_reported() {
    let folder = inputs();
    fs::create_dir(folder.path("shut")).expect("a folder");
    for name in ["map.bsp", "map.prt"] {
        fs::copy(folder.path(name), folder.path("shut").join(name)).expect("a copy");
    }
    let map = folder.read("map.bsp");
    let [Some(sightlines), Some(vis)] = [SIGHTLINES, VIS].map(|program| as_nobody(&folder, program)) else {
        eprintln!(
            "SKIPPED a_folder_that_refuses_files_is_reported: root may write everywhere, and setpriv is not to be had"
        );
        return;
    };
    let is_shut = |shut: bool| {
        let mode = if shut { 0o555 } else { 0o755 };
        fs::set_permissions(folder.path("shut"), PermissionsExt::from_mode(mode)).expect("it is ours");
    };
    is_shut(true);
    let run = |program: &[OsString], args: &[&str]| {
        folder.run_command(Command::new(&program[0]).args(&program[1..]).args(args))
    };
    for args in COMMANDS {
        let (last, rest) = args.split_last().expect("an output");
        let out = format!("shut/{last}");
        let args = [rest, &[&out]].concat();
        assert_refused(run(&sightlines, &args), &out, "Permission denied", &args);
    }
    for (program, args) in
        [(&sightlines, &["vis", "shut/map.bsp"][..]), (&vis, &["shut/map.map"]), (&vis, &["-fast", "shut/map"])]
    {
        assert_refused(run(program, args), "shut/map.bsp", "Permission denied", args);
    }
    let log = run(&vis, &["-log", "shut/map"]).expect(2).err;
    assert!(log.starts_with("error: shut/map-vis.log: the log cannot be written: "), "{log}");
    assert_eq!(crate::common::names(&folder.path("shut")), ["map.bsp", "map.prt"]);
    assert_eq!(folder.read("shut/map.bsp"), map);
    is_shut(false);
}

/// Maps whose names are no text in UTF-8, have line ends in them, or begin as an option does.
#[test]
fn names_may_be_anything() {
    let map = rooms(3, 2);
    let folder = Folder::new();
    folder.write("plain.bsp", &map.bsp);
    folder.write("plain.prt", &map.prt);
    folder.run(&["vis", "plain.bsp"]).expect(0);
    let done = folder.read("plain.bsp");
    for name in [&b"k\xFCche"[..], b"two\nlines", "\u{1F3E0} \u{202E}x".as_bytes(), b"a'b\"c $d", b"./-level 4"] {
        let file =
            |extension: &str| folder.path(".").join(OsStr::from_bytes(&[name, b".", extension.as_bytes()].concat()));
        for (program, command) in [(SIGHTLINES, &["vis"][..]), (VIS, &[])] {
            fs::write(file("bsp"), &map.bsp).expect("a file");
            fs::write(file("prt"), &map.prt).expect("a file");
            let run = folder.run_command(Command::new(program).args(command).arg(file("bsp"))).expect(0);
            assert!(fs::read(file("bsp")).expect("a map") == done && run.err.is_empty(), "{}", run.err);
            fs::remove_file(file("prt")).expect("a file");
            let run = folder.run_command(Command::new(program).args(command).arg(file("bsp"))).expect(2);
            assert!(run.err.contains("no portals can be made from the map"), "{}", run.err);
        }
    }
}
