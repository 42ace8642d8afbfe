//! Behind a node builder: the script for Ultimate Doom Builder on a real zdbsp, and what an engine makes of the result.
#![cfg(unix)]

use crate::common::{Folder, doom_map, udmf};
use sightlines::formats::doom::{DoomMap, list_maps, write_doom_map};
use sightlines::formats::wad::{WadBuilder, WadKind};
use sightlines::formats::{LumpName, RejectTable, Wad};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A program of the system, if it is installed.
fn installed(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    // Debian's games are not in everyone's path.
    let folders = std::env::split_paths(&path).chain([PathBuf::from("/usr/games")]);
    let found = folders.map(|folder| folder.join(name)).find(|file| file.is_file());
    if found.is_none() {
        eprintln!("SKIPPED: {name} is not installed, so a test of REJECT lumps with it did not run");
    }
    found
}

fn guide(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guides/udb").join(name)
}

/// What the script gave: its exit code and all it said.
fn run_script(folder: &Folder, zdbsp: &Path, args: &[String]) -> (i32, String) {
    let output = Command::new(guide("zdbsp-reject.sh"))
        .args(args)
        .env("ZDBSP", zdbsp)
        .env("SIGHTLINES", env!("CARGO_BIN_EXE_sightlines"))
        .current_dir(folder.path("."))
        .output()
        .expect("the script can be run");
    let said = [output.stdout, output.stderr].concat();
    (output.status.code().expect("the script ends by itself"), String::from_utf8(said).expect("text"))
}

/// The options of each node builder in the configuration file, for an input and an output.
fn configured(input: &str, output: &str) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(guide("sightlines.cfg")).expect("the file of the guide");
    let values = |key: &str| -> Vec<String> {
        let lines = text.lines().filter(|line| line.trim_start().starts_with(&format!("{key} =")));
        lines.map(|line| line.split('"').nth(1).expect("a value in quotes").to_owned()).collect()
    };
    assert_eq!(values("program"), ["zdbsp-reject.cmd"]);
    assert!(guide("zdbsp-reject.cmd").is_file() && guide("zdbsp-reject.sh").is_file());
    let fill = |options: &str| options.replace("%FO", output).replace("%FI", input);
    let filled: Vec<String> = values("parameters").iter().map(|options| fill(options)).collect();
    assert_eq!(filled.len(), 2, "{filled:?}");
    filled.iter().map(|options| options.split(' ').map(str::to_owned).collect()).collect()
}

/// Names and bytes of all lumps but REJECT.
fn others(wad: &Wad) -> Vec<(String, Vec<u8>)> {
    let lump = |k: usize| (wad.lumps()[k].name.to_string(), wad.lump_bytes(k).to_vec());
    (0..wad.lumps().len()).map(lump).filter(|(name, _)| name != "REJECT").collect()
}

/// What the script writes is what zdbsp writes and then `reject`: binary maps, with ordinary and extended nodes, and maps as text.
#[test]
fn the_script_builds_nodes_and_then_reject() {
    let Some(zdbsp) = installed("zdbsp") else { return };
    let folder = Folder::new();
    let mut n_runs = 0;
    for seed in 1..4 {
        let name = LumpName::new("MAP01").expect("a short name");
        let binary = write_doom_map(name, &doom_map(seed)).expect("a small map");
        let as_text = udmf::as_text(&Wad::parse(binary.clone()).expect("a sound WAD"));
        for (map, kind) in [(binary, "binary"), (as_text, "text")] {
            folder.write("in.wad", map);
            for args in configured("in.wad", "out.wad") {
                let (code, said) = run_script(&folder, &zdbsp, &args);
                assert_eq!((code, said.as_str()), (0, ""), "{kind} {args:?}");
                let out = Wad::parse(folder.read("out.wad")).expect("a sound WAD");

                let alone: Vec<String> = args.iter().map(|arg| arg.replace("out.wad", "alone.wad")).collect();
                let made =
                    Command::new(&zdbsp).args(&alone).current_dir(folder.path(".")).output().expect("zdbsp runs");
                assert!(made.status.success());
                folder.run(&["reject", "alone.wad", "-o", "then.wad"]).expect(0);
                let without = Wad::parse(folder.read("alone.wad")).expect("a sound WAD");
                assert_eq!(others(&out), others(&without));
                assert!(folder.read("out.wad") == folder.read("then.wad"));

                let map = DoomMap::parse(&out, &list_maps(&out)[0]).expect("a sound map");
                let table =
                    RejectTable::from_bytes(map.n_sectors(), map.reject().expect("a lump")).expect("a full table");
                assert!(table.n_rejected() > 0 && !table.has_hand_made_effects());
                folder.run(&["verify", "out.wad", "in.wad", "--rays", "2000"]).expect(0);
                let nodes = if kind == "text" { "ZNODES" } else { "NODES" };
                let is_built = |(name, bytes): &(String, Vec<u8>)| name == nodes && bytes.len() > 4;
                assert!(others(&out).iter().any(is_built), "{kind}: zdbsp has built nodes");
                n_runs += 1;
            }
        }
    }
    assert_eq!(n_runs, 12);
}

