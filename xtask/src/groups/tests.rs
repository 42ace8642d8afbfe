//! Tests of the choice, and of the table against the workspace.

use super::*;
use crate::step::root;
use std::fs;
use std::path::Path;
use toml::{Table, Value};

/// The groups that run when `file` was changed by the last commit but one, at a turn, with time for all.
fn brought(file: &str, layers: &Layers, turn: usize) -> Vec<&'static str> {
    let history = History::of(&[&[], &["docs/FIGURES.md"], &[file]]);
    let plan = choose(&GROUPS, layers, Some(&history), turn, u32::MAX);
    assert_eq!(plan.len(), GROUPS.len());
    plan.iter().filter(|(_, why)| matches!(why, Why::Changed { ago: 2, .. })).map(|(group, _)| group.name).collect()
}

/// The groups whose turn it is.
fn of_turn(turn: usize) -> Vec<&'static str> {
    GROUPS.iter().filter(|group| group.turn == turn % TURNS).map(|group| group.name).collect()
}

#[test]
fn a_change_in_a_crate_brings_the_groups_that_depend_on_it() {
    let layers = Layers::read().expect("it is readable");
    let mut n_compared = 0;
    for (file, expected, others) in [
        (
            "crates/pvs/src/table.rs",
            &["bevy", "python", "sanitizers", "browser", "lab", "program", "alone"][..],
            &[][..],
        ),
        ("crates/isovist/src/lib.rs", &["python", "benches", "program"], &["bevy", "sanitizers", "slurm"]),
        ("crates/walkthrough/src/walk.rs", &["bevy", "benches", "python"], &["browser", "slurm"]),
        ("crates/viewer/web/page.js", &["browser", "program", "wasm"], &["bevy", "slurm"]),
        ("crates/checkpoint/src/journal.rs", &["slurm", "stops", "python"], &["bevy", "browser"]),
        ("crates/capi/src/lib.rs", &["sanitizers", "alone", "package"], &["bevy", "python"]),
        ("shaders/wgsl/splat.wgsl", &["benches", "program"], &["bevy", "browser"]),
        ("python/src/bake.rs", &["python"], &["bevy", "lab"]),
        ("integrations/bevy/src/lib.rs", &["bevy"], &["python", "lab"]),
        ("crates/cli/tests/cli/slurm.rs", &["slurm", "program"], &["stops", "bevy"]),
        ("Cargo.lock", &["alone", "package"], &["stops"]),
        ("docs/ARCHITECTURE.md", &[], &["alone", "bevy", "program", "python"]),
        ("crates/pvs/tests/pvs/main.rs", &[], &["alone", "bevy", "program", "python"]),
    ] {
        // At every turn it is brought either by the change or by its turn.
        for turn in 0..TURNS {
            let brought = brought(file, &layers, turn);
            for name in expected {
                assert!(brought.contains(name) != of_turn(turn).contains(name), "{file}: {name} of {brought:?}");
                n_compared += 1;
            }
            assert!(!others.iter().any(|name| brought.contains(name)), "{file}: {brought:?}");
        }
    }
    assert!(n_compared > 100, "{n_compared}");
}

#[test]
fn impostor_layers_that_lack_a_line_do_not_bring_a_group() {
    let layers = Layers::read().expect("it is readable");
    let file = "crates/progress/src/lib.rs";
    assert!(brought(file, &layers, 0).contains(&"stops"));
    let forgotten =
        Layers::parse("[crates.checkpoint]\nuses = [\"formats\"]\n[crates.formats]\nuses = []\n").expect("layers");
    assert!(!brought(file, &forgotten, 0).contains(&"stops"));
}

#[test]
fn each_group_has_a_turn_in_six_gates_and_turns_fit() {
    let layers = Layers::read().expect("it is readable");
    let nothing = History::of(&[]);
    for first in [0, 17] {
        let mut seen = BTreeSet::new();
        for turn in first..first + TURNS {
            let plan = choose(&GROUPS, &layers, Some(&nothing), turn, SECONDS);
            let runs: Vec<_> = plan.iter().filter(|(_, why)| why.runs()).collect();
            assert!(runs.iter().all(|(_, why)| *why == Why::Turn), "{runs:?}");
            let seconds: u32 = runs.iter().map(|(group, _)| group.seconds).sum();
            assert!(!runs.is_empty() && seconds <= SECONDS, "turn {turn}: {seconds} s");
            seen.extend(runs.iter().map(|(group, _)| group.name));
        }
        assert_eq!(seen.len(), GROUPS.len(), "{seen:?}");
    }
}

