//! What `--help` shows: every option under a heading that says what it is about.

use crate::common::Folder;

/// All commands, with those that have others below them.
const COMMANDS: [&str; 36] = [
    "build",
    "reject",
    "vis",
    "portals",
    "plan",
    "job plan",
    "job shard",
    "job merge",
    "job submit",
    "job status",
    "tiles build",
    "tiles query",
    "tiles check",
    "verify",
    "isovist",
    "query",
    "walk",
    "relevance",
    "pack",
    "unpack",
    "export",
    "explain",
    "draw",
    "view",
    "multifocal",
    "render",
    "simplify",
    "strip",
    "vga",
    "light",
    "levels",
    "info",
    "generate tower",
    "generate gearbox",
    "generate world",
    "demo",
];

/// The headings of a help text, with how many options are below each.
fn headings(help: &str) -> Vec<(String, usize)> {
    let mut found: Vec<(String, usize)> = Vec::new();
    for line in help.lines() {
        let is_heading = line.ends_with(':') && !line.starts_with(' ') && line.len() < 40;
        if is_heading {
            found.push((line.trim_end_matches(':').to_owned(), 0));
        } else if line.trim_start().starts_with('-') && line.starts_with("  ") {
            found.last_mut().expect("options are below a heading").1 += 1;
        }
    }
    found
}

#[test]
fn options_are_grouped_and_those_of_all_commands_come_last() {
    let folder = Folder::new();
    for command in COMMANDS {
        let args: Vec<&str> = command.split(' ').chain(["-h"]).collect();
        let help = folder.run(&args).expect(0).out;
        let found = headings(&help);
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert!(!names.contains(&"Options"), "{command}: an option without a heading: {help}");
        assert_eq!(found.last(), Some(&("General".to_owned(), 3)), "{command}: {names:?}");
        let mut once = names.clone();
        once.sort_unstable();
        once.dedup();
        assert_eq!(once.len(), names.len(), "{command}: {names:?}");
        // Options for output have one heading, after those for the method.
        assert_eq!(names.iter().rev().nth(1), Some(&"Output"), "{command}: {names:?}");
    }
    let names: Vec<String> =
        headings(&folder.run(&["build", "-h"]).expect(0).out).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["Arguments", "Input", "Cells", "Method", "Multifocal buffers", "Resuming", "Output", "General"]);
    for args in [&["--help"][..], &["help", "render"], &["render", "--help"], &["-V"], &["--version"]] {
        assert!(!folder.run(args).expect(0).out.is_empty(), "{args:?}");
    }
}

/// Every command of the program is looked at above.
#[test]
fn all_commands_are_known_here() {
    let help = Folder::new().run(&["-h"]).expect(0).out;
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| line.starts_with("  "));
    // The description of a command may continue in the next line, further indented.
    let first = listed.filter(|line| !line.starts_with("   "));
    let listed: Vec<&str> = first.filter_map(|line| line.split_whitespace().next()).filter(|c| *c != "help").collect();
    let mut known: Vec<&str> = COMMANDS.iter().filter_map(|c| c.split(' ').next()).collect();
    known.dedup();
    assert_eq!(listed, known);
}

/// One of two options is needed, and the usage says so.
#[test]
fn what_render_needs_stands_in_its_usage() {
    let folder = Folder::new();
    let needed = "<--method <NAME[,NAME...]>|--compare>";
    let help = folder.run(&["render", "--help"]).expect(0).out;
    assert!(help.lines().any(|line| line.starts_with("Usage: ") && line.contains(needed)), "{help}");
    assert!(help.contains("this or --compare is needed"), "{help}");
    let run = folder.run(&["render", "s.glb", "--eye", "0,0,0", "--look-at", "1,1,1", "-o", "out.png"]).expect(2);
    assert!(run.err.contains(needed), "{}", run.err);
}
