//! The backend, in three ways.

use crate::context::Gpu;
use crate::draw::{self, Input};
use crate::{GpuPath, OpenError, PlaneForms, Ticket, Values};
use sightlines_multifocal::{BackendError, Buffer, BufferJob, Measure, MultifocalBackend};

/// A backend on a GPU. Clones share the device; each may be used from another thread.
#[derive(Debug, Clone)]
pub struct GpuBackend {
    gpu: Gpu,
    path: GpuPath,
}

impl GpuBackend {
    /// Opens a device, see [`Gpu::open`].
    ///
    /// # Errors
    /// [`OpenError`]
    pub fn open(path: GpuPath) -> Result<Self, OpenError> {
        Ok(Self::new(Gpu::open()?, path))
    }

    /// A backend on the device and the queue of a host, see [`Gpu::from_device`].
    ///
    /// # Errors
    /// [`OpenError`]
    pub fn from_device(device: wgpu::Device, queue: wgpu::Queue, path: GpuPath) -> Result<Self, OpenError> {
        Ok(Self::new(Gpu::from_device(device, queue)?, path))
    }

    /// A backend on a device that is open already.
    pub const fn new(gpu: Gpu, path: GpuPath) -> Self {
        Self { gpu, path }
    }

    /// The device.
    pub const fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// How it fills buffers.
    pub const fn path(&self) -> GpuPath {
        self.path
    }

    /// Gives the device a job and returns at once; any number of jobs may be in flight.
    ///
    /// The occluders are turned into integers on the caller's thread, O(planes · occluders · corners); with
    /// [`Self::submit_forms`] that can be done elsewhere.
    ///
    /// # Errors
    /// [`BackendError`], for errors that are known at once
    pub fn submit(&self, job: &BufferJob<'_>) -> Result<Ticket, BackendError> {
        let values = self.keep(job)?;
        self.gpu.fetch(self.path.name(), &values)
    }

    /// As [`Self::submit`], for planes that are integers already.
    ///
    /// # Errors
    /// [`BackendError`]; [`GpuPath::Float`] has no use for integers
    pub fn submit_forms(&self, planes: &[PlaneForms]) -> Result<Ticket, BackendError> {
        let values = self.keep_forms(planes)?;
        self.gpu.fetch(self.path.name(), &values)
    }

    /// Gives the device a job whose result stays there. Whatever is submitted to the device's queue later finds it
    /// done.
    ///
    /// # Errors
    /// [`BackendError`], for errors that are known at once
    pub fn keep(&self, job: &BufferJob<'_>) -> Result<Values, BackendError> {
        if !self.supports(job.measure()) {
            return Err(BackendError::Unsupported { backend: self.path.name(), measure: job.measure() });
        }
        match self.path {
            GpuPath::Float => draw::draw(&self.gpu, self.path, &Input::Floats(job)),
            _ => self.keep_forms(&PlaneForms::of(job)),
        }
    }

    /// As [`Self::keep`], for planes that are integers already.
    ///
    /// # Errors
    /// [`BackendError`]; [`GpuPath::Float`] has no use for integers
    pub fn keep_forms(&self, planes: &[PlaneForms]) -> Result<Values, BackendError> {
        if self.path == GpuPath::Float {
            return Err(BackendError::Unsupported { backend: self.path.name(), measure: Measure::default() });
        }
        draw::draw(&self.gpu, self.path, &Input::Forms(planes))
    }

    /// The buffers of a job, one for each plane, if it is done; asked again it gives them again. Never waits.
    pub fn poll(&self, ticket: &Ticket) -> Option<Result<Vec<Buffer>, BackendError>> {
        self.gpu.poll_ticket(ticket)
    }

    /// The buffers of a job. Waits for them.
    ///
    /// # Errors
    /// [`BackendError`]
    pub fn wait(&self, ticket: &Ticket) -> Result<Vec<Buffer>, BackendError> {
        self.gpu.wait_for(ticket)
    }
}

impl MultifocalBackend for GpuBackend {
    fn name(&self) -> &'static str {
        self.path.name()
    }

    fn supports(&self, measure: Measure) -> bool {
        match self.path {
            GpuPath::Float => measure == Measure::VertexHeight,
            _ => measure != Measure::ClippedEuclid,
        }
    }

    fn render(&mut self, job: &BufferJob<'_>, out: &mut Vec<Buffer>) -> Result<(), BackendError> {
        let ticket = self.submit(job)?;
        *out = self.wait(&ticket)?;
        Ok(())
    }
}
