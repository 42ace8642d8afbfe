//! Backends of multifocal buffers by name.

use sightlines_multifocal::{BackendError, Buffer, BufferJob, Measure, MultifocalBackend, WithFallback};
use sightlines_multifocal_cpu::{Fast, Reference};
use std::fmt;
use std::str::FromStr;

/// What draws multifocal buffers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum Backend {
    /// Whole numbers, on the processor.
    #[default]
    Cpu,
    /// Exact arithmetic, on the processor; slow.
    Reference,
    /// The bits of [`Backend::Cpu`], on a graphics card; needs the feature `multifocal-gpu`.
    Gpu,
}

/// One backend for one thread.
type Boxed = Box<dyn MultifocalBackend>;
/// Makes a backend for one thread.
type Make = Box<dyn Fn() -> Boxed + Send + Sync>;

/// Opens a backend; warnings go to the function.
type Open = fn(fn(&str)) -> Result<Vec<Make>, NotBuiltIn>;

/// An entry of the table of backends.
struct Entry {
    name: &'static str,
    about: &'static str,
    /// The backends to try, in order; the last one takes every job.
    open: Open,
}

impl Backend {
    /// All backends, those among them that are not built in.
    pub const ALL: [Self; 3] = [Self::Cpu, Self::Reference, Self::Gpu];

    const fn entry(self) -> Entry {
        match self {
            Self::Cpu => Entry { name: "cpu", about: "In whole numbers, in threads", open: |_| Ok(processor()) },
            Self::Reference => {
                Entry { name: "reference", about: "In exact arithmetic, very slow", open: |_| Ok(vec![reference()]) }
            }
            Self::Gpu => Entry {
                name: "gpu",
                about: "As cpu, bit for bit, on a graphics card; the CPU takes over where there is none",
                open: gpu,
            },
        }
    }

    /// Lower-case name for options: what [`Display`](fmt::Display) writes and [`FromStr`] reads.
    pub const fn name(self) -> &'static str {
        self.entry().name
    }

    /// What it does, as one line of help.
    pub const fn about(self) -> &'static str {
        self.entry().about
    }

    /// Opens the backend, and those that take over the jobs it refuses. A graphics card that cannot be opened is passed
    /// over with a call of `warn`.
    ///
    /// # Errors
    /// [`NotBuiltIn`]
    pub fn open(self, warn: fn(&str)) -> Result<OpenBackend, NotBuiltIn> {
        Ok(OpenBackend { all: (self.entry().open)(warn)?, warn: (self == Self::Gpu).then_some(warn) })
    }
}

impl fmt::Display for Backend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Not the name of a backend.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no backend")]
pub struct ParseBackendError(pub String);

impl FromStr for Backend {
    type Err = ParseBackendError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|backend| backend.name() == text);
        found.ok_or_else(|| ParseBackendError(text.to_owned()))
    }
}

/// A backend that is not part of this build.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the backend {} is not part of this build: it needs the feature {feature}", backend.name())]
pub struct NotBuiltIn {
    /// The backend.
    pub backend: Backend,
    /// The Cargo feature that brings it.
    pub feature: &'static str,
}

fn reference() -> Make {
    Box::new(|| Box::new(Reference))
}

fn processor() -> Vec<Make> {
    vec![Box::new(|| Box::new(Fast::new())), reference()]
}

#[cfg(feature = "multifocal-gpu")]
fn gpu(warn: fn(&str)) -> Result<Vec<Make>, NotBuiltIn> {
    use sightlines_multifocal_gpu::{Gpu, GpuBackend, GpuPath};
    let mut all = processor();
    match Gpu::open() {
        Ok(gpu) => all.insert(0, Box::new(move || Box::new(GpuBackend::new(gpu.clone(), GpuPath::Compute)))),
        Err(error) => warn(&format!("{error}; the CPU takes over")),
    }
    Ok(all)
}

#[cfg(not(feature = "multifocal-gpu"))]
fn gpu(_: fn(&str)) -> Result<Vec<Make>, NotBuiltIn> {
    Err(NotBuiltIn { backend: Backend::Gpu, feature: "multifocal-gpu" })
}

/// An open backend with those that take over from it; it makes instances for threads.
pub struct OpenBackend {
    all: Vec<Make>,
    /// Called when the processor takes over from a device.
    warn: Option<fn(&str)>,
}

impl fmt::Debug for OpenBackend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.chain()).finish()
    }
}

impl OpenBackend {
    /// The backends one by one, in the order in which they are tried; at least one.
    pub fn chain(&self) -> Vec<Box<dyn MultifocalBackend>> {
        self.all.iter().map(|make| make()).collect()
    }

    /// One backend that does each job by the first of the chain that takes it.
    pub fn instance(&self) -> Box<dyn MultifocalBackend> {
        let mut chain = self.chain().into_iter();
        let first = chain.next().expect("a chain is never empty");
        let rest = chain.rev().reduce(|second, first| Box::new(WithFallback::new(first, second)));
        match (rest, self.warn) {
            (None, _) => first,
            (Some(rest), None) => Box::new(WithFallback::new(first, rest)),
            (Some(rest), Some(warn)) => Box::new(Warning { inner: WithFallback::new(first, rest), warn }),
        }
    }
}

/// A backend with one that takes over, and a call for each new reason to.
#[derive(Debug)]
struct Warning {
    inner: WithFallback<Boxed, Boxed>,
    warn: fn(&str),
}

impl MultifocalBackend for Warning {
    fn name(&self) -> &'static str {
        self.inner.name()
    }

    fn supports(&self, measure: Measure) -> bool {
        self.inner.supports(measure)
    }

    fn render(&mut self, job: &BufferJob<'_>, out: &mut Vec<Buffer>) -> Result<(), BackendError> {
        let before = self.inner.took_over().cloned();
        let done = self.inner.render(job, out);
        if let Some(error) = self.inner.took_over().filter(|error| before.as_ref() != Some(error)) {
            (self.warn)(&format!("{error}; the CPU takes over"));
        }
        done
    }
}
