//! What is carried from a plane to the next one.
//!
//! A segment from an eye at height `H` above a plane to a point `p` of it crosses a nearer plane, `D` in front, at the
//! part `D / H` of its way. If that crossing lies in a blocked texel of the nearer plane, the segment is blocked there, at
//! a height that counts from the nearer plane. So a texel is blocked if the crossings of all segments to it lie in
//! blocked texels, with the least of their values, raised by whole units of `D`.
//!
//! Along each axis of the plane the crossings `p + (v - p) D / H` are least and greatest for corners. The
//! rectangle between is closed; it is covered by the closed texels that its inside meets, so a texel that it only
//! touches need not be blocked: who crosses there crosses a texel that is looked at as well. (The rectangle is never
//! flat: the corners of a texel differ, and less than all of the way is gone.)

use num_traits::{ToPrimitive, Zero};
use sightlines_exact::{BigRational, rational};
use sightlines_multifocal::{Buffer, BufferJob, BufferPlane};

/// Adds to `out`, the buffer of the farther plane, what follows from that of the nearer one. Exact.
pub(super) fn carry(job: &BufferJob<'_>, [nearer, plane]: [&BufferPlane; 2], known: &Buffer, out: &mut Buffer) {
    let between = (rational(plane.at()) - rational(nearer.at())) * rational(if plane.positive() { 1.0 } else { -1.0 });
    let rise = (&between / rational(job.unit())).floor().to_u32().expect("values of a job are less than 2^28");
    let [columns, rows] = [0, 1].map(|k| touched(job, [nearer, plane], &between, k));
    let width = plane.texels()[0] as usize;
    for (i, stored) in out.values_mut().iter_mut().enumerate() {
        let (Some([x0, x1]), Some([y0, y1])) = (columns[i % width], rows[i / width]) else { continue };
        let texels = (y0..y1).flat_map(|y| &known.row(y)[x0 as usize..x1 as usize]);
        let least = texels.min().expect("a footprint is not empty");
        if *least > 0 {
            *stored = (*stored).max(least + rise);
        }
    }
}

/// For each texel along axis `k` of a plane, the texels of the nearer plane that segments to it cross: from the first
/// to before the second. None if they leave the window.
fn touched(
    job: &BufferJob<'_>,
    [nearer, plane]: [&BufferPlane; 2],
    between: &BigRational,
    k: usize,
) -> Vec<Option<[u32; 2]>> {
    let eyes = job.volume().corners().map(|v| {
        let height =
            (rational(plane.at()) - rational(v[plane.axis()])) / rational(if plane.positive() { 1.0 } else { -1.0 });
        (rational(v[plane.across()[k]]), between / height)
    });
    let (origin, step) = (rational(nearer.origin()[k]), rational(nearer.step()[k]));
    let crossings = |i: u32| {
        let p = rational(plane.origin()[k] + plane.step()[k] * f64::from(i));
        let at = eyes.each_ref().map(|(v, part)| (&p + (v - &p) * part - &origin) / &step);
        let [least, greatest] = [at.iter().min(), at.iter().max()].map(|x| x.expect("there are eight eyes").clone());
        (least, greatest)
    };
    let of_texel = |i: u32| {
        let (low, high) = (crossings(i).0.floor(), crossings(i + 1).1.ceil());
        let is_within = low >= BigRational::zero() && high <= rational(f64::from(nearer.texels()[k]));
        is_within.then(|| [low, high].map(|x| x.to_u32().expect("it lies within the window")))
    };
    (0..plane.texels()[k]).map(of_texel).collect()
}
