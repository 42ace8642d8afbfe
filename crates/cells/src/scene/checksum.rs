//! A hash that tells two scenes apart.

use super::{MovingObject, Scene, SceneObject};
use sightlines_geometry::Aabb;
use sightlines_pvs::ObjectSource;
use xxhash_rust::xxh3::Xxh3;

impl Scene {
    /// A hash of all that the scene is, with names and in its order, by the bits of its numbers. Scenes with equal hashes are the same scene: it guards
    /// against mistakes, not against malice. O(size), some ten times as fast as the digests.
    pub fn checksum(&self) -> u128 {
        let Self { objects, mirrors, see_through, moving, single_sided, front_occluders, doors, sources } = self;
        let mut sum = Sum::default();
        sum.length(objects.len());
        for SceneObject { name, vertices, triangles } in objects {
            sum.length(name.len());
            sum.0.update(name.as_bytes());
            sum.numbers(vertices.as_flattened());
            sum.integers(triangles.as_flattened());
        }
        [mirrors, see_through, single_sided, front_occluders, doors].into_iter().for_each(|list| sum.integers(list));
        sum.length(moving.len());
        for MovingObject { object, within } in moving {
            sum.integers(&[*object, u32::from(within.is_some())]);
            let within = within.unwrap_or(Aabb::EMPTY);
            sum.numbers(&[within.min, within.max].concat());
        }
        sum.length(sources.len());
        for source in sources {
            let source = source.map(|ObjectSource { node, primitive }| [node, primitive]);
            sum.integers(source.as_ref().map_or(&[], |source| &source[..]));
        }
        sum.0.digest128()
    }
}

/// Hashes lists, with their lengths.
#[derive(Default)]
struct Sum(Xxh3);

impl Sum {
    fn length(&mut self, n: usize) {
        self.0.update(&(n as u64).to_le_bytes());
    }

    fn numbers(&mut self, numbers: &[f64]) {
        self.list(numbers, f64::to_le_bytes);
    }

    fn integers(&mut self, integers: &[u32]) {
        self.list(integers, u32::to_le_bytes);
    }

    fn list<T: Copy, const N: usize>(&mut self, items: &[T], bytes: impl Fn(T) -> [u8; N]) {
        self.length(items.len());
        let mut buffer = [0; 2048];
        for chunk in items.chunks(buffer.len() / N) {
            buffer.chunks_exact_mut(N).zip(chunk).for_each(|(out, item)| out.copy_from_slice(&bytes(*item)));
            self.0.update(&buffer[..chunk.len() * N]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn object(vertices: &[[f64; 3]], triangles: Vec<[u32; 3]>) -> SceneObject {
        SceneObject { name: "o".to_owned(), vertices: vertices.to_vec(), triangles }
    }

    fn scene() -> Scene {
        let square = |z: f64| [[0., 0., z], [1., 0., z], [1., 1., z], [0., 1., z]];
        let low = object(&square(0.), vec![[0, 1, 2], [0, 2, 3]]);
        Scene::new(vec![low, object(&square(2.), vec![[0, 1, 2]])]).unwrap()
    }

    #[test]
    fn checksums_differ_with_whatever_a_scene_has() {
        let with = |change: fn(&mut Vec<SceneObject>)| {
            let mut objects = scene().objects().to_vec();
            change(&mut objects);
            Scene::new(objects).unwrap()
        };
        let moving = |within| scene().with_moving(vec![MovingObject { object: 1, within }]).unwrap();
        let source = Some(ObjectSource { node: 0, primitive: 1 });
        let scenes = [
            scene(),
            Scene::default(),
            with(|o| o[1].vertices[0][2] = 2f64.next_up()),
            with(|o| o[0].triangles.truncate(1)),
            with(|o| o[0].triangles[0] = [1, 2, 0]),
            with(|o| o[0].triangles.reverse()),
            with(|o| o[0].name = "other".to_owned()),
            with(|o| o.swap(0, 1)),
            scene().with_see_through(vec![1]).unwrap(),
            scene().with_single_sided(vec![1]).unwrap(),
            scene().with_see_through(vec![1]).and_then(|scene| scene.with_front_occluders(vec![1])).unwrap(),
            scene().with_mirrors(vec![1]).unwrap(),
            scene().with_doors(vec![1]).unwrap(),
            moving(None),
            moving(Some(Aabb { min: [0.; 3], max: [3.; 3] })),
            moving(Some(Aabb { min: [0.; 3], max: [3., 3., 4.] })),
            scene().with_sources(vec![None, source]).unwrap(),
            scene().with_sources(vec![source, None]).unwrap(),
        ];
        let sums = scenes.each_ref().map(Scene::checksum);
        assert_eq!(sums[0], scene().checksum());
        for (k, sum) in sums.iter().enumerate() {
            assert!(!sums[..k].contains(sum), "scene {k}");
        }
        // A list that is longer than what is hashed at once.
        let many = |last: f64| {
            let corners: Vec<[f64; 3]> =
                (0..1000).map(|k| [f64::from(k), 0.0, if k == 999 { last } else { 0.0 }]).collect();
            Scene::new(vec![object(&corners, Vec::new())]).unwrap().checksum()
        };
        assert_ne!(many(0.0), many(1.0));
    }
}
