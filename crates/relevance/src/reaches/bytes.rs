//! The bytes of a `.rel` file.
//!
//! All numbers are little-endian.
//!
//! ```text
//! offset  size
//!      0     8  magic: 89 'R' 'E' 'L' 0D 0A 1A 0A
//!      8     2  version, 1
//!     10     1  who moves: 0 both, 1 the first alone
//!     11     1  ways: 0 straight, 1 through portals
//!     12     4  number of cells, n
//!     16     4  number of reaches, from 0 on, m
//!     20     4  checksum of the table: CRC-32 of its cells, rows and portals
//!     24    8m  the reaches, IEEE doubles
//!  24+8m     *  rungs, four bits each, compressed (RFC 1950): if both move, row i has those of cells 0 to i, else of all; each row begins with a byte
//!   end-4    4  CRC-32 of all bytes before
//! ```

use super::{MOST_REACHES, Nibbles, Reaches, WhoMoves, nibble, set_nibble};
use crate::distance::Ways;
use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use sightlines_pvs::Table;
use std::io::{Read, Write};

const MAGIC: [u8; 8] = *b"\x89REL\r\n\x1a\n";
const VERSION: u16 = 1;

/// Why bytes are no reaches of a table.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReachFileError {
    /// They begin with something else.
    #[error("not a file of reaches: it begins with other bytes")]
    Magic,
    /// Another version of the format.
    #[error("version {version} of the format; only version 1 is read")]
    Version {
        /// Which.
        version: u16,
    },
    /// Made of another table, or of a table that was built again since.
    #[error("the reaches are of another table, or the table was built again since")]
    OtherTable,
    /// Some bytes are missing or changed.
    #[error("the file is damaged at byte {offset}: {what}")]
    Damaged {
        /// Where.
        offset: usize,
        /// What is wrong there.
        what: &'static str,
    },
}

/// The checksum of what reaches depend on: cells, what they see, portals, and how precise their places are.
pub(super) fn checksum(table: &Table) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    let mut point = |p: &[f64; 3]| p.iter().for_each(|x| crc.update(&x.to_le_bytes()));
    table.cells().iter().for_each(|cell| [cell.min, cell.max].iter().for_each(&mut point));
    table.portals().iter().for_each(|portal| portal.points.iter().for_each(&mut point));
    if let Some(frame) = table.frame() {
        frame.axes().iter().for_each(&mut point);
        point(&[frame.gap(); 3]);
    }
    let joined = table.portals().iter().flat_map(|portal| portal.cells.map(|cell| cell.0));
    joined.for_each(|cell| crc.update(&cell.to_le_bytes()));
    crc.update(&[table.dimension(), u8::from(table.kind().is_quake())]);
    for i in 0..table.n_cells() {
        table.row(sightlines_pvs::CellId(i as u32)).iter().for_each(|word| crc.update(&word.to_le_bytes()));
    }
    crc.finalize()
}

fn damaged<T>(offset: usize, what: &'static str) -> Result<T, ReachFileError> {
    Err(ReachFileError::Damaged { offset, what })
}

/// The number of rungs that are stored of row `i`.
const fn stored(movers: WhoMoves, i: usize, n: usize) -> usize {
    match movers {
        WhoMoves::Both => i + 1,
        WhoMoves::One => n,
    }
}

