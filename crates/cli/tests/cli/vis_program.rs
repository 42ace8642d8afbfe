//! `sightlines-vis` in the place of other programs of that kind.

use crate::common::Folder;
use crate::common::quake::{Map, rooms, row_of_leafs, small_maps};
use sightlines::formats::quake::visibility::{VisibilityLump, lump, read_hearing, read_visibility};
use sightlines::formats::quake::{Bsp, BspFormat, LeafClusters};
use sightlines::pvs::BitMatrix;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// How editors call their `vis`, `MAP` being the map without extension, and whether a coarse bound is asked for.
///
/// NetRadiant and its relatives name the source of the map, TrenchBroom's users write `${MAP_BASE_NAME}.bsp`, or no extension for Half-Life.
const CALLS: [(&str, &[&str], bool); 12] = [
    ("NetRadiant", &["MAP.map"], false),
    ("NetRadiant, fast", &["-fast", "MAP.map"], true),
    ("NetRadiant, full", &["-level", "4", "MAP.map"], false),
    ("TrenchBroom, Quake", &["MAP.bsp"], false),
    ("TrenchBroom, Quake, full", &["-level", "4", "MAP.bsp"], false),
    ("TrenchBroom, Quake, fast", &["-fast", "MAP.bsp"], true),
    ("TrenchBroom, Half-Life", &["MAP"], false),
    ("TrenchBroom, Half-Life, full", &["-full", "MAP"], false),
    ("q1compile, fast", &["-fast", "MAP.bsp"], true),
    ("q1compile, full", &["-level", "4", "MAP.bsp"], false),
    ("threads", &["-threads", "2", "-v", "--level", "0", "MAP.bsp"], false),
    ("behind the map", &["MAP.bsp", "-noverbose", "-FAST", "-log", "-nolog"], true),
];

/// A folder with a map as an editor leaves it; the name has a space and letters that ASCII lacks.
fn with(map: &Map) -> Folder {
    let folder = Folder::new();
    folder.write("Größe 1.map", "// the source");
    folder.write("Größe 1.bsp", &map.bsp);
    folder.write("Größe 1.prt", &map.prt);
    folder
}

/// How a map is named: by a name in the folder, or by the whole path.
const IS_WHOLE: [bool; 2] = [false, true];

/// Every call gives the bytes of `sightlines vis`, and leaves nothing else behind. How many calls there were.
///
/// * `is_wanted`: whether the call of this number is made by this name of the map
fn check_calls(map: &Map, calls: &[(&str, &[&str], bool)], is_wanted: impl Fn(usize, bool) -> bool) -> usize {
    let folder = with(map);
    let [exact, fast] = [&[][..], &["--fast"]].map(|more| {
        folder.run(&[&["vis", "Größe 1.bsp", "-o", "reference.bsp"], more].concat()).expect(0);
        folder.read("reference.bsp")
    });
    let here = folder.path("");
    let mut n_calls = 0;
    for (k, &(editor, args, is_fast)) in calls.iter().enumerate() {
        for is_whole in IS_WHOLE.into_iter().filter(|&is_whole| is_wanted(k, is_whole)) {
            let base = if is_whole { here.join("Größe 1") } else { PathBuf::from("Größe 1") };
            folder.write("Größe 1.bsp", &map.bsp);
            let base = base.to_str().expect("a path in UTF-8");
            let args: Vec<String> = args.iter().map(|arg| arg.replace("MAP", base)).collect();
            let args: Vec<&str> = args.iter().map(String::as_str).collect();
            let run = folder.run_vis(&args).expect(0);
            let expected = if is_fast { &fast } else { &exact };
            assert!(folder.read("Größe 1.bsp") == *expected, "{}: {editor}", map.name);
            assert_eq!(run.err, "", "{}: {editor}", map.name);
            // Editors look for this word.
            assert!(!run.out.to_lowercase().contains("error"), "{}", run.out);
            assert!(run.out.starts_with("---- sightlines-vis ") && run.out.contains("\nelapsed    "), "{}", run.out);
            n_calls += 1;
        }
    }
    assert_eq!(folder.names(), ["Größe 1.bsp", "Größe 1.map", "Größe 1.prt", "reference.bsp"]);
    n_calls
}

