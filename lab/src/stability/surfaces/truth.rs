//! What each pixel shows, by brute force in whole numbers: every ray against every face.

use crate::stability::predicates::exact::{Whole3, whole, whole_all};
use num_bigint::{BigInt, Sign};
use sightlines::visible_surface::{Camera, Faces, NOTHING};

fn cross(a: &Whole3, b: &Whole3) -> Whole3 {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &a[i] * &b[j] - &a[j] * &b[i]
    })
}

fn dot(a: &Whole3, b: &Whole3) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// A face from the eye: the normals of the planes through its edges and the eye, and the product of the three ways.
struct Cone {
    sides: [Whole3; 3],
    volume: BigInt,
}

/// For each pixel, row by row, the face that its ray meets first; nothing where the ray meets an edge, or two faces first at one
/// depth, for there rules decide and not what is seen.
pub(super) fn picture(faces: &Faces, camera: &Camera) -> Vec<Option<u32>> {
    let points: Vec<_> = std::iter::once(camera.eye()).chain(faces.corners().iter().flatten().copied()).collect();
    let points = whole_all(&points);
    let (eye, corners) = points.split_first().expect("there is an eye");
    let cones: Vec<Cone> = corners
        .chunks_exact(3)
        .map(|of| {
            let way = |p: &Whole3| -> Whole3 { std::array::from_fn(|k| &p[k] - &eye[k]) };
            let [a, b, c] = [way(&of[0]), way(&of[1]), way(&of[2])];
            let sides = [cross(&a, &b), cross(&b, &c), cross(&c, &a)];
            let volume = dot(&sides[0], &c);
            Cone { sides, volume }
        })
        .collect();
    let [corner, across, down] = whole(camera.rays());
    let [width, height] = camera.size();
    (0..width * height)
        .map(|i| {
            let (x, y) = (2 * (i % width) + 1, 2 * (i / width) + 1);
            let ray: Whole3 = std::array::from_fn(|k| &corner[k] * 2 + &across[k] * x + &down[k] * y);
            first(&cones, &ray)
        })
        .collect()
}

fn first(cones: &[Cone], ray: &Whole3) -> Option<u32> {
    // The nearest face, and its depth as a fraction with a positive denominator.
    let mut best: Option<(u32, BigInt, BigInt)> = None;
    let mut tied = false;
    for (face, cone) in (0..).zip(cones) {
        let values = cone.sides.each_ref().map(|n| dot(n, ray));
        let has = |sign: Sign| values.iter().any(|v| v.sign() == sign);
        if cone.volume.sign() == Sign::NoSign || (has(Sign::Plus) && has(Sign::Minus)) {
            continue;
        }
        if has(Sign::NoSign) {
            return None;
        }
        let [u, v, w] = values;
        let (mut num, mut den) = (cone.volume.clone(), u + v + w);
        if den.sign() == Sign::Minus {
            (num, den) = (-num, -den);
        }
        if num.sign() == Sign::Minus {
            continue;
        }
        match best.as_ref().map(|(_, n, d)| (&num * d).cmp(&(n * &den))) {
            Some(std::cmp::Ordering::Greater) => {}
            Some(std::cmp::Ordering::Equal) => tied = true,
            _ => {
                tied = false;
                best = Some((face, num, den));
            }
        }
    }
    if tied { None } else { Some(best.map_or(NOTHING, |(face, ..)| face)) }
}