impl Reaches {
    /// The bytes of a file. The same reaches give the same bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let n = self.n_cells();
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend([u8::from(self.movers == WhoMoves::One), u8::from(self.ways == Ways::Portals)]);
        bytes.extend((n as u32).to_le_bytes());
        bytes.extend((self.ladder.len() as u32).to_le_bytes());
        bytes.extend(self.table.to_le_bytes());
        self.ladder.iter().for_each(|r| bytes.extend(r.to_le_bytes()));
        let mut packed = ZlibEncoder::new(bytes, Compression::best());
        for i in 0..n {
            let len = stored(self.movers, i, n);
            let mut row = self.first.row(i)[..len.div_ceil(2)].to_vec();
            if len % 2 == 1 {
                row[len / 2] &= 15;
            }
            packed.write_all(&row).expect("a vector takes all bytes");
        }
        let mut bytes = packed.finish().expect("a vector takes all bytes");
        let crc = crc32fast::hash(&bytes);
        bytes.extend(crc.to_le_bytes());
        bytes
    }

    /// The reaches of a file, which have to be of this table.
    ///
    /// # Errors
    /// [`ReachFileError`]; no bytes panic, and none make more memory than the reaches of the table take.
    pub fn from_bytes(bytes: &[u8], table: &Table) -> Result<Self, ReachFileError> {
        if bytes.len() < MAGIC.len() || bytes[..MAGIC.len()] != MAGIC {
            return Err(ReachFileError::Magic);
        }
        let u32_at = |at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes(b.try_into().expect("four bytes")));
        let (Some(n), Some(n_reaches), Some(of)) = (u32_at(12), u32_at(16), u32_at(20)) else {
            return damaged(bytes.len(), "the file ends within its head");
        };
        let version = u16::from_le_bytes([bytes[8], bytes[9]]);
        if version != VERSION {
            return Err(ReachFileError::Version { version });
        }
        let end = bytes.len() - 4;
        if u32_at(end) != Some(crc32fast::hash(&bytes[..end])) {
            return damaged(end, "the checksum is wrong");
        }
        let (movers, ways) = match (bytes[10], bytes[11]) {
            (m @ 0..=1, w @ 0..=1) => {
                ([WhoMoves::Both, WhoMoves::One][m as usize], [Ways::Straight, Ways::Portals][w as usize])
            }
            _ => return damaged(10, "who moves, and on which ways, is 0 or 1"),
        };
        let n = n as usize;
        if n != table.n_cells() || of != checksum(table) {
            return Err(ReachFileError::OtherTable);
        }
        let m = n_reaches as usize;
        if !(1..=MOST_REACHES).contains(&m) || 24 + 8 * m > end {
            return damaged(16, "the number of reaches is none that is possible");
        }
        let reaches: Vec<f64> = bytes[24..24 + 8 * m]
            .chunks_exact(8)
            .map(|b| f64::from_le_bytes(b.try_into().expect("eight bytes")))
            .collect();
        if reaches[0] != 0.0 || reaches.windows(2).any(|r| !(r[0] < r[1] && r[1].is_finite())) {
            return damaged(24, "the reaches do not ascend from 0");
        }
        let mut packed = ZlibDecoder::new(&bytes[24 + 8 * m..end]);
        let mut first = Nibbles::new(n, 0);
        let mut row = vec![0; n.div_ceil(2)];
        for i in 0..n {
            let len = stored(movers, i, n);
            let row = &mut row[..len.div_ceil(2)];
            if packed.read_exact(row).is_err() {
                return damaged(24 + 8 * m, "the rungs are not complete");
            }
            for j in 0..len {
                let rung = nibble(row, j);
                // What sees each other is no matter of opinion.
                let sees = table.sees(sightlines_pvs::CellId(i as u32), sightlines_pvs::CellId(j as u32));
                if rung as usize > m || sees != (rung == 0) {
                    return damaged(24 + 8 * m, "a rung is none that is possible");
                }
                set_nibble(&mut first.bytes[i * first.stride..], j, rung);
                if movers == WhoMoves::Both {
                    set_nibble(&mut first.bytes[j * first.stride..], i, rung);
                }
            }
        }
        if !matches!(packed.read(&mut [0]), Ok(0)) || packed.total_in() != (end - 24 - 8 * m) as u64 {
            return damaged(24 + 8 * m, "something follows the rungs");
        }
        Ok(Self { ladder: reaches, movers, ways, first, table: of })
    }
}