/// Whatever goes wrong in either program is said with the word that the editor looks for, and the exit code is not 0.
#[test]
fn the_script_says_what_goes_wrong() {
    let Some(zdbsp) = installed("zdbsp") else { return };
    let folder = Folder::with_wad();
    let args = |input: &str, out: &str| ["-R".to_owned(), "-o".to_owned(), out.to_owned(), input.to_owned()];
    folder.write("junk.wad", "no WAD at all");
    for input in ["junk.wad", "absent.wad"] {
        let (code, said) = run_script(&folder, &zdbsp, &args(input, "out.wad"));
        assert!(code > 0 && said.to_lowercase().contains("error"), "{code} {said}");
    }
    let (code, said) = run_script(&folder, Path::new("/no/such/zdbsp"), &args("maps.wad", "out.wad"));
    assert!(code > 0 && said.to_lowercase().contains("error"), "{code} {said}");
    let output = Command::new(guide("zdbsp-reject.sh"))
        .args(args("maps.wad", "out.wad"))
        .envs([("ZDBSP", zdbsp.as_path()), ("SIGHTLINES", Path::new("/no/such/sightlines"))])
        .current_dir(folder.path("."))
        .output()
        .expect("the script can be run");
    assert!(
        output.status.code() == Some(2)
            && String::from_utf8_lossy(&output.stderr).contains("error: no REJECT lump was built in out.wad")
    );
    // A node builder that writes a map with a line to nowhere.
    let mut bad = doom_map(1);
    bad.lines[0].v1 = 50_000;
    folder.write("out.wad", write_doom_map(LumpName::new("MAP01").expect("short"), &bad).expect("a small map"));
    let before = folder.read("out.wad");
    let (code, said) = run_script(&folder, Path::new("/bin/true"), &args("maps.wad", "out.wad"));
    assert!(code > 0 && said.contains("error: out.wad: map MAP01: LINEDEFS 0: vertex 50000"), "{code} {said}");
    assert!(folder.read("out.wad") == before);
}

/// A map of a game as a WAD of its own.
fn extract(game: &Wad, map: &str) -> Vec<u8> {
    let maps = list_maps(game);
    let lumps = maps.iter().find(|m| m.name().is(map)).expect("the map");
    let mut builder = WadBuilder::new(WadKind::Patch);
    for k in lumps.range() {
        builder.lump_named(game.lumps()[k].name, game.lump_bytes(k)).expect("a small map");
    }
    builder.finish().expect("a small file")
}

