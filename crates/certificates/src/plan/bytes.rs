//! Proofs of plans as bytes.
//!
//! After the frame: the checksum of the network (four bytes); the number of lines, and each line; the number of
//! unproven pairs, and each as differences to the one before; the number of walks, and each walk.

use super::{LineForm, PlanBlock, PlanLine, PlanProofs, PlanWalk};
use crate::bits::Bits;
use crate::bytes::{Kind, ReadError, ReadErrorKind, Reader, Writer, framed, is_narrow, unframed};

/// Forms of lines.
const NARROW: u8 = 0;
const WIDE: u8 = 1;
const WHOLE: u8 = 2;

/// How many left and right ends a block has, by its code.
const SHAPES: [[u8; 2]; 6] = [[1, 1], [1, 2], [2, 1], [2, 2], [1, 3], [3, 1]];

impl PlanProofs {
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
            writer.size(walk.open.len());
            writer.bytes(walk.open.bytes());
            writer.size(walk.blocks.len());
            walk.blocks.iter().for_each(|block| write_block(block, &mut writer));
        }
        framed(Kind::Plan, writer)
    }

    /// Reads proofs. Whether they prove anything is another question ([`PlanProofs::check`]).
    ///
    /// # Errors
    /// [`ReadError`] with the offset of what is wrong.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ReadError> {
        let (kind, mut reader) = unframed(bytes)?;
        if kind != Kind::Plan {
            return Err(ReadError { offset: 12, kind: ReadErrorKind::Kind(bytes[12]) });
        }
        let four = reader.bytes(4)?;
        let checksum = u32::from_le_bytes([four[0], four[1], four[2], four[3]]);
        let n = reader.count(2)?;
        let lines = (0..n).map(|_| read_line(&mut reader)).collect::<Result<_, _>>()?;
        let unproven = read_pairs(&mut reader)?;
        let n = reader.count(3)?;
        let walks = (0..n).map(|_| read_walk(&mut reader)).collect::<Result<_, _>>()?;
        reader.end()?;
        Ok(Self { checksum, lines, unproven, walks })
    }
}

fn write_line(line: &PlanLine, writer: &mut Writer) {
    writer.number(line.cell);
    match &line.form {
        LineForm::Points(points) => {
            let values = points.as_flattened().iter().map(|&x| f64::from_bits(x));
            let wide = !values.clone().all(is_narrow);
            writer.byte(if wide { WIDE } else { NARROW });
            values.for_each(|x| writer.double(x, wide));
        }
        LineForm::Whole(abc) => {
            writer.byte(WHOLE);
            abc.iter().for_each(|x| writer.whole(x));
        }
    }
}

fn read_line(reader: &mut Reader<'_>) -> Result<PlanLine, ReadError> {
    let cell = reader.number()?;
    let form = match reader.byte()? {
        code @ (NARROW | WIDE) => {
            let mut points = [[0; 2]; 2];
            for x in points.as_flattened_mut() {
                *x = reader.coordinate(code == WIDE)?.to_bits();
            }
            LineForm::Points(points)
        }
        WHOLE => LineForm::Whole(Box::new([reader.whole()?, reader.whole()?, reader.whole()?])),
        code => return reader.fail(1, ReadErrorKind::Code(code)),
    };
    Ok(PlanLine { cell, form })
}

/// Ascending pairs: the difference of the first numbers, then the second number or its difference.
pub(crate) fn write_pairs(pairs: &[[u32; 2]], writer: &mut Writer) {
    writer.size(pairs.len());
    let mut before = [0, 0];
    for &[a, b] in pairs {
        let step = a.wrapping_sub(before[0]);
        writer.number(step);
        writer.number(if step == 0 { b.wrapping_sub(before[1]) } else { b });
        before = [a, b];
    }
}

pub(crate) fn read_pairs(reader: &mut Reader<'_>) -> Result<Vec<[u32; 2]>, ReadError> {
    let n = reader.count(2)?;
    let mut before = [0u32, 0u32];
    let mut pairs = Vec::with_capacity(n);
    for k in 0..n {
        let [step, second] = [reader.number()?, reader.number()?];
        let base = if step == 0 { before[1] } else { 0 };
        let pair = before[0].checked_add(step).zip(base.checked_add(second)).map(|(a, b)| [a, b]);
        match pair.filter(|pair| k == 0 || *pair > before) {
            Some(pair) => pairs.push(pair),
            None => return reader.fail(0, ReadErrorKind::Number),
        }
        before = pairs[k];
    }
    Ok(pairs)
}

fn write_block(block: &PlanBlock, writer: &mut Writer) {
    let shape = [block.lefts.len() as u8, block.rights.len() as u8];
    // Blocks of another shape prove nothing; none is made.
    let code = SHAPES.iter().position(|s| *s == shape).unwrap_or(0);
    writer.byte(code as u8);
    block.lefts.iter().chain(&block.rights).take(usize::from(SHAPES[code][0] + SHAPES[code][1])).for_each(|&back| {
        writer.number(back);
    });
}

fn read_walk(reader: &mut Reader<'_>) -> Result<PlanWalk, ReadError> {
    let source = reader.number()?;
    let n_bits = reader.number()? as usize;
    let bytes = reader.bytes(n_bits.div_ceil(8))?;
    let Some(open) = Bits::of(bytes, n_bits) else { return reader.fail(bytes.len(), ReadErrorKind::Number) };
    let n = reader.count(3)?;
    let blocks = (0..n).map(|_| read_block(reader)).collect::<Result<_, _>>()?;
    Ok(PlanWalk { source, open, blocks })
}

fn read_block(reader: &mut Reader<'_>) -> Result<PlanBlock, ReadError> {
    let code = reader.byte()?;
    let Some(&[lefts, rights]) = SHAPES.get(usize::from(code)) else {
        return reader.fail(1, ReadErrorKind::Code(code));
    };
    let mut ends = |n: u8| (0..n).map(|_| reader.number()).collect::<Result<Vec<u32>, _>>();
    Ok(PlanBlock { lefts: ends(lefts)?, rights: ends(rights)? })
}
