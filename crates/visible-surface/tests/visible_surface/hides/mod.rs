//! Which face hides another, by brute force in whole numbers.
//!
//! The directions in which both are met, one before the other, are those on the positive side of some planes through
//! the eye. All rays in which two of those planes meet and that are outside of none are summed up: the sum is strictly
//! inside of all if anything is.

/// Triangles and an eye with small whole coordinates.
#[derive(Debug, Clone)]
pub(crate) struct Grid {
    pub(crate) triangles: Vec<[Vector; 3]>,
    pub(crate) eye: Vector,
}

type Vector = [i128; 3];

fn minus(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn times(a: Vector, s: i128) -> Vector {
    a.map(|x| x * s)
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Vector, b: Vector) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The corners as seen from the eye, and six times the volume between.
fn seen(grid: &Grid, face: u32) -> ([Vector; 3], i128) {
    let t = grid.triangles[face as usize].map(|p| minus(p, grid.eye));
    (t, dot(cross(t[0], t[1]), t[2]))
}

/// Whether in some directions, and those around, both are met, and `p` first, or both in one plane and `p` has the
/// lower id.
pub(crate) fn hides(grid: &Grid, p: u32, q: u32) -> bool {
    let ((a, v), (b, w)) = (seen(grid, p), seen(grid, q));
    if p == q || v == 0 || w == 0 {
        return false;
    }
    let sides = |t: [Vector; 3], volume: i128| [0, 1, 2].map(|k| times(cross(t[k], t[(k + 1) % 3]), volume.signum()));
    let mut planes = [sides(a, v), sides(b, w)].concat();
    // n · d = v where the first is met at d; so n · d / v is one over the distance.
    let normal = |t: [Vector; 3]| cross(minus(t[1], t[0]), minus(t[2], t[0]));
    let nearer = times(minus(times(normal(a), w), times(normal(b), v)), (v * w).signum());
    if nearer == [0; 3] {
        if p > q {
            return false;
        }
    } else {
        planes.push(nearer);
    }
    let mut sum = [0; 3];
    for i in 0..planes.len() {
        for j in 0..planes.len() {
            let ray = cross(planes[i], planes[j]);
            if planes.iter().all(|&n| dot(n, ray) >= 0) {
                sum = [0, 1, 2].map(|k| sum[k] + ray[k]);
            }
        }
    }
    planes.iter().all(|&n| dot(n, sum) > 0)
}

/// Whether faces hide each other in a circle.
pub(crate) fn is_circular(grid: &Grid) -> bool {
    let n = grid.triangles.len() as u32;
    // Takes away what hides nothing that is left, until nothing is left or nothing goes.
    let mut left: Vec<u32> = (0..n).collect();
    loop {
        let stays: Vec<u32> = left.iter().copied().filter(|&p| left.iter().any(|&q| hides(grid, p, q))).collect();
        if stays.len() == left.len() {
            return !left.is_empty();
        }
        left = stays;
    }
}
