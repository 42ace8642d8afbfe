//! Budgets of memory: what is refused before the work, what fits otherwise, and what is stopped.

use crate::common::{Folder, small_tower};
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

/// A scene, and a build of it in many cells.
fn scene() -> Folder {
    let folder = Folder::new();
    folder.write("tower.glb", small_tower());
    folder
}

const BUILD: [&str; 8] = ["build", "tower.glb", "--method", "multifocal", "--planes", "3", "--threads", "2"];

#[test]
fn what_cannot_fit_is_refused_before_the_work() {
    let folder = scene();
    let square = [&BUILD[..], &["--grid", "400,400,1", "-q", "--memory", "1GB"]].concat();
    let error = folder.refused(&[&square[..], &["-o", "out.pvs"]].concat());
    assert!(error.starts_with("tower.glb: --memory 953.7 MiB: with one thread this needs about "), "{error}");
    assert!(error.contains("name the output .pvz"), "{error}");
    // 160,000 cells: five squares of bits.
    let needed: f64 = error.split("about ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let squares = 5.0 * 160_000.0 * 160_000.0 / 8.0 / 1024.0 / 1024.0;
    assert!(needed > squares && needed < squares + 700.0, "{needed}");
    assert_eq!(folder.names(), ["tower.glb"]);
    for (size, wrong) in [("1 potato", true), ("0", true), ("2GiB", false)] {
        let run = folder.run(&["build", "tower.glb", "-o", "t.pvs", "-q", "--memory", size]);
        assert_eq!(run.code == 2, wrong, "{size}: {}", run.err);
        assert!(!wrong || run.err.contains("not a size such as 2GiB"), "{}", run.err);
    }
}

/// What fits with fewer threads, or row by row, is done so.
#[cfg(target_os = "linux")]
#[test]
fn what_fits_otherwise_is_done_otherwise() {
    let folder = Folder::new();
    folder.write("one.obj", "v 0 0 0\nv 9 0 0\nv 9 9 3\nf 1 2 3\n");
    let build = ["build", "one.obj", "--method", "multifocal", "--threads", "2"];
    // Buffers of three planes with 1024 texels along a side take 72 MiB for each thread.
    let large = [&build[..], &["--grid", "2,1,1", "--planes", "3", "--texels", "1024", "--json"]].concat();
    let whole = folder.run(&[&large[..], &["-o", "whole.pvs"]].concat()).expect(0);
    let run = folder.run(&[&large[..], &["-o", "few.pvs", "--memory", "130MB"]].concat()).expect(0);
    assert!(run.err.contains("--memory: 1 of 2 threads") && !whole.err.contains("--memory"), "{}", run.err);
    let peaks = [&whole, &run].map(|run| run.json()["peak_bytes"].as_u64().expect("Linux reports it"));
    assert!(peaks[1] > 1 << 20 && peaks[1] < 130_000_000, "{peaks:?}");
    assert!(folder.read("few.pvs") == folder.read("whole.pvs"));
    // Cells for which rows fit, and five squares do not.
    let many = ["--grid", "80,80,1", "--planes", "1", "--texels", "16", "-o", "rows.pvz", "--memory", "35MB"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_sightlines"));
    command.args([&build[..], &many].concat()).current_dir(folder.path(".")).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program was built");
    let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines().map(|line| line.expect("text"));
    assert!(lines.any(|line| line.contains("rows.pvz: written row by row, as --class large does, for --memory")));
    // That it is done does not take that long alone.
    child.kill().expect("a child can be killed");
    child.wait().expect("a child ends");
}

/// Stopped as by Ctrl-C, with an exit code and a text of its own, a build goes on with more memory.
#[cfg(target_os = "linux")]
#[test]
fn what_uses_too_much_is_stopped_and_goes_on() {
    let folder = scene();
    // The program alone takes more than a MiB, so it is stopped after its first units; nothing is estimated that needs it.
    let shaft = |more: &[&'static str]| {
        let args = ["build", "tower.glb", "-o", "out.pvs", "-q", "--save-after", "0"];
        folder.run(&[&args[..], more].concat())
    };
    shaft(&["--state", "none"]).expect(0);
    let expected = folder.read("out.pvs");
    std::fs::remove_file(folder.path("out.pvs")).unwrap();
    let run = shaft(&["--memory", "1MiB"]);
    assert_eq!(run.code, 4, "{}", run.err);
    assert!(
        run.err.starts_with("stopped: ") && run.err.contains(" of memory are in use, and --memory allows 1024.0 KiB")
    );
    assert!(run.err.contains("larger --memory, or fewer --threads") || run.err.contains("nothing was written"));
    assert!(!folder.path("out.pvs").exists());
    let resumed: &[&str] = if folder.path("out.pvs.state").exists() { &["--resume", "--memory", "4GiB"] } else { &[] };
    shaft(resumed).expect(0);
    assert!(folder.read("out.pvs") == expected);
    assert_eq!(folder.names(), ["out.pvs", "tower.glb"]);
}

/// A shard takes the budget, and keeps what it has done.
#[cfg(target_os = "linux")]
#[test]
fn shards_have_budgets_too() {
    let folder = scene();
    let plan = ["job", "plan", "-o", "job", "--shards", "2", "build", "tower.glb", "-o", "out.pvs"];
    folder.run(&plan).expect(0);
    let run = folder.run(&["job", "shard", "job", "0", "--memory", "1MiB", "-q"]);
    assert!(run.code == 4 && run.err.contains("what is done stays"), "{} {}", run.code, run.err);
    folder.run(&["job", "shard", "job", "0", "--memory", "4GiB", "-q"]).expect(0);
}

/// Killed once it has results, and taken up, levels have the bytes of those that were left alone.
#[test]
fn levels_go_on_where_they_were_killed() {
    let folder = Folder::with_bare_tower();
    let args = ["levels", "tower.glb", "--table", "tower.pvs", "--method", "none", "--budget", "0.0001", "-q"];
    let args = [&args[..], &["--save-after", "0", "-o"]].concat();
    let with = |out: &'static str, more: &[&'static str]| [&args[..], &[out], more].concat();
    folder.run(&with("whole", &[])).expect(0);
    let begin = std::time::Instant::now();
    let mut n_kills = 0;
    for size in [2_000_u64, 20_000, 60_000] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sightlines"));
        command.args(with("out", &["--resume"])).current_dir(folder.path(".")).stdout(Stdio::null());
        let mut child = command.spawn().expect("the program was built");
        while std::fs::metadata(folder.path("out.state")).map_or(0, |state| state.len()) < size {
            if child.try_wait().expect("a child").is_some() {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        child.kill().expect("a child can be killed");
        n_kills += u32::from(child.wait().expect("a child ends").code().is_none());
        if folder.path("out").exists() {
            break;
        }
    }
    eprintln!("killed {n_kills} times in {:?}", begin.elapsed());
    assert!(n_kills > 0);
    // The last run may have come to its end before it was killed.
    if !folder.path("out").exists() {
        assert!(folder.path("out.state").exists());
        let other = folder.refused(&with("out", &["--resume", "--flat"]));
        assert!(other.starts_with("out.state: the results are of another input or of other options"), "{other}");
        folder.run(&with("out", &["--resume"])).expect(0);
    }
    let files = |name: &str| {
        let entries = std::fs::read_dir(folder.path(name)).unwrap().map(|entry| entry.unwrap().path());
        let mut all: Vec<_> =
            entries.map(|path| (path.file_name().unwrap().to_owned(), std::fs::read(&path).unwrap())).collect();
        all.sort();
        all
    };
    assert!(files("whole").len() > 2 && files("whole") == files("out") && !folder.path("out.state").exists());
}
