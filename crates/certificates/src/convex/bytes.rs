//! Proofs of maps as bytes.
//!
//! After the frame: the checksum of the network (four bytes); the number of lines, and each line; the number of
//! unproven pairs, and each as differences to the one before; the number of walks, and each walk.

use super::block::MOST_DEPTH;
use super::{
    ConvexBlock, ConvexCut, ConvexLine, ConvexPlane, ConvexProofs, ConvexSums, ConvexTerm, ConvexTree, ConvexWalk,
};
use crate::bits::Bits;
use crate::bytes::{Kind, ReadError, ReadErrorKind, Reader, Writer, framed, is_narrow, unframed};
use crate::plan::{read_pairs, write_pairs};

/// Forms of lines.
const NARROW: u8 = 0;
const WIDE: u8 = 1;

/// Forms of blocks and their parts: a plane; sums with multipliers that are whole, in four bytes, in eight; a cut of the earlier
/// gate's part, and of the later one's.
const PLANE: u8 = 0;
const SUM_WHOLE: u8 = 1;
const SUM_NARROW: u8 = 2;
const SUM_WIDE: u8 = 3;
const CUT_EARLIER: u8 = 4;
const CUT_LATER: u8 = 5;

impl ConvexProofs {
    /// The bytes of these proofs: for the same proofs always the same.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut writer = Writer::default();
        writer.bytes(&self.checksum.to_le_bytes());
        writer.size(self.lines.len());
        self.lines.iter().for_each(|line| write_line(line, &mut writer));
        write_pairs(&self.unproven, &mut writer);
        writer.size(self.walks.len());
        for walk in &self.walks {
            writer.number(walk.source);
            writer.size(walk.targets.len());
            // Ascending: the difference to the one before.
            let mut before = 0;
            for &target in &walk.targets {
                writer.number(target.wrapping_sub(before));
                before = target;
            }
            writer.size(walk.open.len());
            writer.bytes(walk.open.bytes());
            writer.size(walk.blocks.len());
            walk.blocks.iter().for_each(|block| write_block(block, &mut writer));
        }
        framed(Kind::Convex, writer)
    }

    /// Reads proofs. Whether they prove anything is another question ([`ConvexProofs::check`]).
    ///
    /// # Errors
    /// [`ReadError`] with the offset of what is wrong.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ReadError> {
        let (kind, mut reader) = unframed(bytes)?;
        if kind != Kind::Convex {
            return Err(ReadError { offset: 12, kind: ReadErrorKind::Kind(bytes[12]) });
        }
        let four = reader.bytes(4)?;
        let checksum = u32::from_le_bytes([four[0], four[1], four[2], four[3]]);
        let n = reader.count(2)?;
        let lines = (0..n).map(|_| read_line(&mut reader)).collect::<Result<_, _>>()?;
        let unproven = read_pairs(&mut reader)?;
        let n = reader.count(4)?;
        let walks = (0..n).map(|_| read_walk(&mut reader)).collect::<Result<_, _>>()?;
        reader.end()?;
        Ok(Self { checksum, lines, unproven, walks })
    }
}

fn write_line(line: &ConvexLine, writer: &mut Writer) {
    writer.number(line.gate);
    let values = line.bits.as_flattened().iter().map(|&x| f64::from_bits(x));
    let wide = !values.clone().all(is_narrow);
    writer.byte(if wide { WIDE } else { NARROW });
    values.for_each(|x| writer.double(x, wide));
}

fn read_line(reader: &mut Reader<'_>) -> Result<ConvexLine, ReadError> {
    let gate = reader.number()?;
    let wide = match reader.byte()? {
        code @ (NARROW | WIDE) => code == WIDE,
        code => return reader.fail(1, ReadErrorKind::Code(code)),
    };
    let mut bits = [[0; 3]; 2];
    for x in bits.as_flattened_mut() {
        *x = reader.coordinate(wide)?.to_bits();
    }
    Ok(ConvexLine { gate, bits })
}

