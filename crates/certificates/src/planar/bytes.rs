//! Proofs of plans as bytes.
//!
//! After the frame: the checksum of the network (four bytes); lines; unproven pairs; walks. Each list begins with its
//! length.

use super::{LineForm, PlanLine, PlanarBlock, PlanarProofs, PlanarWalk};
use crate::bytes::{
    Coded, FIRST_VERSION, Kind, ReadError, ReadErrorKind, Reader, Writer, framed, is_wide, unframed_of,
};

/// Forms of lines.
const NARROW: u8 = 0;
const WIDE: u8 = 1;
const WHOLE: u8 = 2;

/// Numbers of left and right ends of a block, by its code.
const SHAPES: [[u8; 2]; 6] = [[1, 1], [1, 2], [2, 1], [2, 2], [1, 3], [3, 1]];

impl PlanarProofs {
    /// The bytes of these proofs: the same for equal proofs.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut writer = Writer::for_network(self.checksum);
        writer.list(&self.lines);
        writer.pairs(&self.unproven);
        writer.list(&self.walks);
        framed(Kind::Planar, FIRST_VERSION, writer)
    }

    /// Reads proofs without checking what they prove: see [`PlanarProofs::check`].
    ///
    /// # Errors
    /// [`ReadError`] with the offset of what is wrong.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ReadError> {
        let (checksum, mut reader) = unframed_of(Kind::Planar, bytes)?;
        let proofs = Self { checksum, lines: reader.list()?, unproven: reader.pairs()?, walks: reader.list()? };
        reader.end().map(|()| proofs)
    }
}

impl Coded for PlanLine {
    const LEAST: usize = 2;

    fn write(&self, writer: &mut Writer) {
        writer.number(self.cell);
        match &self.form {
            LineForm::Points(points) => {
                let bits = points.as_flattened();
                let wide = is_wide(bits);
                writer.byte(if wide { WIDE } else { NARROW });
                writer.coordinates(bits, wide);
            }
            LineForm::Whole(abc) => {
                writer.byte(WHOLE);
                abc.iter().for_each(|x| writer.whole(x));
            }
        }
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, ReadError> {
        let cell = reader.number()?;
        let form = match reader.byte()? {
            code @ (NARROW | WIDE) => LineForm::Points(reader.points(code == WIDE)?),
            WHOLE => LineForm::Whole(Box::new([reader.whole()?, reader.whole()?, reader.whole()?])),
            code => return reader.fail(1, ReadErrorKind::Code(code)),
        };
        Ok(Self { cell, form })
    }
}

impl Coded for PlanarWalk {
    const LEAST: usize = 3;

    fn write(&self, writer: &mut Writer) {
        writer.number(self.source);
        self.decisions.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, ReadError> {
        Ok(Self { source: reader.number()?, decisions: Coded::read(reader)? })
    }
}

impl Coded for PlanarBlock {
    const LEAST: usize = 3;

    fn write(&self, writer: &mut Writer) {
        let shape = [self.lefts.len() as u8, self.rights.len() as u8];
        // A block of another shape proves nothing, and no maker takes one.
        let code = SHAPES.iter().position(|s| *s == shape).unwrap_or(0);
        writer.byte(code as u8);
        let n = usize::from(SHAPES[code][0] + SHAPES[code][1]);
        self.lefts.iter().chain(&self.rights).take(n).for_each(|&back| writer.number(back));
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, ReadError> {
        let code = reader.byte()?;
        let Some(&[lefts, rights]) = SHAPES.get(usize::from(code)) else {
            return reader.fail(1, ReadErrorKind::Code(code));
        };
        let mut ends = |n: u8| (0..n).map(|_| reader.number()).collect::<Result<Vec<u32>, _>>();
        Ok(Self { lefts: ends(lefts)?, rights: ends(rights)? })
    }
}
