//! Generated worlds as the files of a compiler of maps: portals, and a map that they belong to.

#[path = "../../crates/formats/tests/formats/common/convert.rs"]
mod convert;

use sightlines::formats::quake::BspFormat;
use sightlines::formats::quake::prt::{LeafList, Prt, write_prt};
use sightlines::geometry::{Aabb, Point3};
use sightlines::scenes::world::{World, WorldChild, WorldLeaf};

/// The portals of a world; every cell is a cluster of one leaf.
///
/// # Panics
/// If the world has no cell, or more than a file can have.
pub fn prt_of_world(world: &World) -> Prt {
    let mut prt =
        Prt::new(u32::try_from(world.graph.n_cells()).expect("ids have 32 bits")).expect("cells are clusters");
    for portal in world.graph.portals() {
        let cells = portal.cells.map(|cell| cell.0);
        prt.push_portal(cells, portal.shape.corners()).expect("portals of worlds are convex");
    }
    prt
}

/// The portal file of a world: `PRT1`.
///
/// # Panics
/// As [`prt_of_world`].
pub fn prt_text(world: &World) -> String {
    write_prt(&prt_of_world(world))
}

/// The portal file of a world whose leafs are listed, each as a cluster of its own: `PRT2` or `PRT1-AM`.
///
/// # Panics
/// As [`prt_of_world`].
pub fn prt_text_with_leafs(world: &World, list: LeafList) -> String {
    let prt = prt_of_world(world);
    let clusters = (0..prt.n_clusters()).collect();
    write_prt(&prt.with_leafs(list, clusters).expect("every leaf has its cluster"))
}

/// Textures of faces, taken in turn by the leafs that have faces.
const TEXTURES: [&str; 5] = ["brick", "*water0", "sky1", "floor", "*lava1"];

/// A map without visibility, with the tree, the leafs and the faces of a world: leaf `k + 1` is cell `k`, and in
/// Quake II of cluster `k`. A cell has a face where its own face lies next to something solid, or would if nothing
/// were cut away from it; the textures of water, sky and lava are among them.
///
/// # Panics
/// If the world is too large for the format: indices have 16 bits in `Bsp29` and `Quake2`.
pub fn bsp_bytes(world: &World, format: BspFormat) -> Vec<u8> {
    if convert::base(format) != format {
        return convert::map(&bsp_bytes(world, convert::base(format)), format);
    }
    let lumps = Lumps::new(world, format);
    let mut file = format.magic().to_vec();
    let directory = file.len();
    file.resize(format.header_len(), 0);
    for (k, name) in format.lump_names().iter().enumerate() {
        let lump = lumps.lump(name);
        file.resize(file.len().next_multiple_of(4), 0);
        let place = [file.len(), lump.len()].map(int);
        file[directory + 8 * k..][..8].copy_from_slice(&place.concat());
        file.extend(lump);
    }
    file
}

/// The content of lumps, for the most part as lists of equal records.
struct Lumps<'w> {
    world: &'w World,
    format: BspFormat,
    /// For each cell its leaf, and its faces: the plane, which side of it, and the corners.
    cells: Vec<(&'w WorldLeaf, Vec<Face<'w>>)>,
}

/// A face of a cell, as an index of planes of the file, and its corners.
struct Face<'w> {
    plane: usize,
    corners: &'w [Point3],
}

