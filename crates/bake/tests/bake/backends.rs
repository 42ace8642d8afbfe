//! Backends by name, one of which takes over what another refuses.

use sightlines_bake::methods::Backend;
use sightlines_geometry::Aabb;
use sightlines_multifocal::{
    BackendError, Buffer, BufferJob, BufferPlane, Measure, MultifocalBackend, Occluder, Volume, render_by_first,
};
use sightlines_multifocal_cpu::Reference;

/// A device that is lost.
#[derive(Debug)]
struct Lost;

impl MultifocalBackend for Lost {
    fn name(&self) -> &'static str {
        "lost"
    }

    fn supports(&self, _: Measure) -> bool {
        true
    }

    fn render(&mut self, _: &BufferJob<'_>, _: &mut Vec<Buffer>) -> Result<(), BackendError> {
        Err(BackendError::Lost { backend: self.name(), reason: "unplugged".to_owned() })
    }
}

#[test]
fn the_next_backend_takes_over() {
    let chain = |backend: Backend| backend.open(|_| {}).unwrap().chain();
    let fill = |all, job: &BufferJob<'_>| {
        let (mut buffers, mut n_refused) = (Vec::new(), 0);
        let by = render_by_first(all, job, &mut buffers, |_| n_refused += 1)?;
        Ok::<_, BackendError>((by, buffers.pop().unwrap(), n_refused))
    };
    let volume = Volume::new(Aabb { min: [-0.5; 3], max: [0.5; 3] }).unwrap();
    let occluders = [Occluder::triangle([[-4., -4., 3.], [4., -4., 3.], [0., 4., 3.]]).unwrap()];
    let plane = BufferPlane::new(2, true, 9.0, [-1.; 2], [1.; 2], [4, 4]).unwrap();
    let job = |measure| BufferJob::new(volume, vec![plane], &occluders, measure, false).unwrap();
    let (by, buffer, n_refused) =
        fill(vec![Box::new(Lost), Box::new(Reference)], &job(Measure::SectionHeight)).unwrap();
    assert_eq!((by, buffer.n_blocked(), n_refused), ("cpu-reference", 16, 1));
    let error = fill(vec![Box::new(Lost)], &job(Measure::SectionHeight)).unwrap_err();
    assert_eq!(error.to_string(), "the device of lost is lost: unplugged");
    assert_eq!(fill(chain(Backend::Cpu), &job(Measure::SectionHeight)).unwrap().0, "cpu");
    assert_eq!(fill(chain(Backend::Reference), &job(Measure::SectionHeight)).unwrap().0, "cpu-reference");
    // A backend without a form of a measure leaves it to the reference.
    assert_eq!(fill(chain(Backend::Cpu), &job(Measure::ClippedEuclid)).unwrap().0, "cpu-reference");
}
