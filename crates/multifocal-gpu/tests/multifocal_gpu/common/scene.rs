//! Random scenes in front of planes.

use crate::common::Chance;
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::{BufferJob, BufferPlane, Measure, Occluder, Volume};

/// Rectangles and triangles between a volume and a plane at 20, some of them tilted, and some that cut either.
pub(crate) fn occluders(chance: &mut Chance, n: usize) -> Vec<Occluder> {
    let mut one = || {
        let z = chance.real(1.5, 19.0);
        let (x, y) = (chance.real(-z, z), chance.real(-z, z));
        let (w, h) = (chance.real(0.2, 4.0), chance.real(0.2, 4.0));
        let (s, t) = (chance.real(-0.6, 0.6), chance.real(-0.6, 0.6));
        let corner = |a: f64, b: f64| -> Point3 { [x + a * w, y + b * h, z + s * a * w + t * b * h] };
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let [a, b, c, d] = corners;
        if chance.int(0, 3) == 0 {
            Occluder::triangle([a, c, b])
        } else {
            Occluder::patch(corners.to_vec(), &[[a, b, c], [a, c, d]])
        }
    };
    (0..n).map(|_| one().expect("it has an area")).collect()
}

/// A job on one plane, or on four of them one behind the other.
pub(crate) fn job<'a>(occluders: &'a [Occluder], measure: Measure, texels: [u32; 2], sweep: bool) -> BufferJob<'a> {
    let volume = Volume::new(Aabb { min: [-1.0, -0.5, -1.0], max: [0.5, 0.5, 1.0] }).expect("it is a box");
    let at: &[f64] = if sweep { &[8.0, 12.0, 16.0, 20.0] } else { &[20.0] };
    let plane = |&at: &f64| BufferPlane::new(2, true, at, [-at; 2], [at; 2], texels).expect("it is a plane");
    BufferJob::new(volume, at.iter().map(plane).collect(), occluders, measure, sweep).expect("it can be done")
}
