//! The guides: every command in them works, in order, on input of the kind that they speak of.

use crate::common::dxf::small_drawing;
use crate::common::quake::row_of_leafs;
use crate::common::{Folder, bytes, levels};
use sightlines::formats::quake::BspFormat;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// A block of a guide between fences: what stands behind the opening fence, and the lines.
fn blocks(guide: &str) -> Vec<(String, String)> {
    let mut blocks = Vec::new();
    let mut open: Option<(String, String)> = None;
    for line in guide.lines() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some(kind), None) => open = Some((kind.trim().to_owned(), String::new())),
            (None, Some((_, text))) => {
                text.push_str(line);
                text.push('\n');
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a block is not closed");
    blocks
}

fn guide(name: &str) -> String {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guides").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The commands of a block, each in words without what stands behind `#`, a comment as for a shell.
fn commands(block: &str) -> impl Iterator<Item = Vec<&str>> {
    let lines = block.lines().filter(|line| !line.trim().is_empty() && !line.starts_with("cargo "));
    lines.map(|line| line.split_whitespace().take_while(|word| *word != "#").collect())
}

/// Runs the commands of a guide in a folder that has what it starts from; how many there were.
fn follow(folder: &Folder, name: &str) -> usize {
    outputs_of(folder, name).len()
}

/// Runs the commands of a guide in a folder that has what it starts from; each with what it printed. Files that a guide shows are written first.
fn outputs_of(folder: &Folder, name: &str) -> Vec<(String, String)> {
    let mut outputs = Vec::new();
    for (kind, text) in blocks(&guide(name)) {
        if let Some(file) = ["json ", "csv ", "rej ", "text "].iter().find_map(|kinds| kind.strip_prefix(kinds)) {
            folder.write(file, &text);
        }
        if kind != "sh" {
            continue;
        }
        for words in commands(&text) {
            // Quotes keep patterns from the shell.
            let args: Vec<&str> = words[1..].iter().map(|word| word.trim_matches('\'')).collect();
            let line = words.join(" ");
            let run = match words[0] {
                "sightlines" => folder.run(&args),
                "sightlines-vis" => folder.run_vis(&args),
                _ => panic!("{name}: {line}"),
            };
            // The answer may be no: two cells that do not see each other.
            let may_say_no = args[0] == "explain";
            assert!(
                run.code == 0 || may_say_no && run.code == 1,
                "{name}: {line}: exit code {}: {}",
                run.code,
                run.err
            );
            outputs.push((line, run.out));
        }
    }
    outputs
}

#[test]
fn the_guide_for_engines_works() {
    let folder = Folder::new();
    assert!(follow(&folder, "rust-engine.md") >= 7);
    // The picture of the guide is the one that its commands make, but for its size.
    folder.run(&["draw", "level.pvs", "--eye", "9,1.7,5", "--size", "900", "-o", "small.svg"]).expect(0);
    assert_same_picture("floor.svg", &folder.read("small.svg"));
}

/// What it writes tells the floors of the tower apart at once, and is small.
#[test]
fn the_guide_for_servers_works() {
    let folder = Folder::new();
    assert_eq!(follow(&folder, "servers.md"), 3);
    let rel = |args: &[&str]| {
        folder.run(&[&["relevance", "level.pvs", "-o", "out.rel", "--json"], args].concat()).expect(0).json()
    };
    let hidden = |reply: &serde_json::Value, i: usize| reply["reaches"][i]["hidden"].as_f64().expect("a share");
    let straight = rel(&[]);
    let n = straight["n_cells"].as_f64().expect("a number");
    assert!(straight["n_bytes"].as_f64().expect("a number") <= 4.0 / 8.0 * n * n, "4 bits a pair");
    assert_eq!(folder.read("out.rel"), folder.read("level.rel"), "the same again");
    assert!(hidden(&straight, 0) > hidden(&straight, 3) && hidden(&straight, 3) > 0.0);
    let walked = rel(&["--by-walking", "--threads", "1"]);
    assert!(hidden(&walked, 5) > hidden(&straight, 5), "ways through doors are longer");
    let one = rel(&["--one-moves", "--ladder", "1,2"]);
    assert!(one["reaches"].as_array().expect("reaches").len() == 3 && hidden(&one, 1) >= hidden(&straight, 3));
    for (args, why) in [(["--ladder", "2,1"], "not above the reach before it"), (["--ladder", "nan"], "is not finite")]
    {
        let run = folder.run(&[&["relevance", "level.pvs", "-o", "bad.rel"], &args[..]].concat());
        assert!(run.code == 2 && run.err.contains(why), "{}", run.err);
    }
}

/// The share of the polygons that a viewer has on average, in the last line of `build`.
fn polygons_of_a_viewer(out: &str) -> f64 {
    let (_, share) = out.split_once(": a viewer has ").expect("in the last line");
    share.split_whitespace().next().and_then(|number| number.parse().ok()).expect("a number")
}

/// What a point of a scene sees of others in a table: whether the cells of both see each other.
fn see_each_other(folder: &Folder, table: &str, a: &str, b: &str) -> bool {
    folder.run(&["explain", table, a, b]).code == 0
}

/// What the pictures of the guide show: behind the pane is a room, and only one of the tables has it.
#[test]
fn the_guide_for_blender_works() {
    let folder = Folder::new();
    folder.write("level.glb", levels::blender());
    assert_eq!(follow(&folder, "blender.md"), 6);
    for name in ["blender-before.svg", "blender-after.svg"] {
        assert_same_picture(name, &folder.read(name));
    }
    let behind_glass = |table: &str| see_each_other(&folder, table, "2,1.7,2", "5,1.7,3");
    assert_eq!((behind_glass("before.pvs"), behind_glass("level.pvs")), (false, true));
    let info = folder.run(&["info", "level.glb"]).expect(0).out;
    assert!(info.contains("classified by a name with noimp: Alarm-noimp"), "{info}");
    // The impostor: a table that takes glass for a wall is found by who knows better.
    let check = ["verify", "before.pvs", "level.glb", "--see-through", "*glass*", "--rays", "20000"];
    let found = folder.run(&check).expect(1).out;
    for kind in ["changed-geometry: what hides", "hidden-"] {
        assert!(found.contains(&format!("violation      {kind}")), "{found}");
    }
}

/// What it removes is what is hidden by construction, and nothing else of the file changes.
#[test]
fn the_guide_to_stripping_works() {
    let folder = Folder::new();
    let outputs = outputs_of(&folder, "strip.md");
    assert_eq!(outputs.len(), 12);
    for line in ["objects        38: 14 seen, 24 hidden (63.2 %)", "hidden         24 enclosed of the objects"] {
        assert!(outputs[1].1.contains(line) && guide("strip.md").contains(line), "{}", outputs[1].1);
    }
    let size = |name: &str| folder.read(name).len();
    assert!(size("least.glb") < size("small.glb") && size("small.glb") < size("light.glb"));
    assert!(size("light.glb") < size("gearbox.glb") && size("flagged.glb") > size("gearbox.glb"));
}

#[test]
fn the_guide_for_bim_works() {
    let folder = Folder::new();
    folder.write("building.glb", levels::bim());
    assert_eq!(follow(&folder, "bim.md"), 8);
    for name in ["bim-before.svg", "bim-after.svg"] {
        assert_same_picture(name, &folder.read(name));
    }
    folder.run(&["build", "building.glb", "--gap", "25", "-o", "shut.pvs"]).expect(0);
    // From the first room: the last one in its row, and the corridor before its door.
    let [eye, last, corridor] = ["2732,-732,1700", "10526,3768,1700", "3674,-3290,1700"];
    let sees = |table: &str| [last, corridor].map(|place| see_each_other(&folder, table, eye, place));
    assert_eq!(["before.pvs", "shut.pvs", "building.pvs"].map(sees), [[true, true], [false, false], [false, true]]);
    // Whoever checks a table hears of a gap that no file explains.
    let check =
        |table: &str| folder.run(&["verify", table, "building.glb", "--rays", "100", "--pairs", "1"]).expect(0).out;
    let remark = "times what single precision explains in this scene: rays cannot check anything narrower\n";
    let told = ["before.pvs", "shut.pvs", "building.pvs"].map(|table| check(table).contains(remark));
    assert_eq!(told, [false, true, true]);
}

/// The commands of the guide on buildings that were exported by others.
#[test]
fn the_guide_for_bim_works_on_a_real_building() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA") else {
        eprintln!("SKIPPED the_guide_for_bim_works_on_a_real_building: SIGHTLINES_DATA is not set");
        return;
    };
    let folder = Folder::new();
    let scene = Path::new(&data).join("scenes/duplex/duplex.glb");
    let scene = scene.to_str().expect("a path in UTF-8");
    let options = ["--see-through", "*Window*", "--gap", "0.003"];
    let run = folder.run(&[&["build", scene, "-o", "duplex.pvs", "-v"][..], &options].concat()).expect(0);
    assert!(
        run.out.contains("see-through    24 objects, classified by the pattern *Window*: IfcWindow_"),
        "{}",
        run.out
    );
    folder.run(&["verify", "duplex.pvs", scene, "--rays", "20000"]).expect(0);
}

