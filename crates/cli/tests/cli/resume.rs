//! Builds that are stopped, and go on.

use crate::common::{Folder, small_tower};
use sightlines::checkpoint::{Journal, Key, OpenMode};
use sightlines::progress::UnitStore;
use std::process::{Child, Command, Stdio};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

/// A build of some seconds in 48 units, with its results in a file from the first one on.
const BUILD: [&str; 15] = [
    "build",
    "tower.glb",
    "--method",
    "multifocal",
    "--grid",
    "6,4,2",
    "--planes",
    "3",
    "--threads",
    "1",
    "-q",
    "--save-after",
    "0",
    "-o",
    "out.pvs",
];
const STATE: &str = "out.pvs.state";

fn start(folder: &Folder, args: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sightlines"));
    command.args(args).current_dir(folder.path(".")).stdout(Stdio::null()).stderr(Stdio::piped());
    command.spawn().expect("the program was built")
}

/// The folder with the scene, the bytes of a build that nobody stopped, and how long that took.
fn scene() -> (Folder, Vec<u8>, Duration) {
    static WHOLE: LazyLock<(Vec<u8>, Duration)> = LazyLock::new(|| {
        let folder = Folder::new();
        folder.write("tower.glb", small_tower());
        let begin = Instant::now();
        folder.run(&BUILD).expect(0);
        let took = begin.elapsed();
        assert_eq!(folder.names(), ["out.pvs", "tower.glb"], "a build that is done leaves no state");
        (folder.read("out.pvs"), took)
    });
    let folder = Folder::new();
    folder.write("tower.glb", small_tower());
    let (whole, took) = WHOLE.clone();
    (folder, whole, took)
}

/// The results in a state, which has to be sound.
fn journal(folder: &Folder) -> Journal {
    let bytes = folder.read(STATE);
    let key = Key(*bytes[12..28].first_chunk().unwrap());
    Journal::open(&folder.path(STATE), key, env!("CARGO_PKG_VERSION"), OpenMode::Resume, Duration::ZERO).unwrap()
}

/// Killed six times at moments of chance, every other time once it has more results, and taken up each time, a build ends with the bytes of one that was left alone.
#[test]
fn a_build_that_is_killed_again_and_again_loses_nothing() {
    let (folder, whole, took) = scene();
    let resumed = [&BUILD[..], &["--resume"]].concat();
    let (mut seed, mut n_kills, mut n_before) = (1_u64, 0, 0);
    let mut kept = Vec::new();
    while n_kills < 6 {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let n_bytes = || std::fs::metadata(folder.path(STATE)).map_or(0, |state| state.len());
        let least = if n_kills % 2 == 1 { n_bytes() + 1000 } else { 0 };
        let mut child = start(&folder, &resumed);
        while n_bytes() < least && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(took.mul_f64((seed >> 40) as f64 / (1 << 24) as f64 * 0.3));
        child.kill().expect("a child can be killed");
        if child.wait().expect("a child ends").code().is_some() {
            // It was faster; another build begins.
            assert!(folder.read("out.pvs") == whole);
            std::fs::remove_file(folder.path("out.pvs")).unwrap();
            n_before = 0;
            continue;
        }
        n_kills += 1;
        assert!(!folder.path("out.pvs").exists(), "an output appears as a whole");
        let n = if folder.path(STATE).exists() { journal(&folder).n_taken_up() } else { 0 };
        assert!(n >= n_before, "{n} results, of {n_before}");
        n_before = n;
        kept.push(n);
    }
    eprintln!("results after each kill: {kept:?}, of 48");
    assert!(kept.iter().any(|&n| n > 0) || cfg!(not(unix)));
    folder.run(&resumed).expect(0);
    assert!(folder.read("out.pvs") == whole);
    assert_eq!(folder.names(), ["out.pvs", "tower.glb"]);
}

