use sightlines_visible_surface::*;
use std::time::Instant;
fn main() {
    use sightlines_scenes::*;
    let args: Vec<String> = std::env::args().skip(1).collect();
    let camera = Camera::look_at(surfaces::EYE, surfaces::AT, surfaces::UP, surfaces::ANGLE, [640, 480]).unwrap();
    let run = |name: &str, faces: &Faces, camera: &Camera| {
        let chosen = Chosen::all(faces);
        let shot = Shot { faces, camera, chosen: &chosen };
        let reference = ZBuffer::new(DepthFormat::Exact).picture(&shot).0;
        for method in [&Newell as &dyn VisibleSurface, &Painter] {
        let t = Instant::now();
        let mut c = Counters::default();
        let _ = method.see(&shot, &mut c);
        let see = t.elapsed().as_secs_f64();
        let t = Instant::now();
        let (image, c) = method.picture(&shot);
        let cmp = compare(&shot, &reference, &image);
        println!("{name} {} faces {} see {see:.3}s picture {:.3}s wrong {} ties {} splits {} fragments {} exact {} overdraw {:.1} {:?}", method.name(), faces.len(), t.elapsed().as_secs_f64(), cmp.wrong.len(), cmp.ties, c.splits, c.fragments, c.exact, c.overdraw(), c.tests);
        }
    };
    for a in &args {
        if a.contains('/') {
            let f = sightlines_formats::scene::read_scene(a).unwrap();
            let faces = Faces::of_scene(&f.scene).unwrap();
            let b = f.scene.bounds();
            let at = |x: f64, y: f64, z: f64| [b.min[0] + x * (b.max[0] - b.min[0]), b.min[1] + y * (b.max[1] - b.min[1]), b.min[2] + z * (b.max[2] - b.min[2])];
            for (e, l) in [(at(0.2, 0.2, 0.5), at(0.9, 0.3, 0.5)), (at(0.5, 0.3, 0.5), at(0.1, 0.2, 0.4)), (at(-0.5, 1.5, -0.5), at(0.5, 0.5, 0.5))] {
                let camera = Camera::look_at(e, l, [0., 1., 0.], 60.0, [640, 480]).unwrap();
                run(a, &faces, &camera);
            }
            continue;
        }
        let (kind, n) = a.split_once(':').unwrap();
        let n: u32 = n.parse().unwrap();
        let o = SurfaceOptions { triangles: n, ..Default::default() };
        let scene = match kind { "soup" => soup(o), "coplanar" => coplanar(o), "slivers" => slivers(o), "cycles" => cycles(n), "interleaved" => interleaved(n), "lattice" => lattice(n), "split" => split_worst(n), _ => depth_pairs(DepthPairsOptions { pairs: n, ..Default::default() }) }.unwrap();
        run(a, &Faces::of_scene(&scene).unwrap(), &camera);
    }
}
