//! REJECT lumps of a folder of WADs.

use crate::common::{Folder, bytes, doom_map, names};
use crate::reject::tables;
use serde_json::{Value, json};
use sightlines::formats::wad::{LumpName, WadBuilder, WadKind};
use std::path::Path;
use std::process::{Command, Stdio};

/// A WAD of maps by names and seeds, with a lump before them.
fn wad(maps: &[(&str, u64)]) -> Vec<u8> {
    let mut builder = WadBuilder::new(WadKind::Patch);
    builder.lump("BEFORE", b"some bytes").expect("a short name");
    for (name, seed) in maps {
        let name = LumpName::new(name).expect("a short name");
        doom_map(*seed).add_to(&mut builder, name).expect("a small map");
    }
    builder.finish().expect("a small file")
}

/// A WAD of one map with a line to nowhere.
fn damaged(name: &str) -> Vec<u8> {
    let mut builder = WadBuilder::new(WadKind::Patch);
    let mut map = doom_map(3);
    map.lines[4].v2 = 60_000;
    map.add_to(&mut builder, LumpName::new(name).expect("a short name")).expect("a small map");
    builder.finish().expect("a small file")
}

/// Puts a folder `wads` into a folder: three WADs with six maps, all different.
pub(crate) fn add_wads(folder: &Folder) {
    std::fs::create_dir(folder.path("wads")).unwrap();
    folder.write("wads/a.wad", wad(&[("MAP01", 11), ("MAP02", 12)]));
    folder.write("wads/B.WAD", wad(&[("MAP01", 13), ("E1M1", 14), ("E1M2", 15)]));
    folder.write("wads/c.Wad", wad(&[("MAP07", 16)]));
}

const WADS: [&str; 3] = ["B.WAD", "a.wad", "c.Wad"];

fn with_wads() -> Folder {
    let folder = Folder::new();
    add_wads(&folder);
    folder
}

/// The same with 200 maps in one of them: enough to kill a run in the middle.
fn with_many_maps() -> Folder {
    let folder = with_wads();
    let maps: Vec<(String, u64)> = (0..200).map(|k| (format!("MAP{k:03}"), k)).collect();
    let maps: Vec<(&str, u64)> = maps.iter().map(|(name, seed)| (name.as_str(), *seed)).collect();
    folder.write("wads/c.Wad", wad(&maps));
    folder
}

/// What the WADs of `wads` get, each alone.
fn alone(folder: &Folder, more: &[&str]) -> Vec<(String, Vec<u8>)> {
    let one = |name: &str| {
        let input = format!("wads/{name}");
        folder.run(&[&["reject", &input, "-o", "alone.wad"], more].concat()).expect(0);
        (name.to_owned(), folder.read("alone.wad"))
    };
    let all = WADS.map(one).to_vec();
    std::fs::remove_file(folder.path("alone.wad")).unwrap();
    all
}

fn statuses(reply: &Value) -> Vec<(String, String)> {
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    reply["files"].as_array().unwrap().iter().map(|file| (text(&file["name"]), text(&file["status"]))).collect()
}