impl<'w> Lumps<'w> {
    fn new(world: &'w World, format: BspFormat) -> Self {
        let n_cuts = world.planes.len();
        let faces = |leaf: &'w WorldLeaf| {
            // The outermost walls are no cuts, but planes of the file behind those of the cuts.
            let is_wall =
                |k: usize| !world.planes.iter().any(|p| *p == leaf.planes[k] || p.flipped() == leaf.planes[k]);
            let wall = |k: usize| {
                leaf.planes[k].axis().map_or(0, |axis| 2 * axis + usize::from(leaf.planes[k].normal[axis] > 0))
            };
            let of = |k: usize| Face { plane: n_cuts + wall(k), corners: &leaf.faces[k] };
            (0..leaf.planes.len()).filter(|&k| is_wall(k)).map(of).collect()
        };
        let cells = world.cells().into_iter().map(|leaf| (leaf, faces(leaf))).collect();
        Self { world, format, cells }
    }

    fn is_wide(&self) -> bool {
        matches!(self.format, BspFormat::Bsp2 | BspFormat::Bsp2Psb)
    }

    /// An index: 16 or 32 bits.
    fn index(&self, n: usize) -> Vec<u8> {
        if self.is_wide() { int(n).to_vec() } else { short(n).to_vec() }
    }

    fn lump(&self, name: &str) -> Vec<u8> {
        let quake2 = self.format == BspFormat::Quake2;
        let n_faces = self.cells.iter().map(|(_, faces)| faces.len()).sum();
        match name {
            "entities" => b"{\n\"classname\" \"worldspawn\"\n}\n\0".to_vec(),
            "planes" => self.planes(),
            "textures" => textures(),
            "vertices" => self.corners().flat_map(floats).collect(),
            "nodes" => self.nodes(),
            "texinfo" if quake2 => (0..TEXTURES.len()).flat_map(texinfo2).collect(),
            "texinfo" => {
                (0..TEXTURES.len()).flat_map(|k| [vec![0; 32], int(k).to_vec(), vec![0; 4]].concat()).collect()
            }
            "faces" => self.faces(),
            "leafs" => self.leafs(),
            "marksurfaces" | "leaffaces" => (0..n_faces).flat_map(|k| self.index(k)).collect(),
            "edges" => self.edges(),
            "surfedges" => (1..=self.corners().count()).flat_map(int).collect(),
            "models" => self.model(),
            _ => Vec::new(),
        }
    }

    /// The corners of all faces, face by face.
    fn corners(&self) -> impl Iterator<Item = Point3> + '_ {
        self.cells.iter().flat_map(|(_, faces)| faces.iter().flat_map(|face| face.corners.iter().copied()))
    }

    /// 20 bytes each: the normal, the distance, the kind. First those of the cuts, then the six around the world.
    fn planes(&self) -> Vec<u8> {
        let unit = |k: usize, sign: f64| std::array::from_fn(|j| if j == k { sign } else { 0.0 });
        let box_ = self.world.bounds();
        let walls = (0..3).flat_map(|k| [(unit(k, -1.0), -box_.min[k]), (unit(k, 1.0), box_.max[k])]);
        let cuts = self.world.planes.iter().map(|p| {
            let length = p.normal.iter().map(|&n| f64::from(n).powi(2)).sum::<f64>().sqrt();
            (p.normal.map(|n| f64::from(n) / length), p.offset / length)
        });
        let record = |(normal, distance): (Point3, f64)| {
            let axis = (0..3).find(|&k| normal[k].abs() == 1.0).unwrap_or(3);
            [floats(normal), (distance as f32).to_le_bytes().to_vec(), int(axis).to_vec()].concat()
        };
        cuts.chain(walls).flat_map(record).collect()
    }

    fn nodes(&self) -> Vec<u8> {
        let leaf_index = |leaf: usize| self.world.leafs[leaf].cell.map_or(0, |cell| cell.idx() + 1);
        let child = |child| match child {
            WorldChild::Node(node) => node as i32,
            WorldChild::Leaf(leaf) => -1 - leaf_index(leaf) as i32,
        };
        let wide_children = self.format != BspFormat::Bsp29;
        let record = |node: &sightlines::scenes::world::WorldNode| {
            let children = node.children.into_iter().flat_map(|c| match wide_children {
                true => child(c).to_le_bytes().to_vec(),
                false => i16::try_from(child(c)).expect("a map of few leafs").to_le_bytes().to_vec(),
            });
            let head = int(node.plane).into_iter().chain(children);
            head.chain(self.bounds(self.world.bounds()))
                .chain([self.index(0), self.index(0)].concat())
                .collect::<Vec<u8>>()
        };
        self.world.nodes.iter().flat_map(record).collect()
    }

    /// Whole numbers of 16 bits, or floats in `BSP2`; rounded outwards.
    fn bounds(&self, b: Aabb<3>) -> Vec<u8> {
        let outwards = b.min.map(f64::floor).into_iter().chain(b.max.map(f64::ceil));
        match self.format {
            BspFormat::Bsp2 => outwards.flat_map(|x| (x as f32).to_le_bytes()).collect(),
            // What is too far out for 16 bits stays at the border.
            _ => outwards.flat_map(|x| (x as i16).to_le_bytes()).collect(),
        }
    }

    fn leafs(&self) -> Vec<u8> {
        let record = |contents: [u8; 4], row: [u8; 4], b: Aabb<3>, first: usize, count: usize| {
            let faces = [self.index(first), self.index(count)].concat();
            [&contents[..], &row, &self.bounds(b), &faces, &[0; 4]].concat()
        };
        let quake2 = self.format == BspFormat::Quake2;
        let nowhere = Aabb { min: [0.0; 3], max: [0.0; 3] };
        let solid = if quake2 { 1i32 } else { -2 }.to_le_bytes();
        let mut leafs =
            record(solid, [0xFF, 0xFF, if quake2 { 0 } else { 0xFF }, if quake2 { 0 } else { 0xFF }], nowhere, 0, 0);
        let mut first = 0;
        for (cell, (leaf, faces)) in self.cells.iter().enumerate() {
            let empty = if quake2 { 0i32 } else { -1 }.to_le_bytes();
            let row = match short(cell) {
                [low, high] if quake2 => [low, high, 0, 0],
                _ => [0xFF; 4],
            };
            leafs.extend(record(empty, row, leaf.bounds(), first, faces.len()));
            first += faces.len();
        }
        leafs
    }

    fn faces(&self) -> Vec<u8> {
        let mut out = Vec::new();
        let mut first = 0;
        for (cell, (_, faces)) in self.cells.iter().enumerate() {
            for face in faces {
                // A cell's walls are seen from inside, from behind their plane.
                for field in [self.index(face.plane), self.index(1), int(first).to_vec()] {
                    out.extend(field);
                }
                out.extend(self.index(face.corners.len()));
                out.extend(self.index(cell % TEXTURES.len()));
                out.extend([0xFF; 4]);
                out.extend([0xFF; 4]);
                first += face.corners.len();
            }
        }
        out
    }

    /// One for each corner, to the next of its face, behind one that is not used: an edge may be named backwards.
    fn edges(&self) -> Vec<u8> {
        let mut edges = [self.index(0), self.index(0)].concat();
        let mut first = 0;
        for face in self.cells.iter().flat_map(|(_, faces)| faces) {
            let n = face.corners.len();
            edges.extend((0..n).flat_map(|k| [self.index(first + k), self.index(first + (k + 1) % n)].concat()));
            first += n;
        }
        edges
    }

    fn model(&self) -> Vec<u8> {
        let b = self.world.bounds();
        let n_faces = self.cells.iter().map(|(_, faces)| faces.len()).sum();
        let head = [floats(b.min), floats(b.max), vec![0; 12]].concat();
        match self.format {
            BspFormat::Quake2 => [&head[..], &int(0), &int(0), &int(n_faces)].concat(),
            _ => [&head[..], &[0; 16], &int(self.cells.len()), &int(0), &int(n_faces)].concat(),
        }
    }
}

