//! Jobs: builds that processes share.

use crate::common::quake::rooms;
use crate::common::{Folder, one_floor, wad};
use serde_json::{Value, json};
use std::process::{Command, Stdio};

/// Command lines for the folder of [`inputs`], each with the file that it writes.
pub(crate) const COMMANDS: [(&str, &str); 4] = [
    ("build tower.glb --method multifocal --grid 5,3,1 --planes 3 -o OUT", "out.pvs"),
    ("build tower.glb -o OUT", "out.pvs"),
    ("vis map.bsp -o OUT", "out.bsp"),
    ("reject maps.wad --force -o OUT", "out.wad"),
];

pub(crate) fn inputs() -> Folder {
    let folder = Folder::new();
    folder.write("tower.glb", one_floor(1, 0));
    let map = rooms(4, 3);
    folder.write("map.bsp", map.bsp);
    folder.write("map.prt", map.prt);
    folder.write("maps.wad", wad(&["MAP01", "MAP02", "MAP03", "MAP04"]));
    crate::reject_folder::add_wads(&folder);
    folder
}

/// The words of a command that writes a file.
fn words<'a>(command: &'a str, out: &'a str) -> Vec<&'a str> {
    command.split(' ').map(|word| if word == "OUT" { out } else { word }).collect()
}

fn plan(folder: &Folder, job: &str, command: &str, out: &str) -> Value {
    let args = [&["job", "plan", "-o", job, "--shards", "5", "--json"][..], &words(command, out)].concat();
    folder.run(&args).expect(0).json()
}

/// Numbers of the shards of a phase, in an order of chance.
fn shuffled(phase: &Value) -> Vec<u64> {
    let first = phase["first_shard"].as_u64().unwrap();
    let mut all: Vec<u64> = (first..first + phase["n_shards"].as_u64().unwrap()).collect();
    all.sort_by_key(|n| n.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32);
    all
}

/// Shards in any order, some twice, some at once, and a merge write what the command writes.
#[test]
fn jobs_write_the_same_bytes() {
    let folder = inputs();
    let mut n_rounds = 0;
    for (k, (command, out)) in COMMANDS.into_iter().enumerate() {
        folder.run(&words(command, out)).expect(0);
        let (whole, job, other) = (folder.read(out), format!("job{k}"), format!("merged-{out}"));
        let mut phase = plan(&folder, &job, command, &other);
        loop {
            n_rounds += 1;
            let shards = shuffled(&phase);
            let numbers: Vec<String> = shards.iter().map(ToString::to_string).collect();
            for number in &numbers[1..] {
                folder.run(&["job", "shard", &job, number]).expect(0);
            }
            // The first one by three processes at once, and then once more.
            let start = |_| {
                let mut program = Command::new(env!("CARGO_BIN_EXE_sightlines"));
                program.args(["job", "shard", &job, &numbers[0], "-q"]).current_dir(folder.path("."));
                program.stdout(Stdio::null()).spawn().unwrap()
            };
            for mut child in (0..3).map(start).collect::<Vec<_>>() {
                assert!(child.wait().unwrap().success());
            }
            let again = folder.run(&["job", "shard", &job, &numbers[0], "--json"]).expect(0).json();
            assert_eq!(again["shards"][0]["was_done"], json!(true));
            let merged = folder.run(&["job", "merge", &job, "--json"]);
            match merged.code {
                3 => phase = merged.json()["next"].clone(),
                _ => break assert_eq!(merged.expect(0).json()["status"], json!("written")),
            }
        }
        assert!(folder.read(&other) == whole, "{command}");
        let status = folder.run(&["job", "status", &job, "--json"]).expect(0).json();
        assert!(status["phases"].as_array().unwrap().iter().all(|phase| phase["done_share"] == json!(1.0)), "{status}");
    }
    assert!(n_rounds >= 6, "{n_rounds}");
}

