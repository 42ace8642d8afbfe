//! The form in floats: never more than what is exact, and not much less.

use crate::common::scene::{job, occluders};
use crate::common::{Chance, gpu};
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::{BufferJob, BufferPlane, Measure, MultifocalBackend, Occluder, Volume};
use sightlines_multifocal_cpu::{Fast, Reference};
use sightlines_multifocal_gpu::{GpuBackend, GpuPath};

/// How many texels floats and integers block, after checking that neither exceeds the reference.
fn compare(backend: &mut GpuBackend, job: &BufferJob<'_>, what: &str) -> [usize; 3] {
    let (mut floats, mut integers, mut exact) = (Vec::new(), Vec::new(), Vec::new());
    backend.render(job, &mut floats).expect("the device does it");
    Fast::new().render(job, &mut integers).expect("the processor does it");
    Reference.render(job, &mut exact).expect("the reference does it");
    for (plane, exact) in exact.iter().enumerate() {
        for (i, (float, exact)) in floats[plane].values().iter().zip(exact.values()).enumerate() {
            assert!(float <= exact, "{what}, plane {plane}, texel {i}: {float} exceeds {exact}");
        }
    }
    [floats, integers, exact].map(|buffers| buffers.iter().map(|b| b.n_blocked()).sum())
}

#[test]
fn floats_never_exceed_the_reference_and_lose_little() {
    let Some(gpu) = gpu("floats against the reference") else { return };
    let mut backend = GpuBackend::new(gpu, GpuPath::Float);
    let mut sum = [0; 3];
    for seed in 0..3 {
        let occluders = occluders(&mut Chance::new(seed), 60);
        let job = job(&occluders, Measure::VertexHeight, [40, 36], false);
        let counts = compare(&mut backend, &job, &format!("seed {seed}"));
        sum.iter_mut().zip(counts).for_each(|(sum, n)| *sum += n);
    }
    let [floats, integers, exact] = sum;
    println!("blocked: floats {floats}, integers {integers}, exact {exact}");
    assert!(floats * 100 > exact * 97 && exact > 1000, "{floats} of {exact} texels");
}

#[test]
fn floats_never_exceed_the_reference_in_near_degenerate_scenes() {
    let Some(gpu) = gpu("floats in near-degenerate scenes") else { return };
    let mut backend = GpuBackend::new(gpu, GpuPath::Float);
    // Edges of umbrae along lines between texels: far from the origin, and in all directions.
    let mut n_blocked = 0;
    for (axis, positive, far) in [(0, true, 0.0), (1, false, 1e5), (2, true, -3e6), (0, false, 7.0)] {
        let put = |u: f64, v: f64, h: f64| -> Point3 {
            let mut p = [0.0; 3];
            p[axis] = if positive { h } else { -h };
            p[(axis + 1) % 3] = u;
            p[(axis + 2) % 3] = v;
            p.map(|x| x + far)
        };
        let volume = Aabb::around([put(-1.0, -1.0, -1.0), put(1.0, 1.0, 1.0)]);
        let volume = Volume::new(volume).expect("it is a box");
        let square = |low: f64, high: f64, h: f64| {
            let [a, b, c, d] = [put(low, low, h), put(high, low, h), put(high, high, h), put(low, high, h)];
            Occluder::patch(vec![a, b, c, d], &[[a, b, c], [a, c, d]]).expect("it has an area")
        };
        // Half way to the plane: its umbra is twice as large, less the volume's size.
        let occluders = [square(-3.0, 3.0, 8.5), square(-4.0, -2.0, 4.0), square(0.0, 5.0, 15.0)];
        let plane =
            BufferPlane::new(axis, positive, put(0.0, 0.0, 16.0)[axis], [far - 8.0; 2], [far + 8.0; 2], [32, 32]);
        let plane = plane.expect("it is a plane");
        let job =
            BufferJob::new(volume, vec![plane], &occluders, Measure::VertexHeight, false).expect("it can be done");
        let [floats, ..] = compare(&mut backend, &job, &format!("axis {axis}, {far} away"));
        n_blocked += floats;
    }
    assert!(n_blocked > 300, "{n_blocked}");
}

#[test]
fn floats_carry_from_plane_to_plane() {
    let Some(gpu) = gpu("floats on sweeps") else { return };
    let occluders = occluders(&mut Chance::new(20), 60);
    let sweep = job(&occluders, Measure::VertexHeight, [40, 36], true);
    let [floats, integers, _] = compare(&mut GpuBackend::new(gpu, GpuPath::Float), &sweep, "sweep");
    assert!(floats * 100 > integers * 90 && floats > 100, "{floats} and {integers}");
}
