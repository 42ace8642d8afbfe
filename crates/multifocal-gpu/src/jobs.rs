//! Jobs in flight.

use crate::context::Gpu;
use crate::recording::{Part, Values};
use sightlines_multifocal::{BackendError, Buffer};
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::{BufferUsages, MapMode, PollType};

/// A job that the device works on. Dropped, its result is forgotten.
#[derive(Debug)]
pub struct Ticket {
    name: &'static str,
    parts: Vec<Part>,
    staging: wgpu::Buffer,
    /// Whether the result is there, or could not be had.
    state: Arc<Mutex<Option<bool>>>,
}

impl Gpu {
    /// Requests the values of all planes, copied to memory that the host can read.
    pub(crate) fn fetch(&self, name: &'static str, values: &Values) -> Result<Ticket, BackendError> {
        let size = values.buffer.size();
        let state = Arc::new(Mutex::new(None));
        let staging = self.guarded(name, size, || {
            let staging = self.buffer("staging", size, BufferUsages::COPY_DST | BufferUsages::MAP_READ);
            let mut encoder = self.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.copy_buffer_to_buffer(&values.buffer, 0, &staging, 0, size);
            self.queue().submit([encoder.finish()]);
            let result_of_map = Arc::clone(&state);
            staging.map_async(MapMode::Read, .., move |result| {
                *result_of_map.lock().unwrap_or_else(PoisonError::into_inner) = Some(result.is_ok());
            });
            staging
        })?;
        Ok(Ticket { name, parts: values.parts.clone(), staging, state })
    }

    /// The buffers of a job, if it is done: one for each plane. Does not wait.
    pub(crate) fn poll_ticket(&self, ticket: &Ticket) -> Option<Result<Vec<Buffer>, BackendError>> {
        if let Err(error) = self.device().poll(PollType::Poll) {
            return Some(Err(BackendError::Device { backend: ticket.name, reason: error.to_string() }));
        }
        if let Err(lost) = self.check_alive(ticket.name) {
            return Some(Err(lost));
        }
        let state = *ticket.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.map(|arrived| if arrived { ticket.read() } else { Err(self.not_arrived(ticket)) })
    }

    /// As [`Self::poll_ticket`], but waits.
    pub(crate) fn wait_for(&self, ticket: &Ticket) -> Result<Vec<Buffer>, BackendError> {
        loop {
            if let Some(result) = self.poll_ticket(ticket) {
                return result;
            }
            if let Err(error) = self.device().poll(PollType::wait_indefinitely()) {
                return Err(BackendError::Device { backend: ticket.name, reason: error.to_string() });
            }
        }
    }

    /// A result that a device owes and does not give: it is lost, whether or not somebody said so.
    fn not_arrived(&self, ticket: &Ticket) -> BackendError {
        self.tell_lost("it gave no result for what was submitted".to_owned());
        BackendError::Lost { backend: ticket.name, reason: "it gave no result for what was submitted".to_owned() }
    }
}

impl Ticket {
    fn read(&self) -> Result<Vec<Buffer>, BackendError> {
        let read = |part: &Part| {
            let failed = |e: wgpu::MapRangeError| BackendError::Device { backend: self.name, reason: e.to_string() };
            let bytes = self.staging.get_mapped_range(part.offset..part.offset + part.bytes()).map_err(failed)?;
            let mut buffer = Buffer::default();
            buffer.reset(part.texels);
            for (value, bytes) in buffer.values_mut().iter_mut().zip(bytes.chunks_exact(4)) {
                *value = u32::from_le_bytes(bytes.try_into().expect("chunks have four bytes"));
            }
            Ok(buffer)
        };
        self.parts.iter().map(read).collect()
    }
}
