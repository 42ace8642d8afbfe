//! Maps of one format as maps of another, byte by byte and without the code under test: of Quake as of Half-Life and Hexen II, of
//! Quake II as of Qbism, Quake III and Wolfenstein.

use super::BspFormat;

/// The format whose maps are made into maps of this one; itself for those that are not made of others.
pub(crate) fn base(format: BspFormat) -> BspFormat {
    match format {
        BspFormat::HalfLife | BspFormat::Hexen2 => BspFormat::Bsp29,
        BspFormat::Qbism | BspFormat::Quake3 | BspFormat::Wolfenstein => BspFormat::Quake2,
        own => own,
    }
}

/// A map of the [base] of a format as one of the format. Visibility is left out where it is stored in another way.
///
/// # Panics
/// As everything here, if the bytes are no sound map.
pub(crate) fn map(bytes: &[u8], format: BspFormat) -> Vec<u8> {
    let from = base(format);
    let entry = |lump: usize| from.magic().len() + 8 * lump;
    let lump = |k: usize| {
        let [at, len] = [0, 4].map(|b| int(bytes, entry(k) + b) as usize);
        if len == 0 { Vec::new() } else { bytes[at..at + len].to_vec() }
    };
    let lumps = lumps((0..from.lump_names().len()).map(lump).collect(), format);
    let mut file = format.magic().to_vec();
    let directory = file.len();
    file.resize(format.header_len(), 0);
    for (k, lump) in lumps.iter().enumerate() {
        file.resize(file.len().next_multiple_of(4), 0);
        let place = [file.len(), lump.len()].map(|n| (n as u32).to_le_bytes());
        file[directory + 8 * k..][..8].copy_from_slice(&place.concat());
        file.extend(lump);
    }
    file
}

/// The lumps of a map of the [base] of a format as lumps of the format.
pub(crate) fn lumps(lumps: Vec<Vec<u8>>, format: BspFormat) -> Vec<Vec<u8>> {
    let get = |name: &str| {
        let index = base(format).lump_names().iter().position(|n| *n == name);
        index.map_or(Vec::new(), |k| lumps[k].clone())
    };
    let convert = |(k, name): (usize, &&str)| match (format, *name) {
        (BspFormat::Hexen2, "models") => records(&lumps[k], 64, |m| [&m[..52], &[0; 16], &m[52..]].concat()),
        (BspFormat::HalfLife | BspFormat::Hexen2, _) => lumps[k].clone(),
        (BspFormat::Qbism, _) => qbism(name, &lumps[k]),
        (_, name) => quake3(name, &get),
    };
    if base(format) == format {
        return lumps;
    }
    format.lump_names().iter().enumerate().map(convert).collect()
}

fn qbism(name: &str, lump: &[u8]) -> Vec<u8> {
    match name {
        "nodes" => records(lump, 28, |r| [&r[..12], &floats(&r[12..24]), &words(&r[24..])].concat()),
        "leafs" => records(lump, 28, |r| [&r[..4], &shorts(&r[4..8]), &floats(&r[8..20]), &words(&r[20..])].concat()),
        "faces" => records(lump, 20, |r| [&words(&r[..4]), &r[4..8], &words(&r[8..12]), &r[12..]].concat()),
        "edges" | "leaffaces" | "leafbrushes" | "brushsides" => words(lump),
        "visibility" => Vec::new(),
        _ => lump.to_vec(),
    }
}

fn quake3(name: &str, get: &dyn Fn(&str) -> Vec<u8>) -> Vec<u8> {
    let lump = get(name);
    match name {
        "planes" => records(&lump, 20, |r| r[..16].to_vec()),
        "nodes" => records(&lump, 28, |r| [&r[..12], &shorts(&r[12..24])].concat()),
        "leafs" => records(&lump, 28, |r| [&shorts(&r[4..20])[..], &words(&r[20..])].concat()),
        "leaffaces" | "leafbrushes" => words(&lump),
        "models" => records(&lump, 48, |r| [&r[..24], &r[40..], &[0; 8]].concat()),
        "vertices" => polygons(get).iter().flatten().flat_map(|p| [&p[..], &[0; 32]].concat()).collect(),
        "indices" => {
            let fan = |n: u32| (2..n).flat_map(|k| [0, k - 1, k]).flat_map(u32::to_le_bytes).collect::<Vec<_>>();
            polygons(get).iter().flat_map(|polygon| fan(polygon.len() as u32)).collect()
        }
        "faces" => {
            let (mut first, mut first_index) = (0u32, 0u32);
            let face = |polygon: &Vec<[u8; 12]>| {
                let (n, n_indices) = (polygon.len() as u32, 3 * (polygon.len() as u32).saturating_sub(2));
                let head = [0, 0, 1, first, n, first_index, n_indices].map(u32::to_le_bytes).concat();
                (first, first_index) = (first + n, first_index + n_indices);
                [&head[..], &[0; 76]].concat()
            };
            polygons(get).iter().flat_map(face).collect()
        }
        "entities" => lump,
        "visibility" => Vec::new(),
        other => other.as_bytes().to_vec(),
    }
}

/// The corners of the faces of a map of Quake II; none if it has no such.
fn polygons(get: &dyn Fn(&str) -> Vec<u8>) -> Vec<Vec<[u8; 12]>> {
    let [faces, surfedges, edges, vertices] = ["faces", "surfedges", "edges", "vertices"].map(get);
    let corner = |at: usize| -> Option<[u8; 12]> {
        let edge = i32::from_le_bytes(surfedges.get(4 * at..4 * at + 4)?.try_into().ok()?);
        let at = 4 * edge.unsigned_abs() as usize + if edge < 0 { 2 } else { 0 };
        let vertex = usize::from(u16::from_le_bytes(edges.get(at..at + 2)?.try_into().ok()?));
        vertices.get(12 * vertex..12 * vertex + 12)?.try_into().ok()
    };
    let polygon = |face: &[u8]| {
        let (first, n) = (int(face, 4) as usize, usize::from(u16::from_le_bytes([face[8], face[9]])));
        (first..first.saturating_add(n)).map_while(corner).collect()
    };
    faces.chunks_exact(20).map(polygon).collect()
}

fn records(lump: &[u8], len: usize, convert: impl Fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
    lump.chunks_exact(len).flat_map(convert).collect()
}

fn int(bytes: &[u8], at: usize) -> i32 {
    i32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn short(bytes: &[u8]) -> i16 {
    i16::from_le_bytes([bytes[0], bytes[1]])
}

/// Numbers of 16 bits with a sign as such of 32.
fn shorts(bytes: &[u8]) -> Vec<u8> {
    bytes.chunks_exact(2).flat_map(|b| i32::from(short(b)).to_le_bytes()).collect()
}

/// Numbers of 16 bits without a sign as such of 32.
fn words(bytes: &[u8]) -> Vec<u8> {
    bytes.chunks_exact(2).flat_map(|b| u32::from(short(b).cast_unsigned()).to_le_bytes()).collect()
}

/// Numbers of 16 bits with a sign as floats.
fn floats(bytes: &[u8]) -> Vec<u8> {
    bytes.chunks_exact(2).flat_map(|b| f32::from(short(b)).to_le_bytes()).collect()
}
