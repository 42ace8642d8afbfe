//! What a job costs: `cost [OCCLUDERS] [TEXELS] [VOLUME HALF SIZE]`, for each way and measure, and how many texels each
//! blocks. Beside the time it shows, where the system tells, the processor's time of all threads: with a software device
//! on a busy machine that is the number to compare.

use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::{
    BackendError, Buffer, BufferJob, BufferPlane, Measure, MultifocalBackend, Occluder, Volume,
};
use sightlines_multifocal_cpu::Fast;
use sightlines_multifocal_gpu::{Gpu, GpuBackend, GpuPath, PlaneForms};
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let number = |i: usize, default: f64| std::env::args().nth(i).map_or(Ok(default), |s| s.parse::<f64>());
    let (n, texels, half) = (number(1, 1000.0)? as usize, number(2, 512.0)? as u32, number(3, 1.0)?);
    let gpu = Gpu::open()?;
    println!("{n} occluders, {texels} x {texels} texels, volume of half size {half}, on {}", gpu.name());
    println!("{:>14} {:>10} {:>8} {:>8} {:>8} {:>10}", "measure", "way", "ms", "cpu ms", "forms ms", "blocked");
    let occluders = rectangles(n)?;
    let volume = Volume::new(Aabb { min: [-half; 3], max: [half; 3] })?;
    for measure in [Measure::VertexHeight, Measure::SectionHeight] {
        let plane = BufferPlane::new(2, true, 20.0, [-20.0; 2], [20.0; 2], [texels; 2])?;
        let job = BufferJob::new(volume, vec![plane], &occluders, measure, false)?;
        let integers = fastest(|| drop(PlaneForms::of(&job)));
        let show = |backend: &mut dyn MultifocalBackend| -> Result<(), BackendError> {
            let mut out: Vec<Buffer> = Vec::new();
            backend.render(&job, &mut out)?;
            let time = fastest(|| backend.render(&job, &mut out).expect("it did so before"));
            let (name, n) = (backend.name(), out[0].n_blocked());
            println!("{:>14} {name:>10} {:8.1} {:8.1} {:8.1} {n:10}", measure.name(), time[0], time[1], integers[0]);
            Ok(())
        };
        show(&mut Fast::new())?;
        for way in GpuPath::ALL {
            let mut backend = GpuBackend::new(gpu.clone(), way);
            if !backend.supports(measure) {
                continue;
            }
            show(&mut backend)?;
        }
    }
    Ok(())
}

/// The least time of several, and the mean time of the processor.
fn fastest(mut act: impl FnMut()) -> [f64; 2] {
    let (start, before) = (Instant::now(), processor());
    let (mut n, mut least) = (0.0, f64::INFINITY);
    while n < 5.0 || start.elapsed().as_secs_f64() < 1.0 {
        let start = Instant::now();
        act();
        least = least.min(start.elapsed().as_secs_f64() * 1e3);
        n += 1.0;
    }
    [least, (processor() - before) / n]
}

/// Milliseconds of user and system time of this process, in steps of ten; 0 where it is not to be had.
fn processor() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = text.rsplit(')').next().unwrap_or_default();
    let ticks = after_name.split_whitespace().skip(11).take(2).map(|n| n.parse::<f64>().unwrap_or(0.0));
    ticks.sum::<f64>() * 10.0
}

/// Tilted rectangles between the volume and the plane, the same in every run.
fn rectangles(n: usize) -> Result<Vec<Occluder>, Box<dyn Error>> {
    let mut state = 1u64;
    let mut unit = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut one = || {
        let mut between = |low: f64, high: f64| low + (high - low) * unit();
        let z = between(3.0, 15.0);
        let (x, y) = (between(-z, z), between(-z, z));
        let (w, h) = (between(0.5, 2.0), between(0.5, 2.0));
        let (s, t) = (between(-0.3, 0.3), between(-0.3, 0.3));
        let corner = |a: f64, b: f64| -> Point3 { [x + a * w, y + b * h, z + s * a * w + t * b * h] };
        let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        Occluder::patch(vec![a, b, c, d], &[[a, b, c], [a, c, d]])
    };
    Ok((0..n).map(|_| one()).collect::<Result<_, _>>()?)
}
