//! The fast backend: the integer form of a job, row by row, in threads.
//!
//! Draws [`Forms`] and carries values from plane to plane as whole numbers, so its buffers have the same bits on every
//! machine and with any number of threads, and are those of any other backend that does the same.

mod carry;
mod fill;

use rayon::prelude::*;
use sightlines_multifocal::{BackendError, Buffer, BufferJob, Carry, Forms, Measure, MultifocalBackend, Outlines};

/// Rows that one thread draws at a time: as many as stay in the nearest cache.
const ROWS: usize = 16;

/// Fills buffers by spans of rows, in the threads of the pool that it is called in.
#[derive(Debug, Clone, Default)]
pub struct Fast {
    outlines: Outlines,
    forms: Forms,
    lines: carry::Scratch,
}

impl Fast {
    /// A backend without memory of any job.
    pub fn new() -> Self {
        Self::default()
    }
}

impl MultifocalBackend for Fast {
    fn name(&self) -> &'static str {
        "cpu"
    }

    fn supports(&self, measure: Measure) -> bool {
        measure != Measure::ClippedEuclid
    }

    /// O(rows of umbrae · edges + texels of umbrae + texels · log(range of a carry)).
    fn render(&mut self, job: &BufferJob<'_>, out: &mut Vec<Buffer>) -> Result<(), BackendError> {
        if !self.supports(job.measure()) {
            return Err(BackendError::Unsupported { backend: self.name(), measure: job.measure() });
        }
        self.outlines.refill(job);
        out.resize_with(job.planes().len(), Buffer::default);
        for (k, plane) in job.planes().iter().enumerate() {
            let (before, rest) = out.split_at_mut(k);
            let buffer = &mut rest[0];
            buffer.reset(plane.texels());
            if let Some(before) = before.last().filter(|_| job.carry()) {
                carry::carry(&Carry::of(job, k), before, buffer, &mut self.lines);
            }
            self.forms.clear();
            self.forms.extend(job, &self.outlines, k);
            draw(&self.forms, buffer);
        }
        Ok(())
    }
}

/// Draws forms into a buffer, each where it is more than what is there.
pub fn draw(forms: &Forms, buffer: &mut Buffer) {
    let width = buffer.texels()[0] as usize;
    buffer.values_mut().par_chunks_mut(width * ROWS).enumerate().for_each(|(band, rows)| {
        let first = (band * ROWS) as i32;
        let last = first + (rows.len() / width) as i32;
        for form in &forms.forms {
            let (from, to) = (form.bounds[1].max(first), form.bounds[3].min(last));
            for y in from..to {
                let row = &mut rows[(y - first) as usize * width..][..width];
                fill::fill(forms, form, y, row);
            }
        }
    });
}