#[test]
fn the_newest_change_is_first_and_what_does_not_fit_waits() {
    let layers = Layers::read().expect("it is readable");
    let history = History::of(&[&["python/src/lib.rs"], &["lab/src/lib.rs"], &["crates/geometry/src/lib.rs"]]);
    let group = |name: &str| *GROUPS.iter().find(|group| group.name == name).expect("a group");
    let time = of_turn(0).iter().map(|name| group(name).seconds).sum::<u32>() + group("python").seconds;
    let plan = choose(&GROUPS, &layers, Some(&history), 0, time + 5);
    let why = |name: &str| &plan.iter().find(|(group, _)| group.name == name).expect("a group").1;
    assert!(matches!(why("python"), Why::Changed { ago: 0, .. }));
    assert!(matches!(why("lab"), Why::NoTime { ago: 1, turn_in: 3, .. }), "{}", why("lab"));
    assert!(matches!(why("bevy"), Why::NoTime { ago: 2, turn_in: 5, .. }), "{}", why("bevy"));
    assert!(plan.iter().filter(|(_, why)| why.runs()).map(|(group, _)| group.seconds).sum::<u32>() <= time + 5);
    // Where git tells nothing, all of them run.
    assert!(choose(&GROUPS, &layers, None, 0, 0).iter().all(|(_, why)| why.runs()));
}

#[test]
fn names_and_files_of_the_table_are_those_of_the_workspace() {
    let layers = Layers::read().expect("it is readable");
    let names: BTreeSet<_> = GROUPS.iter().map(|group| group.name).collect();
    assert_eq!(names.len(), GROUPS.len());
    for group in &GROUPS {
        assert!(group.turn < TURNS);
        group.crates.iter().for_each(|name| assert!(layers.has(name), "{}: {name}", group.name));
        for path in group.paths {
            let there = root().join(path);
            let is_right = if path.ends_with('/') { there.is_dir() } else { there.is_file() };
            assert!(is_right, "{}: {path}", group.name);
        }
    }
}

/// The crates of this project that a manifest names, by their folders.
fn named_in(manifest: &str) -> BTreeSet<String> {
    let text = fs::read_to_string(root().join(manifest)).expect("it is readable");
    let table: Table = text.parse().expect("a manifest is TOML");
    let dependencies = table["dependencies"].as_table().expect("it depends on something");
    let path = |value: &Value| value.get("path").and_then(Value::as_str).map(str::to_owned);
    dependencies.values().filter_map(path).filter_map(|path| path.rsplit('/').next().map(str::to_owned)).collect()
}

#[test]
fn groups_of_other_workspaces_have_the_crates_of_their_manifests() {
    for (name, manifest) in [("bevy", "integrations/bevy/Cargo.toml"), ("python", "python/Cargo.toml")] {
        let group = GROUPS.iter().find(|group| group.name == name).expect("a group");
        let crates: BTreeSet<String> = group.crates.iter().map(|&name| name.to_owned()).collect();
        assert_eq!(crates, named_in(manifest), "{name}");
    }
}

/// Paths of modules below a folder that has the sources of a test program.
fn modules_below(folder: &Path, above: &str, found: &mut Vec<String>) {
    for entry in fs::read_dir(folder).expect("it is readable") {
        let path = entry.expect("an entry").path();
        let name = format!("{above}{}::", path.file_stem().and_then(|stem| stem.to_str()).expect("a plain name"));
        if path.is_dir() {
            modules_below(&path, &name, found);
            found.push(name);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(name);
        }
    }
}

/// A program leaves out tests whose path contains the name of a module. So no other test in it may have such a path.
#[test]
fn modules_of_groups_are_where_the_table_says_and_nowhere_else() {
    let mut n_looked_at = 0;
    for of_program in GROUPS.iter().flat_map(Group::modules) {
        let folder = root().join(of_program.sources);
        let mut all = Vec::new();
        modules_below(&folder, "", &mut all);
        for module in of_program.modules {
            let name = module.strip_suffix("::").expect("modules end so");
            let text = fs::read_to_string(folder.join(name).with_extension("rs")).expect("a file of this name");
            assert!(text.contains("#[test]"), "{module} has no tests");
            let found: Vec<_> =
                all.iter().filter(|path| path.contains(module) && !path.starts_with("common::")).collect();
            assert_eq!(found, [module], "all of these are left out");
            n_looked_at += 1;
        }
    }
    assert!(n_looked_at > 5, "{n_looked_at}");
}