#[test]
fn a_folder_is_as_each_wad_alone() {
    let folder = with_wads();
    folder.write("wads/notes.txt", "no WAD");
    folder.write("wads/.hidden.wad", "no WAD either");
    std::fs::create_dir(folder.path("wads/folder.wad")).unwrap();
    let alone = alone(&folder, &[]);
    let said = folder.run(&["reject", "wads", "-o", "new/"]).expect(0);
    assert!(said.out.starts_with("B.WAD:\n  MAP01 ") && said.err.is_empty(), "{} {}", said.out, said.err);
    assert!(said.out.ends_with("wrote new/: 3 of 3 WADs, with 6 of 6 maps built\n"), "{}", said.out);
    assert!(bytes(&folder, "new") == alone);
    // The impostor: each has tables, and those of its own.
    for (name, new) in &alone {
        let old = folder.read(&format!("wads/{name}"));
        assert!(*new != old && tables(new.clone()).iter().all(Option::is_some));
    }
    assert!(alone[0].1 != alone[1].1 && alone[1].1 != alone[2].1);
    // Whatever the threads; what else is in the folder stays, and so does its state.
    folder.write("new/letter", "dear");
    folder.write("new/c.Wad", "old");
    let reply = folder.run(&["reject", "wads/", "-o", "new", "--threads", "2", "--json"]).expect(0).json();
    let mut with_letter = alone.clone();
    with_letter.push(("letter".to_owned(), b"dear".to_vec()));
    with_letter.sort();
    assert!(bytes(&folder, "new") == with_letter);
    assert_eq!((&reply["out"], &reply["files"][0]["out"]), (&json!("new"), &json!("new/B.WAD")));
    assert!(statuses(&reply).iter().all(|(_, status)| status == "written"));
    let one = folder.run(&["reject", "wads/a.wad", "-o", "a.wad", "--json"]).expect(0).json();
    for (of_folder, of_one) in reply["files"][1]["maps"].as_array().unwrap().iter().zip(one["maps"].as_array().unwrap())
    {
        let without_time = |map: &Value| {
            let mut map = map.clone();
            map.as_object_mut().unwrap().remove("seconds");
            map
        };
        assert_eq!(without_time(of_folder), without_time(of_one));
    }
    assert_eq!(folder.names(), ["a.wad", "new", "wads"]);
}

#[test]
fn maps_by_name_are_those_of_all_wads_that_have_them() {
    let folder = with_wads();
    let reply = folder.run(&["reject", "wads", "-o", "new", "--map", "map01", "--json"]).expect(0).json();
    let expected = [("B.WAD", "written"), ("a.wad", "written"), ("c.Wad", "skipped")];
    assert_eq!(statuses(&reply), expected.map(|(name, status)| (name.to_owned(), status.to_owned())));
    assert_eq!(reply["files"][2]["reason"], json!("it has no map of that name"));
    assert_eq!(names(&folder.path("new")), ["B.WAD", "a.wad"]);
    for name in ["B.WAD", "a.wad"] {
        folder.run(&["reject", &format!("wads/{name}"), "-o", "one.wad", "--map", "MAP01"]).expect(0);
        assert!(folder.read("one.wad") == folder.read(&format!("new/{name}")));
    }
    let error = folder.refused(&["reject", "wads", "-o", "none", "--map", "MAP01", "--map", "MAP09"]);
    assert_eq!(error, "wads: map MAP09 is in none of the WADs in the folder that can be read");
    folder.write("maps.rej", "BLIND 0 (1)\n");
    let error = folder.refused(&["reject", "wads", "-o", "none", "--rmb", "maps.rej"]);
    assert!(error.starts_with("wads: --rmb is for one WAD, and this is a folder: "), "{error}");
    assert!(!folder.path("none").exists());
}

