//! A device with its shaders, shared by all who work on it.

use crate::OpenError;
use crate::pipelines::Pipelines;
use sightlines_multifocal::BackendError;
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::{BindGroup, BindGroupLayout, Buffer, BufferBinding, BufferUsages, Device, Error, ErrorFilter, Queue};

/// A device, its queue, and the shaders on it. Clones share them.
#[derive(Debug, Clone)]
pub struct Gpu(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    device: Device,
    queue: Queue,
    name: String,
    pipelines: Pipelines,
    /// What the driver said when the device was lost.
    lost: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Builds the shaders on a device.
    pub(crate) fn new(device: Device, queue: Queue, name: String) -> Result<Self, OpenError> {
        let scope = device.push_error_scope(ErrorFilter::Validation);
        let internal = device.push_error_scope(ErrorFilter::Internal);
        let pipelines = Pipelines::new(&device);
        // Natively both are there at once.
        let errors = [pollster::block_on(internal.pop()), pollster::block_on(scope.pop())];
        match errors.into_iter().flatten().next() {
            Some(error) => Err(OpenError::Shaders(error.to_string())),
            None => Ok(Self(Arc::new(Inner { device, queue, name, pipelines, lost: Arc::default() }))),
        }
    }

    /// Takes the callback of a device that is ours.
    pub(crate) fn hear_of_loss(&self) {
        let lost = Arc::clone(&self.0.lost);
        self.0.device.set_device_lost_callback(move |reason, text| set_lost(&lost, format!("{reason:?}: {text}")));
    }

    /// Says that the device was lost: everything fails from now on.
    pub fn tell_lost(&self, reason: String) {
        set_lost(&self.0.lost, reason);
    }

    /// The device, for what a host does with results that stay there.
    pub fn device(&self) -> &Device {
        &self.0.device
    }

    /// The queue of the device.
    pub fn queue(&self) -> &Queue {
        &self.0.queue
    }

    /// Name of the adapter.
    pub fn name(&self) -> &str {
        &self.0.name
    }

    pub(crate) fn pipelines(&self) -> &Pipelines {
        &self.0.pipelines
    }

    /// An error if the device is lost.
    pub(crate) fn check_alive(&self, backend: &'static str) -> Result<(), BackendError> {
        let lost = self.0.lost.lock().unwrap_or_else(PoisonError::into_inner);
        lost.as_ref().map_or(Ok(()), |reason| Err(BackendError::Lost { backend, reason: reason.clone() }))
    }

    /// An error if a buffer of `needed` bytes, bound to a shader or not, is more than the device allows.
    pub(crate) fn check_size(&self, backend: &'static str, needed: u64, bound: bool) -> Result<(), BackendError> {
        let limits = self.0.device.limits();
        let binding = limits.max_storage_buffer_binding_size;
        let offered = if bound { limits.max_buffer_size.min(binding) } else { limits.max_buffer_size };
        if needed <= offered { Ok(()) } else { Err(BackendError::OutOfMemory { backend, needed, offered }) }
    }

    /// Does something with the device, and turns what it complains about into an error. `needed` is the size of the
    /// largest buffer, for the message.
    pub(crate) fn guarded<T>(
        &self,
        backend: &'static str,
        needed: u64,
        act: impl FnOnce() -> T,
    ) -> Result<T, BackendError> {
        self.check_alive(backend)?;
        let filters = [ErrorFilter::Internal, ErrorFilter::Validation, ErrorFilter::OutOfMemory];
        let [a, b, c] = filters.map(|filter| self.0.device.push_error_scope(filter));
        let result = act();
        // Innermost first: memory that is missing makes calls invalid.
        let errors = [pollster::block_on(c.pop()), pollster::block_on(b.pop()), pollster::block_on(a.pop())];
        self.check_alive(backend)?;
        match errors.into_iter().flatten().next() {
            None => Ok(result),
            Some(Error::OutOfMemory { .. }) => {
                let offered = self.0.device.limits().max_buffer_size;
                Err(BackendError::OutOfMemory { backend, needed, offered })
            }
            Some(error) => {
                self.notice_loss();
                self.check_alive(backend)?;
                Err(BackendError::Device { backend, reason: error.to_string() })
            }
        }
    }

    /// Finds out whether the device is lost, which only its callback learns. On a device that is, nothing can be made,
    /// and what was made is not complained about until it is used.
    fn notice_loss(&self) {
        // Whatever comes of it: this is what calls the callback, if it is ours.
        let _ = self.0.device.poll(wgpu::PollType::Poll);
        let memory = self.0.device.push_error_scope(ErrorFilter::OutOfMemory);
        let scope = self.0.device.push_error_scope(ErrorFilter::Validation);
        let probe = self.buffer("probe", 4, BufferUsages::COPY_DST);
        self.0.queue.write_buffer(&probe, 0, &[0; 4]);
        let refused = pollster::block_on(scope.pop()).is_some();
        if refused && pollster::block_on(memory.pop()).is_none() && self.check_alive("").is_ok() {
            self.tell_lost("it makes no buffers any more".to_owned());
        }
    }

    /// A buffer with `bytes`, and at least `least` zeros, so that it can be bound also if there is nothing in it.
    pub(crate) fn upload(&self, label: &str, bytes: &[u8], least: u64, usage: BufferUsages) -> Buffer {
        let size = (bytes.len() as u64).max(least);
        let buffer = self.buffer(label, size, usage | BufferUsages::COPY_DST);
        if !bytes.is_empty() {
            self.0.queue.write_buffer(&buffer, 0, bytes);
        }
        buffer
    }

    pub(crate) fn buffer(&self, label: &str, size: u64, usage: BufferUsages) -> Buffer {
        let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
        self.0.device.create_buffer(&descriptor)
    }

    /// Binds parts of buffers in order from 0.
    pub(crate) fn bind(&self, layout: &BindGroupLayout, parts: &[BufferBinding<'_>]) -> BindGroup {
        let mut entries = Vec::with_capacity(parts.len());
        for (binding, part) in (0..).zip(parts) {
            let resource = wgpu::BindingResource::Buffer(part.clone());
            entries.push(wgpu::BindGroupEntry { binding, resource });
        }
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout, entries: &entries };
        self.0.device.create_bind_group(&descriptor)
    }
}

fn set_lost(lost: &Mutex<Option<String>>, reason: String) {
    *lost.lock().unwrap_or_else(PoisonError::into_inner) = Some(reason);
}
