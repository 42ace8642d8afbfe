//! Proofs of scenes in space as bytes.
//!
//! After the frame: the checksum of the network (four bytes); lines; blockers; proofs of boxes; from version 2 on the checksum of the
//! objects and proofs about them. Each list begins with its length. A box is given by six indices of coordinates of the network.

use super::branch::{Branch, Bypass, Claim, Sum};
use super::network::{AxialLine, AxialName};
use super::{AxialProofs, BoxProof, ObjectProof};
use crate::bytes::{
    Coded, FIRST_VERSION, Kind, ReadError, ReadErrorKind, Reader, VERSION, Writer, framed, is_wide, unframed_of,
};
use num_bigint::BigInt;

/// Depth of branches that are read.
const DEEPEST: usize = 200;
/// Most ways past a blocker that are written.
const MOST_WAYS: usize = 100;
/// Most claims of a sum that are written.
const MOST_CLAIMS: usize = 254;

/// Whether reading the bytes of octants gives the same octants.
pub(super) fn can_be_written(octants: &[(u8, Branch)]) -> bool {
    let mut before = 0u8;
    octants.iter().all(|(octant, branch)| {
        let is_new = *octant < 8 && before >> octant & 1 == 0;
        before |= 1 << (octant & 7);
        is_new && branch_can(branch, 0)
    })
}

fn branch_can(branch: &Branch, depth: usize) -> bool {
    let sum_can = |sum: &Sum| sum.len() <= MOST_CLAIMS;
    match branch {
        Branch::Empty(sum) => sum_can(sum),
        Branch::Past { ways, rest, .. } => {
            let is_way = |way: Bypass| way_of(code_of(way)) == way;
            depth < DEEPEST
                && ways.len() <= MOST_WAYS
                && rest.iter().all(sum_can)
                && ways.iter().all(|(way, branch)| is_way(*way) && branch_can(branch, depth + 1))
        }
    }
}

impl AxialProofs {
    /// The bytes of these proofs: the same for equal proofs.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut writer = Writer::for_network(self.checksum);
        writer.list(&self.lines);
        writer.list(&self.blockers);
        writer.list(&self.boxes);
        if self.objects.is_empty() {
            return framed(Kind::Axial, FIRST_VERSION, writer);
        }
        self.objects_checksum.to_le_bytes().into_iter().for_each(|byte| writer.byte(byte));
        writer.list(&self.objects);
        framed(Kind::Axial, VERSION, writer)
    }

    /// Reads proofs without checking what they prove: see [`AxialProofs::check`].
    ///
    /// # Errors
    /// [`ReadError`] with the offset of what is wrong.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ReadError> {
        let (checksum, mut reader) = unframed_of(Kind::Axial, bytes)?;
        let (lines, blockers, boxes) = (reader.list()?, reader.list()?, reader.list()?);
        let mut proofs = Self { checksum, lines, blockers, boxes, ..Self::default() };
        if reader.is_newer() {
            let four = reader.bytes(4)?;
            proofs.objects_checksum = u32::from_le_bytes([four[0], four[1], four[2], four[3]]);
            proofs.objects = reader.list()?;
            // Without any, the version before has the same bytes.
            if proofs.objects.is_empty() {
                return reader.fail(1, ReadErrorKind::Number);
            }
        }
        reader.end().map(|()| proofs)
    }
}

/// Twice the cell, plus 1 if coordinates are wide; then the points.
impl Coded for AxialLine {
    const LEAST: usize = 25;

    fn write(&self, writer: &mut Writer) {
        let bits = self.points.as_flattened();
        let wide = is_wide(bits);
        writer.number(2 * u64::from(self.cell) + u64::from(wide));
        writer.coordinates(bits, wide);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, ReadError> {
        let head = reader.number()?;
        Ok(Self { cell: head / 2, points: reader.points(head % 2 == 1)? })
    }
}

/// The lower indices, then the differences to the upper ones.
impl Coded for AxialName {
    const LEAST: usize = 6;

    fn write(&self, writer: &mut Writer) {
        let [low, high] = self.0;
        low.iter().for_each(|&x| writer.number(x));
        low.iter().zip(&high).for_each(|(x, y)| writer.number(y.wrapping_sub(*x)));
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut name = Self::default();
        for side in 0..2 {
            for k in 0..3 {
                let x = reader.number()?;
                let base = if side == 0 { 0 } else { name.0[0][k] };
                match base.checked_add(x) {
                    Some(x) => name.0[side][k] = x,
                    None => return reader.fail(0, ReadErrorKind::Number),
                }
            }
        }
        Ok(name)
    }
}

/// The names of the boxes; a byte with a bit for each octant; the branches of these octants, ascending.
impl Coded for BoxProof {
    const LEAST: usize = 13;

    fn write(&self, writer: &mut Writer) {
        self.boxes.iter().for_each(|name| name.write(writer));
        write_octants(&self.octants, writer);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, ReadError> {
        let boxes = [AxialName::read(reader)?, AxialName::read(reader)?];
        Ok(Self { boxes, octants: read_octants(reader)? })
    }
}

/// The name of the box; the object; its octants as those of a pair of boxes.
impl Coded for ObjectProof {
    const LEAST: usize = 8;

