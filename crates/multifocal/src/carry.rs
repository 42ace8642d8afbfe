//! Carrying (re-projection): blocking information from one plane applied to the next.
//!
//! A texel of a plane is also blocked if all lines from it to the volume cross the previous plane in blocked texels:
//! whatever blocks them there blocks them here, higher by the distance of the planes. This fuses occluders that no line
//! of a bundle has in common.
//!
//! Source: Durand, Drettakis, Thollot and Puech, SIGGRAPH 2000 (re-projection of extended projections), with
//! heights kept.

use crate::{BufferJob, BufferPlane, Volume};

/// How to carry values from one plane of a job to the next, in integers.
///
/// A texel `(x, y)` whose ranges are not empty and cover only blocked texels is blocked, with the least of their values
/// plus `rise`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Carry {
    /// For each column of texels the first and the last column that its lines cross on the previous plane; the first is
    /// larger than the last where lines leave its window.
    pub columns: Vec<[u32; 2]>,
    /// The same for each row.
    pub rows: Vec<[u32; 2]>,
    /// The number added to a value.
    pub rise: u32,
}

/// The range for lines that leave the window.
pub const OUTSIDE: [u32; 2] = [1, 0];

impl Carry {
    /// From plane `to - 1` of a job to plane `to`. O(texels of a side).
    ///
    /// # Panics
    /// If `to` is 0 or no plane of the job.
    pub fn of(job: &BufferJob<'_>, to: usize) -> Self {
        let (before, after) = (&job.planes()[to - 1], &job.planes()[to]);
        let apart = (after.at() - before.at()).abs();
        let rise = (apart.next_down() / job.unit()).floor() as u32;
        let ranges = |k: usize| {
            let lines = Lines::new(job.volume(), before, after, k);
            (0..after.texels()[k]).map(|i| lines.range(i)).collect()
        };
        Self { columns: ranges(0), rows: ranges(1), rise }
    }
}

/// The lines from the texels of one plane to a volume, along one of the axes across.
struct Lines<'a> {
    before: &'a BufferPlane,
    after: &'a BufferPlane,
    k: usize,
    /// The range of the eyes.
    eyes: [f64; 2],
    /// Which part of the way from the plane to an eye lies between the planes: least and largest.
    parts: [f64; 2],
}

impl<'a> Lines<'a> {
    fn new(volume: &Volume, before: &'a BufferPlane, after: &'a BufferPlane, k: usize) -> Self {
        let (b, across) = (volume.bounds(), after.across()[k]);
        let heights = [after.height(b.min), after.height(b.max)];
        let apart = (after.at() - before.at()).abs();
        let (high, low) = (heights[0].max(heights[1]), heights[0].min(heights[1]));
        Self { before, after, k, eyes: [b.min[across], b.max[across]], parts: [apart / high, apart / low] }
    }

    /// The texels that the lines from texel `i` cross.
    ///
    /// A line from `p` to an eye `v` crosses the previous plane at `p + t (v - p)`, affine in each of the three, so
    /// extremes are at ends of the ranges. Each is computed with three roundings of magnitudes up to `m = |p| + |v|`,
    /// in addition to two in `t`: within 8 ε m; the texel's number with two more, for which the same bound of its parts
    /// is used.
    fn range(&self, i: u32) -> [u32; 2] {
        let (origin, step) = (self.after.origin()[self.k], self.after.step()[self.k]);
        let (from, to) = (self.before.origin()[self.k], self.before.step()[self.k]);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for p in [origin + step * f64::from(i), origin + step * f64::from(i + 1)] {
            for v in self.eyes {
                for t in self.parts {
                    let error = (p.abs() + v.abs() + from.abs()) * (16.0 * f64::EPSILON);
                    let at = p + t * (v - p) - from;
                    low = low.min(((at - error) / to).next_down());
                    high = high.max(((at + error) / to).next_up());
                }
            }
        }
        let n = f64::from(self.before.texels()[self.k]);
        if !(low >= 0.0 && high <= n) {
            return OUTSIDE;
        }
        let first = low.floor() as u32;
        [first, (high.ceil() as u32 - 1).max(first)]
    }
}
