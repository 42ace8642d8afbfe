//! Small maps of the Quake family, put together without the code that they test, and what has to hold of
//! whatever bytes are read as one.

#[path = "convert.rs"]
pub(crate) mod convert;

use sightlines_formats::quake::bsp::{BspChild, LeafRow};
use sightlines_formats::quake::prt::{parse_prt, write_prt};
use sightlines_formats::quake::visibility::{self, VisibilityLump};
use sightlines_formats::quake::{Bsp, BspFormat, LeafClusters};

/// A portal file of each dialect: three clusters in a row, one of them of two leafs where leafs are listed.
pub(crate) const SMALL_PRTS: [&str; 5] = [
    "PRT1\n3\n2\n4 0 1 (0 0 0) (0 8 0) (0 8 8) (0 0 8) \n3 2 1 (64 0 0) (64.25 0 9) (64 1e-3 0.5) \n",
    "PRT2\n4\n3\n2\n4 0 1 (0 0 0) (0 8 0) (0 8 8) (0 0 8) \n3 2 1 (64 0 0) (64.25 0 9) (64 1e-3 0.5) \n2 -1\n0 3 -1\n1 -1\n",
    "PRT1-AM\n3\n2\n4\n4 0 1 (0 0 0) (0 8 0) (0 8 8) (0 0 8) \n3 2 1 (64 0 0) (64.25 0 9) (64 1e-3 0.5) \n1\n2\n0\n1\n",
    "3\n2\n1\n1\n2\n4 0 1 (0 0 0) (0 8 0) (0 8 8) (0 0 8) \n3 2 1 (64 0 0) (64.25 0 9) (64 1e-3 0.5) \n",
    "PRT1\n3\n2\n1\n4 0 1 0 (0 0 0) (0 8 0) (0 8 8) (0 0 8) \n3 2 1 1 (64 0 0) (64.25 0 9) (64 1e-3 0.5) \n3 2 (64 0 0) (64.25 0 9) (64 1e-3 0.5) \n",
];

/// What a small map is made of.
#[derive(Debug, Clone)]
pub(crate) struct SmallBsp {
    pub format: BspFormat,
    /// Leafs besides leaf 0, each with the textures of its faces.
    pub leafs: Vec<Vec<&'static str>>,
    /// How many of them can be seen.
    pub n_visible: usize,
    /// Clusters of all leafs but the first, for Quake II and III.
    pub clusters: Vec<i16>,
    pub visibility: Vec<u8>,
    /// Names and content of lumps behind the others.
    pub extra: Option<Vec<(&'static str, Vec<u8>)>>,
    /// Whether there is a tree of leafs, and faces have corners: leaf `k` is the cube from `64 (k - 1)` to `64 k` in x,
    /// the last of those that can be seen has something solid behind it, and the faces of a leaf are squares in the
    /// middle of it across x.
    pub world: bool,
}

impl SmallBsp {
    /// Five leafs, of which four can be seen, with something to hear in two.
    pub(crate) fn new(format: BspFormat) -> Self {
        Self {
            format,
            leafs: vec![vec!["BRICK"], vec!["*Water1", "brick"], vec![], vec!["SKY1", "*lava"], vec!["*slime"]],
            n_visible: 4,
            clusters: vec![2, 0, 1, 0, -1],
            visibility: Vec::new(),
            extra: None,
            world: false,
        }
    }

    /// The same with a tree and corners.
    pub(crate) fn with_world(format: BspFormat) -> Self {
        Self { world: true, ..Self::new(format) }
    }

    fn is_wide(&self) -> bool {
        matches!(self.format, BspFormat::Bsp2 | BspFormat::Bsp2Psb)
    }

    /// An index of a face, an edge or a vertex.
    fn index(&self, n: usize) -> Vec<u8> {
        if self.is_wide() { (n as u32).to_le_bytes().to_vec() } else { (n as u16).to_le_bytes().to_vec() }
    }

    /// The lump of a name, as `lump_names` has it.
    pub(crate) fn lump(&self, name: &str) -> usize {
        self.format.lump_names().iter().position(|n| *n == name).expect("a lump")
    }