/// `job submit` goes through all rounds by itself, and tries again what fails.
#[test]
fn engines_do_all_rounds() {
    let folder = inputs();
    for (k, (command, out)) in COMMANDS.into_iter().enumerate() {
        folder.run(&words(command, out)).expect(0);
        let (job, other) = (format!("job{k}"), format!("submitted-{out}"));
        plan(&folder, &job, command, "elsewhere");
        let engine = match k % 2 {
            0 => vec!["--engine", "local", "--workers", "3"],
            // Every shard fails the first time that it is tried.
            _ => vec![
                "--engine",
                "command",
                "--workers",
                "2",
                "--command",
                "mkdir {job}/was-{shard} || {program} job shard {job} {shard} -q; test -f {job}/parts/{shard}.part",
            ],
        };
        let run = folder.run(&[&["job", "submit", &job, "-o", &other][..], &engine].concat()).expect(0);
        assert!(folder.read(&other) == folder.read(out), "{command}: {}", run.err);
        assert!(!folder.path("elsewhere").exists());
    }
    // One that always fails.
    plan(&folder, "hopeless", COMMANDS[0].0, "elsewhere");
    let args = ["job", "submit", "hopeless", "--engine", "command", "--command", "exit 7", "--retries", "1", "--json"];
    let run = folder.run(&args).expect(3);
    assert_eq!(run.json()["undone"]["missing"], json!([0, 1, 2, 3, 4]));
    assert_eq!(run.err.matches("exit status: 7").count(), 10, "{}", run.err);
    let refused = folder.run(&["job", "submit", "hopeless", "--engine", "command"]).expect(2).err;
    assert!(refused.contains("--command <TEMPLATE>"), "{refused}");
}

#[test]
fn what_is_missing_broken_or_of_another_job_is_named() {
    let folder = inputs();
    let (command, out) = COMMANDS[0];
    let phase = plan(&folder, "job", command, out);
    assert_eq!((&phase["phase"], &phase["n_units"], &phase["n_shards"]), (&json!("cells"), &json!(15), &json!(5)));
    for shard in ["0", "1", "2", "4"] {
        folder.run(&["job", "shard", "job", shard]).expect(0);
    }
    let merge = |code| folder.run(&["job", "merge", "job", "-q"]).expect(code).out;
    assert_eq!(merge(3), "missing        shard 3\n");
    folder.run(&["job", "shard", "job", "3"]).expect(0);
    // A bit of a part is changed.
    let part = folder.read("job/parts/2.part");
    let mut changed = part.clone();
    changed[part.len() / 2] ^= 4;
    folder.write("job/parts/2.part", &changed);
    let text = merge(3);
    assert!(
        text.starts_with("broken         shard 2: ") && text.contains("job/parts/2.part: it is cut off after byte"),
        "{text}"
    );
    assert!(!folder.path(out).exists());
    // A part by another version of the program.
    let version = env!("CARGO_PKG_VERSION");
    let at = part.windows(version.len()).position(|bytes| bytes == version.as_bytes()).expect("the version");
    let mut other = part.clone();
    other[at] = b'9';
    let crc = crc32fast::hash(&other[..at + version.len()]);
    other[at + version.len()..][..4].copy_from_slice(&crc.to_le_bytes());
    folder.write("job/parts/2.part", &other);
    let text = merge(3);
    assert!(text.contains("job/parts/2.part: written by version 9.1.0 of the program, and this is 0.1.0"), "{text}");
    let manifest = String::from_utf8(folder.read("job/job.json")).unwrap();
    folder.write("job/job.json", manifest.replace("\"program\": \"0", "\"program\": \"9"));
    for args in [
        &["job", "shard", "job", "2"][..],
        &["job", "merge", "job"],
        &["job", "status", "job"],
        &["job", "submit", "job"],
    ] {
        let error = folder.refused(args);
        assert!(
            error.ends_with("job.json: planned by version 9.1.0 of the program, and this is 0.1.0; plan it anew"),
            "{error}"
        );
    }
    folder.write("job/job.json", manifest);
    assert!(folder.read("job/parts/2.part") == other, "a shard that is refused touches no part");
    // Whoever does the shard again repairs it.
    folder.run(&["job", "shard", "job", "2"]).expect(0);
    assert!(folder.read("job/parts/2.part") == part);
    folder.run(&["job", "merge", "job"]).expect(0);
    // Another input, whatever its length.
    let scene = folder.read("tower.glb");
    let mut longer = scene.clone();
    longer.push(b' ');
    let mut changed = scene;
    *changed.last_mut().unwrap() ^= 1;
    std::fs::remove_file(folder.path("job/parts/1.part")).unwrap();
    for bytes in [longer, changed] {
        folder.write("tower.glb", bytes);
        for args in [&["job", "shard", "job", "1"][..], &["job", "merge", "job"]] {
            let error = folder.refused(args);
            assert!(error.starts_with("tower.glb: the file is not what it was when the job in "), "{error}");
        }
    }
    assert!(!folder.path("job/parts/1.part").exists());
}