/// A number of textures, the place of each, and each: its name, its size, no pictures.
fn textures() -> Vec<u8> {
    let n = TEXTURES.len();
    let places = (0..n).flat_map(|k| int(4 + 4 * n + 40 * k));
    let texture = |name: &&str| {
        let mut bytes = name.as_bytes().to_vec();
        bytes.resize(16, 0);
        bytes.extend([int(16), int(16), int(0), int(0), int(0), int(0)].concat());
        bytes
    };
    int(n).into_iter().chain(places).chain(TEXTURES.iter().flat_map(texture)).collect()
}

/// Quake II names the texture where Quake has its index.
fn texinfo2(k: usize) -> Vec<u8> {
    let mut name = TEXTURES[k].as_bytes().to_vec();
    name.resize(32, 0);
    [vec![0; 40], name, vec![0xFF; 4]].concat()
}

fn int(n: usize) -> [u8; 4] {
    i32::try_from(n).expect("a map of less than 2 GiB").to_le_bytes()
}

fn short(n: usize) -> [u8; 2] {
    u16::try_from(n).expect("a map of few leafs").to_le_bytes()
}

fn floats(p: Point3) -> Vec<u8> {
    p.iter().flat_map(|&x| (x as f32).to_le_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines::cells::{CellGraph, Convex, Portal};
    use sightlines::formats::quake::prt::parse_prt;
    use sightlines::formats::quake::visibility::{check_portals, lump, read_visibility};
    use sightlines::formats::quake::{Bsp, graph_of_prt};
    use sightlines::pvs::BitMatrix;
    use sightlines::scenes::{BspWorldOptions, bsp_world};

    fn world(seed: u64) -> World {
        bsp_world(BspWorldOptions { seed, ..BspWorldOptions::default() }).unwrap()
    }

    /// Whether the portals are the same, whichever of their corners comes first: that depends on the axis that a
    /// portal faces most, which rounding decides for some.
    fn same_portals(a: &CellGraph<Convex>, b: &CellGraph<Convex>) -> bool {
        let turned = |portal: &Portal<Convex>| {
            let mut corners = portal.shape.corners().to_vec();
            let low = |&i: &usize, &j: &usize| corners[i].partial_cmp(&corners[j]).expect("corners are finite");
            let first = (0..corners.len()).min_by(low).expect("portals have corners");
            corners.rotate_left(first);
            (portal.cells, corners)
        };
        let all = |graph: &CellGraph<Convex>| graph.portals().iter().map(turned).collect::<Vec<_>>();
        a.n_cells() == b.n_cells() && all(a) == all(b)
    }

    #[test]
    fn worlds_survive_their_portal_files() {
        for seed in 0..20 {
            let world = world(seed);
            assert!(world.graph.portals().len() > 10);
            let prt = parse_prt(prt_text(&world).as_bytes()).unwrap();
            assert!(same_portals(&graph_of_prt(&prt), &world.graph));
            assert!(!same_portals(&graph_of_prt(&prt), &world.scaled(1.0 + f64::EPSILON).graph), "an impostor");
            for list in [LeafList::PerCluster, LeafList::PerLeaf] {
                let listed = parse_prt(prt_text_with_leafs(&world, list).as_bytes()).unwrap();
                assert_eq!(listed.leaf_clusters(), prt.leaf_clusters());
                assert!(same_portals(&graph_of_prt(&listed), &world.graph));
            }
        }
    }

    #[test]
    fn maps_fit_the_portals_of_their_world_and_no_others() {
        let mut n_heard = 0;
        for format in BspFormat::ALL {
            for seed in 0..5 {
                let world = world(seed);
                let prt = prt_of_world(&world);
                let bsp = Bsp::parse(bsp_bytes(&world, format)).unwrap();
                assert_eq!(check_portals(&bsp, &prt), Ok(()), "{format:?}");
                // An impostor: the portals of the same world somewhere else.
                let other = prt_of_world(&world.moved([900.0, 0.0, 0.0]));
                assert!(check_portals(&bsp, &other).is_err());
                let leafs = prt.leaf_clusters();
                let seen = BitMatrix::identity(leafs.n_clusters());
                let lump = lump(&bsp, &leafs, &seen).unwrap();
                n_heard += lump.ambient.iter().filter(|a| a.iter().any(|&x| x > 0)).count();
                let after = Bsp::parse(bsp.with_visibility(&lump).unwrap()).unwrap();
                assert_eq!(read_visibility(&after, &leafs), Ok(Some(seen)));
            }
        }
        assert!(n_heard > 50, "{n_heard}");
    }
}
