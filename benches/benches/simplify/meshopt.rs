//! The meshoptimizer library as the ordinary metric of shape: only with the feature `meshopt`, which needs a C++ compiler.

use meshopt::{SimplifyOptions, simplify_decoder};
use sightlines::cells::{Scene, SceneObject};
use sightlines::simplify::{Counts, Simplified};
use std::collections::BTreeMap;

/// Halvings of the error that is allowed.
const STEPS: u32 = 24;

/// Each object simplified with the same error in scene units, the largest one with which at most `target` triangles are left; with
/// no limit to the error if that is not enough.
pub(crate) fn simplified(scene: &Scene, target: usize) -> Simplified {
    let bounds = scene.bounds();
    let size = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max) as f32;
    let count = |lists: &[Vec<[u32; 3]>]| lists.iter().map(Vec::len).sum::<usize>();
    let all = |error: f32| scene.objects().iter().map(|o| one(o, error)).collect::<Vec<_>>();
    // From a millionth of the scene to all of it, halved in logarithms.
    let (mut low, mut high) = (size * 1e-6, size);
    let mut best = all(high);
    for _ in 0..STEPS {
        let middle = (low * high).sqrt();
        let left = all(middle);
        if count(&left) <= target {
            (high, best) = (middle, left);
        } else {
            low = middle;
        }
    }
    let origin: Vec<Vec<Option<u32>>> = scene.objects().iter().zip(&best).map(|(o, t)| origins(o, t)).collect();
    let left = count(&best);
    let new = origin.iter().flatten().filter(|o| o.is_none()).count();
    let before = scene.n_triangles();
    let counts = Counts { before, left, new, collapsed: before - (left - new), ..Counts::default() };
    let [bound, deviation, shift] = [f64::INFINITY; 3];
    let hidden = vec![Vec::new(); best.len()];
    Simplified { triangles: best, origin, hidden, bound, deviation, shift, counts }
}

fn one(object: &SceneObject, error: f32) -> Vec<[u32; 3]> {
    if object.triangles.is_empty() {
        return Vec::new();
    }
    // Single precision, from the object's own corner.
    let corner = object.bounds().min;
    let positions: Vec<[f32; 3]> =
        object.vertices.iter().map(|p| [0, 1, 2].map(|k| (p[k] - corner[k]) as f32)).collect();
    let indices = object.triangles.as_flattened();
    let left = simplify_decoder(indices, &positions, 0, error, SimplifyOptions::ErrorAbsolute, None);
    left.as_chunks::<3>().0.to_vec()
}

/// Which triangle of the object each one was.
fn origins(object: &SceneObject, left: &[[u32; 3]]) -> Vec<Option<u32>> {
    let turned = |&[a, b, c]: &[u32; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
    let ids: BTreeMap<_, u32> = object.triangles.iter().map(turned).zip(0..).collect();
    left.iter().map(|t| ids.get(&turned(t)).copied()).collect()
}
