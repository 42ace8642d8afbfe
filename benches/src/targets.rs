//! Random points on the triangles of objects.

use sightlines::cells::{Point3, Scene};
use sightlines_testkit::Random;

/// A scene whose objects can be aimed at.
#[derive(Debug)]
pub struct Targets<'a> {
    scene: &'a Scene,
    /// For each object the area of its triangles up to each, doubled.
    areas: Vec<Vec<f64>>,
    /// Objects that have an area.
    solid: Vec<u32>,
}

impl<'a> Targets<'a> {
    /// O(triangles).
    pub fn new(scene: &'a Scene) -> Self {
        let sums = |o: &sightlines::cells::SceneObject| {
            let add = |sum: &mut f64, t: [Point3; 3]| {
                *sum += area(&t);
                Some(*sum)
            };
            o.corners().scan(0.0, add).collect::<Vec<f64>>()
        };
        let areas: Vec<Vec<f64>> = scene.objects().iter().map(sums).collect();
        let has_area = |a: &[f64]| a.last().is_some_and(|sum| *sum > 0.0);
        let solid = (0u32..).zip(&areas).filter(|(_, a)| has_area(a)).map(|(o, _)| o).collect();
        Self { scene, areas, solid }
    }

    /// A point on any object, all objects alike; none if there are none.
    pub fn any(&self, random: &mut Random) -> Option<Point3> {
        let object = self.solid.get(random.below(self.solid.len().max(1)))?;
        self.on(*object, random)
    }

    /// A point on an object, uniform over its area; none if it has none.
    pub fn on(&self, object: u32, random: &mut Random) -> Option<Point3> {
        let areas = &self.areas[object as usize];
        let all = areas.last().copied().filter(|sum| *sum > 0.0)?;
        let at = random.unit() * all;
        let triangle = areas.partition_point(|sum| *sum < at).min(areas.len() - 1);
        let o = &self.scene.objects()[object as usize];
        let [a, b, c] = o.triangles[triangle].map(|i| o.vertices[i as usize]);
        let [mut s, mut t] = [random.unit(), random.unit()];
        if s + t > 1.0 {
            [s, t] = [1.0 - s, 1.0 - t];
        }
        Some([0, 1, 2].map(|k| a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k])))
    }
}

/// Twice the area of a triangle.
fn area([a, b, c]: &[Point3; 3]) -> f64 {
    let [u, v] = [b, c].map(|p| [0, 1, 2].map(|k| p[k] - a[k]));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    n.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines::cells::SceneObject;

    #[test]
    fn points_lie_on_what_has_an_area() {
        let object = |x: f64, triangles: Vec<[u32; 3]>| SceneObject {
            name: String::new(),
            vertices: vec![[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 0.0, 1.0], [x, 1.0, 1.0], [x, 0.0, 0.0]],
            triangles,
        };
        let objects =
            vec![object(0.0, vec![]), object(1.0, vec![[0, 4, 1], [0, 1, 2], [3, 1, 2]]), object(2.0, vec![[0, 0, 1]])];
        let scene = Scene::new(objects).unwrap();
        let targets = Targets::new(&scene);
        let mut random = Random::new(1, 2);
        assert!(targets.on(0, &mut random).is_none() && targets.on(2, &mut random).is_none());
        let points: Vec<Point3> = (0..400).filter_map(|_| targets.any(&mut random)).collect();
        assert!(points.len() == 400 && points.iter().all(|p| p[0] == 1.0 && p[1] <= 1.0 && p[2] <= 1.0));
        let upper = points.iter().filter(|p| p[1] + p[2] > 1.0).count();
        assert!((150..250).contains(&upper), "{upper} of 400 points in one of two equal triangles");
        let empty = Scene::default();
        assert_eq!(Targets::new(&empty).any(&mut random), None);
    }
}
