//! Outputs that cannot be written are reported first.

use crate::common::Folder;
use crate::common::picture::DRAWN;

/// The arguments with the name of an output behind the last option.
fn naming(args: &[&str], output: &str) -> Vec<String> {
    let mut with: Vec<String> = args.iter().map(|&arg| arg.to_owned()).collect();
    match args.last() {
        // A name is not needed there, so it has to stand in the same word.
        Some(&"--certify") => with.last_mut().expect("an option").push_str(&format!("={output}")),
        _ => with.push(output.to_owned()),
    }
    with
}

/// Outputs that cannot be written are reported before anything is read or computed; nothing is left behind.
#[test]
fn outputs_are_checked_first() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("taken.png")).expect("a folder");
    folder.write("file", "");
    let commands: &[&[&str]] = &[
        &["build", "none.wad", "-o"],
        &["build", "none.wad", "-o", "out.pvs", "--certify"],
        &["reject", "none.wad", "-o"],
        &["vis", "none.bsp", "-o"],
        &["verify", "none.pvs", "none.glb", "--draw"],
        &["walk", "none.pvs", "--random", "5", "-o"],
        &["walk", "none.pvs", "--random", "5", "-o", "out.svg", "--csv"],
        &["pack", "none.pvs", "-o"],
        &["unpack", "none.pvz", "-o"],
        &["export", "none.pvs", "-o"],
        &["explain", "none.pvs", "0", "1", "--draw"],
        &["draw", "none.pvs", "-o"],
        &["multifocal", "none.glb", "--volume", "0,0,0,1,1,1", "--plane", "x=9", "-o"],
        &["multifocal", "none.glb", "--volume", "0,0,0,1,1,1", "--plane", "x=9", "-o", "out.png", "--voronoi"],
        &["multifocal", "none.glb", "--volume", "0,0,0,1,1,1", "--plane", "x=9", "-o", "out.png", "--distance"],
        &["render", "none.glb", "--eye", "0,0,0", "--look-at", "1,1,1", "--compare", "-o"],
        &["light", "none.glb", "--eye", "0,0,0", "--look-at", "1,1,1", "--light", "0,0,0,1,1,1", "-o"],
        &["simplify", "none.glb", "--volume", "0,0,0,1,1,1", "-o"],
        &["strip", "none.glb", "-o"],
        &["levels", "none.glb", "--table", "none.pvs", "-o"],
        &["generate", "tower", "-o"],
        &["vga", "none.geojson", "--spacing", "1", "-o"],
    ];
    for args in commands {
        let ending = match args[0] {
            "simplify" | "strip" | "generate" => "glb",
            "levels" => "lod",
            "verify" | "explain" | "draw" => DRAWN,
            _ => "png",
        };
        for bad in [format!("no/out.{ending}"), format!("file/out.{ending}"), "taken.png".to_owned()] {
            if bad == "taken.png" && ending != "png" {
                continue;
            }
            let with = naming(args, &bad);
            let with: Vec<&str> = with.iter().map(String::as_str).collect();
            let error = folder.refused(&with);
            assert!(error.starts_with(&format!("{bad}: cannot be ")), "{with:?}: {error}");
        }
        // A place that can be written to leads on to what is read.
        let good = format!("new.{ending}");
        let with = naming(args, &good);
        let with: Vec<&str> = with.iter().map(String::as_str).collect();
        if args[0] != "generate" {
            let error = folder.refused(&with);
            assert!(error.starts_with("none."), "{with:?}: {error}");
        }
    }
    assert_eq!(folder.names(), ["file", "taken.png"]);
}