#[test]
fn wrong_usage_is_refused() {
    let folder = inputs();
    let plan = |command: &str| {
        let args: Vec<&str> = ["job", "plan", "-o", "job"].into_iter().chain(command.split(' ')).collect();
        folder.refused(&args)
    };
    for (command, reason) in [
        ("info tower.glb", "info: only build, vis, reject and tiles build can be shared"),
        ("build tower.glb -o out.pvs --time-limit 5", "--time-limit means nothing for a job"),
        ("build tower.glb -o out.pvs --resume", "--resume or --state means nothing for a job"),
        ("vis map.bsp --resume", "--resume or --state means nothing for a job"),
        ("build tower.glb --no-such -o out.pvs", "the command of the job: unexpected argument '--no-such' found"),
        ("build none.glb -o out.pvs", "none.glb: No such file or directory (os error 2)"),
    ] {
        assert_eq!(plan(command), reason);
    }
    assert!(!folder.path("job").exists());
    let args = |out: &'static str| ["job", "plan", "-o", "job", "reject", "maps.wad", "--force", "-o", out];
    folder.run(&args("a.wad")).expect(0);
    folder.run(&args("a.wad")).expect(0);
    assert!(
        folder.refused(&args("b.wad")).ends_with("there is another job in the folder; name a new one, or remove it")
    );
    assert!(folder.refused(&["job", "shard", "job", "4"]).ends_with("job.json: there is no shard 4; there are 4"));
    assert!(folder.refused(&["job", "merge", "nowhere"]).contains("nowhere/job.json: "));
    for wrong in ["3-1", "x", "1-", "-1"] {
        folder.run(&["job", "shard", "job", wrong]).expect(2);
    }
    let past = folder.refused(&["job", "shard", "job", "2-99999999999"]);
    assert!(past.ends_with("job.json: there is no shard 99999999999; there are 4"), "{past}");
    // Scripts without starting anything.
    let files =
        folder.run(&["job", "submit", "job", "--dry-run", "--sbatch=--partition=long", "--json"]).expect(0).json();
    assert_eq!(files["files"].as_array().unwrap().len(), 2);
    let script = String::from_utf8(folder.read("job/slurm/shards-0-0.sh")).unwrap();
    assert!(script.contains("#SBATCH --array=0-3\n") && script.contains("#SBATCH --partition=long\n"), "{script}");
    let unknown = folder.run(&["job", "submit", "job", "--engine", "kubernetes"]).expect(2);
    assert!(unknown.err.contains("invalid value 'kubernetes' for '--engine <WHO>'"), "{}", unknown.err);
    // Several shards to a task; those that are done are no reason for one.
    folder.run(&["job", "submit", "job", "--dry-run", "--shards-per-task", "3"]).expect(0);
    let script = String::from_utf8(folder.read("job/slurm/shards-0-0.sh")).unwrap();
    assert!(
        script.contains("#SBATCH --array=0-1\n") && script.contains("first=$((0 + SLURM_ARRAY_TASK_ID * 3))"),
        "{script}"
    );
}

/// A place for parts that is full: a clear error, and nothing half-written.
#[test]
fn a_full_disk_leaves_no_broken_part() {
    let folder = inputs();
    let (command, out) = COMMANDS[0];
    plan(&folder, "job", command, out);
    let place = folder.path("job/parts");
    let mounted = Command::new("mount").args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"]).arg(&place).output();
    if !mounted.is_ok_and(|mounted| mounted.status.success()) {
        eprintln!("SKIPPED a_full_disk_leaves_no_broken_part: nothing can be mounted here");
        return;
    }
    /// Unmounts, whatever happens.
    struct Mounted(std::path::PathBuf);
    impl Drop for Mounted {
        fn drop(&mut self) {
            let _ = Command::new("umount").arg(&self.0).status();
        }
    }
    let mounted = Mounted(place);
    let fill = |n: usize| std::fs::write(folder.path("job/parts/filler"), vec![1; n]).is_ok();
    // All pages but none for a part.
    assert!((1..=16).rev().any(|pages| fill(pages * 4096)));
    let names = || crate::common::names(&folder.path("job/parts"));
    for args in [&["job", "shard", "job", "1", "-q", "--save-after", "0"][..], &["job", "shard", "job", "1", "-q"]] {
        let error = folder.refused(args);
        assert!(error.contains("cannot be written: No space left on device"), "{error}");
        assert!(names().iter().all(|name| !name.ends_with(".part")), "{:?}", names());
    }
    std::fs::remove_file(folder.path("job/parts/filler")).unwrap();
    folder.run(&["job", "shard", "job", "1"]).expect(0);
    assert_eq!(names(), ["1.part"]);
    drop(mounted);
}

