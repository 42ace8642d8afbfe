//! Small scenes made of bytes, and what has to hold of them simplified.

use crate::numbers::Numbers;
use crate::surfaces::point;
use sightlines::cells::{Scene, SceneObject};
use sightlines::geometry::{Aabb, Point3};
use sightlines::multifocal::mesh::{SheetMethod, Sheets};
use sightlines::multifocal::{FromRegion, Volume};
use sightlines::simplify::{HiddenBy, MeasureOptions, SimplifyOptions, Views, estimate, geometric, measure, simplify};
use std::sync::Arc;

/// Triangles, where eyes are, and how to simplify.
#[derive(Debug)]
pub struct SmallMesh {
    scene: Scene,
    views: Views,
    options: SimplifyOptions,
}

impl SmallMesh {
    /// The scene that bytes stand for; none if their numbers are refused.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let mut numbers = Numbers::new(bytes);
        let view = Aabb::around([point(&mut numbers), point(&mut numbers)]);
        let views = Views::new([Volume::new(view).ok()?]).ok()?;
        let flags = numbers.byte();
        let options = SimplifyOptions {
            budget: [0.0, 1e-3, 0.05, 0.5][usize::from(flags % 4)],
            collapse: [0.0, 0.5, 1.0, 1.0][usize::from(flags / 4 % 4)],
            flat: flags & 16 != 0,
            shift: if flags & 32 != 0 { f64::INFINITY } else { 0.1 },
            n_parts: 1 + usize::from(flags / 64),
            n_rays: 256,
            depth: 2,
            threads: 1,
            ..SimplifyOptions::default()
        };
        let mut objects = Vec::new();
        for name in ["a", "b"] {
            let n = 3 + usize::from(numbers.byte() % 12);
            let vertices: Vec<Point3> = (0..n).map(|_| point(&mut numbers)).collect();
            let index = |numbers: &mut Numbers<'_>| u32::from(numbers.byte()) % n as u32;
            let triangles = (0..numbers.byte() % 24).map(|_| std::array::from_fn(|_| index(&mut numbers))).collect();
            objects.push(SceneObject { name: name.into(), vertices, triangles });
        }
        Some(Self { scene: Scene::new(objects).ok()?, views, options })
    }

    /// Checks the promise by rays, and what merging and the metric of shape say of themselves.
    ///
    /// # Panics
    /// If something does not hold.
    pub fn check(&self) {
        let Self { scene, views, options } = self;
        let triangles: Vec<[Point3; 3]> = scene.objects().iter().flat_map(|o| o.corners()).collect();
        let sheets = Arc::new(Sheets::new(&triangles));
        let make = || Box::new(SheetMethod::shared(Arc::clone(&sheets))) as Box<dyn FromRegion + Send>;
        let by = HiddenBy { method: Some(&make), table: None };
        let left = simplify(scene, views, &by, options).expect("a small scene");
        let counts = left.counts;
        assert!(left.bound <= options.budget && left.shift <= options.shift, "{left:?}");
        assert!(options.budget > 0.0 || counts.deleted + counts.collapsed + counts.new == 0, "{counts:?}");
        assert!(left.scene(scene).is_ok());
        let rays = MeasureOptions { n_eyes: 6, n_rays: 200, threads: 1, ..MeasureOptions::default() };
        // A flat view may lie in a surface, whose eyes are promised nothing.
        let bounds = views.parts()[0].volume.bounds();
        if (0..3).all(|k| bounds.min[k] < bounds.max[k]) {
            let measured = measure(scene, &left, views, &rays).expect("a small scene");
            let hits = (measured.worst * rays.n_rays as f64).round() as u64;
            let surely = estimate::interval(hits, rays.n_rays, 1.0 - 1e-12).ends[0];
            assert!(surely <= left.bound, "{measured:?} {left:?}");
            assert!(left.bound > 0.0 || measured.changed == 0.0, "{measured:?} {left:?}");
        }
        let shape = geometric(scene, 1).expect("a small scene");
        assert!(shape.counts.left <= scene.n_triangles() && shape.deviation >= 0.0);
    }
}
