//! Proofs of maps as bytes.
//!
//! After the frame: the checksum of the network (four bytes); lines; unproven pairs; walks. Each list begins with its
//! length.

use super::block::MOST_DEPTH;
use super::{
    ConvexBlock, ConvexCut, ConvexLine, ConvexPlane, ConvexProofs, ConvexSums, ConvexTerm, ConvexTree, ConvexWalk,
};
use crate::bytes::{
    Coded, FIRST_VERSION, Kind, ReadError, ReadErrorKind, Reader, VERSION, Writer, framed, is_narrow, is_wide,
    unframed_of,
};

/// Forms of lines: coordinates of four bytes, of eight, and sums of two of eight.
const NARROW: u8 = 0;
const WIDE: u8 = 1;
const SUMS: u8 = 2;

/// Forms of blocks and their parts: a plane; sums with multipliers that are whole, in four bytes, in eight; a cut of the earlier
/// gate's part, and of the later one's.
const PLANE: u8 = 0;
const SUM_WHOLE: u8 = 1;
const SUM_NARROW: u8 = 2;
const SUM_WIDE: u8 = 3;
const CUT_EARLIER: u8 = 4;
const CUT_LATER: u8 = 5;

impl ConvexProofs {
    /// The bytes of these proofs: the same for equal proofs.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut writer = Writer::for_network(self.checksum);
        writer.list(&self.lines);
        writer.pairs(&self.unproven);
        writer.list(&self.walks);
        let has_sums = self.lines.iter().any(ConvexLine::has_rest);
        framed(Kind::Convex, if has_sums { VERSION } else { FIRST_VERSION }, writer)
    }

    /// Reads proofs without checking what they prove: see [`ConvexProofs::check`].
    ///
    /// # Errors
    /// [`ReadError`] with the offset of what is wrong.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ReadError> {
        let (checksum, mut reader) = unframed_of(Kind::Convex, bytes)?;
        let proofs = Self { checksum, lines: reader.list()?, unproven: reader.pairs()?, walks: reader.list()? };
        reader.end().map(|()| proofs)
    }
}

impl Coded for ConvexLine {
    const LEAST: usize = 2;

    fn write(&self, writer: &mut Writer) {
        let bits = self.bits.as_flattened();
        writer.number(self.gate);
        if self.has_rest() {
            writer.byte(SUMS);
            writer.coordinates(bits, true);
            return writer.coordinates(self.rest.as_flattened(), true);
        }
        let wide = is_wide(bits);
        writer.byte(if wide { WIDE } else { NARROW });
        writer.coordinates(bits, wide);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, ReadError> {
        let gate = reader.number()?;
        match reader.byte()? {
            code @ (NARROW | WIDE) => Ok(Self { gate, bits: reader.points(code == WIDE)?, rest: [[0; 3]; 2] }),
            SUMS if reader.is_newer() => Ok(Self { gate, bits: reader.points(true)?, rest: reader.points(true)? }),
            code => reader.fail(1, ReadErrorKind::Code(code)),
        }
    }
}

impl Coded for ConvexWalk {
    const LEAST: usize = 4;

    fn write(&self, writer: &mut Writer) {
        writer.number(self.source);
        writer.size(self.targets.len());
        // Ascending: the difference to the target before.
        let mut before = 0;
        for &target in &self.targets {
            writer.number(target.wrapping_sub(before));
            before = target;
        }
        self.decisions.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, ReadError> {
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
        Ok(Self { source, targets, decisions: Coded::read(reader)? })
    }
}

impl Coded for ConvexBlock {
    const LEAST: usize = 4;

    fn write(&self, writer: &mut Writer) {
        match self {
            Self::Plane(ConvexPlane { stops, edge, corner }) => {
                writer.byte(PLANE);
                stops.iter().chain(edge).chain(corner).for_each(|&x| writer.number(x));
            }
            // The form of the tree's root is that of the block.
            Self::Sums(ConvexSums { ends, tree }) => write_tree(tree, Some(ends), writer),
        }
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, ReadError> {
        match reader.byte()? {
            PLANE => {
                let mut two = || Ok([reader.number()?, reader.number()?]);
                Ok(Self::Plane(ConvexPlane { stops: two()?, edge: two()?, corner: two()? }))
            }
            code => {
                let ends = [reader.number()?, reader.number()?];
                Ok(Self::Sums(ConvexSums { ends, tree: read_tree(code, MOST_DEPTH, reader)? }))
            }
        }
    }
}

/// Whether a multiplier is written as a whole number.
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