#[test]
fn the_guide_for_scans_works() {
    let folder = Folder::new();
    folder.write("scan.glb", levels::scan(false));
    folder.write("pieces.glb", levels::scan(true));
    let outputs = outputs_of(&folder, "scans.md");
    assert_eq!(outputs.len(), 8);
    for name in ["scan-before.svg", "scan-after.svg"] {
        assert_same_picture(name, &folder.read(name));
    }
    // What the guide builds, and the pieces with lines of sight alone.
    let built = |scene: &str| {
        let start = format!("sightlines build {scene} ");
        let is_built = |line: &str| line.starts_with(&start) && !line.contains("--method");
        let (_, out) = outputs.iter().find(|(line, _)| is_built(line)).expect("the guide builds it");
        polygons_of_a_viewer(out)
    };
    let cells = ["--view-region", "0,0.5,0,32,3,32", "--grid", "12,1,12", "--method", "sightlines"];
    let lines = folder.run(&[&["build", "pieces.glb", "-o", "lines.pvs"][..], &cells].concat()).expect(0).out;
    assert_eq!((polygons_of_a_viewer(&lines), built("scan.glb")), (100.0, 100.0));
    let of_pieces = built("pieces.glb");
    assert!((60.0..80.0).contains(&of_pieces), "{of_pieces}");
}