/// A recording of a player who walks, turns, shoots and opens doors, for `tics` tics from the start of E1M1.
fn recording(tics: u32) -> Vec<u8> {
    let mut random = sightlines_testkit::mutate::SplitMix::new(5);
    let mut bytes = vec![109, 3, 1, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0];
    let (mut forward, mut turn) = (50u8, 0u8);
    for tic in 0..tics {
        if tic.is_multiple_of(20) {
            let pick = random.next() as usize;
            forward = [50, 50, 25, 0, 206][pick % 5];
            turn = [0, 0, 3, 253, 8, 248][pick / 8 % 6];
        }
        let buttons = if tic % 40 < 20 { 1 } else { u8::from(tic % 40 == 30) * 2 };
        bytes.extend([forward, 0, turn, buttons]);
    }
    bytes.push(0x80);
    bytes
}

/// What the engine said, and where the player was in each tic.
fn play(folder: &Folder, engine: &Path, game: &Path, file: &str) -> (String, Vec<u8>) {
    let ghost = format!("{file}.gst");
    let output = Command::new("timeout")
        .arg("60")
        .arg(engine)
        .args(["-iwad".as_ref(), game.as_os_str()])
        .args(["-file", file, "-fastdemo", "walk.lmp", "-nosound", "-nomusic", "-nodraw", "-verbose"])
        .args(["-export_ghost", &ghost])
        .envs([("SDL_VIDEODRIVER", "dummy"), ("SDL_AUDIODRIVER", "dummy")])
        .env("HOME", folder.path("."))
        .current_dir(folder.path("."))
        .output()
        .expect("the engine can be run");
    let said = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
    assert!(output.status.success() && said.contains("Timed 2000 gametics"), "{file}: {said}");
    (said, folder.read(&ghost))
}

/// A real engine loads a map that went through zdbsp and `reject`, and plays a recording as it does without REJECT: nobody is blind who
/// was not. The impostors: a table that hides everything gives another game, and a table that is cut short is noticed.
#[test]
fn an_engine_plays_as_without_reject() {
    let (Some(zdbsp), Some(engine)) = (installed("zdbsp"), installed("dsda-doom")) else { return };
    let Some(game) = std::env::var_os("SIGHTLINES_FREEDOOM").map(|folder| Path::new(&folder).join("freedoom1.wad"))
    else {
        eprintln!("SKIPPED: SIGHTLINES_FREEDOOM is not set, so no engine has played a map with a REJECT lump");
        return;
    };
    let folder = Folder::new();
    folder.write("in.wad", extract(&Wad::read(&game).expect("the game"), "E1M1"));
    folder.write("walk.lmp", recording(2000));
    for (k, args) in configured("in.wad", "built.wad").iter().enumerate() {
        let (code, said) = run_script(&folder, &zdbsp, args);
        assert_eq!((code, said.as_str()), (0, ""));
        let wad = Wad::parse(folder.read("built.wad")).expect("a sound WAD");
        let maps = list_maps(&wad);
        let map = DoomMap::parse(&wad, &maps[0]).expect("a sound map");
        let reject = map.reject().expect("a lump");
        let n_rejected = reject.iter().map(|b| b.count_ones()).sum::<u32>();
        assert!(n_rejected * 2 > map.n_sectors() * map.n_sectors(), "{n_rejected} of pairs are rejected");
        let with = |name: &str, bytes: Vec<u8>| {
            folder.write(name, wad.with_rejects(&[(&maps[0], bytes)]).expect("a small file"));
            play(&folder, &engine, &game, name)
        };
        let none = with("none.wad", vec![0; reject.len()]);
        let built = play(&folder, &engine, &game, "built.wad");
        assert!(built.1.len() > 10_000, "{} bytes of places", built.1.len());
        assert!(built.1 == none.1, "the player was elsewhere than without REJECT");
        assert!(!built.0.contains("REJECT"), "{}", built.0);
        let blind = with("blind.wad", vec![0xff; reject.len()]);
        assert!(blind.1 != none.1, "nobody cares whether monsters are blind");
        let short = with("short.wad", reject[..100].to_vec());
        assert!(short.0.contains("REJECT too short"), "{}", short.0);
        eprintln!("engine run {k}: {n_rejected} of {} pairs rejected, the same 2000 tics", map.n_sectors().pow(2));
    }
}