    /// Puts the tree and the faces of the world in.
    fn put_world(&self, lumps: &mut [Vec<u8>]) {
        let int = |n: i32| n.to_le_bytes();
        let floats = |p: &[f32]| -> Vec<u8> { p.iter().flat_map(|x| x.to_le_bytes()).collect() };
        let n_nodes = self.n_visible;
        let plane = |k: usize| [floats(&[1.0, 0.0, 0.0, 64.0 * (k + 1) as f32]), int(0).to_vec()].concat();
        lumps[self.lump("planes")] = (0..n_nodes).flat_map(plane).collect();
        let node = |k: usize| {
            // What is further on, or solid behind the last; then the leaf.
            let children = [if k + 1 < n_nodes { k as i32 + 1 } else { -1 }, -2 - k as i32];
            let children: Vec<u8> = match self.format {
                BspFormat::Bsp29 => children.iter().flat_map(|&c| (c as i16).to_le_bytes()).collect(),
                _ => children.iter().flat_map(|&c| int(c)).collect(),
            };
            let bounds = if self.format == BspFormat::Bsp2 { 24 } else { 12 };
            [int(k as i32).to_vec(), children, vec![0; bounds], self.index(0), self.index(0)].concat()
        };
        lumps[self.lump("nodes")] = (0..n_nodes).flat_map(node).collect();
        let places: Vec<usize> =
            self.leafs.iter().enumerate().flat_map(|(k, names)| names.iter().map(move |_| k)).collect();
        let corner = |leaf: usize, y: f32, z: f32| floats(&[64.0 * leaf as f32 + 32.0, y, z]);
        let square = |&leaf: &usize| {
            [corner(leaf, 8.0, 8.0), corner(leaf, 24.0, 8.0), corner(leaf, 24.0, 24.0), corner(leaf, 8.0, 24.0)]
                .concat()
        };
        lumps[self.lump("vertices")] = places.iter().flat_map(square).collect();
        // Behind an edge that is not used, every second one is backwards.
        let edge = |k: usize| {
            let ends = [k, k / 4 * 4 + (k + 1) % 4];
            let [a, b] = if k.is_multiple_of(2) { ends } else { [ends[1], ends[0]] };
            [self.index(a), self.index(b)].concat()
        };
        let n_corners = 4 * places.len();
        lumps[self.lump("edges")] =
            [[self.index(0), self.index(0)].concat(), (0..n_corners).flat_map(edge).collect()].concat();
        let listed = |k: usize| int(if k.is_multiple_of(2) { k as i32 + 1 } else { -1 - k as i32 });
        lumps[self.lump("surfedges")] = (0..n_corners).flat_map(listed).collect();
        let face = |k: usize| {
            let head = [self.index(0), self.index(0), int(4 * k as i32).to_vec(), self.index(4), self.index(k)];
            [head.concat(), vec![0; 8]].concat()
        };
        lumps[self.lump("faces")] = (0..places.len()).flat_map(face).collect();
        let marks = if self.format == BspFormat::Quake2 { "leaffaces" } else { "marksurfaces" };
        lumps[self.lump(marks)] = (0..places.len()).flat_map(|k| self.index(k)).collect();
        if self.format == BspFormat::Quake2 {
            lumps[self.lump("texinfo")] = vec![0; 76 * places.len()];
        }
        let run = [int(0), int(places.len() as i32)].concat();
        lumps[self.lump("models")] = match self.format {
            BspFormat::Quake2 => [vec![0; 36], int(0).to_vec(), run].concat(),
            _ => [vec![0; 52], int(self.n_visible as i32).to_vec(), run].concat(),
        };
    }

    fn leaf(&self, leaf: usize, first: usize, count: usize) -> Vec<u8> {
        let wide = |n: usize| (n as u32).to_le_bytes().to_vec();
        let short = |n: usize| (n as u16).to_le_bytes().to_vec();
        // Farther than bounds of 16 bits reach, leafs are all at the same place.
        let west = if self.world { (64 * leaf.saturating_sub(1)).min(32_000) as i16 } else { 0 };
        let bounds = [west, 0, 0, west + 64, 64, 64i16];
        let shorts: Vec<u8> = bounds.iter().flat_map(|b| b.to_le_bytes()).collect();
        let floats: Vec<u8> = bounds.iter().flat_map(|b| f32::from(*b).to_le_bytes()).collect();
        let codes = if self.format == BspFormat::Quake2 { [1, 0] } else { [-2i32, -1] };
        let contents = codes[usize::from(leaf > 0)].to_le_bytes().to_vec();
        let row = (-1i32).to_le_bytes().to_vec();
        match self.format {
            // Made of another.
            format if convert::base(format) != format => unreachable!("{format:?}"),
            BspFormat::Bsp29 => [contents, row, shorts, short(first), short(count), vec![9; 4]].concat(),
            BspFormat::Bsp2 => [contents, row, floats, wide(first), wide(count), vec![9; 4]].concat(),
            BspFormat::Bsp2Psb => [contents, row, shorts, wide(first), wide(count), vec![9; 4]].concat(),
            BspFormat::Quake2 => {
                let cluster = leaf.checked_sub(1).map_or(-1, |k| self.clusters[k]).to_le_bytes().to_vec();
                [contents, cluster, vec![0; 2], shorts, short(first), short(count), vec![0; 4]].concat()
            }
            _ => unreachable!("all that are no others"),
        }
    }