#[test]
fn editors_get_the_bytes_of_the_other_program() {
    let mut n_calls = check_calls(&rooms(5, 4), &CALLS, |_, _| true);
    // Each call is made on every fourth of the small maps of a format, by the names in turn.
    let mut made = BTreeMap::<String, BTreeSet<usize>>::new();
    for (m, map) in small_maps().into_iter().enumerate() {
        let is_wanted = |k: usize, is_whole: bool| (m + k).is_multiple_of(4) && (m / 4 % 2 == 1) == is_whole;
        n_calls += check_calls(&map, &CALLS, is_wanted);
        let wanted = (0..CALLS.len()).filter(|&k| IS_WHOLE.iter().any(|&is_whole| is_wanted(k, is_whole)));
        made.entry(format!("{:?}", map.format)).or_default().extend(wanted);
    }
    assert!(made.len() == BspFormat::ALL.len() && made.values().all(|calls| calls.len() == CALLS.len()), "{made:?}");
    assert!(n_calls > 200, "{n_calls}");
}

#[test]
fn real_maps_get_the_bytes_of_the_other_program() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA") else {
        eprintln!("SKIPPED real_maps_get_the_bytes_of_the_other_program: SIGHTLINES_DATA is not set");
        return;
    };
    // All calls on a small one of them, two on a larger one.
    for (name, format, calls) in
        [("dm3", BspFormat::Bsp29, &CALLS[..]), ("base1-test", BspFormat::Quake2, &CALLS[1..3])]
    {
        let read = |extension| std::fs::read(Path::new(&data).join("quake").join(name).with_extension(extension));
        let prt = String::from_utf8(read("prt").expect("portals")).expect("text");
        let map = Map { name: name.to_owned(), format, bsp: read("bsp").expect("a map"), prt };
        check_calls(&map, calls, |_, _| true);
    }
}

/// Lines about the map, by their first words, as they are printed with some options.
#[test]
fn options_choose_what_is_printed() {
    let folder = with(&rooms(3, 3));
    let heads = |args: &[&str]| -> Vec<String> {
        let run = folder.run_vis(&[args, &["Größe 1.bsp"]].concat()).expect(0);
        assert_eq!(run.err, "");
        run.out.lines().map(|line| line.split_whitespace().next().unwrap_or_default().to_owned()).collect()
    };
    let all = ["----", "map", "portals", "counts", "computing", "pairs", "wrote", "elapsed"];
    assert_eq!(heads(&[]), all);
    assert_eq!(heads(&["-nopercent", "-nocolor"]), all);
    assert_eq!(heads(&["-nostat"]), ["----", "map", "portals", "computing", "wrote", "elapsed"]);
    assert_eq!(heads(&["-noprogress"]), ["----", "counts", "pairs", "wrote", "elapsed"]);
    for quiet in ["-quiet", "-noverbose"] {
        assert_eq!(heads(&[quiet]), ["----", "wrote", "elapsed"]);
    }
    assert!(heads(&["-verbose"]).len() > all.len());
    // What has no effect is said in a line each, unless nothing is to be said.
    let idle =
        ["-visdist", "200", "-targetchecks", "5", "-gamedir", "id1", "-basedir", "/quake", "-path", "a", "-path", "b"];
    let noted = heads(&idle);
    assert_eq!(noted.iter().filter(|head| *head == "note").count(), 4, "{noted:?}");
    assert!(noted.contains(&"wishes".to_owned()));
    assert_eq!(heads(&[&idle[..], &["-quiet"]].concat()), ["----", "wishes", "wrote", "elapsed"]);
}

#[test]
fn a_log_has_what_is_printed() {
    let folder = with(&rooms(3, 3));
    let run = folder.run_vis(&["-log", "Größe 1.map"]).expect(0);
    assert_eq!(String::from_utf8(folder.read("Größe 1-vis.log")).expect("text"), run.out);
    // Warnings and errors too, after which the log of another run is gone.
    folder.write("Größe 1.bsp.state", "precious");
    let run = folder.run_vis(&["-log", "Größe 1.map"]).expect(0);
    assert_eq!(folder.read("Größe 1.bsp.state"), b"precious");
    let log = String::from_utf8(folder.read("Größe 1-vis.log")).expect("text");
    assert!(
        run.err.contains("this is no file of results of units; the results of this run are not kept"),
        "{}",
        run.err
    );
    assert!(log.contains(run.err.trim()) && log.contains("elapsed"), "{log}");
    std::fs::remove_file(folder.path("Größe 1.prt")).expect("a file");
    let run = folder.run_vis(&["-log", "Größe 1.map"]).expect(2);
    let log = String::from_utf8(folder.read("Größe 1-vis.log")).expect("text");
    assert!(log.ends_with(&run.err) && run.err.starts_with("error: Größe 1.bsp: "), "{log}");
}

