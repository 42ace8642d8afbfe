//! Which pairs may see each other, and which are shown: two bits for each who is told and each other.

use sightlines_pvs::bits::ones;

/// No row yet.
const NONE: u32 = u32::MAX;

#[derive(Debug, Default)]
pub(crate) struct Pairs {
    /// Words in a row.
    stride: usize,
    /// For each body its row, which only those have who are told of others, or were.
    row_of: Vec<u32>,
    may: Vec<u64>,
    shown: Vec<u64>,
    /// Pairs that are shown and may not be seen, and until when; also some that may be seen again, until the end of the tick.
    held: Vec<([u32; 2], f64)>,
}

impl Pairs {
    /// Makes room for so many bodies. Pairs with those that go are dropped.
    pub(crate) fn resize(&mut self, n: usize) {
        let (old, stride) = (self.stride, n.div_ceil(64));
        self.held.retain(|(pair, _)| pair.iter().all(|&i| (i as usize) < n));
        let mut kept = Self { stride, row_of: vec![NONE; n], held: std::mem::take(&mut self.held), ..Self::default() };
        for to in (0..n.min(self.row_of.len())).filter(|&to| self.row_of[to] != NONE) {
            let from = self.row_of[to] as usize * old;
            let row = kept.open(to);
            let pairs = [(&self.may, &mut kept.may), (&self.shown, &mut kept.shown)];
            for (words, into) in pairs {
                let into = &mut into[row * stride..];
                for of in ones(&words[from..from + old]).filter(|&of| of < n) {
                    into[of / 64] |= 1 << (of % 64);
                }
            }
        }
        *self = kept;
    }

    /// The row of somebody who is told of others.
    pub(crate) fn open(&mut self, to: usize) -> usize {
        if self.row_of[to] == NONE {
            self.row_of[to] = (self.may.len() / self.stride) as u32;
            for words in [&mut self.may, &mut self.shown] {
                words.resize(words.len() + self.stride, 0);
            }
        }
        self.row_of[to] as usize
    }

    pub(crate) fn has_row(&self, to: usize) -> bool {
        self.row_of[to] != NONE
    }

    /// The bits of those who are shown to somebody.
    pub(crate) fn shown_to(&self, to: u32) -> &[u64] {
        match self.row_of.get(to as usize) {
            Some(&row) if row != NONE => &self.shown[row as usize * self.stride..][..self.stride],
            _ => &[],
        }
    }

    /// Sets whether a pair, of which the first has a row, may see each other.
    #[inline]
    pub(crate) fn set(&mut self, [to, of]: [usize; 2], may: bool, until: f64, gained: &mut Vec<[u32; 2]>) {
        let (word, bit) = (self.row_of[to] as usize * self.stride + of / 64, 1 << (of % 64));
        if may == (self.may[word] & bit != 0) {
            return;
        }
        self.may[word] ^= bit;
        let pair = [to as u32, of as u32];
        if !may {
            self.held.push((pair, until));
        } else if self.shown[word] & bit == 0 {
            self.shown[word] |= bit;
            gained.push(pair);
        }
    }

    /// Ends what was held for long enough.
    pub(crate) fn release(&mut self, now: f64, lost: &mut Vec<[u32; 2]>) {
        let Self { stride, row_of, may, shown, held } = self;
        held.retain(|&([to, of], until)| {
            let (word, bit) = (row_of[to as usize] as usize * *stride + of as usize / 64, 1 << (of % 64));
            let may_again = may[word] & bit != 0;
            let goes = !may_again && until <= now;
            if goes {
                shown[word] &= !bit;
                lost.push([to, of]);
            }
            !(may_again || goes)
        });
    }
}
