//! Maps in a real engine: it loads what was written without complaint, and sees in it what is there.

use crate::common::Folder;
use crate::common::engine::{Loaded, load, server};
use crate::common::quake::row_of_leafs;
use sightlines::formats::quake::bsp::{BspChild, BspTree};
use sightlines::formats::quake::prt::{parse_prt, write_prt};
use sightlines::formats::quake::visibility::lump;
use sightlines::formats::quake::{Bsp, BspFormat, Prt};
use sightlines::pvs::{BitMatrix, CellId, Table};
use std::path::{Path, PathBuf};

fn engine(test: &str) -> Option<PathBuf> {
    let found = server();
    if found.is_none() {
        eprintln!(
            "SKIPPED {test}: darkplaces-server, a Quake engine in Debian's package of that name, is not installed"
        );
    }
    found
}

/// The leaf of a point that is at least a unit away from every plane on the way there.
fn leaf_at(tree: &BspTree, point: [f64; 3]) -> Option<usize> {
    let mut at = tree.root();
    loop {
        match at {
            BspChild::Leaf(leaf) => return Some(leaf as usize),
            BspChild::Node(node) => {
                let node = &tree.nodes()[node as usize];
                let height = node.height(point);
                at = node.children[usize::from(height < 0.0)];
                if height.abs() < 1.0 {
                    return None;
                }
            }
        }
    }
}

/// Points well inside some of the leafs that can be seen, spread over the map, with their clusters.
fn points(bsp: &Bsp, prt: &Prt, most: usize) -> Vec<([f32; 3], usize)> {
    let tree = bsp.world_tree().expect("a sound tree");
    let clusters = prt.leaf_clusters();
    let inside = |leaf: usize| {
        let bounds = bsp.leafs()[leaf];
        let steps = (0..343).map(|k| [k % 7, k / 7 % 7, k / 49].map(|step| (step as f32 + 0.7) / 7.4));
        let at = |share: [f32; 3]| -> [f32; 3] {
            std::array::from_fn(|k| bounds.mins[k] + share[k] * (bounds.maxs[k] - bounds.mins[k]))
        };
        steps.map(at).find(|&point| leaf_at(&tree, point.map(f64::from)) == Some(leaf))
    };
    let n = bsp.n_visible_leafs();
    let chosen = (1..=n).step_by(n.div_ceil(most));
    let found = chosen.filter_map(|leaf| Some((inside(leaf)?, clusters.cluster_of_leaf()[leaf - 1] as usize)));
    found.collect()
}

/// The first pair of points of which engine and matrix say different things, and how many pairs are hidden.
fn compare(loaded: &Loaded, points: &[([f32; 3], usize)], seen: &BitMatrix) -> (Option<[usize; 2]>, usize) {
    let n = points.len();
    assert!(loaded.seen.len() == n && loaded.seen.iter().all(|row| row.len() == n), "{}", loaded.text);
    let pairs = || (0..n).flat_map(|a| (0..n).map(move |b| [a, b]));
    let differs = |&[a, b]: &[usize; 2]| loaded.seen[a][b] != seen.get(points[a].1, points[b].1);
    (pairs().find(differs), pairs().filter(|&[a, b]| !loaded.seen[a][b]).count())
}