#[test]
fn wads_that_cannot_be_done_are_named_and_the_others_are_done() {
    let folder = with_wads();
    let alone = alone(&folder, &[]);
    folder.write("wads/bad.wad", damaged("MAP01"));
    folder.write("wads/noise.wad", [7u8; 100]);
    folder.write("wads/textures.wad", wad(&[]));
    let args = ["reject", "wads", "-o", "new"];
    let said = folder.run(&args).expect(0);
    let place = "map MAP01: LINEDEFS 4: vertex 60000 is not among the ";
    for (begin, text) in [
        (format!("bad.wad: not done: {place}"), &said.out),
        ("noise.wad: not done: ".to_owned(), &said.out),
        ("textures.wad: skipped: it has no maps\n".to_owned(), &said.out),
        (format!("wads/bad.wad: not done: {place}"), &said.err),
        ("wads/noise.wad: not done: ".to_owned(), &said.err),
    ] {
        assert!(text.contains(&begin), "{begin} {text}");
    }
    assert!(said.out.ends_with("wrote new: 3 of 6 WADs, with 6 of 6 maps built\n"), "{}", said.out);
    assert_eq!(said.err.lines().count(), 2, "{}", said.err);
    assert!(bytes(&folder, "new") == alone);
    let reply = folder.run(&[&args[..], &["--json", "-q"]].concat()).expect(0).json();
    assert_eq!(
        reply["files"][2],
        json!({
            "name": "bad.wad", "out": null, "status": "failed", "reason": reply["files"][2]["reason"], "maps": [],
        })
    );
    // As a job too, where the processes of shards go on.
    folder.run(&["job", "plan", "-o", "job", "--shards", "2", "reject", "wads", "-o", "shared"]).expect(0);
    folder.run(&["job", "shard", "job", "0-1"]).expect(0);
    let merged = folder.run(&["job", "merge", "job"]).expect(0);
    assert_eq!(merged.out.lines().last(), Some("wrote shared: 3 of 6 WADs, with 6 of 6 maps built"));
    assert!(merged.err.contains(&format!("wads/bad.wad: not done: {place}")) && bytes(&folder, "shared") == alone);
    // With --strict nothing is written: neither for what is no WAD nor for one that cannot be done. One without maps is no reason.
    let strict = ["reject", "wads", "-o", "none", "--strict"];
    assert!(folder.refused(&strict).starts_with("wads/noise.wad: "));
    std::fs::remove_file(folder.path("wads/noise.wad")).unwrap();
    let error = folder.refused(&strict);
    assert!(error.starts_with(&format!("wads/bad.wad: {place}")), "{error}");
    assert!(!folder.path("none").exists());
    std::fs::remove_file(folder.path("wads/bad.wad")).unwrap();
    folder.run(&["reject", "wads", "-o", "strict", "--strict"]).expect(0);
    assert!(bytes(&folder, "strict") == alone);
}

#[test]
fn folders_that_cannot_be_done_are_refused() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("wads")).unwrap();
    let refused = |args: &[&str]| folder.refused(&[&["reject", "wads", "-o"], args].concat());
    assert_eq!(refused(&["new"]), "wads: there are no WADs in the folder");
    folder.write("wads/textures.wad", wad(&[]));
    assert_eq!(refused(&["new"]), "wads: none of the WADs in the folder has maps");
    folder.write("wads/bad.wad", damaged("MAP01"));
    let error = refused(&["new"]);
    let begin = "wads: none of the WADs in the folder can be done; the first that fails is wads/bad.wad: map MAP01: ";
    assert!(error.starts_with(begin), "{error}");
    folder.write("wads/good.wad", wad(&[("MAP01", 2)]));
    folder.write("file", "");
    assert!(refused(&["no/new"]).contains("no/new: cannot be written: No such file"));
    assert!(refused(&["file"]).starts_with("file: cannot be made: "));
    for same in ["wads", "./wads/", "wads/../wads"] {
        assert!(refused(&[same]).ends_with(": the output would replace the input"), "{same}");
    }
    let before = bytes(&folder, "wads");
    #[cfg(unix)]
    {
        // Links to what is read, and two to one file.
        std::fs::create_dir(folder.path("links")).unwrap();
        let link = |to: &str, name: &str| std::os::unix::fs::symlink(folder.path(to), folder.path(name)).unwrap();
        link("wads/bad.wad", "links/good.wad");
        assert_eq!(refused(&["links"]), "links/good.wad: the output would replace the input");
        std::fs::remove_file(folder.path("links/good.wad")).unwrap();
        folder.write("links/other", "");
        link("links/other", "links/good.wad");
        link("links/other", "links/bad.wad");
        assert_eq!(refused(&["links"]), "links/good.wad: two outputs would be written to this file");
        std::fs::remove_dir_all(folder.path("links")).unwrap();
    }
    std::fs::create_dir_all(folder.path("taken/good.wad")).unwrap();
    assert!(refused(&["taken"]).starts_with("taken/good.wad: cannot be written: "));
    assert!(refused(&["new", "--state", "wads/good.wad"]).contains("two outputs would be written"));
    assert!(refused(&["new", "--state", "new/good.wad"]).contains("two outputs would be written"));
    assert_eq!((folder.names(), bytes(&folder, "wads")), (vec!["file".into(), "taken".into(), "wads".into()], before));
    // Inside the folder that is read, or around it, is no harm.
    folder.run(&["reject", "wads", "-o", "wads/new"]).expect(0);
    folder.run(&["reject", "wads", "-o", "."]).expect(0);
    assert!(folder.read("wads/new/good.wad") == folder.read("good.wad"));
}

