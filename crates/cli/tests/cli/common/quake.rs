//! Maps of the Quake family with their portals.

#[path = "../../../../formats/tests/formats/common/quake.rs"]
#[expect(dead_code, reason = "other tests use the rest")]
mod files;

use files::{SMALL_PRTS, SmallBsp, small_bsps};
use sightlines::formats::Prt;
use sightlines::formats::quake::prt::{LeafList, SolidFace, parse_prt, write_prt};
use sightlines::formats::quake::visibility::check_portals;
use sightlines::formats::quake::{Bsp, BspFormat};

/// The text of a portal file.
pub(crate) type Portals = String;

/// A map and its portals.
pub(crate) struct Map {
    pub(crate) name: String,
    pub(crate) format: BspFormat,
    pub(crate) bsp: Vec<u8>,
    pub(crate) prt: Portals,
}

/// A small map of each format, with and without visibility, with each dialect of portals that goes with it.
pub(crate) fn small_maps() -> Vec<Map> {
    let mut maps = Vec::new();
    for bytes in small_bsps() {
        let bsp = Bsp::parse(bytes.clone()).expect("a sound map");
        for text in SMALL_PRTS {
            let prt = parse_prt(text.as_bytes()).expect("sound portals");
            if check_portals(&bsp, &prt).is_ok() {
                let name = format!("{:?} with {}", bsp.format(), prt.dialect());
                maps.push(Map { name, format: bsp.format(), bsp: bytes.clone(), prt: text.to_owned() });
            }
        }
    }
    maps
}

/// A map of each format with a tree and faces: four leafs in a row, with windows between them that are squares of 16, and
/// its portals, in the dialect of its compilers. Leaf `k` is cluster `k`, but for Quake II and III, where they are clusters 2, 0, 1 and 0.
pub(crate) fn row_of_leafs(format: BspFormat) -> Map {
    let map = SmallBsp::with_world(format);
    let cluster = |leaf: usize| match format.has_clusters() {
        true => u32::try_from(map.clusters[leaf]).expect("a cluster"),
        false => leaf as u32,
    };
    let n_clusters = if format.has_clusters() { 3 } else { 4 };
    let mut prt = Prt::new(n_clusters).expect("some rooms");
    for leaf in 0..3 {
        let x = 64.0 * (leaf + 1) as f64;
        let points = [[x, 24.0, 24.0], [x, 40.0, 24.0], [x, 40.0, 40.0], [x, 24.0, 40.0]];
        prt.push_portal([cluster(leaf), cluster(leaf + 1)], &points).expect("a window");
    }
    let prt = match format {
        BspFormat::HalfLife => prt.with_leafs(LeafList::Counts, vec![0, 1, 2, 3]).expect("four leafs"),
        BspFormat::Quake3 | BspFormat::Wolfenstein => {
            let end = SolidFace { cluster: 0, points: vec![[256.0, 0.0, 0.0], [256.0, 64.0, 0.0], [256.0, 0.0, 64.0]] };
            prt.with_faces(vec![0, 1, 0], vec![end]).expect("a face")
        }
        _ => prt,
    };
    let name = format!("a row of leafs, {format:?}");
    Map { name, format, bsp: map.file(true), prt: write_prt(&prt) }
}

/// Rooms in a row of rows, each a leaf of a Quake map, with a window in each wall between two at a place that
/// differs from wall to wall.
pub(crate) fn rooms(columns: u32, rows: u32) -> Map {
    let mut prt = Prt::new(columns * rows).expect("some rooms");
    let mut leafs = vec![vec!["*water1"]];
    for y in 0..rows {
        for x in 0..columns {
            let (cell, x0, y0) = (y * columns + x, 16.0 * f64::from(x), 16.0 * f64::from(y));
            let (u, v) = (f64::from((cell * 7 + 3) % 11) + 1.0, f64::from((cell * 5 + 1) % 9) + 1.0);
            let corners = [(u, v), (u + 3.0, v), (u + 3.0, v + 4.0), (u, v + 4.0)];
            if x + 1 < columns {
                let points = corners.map(|(b, c)| [x0 + 16.0, y0 + b, c]);
                prt.push_portal([cell, cell + 1], &points).expect("a window");
            }
            if y + 1 < rows {
                // From the far room into the near one, against the axis.
                let points = corners.map(|(a, c)| [x0 + a, y0 + 16.0, c]);
                prt.push_portal([cell + columns, cell], &points).expect("a window");
            }
            leafs.push(if cell % 3 == 0 { vec!["sky1"] } else { vec![] });
        }
    }
    leafs.remove(0);
    let small = SmallBsp { n_visible: leafs.len(), leafs, ..SmallBsp::new(BspFormat::Bsp29) };
    let mut bsp = small.file(false);
    put_bounds(&mut bsp, columns);
    let map = Bsp::parse(bsp.clone()).expect("a sound map");
    check_portals(&map, &prt).expect("portals of the map");
    let name = format!("{columns} by {rows} rooms");
    Map { name, format: BspFormat::Bsp29, bsp, prt: write_prt(&prt) }
}

/// Where a map differs from what it was in more than visibility and what goes with it, if it does.
pub(crate) fn difference(before: &[u8], after: &[u8]) -> Option<String> {
    let [before, after] = [before, after].map(|bytes| Bsp::parse(bytes.to_vec()).expect("a sound map"));
    files::difference_besides_visibility(&before, &after)
}

/// Puts each leaf where its room is.
fn put_bounds(bytes: &mut [u8], columns: u32) {
    let lump = Bsp::parse(bytes.to_vec()).expect("a sound map").lumps()[BspFormat::Bsp29.leaf_lump()].clone();
    for (cell, leaf) in (0u32..).zip(bytes[lump].chunks_exact_mut(28).skip(1)) {
        let (x, y) = ((16 * (cell % columns)) as i16, (16 * (cell / columns)) as i16);
        let bounds = [x, y, 0, x + 16, y + 16, 16].into_iter().flat_map(i16::to_le_bytes);
        leaf[8..20].iter_mut().zip(bounds).for_each(|(byte, new)| *byte = new);
    }
}
