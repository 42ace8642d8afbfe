//! Whole jobs: sound, complete, repeatable.

use super::pair::{Pair, render};
use super::scene::Scene;
use super::{Violation, sweep};
use crate::{BackendError, Buffer, Job, Measure};

/// The previous content of a buffer: of the right size, or of any other size and number.
fn used(job: &Job<'_>, right_size: bool) -> Vec<Buffer> {
    let full = |texels: [u32; 2], value: u32| {
        let mut buffer = Buffer::default();
        buffer.reset(texels);
        buffer.values_mut().fill(value);
        buffer
    };
    if right_size {
        return job.planes().iter().map(|plane| full(plane.texels(), 0x0fff_fff0)).collect();
    }
    vec![full([31, 2], u32::MAX); job.planes().len() + 2]
}

/// The first texel in which two sets of buffers differ by `wrong`, with both values.
pub(super) fn first([a, b]: [&[Buffer]; 2], wrong: impl Fn(u32, u32) -> bool) -> Option<(usize, [u32; 2], [u32; 2])> {
    a.iter().zip(b).enumerate().find_map(|(plane, (a, b))| {
        let width = a.texels()[0] as usize;
        let at = a.values().iter().zip(b.values()).position(|(&a, &b)| wrong(a, b))?;
        let texel = [(at % width) as u32, (at / width) as u32];
        Some((plane, texel, [a.values()[at], b.values()[at]]))
    })
}

/// Clauses 1, 3 and 4, and 2 for carried planes.
pub(super) fn compare(pair: &mut Pair<'_>, scene: &Scene, measure: Measure, round: u32) -> Result<(), Violation> {
    let job = scene.job(measure);
    let got = render(pair.backend, scene, &job, Vec::new())?;
    let again = render(pair.backend, scene, &job, Vec::new())?;
    if let Some((plane, texel, [first, second])) = first([&got, &again], |a, b| a != b) {
        return Err(Violation::NotRepeatable { place: scene.place(measure, plane, texel), first, second });
    }
    // Every other pair of scenes, so that both happen with carried planes and without.
    let reused = render(pair.backend, scene, &job, used(&job, (round / 2).is_multiple_of(2)))?;
    if let Some((plane, texel, [fresh, got])) = first([&got, &reused], |a, b| a != b) {
        return Err(Violation::Incomplete { place: scene.place(measure, plane, texel), got, fresh });
    }
    let exact = render(pair.reference, scene, &job, Vec::new())?;
    if let Some((plane, texel, [got, exact])) = first([&got, &exact], |got, exact| got > exact) {
        return Err(Violation::Unsound { place: scene.place(measure, plane, texel), got, exact });
    }
    pair.report.jobs += 3;
    let count = |buffers: &[Buffer], what: fn(&Buffer) -> usize| buffers.iter().map(what).sum::<usize>();
    pair.report.texels += count(&got, |b| b.values().len());
    pair.report.blocked += count(&exact, Buffer::n_blocked);
    pair.report.found += count(&got, Buffer::n_blocked);
    if job.carry() { sweep::compare(pair, scene, &job, &got) } else { Ok(()) }
}

/// A measure that is not supported must be refused.
pub(super) fn refuses(pair: &mut Pair<'_>, scene: &Scene, measure: Measure) -> Result<(), Violation> {
    pair.report.unsupported += 1;
    match pair.backend.render(&scene.job(measure), &mut Vec::new()) {
        Err(BackendError::Unsupported { .. }) => Ok(()),
        _ => Err(Violation::NotRefused { place: scene.place(measure, 0, [0, 0]) }),
    }
}