    fn write(&self, writer: &mut Writer) {
        self.cells.write(writer);
        writer.number(self.object);
        write_octants(&self.octants, writer);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, ReadError> {
        let (cells, object) = (AxialName::read(reader)?, reader.number()?);
        Ok(Self { cells, object, octants: read_octants(reader)? })
    }
}

fn write_octants(all: &[(u8, Branch)], writer: &mut Writer) {
    writer.byte(all.iter().fold(0u8, |bits, (octant, _)| bits | 1 << (octant & 7)));
    for octant in 0..8 {
        if let Some((_, branch)) = all.iter().find(|(o, _)| *o == octant) {
            write_branch(branch, writer);
        }
    }
}

fn read_octants(reader: &mut Reader<'_>) -> Result<Vec<(u8, Branch)>, ReadError> {
    let bits = reader.byte()?;
    let octants = (0..8).filter(|octant| bits >> octant & 1 == 1);
    octants.map(|octant| Ok((octant, read_branch(reader, 0)?))).collect()
}

/// The six ways beside a rectangle by axis and side, then the two others.
fn code_of(way: Bypass) -> u8 {
    match way {
        Bypass::Beside { axis, before } => 2 * (axis % 3) + u8::from(before),
        Bypass::InFirst => 6,
        Bypass::InSecond => 7,
    }
}

fn way_of(code: u8) -> Bypass {
    match code {
        0..=5 => Bypass::Beside { axis: code / 2, before: code % 2 == 1 },
        6 => Bypass::InFirst,
        _ => Bypass::InSecond,
    }
}

/// A leaf begins with the number of its claims; a node with 255, its blocker, and twice the number of its ways, plus 1 if
/// there is a rest.
fn write_branch(branch: &Branch, writer: &mut Writer) {
    match branch {
        Branch::Empty(sum) => write_sum(sum, writer),
        Branch::Past { blocker, ways, rest } => {
            writer.byte(255);
            writer.number(*blocker);
            writer.byte(2 * ways.len().min(MOST_WAYS) as u8 + u8::from(rest.is_some()));
            for (way, branch) in ways.iter().take(MOST_WAYS) {
                writer.byte(code_of(*way));
                write_branch(branch, writer);
            }
            rest.iter().for_each(|sum| write_sum(sum, writer));
        }
    }
}

fn read_branch(reader: &mut Reader<'_>, depth: usize) -> Result<Branch, ReadError> {
    let first = reader.byte()?;
    if first != 255 {
        return Ok(Branch::Empty(read_sum(reader, first)?));
    }
    if depth == DEEPEST {
        return reader.fail(1, ReadErrorKind::Depth);
    }
    let blocker = reader.number()?;
    let head = reader.byte()?;
    let mut ways = Vec::new();
    for _ in 0..head / 2 {
        let code = reader.byte()?;
        if code > 7 {
            return reader.fail(1, ReadErrorKind::Code(code));
        }
        ways.push((way_of(code), read_branch(reader, depth + 1)?));
    }
    let rest = if head % 2 == 1 {
        let n = reader.byte()?;
        Some(read_sum(reader, n)?)
    } else {
        None
    };
    Ok(Branch::Past { blocker, ways, rest })
}

/// Codes of claims: 18 about boxes, 2 about ways taken, 8 about ways reversed.
fn write_sum(sum: &Sum, writer: &mut Writer) {
    let n = sum.len().min(MOST_CLAIMS);
    writer.byte(n as u8);
    let one = BigInt::from(1);
    for (claim, multiplier) in &sum[..n] {
        let (code, depth) = match *claim {
            Claim::Box { second, enter, leave } => (9 * u8::from(second) + 3 * (enter % 3) + leave % 3, None),
            Claim::Taken { depth, part } => (18 + part % 2, Some(depth)),
            Claim::Reversed { depth, way } => (20 + code_of(way), Some(depth)),
        };
        // Most multipliers are 1.
        writer.byte(2 * code + u8::from(*multiplier != one));
        depth.into_iter().for_each(|depth| writer.number(depth));
        if *multiplier != one {
            writer.whole(multiplier);
        }
    }
}

fn read_sum(reader: &mut Reader<'_>, n: u8) -> Result<Sum, ReadError> {
    if n == 255 {
        return reader.fail(1, ReadErrorKind::Code(n));
    }
    let mut sum = Vec::with_capacity(usize::from(n));
    for _ in 0..n {
        let head = reader.byte()?;
        let code = head / 2;
        let claim = match code {
            0..=17 => Claim::Box { second: code >= 9, enter: code % 9 / 3, leave: code % 3 },
            18 | 19 => Claim::Taken { depth: reader.number()?, part: code - 18 },
            20..=27 => Claim::Reversed { depth: reader.number()?, way: way_of(code - 20) },
            _ => return reader.fail(1, ReadErrorKind::Code(head)),
        };
        let multiplier = if head % 2 == 1 { reader.whole()? } else { BigInt::from(1) };
        sum.push((claim, multiplier));
    }
    Ok(sum)
}