/// What the visible leafs of a map are loud of.
fn ambient(bytes: Vec<u8>) -> Vec<[u8; 4]> {
    Bsp::parse(bytes).expect("a sound map").visible_leafs().iter().map(|leaf| leaf.ambient).collect()
}

#[test]
fn sounds_are_turned_off() {
    let map = rooms(4, 3);
    let folder = with(&map);
    let heard = |args: &[&str]| {
        folder.run_vis(&[args, &["Größe 1.bsp"]].concat()).expect(0);
        ambient(folder.read("Größe 1.bsp"))
    };
    let all = heard(&[]);
    // Rooms with a sky, and others.
    assert!(all.iter().any(|levels| levels[1] == 255), "{all:?}");
    let without = |places: &[usize]| -> Vec<[u8; 4]> {
        let silent = |levels: &[u8; 4]| std::array::from_fn(|k| if places.contains(&k) { 0 } else { levels[k] });
        all.iter().map(silent).collect()
    };
    assert_eq!(heard(&["-noambientsky"]), without(&[1]));
    assert_ne!(all, without(&[1]));
    for others in [&["-noambientlava"][..], &["-noambientslime", "-noambientwater"]] {
        assert_eq!(heard(others), all, "there is nothing of that kind");
    }
    assert_eq!(heard(&["-noambient"]), without(&[0, 1, 2, 3]));
    assert_eq!(heard(&["-noambient", "0"]), all);
    // The same of the other program.
    for (args, silence) in [("-noambientsky", "sky"), ("-noambient", "sky,water,slime,lava")] {
        folder.run_vis(&[args, "Größe 1.bsp"]).expect(0);
        folder.run(&["vis", "Größe 1.bsp", "--silence", silence, "-o", "other.bsp"]).expect(0);
        assert!(folder.read("Größe 1.bsp") == folder.read("other.bsp"), "{args}");
    }
    folder.run(&["vis", "Größe 1.bsp", "--silence", "thunder"]).expect(2);
}

/// A state is kept, found and used if it fits, else put aside; without states none is touched.
#[test]
fn states_are_used_if_they_fit() {
    let (map, other) = (rooms(4, 3), rooms(3, 3));
    let folder = with(&map);
    folder.run_vis(&["Größe 1"]).expect(0);
    let done = folder.read("Größe 1.bsp");
    let name = "Größe 1.bsp.state";
    let kept = || folder.path(name).exists().then(|| folder.read(name));
    assert_eq!(kept(), None, "nothing is left of a run that ended");
    folder.run_vis(&["-noautoclean", "Größe 1"]).expect(0);
    let state = kept().expect("it is kept");
    assert!(state.starts_with(b"SLUNITS\n"));
    let again = |args: &[&str]| {
        folder.write("Größe 1.bsp", &map.bsp);
        folder.run_vis(&[args, &["Größe 1"]].concat()).expect(0)
    };
    // It has all results: another run has nothing left to do.
    let run = again(&["-noautoclean"]);
    assert!(run.out.contains("resumed    ") && run.err.is_empty() && folder.read("Größe 1.bsp") == done, "{}", run.out);
    assert_eq!(kept(), Some(state.clone()));
    let run = again(&["-nostate"]);
    assert!(!run.out.contains("resumed") && run.err.is_empty() && folder.read("Größe 1.bsp") == done);
    assert_eq!(kept(), Some(state.clone()), "it is left alone");
    assert!(again(&[]).out.contains("resumed") && kept().is_none());
    // Of other portals, of other options, of the kind of another version: not used, and left alone by a run that keeps nothing.
    let with_other = with(&other);
    with_other.run_vis(&["-noautoclean", "Größe 1"]).expect(0);
    again(&["-fast", "-noautoclean"]);
    let fast = kept().expect("it is kept");
    let (other_form, before) = (b"\x8ESLVIS\r\n\x01\0\0\0".to_vec(), "Größe 1.bsp.state.before");
    for (bytes, what) in [
        (with_other.read(name), "the results are of another input or of other options"),
        (fast, "the results are of another input or of other options"),
        (other_form, "the file has the form of another version of the program"),
    ] {
        folder.write(name, &bytes);
        let run = again(&[]);
        assert!(
            run.err.contains(what) && run.err.contains("; beginning anew") && run.err.lines().count() == 1,
            "{}",
            run.err
        );
        assert!(!run.out.contains("resumed") && folder.read("Größe 1.bsp") == done && kept() == Some(bytes.clone()));
        // One that keeps results puts it aside.
        let run = again(&["-save-after", "0"]);
        assert!(run.err.contains(what) && folder.read("Größe 1.bsp") == done && kept().is_none(), "{}", run.err);
        assert_eq!(folder.read(before), bytes);
    }
    // Damaged: the rest is used, and what is lost is computed again.
    let mut damaged = state.clone();
    *damaged.last_mut().expect("bytes") ^= 4;
    folder.write(name, &damaged);
    let run = again(&["-noautoclean"]);
    assert!(run.err.contains("1 record damaged; the rest is used") && run.out.contains("resumed"), "{}", run.err);
    assert!(folder.read("Größe 1.bsp") == done && kept().is_some_and(|kept| kept.len() > damaged.len()));
    // Cut off, as a run leaves it that is killed while it writes.
    folder.write(name, &state[..state.len() - 1]);
    let run = again(&[]);
    assert!(run.err.is_empty() && run.out.contains("resumed"), "{}", run.err);
    assert!(folder.read("Größe 1.bsp") == done && kept().is_none());
}