/// A folder as a job: all its maps are units of one phase, and shards in any order, or `job submit`, write what the command writes.
#[test]
fn a_folder_is_shared() {
    let folder = with_wads();
    let alone = alone(&folder, &["--force"]);
    let plan = |job: &str, out: &str| {
        let args = ["job", "plan", "-o", job, "--shards", "3", "--json", "reject", "wads", "--force", "-o", out];
        folder.run(&args).expect(0).json()
    };
    let phase = plan("job", "new/");
    assert_eq!((&phase["phase"], &phase["n_units"], &phase["n_shards"]), (&json!("maps"), &json!(6), &json!(3)));
    assert!(!folder.path("new").exists(), "a plan writes nothing");
    folder.run(&["job", "shard", "job", "2"]).expect(0);
    assert_eq!(folder.run(&["job", "merge", "job", "--json"]).expect(3).json()["undone"]["missing"], json!([0, 1]));
    folder.run(&["job", "shard", "job", "0"]).expect(0);
    folder.run(&["job", "shard", "job", "1"]).expect(0);
    let merged = folder.run(&["job", "merge", "job", "--json"]).expect(0).json();
    assert!(
        merged["text"].as_str().unwrap().ends_with("wrote new/: 3 of 3 WADs, with 6 of 6 maps built\n"),
        "{merged}"
    );
    assert!(bytes(&folder, "new") == alone);
    plan("submitted", "elsewhere");
    folder.run(&["job", "submit", "submitted", "--workers", "2", "-o", "workers"]).expect(0);
    assert!(bytes(&folder, "workers") == alone && !folder.path("elsewhere").exists());
    // A worker writes again what is not there any more.
    std::fs::remove_file(folder.path("workers/a.wad")).unwrap();
    folder.run(&["job", "work", "submitted", "-o", "workers"]).expect(0);
    assert!(bytes(&folder, "workers") == alone);
    // The impostor: the part of another shard in the place of one.
    folder.write("job/parts/0.part", folder.read("job/parts/1.part"));
    folder.run(&["job", "merge", "job", "-o", "wrong"]).expect(3);
    // A WAD more, or another one, is another folder.
    plan("other", "new");
    folder.write("wads/d.wad", wad(&[("MAP01", 17)]));
    let error = folder.refused(&["job", "shard", "other", "0"]);
    assert!(
        error.ends_with("the command and what it reads are not what they were when the job was planned"),
        "{error}"
    );
    std::fs::remove_file(folder.path("wads/d.wad")).unwrap();
    let mut changed = folder.read("wads/c.Wad");
    changed[13] ^= 1;
    folder.write("wads/c.Wad", changed);
    let error = folder.refused(&["job", "shard", "other", "0"]);
    assert!(error.starts_with("wads/c.Wad: the file is not what it was when the job in "), "{error}");
}