/// A picture of the documents is the one that the program draws.
fn assert_same_picture(name: &str, drawn: &[u8]) {
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/pictures").join(name);
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&kept, drawn).expect("the picture can be written");
    }
    assert!(drawn == std::fs::read(kept).expect("the picture is there"), "{name}: BLESS=1 draws it anew");
}

/// The commands of the README, and the page that one of them writes.
static README: LazyLock<(Vec<String>, Vec<u8>)> = LazyLock::new(|| {
    let folder = Folder::new();
    let lines = outputs_of(&folder, "../../README.md").into_iter().map(|(line, _)| line).collect();
    (lines, folder.read("tower.html"))
});

#[test]
fn the_guide_to_the_viewer_works() {
    let blocks = blocks(&guide("viewer.md"));
    let blocks = blocks.iter().filter(|(kind, _)| kind == "sh");
    let lines: Vec<String> = blocks.flat_map(|(_, text)| commands(text)).map(|words| words.join(" ")).collect();
    assert_eq!(lines.len(), 3);
    // Commands of the README, in its order, are not run twice.
    let page = if README.0.iter().filter(|line| lines.contains(line)).eq(&lines) {
        README.1.clone()
    } else {
        let folder = Folder::new();
        follow(&folder, "viewer.md");
        folder.read("tower.html")
    };
    assert!(page.starts_with(b"<!DOCTYPE html>"));
}

#[test]
fn the_commands_of_the_readme_work() {
    assert_eq!(README.0.len(), 7);
}

#[test]
fn the_picture_of_the_readme_is_what_the_program_draws() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA") else {
        eprintln!("SKIPPED the_picture_of_the_readme: SIGHTLINES_DATA is not set");
        return;
    };
    let wad = Path::new(&data).join("doom/freedoom1_E1M1.wad");
    let folder = Folder::new();
    folder.run(&["build", wad.to_str().expect("a path in UTF-8"), "-o", "e1m1.pvs"]).expect(0);
    folder.run(&["draw", "e1m1.pvs", "--cell", "200", "--size", "800", "-o", "doom.svg"]).expect(0);
    assert_same_picture("doom.svg", &folder.read("doom.svg"));
}

#[test]
fn the_guide_for_quake_works() {
    let (folder, map) = (Folder::new(), row_of_leafs(BspFormat::Bsp29));
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &map.prt);
    assert!(follow(&folder, "quake.md") >= 8);
    // Every option of the guide is one of the program.
    let text = guide("quake.md");
    let (_, section) = text.split_once("## Swap one path").expect("a section");
    let (section, _) = section.split_once("\n## ").expect("another section");
    let words =
        section.split('`').filter(|word| word.starts_with('-')).map(|word| word.split(' ').next().unwrap_or(word));
    let options: Vec<&str> = words.collect();
    let help = folder.run_vis(&["-help"]).expect(0).out;
    assert!(options.len() > 25, "{options:?}");
    for option in options {
        assert!(help.contains(&format!(" -{option}")), "{option}");
    }
}

#[test]
fn the_guide_for_clusters_works() {
    let folder = Folder::new();
    crate::reject_folder::add_wads(&folder);
    assert_eq!(follow(&folder, "when-one-machine-is-not-enough.md"), 22);
    folder.run(&["reject", "wads", "-o", "whole-wads"]).expect(0);
    assert!(bytes(&folder, "new-wads") == bytes(&folder, "whole-wads"));
    assert!(folder.read("tower.pvs") == folder.read("whole.pvs"));
    assert!(!folder.path("tower.pvs.state").exists());
}

#[test]
fn the_guide_for_doom_works() {
    let folder = Folder::with_wad();
    crate::reject_folder::add_wads(&folder);
    assert!(follow(&folder, "doom.md") >= 6);
    assert_eq!(crate::common::names(&folder.path("new-wads")).len(), 3);
}

#[test]
fn the_guide_for_floor_plans_works() {
    let folder = Folder::new();
    folder.write("drawing.dxf", small_drawing());
    folder.run(&["generate", "tower", "--floors", "2", "--rooms-x", "2", "-o", "building.glb"]).expect(0);
    assert!(follow(&folder, "floor-plans.md") >= 11);
}

#[test]
fn the_guide_for_teaching_works() {
    assert!(follow(&Folder::new(), "teaching.md") >= 7);
}

/// The impostor: a command that fails is noticed.
#[test]
#[should_panic(expected = "exit code 2")]
fn commands_that_fail_are_noticed() {
    // The guide starts from files that this folder does not have.
    follow(&Folder::new(), "doom.md");
}