/// Killed while it works and called again as before, it continues, and ends with the same bytes.
#[cfg(unix)]
#[test]
fn a_killed_run_is_resumed_by_itself() {
    let map = rooms(12, 10);
    let folder = with(&map);
    folder.run(&["vis", "Größe 1.bsp", "-o", "reference.bsp"]).expect(0);
    let args = ["-save-after", "0", "-quiet", "Größe 1"];
    let (mut n_killed, mut n_kept) = (0, 0);
    for wait in (0..60).map(|k| std::time::Duration::from_millis(2 * k)) {
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_sightlines-vis"))
            .args(args)
            .current_dir(folder.path("."))
            .stdout(std::process::Stdio::null())
            .spawn()
            .expect("the program was built");
        std::thread::sleep(wait);
        child.kill().expect("a child can be killed");
        let has_ended = child.wait().expect("a child ends").code() == Some(0);
        let now = folder.read("Größe 1.bsp");
        assert!(now == map.bsp || now == folder.read("reference.bsp"), "the map is the old one or the new one");
        n_killed += usize::from(!has_ended);
        n_kept += usize::from(folder.path("Größe 1.bsp.state").exists());
        if has_ended {
            break;
        }
    }
    assert!(n_killed > 0);
    let run = folder.run_vis(&["-save-after", "0", "Größe 1"]).expect(0);
    assert!(folder.read("Größe 1.bsp") == folder.read("reference.bsp"));
    eprintln!("{n_killed} killed, {n_kept} times with a state; {}", run.out);
}

/// What is heard in a map of Quake II is made from what it has as visible, which stays.
#[test]
fn hearing_alone_is_made_anew() {
    let map = row_of_leafs(BspFormat::Quake2);
    let folder = with(&map);
    let refused = |what: &str| {
        let before = folder.read("Größe 1.bsp");
        let run = folder.run_vis(&["-phsonly", "Größe 1"]).expect(2);
        assert!(run.err.starts_with("error: Größe 1.bsp: ") && run.err.contains(what), "{}", run.err);
        assert_eq!(folder.read("Größe 1.bsp"), before);
    };
    refused("the map has no visibility yet");
    folder.run_vis(&["Größe 1"]).expect(0);
    let whole = Bsp::parse(folder.read("Größe 1.bsp")).expect("a sound map");
    // Less is visible, and everything heard: the first row of the one stands for all rows of the other.
    let leafs = LeafClusters::identity(3).expect("three clusters");
    let less = lump(&whole, &leafs, &BitMatrix::identity(3)).expect("a lump");
    let deaf = whole.with_visibility(&less).expect("a small map");
    let mut loud = less.bytes.clone();
    loud.push(0b111);
    for cluster in 0..3 {
        let heard = (less.bytes.len() as u32).to_le_bytes();
        loud[4 + 8 * cluster + 4..][..4].copy_from_slice(&heard);
    }
    let loud = whole.with_visibility(&VisibilityLump { bytes: loud, ..less }).expect("a small map");
    let n_heard = |bytes: &[u8]| read_hearing(&Bsp::parse(bytes.to_vec()).unwrap()).unwrap().unwrap().count_ones();
    assert_eq!((n_heard(&loud), n_heard(&deaf)), (9, 3));
    folder.write("Größe 1.bsp", &loud);
    // Portals are not needed.
    std::fs::remove_file(folder.path("Größe 1.prt")).expect("a file");
    let run = folder.run_vis(&["-phsonly", "Größe 1"]).expect(0);
    assert!(folder.read("Größe 1.bsp") == deaf && run.out.contains("wrote "), "{}", run.out);
    let seen = read_visibility(&Bsp::parse(deaf).unwrap(), &leafs).unwrap().unwrap();
    assert_eq!(seen, BitMatrix::identity(3));
    folder.write("Größe 1.bsp", rooms(2, 2).bsp);
    refused("-phsonly is for Quake II");
}