/// Builds with proofs, which are killed whenever they have kept as much again, go on with what they have, and end with the same bytes.
#[test]
fn proofs_are_kept_piece_by_piece() {
    let folder = crate::jobs::inputs();
    folder.write("office.geojson", Folder::with_office().read("office.geojson"));
    for input in ["tower.glb", "office.geojson", "map.prt"] {
        let mut n_anew = 0;
        let build = ["build", input, "-o", "out.pvs", "--certify", "-q", "--save-after", "0", "--resume"];
        folder.run(&build).expect(0);
        let outputs = ["out.pvs", "out.cert"];
        let whole = outputs.map(|name| folder.read(name));
        outputs.iter().for_each(|name| std::fs::remove_file(folder.path(name)).unwrap());
        let n_bytes = || std::fs::metadata(folder.path(STATE)).map_or(0, |state| state.len());
        let (step, mut n_kills, mut n_before) = (whole[1].len() as u64 / 8, 0, 0);
        // One that is done before it is killed twice begins anew: how fast it is, depends on the machine.
        while (n_kills < 2 && cfg!(unix)) || !folder.path("out.cert").exists() {
            if folder.path("out.cert").exists() {
                outputs.iter().for_each(|name| std::fs::remove_file(folder.path(name)).unwrap());
                (n_kills, n_before, n_anew) = (0, 0, n_anew + 1);
                assert!(n_anew < 100, "{input}: it was always over before it could be killed twice");
            }
            let (mut child, least) = (start(&folder, &build), n_bytes() + step);
            while child.try_wait().unwrap().is_none() && n_bytes() < least {
                std::thread::sleep(Duration::from_millis(1));
            }
            child.kill().unwrap();
            if child.wait().unwrap().code().is_none() && folder.path(STATE).exists() {
                let n = journal(&folder).n_taken_up();
                assert!(n > n_before, "{n} results, of {n_before}");
                (n_kills, n_before) = (n_kills + 1, n);
            }
        }
        folder.run(&build).expect(0);
        assert!(outputs.map(|name| folder.read(name)) == whole, "{input}");
        eprintln!("{input}: {n_kills} kills, begun anew {n_anew} times");
    }
}

/// The impostor: results in the wrong place change the output, so results are taken from the file.
#[test]
fn results_that_are_kept_count() {
    let (folder, whole, _) = scene();
    killed(&folder);
    let kept = journal(&folder);
    let result = |unit: usize| kept.load("cells", unit).unwrap();
    let mut found = (0..48).filter_map(|unit| Some((unit, result(unit)?)));
    let (first, bytes) = found.next().expect("a result");
    let (other, _) = found.find(|(_, other)| *other != bytes).expect("a result that differs");
    kept.save("cells", other, &bytes).unwrap();
    drop(kept);
    assert!(first != other);
    let run = folder.run(&[&BUILD[..], &["--resume"]].concat());
    assert!(run.code == 2 || folder.read("out.pvs") != whole);
}

#[test]
fn states_of_other_builds_are_refused_or_replaced() {
    let (folder, whole, _) = scene();
    let resumed = [&BUILD[..], &["--resume"]].concat();
    killed(&folder);
    let state = folder.read(STATE);
    // Another option, another input.
    let other: Vec<&str> = resumed.iter().map(|arg| if *arg == "3" { "4" } else { *arg }).collect();
    let reason =
        "out.pvs.state: the results are of another input or of other options; without --resume the work begins anew";
    assert_eq!(folder.refused(&other), reason);
    let scene = folder.read("tower.glb");
    let larger = ["generate", "tower", "-o", "tower.glb", "--floors", "1", "--rooms-x", "2", "--rooms-y", "2"];
    folder.run(&larger).expect(0);
    assert_eq!(folder.refused(&resumed), reason);
    folder.write("tower.glb", scene);
    assert!(folder.read(STATE) == state, "what is refused stays");
    // Another number of threads goes on, and so does another place for the output.
    let elsewhere: Vec<&str> = resumed.iter().map(|arg| if *arg == "1" { "2" } else { *arg }).collect();
    let run = folder.run(&[&elsewhere[..], &["--state", STATE]].concat()).expect(0);
    assert_eq!(run.err, "");
    assert!(folder.read("out.pvs") == whole && !folder.path(STATE).exists());
    // What is no state is never overwritten.
    folder.write(STATE, "a letter");
    let reason =
        "out.pvs.state: this is no file of results of units, and would be overwritten; name another with --state";
    assert_eq!([&BUILD[..], &resumed].map(|args| folder.refused(args)), [reason; 2]);
    assert!(folder.refused(&[&BUILD[..], &["--state", "tower.glb"]].concat()).contains("tower.glb"));
    std::fs::remove_file(folder.path(STATE)).unwrap();
    // Without anything to go on from, it begins anew.
    let loud: Vec<&str> = resumed.iter().copied().filter(|arg| *arg != "-q").collect();
    let run = folder.run(&loud).expect(0);
    assert!(run.err.contains("out.pvs.state: there is nothing to go on from; beginning anew"), "{}", run.err);
}