    /// The content of each lump, in the order of the directory.
    pub(crate) fn lumps(&self) -> Vec<Vec<u8>> {
        let base = convert::base(self.format);
        if base != self.format {
            let mut lumps = convert::lumps(Self { format: base, ..self.clone() }.lumps(), self.format);
            lumps[self.format.visibility_lump()] = self.visibility.clone();
            return lumps;
        }
        let n = self.format.lump_names().len();
        // Lumps that are not read hold bytes of their own, of lengths that are no multiples of four.
        let mut lumps: Vec<Vec<u8>> = (0..n).map(|k| vec![b'a' + k as u8; 3 + k % 5]).collect();
        let names: Vec<&str> = self.leafs.iter().flatten().copied().collect();
        let int = |n: usize| (n as i32).to_le_bytes();
        let wide = matches!(self.format, BspFormat::Bsp2 | BspFormat::Bsp2Psb);
        let mut first = 0;
        let mut leafs = self.leaf(0, 0, 0);
        for (k, names) in self.leafs.iter().enumerate() {
            leafs.extend(self.leaf(k + 1, first, names.len()));
            first += names.len();
        }
        lumps[self.format.leaf_lump()] = leafs;
        lumps[self.format.visibility_lump()] = self.visibility.clone();
        if self.format != BspFormat::Quake2 {
            // A texture, a texinfo, a face and a mark for each name, with one texture that is missing behind.
            let places = names.iter().enumerate().map(|(k, _)| int(4 + 4 * (names.len() + 1) + 16 * k));
            let named = names.iter().map(|name| {
                let mut bytes = name.as_bytes().to_vec();
                bytes.resize(16, 0);
                bytes
            });
            let head = int(names.len() + 1).into_iter().chain(places.flatten()).chain((-1i32).to_le_bytes());
            lumps[2] = head.chain(named.flatten()).collect();
            let texinfo = |k: usize| [vec![0; 32], int(k).to_vec(), vec![0; 4]].concat();
            lumps[6] = (0..names.len()).flat_map(texinfo).collect();
            let face = |k: usize| match wide {
                true => [vec![0; 16], int(k).to_vec(), vec![0; 8]].concat(),
                false => [vec![0; 10], (k as u16).to_le_bytes().to_vec(), vec![0; 8]].concat(),
            };
            lumps[7] = (0..names.len()).flat_map(face).collect();
            let mark = |k: usize| if wide { int(k).to_vec() } else { (k as u16).to_le_bytes().to_vec() };
            lumps[11] = (0..names.len()).flat_map(mark).collect();
            lumps[14] = [vec![0; 52], int(self.n_visible).to_vec(), vec![0; 8]].concat();
        }
        if self.world {
            self.put_world(&mut lumps);
        }
        lumps
    }

