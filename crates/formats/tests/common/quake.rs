//! Small maps of the Quake family, put together without the code that they test, and what has to hold of
//! whatever bytes are read as one.

use sightlines_formats::quake::bsp::LeafRow;
use sightlines_formats::quake::prt::{parse_prt, write_prt};
use sightlines_formats::quake::visibility::{self, VisibilityLump};
use sightlines_formats::quake::{Bsp, BspFormat, LeafClusters};

/// A portal file of each dialect: three clusters in a row, one of them of two leafs where leafs are listed.
pub const SMALL_PRTS: [&str; 3] = [
    "PRT1\n3\n2\n4 0 1 (0 0 0) (0 8 0) (0 8 8) (0 0 8) \n3 2 1 (64 0 0) (64.25 0 9) (64 1e-3 0.5) \n",
    "PRT2\n4\n3\n2\n4 0 1 (0 0 0) (0 8 0) (0 8 8) (0 0 8) \n3 2 1 (64 0 0) (64.25 0 9) (64 1e-3 0.5) \n2 -1\n0 3 -1\n1 -1\n",
    "PRT1-AM\n3\n2\n4\n4 0 1 (0 0 0) (0 8 0) (0 8 8) (0 0 8) \n3 2 1 (64 0 0) (64.25 0 9) (64 1e-3 0.5) \n1\n2\n0\n1\n",
];

/// What a small map is made of.
#[derive(Debug, Clone)]
pub struct SmallBsp {
    pub format: BspFormat,
    /// Leafs besides leaf 0, each with the textures of its faces.
    pub leafs: Vec<Vec<&'static str>>,
    /// How many of them can be seen.
    pub n_visible: usize,
    /// Clusters of all leafs but the first, for Quake II.
    pub clusters: Vec<i16>,
    pub visibility: Vec<u8>,
    /// Names and content of lumps behind the others.
    pub extra: Option<Vec<(&'static str, Vec<u8>)>>,
}

impl SmallBsp {
    /// Five leafs, of which four can be seen, with something to hear in two.
    pub fn new(format: BspFormat) -> Self {
        Self {
            format,
            leafs: vec![vec!["BRICK"], vec!["*Water1", "brick"], vec![], vec!["SKY1", "*lava"], vec!["*slime"]],
            n_visible: 4,
            clusters: vec![2, 0, 1, 0, -1],
            visibility: Vec::new(),
            extra: None,
        }
    }

    fn leaf(&self, leaf: usize, first: usize, count: usize) -> Vec<u8> {
        let wide = |n: usize| (n as u32).to_le_bytes().to_vec();
        let short = |n: usize| (n as u16).to_le_bytes().to_vec();
        let bounds = [0, 0, 0, 64, 64, 64i16];
        let shorts: Vec<u8> = bounds.iter().flat_map(|b| b.to_le_bytes()).collect();
        let floats: Vec<u8> = bounds.iter().flat_map(|b| f32::from(*b).to_le_bytes()).collect();
        let contents = if leaf == 0 { -2i32 } else { -1 }.to_le_bytes().to_vec();
        let row = (-1i32).to_le_bytes().to_vec();
        match self.format {
            BspFormat::Bsp29 => [contents, row, shorts, short(first), short(count), vec![9; 4]].concat(),
            BspFormat::Bsp2 => [contents, row, floats, wide(first), wide(count), vec![9; 4]].concat(),
            BspFormat::Bsp2Psb => [contents, row, shorts, wide(first), wide(count), vec![9; 4]].concat(),
            BspFormat::Quake2 => {
                let cluster = leaf.checked_sub(1).map_or(-1, |k| self.clusters[k]).to_le_bytes().to_vec();
                [contents, cluster, vec![0; 2], shorts, short(first), short(count), vec![0; 4]].concat()
            }
        }
    }

    /// The content of each lump, in the order of the directory.
    pub fn lumps(&self) -> Vec<Vec<u8>> {
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
        lumps
    }

    /// The file, with lumps in the order of the directory but visibility where `vis_last` wants it.
    pub fn file(&self, vis_last: bool) -> Vec<u8> {
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
pub fn small_bsps() -> Vec<Vec<u8>> {
    let mut files = Vec::new();
    for format in BspFormat::ALL {
        let mut map = SmallBsp::new(format);
        files.push(map.file(false));
        map.visibility = match format {
            // Three clusters, of which 0 and 1, and 1 and 2 see each other.
            BspFormat::Quake2 => {
                let places: Vec<u8> = [3u32, 28, 31, 29, 31, 30, 31].iter().flat_map(|n| n.to_le_bytes()).collect();
                [&places[..], &[3, 7, 6, 7]].concat()
            }
            _ => vec![0b1111, 0, 1],
        };
        map.extra = Some(vec![("BRUSHLIST", vec![1; 5]), ("EMPTY", vec![]), ("LMSHIFT", vec![2; 8])]);
        files.push(map.file(true));
    }
    files
}

/// Where `after` differs from `before` in more than visibility and what goes with it, if it does.
pub fn difference_besides_visibility(before: &Bsp, after: &Bsp) -> Option<String> {
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
                    leaf[len - 4..].fill(0);
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
pub fn check_prt(text: &[u8]) -> bool {
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
            assert!(error.line > 0 && error.column > 0 && error.to_string().len() < 300);
            false
        }
    }
}

/// Reads a map and its visibility, puts another lump in and reads it again; whether it could. What a fuzz target
/// does.
pub fn check_bsp(bytes: &[u8]) -> bool {
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