/// Shards that one process does have the parts that processes of their own write.
#[test]
fn groups_of_shards_write_the_same_parts() {
    let folder = inputs();
    let mut n_parts = 0;
    for (k, (command, out)) in COMMANDS.into_iter().enumerate() {
        let jobs = [format!("alone{k}"), format!("together{k}")];
        let mut phase = plan(&folder, &jobs[0], command, out);
        plan(&folder, &jobs[1], command, out);
        loop {
            let first = phase["first_shard"].as_u64().unwrap();
            let all: Vec<u64> = (first..first + phase["n_shards"].as_u64().unwrap()).collect();
            for shard in &all {
                folder.run(&["job", "shard", &jobs[0], &shard.to_string()]).expect(0);
            }
            let (last, run) = (all[all.len() - 1].to_string(), format!("{first}-{}", all[all.len() / 2]));
            let done = folder.run(&["job", "shard", &jobs[1], &last, &run, &last, "--json"]).expect(0).json();
            assert!(done["shards"].as_array().unwrap().iter().all(|shard| shard["was_done"] == json!(false)), "{done}");
            let rest = format!("{first}-{last}");
            folder.run(&["job", "shard", &jobs[1], &rest, "--threads", "2"]).expect(0);
            for shard in all {
                let [alone, together] = [0, 1].map(|k: usize| folder.read(&format!("{}/parts/{shard}.part", jobs[k])));
                assert!(alone == together, "{command}: shard {shard}");
                n_parts += 1;
            }
            let merged =
                jobs.clone().map(|job| folder.run(&["job", "merge", &job, "-o", &format!("{job}-out"), "--json"]));
            match merged[0].code {
                3 => phase = merged[0].json()["next"].clone(),
                code => break assert_eq!((code, merged[1].code), (0, 0)),
            }
        }
    }
    assert!(n_parts >= 20, "{n_parts}");
}

/// A process that is killed in the middle of its shards leaves the parts of those that were done.
#[cfg(unix)]
#[test]
fn killed_processes_leave_parts() {
    let folder = inputs();
    let (command, out) = ("build tower.glb --method multifocal --grid 6,4,1 --planes 6 -o OUT", "out.pvs");
    folder.run(&words(command, out)).expect(0);
    let whole = folder.read(out);
    plan(&folder, "job", command, "merged.pvs");
    let part = |shard: usize| folder.path(&format!("job/parts/{shard}.part"));
    let mut program = Command::new(env!("CARGO_BIN_EXE_sightlines"));
    program.args(["job", "shard", "job", "0-4", "-q"]).current_dir(folder.path(".")).stdout(Stdio::null());
    let mut child = program.spawn().unwrap();
    while !part(0).is_file() {
        assert!(child.try_wait().unwrap().is_none_or(|status| status.success()));
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    let _ = child.kill();
    child.wait().unwrap();
    let left: Vec<bool> = (0..5).map(|shard| part(shard).is_file()).collect();
    // Parts come in the order of shards.
    assert!(left.is_sorted_by(|a, b| a >= b) && left.contains(&false), "{left:?}");
    let done = folder.run(&["job", "shard", "job", "0-4", "--json"]).expect(0).json();
    let were_done: Vec<Value> = done["shards"].as_array().unwrap().iter().map(|of| of["was_done"].clone()).collect();
    assert_eq!(json!(were_done), json!(left));
    folder.run(&["job", "merge", "job"]).expect(0);
    assert!(folder.read("merged.pvs") == whole);
}

/// What would fail again is said once, and not tried again.
#[test]
fn hopeless_shards_are_not_tried_again() {
    let folder = inputs();
    let (command, out) = COMMANDS[0];
    plan(&folder, "job", command, out);
    let mut scene = folder.read("tower.glb");
    *scene.last_mut().unwrap() ^= 1;
    folder.write("tower.glb", scene);
    let command = "{program} job shard {job} {shards} -q; code=$?; echo tried >> {job}/tries; exit $code";
    for engine in [&["--workers", "1"][..], &["--engine", "command", "--workers", "1", "--command", command]] {
        let error = folder.refused(&[&["job", "submit", "job", "--retries", "9"][..], engine].concat());
        let name = if engine.len() > 2 { "shards 0 to 2" } else { "worker 0" };
        assert!(
            error.starts_with(&format!("{name}: tower.glb: the file is not what it was when the job in ")),
            "{error}"
        );
        assert_eq!(error.matches("the file is not").count(), 1, "{error}");
    }
    assert_eq!(folder.read("job/tries"), b"tried\n");
}
