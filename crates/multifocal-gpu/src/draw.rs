//! Drawing a job: its planes, one after the other, by one of the techniques.

use crate::context::Gpu;
use crate::pack::{Packed, PlaneForms};
use crate::path::GpuPath;
use crate::recording::{Recording, Sizes, Uploaded, Values};
use crate::{float, outline};
use sightlines_multifocal::{BackendError, BufferJob, Carry};

/// What is to be drawn.
pub(crate) enum Input<'a, 'b> {
    /// Integers.
    Forms(&'a [PlaneForms]),
    /// Occluders as they are, in floats.
    Floats(&'a BufferJob<'b>),
}

/// Records all planes of a job and submits them; the values stay on the device.
pub(crate) fn draw(gpu: &Gpu, path: GpuPath, input: &Input<'_, '_>) -> Result<Values, BackendError> {
    let name = path.name();
    let sizes = match input {
        Input::Forms(planes) => Sizes::new(planes.iter().map(|p| p.texels)),
        Input::Floats(job) => Sizes::new(job.planes().iter().map(|p| p.texels())),
    };
    gpu.check_alive(name)?;
    gpu.check_size(name, sizes.values, false)?;
    for part in &sizes.parts {
        gpu.check_size(name, part.bytes(), true)?;
    }
    gpu.check_size(name, sizes.scratch, true)?;
    let largest = sizes.values.max(sizes.scratch);
    match input {
        Input::Forms(planes) => {
            let packed = Packed::new(planes);
            for bytes in [&packed.forms, &packed.edges, &packed.slopes] {
                gpu.check_size(name, bytes.len() as u64, true)?;
            }
            let corners = if path == GpuPath::Raster { corners(planes, &packed) } else { Vec::new() };
            for bytes in &corners {
                gpu.check_size(name, bytes.len() as u64, false)?;
            }
            gpu.guarded(name, largest, || {
                let carries: Vec<_> = planes.iter().map(|p| p.carry.as_ref()).collect();
                let uploaded = Uploaded::new(gpu, &packed);
                Recording::new(gpu, sizes).run(&carries, |recording, plane| match path {
                    GpuPath::Raster => recording.raster(&uploaded, &packed.planes[plane], &corners[plane], plane),
                    _ => recording.direct(&uploaded, plane),
                })
            })
        }
        Input::Floats(job) => {
            let scenes = float::Packed::new(job);
            for bytes in [&scenes.occluders, &scenes.points] {
                gpu.check_size(name, bytes.len() as u64, true)?;
            }
            gpu.guarded(name, largest, || {
                let carries: Vec<_> =
                    (0..job.planes().len()).map(|i| (job.carry() && i > 0).then(|| Carry::of(job, i))).collect();
                let carries: Vec<_> = carries.iter().map(Option::as_ref).collect();
                Recording::new(gpu, sizes)
                    .run(&carries, |recording, plane| float::record(gpu, recording, &scenes, plane))
            })
        }
    }
}

/// Triangles of each plane.
fn corners(planes: &[PlaneForms], packed: &Packed) -> Vec<Vec<u8>> {
    let of = |(plane, i): (&PlaneForms, usize)| {
        let mut bytes = Vec::new();
        for (&form, place) in packed.orders[i].iter().zip(packed.planes[i].first_form..) {
            let form = &plane.forms.forms[form as usize];
            outline::put_triangles(&plane.forms, form, place, plane.texels, &mut bytes);
        }
        bytes
    };
    planes.iter().zip(0..).map(of).collect()
}
