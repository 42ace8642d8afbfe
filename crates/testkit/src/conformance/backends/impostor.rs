//! Backends with one fault each.

use crate::conformance::Impostor;
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::{BackendError, Buffer, BufferJob, BufferPlane, Measure, MultifocalBackend, Volume};

faults! {
    /// What a wrong backend does.
    BackendFault {
        /// Values of blocked texels are one unit too large. (A backend that errs by a unit itself masks this.)
        OneUnitNearer breaks Sound,
        /// One texel beside a blocked one counts as blocked too.
        OneTexelMore breaks Sound,
        /// One row of each buffer is left empty.
        MissedRow breaks Tight,
        /// Old content of a buffer stays where it is larger.
        ForgetsToReset breaks Complete,
        /// Every other job has one texel less.
        NotRepeatable breaks Repeatable,
        /// Nothing is ever blocked, which is sound.
        NothingBlocked breaks Tight,
        /// Values of blocked texels are all 1: blocked from the plane on, no more. Sound as well.
        NoValues breaks Tight,
        /// A texel counts as blocked if each corner of the volume has some occluder that blocks it. Wrong, because eyes
        /// inside the volume may see through between two occluders.
        UnionOfCorners breaks Sound,
        /// An unblocked texel has the value of one that is blocked from height 0 on.
        ZeroForNothing breaks Sound,
        /// Planes are not carried over.
        NothingCarried breaks Tight,
        /// Planes are carried over as if all lines to a texel went from the middle of the volume to the middle of the
        /// texel.
        NoErosion breaks Sound,
        /// Does nothing for a measure that it claims to support.
        Idle breaks Complete,
    }
}

impl<B: MultifocalBackend> Impostor<B, BackendFault> {
    fn corners(&mut self, job: &BufferJob<'_>, out: &mut [Buffer]) -> Result<(), BackendError> {
        let mut least: Vec<Vec<u32>> = out.iter().map(|buffer| vec![u32::MAX; buffer.values().len()]).collect();
        for corner in job.volume().corners() {
            let part = with(job, point(corner), job.carry());
            let mut buffers = Vec::new();
            self.inner.render(&part, &mut buffers)?;
            // Units are powers of two.
            let per_unit = part.unit() / job.unit();
            let rescaled = |v: u32| if v == 0 { 0 } else { (f64::from(v - 1) * per_unit) as u32 + 1 };
            for (least, &v) in least.iter_mut().flatten().zip(buffers.iter().flat_map(Buffer::values)) {
                *least = rescaled(v).min(*least);
            }
        }
        let values = out.iter_mut().flat_map(Buffer::values_mut);
        values.zip(least.iter().flatten()).for_each(|(value, &least)| *value = (*value).max(least));
        Ok(())
    }
}

fn point(p: Point3) -> Volume {
    Volume::new(Aabb { min: p, max: p }).expect("a corner of a volume is a volume")
}

fn with<'a>(job: &BufferJob<'a>, volume: Volume, carry: bool) -> BufferJob<'a> {
    BufferJob::new(volume, job.planes().to_vec(), job.occluders().iter().copied(), job.measure(), carry)
        .expect("a part of the volume makes a job, too")
}

impl<B: MultifocalBackend> MultifocalBackend for Impostor<B, BackendFault> {
    fn name(&self) -> &'static str {
        "impostor"
    }

    fn supports(&self, measure: Measure) -> bool {
        self.inner.supports(measure)
    }

    fn render(&mut self, job: &BufferJob<'_>, out: &mut Vec<Buffer>) -> Result<(), BackendError> {
        let is_odd = self.call().is_multiple_of(2);
        let before = out.clone();
        match self.fault {
            BackendFault::Idle => return Ok(()),
            BackendFault::NothingCarried => return self.inner.render(&with(job, *job.volume(), false), out),
            _ => self.inner.render(job, out)?,
        }
        if self.fault == BackendFault::UnionOfCorners {
            return self.corners(job, out);
        }
        if self.fault == BackendFault::NoErosion && job.carry() {
            for idx in 1..out.len() {
                let (known, stored) = out.split_at_mut(idx);
                carry_middles(job, [&job.planes()[idx - 1], &job.planes()[idx]], &known[idx - 1], &mut stored[0]);
            }
        }
        out.iter_mut().enumerate().for_each(|(i, buffer)| spoil(self.fault, is_odd, before.get(i), buffer));
        Ok(())
    }
}

/// Faults that a single buffer shows.
fn spoil(fault: BackendFault, is_odd: bool, before: Option<&Buffer>, buffer: &mut Buffer) {
    let [width, height] = buffer.texels().map(|n| n as usize);
    let first_blocked = buffer.values().iter().position(|&v| v > 0);
    let values = buffer.values_mut();
    match fault {
        BackendFault::OneUnitNearer => values.iter_mut().filter(|v| **v > 0).for_each(|v| *v += 1),
        BackendFault::NoValues => values.iter_mut().for_each(|v| *v = (*v).min(1)),
        BackendFault::NothingBlocked => values.fill(0),
        BackendFault::ZeroForNothing => values.iter_mut().for_each(|v| *v = (*v).max(1)),
        BackendFault::MissedRow => values[height / 2 * width..][..width].fill(0),
        BackendFault::OneTexelMore => {
            // No texel precedes the first blocked one if it is the very first.
            if let Some(i) = first_blocked.and_then(|i| i.checked_sub(1)) {
                values[i] = 1;
            }
        }
        BackendFault::NotRepeatable => {
            if let Some(i) = first_blocked.filter(|_| is_odd) {
                values[i] = 0;
            }
        }
        BackendFault::ForgetsToReset => {
            if let Some(before) = before.filter(|b| b.values().len() == values.len()) {
                values.iter_mut().zip(before.values()).for_each(|(v, &old)| *v = (*v).max(old));
            }
        }
        BackendFault::UnionOfCorners | BackendFault::NothingCarried | BackendFault::NoErosion | BackendFault::Idle => {}
    }
}

fn carry_middles(job: &BufferJob<'_>, [nearer, plane]: [&BufferPlane; 2], known: &Buffer, stored: &mut Buffer) {
    let b = job.volume().bounds();
    let eye: Point3 = [0, 1, 2].map(|k| b.min[k] + (b.max[k] - b.min[k]) / 2.0);
    let between = plane.height(nearer.corner(0, 0));
    let part = between / plane.height(eye);
    let rise = (between / job.unit()).floor() as u32;
    let width = plane.texels()[0] as usize;
    for (i, stored) in stored.values_mut().iter_mut().enumerate() {
        let texel = [i % width, i / width];
        let crossed = [0, 1].map(|k| {
            let p = plane.origin()[k] + plane.step()[k] * (texel[k] as f64 + 0.5);
            let x = p + (eye[plane.across()[k]] - p) * part;
            ((x - nearer.origin()[k]) / nearer.step()[k]).floor()
        });
        let is_within = (0..2).all(|k| (0.0..f64::from(nearer.texels()[k])).contains(&crossed[k]));
        let value = if is_within { known.get(crossed[0] as u32, crossed[1] as u32) } else { 0 };
        if value > 0 {
            *stored = (*stored).max(value + rise);
        }
    }
}
