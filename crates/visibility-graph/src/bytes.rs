//! Results of units of work: as bytes, and which can be results of a point.

use crate::Run;
use sightlines_progress::Kept;

/// A list has of each run how far it begins behind the one before, and its length.
impl Kept for Run {
    fn write(&self, out: &mut Vec<u8>) {
        Self::write_all(&[*self], out);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Self::read_all(bytes, 1)?.pop()
    }

    fn write_all(all: &[Self], out: &mut Vec<u8>) {
        let mut before = 0;
        for Self { start, end } in all {
            [start - before, end - start].write(out);
            before = *end;
        }
    }

    fn read_all(bytes: &mut &[u8], n: usize) -> Option<Vec<Self>> {
        let mut before = 0u32;
        let mut next = |(gap, length): (u32, u32)| {
            let start = before.checked_add(gap)?;
            before = start.checked_add(length)?;
            Some(Self { start, end: before })
        };
        <(u32, u32)>::read_all(bytes, n)?.into_iter().map(&mut next).collect()
    }
}

/// Whether a number of points and some values can be of a graph of so many points.
pub(crate) fn fits_values<const N: usize>((n, values): &(u32, [f64; N]), n_points: usize) -> bool {
    *n as usize <= n_points && values.iter().all(|x| x.is_finite())
}

/// Whether runs can be what a point sees of so many points: they do not touch, and the point is in none of them.
pub(crate) fn fits_row(row: &[Run], point: usize, n_points: usize) -> bool {
    let has_point = |run: &Run| (run.start as usize..run.end as usize).contains(&point);
    row.iter().all(|run| run.start < run.end && !has_point(run))
        && row.windows(2).all(|pair| pair[0].end < pair[1].start)
        && row.last().is_none_or(|last| last.end as usize <= n_points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_back_and_only_where_they_fit() {
        let run = |start, end| Run { start, end };
        let row = Box::<[Run]>::from([run(0, 3), run(4, 5), run(200, 400)]);
        let bytes = row.to_bytes();
        let read = |bytes: &[u8], point: usize, n_points: usize| {
            Box::<[Run]>::from_bytes(bytes).filter(|row| fits_row(row, point, n_points))
        };
        assert_eq!(read(&bytes, 3, 400), Some(row));
        assert_eq!(read(&bytes, 4, 400), None, "a point that sees itself");
        assert_eq!(read(&bytes, 3, 399), None);
        assert!((0..bytes.len()).all(|n| read(&bytes[..n], 3, 400).is_none()));
        assert_eq!(read(&[2, 0, 1, 0, 1], 9, 400), None, "two runs that are one");
        assert_eq!(run(7, 9).to_bytes(), [7, 2]);
        assert_eq!(Run::from_bytes(&[7, 2]), Some(run(7, 9)));
        assert_eq!(Box::<[Run]>::from_bytes(&[1, 0xFF, 0xFF, 0xFF, 0xFF, 0x0F, 1]), None, "too far");

        let some = (300, [0.5, -1.0]);
        let bytes = some.to_bytes();
        let read = |bytes: &[u8], n_points: usize| {
            <(u32, [f64; 2])>::from_bytes(bytes).filter(|values| fits_values(values, n_points))
        };
        assert_eq!((read(&bytes, 300), read(&bytes, 299)), (Some(some), None));
        assert!((0..bytes.len()).all(|n| read(&bytes[..n], 300).is_none()));
        assert_eq!(read(&(1_u32, [f64::NAN, 0.0]).to_bytes(), 300), None, "not a number");
    }
}