/// Starts a build and kills it once it has some results in its state. Nobody else opens a state while a build uses it.
fn killed(folder: &Folder) {
    let mut child = start(folder, &BUILD);
    while std::fs::metadata(folder.path(STATE)).map_or(0, |state| state.len()) < 2000 {
        assert!(child.try_wait().unwrap().is_none(), "it was over before it could be killed");
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
}

/// A state that is forgotten is put aside until the build is done; one that is damaged loses what is damaged; one that is in use is refused; none has the name
/// of another file of the command.
#[test]
fn states_are_not_lost_by_a_slip() {
    let (folder, whole, _) = scene();
    killed(&folder);
    let n = journal(&folder).n_taken_up();
    assert!(n > 1, "{n}");
    let loud: Vec<&str> = BUILD.iter().copied().filter(|arg| *arg != "-q").collect();
    // Without --resume it begins anew, says so, and is killed too: the first state is aside.
    let mut child = start(&folder, &loud);
    while !folder.path("out.pvs.state.before").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it was over before it could be killed");
        std::thread::sleep(Duration::from_millis(2));
    }
    let busy =
        "out.pvs.state: another process keeps its results in this file; wait for it, or name another with --state";
    assert_eq!(folder.refused(&BUILD), busy);
    child.kill().unwrap();
    let said = String::from_utf8(child.wait_with_output().unwrap().stderr).unwrap();
    let text = format!("out.pvs.state: beginning without its {n} results: --resume goes on from them.");
    assert!(said.contains(&text) && said.contains("out.pvs.state.before"), "{said}");
    std::fs::rename(folder.path("out.pvs.state.before"), folder.path(STATE)).unwrap();
    assert_eq!(journal(&folder).n_taken_up(), n);
    // A byte in the first results: the others are used.
    let mut bytes = folder.read(STATE);
    bytes[200] ^= 1;
    folder.write(STATE, bytes);
    let run = folder.run(&[&loud[..], &["--resume"]].concat()).expect(0);
    assert!(run.err.contains("out.pvs.state: 1 record damaged; the rest is used"), "{}", run.err);
    assert!(folder.read("out.pvs") == whole);
    // Done without --resume, nothing is left either.
    killed(&folder);
    folder.run(&BUILD).expect(0);
    assert_eq!(folder.names(), ["out.pvs", "tower.glb"]);
    for name in ["tower.glb", "./tower.glb", "out.pvs", "./out.pvs"] {
        let error = folder.refused(&[&BUILD[..], &["--state", name]].concat());
        assert!(error.contains(name) && error.contains("two outputs would be written"), "{name}: {error}");
    }
    std::fs::remove_file(folder.path("out.pvs")).unwrap();
    let proofs = ["build", "tower.glb", "-o", "t.pvs", "--certify", "--state", "./t.cert", "-q"];
    assert!(folder.refused(&proofs).contains("two outputs would be written"));
    assert_eq!(folder.names(), ["tower.glb"]);
}

/// The first Ctrl-C keeps what is done; a build, and the visibility of a map.
#[cfg(unix)]
#[test]
fn an_interrupted_build_says_how_it_goes_on() {
    let (folder, whole, took) = scene();
    let mut child = start(&folder, &BUILD);
    let begin = Instant::now();
    while !folder.path(STATE).exists() {
        assert!(begin.elapsed() < took * 20, "no results");
        std::thread::sleep(Duration::from_millis(5));
    }
    let interrupt = |child: &Child| {
        let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        assert!(sent.expect("kill").success());
    };
    interrupt(&child);
    let ended = child.wait_with_output().unwrap();
    let text = String::from_utf8(ended.stderr).unwrap();
    let lines = "interrupted: ending as soon as it can go on later; once more ends at once\n\
                 interrupted; the same command with --resume goes on from out.pvs.state\n";
    assert_eq!((ended.status.code(), text.as_str()), (Some(130), lines));
    assert_eq!(folder.names(), [STATE, "tower.glb"]);
    folder.run(&[&BUILD[..], &["--resume"]].concat()).expect(0);
    assert!(folder.read("out.pvs") == whole);
    // A second one ends at once, whatever is under way.
    child = start(&folder, &BUILD);
    let begin = Instant::now();
    while child.try_wait().unwrap().is_none() {
        assert!(begin.elapsed() < Duration::from_secs(30), "it goes on");
        interrupt(&child);
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_build_that_is_quick_leaves_nothing_while_it_runs() {
    let (folder, whole, _) = scene();
    let args: Vec<&str> = BUILD.iter().map(|arg| if *arg == "0" { "3600" } else { *arg }).collect();
    let mut child = start(&folder, &args);
    let mut n_looks = 0;
    while child.try_wait().unwrap().is_none() {
        assert!(!folder.path(STATE).exists());
        n_looks += 1;
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(n_looks > 3 && folder.read("out.pvs") == whole);
}
