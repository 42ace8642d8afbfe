//! The state of a search as bytes.

use super::StateError;
use sightlines_formats::quake::rle;
use sightlines_pvs::BitMatrix;
use sightlines_stabtree::{ConvexCounters, ConvexState};

const N_COUNTERS: usize = 5;

/// Stages of a search, and the number that says that all are done.
const N_STAGES: u32 = 4;

/// Names and values of the counters of a search, in a fixed order.
pub fn named_counters(all: &ConvexCounters) -> [(&'static str, u64); N_COUNTERS] {
    let ConvexCounters { clips, lines, programs, beams, sequences } = *all;
    [("clips", clips), ("lines", lines), ("programs", programs), ("beams", beams), ("sequences", sequences)]
}

fn counters_of([clips, lines, programs, beams, sequences]: [u64; N_COUNTERS]) -> ConvexCounters {
    ConvexCounters { clips, lines, programs, beams, sequences }
}

pub(super) fn append(state: &ConvexState, out: &mut Vec<u8>) {
    let ConvexState { stage, done, visible, possible, through, undecided, counters: counted } = state;
    let count = |n: usize| u32::try_from(n).expect("a state's counts fit 32 bits").to_le_bytes();
    let n = visible.n_rows();
    out.extend(count(n));
    out.extend(stage.to_le_bytes());
    out.extend(done.to_le_bytes());
    let counters = named_counters(counted);
    out.extend(count(counters.len()));
    for (name, value) in counters {
        // Names of fields are short.
        out.push(name.len() as u8);
        out.extend(name.as_bytes());
        out.extend(value.to_le_bytes());
    }
    out.extend(count(undecided.len()));
    out.extend(undecided.as_flattened().iter().flat_map(|id| id.to_le_bytes()));
    let mut row = Vec::new();
    for a in 0..n {
        append_row(visible.row(a).iter().copied(), n, &mut row, out);
    }
    for a in 0..n {
        let beyond = possible.row(a).iter().zip(visible.row(a)).map(|(p, v)| p ^ v);
        append_row(beyond, n, &mut row, out);
    }
    for gate in 0..through.n_rows() {
        append_row(through.row(gate).iter().copied(), n, &mut row, out);
    }
}

fn append_row(words: impl Iterator<Item = u64>, n: usize, row: &mut Vec<u8>, out: &mut Vec<u8>) {
    row.clear();
    row.extend(words.flat_map(u64::to_le_bytes));
    row.truncate(rle::row_len(n));
    rle::encode(row, out);
}

/// Reads the body that begins at `start` and ends with the bytes; of a search of cells and gates, which are portals
/// with a direction.
pub(super) fn read(bytes: &[u8], start: usize, n_cells: usize, n_gates: usize) -> Result<ConvexState, StateError> {
    let mut reader = Reader { bytes, at: start };
    let n = reader.u32()?;
    if n as usize != n_cells {
        return Err(reader.unsound(start, "it is for another number of cells"));
    }
    let (stage, done) = (reader.u32()?, reader.u64()?);
    if stage > N_STAGES || done > n_cells.max(n_gates) as u64 {
        return Err(reader.unsound(start + 4, "there is no such stage, or not so much to do in it"));
    }
    let counters = reader.counters()?;
    let undecided = reader.undecided(n)?;
    let visible = reader.matrix(n_cells, n_cells)?;
    let mut possible = reader.matrix(n_cells, n_cells)?;
    let through = reader.matrix(n_gates, n_cells)?;
    let end = reader.at;
    if end != bytes.len() {
        return Err(reader.unsound(end, "something is behind the last row"));
    }
    let is_apart = (0..n_cells).all(|a| visible.row(a).iter().zip(possible.row(a)).all(|(v, p)| v & p == 0));
    let sees_itself = (0..n_cells).all(|a| visible.get(a, a));
    if !is_apart || !sees_itself || !visible.is_symmetric() || !possible.is_symmetric() {
        return Err(reader.unsound(end, "who is seen does not see, or not itself, or twice"));
    }
    for a in 0..n_cells {
        possible.row_mut(a).iter_mut().zip(visible.row(a)).for_each(|(p, v)| *p |= v);
    }
    Ok(ConvexState { stage, done, visible, possible, through, undecided, counters })
}

struct Reader<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl Reader<'_> {
    fn unsound(&self, at: usize, what: &'static str) -> StateError {
        StateError::Unsound { at, what }
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], StateError> {
        let found = self.bytes.get(self.at..).and_then(|rest| rest.first_chunk::<N>());
        let found = *found.ok_or_else(|| self.unsound(self.at, "it ends too early"))?;
        self.at += N;
        Ok(found)
    }

    fn u32(&mut self) -> Result<u32, StateError> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    fn u64(&mut self) -> Result<u64, StateError> {
        Ok(u64::from_le_bytes(self.take()?))
    }

    /// The same counters in the same order as they are written: those of another search are of no use.
    fn counters(&mut self) -> Result<ConvexCounters, StateError> {
        let expected = named_counters(&ConvexCounters::default());
        let place = self.at;
        let mut values = [0; N_COUNTERS];
        let mut is_known = self.u32()? as usize == expected.len();
        if is_known {
            for (value, (name, _)) in values.iter_mut().zip(expected) {
                let [len] = self.take()?;
                let found = self.bytes.get(self.at..self.at + usize::from(len));
                is_known &= found == Some(name.as_bytes());
                self.at += usize::from(len);
                *value = self.u64()?;
            }
        }
        if is_known { Ok(counters_of(values)) } else { Err(self.unsound(place, "it counts something else")) }
    }

    fn undecided(&mut self, n_cells: u32) -> Result<Vec<[u32; 2]>, StateError> {
        let place = self.at;
        let n_pairs = self.u32()? as usize;
        // Memory is taken only for pairs that are there.
        if (self.bytes.len() - self.at) / 8 < n_pairs {
            return Err(self.unsound(place, "it ends before the last undecided pair"));
        }
        let mut pairs: Vec<[u32; 2]> = Vec::with_capacity(n_pairs);
        for _ in 0..n_pairs {
            let at = self.at;
            let pair = [self.u32()?, self.u32()?];
            if pair[0] >= pair[1] || pair[1] >= n_cells {
                return Err(self.unsound(at, "an undecided pair is no pair of cells, lower first"));
            }
            pairs.push(pair);
        }
        Ok(pairs)
    }

    /// Rows of `n` bits each.
    fn matrix(&mut self, n_rows: usize, n: usize) -> Result<BitMatrix, StateError> {
        let mut matrix = BitMatrix::new(n_rows, n);
        let mut row = vec![0u8; rle::row_len(n)];
        for a in 0..n_rows {
            let used = rle::decode(&self.bytes[self.at..], &mut row);
            self.at += used.map_err(|_| self.unsound(self.at, "a row cannot be read"))?;
            if !n.is_multiple_of(8) && row.last().is_some_and(|last| last >> (n % 8) != 0) {
                return Err(self.unsound(self.at, "a row has a one past the last cell"));
            }
            for (word, bytes) in matrix.row_mut(a).iter_mut().zip(row.chunks(8)) {
                *word = bytes.iter().rev().fold(0, |word, &byte| word << 8 | u64::from(byte));
            }
        }
        Ok(matrix)
    }
}
