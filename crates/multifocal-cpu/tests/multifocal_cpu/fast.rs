//! The fast backend: what a plain loop over texels finds, with any number of threads.

use proptest::prelude::*;
use sightlines_geometry::Aabb;
use sightlines_multifocal::{
    BackendError, Buffer, BufferJob, BufferPlane, Carry, Forms, Measure, MultifocalBackend, Occluder, Volume,
};
use sightlines_multifocal_cpu::Fast;

/// Oracle: every texel, every form, every edge, as the forms' documentation says.
fn plain(job: &BufferJob<'_>) -> Vec<Buffer> {
    let mut out: Vec<Buffer> = Vec::new();
    for (k, plane) in job.planes().iter().enumerate() {
        let forms = Forms::of(job, k);
        let mut buffer = Buffer::new(plane);
        let [w, h] = plane.texels();
        for y in 0..h {
            for x in 0..w {
                let (xi, yi) = (x as i32, y as i32);
                let blocked = forms.forms.iter().filter(|form| {
                    let [x0, y0, x1, y1] = form.bounds;
                    let within = x0 <= xi && xi < x1 && y0 <= yi && yi < y1;
                    within && forms.edges_of(form).iter().all(|[a, b, c]| a * xi + b * yi + c >= 0)
                });
                let value = |form: &sightlines_multifocal::Form| {
                    let slopes = forms.slopes_of(form).iter();
                    let along = slopes.map(|[p, q, r]| r + p * (xi - form.bounds[0]) + q * (yi - form.bounds[1]));
                    along.chain([form.floor as i32]).max().expect("there is the least one") as u32
                };
                let direct = blocked.map(value).max().unwrap_or(0);
                let carried = if job.carry() && k > 0 { carried(&Carry::of(job, k), &out[k - 1], x, y) } else { 0 };
                buffer.values_mut()[(y * w + x) as usize] = direct.max(carried);
            }
        }
        out.push(buffer);
    }
    out
}

fn carried(carry: &Carry, before: &Buffer, x: u32, y: u32) -> u32 {
    let ([x0, x1], [y0, y1]) = (carry.columns[x as usize], carry.rows[y as usize]);
    let texels = (y0..=y1).flat_map(|y| (x0..=x1).map(move |x| before.get(x, y)));
    match texels.min() {
        Some(least) if least > 0 => least + carry.rise,
        _ => 0,
    }
}

fn occluder() -> impl Strategy<Value = Occluder> {
    let point = || (-24i32..25, -24i32..25, 2i32..40).prop_map(|(x, y, z)| [x, y, z].map(|x| f64::from(x) * 0.25));
    [point(), point(), point()].prop_filter_map("flat", |t| Occluder::triangle(t).ok())
}

proptest! {
    #[test]
    fn fast_is_the_plain_loop(
        occluders in prop::collection::vec(occluder(), 0..12),
        half in 0i32..8,
        texels in prop::collection::vec([1u32..50, 1u32..50], 1..4),
        measure in prop::sample::select(vec![Measure::Euclid, Measure::VertexHeight, Measure::SectionHeight]),
        carry in any::<bool>(),
    ) {
        let half = f64::from(half) * 0.125;
        let volume = Volume::new(Aabb { min: [-half; 3], max: [half, half, half.min(0.4)] }).unwrap();
        let plane = |(k, n): (usize, &[u32; 2])| {
            let (at, window) = (4.0 + 3.0 * k as f64, 3.0 + k as f64);
            BufferPlane::new(2, true, at, [-window; 2], [window, 1.5 * window], *n).unwrap()
        };
        let planes: Vec<BufferPlane> = texels.iter().enumerate().map(plane).collect();
        let job = BufferJob::new(volume, planes, &occluders, measure, carry && measure.is_height()).unwrap();
        let expected = plain(&job);
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            // What was in the buffers before does not matter.
            let mut out = vec![Buffer::default(); 5];
            let mut fast = Fast::new();
            for _ in 0..2 {
                pool.install(|| fast.render(&job, &mut out)).unwrap();
                prop_assert_eq!(&out, &expected, "{} threads", threads);
            }
        }
    }
}

/// The twin: what is compared above is not all empty.
#[test]
fn plain_loops_find_blocked_texels_and_carry_some() {
    // Two walls that overlap as seen from every eye, but none of which covers all lines to a far texel in the middle.
    let wall = |low: f64, high: f64, z: f64| {
        let corners = [[-9., low, z], [9., low, z], [9., high, z], [-9., high, z]];
        let [a, b, c, d] = corners;
        Occluder::patch(corners.to_vec(), &[[a, b, c], [a, c, d]]).unwrap()
    };
    let occluders = [wall(-9.0, 0.2, 2.0), wall(-0.2, 9.0, 3.0)];
    let volume = Volume::new(Aabb { min: [-0.25; 3], max: [0.25; 3] }).unwrap();
    let planes = [3.2, 16.0].map(|at| BufferPlane::new(2, true, at, [-3.0; 2], [3.0; 2], [40, 40]).unwrap());
    let count = |carry| {
        let job = BufferJob::new(volume, planes.to_vec(), &occluders, Measure::SectionHeight, carry).unwrap();
        plain(&job).iter().map(Buffer::n_blocked).collect::<Vec<_>>()
    };
    let (with, without) = (count(true), count(false));
    assert!(without[1] > 100 && with[1] > without[1] && with[0] == without[0], "{with:?} {without:?}");
}

#[test]
fn fast_has_no_form_of_the_clipped_distance() {
    let volume = Volume::new(Aabb { min: [-0.25; 3], max: [0.25; 3] }).unwrap();
    let plane = BufferPlane::new(2, true, 4.0, [-1.0; 2], [1.0; 2], [4, 4]).unwrap();
    let job = BufferJob::new(volume, vec![plane], [], Measure::ClippedEuclid, false).unwrap();
    let error = Fast::new().render(&job, &mut Vec::new()).unwrap_err();
    assert_eq!(error, BackendError::Unsupported { backend: "cpu", measure: Measure::ClippedEuclid });
    assert_eq!(error.to_string(), "cpu cannot measure clipped");
}
