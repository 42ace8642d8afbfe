//! Quake maps as their bytes have them: tree, leafs and faces, read without the code that is tested with them.

use sightlines::formats::quake::BspFormat;

type Point = [f64; 3];

/// A map as its bytes have it, read without the code under test.
#[derive(Debug)]
pub struct RawMap<'b> {
    bytes: &'b [u8],
    format: BspFormat,
}

impl<'b> RawMap<'b> {
    /// The bytes of a map of any known format.
    ///
    /// # Panics
    /// As everything here, if the bytes are no sound map.
    pub fn new(bytes: &'b [u8]) -> Self {
        let format = BspFormat::ALL.into_iter().find(|f| bytes.starts_with(f.magic())).expect("a map");
        // Hexen II begins as Quake, with models of another length.
        let begins = Self { bytes, format };
        let is_hexen = format == BspFormat::Bsp29 && !begins.lump("models").len().is_multiple_of(64);
        Self { bytes, format: if is_hexen { BspFormat::Hexen2 } else { format } }
    }

    fn lump(&self, name: &str) -> &'b [u8] {
        let names = self.format.lump_names();
        let other = if name == "marksurfaces" { "leaffaces" } else { name };
        let index = names.iter().position(|n| *n == name || *n == other).expect("a lump");
        let entry = self.format.magic().len() + 8 * index;
        let [at, len] = [0, 4].map(|k| int(self.bytes, entry + k) as usize);
        &self.bytes[at..at + len]
    }

    fn is_wide(&self) -> bool {
        matches!(self.format, BspFormat::Bsp2 | BspFormat::Bsp2Psb | BspFormat::Qbism) || self.is_quake3()
    }

    fn is_quake3(&self) -> bool {
        matches!(self.format, BspFormat::Quake3 | BspFormat::Wolfenstein)
    }

    /// Normal and distance of a node's plane, and its children.
    fn node(&self, node: usize) -> ([f32; 4], [i32; 2]) {
        let (len, wide) = match self.format {
            BspFormat::Bsp29 | BspFormat::HalfLife | BspFormat::Hexen2 => (24, false),
            BspFormat::Bsp2 | BspFormat::Qbism => (44, true),
            BspFormat::Quake3 | BspFormat::Wolfenstein => (36, true),
            BspFormat::Bsp2Psb => (32, true),
            BspFormat::Quake2 => (28, true),
        };
        let record = &self.lump("nodes")[len * node..];
        let plane_len = if self.is_quake3() { 16 } else { 20 };
        let plane = &self.lump("planes")[plane_len * int(record, 0) as usize..];
        let child = |k: usize| if wide { int(record, 4 + 4 * k) } else { short(record, 4 + 2 * k) };
        (std::array::from_fn(|k| float(plane, 4 * k)), [child(0), child(1)])
    }

    /// Low and high corner of the world.
    pub fn bounds(&self) -> [Point; 2] {
        [0, 12].map(|at| std::array::from_fn(|k| float(self.lump("models"), at + 4 * k).into()))
    }

    fn root(&self) -> i32 {
        if self.is_quake3() { 0 } else { int(self.lump("models"), 36) }
    }

    /// Number of leafs, the solid one included.
    pub fn n_leafs(&self) -> usize {
        self.lump("leafs").len() / self.leaf_len()
    }

    /// The cluster that each leaf names; `None` where rows are for leafs.
    pub fn named_clusters(&self) -> Option<Vec<Option<u32>>> {
        let leafs = self.lump("leafs").chunks_exact(self.leaf_len());
        let cluster = |leaf: &[u8]| match self.format {
            BspFormat::Quake3 | BspFormat::Wolfenstein => int(leaf, 0),
            BspFormat::Qbism => int(leaf, 4),
            _ => short(leaf, 4),
        };
        let clusters = leafs.map(|leaf| u32::try_from(cluster(leaf)).ok()).collect();
        let has_clusters = self.is_quake3() || matches!(self.format, BspFormat::Quake2 | BspFormat::Qbism);
        has_clusters.then_some(clusters)
    }

    /// The leaf at a point, and how near to a plane the point came; exact for points on a grid of eighths.
    pub fn leaf_at(&self, p: Point) -> (usize, f64) {
        let (mut at, mut nearest) = (self.root(), f64::INFINITY);
        while at >= 0 {
            let (plane, children) = self.node(at as usize);
            nearest = nearest.min(height(&plane, p).abs());
            at = children[usize::from(exact_height(&plane, p) < 0)];
        }
        ((-1 - at) as usize, nearest)
    }

    /// The leafs that a segment goes through, in order, each with how long it is in there. Rounded.
    pub fn leafs_along(&self, from: Point, to: Point) -> Vec<(usize, f64)> {
        let length = (0..3).map(|k| (to[k] - from[k]).powi(2)).sum::<f64>().sqrt();
        let mut open = vec![(self.root(), from, to, length)];
        let mut met = Vec::new();
        while let Some((at, a, b, length)) = open.pop() {
            if at < 0 {
                met.push(((-1 - at) as usize, length));
                continue;
            }
            let (plane, children) = self.node(at as usize);
            let (ha, hb) = (height(&plane, a), height(&plane, b));
            let near = usize::from(ha < 0.0);
            if (ha < 0.0) == (hb < 0.0) {
                open.push((children[near], a, b, length));
                continue;
            }
            let t = (ha / (ha - hb)).clamp(0.0, 1.0);
            let middle = std::array::from_fn(|k| a[k] + t * (b[k] - a[k]));
            open.push((children[1 - near], middle, b, length * (1.0 - t)));
            open.push((children[near], a, middle, length * t));
        }
        met
    }

    fn leaf_len(&self) -> usize {
        match self.format {
            BspFormat::Bsp29 | BspFormat::HalfLife | BspFormat::Hexen2 | BspFormat::Quake2 => 28,
            BspFormat::Bsp2 => 44,
            BspFormat::Bsp2Psb => 32,
            BspFormat::Qbism => 52,
            BspFormat::Quake3 | BspFormat::Wolfenstein => 48,
        }
    }

    /// Low and high corner of a leaf.
    pub fn leaf_box(&self, leaf: usize) -> (Point, Point) {
        let record = &self.lump("leafs")[self.leaf_len() * leaf..];
        let at = |k: usize| match self.format {
            BspFormat::Bsp2 => f64::from(float(record, 8 + 4 * k)),
            BspFormat::Qbism => f64::from(float(record, 12 + 4 * k)),
            BspFormat::Quake3 | BspFormat::Wolfenstein => f64::from(int(record, 8 + 4 * k)),
            _ => f64::from(short(record, 8 + 2 * k)),
        };
        ([at(0), at(1), at(2)], [at(3), at(4), at(5)])
    }

    /// An index of 16 or 32 bits.
    fn index(&self, lump: &str, k: usize) -> usize {
        let bytes = self.lump(lump);
        if self.is_wide() { int(bytes, 4 * k) as usize } else { word(bytes, 2 * k) }
    }

    /// The faces that a leaf lists.
    pub fn marks(&self, leaf: usize) -> Vec<usize> {
        let record = &self.lump("leafs")[self.leaf_len() * leaf..];
        let [first, count] = match self.format {
            BspFormat::Bsp29 | BspFormat::HalfLife | BspFormat::Hexen2 | BspFormat::Quake2 => {
                [20, 22].map(|at| word(record, at))
            }
            BspFormat::Qbism => [36, 40].map(|at| int(record, at) as usize),
            BspFormat::Bsp2 | BspFormat::Quake3 | BspFormat::Wolfenstein => [32, 36].map(|at| int(record, at) as usize),
            BspFormat::Bsp2Psb => [20, 24].map(|at| int(record, at) as usize),
        };
        (first..first + count).map(|k| self.index("marksurfaces", k)).collect()
    }

    /// The first face of the world, and how many there are.
    pub fn world_faces(&self) -> (usize, usize) {
        let at = match self.format {
            BspFormat::Quake2 | BspFormat::Qbism => 40,
            BspFormat::Quake3 | BspFormat::Wolfenstein => 24,
            BspFormat::Hexen2 => 72,
            _ => 56,
        };
        let [first, count] = [0, 4].map(|k| int(self.lump("models"), at + k) as usize);
        (first, count)
    }

    /// The number of polygons of a face: one, or triangles.
    pub fn n_polygons(&self, face: usize) -> usize {
        if self.is_quake3() { self.corners(face).len() - 2 } else { 1 }
    }

    /// The corners of a face in turn.
    pub fn corners(&self, face: usize) -> Vec<Point> {
        if self.is_quake3() {
            // The vertices of a face that was converted are its corners.
            let record = &self.lump("faces")[104 * face..];
            let vertex = |k: i32| &self.lump("vertices")[44 * (int(record, 12) + k) as usize..];
            return (0..int(record, 16)).map(|k| std::array::from_fn(|j| float(vertex(k), 4 * j).into())).collect();
        }
        let record = &self.lump("faces")[face * if self.is_wide() { 28 } else { 20 }..];
        let (first, count) =
            if self.is_wide() { (int(record, 8), int(record, 12) as usize) } else { (int(record, 4), word(record, 8)) };
        let corner = |k: usize| {
            let edge = int(self.lump("surfedges"), 4 * (first as usize + k));
            let vertex = self.index("edges", 2 * edge.unsigned_abs() as usize + usize::from(edge < 0));
            let record = &self.lump("vertices")[12 * vertex..];
            std::array::from_fn(|j| float(record, 4 * j).into())
        };
        (0..count).map(corner).collect()
    }

    /// The leafs at a point of a face, on both sides of planes that the face lies in; `None` if that is hard to say.
    pub fn leafs_of_face_point(&self, p: Point, corners: &[Point], slack: f64) -> Option<Vec<usize>> {
        let (mut open, mut found) = (vec![self.root()], Vec::new());
        while let Some(at) = open.pop() {
            if at < 0 {
                found.push((-1 - at) as usize);
                continue;
            }
            let (plane, children) = self.node(at as usize);
            let h = height(&plane, p);
            let is_in_plane = corners.iter().all(|c| height(&plane, *c).abs() <= slack);
            if !is_in_plane && h.abs() <= 2.0 * slack {
                return None;
            }
            open.extend((is_in_plane || h > 0.0).then_some(children[0]));
            open.extend((is_in_plane || h < 0.0).then_some(children[1]));
        }
        Some(found)
    }

    /// All leafs that a point may be in, if planes are no nearer than this to where they should be.
    pub fn leafs_near(&self, p: Point, slack: f64) -> Vec<usize> {
        let (mut open, mut found) = (vec![self.root()], Vec::new());
        while let Some(at) = open.pop() {
            if at < 0 {
                found.push((-1 - at) as usize);
                continue;
            }
            let (plane, children) = self.node(at as usize);
            let h = height(&plane, p);
            open.extend((h >= -slack).then_some(children[0]));
            open.extend((h <= slack).then_some(children[1]));
        }
        found
    }
}

fn int(bytes: &[u8], at: usize) -> i32 {
    i32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn short(bytes: &[u8], at: usize) -> i32 {
    i16::from_le_bytes(bytes[at..at + 2].try_into().unwrap()).into()
}

fn word(bytes: &[u8], at: usize) -> usize {
    u16::from_le_bytes(bytes[at..at + 2].try_into().unwrap()).into()
}

fn float(bytes: &[u8], at: usize) -> f32 {
    f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn height(plane: &[f32; 4], p: Point) -> f64 {
    (0..3).map(|k| f64::from(plane[k]) * p[k]).sum::<f64>() - f64::from(plane[3])
}

/// The same in integers: eighths of a unit times 2^-90.
fn exact_height(plane: &[f32; 4], p: Point) -> i128 {
    let whole = |x: f64| {
        assert!(x.fract() == 0.0 && x.abs() < 2f64.powi(108), "{x}: beyond the integers of this test");
        x as i128
    };
    let part = |x: f32, unit: i32| whole(f64::from(x) * 2f64.powi(unit));
    (0..3).map(|k| part(plane[k], 90) * whole(p[k] * 8.0)).sum::<i128>() - part(plane[3], 93)
}
