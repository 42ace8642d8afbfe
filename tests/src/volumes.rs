//! Small worlds of triangles made of bytes, and the properties that every from-region method must have.

use crate::numbers::Numbers;
use sightlines::cells::{Scene, SceneObject};
use sightlines::geometry::{Aabb, Point3};
use sightlines::multifocal::mesh::{PatchOptions, SheetMethod, patches};
use sightlines::multifocal::{
    Buffer, BufferJob, BufferPlane, FromRegion, Layout, Measure, Multifocal, MultifocalBackend, OccluderSelection,
    UnionMethod, Volume,
};
use sightlines::multifocal_cpu::{Fast, Reference};
use sightlines_testkit::sampled_view;
use std::sync::Arc;

/// A volume, things that hide, and boxes that may be hidden.
#[derive(Debug)]
pub struct SmallWorld {
    scene: Scene,
    volume: Aabb<3>,
    targets: Vec<Aabb<3>>,
}

fn one(numbers: &mut Numbers<'_>, n: i32) -> i32 {
    i32::from(numbers.byte()) % n
}

fn point(numbers: &mut Numbers<'_>, n: i32) -> Point3 {
    std::array::from_fn(|_| f64::from(one(numbers, 2 * n + 1) - n) * 0.5)
}

fn cuboid(numbers: &mut Numbers<'_>, reach: i32, size: i32) -> Aabb<3> {
    let min = point(numbers, reach);
    Aabb { min, max: std::array::from_fn(|k| min[k] + f64::from(one(numbers, size)) * 0.5) }
}

impl SmallWorld {
    /// The world that bytes stand for: coordinates are halves between -12 and 12, so things touch often. None without a
    /// triangle.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let numbers = &mut Numbers::new(bytes);
        let volume = cuboid(numbers, 6, 5);
        let targets = (0..4).map(|_| cuboid(numbers, 24, 6)).collect();
        let mut objects = Vec::new();
        while !numbers.is_empty() && objects.len() < 12 {
            let (origin, u, v) = (point(numbers, 24), point(numbers, 20), point(numbers, 20));
            let at = |s: f64, t: f64| std::array::from_fn(|k| origin[k] + s * u[k] + t * v[k]);
            let vertices = vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
            let triangles = if one(numbers, 3) == 0 { vec![[0, 1, 2]] } else { vec![[0, 1, 2], [0, 2, 3]] };
            objects.push(SceneObject { name: objects.len().to_string(), vertices, triangles });
        }
        let scene = Scene::new(objects).expect("small numbers make a scene");
        (scene.n_triangles() > 0).then_some(Self { scene, volume, targets })
    }

    fn triangles(&self) -> Vec<[Point3; 3]> {
        self.scene.objects().iter().flat_map(|o| o.corners()).collect()
    }

    /// What is shipped hides nothing that a ray reaches.
    ///
    /// # Panics
    /// If it does.
    pub fn check_hidden(&self, n_rays: u64) {
        let triangles = self.triangles();
        let ends = self.targets.iter().flat_map(|b| [b.min, b.max]);
        let around = Aabb::around(ends.chain([self.scene.bounds().min, self.scene.bounds().max]));
        let chosen = Arc::new(OccluderSelection::new(patches(&triangles, &PatchOptions::default()), 100));
        let layout = Layout { texels: 16, planes: 3, ..Layout::default() };
        let buffers = Multifocal::new(Fast::new(), chosen, around, layout);
        let mut method = UnionMethod::new(vec![Box::new(buffers), Box::new(SheetMethod::new(&triangles))]);
        let volume = Volume::new(self.volume).expect("a box");
        let mut umbra = method.umbra(&volume).expect("the CPU does not fail");
        let hidden: Vec<usize> = (0..self.targets.len()).filter(|&i| umbra.hides(&self.targets[i])).collect();
        if !hidden.is_empty() {
            let seen = sampled_view(&self.scene, &self.volume, &self.targets, n_rays, 1);
            assert_eq!(seen.refuted(hidden), [], "what is called hidden is seen in {self:?}");
        }
    }

    /// The fast backend never says more than the reference.
    ///
    /// # Panics
    /// If it does.
    pub fn check_backends(&self) {
        let occluders = patches(&self.triangles(), &PatchOptions::default());
        let volume = Volume::new(self.volume).expect("a box");
        let plane = |(at, n): (f64, u32)| {
            BufferPlane::new(1, true, at, [-9.0, -8.0], [9.0, 10.0], [n, n + 1]).expect("a plane")
        };
        let planes: Vec<BufferPlane> = [(6.0, 5), (9.5, 7)].map(plane).to_vec();
        for measure in [Measure::VertexHeight, Measure::SectionHeight] {
            let job = BufferJob::new(volume, planes.clone(), &occluders, measure, true)
                .expect("planes in front of the volume");
            let (mut fast, mut exact) = (Vec::<Buffer>::new(), Vec::new());
            Fast::new().render(&job, &mut fast).expect("the CPU does not fail");
            Reference.render(&job, &mut exact).expect("the CPU does not fail");
            for (fast, exact) in fast.iter().zip(&exact) {
                let no_more = fast.values().iter().zip(exact.values()).all(|(fast, exact)| fast <= exact);
                assert!(no_more, "{measure:?}: the fast backend says more than the reference in {self:?}");
            }
        }
    }
}