/// Killed again and again, and taken up each time, a folder ends as one that was left alone; until then what was there stays.
#[cfg(unix)]
#[test]
fn a_folder_that_is_killed_goes_on() {
    let folder = with_many_maps();
    let alone = alone(&folder, &[]);
    std::fs::create_dir(folder.path("new")).unwrap();
    folder.write("new/a.wad", "old");
    let args = ["reject", "wads", "-o", "new/", "--save-after", "0", "--threads", "1", "--resume", "-q"];
    let (mut n_kills, mut sizes) = (0, Vec::new());
    let size = || std::fs::metadata(folder.path("new.state")).map_or(0, |state| state.len());
    loop {
        let before = size();
        let mut program = Command::new(env!("CARGO_BIN_EXE_sightlines"));
        let mut child =
            program.args(args).current_dir(folder.path(".")).stdout(Stdio::null()).spawn().expect("the program");
        let ended = loop {
            if let Some(status) = child.try_wait().unwrap() {
                break Some(status);
            }
            if n_kills < 3 && size() > before + 100 {
                break None;
            }
            std::thread::sleep(std::time::Duration::from_micros(200));
        };
        if let Some(status) = ended {
            assert!(status.success());
            break;
        }
        child.kill().unwrap();
        if child.wait().unwrap().success() {
            break;
        }
        n_kills += 1;
        sizes.push(size());
        assert!(sizes.is_sorted(), "{sizes:?}");
        // Whole, if the tables of all were there.
        assert!([b"old", &alone[1].1[..]].contains(&&folder.read("new/a.wad")[..]));
    }
    eprintln!("bytes of the state after each kill: {sizes:?}");
    assert!(n_kills > 0, "it was over before it could be killed");
    assert!(bytes(&folder, "new") == alone);
    assert_eq!(folder.names(), ["new", "wads"]);
}

/// Ctrl-C keeps what is done and writes nothing, of one WAD and of a folder: maps that were not done are not ones that cannot be done.
#[cfg(unix)]
#[test]
fn an_interrupted_run_writes_nothing() {
    let folder = with_many_maps();
    for (input, out) in [("wads/c.Wad", "new.wad"), ("wads", "new")] {
        let args = ["reject", input, "-o", out, "--save-after", "0", "--threads", "1"];
        folder.run(&[&args[..], &["--state", "whole"]].concat()).expect(0);
        let path = folder.path(out);
        let whole = bytes(&folder, out);
        let n_tries = (1..=20).find(|_| {
            let _ = std::fs::remove_dir_all(&path).or_else(|_| std::fs::remove_file(&path));
            let mut program = Command::new(env!("CARGO_BIN_EXE_sightlines"));
            program.args(args).current_dir(folder.path(".")).stdout(Stdio::null()).stderr(Stdio::piped());
            let mut child = program.spawn().expect("the program");
            let state = folder.path(&format!("{out}.state"));
            while child.try_wait().unwrap().is_none() && !state.exists() {
                std::thread::sleep(std::time::Duration::from_micros(200));
            }
            // It may be over.
            let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).stderr(Stdio::null()).status();
            let ended = child.wait_with_output().unwrap();
            let text = String::from_utf8(ended.stderr).unwrap();
            if ended.status.success() {
                assert!(bytes(&folder, out) == whole);
                return false;
            }
            assert_eq!(ended.status.code(), Some(130), "{text}");
            assert!(text.ends_with(&format!("the same command with --resume goes on from {out}.state\n")), "{text}");
            true
        });
        assert!(n_tries.is_some(), "{input}: it was over before it could be interrupted");
        assert!(!path.exists());
        folder.run(&[&args[..], &["--resume"]].concat()).expect(0);
        assert!(bytes(&folder, out) == whole);
    }
    assert_eq!(folder.names(), ["new", "new.wad", "wads"]);
}