/// What `sightlines-vis` makes of a map is what the engine sees, and what a table of the portals has. With impostors: a pair that a map hides is missed,
/// and a lump that ends too early is complained about. How many pairs were compared, and how many of them are hidden.
fn check(engine: &PathBuf, bsp: &[u8], prt: &str, most: usize) -> (usize, usize) {
    let folder = Folder::new();
    folder.write("map.bsp", bsp);
    folder.write("map.prt", prt);
    folder.run_vis(&["map"]).expect(0);
    folder.run(&["build", "map.prt", "-o", "map.pvs"]).expect(0);
    let table = Table::from_bytes(&folder.read("map.pvs")).expect("a sound table");
    let n = table.n_cells();
    let mut seen = BitMatrix::new(n, n);
    (0..n).for_each(|cell| seen.row_mut(cell).copy_from_slice(table.row(CellId(cell as u32))));

    let (written, prt) = (folder.read("map.bsp"), parse_prt(prt.as_bytes()).expect("sound portals"));
    let bsp = Bsp::parse(written.clone()).expect("a sound map");
    let points = points(&bsp, &prt, most);
    let places: Vec<[f32; 3]> = points.iter().map(|point| point.0).collect();
    let loaded = load(engine, &written, &places);
    assert_eq!(loaded.complaints, Vec::<String>::new(), "{}", loaded.text);
    let (difference, n_hidden) = compare(&loaded, &points, &seen);
    assert_eq!(difference, None, "{}", loaded.text);

    // One pair less, in a map that is sound.
    let pair = (0..points.len()).flat_map(|a| (0..points.len()).map(move |b| [a, b]));
    let mut pair = pair.filter(|&[a, b]| points[a].1 != points[b].1 && loaded.seen[a][b]);
    let [a, b] = pair.next().expect("something is visible");
    let mut less = seen.clone();
    less.set(points[a].1, points[b].1, false);
    let lump = lump(&bsp, &prt.leaf_clusters(), &less).expect("a lump");
    let impostor = load(engine, &bsp.with_visibility(&lump).expect("a sound map"), &places);
    assert_eq!(impostor.complaints, Vec::<String>::new());
    assert!(compare(&impostor, &points, &seen).0.is_some() && compare(&impostor, &points, &less).0.is_none());
    // The last byte of the lump is missing.
    let mut short = written;
    let entry = bsp.format().magic().len() + 8 * bsp.format().visibility_lump() + 4;
    short[entry..entry + 4].copy_from_slice(&(bsp.visibility().len() as u32 - 1).to_le_bytes());
    let complaints = load(engine, &short, &places).complaints;
    // Of a row that is cut short, or of one of a byte, which is gone.
    let cut = ["Mod_Q1BSP_DecompressVis: input underrun", "Mod_Q1BSP_LoadLeafs: invalid visofs"];
    assert!(complaints.iter().any(|line| cut.iter().any(|text| line.contains(text))), "{complaints:?}");
    (points.len() * points.len(), n_hidden)
}

/// A map with another lump behind everything else.
fn with_lump(mut map: Vec<u8>, format: BspFormat, name: &str, lump: &[u8]) -> Vec<u8> {
    map.resize(map.len().next_multiple_of(4), 0);
    let index = format.lump_names().iter().position(|n| *n == name).expect("a lump");
    let entry = format.magic().len() + 8 * index;
    let place = [map.len() as u32, lump.len() as u32].map(u32::to_le_bytes).concat();
    map[entry..entry + 8].copy_from_slice(&place);
    map.extend(lump);
    map
}

/// Leafs in a row, of which the first and the last do not see each other.
#[test]
fn generated_maps_are_loaded() {
    let Some(engine) = engine("generated_maps_are_loaded") else { return };
    for format in [BspFormat::Bsp29, BspFormat::Bsp2, BspFormat::Bsp2Psb] {
        let mut map = row_of_leafs(format).bsp;
        // What the reader of visibility never looks at.
        for (name, lump) in [
            ("entities", &b"{\n\"classname\" \"worldspawn\"\n}\n\0"[..]),
            ("textures", &[]),
            ("lighting", &[]),
            ("clipnodes", &[]),
        ] {
            map = with_lump(map, format, name, lump);
        }
        let mut prt = Prt::new(4).expect("four leafs");
        for (leaf, low) in (0..3).zip([2.0, 58.0, 2.0]) {
            let x = 64.0 * f64::from(leaf + 1);
            let points = [[x, low, 24.0], [x, low + 4.0, 24.0], [x, low + 4.0, 40.0], [x, low, 40.0]];
            prt.push_portal([leaf, leaf + 1], &points).expect("a window");
        }
        assert_eq!(check(&engine, &map, &write_prt(&prt), 10), (16, 2), "{format:?}");
    }
}

#[test]
fn real_maps_are_loaded() {
    let Some(engine) = engine("real_maps_are_loaded") else { return };
    let Some(data) = std::env::var_os("SIGHTLINES_DATA") else {
        eprintln!("SKIPPED real_maps_are_loaded: SIGHTLINES_DATA is not set");
        return;
    };
    for (name, most) in [("dm3", 100), ("e1m7", 100)] {
        let read = |extension| std::fs::read(Path::new(&data).join("quake").join(name).with_extension(extension));
        let prt = String::from_utf8(read("prt").expect("portals")).expect("text");
        let (n_pairs, n_hidden) = check(&engine, &read("bsp").expect("a map"), &prt, most);
        eprintln!("{name}: {n_pairs} pairs of points, {n_hidden} hidden");
        assert!(n_pairs > 2500 && n_hidden > n_pairs / 4 && n_hidden < n_pairs, "{n_pairs}, {n_hidden}");
    }
}
