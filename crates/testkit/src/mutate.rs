//! Breaking files: small changes that are likely to upset a reader.

use sightlines_geometry::Random;

/// Pseudorandom integers: the generator of `geometry`, with remainders for ranges.
#[derive(Debug, Clone)]
pub struct SplitMix(pub(crate) Random);

impl SplitMix {
    /// The stream of a seed.
    pub const fn new(seed: u64) -> Self {
        Self(Random::new(seed))
    }

    /// The next number.
    #[expect(clippy::should_implement_trait, reason = "an endless sequence is no iterator here")]
    pub fn next(&mut self) -> u64 {
        self.0.bits()
    }

    /// A number below `n`, or 0.
    pub fn below(&mut self, n: usize) -> usize {
        if n == 0 { 0 } else { (self.next() % n as u64) as usize }
    }

    pub(crate) fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }
}

/// Numbers that are most likely to break a reader of binary fields.
const NUMBERS: [u32; 12] = [0, 1, 2, 11, 12, 16, 0x7F, 0xFFFF, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF_FFF0, 0xFFFF_FFFF];
/// Pieces that are most likely to break a reader of GeoJSON.
const PIECES: [&[u8]; 18] = [
    b"[",
    b"]",
    b"{",
    b"}",
    b",",
    b"null",
    b"NaN",
    b"-",
    b"1e999",
    b"1e-300",
    b"-0",
    b"\"",
    b"\\",
    b"\xFF",
    b"[]",
    b"\"type\":\"Point\",",
    b"\"coordinates\":[1,2],",
    b"18446744073709551616",
];

/// Every copy of `bytes` with one bit changed.
pub fn flipped_bits(bytes: &[u8]) -> impl Iterator<Item = Vec<u8>> + '_ {
    (0..8 * bytes.len()).map(|bit| {
        let mut changed = bytes.to_vec();
        changed[bit / 8] ^= 1 << (bit % 8);
        changed
    })
}

/// Breaks `bytes` in one to four ways.
pub fn mutate(bytes: &[u8], random: &mut SplitMix) -> Vec<u8> {
    let mut out = bytes.to_vec();
    for _ in 0..=random.below(4) {
        mutate_once(&mut out, random);
    }
    out
}

fn mutate_once(out: &mut Vec<u8>, random: &mut SplitMix) {
    let at = random.below(out.len());
    match random.below(8) {
        0 if !out.is_empty() => out[at] ^= 1 << random.below(8),
        1 if !out.is_empty() => out[at] = random.next() as u8,
        2 => out.truncate(at),
        3 => {
            let to = (at + random.below(40)).min(out.len());
            let (piece, goal) = (out[at..to].to_vec(), random.below(out.len()));
            out.splice(goal..goal, piece);
        }
        4 => drop(out.drain(at..(at + random.below(20)).min(out.len()))),
        5 => _ = out.splice(at..at, random.pick(&PIECES).iter().copied()),
        6 => write_number(out, at & !3, random),
        // The header, and the directory that the builder leaves at the end.
        _ if random.below(3) == 0 => write_number(out, 4 * random.below(3), random),
        _ => {
            let entry = out.len().saturating_sub(16 * (1 + random.below(14)));
            write_number(out, entry + 4 * random.below(4), random);
        }
    }
}

/// Puts an extreme number, or the number there with a small change, at `at`.
fn write_number(out: &mut [u8], at: usize, random: &mut SplitMix) {
    let Some(field) = out.get_mut(at..at + 4) else { return };
    let old = u32::from_le_bytes([field[0], field[1], field[2], field[3]]);
    let near = old.wrapping_add(random.below(9) as u32).wrapping_sub(4);
    let new = if random.below(2) == 0 { near } else { random.pick(&NUMBERS) };
    field.copy_from_slice(&new.to_le_bytes());
}
