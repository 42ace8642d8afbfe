//! Who fills the buffer, and who takes over.

use sightlines::multifocal::{BackendError, Buffer, Job, MultifocalBackend};
use sightlines::multifocal_cpu::{Fast, Reference};
use sightlines::multifocal_gpu::{Gpu, GpuBackend, Way};

/// A backend as an argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Kind {
    /// In whole numbers, in threads
    Cpu,
    /// In exact arithmetic, slow
    Reference,
    /// As cpu, bit for bit, on a graphics card; the CPU takes over where there is none
    Gpu,
}

/// Fills the buffer of a job with one plane; who did it. If one cannot, the next one takes over, and a warning says so.
pub(super) fn fill(kind: Kind, job: &Job<'_>) -> Result<(&'static str, Buffer), BackendError> {
    let mut all: Vec<Box<dyn MultifocalBackend>> = Vec::new();
    if kind == Kind::Gpu {
        match Gpu::open() {
            Ok(gpu) => all.push(Box::new(GpuBackend::new(gpu, Way::Compute))),
            Err(error) => tracing::warn!("{error}; the CPU takes over"),
        }
    }
    if kind != Kind::Reference {
        all.push(Box::new(Fast::new()));
    }
    all.push(Box::new(Reference));
    first(all, job)
}

/// What the first that can makes of a job.
fn first(all: Vec<Box<dyn MultifocalBackend>>, job: &Job<'_>) -> Result<(&'static str, Buffer), BackendError> {
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
    use sightlines::geometry::Aabb;
    use sightlines::multifocal::{Measure, Occluder, Plane, Volume};

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
    fn somebody_takes_over() {
        let volume = Volume::new(Aabb { min: [-0.5; 3], max: [0.5; 3] }).unwrap();
        let occluders = [Occluder::triangle([[-4., -4., 3.], [4., -4., 3.], [0., 4., 3.]]).unwrap()];
        let plane = Plane::new(2, true, 9.0, [-1.; 2], [1.; 2], [4, 4]).unwrap();
        let job = |measure| Job::new(volume, vec![plane], &occluders, measure, false).unwrap();
        let (by, buffer) = first(vec![Box::new(Lost), Box::new(Reference)], &job(Measure::SectionHeight)).unwrap();
        assert_eq!((by, buffer.n_blocked()), ("cpu-reference", 16));
        let error = first(vec![Box::new(Lost)], &job(Measure::SectionHeight)).unwrap_err();
        assert_eq!(error.to_string(), "the device of lost is lost: unplugged");
        assert_eq!(fill(Kind::Cpu, &job(Measure::SectionHeight)).unwrap().0, "cpu");
        assert_eq!(fill(Kind::Reference, &job(Measure::SectionHeight)).unwrap().0, "cpu-reference");
        // Who has no form of a measure leaves it to the reference.
        assert_eq!(fill(Kind::Cpu, &job(Measure::ClippedEuclid)).unwrap().0, "cpu-reference");
    }
}