/// Other programs go first, where the system has a way to say so; the answer is the same.
#[test]
fn low_priority_changes_no_byte() {
    let folder = with(&rooms(3, 3));
    folder.run(&["vis", "Größe 1.bsp", "-o", "reference.bsp"]).expect(0);
    let run = folder.run_vis(&["-lowpriority", "Größe 1"]).expect(0);
    assert!(folder.read("Größe 1.bsp") == folder.read("reference.bsp") && run.err.is_empty());
    let path = Command::new(env!("CARGO_BIN_EXE_sightlines-vis"))
        .args(["-lowpriority", "Größe 1"])
        .env("PATH", folder.path("."))
        .current_dir(folder.path("."))
        .output()
        .expect("the program was built");
    let out = String::from_utf8_lossy(&path.stdout);
    assert!(path.status.success() && out.contains("note       -lowpriority has no effect: "), "{out}");
    assert!(!out.to_lowercase().contains("error"), "{out}");
}

#[test]
fn help_and_version_are_printed() {
    let folder = Folder::new();
    for option in ["-h", "-help", "--help", "-?"] {
        let help = folder.run_vis(&[option]).expect(0).out;
        assert!(help.contains("Usage: sightlines-vis [OPTIONS] <MAP>") && help.contains("--noambientsky"), "{help}");
        assert!(!help.contains("--save-after"), "{help}");
    }
    let version = folder.run_vis(&["-version"]).expect(0).out;
    assert_eq!(version, format!("sightlines-vis {}\n", env!("CARGO_PKG_VERSION")));
}

/// A program that calls this one may stop to read what it prints, and still gets its map.
#[test]
fn a_closed_pipe_is_no_reason_to_give_up_the_map() {
    let folder = Folder::new();
    let map = rooms(3, 2);
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &map.prt);
    folder.write("other.bsp", &map.bsp);
    folder.write("other.prt", &map.prt);
    folder.run_vis(&["other"]).expect(0);
    let mut command = Command::new(env!("CARGO_BIN_EXE_sightlines-vis"));
    let mut child = command.arg("map").current_dir(folder.path(".")).stdout(Stdio::piped()).spawn().expect("a program");
    drop(child.stdout.take());
    assert!(child.wait().expect("it ends").success());
    assert!(folder.read("map.bsp") == folder.read("other.bsp") && folder.read("map.bsp") != map.bsp);
}

/// What cannot be saved or read beside a map is a warning, without the word that editors look for.
#[test]
fn warnings_do_not_have_the_word_for_failures() {
    let folder = Folder::new();
    let map = rooms(3, 2);
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &map.prt);
    std::fs::create_dir(folder.path("map.bsp.state")).expect("a folder");
    let run = folder.run_vis(&["map"]).expect(0);
    let text = (run.out + &run.err).to_lowercase();
    assert!(text.contains("the results of this run are not kept") && !text.contains("error"), "{text}");
    // An empty state is none.
    std::fs::remove_dir(folder.path("map.bsp.state")).expect("a folder");
    folder.write("map.bsp.state", b"");
    let run = folder.run_vis(&["map"]).expect(0);
    assert!(run.err.is_empty() && !run.out.contains("resumed"), "{}{}", run.out, run.err);
}