fn read_walk(reader: &mut Reader<'_>) -> Result<ConvexWalk, ReadError> {
    let source = reader.number()?;
    let n = reader.count(1)?;
    let mut targets = Vec::with_capacity(n);
    for k in 0..n {
        let step = reader.number()?;
        match targets.last().map_or(Some(step), |last: &u32| last.checked_add(step)) {
            Some(target) if k == 0 || step > 0 => targets.push(target),
            _ => return reader.fail(0, ReadErrorKind::Number),
        }
    }
    let n_bits = reader.number()? as usize;
    let bytes = reader.bytes(n_bits.div_ceil(8))?;
    let Some(open) = Bits::of(bytes, n_bits) else { return reader.fail(bytes.len(), ReadErrorKind::Number) };
    let n = reader.count(4)?;
    let blocks = (0..n).map(|_| read_block(reader)).collect::<Result<_, _>>()?;
    Ok(ConvexWalk { source, targets, open, blocks })
}

fn write_block(block: &ConvexBlock, writer: &mut Writer) {
    match block {
        ConvexBlock::Plane(ConvexPlane { stops, edge, corner }) => {
            writer.byte(PLANE);
            stops.iter().chain(edge).chain(corner).for_each(|&x| writer.number(x));
        }
        ConvexBlock::Sums(ConvexSums { ends, tree }) => {
            // The form of the tree's root says that it is one.
            write_tree(tree, Some(ends), writer);
        }
    }
}

fn read_block(reader: &mut Reader<'_>) -> Result<ConvexBlock, ReadError> {
    match reader.byte()? {
        PLANE => {
            let mut two = || Ok([reader.number()?, reader.number()?]);
            Ok(ConvexBlock::Plane(ConvexPlane { stops: two()?, edge: two()?, corner: two()? }))
        }
        code => {
            let ends = [reader.number()?, reader.number()?];
            Ok(ConvexBlock::Sums(ConvexSums { ends, tree: read_tree(code, MOST_DEPTH, reader)? }))
        }
    }
}

/// Whether a multiplier is a whole number that is written as one.
fn is_whole(x: f64) -> bool {
    x.fract() == 0.0 && (1.0..=f64::from(u32::MAX)).contains(&x)
}

fn write_tree(tree: &ConvexTree, ends: Option<&[u32; 2]>, writer: &mut Writer) {
    let ends = |writer: &mut Writer| ends.into_iter().flatten().for_each(|&end| writer.number(end));
    match tree {
        ConvexTree::Sum(terms) => {
            let values = || terms.iter().map(|term| term.times);
            let form = match (values().all(is_whole), values().all(is_narrow)) {
                (true, _) => SUM_WHOLE,
                (_, true) => SUM_NARROW,
                _ => SUM_WIDE,
            };
            writer.byte(form);
            ends(writer);
            writer.size(terms.len());
            for &ConvexTerm { gate, edge, times } in terms {
                writer.number(gate);
                writer.number(edge);
                if form == SUM_WHOLE { writer.number(times as u64) } else { writer.double(times, form == SUM_WIDE) }
            }
        }
        ConvexTree::Cut(cut) => {
            writer.byte(if cut.later { CUT_LATER } else { CUT_EARLIER });
            ends(writer);
            cut.plane.iter().for_each(|&x| writer.double(x, true));
            cut.parts.iter().for_each(|part| write_tree(part, None, writer));
        }
    }
}

fn read_tree(code: u8, depth: u32, reader: &mut Reader<'_>) -> Result<ConvexTree, ReadError> {
    match code {
        SUM_WHOLE | SUM_NARROW | SUM_WIDE => {
            let n = reader.count(3)?;
            let term = |reader: &mut Reader<'_>| {
                let [gate, edge] = [reader.number()?, reader.number()?];
                let times = match code {
                    SUM_WHOLE => f64::from(reader.number()?),
                    _ => reader.coordinate(code == SUM_WIDE)?,
                };
                Ok(ConvexTerm { gate, edge, times })
            };
            Ok(ConvexTree::Sum((0..n).map(|_| term(reader)).collect::<Result<_, _>>()?))
        }
        CUT_EARLIER | CUT_LATER => {
            let Some(depth) = depth.checked_sub(1) else { return reader.fail(1, ReadErrorKind::Depth) };
            let mut plane = [0.0; 4];
            for x in &mut plane {
                *x = reader.coordinate(true)?;
            }
            let mut part = || {
                let code = reader.byte()?;
                read_tree(code, depth, reader)
            };
            let parts = [part()?, part()?];
            Ok(ConvexTree::Cut(Box::new(ConvexCut { later: code == CUT_LATER, plane, parts })))
        }
        code => reader.fail(1, ReadErrorKind::Code(code)),
    }
}