/// A state belongs to the names and the content of all WADs.
#[cfg(unix)]
#[test]
fn states_are_of_all_wads() {
    let folder = with_many_maps();
    let args = ["reject", "wads", "-o", "new", "--save-after", "0", "--threads", "1", "-q"];
    // A state that is left: of a run that is killed as soon as it has results.
    for _ in 0..20 {
        let mut program = Command::new(env!("CARGO_BIN_EXE_sightlines"));
        let mut child = program.args(args).current_dir(folder.path(".")).stdout(Stdio::null()).spawn().unwrap();
        while child.try_wait().unwrap().is_none()
            && std::fs::metadata(folder.path("new.state")).map_or(0, |state| state.len()) < 200
        {
            std::thread::sleep(std::time::Duration::from_micros(200));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        if folder.path("new.state").exists() {
            break;
        }
    }
    let state = folder.read("new.state");
    let resumed = [&args[..], &["--resume"]].concat();
    std::fs::rename(folder.path("wads/a.wad"), folder.path("wads/aa.wad")).unwrap();
    let reason =
        "new.state: the results are of another input or of other options; without --resume the work begins anew";
    assert_eq!(folder.refused(&resumed), reason);
    std::fs::rename(folder.path("wads/aa.wad"), folder.path("wads/a.wad")).unwrap();
    // The folder itself may have another name.
    std::fs::rename(folder.path("wads"), folder.path("moved")).unwrap();
    let moved: Vec<&str> = resumed.iter().map(|arg| if *arg == "wads" { "moved" } else { *arg }).collect();
    assert!(folder.read("new.state") == state);
    let run = folder.run(&[&moved[..], &["--json"]].concat()).expect(0);
    assert_eq!(run.json()["files"].as_array().unwrap().len(), 3);
    assert_eq!(folder.names(), ["moved", "new"]);
}

/// Real maps as a folder, alone and as a job: the same bytes, and nothing that was seen is rejected.
#[test]
fn a_folder_of_real_maps_is_as_each_alone() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA") else {
        eprintln!("SKIPPED a_folder_of_real_maps: SIGHTLINES_DATA is not set");
        return;
    };
    let doom = Path::new(&data).join("doom");
    let maps = ["freedm_MAP02", "freedm_MAP03", "freedm_MAP07", "freedoom1_E1M1", "freedoom1_E1M8"];
    let folder = Folder::new();
    std::fs::create_dir(folder.path("wads")).unwrap();
    for map in maps {
        folder.write(&format!("wads/{map}.wad"), std::fs::read(doom.join(format!("{map}.wad"))).expect("the map"));
    }
    folder.run(&["reject", "wads", "-o", "new", "--force"]).expect(0);
    folder.run(&["job", "plan", "-o", "job", "--shards", "3", "reject", "wads", "--force", "-o", "shared"]).expect(0);
    folder.run(&["job", "submit", "job", "--workers", "2"]).expect(0);
    assert_eq!(names(&folder.path("new")).len(), maps.len());
    assert!(bytes(&folder, "new") == bytes(&folder, "shared"));
    let n_wrong = |table: &[u8], seen: &[u8]| -> u32 {
        assert_eq!(table.len(), seen.len(), "both speak of the same sectors");
        table.iter().zip(seen).map(|(a, b)| (a & b).count_ones()).sum()
    };
    let mut n_impostors = 0;
    for map in maps {
        folder.run(&["reject", &format!("wads/{map}.wad"), "-o", "alone.wad", "--force"]).expect(0);
        let new = folder.read(&format!("new/{map}.wad"));
        assert!(folder.read("alone.wad") == new, "{map}");
        let seen = std::fs::read(doom.join(format!("{map}.seen.bin"))).expect("what was seen");
        let lump = |bytes: Vec<u8>| tables(bytes).pop().flatten();
        let table = lump(new).expect("a table");
        assert_eq!(n_wrong(table.as_bytes(), &seen), 0, "{map}");
        // The impostor: all that can be rejected is.
        n_impostors += u32::from(n_wrong(&vec![0xff; seen.len()], &seen) > 0);
    }
    assert_eq!(n_impostors, maps.len() as u32);
}
