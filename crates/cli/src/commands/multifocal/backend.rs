//! Filling one buffer by the first backend of a chain that takes the job.

use crate::error::Result;
use sightlines::multifocal::{BackendError, Buffer, Job, MultifocalBackend};

/// Fills the buffer of a job with one plane, and names the backend that did. Each backend that refuses the job is a warning,
/// but for the last one.
pub(super) fn fill(
    all: Vec<Box<dyn MultifocalBackend>>,
    job: &Job<'_>,
) -> Result<(&'static str, Buffer), BackendError> {
    let mut buffers = Vec::new();
    let n = all.len();
    for (i, mut backend) in all.into_iter().enumerate() {
        match backend.render(job, &mut buffers) {
            Ok(()) => {
                let buffer = buffers.pop().expect("a backend fills a buffer for each plane, and there is one");
                return Ok((backend.name(), buffer));
            }
            Err(error) if i + 1 == n => return Err(error),
            Err(error) => tracing::warn!("{error}; the next one takes over"),
        }
    }
    unreachable!("there is always a backend")
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines::bake::methods::Backend;
    use sightlines::geometry::Aabb;
    use sightlines::multifocal::{Measure, Occluder, Plane, Volume};
    use sightlines::multifocal_cpu::Reference;

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

        fn render(&mut self, _: &Job<'_>, _: &mut Vec<Buffer>) -> Result<(), BackendError> {
            Err(BackendError::Lost { backend: self.name(), reason: "unplugged".to_owned() })
        }
    }

    #[test]
    fn the_next_backend_takes_over() {
        let chain = |backend: Backend| backend.open(|_| {}).unwrap().chain();
        let volume = Volume::new(Aabb { min: [-0.5; 3], max: [0.5; 3] }).unwrap();
        let occluders = [Occluder::triangle([[-4., -4., 3.], [4., -4., 3.], [0., 4., 3.]]).unwrap()];
        let plane = Plane::new(2, true, 9.0, [-1.; 2], [1.; 2], [4, 4]).unwrap();
        let job = |measure| Job::new(volume, vec![plane], &occluders, measure, false).unwrap();
        let (by, buffer) = fill(vec![Box::new(Lost), Box::new(Reference)], &job(Measure::SectionHeight)).unwrap();
        assert_eq!((by, buffer.n_blocked()), ("cpu-reference", 16));
        let error = fill(vec![Box::new(Lost)], &job(Measure::SectionHeight)).unwrap_err();
        assert_eq!(error.to_string(), "the device of lost is lost: unplugged");
        assert_eq!(fill(chain(Backend::Cpu), &job(Measure::SectionHeight)).unwrap().0, "cpu");
        assert_eq!(fill(chain(Backend::Reference), &job(Measure::SectionHeight)).unwrap().0, "cpu-reference");
        // A backend without a form of a measure leaves it to the reference.
        assert_eq!(fill(chain(Backend::Cpu), &job(Measure::ClippedEuclid)).unwrap().0, "cpu-reference");
    }
}
