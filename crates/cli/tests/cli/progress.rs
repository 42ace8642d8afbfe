//! Progress where there is no terminal: lines on standard error.

use crate::common::quake::rooms;
use crate::common::{Folder, PROGRESS, Run};
use std::process::Command;

/// Runs a program on a map, with a line of progress as often as there is news, or every `every`.
fn run(folder: &Folder, program: &str, args: &[&str], every: &str) -> Run {
    folder.run_command(Command::new(program).args(args).env(PROGRESS, every)).expect(0)
}

#[test]
fn long_runs_print_their_progress() {
    let [sightlines, vis] = [env!("CARGO_BIN_EXE_sightlines"), env!("CARGO_BIN_EXE_sightlines-vis")];
    let map = rooms(12, 10);
    let folder = Folder::new();
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &map.prt);
    for (program, args) in
        [(sightlines, &["vis", "map.bsp"][..]), (vis, &["map.bsp"]), (sightlines, &["reject", "m.wad", "-o", "o.wad"])]
    {
        folder.write("m.wad", crate::common::wad(&["MAP01"]));
        let lines = run(&folder, program, args, "0").err;
        let shares = lines.lines().map(|line| {
            let (what, rest) = line.split_once(": ").expect("what is in progress");
            assert!(["visibility of clusters", "visibility of sectors"].contains(&what), "{line}");
            let (share, rest) = rest.split_once(" %").expect("a share");
            assert!(rest.is_empty() || rest.starts_with(", "), "{line}");
            share.parse::<u32>().expect("a number")
        });
        let shares: Vec<u32> = shares.collect();
        assert!(shares.len() > 2 && shares.is_sorted() && shares.last() == Some(&100), "{args:?}: {lines}");
        assert!(program != vis && args[0] != "vis" || lines.contains(" left"), "{lines}");
        // Nobody waits for what is over at once.
        for usual in ["5", "no number"] {
            assert_eq!(run(&folder, program, args, usual).err, "", "{args:?}");
        }
    }
    // Each of the options that ask for it turns them off.
    for args in [&["vis", "map.bsp", "--quiet"][..], &["vis", "map.bsp", "-q", "--fast"]] {
        assert_eq!(run(&folder, sightlines, args, "0").err, "");
    }
    for option in ["-quiet", "-noverbose", "-nopercent", "-noprogress"] {
        assert_eq!(run(&folder, vis, &[option, "map.bsp"], "0").err, "", "{option}");
    }
}
