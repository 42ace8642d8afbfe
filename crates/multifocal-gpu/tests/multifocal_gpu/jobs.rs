//! Whole jobs: the bits of the processor's backend, many in flight, devices that fail, and who takes over.

use crate::common::scene::{job, occluders};
use crate::common::{Chance, expected, gpu};
use sightlines_multifocal::{BackendError, Buffer, Measure, MultifocalBackend, WithFallback};
use sightlines_multifocal_cpu::Fast;
use sightlines_multifocal_gpu::{Gpu, GpuBackend, GpuPath, PlaneForms, wgpu};
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

const WAYS: [GpuPath; 2] = [GpuPath::Compute, GpuPath::Raster];

#[test]
fn jobs_equality_with_the_processor() {
    let Some(gpu) = gpu("jobs as on the processor") else { return };
    let (mut n_texels, mut n_blocked) = (0, 0);
    for seed in 0..4 {
        let occluders = occluders(&mut Chance::new(seed), 80);
        for measure in Measure::ALL {
            for sweep in [false, true] {
                if !Fast::new().supports(measure) || sweep && !measure.is_height() {
                    continue;
                }
                let job = job(&occluders, measure, [70, 90], sweep);
                let mut right = Vec::new();
                Fast::new().render(&job, &mut right).expect("the processor does it");
                assert_eq!(right, expected(&PlaneForms::of(&job)), "the processor's backend errs");
                for way in WAYS {
                    // Whatever was in the buffers before.
                    let mut found = vec![right[0].clone(); 7];
                    GpuBackend::new(gpu.clone(), way).render(&job, &mut found).expect("it is done");
                    assert!(found == right, "{}, {}, sweep {sweep}, seed {seed}", way.name(), measure.name());
                    n_texels += found.iter().map(|b| b.values().len()).sum::<usize>();
                    n_blocked += found.iter().map(Buffer::n_blocked).sum::<usize>();
                }
            }
        }
    }
    assert!(n_texels > 500_000 && n_blocked * 20 > n_texels, "{n_blocked} of {n_texels} texels were blocked");
}

#[test]
fn jobs_many_in_flight_come_back_each_with_its_own() {
    let Some(gpu) = gpu("many in flight") else { return };
    let scenes: Vec<_> = (0..24).map(|seed| occluders(&mut Chance::new(seed), 30)).collect();
    let jobs: Vec<_> = scenes.iter().map(|s| job(s, Measure::SectionHeight, [50, 40], false)).collect();
    let backends = WAYS.map(|way| GpuBackend::new(gpu.clone(), way));
    let mut open: Vec<_> =
        jobs.iter().enumerate().map(|(i, job)| (i, backends[i % 2].submit(job).expect("submitted"))).collect();
    let start = Instant::now();
    let mut different = BTreeSet::new();
    while !open.is_empty() {
        assert!(start.elapsed() < Duration::from_secs(60), "{} jobs never came back", open.len());
        open.retain(|(i, ticket)| {
            let Some(result) = backends[i % 2].poll(ticket) else { return true };
            let found = result.expect("it is done");
            let mut right = Vec::new();
            Fast::new().render(&jobs[*i], &mut right).expect("the processor does it");
            assert!(found == right, "job {i}");
            assert!(backends[i % 2].poll(ticket) == Some(Ok(found)), "asked again, it gives the same");
            different.insert(right[0].values().to_vec());
            false
        });
    }
    assert!(different.len() > 20, "the jobs are not the same");
}

#[test]
fn jobs_come_from_many_threads() {
    let Some(gpu) = gpu("many threads") else { return };
    std::thread::scope(|threads| {
        for seed in 0..4 {
            let mut backend = GpuBackend::new(gpu.clone(), WAYS[seed as usize % 2]);
            threads.spawn(move || {
                let occluders = occluders(&mut Chance::new(seed), 30);
                let job = job(&occluders, Measure::VertexHeight, [60, 33], true);
                let (mut found, mut right) = (Vec::new(), Vec::new());
                Fast::new().render(&job, &mut right).expect("the processor does it");
                for _ in 0..5 {
                    backend.render(&job, &mut found).expect("it is done");
                    assert!(found == right, "thread {seed}");
                }
            });
        }
    });
}

#[test]
fn jobs_that_nothing_blocks() {
    let Some(gpu) = gpu("empty jobs") else { return };
    for way in GpuPath::ALL {
        let mut found = Vec::new();
        GpuBackend::new(gpu.clone(), way)
            .render(&job(&[], Measure::VertexHeight, [17, 1], false), &mut found)
            .expect("it is done");
        assert_eq!((found.len(), found[0].texels(), found[0].n_blocked()), (1, [17, 1], 0), "{}", way.name());
    }
}

#[test]
fn jobs_of_measures_without_a_form_are_refused() {
    let Some(gpu) = gpu("measures without a form") else { return };
    let occluders = occluders(&mut Chance::new(1), 3);
    let mut n_refused = 0;
    for (way, measure) in GpuPath::ALL.into_iter().flat_map(|way| Measure::ALL.map(|measure| (way, measure))) {
        let mut backend = GpuBackend::new(gpu.clone(), way);
        let result = backend.render(&job(&occluders, measure, [8, 8], false), &mut Vec::new());
        if backend.supports(measure) {
            assert_eq!(result, Ok(()));
        } else {
            assert_eq!(result, Err(BackendError::Unsupported { backend: way.name(), measure }));
            n_refused += 1;
        }
    }
    assert_eq!(n_refused, 2 + 3);
}

