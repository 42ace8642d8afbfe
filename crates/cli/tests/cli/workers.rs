//! Workers: processes that go through all of a job together.

use crate::common::{Folder, bytes, small_tower};
use crate::jobs::{COMMANDS, inputs};
use serde_json::{Value, json};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// What is shared here: the commands of other tests of jobs, one that is written row by row, tiles, and a folder of WADs; each with what it writes.
pub(crate) fn commands() -> Vec<(&'static str, &'static str)> {
    let more = [
        ("build tower.glb --method shafts --grid 5,3,1 --class large -o OUT", "out.pvz"),
        ("build tower.glb --certify --stab-trees=1000 -o OUT", "out.pvs"),
        ("tiles build city/world.json --method shafts -o OUT", "out"),
        ("reject wads --force -o OUT", "out-wads"),
    ];
    COMMANDS.into_iter().chain(more).collect()
}

fn words<'a>(command: &'a str, out: &'a str) -> Vec<&'a str> {
    command.split(' ').map(|word| if word == "OUT" { out } else { word }).collect()
}

fn plan(folder: &Folder, job: &str, command: &str, out: &str) {
    let args = [&["job", "plan", "-o", job, "--shards", "6"][..], &words(command, out)].concat();
    folder.run(&args).expect(0);
}

fn start(folder: &Folder, job: &str, more: &[&str]) -> Child {
    let mut program = Command::new(env!("CARGO_BIN_EXE_sightlines"));
    program.args(["job", "work", job, "--json", "-q", "--workers", "3"]).args(more).current_dir(folder.path("."));
    program.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// What a worker has printed, and its exit code.
fn end(worker: Child) -> (Option<i32>, Value, String) {
    let done = worker.wait_with_output().unwrap();
    let err = String::from_utf8_lossy(&done.stderr).into_owned();
    (done.status.code(), serde_json::from_slice(&done.stdout).unwrap_or_default(), err)
}

/// Three workers write what the command writes; each shard is done by one of them, and the output is written by one.
#[test]
fn workers_write_the_same_bytes() {
    let folder = inputs();
    folder.run(&["generate", "world", "--blocks", "2", "--per-tile", "1", "-o", "city"]).expect(0);
    crate::tiles::thin(&folder, 12);
    let mut n_shards = 0;
    for (k, (command, out)) in commands().into_iter().enumerate() {
        folder.run(&words(command, out)).expect(0);
        let (job, other) = (format!("job{k}"), format!("shared-{out}"));
        let elsewhere = format!("elsewhere-{out}");
        plan(&folder, &job, command, &elsewhere);
        let workers: Vec<Child> = (0..3).map(|_| start(&folder, &job, &["-o", &other])).collect();
        let ended: Vec<_> = workers.into_iter().map(end).collect();
        for (code, found, err) in &ended {
            assert_eq!((*code, &found["out"]), (Some(0), &json!(folder.path(&other))), "{command}: {err}");
        }
        let count = |status: &str| ended.iter().filter(|(_, found, _)| found["status"] == status).count();
        assert_eq!((count("written"), count("shared")), (1, 2), "{command}: {ended:?}");
        assert!(bytes(&folder, &other) == bytes(&folder, out), "{command}");
        assert!(!folder.path(&elsewhere).is_file());
        let status = folder.run(&["job", "status", &job, "--json"]).expect(0).json();
        for phase in status["phases"].as_array().unwrap() {
            assert_eq!(phase["done_share"], json!(1.0), "{status}");
            n_shards += phase["n_shards"].as_u64().unwrap();
        }
        // Nothing is left of claims and journals.
        let left = |folder: &Folder, of: &str| crate::common::names(&folder.path(of));
        assert!(left(&folder, &format!("{job}/parts")).iter().all(|name| name.ends_with(".part")));
        let is_known = |name: &String| ["job.json", "parts"].contains(&name.as_str()) || name.ends_with(".written");
        assert!(left(&folder, &job).iter().all(is_known));
    }
    assert!(n_shards >= 50, "{n_shards}");
    // One alone does everything too, and says what the command says.
    plan(&folder, "alone", COMMANDS[1].0, "alone.pvs");
    let whole = folder.run(&words(COMMANDS[1].0, "whole.pvs")).expect(0).out.replace("whole.pvs", "alone.pvs");
    let alone = folder.run(&["job", "work", "alone"]).expect(0).out;
    assert_eq!(alone.lines().next(), whole.lines().next());
    assert!(folder.read("alone.pvs") == folder.read("whole.pvs"));
}

/// Workers that are killed again and again, at moments of chance: those that are left, or come later, end with the bytes of a build.
#[cfg(unix)]
#[test]
fn killed_workers_lose_nothing() {
    let folder = inputs();
    let (command, out) = ("build tower.glb --method multifocal --grid 6,4,1 --planes 6 -o OUT", "out.pvs");
    let begin = Instant::now();
    folder.run(&words(command, out)).expect(0);
    let took = begin.elapsed();
    plan(&folder, "job", command, "shared.pvs");
    let mut workers: Vec<Child> = (0..3).map(|_| start(&folder, "job", &["--save-after", "0"])).collect();
    let (mut seed, mut n_killed) = (7_u64, 0);
    let claims = || crate::common::names(&folder.path("job/parts")).iter().any(|name| name.ends_with(".claim"));
    while !claims() {
        std::thread::sleep(Duration::from_millis(1));
    }
    while n_killed < 10 && !folder.path("shared.pvs").exists() {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let share = if n_killed == 0 { 0.0 } else { (seed >> 40) as f64 / (1 << 24) as f64 / 2.0 };
        std::thread::sleep(took.mul_f64(share).min(Duration::from_secs(2)));
        let place = seed as usize % workers.len();
        n_killed += usize::from(workers[place].try_wait().unwrap().is_none());
        let _ = workers[place].kill();
        workers[place].wait().unwrap();
        workers[place] = start(&folder, "job", &["--save-after", "0"]);
    }
    for (code, found, err) in workers.into_iter().map(end) {
        assert_eq!(code, Some(0), "{found} {err}");
    }
    assert!(n_killed > 0);
    assert!(folder.read("shared.pvs") == folder.read(out));
}

/// More shards than a process may have open files.
#[cfg(unix)]
#[test]
fn workers_need_few_open_files() {
    let folder = inputs();
    folder.write("tower.glb", small_tower());
    folder.run(&["build", "tower.glb", "-o", "whole.pvs"]).expect(0);
    let args = ["job", "plan", "-o", "job", "--shards", "100000", "--json", "build", "tower.glb", "-o", "shared.pvs"];
    let n_shards = folder.run(&args).expect(0).json()["n_shards"].as_u64().unwrap();
    assert!(n_shards > 290, "{n_shards}");
    let line = format!("ulimit -n 290 && exec '{}' job work job --workers 1 -q", env!("CARGO_BIN_EXE_sightlines"));
    let done = Command::new("sh").args(["-c", &line]).current_dir(folder.path(".")).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert!(folder.read("shared.pvs") == folder.read("whole.pvs"));
    std::fs::remove_file(folder.path("shared.pvs")).unwrap();
    let merge = line.replace("job work job --workers 1", "job merge job");
    assert!(Command::new("sh").args(["-c", &merge]).current_dir(folder.path(".")).status().unwrap().success());
    assert!(folder.read("shared.pvs") == folder.read("whole.pvs"));
}

/// What is wrong is said: a damaged part, and another input.
#[test]
fn workers_say_what_is_wrong() {
    let folder = inputs();
    let (command, out) = COMMANDS[0];
    plan(&folder, "job", command, out);
    folder.run(&["job", "shard", "job", "0-4"]).expect(0);
    let mut part = folder.read("job/parts/2.part");
    let sound = part.clone();
    *part.last_mut().unwrap() ^= 1;
    folder.write("job/parts/2.part", part);
    let found = folder.run(&["job", "work", "job", "--json"]).expect(3).json();
    assert_eq!((&found["status"], &found["undone"]["broken"][0]["shard"]), (&json!("missing"), &json!(2)));
    assert!(!folder.path(out).exists());
    // `job submit` removes it, and has it done again.
    folder.run(&["job", "submit", "job", "--workers", "2"]).expect(0);
    assert!(folder.read("job/parts/2.part") == sound && folder.path(out).exists());
    let mut scene = folder.read("tower.glb");
    *scene.last_mut().unwrap() ^= 1;
    folder.write("tower.glb", scene);
    let error = folder.refused(&["job", "work", "job"]);
    assert!(error.starts_with("tower.glb: the file is not what it was when the job in "), "{error}");
    assert!(folder.refused(&["job", "work", "nowhere"]).contains("nowhere/job.json: "));
    folder.run(&["job", "work", "job", "--workers", "0"]).expect(2);
}
