//! Results of units of work as bytes.

use crate::Run;

/// How results of a kind are kept.
pub(crate) trait Kept<R>: Sync {
    /// Appends a result.
    fn write(&self, result: &R, out: &mut Vec<u8>);

    /// Takes the result of a number from the front of `bytes`; `None` if there is none. Memory in proportion to the bytes.
    fn read(&self, bytes: &mut &[u8], k: usize) -> Option<R>;
}

/// Appends a number: seven bits in a byte, the low ones first, and a top bit that is set if more follow.
pub(crate) fn write_number(mut x: u32, out: &mut Vec<u8>) {
    while x >= 0x80 {
        out.push(x as u8 | 0x80);
        x >>= 7;
    }
    out.push(x as u8);
}

/// Takes a number from the front of `bytes`.
pub(crate) fn read_number(bytes: &mut &[u8]) -> Option<u32> {
    let mut x = 0u64;
    for shift in (0..u32::BITS).step_by(7) {
        let (&byte, rest) = bytes.split_first()?;
        *bytes = rest;
        x |= u64::from(byte & 0x7F) << shift;
        if byte < 0x80 {
            return u32::try_from(x).ok();
        }
    }
    None
}

/// A number of points and some values.
pub(crate) struct Values<const N: usize> {
    /// The most points that count.
    pub(crate) n_points: u32,
}

impl<const N: usize> Kept<(u32, [f64; N])> for Values<N> {
    fn write(&self, (n, values): &(u32, [f64; N]), out: &mut Vec<u8>) {
        write_number(*n, out);
        values.iter().for_each(|x| out.extend_from_slice(&x.to_le_bytes()));
    }

    fn read(&self, bytes: &mut &[u8], _: usize) -> Option<(u32, [f64; N])> {
        let n = read_number(bytes).filter(|n| *n <= self.n_points)?;
        let mut values = [0.0; N];
        for value in &mut values {
            let (x, rest) = bytes.split_first_chunk()?;
            *bytes = rest;
            *value = f64::from_le_bytes(*x);
        }
        values.iter().all(|x| x.is_finite()).then_some((n, values))
    }
}

/// What points see.
pub(crate) struct Rows {
    pub(crate) n_points: u32,
}

impl Kept<Box<[Run]>> for Rows {
    fn write(&self, row: &Box<[Run]>, out: &mut Vec<u8>) {
        write_number(row.len() as u32, out);
        let mut end = 0;
        for run in row {
            write_number(run.start - end, out);
            write_number(run.end - run.start, out);
            end = run.end;
        }
    }

    fn read(&self, bytes: &mut &[u8], point: usize) -> Option<Box<[Run]>> {
        // Each takes two bytes at least.
        let n = read_number(bytes).filter(|n| *n as usize <= bytes.len() / 2)?;
        let (mut row, mut last) = (Vec::with_capacity(n as usize), 0u32);
        for k in 0..n {
            let start = last.checked_add(read_number(bytes)?)?;
            let end = start.checked_add(read_number(bytes)?).filter(|end| *end <= self.n_points)?;
            // Runs do not touch, and the point is in none of them.
            let has_point = (start as usize..end as usize).contains(&point);
            if start >= end || has_point || k > 0 && start == last {
                return None;
            }
            row.push(Run { start, end });
            last = end;
        }
        Some(row.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_back_and_only_where_they_fit() {
        let run = |start, end| Run { start, end };
        let (rows, row) = (Rows { n_points: 400 }, Box::<[Run]>::from([run(0, 3), run(4, 5), run(200, 400)]));
        let mut bytes = Vec::new();
        rows.write(&row, &mut bytes);
        let mut rest = &bytes[..];
        assert_eq!((rows.read(&mut rest, 3), rest.len()), (Some(row), 0));
        assert_eq!(rows.read(&mut &bytes[..], 4), None, "a point that sees itself");
        assert_eq!(Rows { n_points: 399 }.read(&mut &bytes[..], 3), None);
        assert!((0..bytes.len()).all(|n| rows.read(&mut &bytes[..n], 3).is_none()));
        assert_eq!(rows.read(&mut &[2, 0, 1, 0, 1][..], 9), None, "two runs that are one");

        let (values, some) = (Values { n_points: 300 }, (300, [0.5, -1.0]));
        let mut bytes = Vec::new();
        values.write(&some, &mut bytes);
        assert_eq!(values.read(&mut &bytes[..], 0), Some(some));
        assert_eq!(Values::<2> { n_points: 299 }.read(&mut &bytes[..], 0), None);
        assert!((0..bytes.len()).all(|n| values.read(&mut &bytes[..n], 0).is_none()));
        values.write(&(1, [f64::NAN, 0.0]), &mut bytes);
        assert_eq!(values.read(&mut &bytes[18..], 0), None, "not a number");
    }

    #[test]
    fn numbers_have_32_bits() {
        for x in [0, 127, 128, 1 << 21, u32::MAX] {
            let mut bytes = Vec::new();
            write_number(x, &mut bytes);
            assert_eq!(read_number(&mut &bytes[..]), Some(x));
        }
        assert_eq!(read_number(&mut &[0xFF, 0xFF, 0xFF, 0xFF, 0x1F][..]), None);
        assert_eq!(read_number(&mut &[0x80; 6][..]), None);
    }
}