    /// The file, with lumps in the order of the directory but visibility where `vis_last` wants it.
    pub(crate) fn file(&self, vis_last: bool) -> Vec<u8> {
        let (lumps, vis) = (self.lumps(), self.format.visibility_lump());
        let mut order: Vec<usize> = (0..lumps.len()).collect();
        if vis_last {
            order.retain(|&k| k != vis);
            order.push(vis);
        }
        let mut file = self.format.magic().to_vec();
        let magic = file.len();
        file.resize(self.format.header_len(), 0);
        let pad = |file: &mut Vec<u8>| file.resize(file.len().next_multiple_of(4), 0xEE);
        for k in order {
            pad(&mut file);
            let at = (file.len() as u32).to_le_bytes();
            file[magic + 8 * k..][..4].copy_from_slice(&at);
            file[magic + 8 * k + 4..][..4].copy_from_slice(&(lumps[k].len() as u32).to_le_bytes());
            file.extend(&lumps[k]);
        }
        if let Some(extra) = &self.extra {
            pad(&mut file);
            file.extend([&b"BSPX"[..], &(extra.len() as u32).to_le_bytes()].concat());
            let mut at = file.len() + 32 * extra.len();
            for (name, bytes) in extra {
                let mut entry = name.as_bytes().to_vec();
                entry.resize(24, 0);
                file.extend([&entry[..], &(at as u32).to_le_bytes(), &(bytes.len() as u32).to_le_bytes()].concat());
                at += bytes.len();
            }
            file.extend(extra.iter().flat_map(|(_, bytes)| bytes));
        }
        file
    }
}

/// A small map of each format, with and without visibility, with additional lumps and without.
pub(crate) fn small_bsps() -> Vec<Vec<u8>> {
    let mut files = Vec::new();
    for format in BspFormat::ALL {
        let mut map = SmallBsp::new(format);
        files.push(map.file(false));
        map.visibility = match format {
            // Three clusters, of which 0 and 1, and 1 and 2 see each other.
            BspFormat::Quake2 | BspFormat::Qbism => {
                let places: Vec<u8> = [3u32, 28, 31, 29, 31, 30, 31].iter().flat_map(|n| n.to_le_bytes()).collect();
                [&places[..], &[3, 7, 6, 7]].concat()
            }
            BspFormat::Quake3 | BspFormat::Wolfenstein => {
                let rows: Vec<u8> = [3, 7, 6].into_iter().flat_map(u64::to_le_bytes).collect();
                [&[3, 0, 0, 0, 8, 0, 0, 0], &rows[..]].concat()
            }
            _ => vec![0b1111, 0, 1],
        };
        map.extra = Some(vec![("BRUSHLIST", vec![1; 5]), ("EMPTY", vec![]), ("LMSHIFT", vec![2; 8])]);
        files.push(map.file(true));
    }
    files
}

/// A small map of each format with a tree and with corners.
pub(crate) fn small_worlds() -> Vec<Vec<u8>> {
    let world = |format: BspFormat| match convert::base(format) {
        base if base == format => SmallBsp::with_world(format).file(true),
        base => convert::map(&SmallBsp::with_world(base).file(true), format),
    };
    BspFormat::ALL.into_iter().map(world).collect()
}

/// Reads the tree and the faces of a world; whether it could. What a fuzz target does.
pub(crate) fn check_world(bytes: &[u8]) -> bool {
    let Ok(bsp) = Bsp::parse(bytes.to_vec()) else { return false };
    let (tree, faces, lists) = (bsp.world_tree(), bsp.world_faces(), bsp.leaf_faces());
    if let Ok(tree) = &tree {
        let n_nodes = tree.nodes().len();
        let mut n_parents = vec![0; n_nodes];
        for (at, node) in tree.nodes().iter().enumerate() {
            for child in node.children {
                match child {
                    BspChild::Node(k) => n_parents[k as usize] += usize::from(k as usize > at),
                    BspChild::Leaf(leaf) => assert!((leaf as usize) < bsp.leafs().len()),
                }
            }
        }
        assert!(n_parents.iter().skip(1).all(|&n| n == 1), "every node has a parent before it");
        assert_eq!(tree.root() == BspChild::Node(0), n_nodes > 0);
    }
    if let Ok(faces) = &faces {
        let n_corners: usize = (0..faces.n_faces()).map(|k| faces.corners(k).len()).sum();
        let of_polygons = (0..faces.n_faces()).flat_map(|k| faces.polygons(k)).map(<[_]>::len);
        assert_eq!(of_polygons.sum::<usize>(), n_corners);
        assert!(n_corners <= bytes.len() && faces.range().len() == faces.n_faces());
    }
    if let Ok(lists) = &lists {
        assert_eq!(lists.n_leafs(), bsp.n_visible_leafs());
        let n_listed: usize = (0..lists.n_leafs()).map(|leaf| lists.of(leaf).len()).sum();
        assert!(n_listed <= 2 * bytes.len());
    }
    for error in [tree.as_ref().err(), faces.as_ref().err(), lists.as_ref().err()].into_iter().flatten() {
        assert!(error.to_string().starts_with("lump "), "{error}");
    }
    tree.is_ok() && faces.is_ok() && lists.is_ok()
}

/// Where `after` differs from `before` in more than visibility and what goes with it, if it does.
pub(crate) fn difference_besides_visibility(before: &Bsp, after: &Bsp) -> Option<String> {
    let format = before.format();
    if format != after.format() || before.lumps().len() != after.lumps().len() {
        return Some(format!("{format:?}, then {:?}", after.format()));
    }
    for lump in (0..before.lumps().len()).filter(|&k| k != format.visibility_lump()) {
        let (mut old, mut new) = (before.lump_bytes(lump).to_vec(), after.lump_bytes(lump).to_vec());
        if lump == format.leaf_lump() && !format.has_clusters() && old.len() == new.len() {
            let (len, n) = (old.len() / before.leafs().len(), before.n_visible_leafs());
            for bytes in [&mut old, &mut new] {
                for leaf in bytes.chunks_exact_mut(len).skip(1).take(n) {
                    leaf[4..8].fill(0);
                    if format.has_sounds() {
                        leaf[len - 4..].fill(0);
                    }
                }
            }
        }
        if old != new {
            return Some(format!("lump {lump} ({}) differs", format.lump_names()[lump]));
        }
        let aligned = |bsp: &Bsp| bsp.lumps()[lump].start % 4;
        if aligned(before) != aligned(after) {
            return Some(format!("lump {lump} ({}) moved by no multiple of four", format.lump_names()[lump]));
        }
    }
    let extra = |bsp: &Bsp| -> Vec<(Vec<u8>, Vec<u8>)> {
        let lumps = bsp.extra_lumps().into_iter();
        lumps.map(|(name, range)| (name.to_vec(), bsp.as_bytes()[range].to_vec())).collect()
    };
    let (old, new) = (extra(before), extra(after));
    (old != new).then(|| format!("additional lumps differ: {old:?}, then {new:?}"))
}

/// Reads portals, writes them and reads them again; whether it could. What a fuzz target does.
pub(crate) fn check_prt(text: &[u8]) -> bool {
    match parse_prt(text) {
        Ok(prt) => {
            let written = write_prt(&prt);
            assert_eq!(parse_prt(written.as_bytes()).as_ref(), Ok(&prt));
            let leafs = prt.leaf_clusters();
            assert_eq!(leafs.n_clusters(), prt.n_clusters() as usize);
            for portal in prt.portals() {
                assert!(
                    (3..=64).contains(&portal.points.len()) && portal.clusters.iter().all(|&c| c < prt.n_clusters())
                );
                portal.is_degenerate();
            }
            true
        }
        Err(error) => {
            assert!(
                error.place.starts_with("line ")
                    && ["line 0", "column 0"].iter().all(|none| !error.place.contains(none))
                    && error.to_string().len() < 300
            );
            false
        }
    }
}

/// Reads a map and its visibility, puts another lump in and reads it again; whether it could. What a fuzz target
/// does.
pub(crate) fn check_bsp(bytes: &[u8]) -> bool {
    let Ok(bsp) = Bsp::parse(bytes.to_vec()) else { return false };
    let n = if bsp.format().has_clusters() { bsp.n_clusters() } else { bsp.n_visible_leafs() };
    // A leaf may name cluster 32767, and a table for so many takes its time.
    let Ok(leafs) = LeafClusters::identity(n.min(512) as u32) else { return true };
    let read = visibility::read_visibility(&bsp, &leafs);
    let seen = match read {
        Ok(Some(seen)) => seen,
        _ => sightlines_pvs::BitMatrix::identity(n),
    };
    let Ok(lump) = visibility::lump(&bsp, &leafs, &seen) else { return true };
    let zeros = VisibilityLump { bytes: vec![0; lump.bytes.len() + 7], ..lump.clone() };
    for lump in [lump, zeros] {
        let Ok(written) = bsp.with_visibility(&lump) else { continue };
        let after = Bsp::parse(written).expect("what is written can be read");
        assert_eq!(after.visibility(), lump.bytes);
        assert_eq!(difference_besides_visibility(&bsp, &after), None);
        if !bsp.format().has_clusters() {
            let rows: Vec<LeafRow> = lump.leaf_rows.iter().map(|&row| LeafRow::At(row)).collect();
            assert_eq!(after.visible_leafs().iter().map(|l| l.row).collect::<Vec<_>>(), rows);
        }
        if lump.bytes.iter().any(|&b| b != 0) {
            assert_eq!(visibility::read_visibility(&after, &leafs), Ok(Some(seen.clone())));
        }
        assert_eq!(after.with_visibility(&lump).as_deref(), Ok(after.as_bytes()), "nothing changes twice");
    }
    true
}