#[test]
fn devices_that_are_lost_say_so_and_somebody_takes_over() {
    if gpu("a lost device").is_none() {
        return;
    }
    let gpu = Gpu::open().expect("there is one");
    let occluders = occluders(&mut Chance::new(5), 40);
    let job = job(&occluders, Measure::SectionHeight, [64, 64], true);
    let mut right = Vec::new();
    Fast::new().render(&job, &mut right).expect("the processor does it");
    let backend = GpuBackend::new(gpu.clone(), GpuPath::Compute);
    let mut both = WithFallback::new(backend.clone(), Fast::new());
    let mut found = Vec::new();
    both.render(&job, &mut found).expect("it is done");
    assert!(found == right && both.took_over().is_none() && both.name() == "gpu");

    gpu.device().destroy();
    both.render(&job, &mut found).expect("the processor takes over");
    assert!(found == right && both.name() == "cpu");
    let error = both.took_over().expect("it says so").clone();
    assert!(matches!(&error, BackendError::Lost { backend: "gpu", .. }), "{error:?}");
    assert!(error.to_string().starts_with("the device of gpu is lost: "), "{error}");
    // And it stays lost.
    let again = backend.submit(&job).and_then(|ticket| backend.wait(&ticket));
    assert!(matches!(again, Err(BackendError::Lost { .. })), "{:?}", again.err());
}

#[test]
fn devices_lost_with_jobs_in_flight_give_an_answer_to_each() {
    if gpu("lost with jobs in flight").is_none() {
        return;
    }
    let gpu = Gpu::open().expect("there is one");
    let occluders = occluders(&mut Chance::new(6), 200);
    let job = job(&occluders, Measure::SectionHeight, [300, 300], false);
    let backend = GpuBackend::new(gpu.clone(), GpuPath::Compute);
    let tickets: Vec<_> = (0..4).map(|_| backend.submit(&job).expect("submitted")).collect();
    gpu.device().destroy();
    let answers: Vec<_> = tickets.iter().map(|ticket| backend.wait(ticket)).collect();
    assert!(answers.iter().all(|a| matches!(a, Ok(_) | Err(BackendError::Lost { .. }))));
    assert!(matches!(answers[3], Err(BackendError::Lost { .. })), "the device is gone");
}

#[test]
fn devices_of_hosts_are_used_and_their_loss_is_noticed() {
    if gpu("a host's device").is_none() {
        return;
    }
    let host = Gpu::open().expect("there is one");
    let (device, queue) = (host.device().clone(), host.queue().clone());
    let mut backend = GpuBackend::from_device(device.clone(), queue, GpuPath::Raster).expect("it has what is needed");
    let occluders = occluders(&mut Chance::new(7), 40);
    let job = job(&occluders, Measure::VertexHeight, [40, 40], true);
    let (mut found, mut right) = (Vec::new(), Vec::new());
    Fast::new().render(&job, &mut right).expect("the processor does it");
    backend.render(&job, &mut found).expect("it is done");
    assert!(found == right);
    device.destroy();
    let error = backend.render(&job, &mut found).expect_err("the device is gone");
    assert!(matches!(error, BackendError::Lost { backend: "gpu-raster", .. }), "{error:?}");
}

/// A device that allows no large buffers.
fn small_device() -> Gpu {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&Default::default())).expect("there is one");
    let required_limits =
        wgpu::Limits { max_storage_buffer_binding_size: 1 << 16, max_buffer_size: 1 << 17, ..wgpu::Limits::default() };
    let descriptor = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).expect("it opens");
    Gpu::from_device(device, queue).expect("it has what is needed")
}

#[test]
fn jobs_too_large_for_a_device_are_refused_before_they_are_tried() {
    if gpu("too large").is_none() {
        return;
    }
    let gpu = small_device();
    let occluders = occluders(&mut Chance::new(8), 10);
    for way in GpuPath::ALL {
        let mut backend = GpuBackend::new(gpu.clone(), way);
        let fits = job(&occluders, Measure::VertexHeight, [128, 128], false);
        let mut found = Vec::new();
        backend.render(&fits, &mut found).expect("64 KiB of values fit");
        for (large, sweep) in [([129, 128], false), ([128, 128], true)] {
            let large = job(&occluders, Measure::VertexHeight, large, sweep);
            let error = backend.render(&large, &mut found).expect_err("more does not fit");
            let BackendError::OutOfMemory { backend: name, needed, offered } = error else { panic!("{error:?}") };
            assert!(name == way.name() && needed > offered, "{needed} and {offered}");
        }
        // The device is as good as before, and the processor does what it cannot.
        backend.render(&fits, &mut found).expect("it is asked again");
        let large = job(&occluders, Measure::VertexHeight, [500, 500], false);
        let mut both = WithFallback::new(backend, Fast::new());
        both.render(&large, &mut found).expect("the processor takes over");
        assert!(matches!(both.took_over(), Some(BackendError::OutOfMemory { .. })));
        both.render(&fits, &mut found).expect("the device does it");
        assert!(both.took_over().is_none());
    }
}
