//! A job as bytes for the device.

use sightlines_multifocal::{BufferJob, BufferPlane, Carry, Form, Forms, Outlines};
use sightlines_shaders::Record;
use sightlines_shaders::multifocal as records;

/// One plane of a job in integers.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PlaneForms {
    /// How many texels along each axis.
    pub texels: [u32; 2],
    /// What blocks.
    pub forms: Forms,
    /// How values of the plane before are carried over to this one.
    pub carry: Option<Carry>,
}

impl PlaneForms {
    /// All planes of a job. O(planes · occluders · corners), on the caller's thread.
    pub fn of(job: &BufferJob<'_>) -> Vec<Self> {
        let outlines = Outlines::of(job);
        let one = |(i, plane): (usize, &BufferPlane)| {
            let mut forms = Forms::default();
            forms.extend(job, &outlines, i);
            let carry = (job.carry() && i > 0).then(|| Carry::of(job, i));
            Self { texels: plane.texels(), forms, carry }
        };
        job.planes().iter().enumerate().map(one).collect()
    }
}

/// Bytes of the lists that all planes of a job share, and of each plane's own record.
#[derive(Debug, Default)]
pub(crate) struct Packed {
    pub(crate) forms: Vec<u8>,
    pub(crate) edges: Vec<u8>,
    pub(crate) slopes: Vec<u8>,
    pub(crate) planes: Vec<records::Plane>,
    /// The forms of each plane in the order that they were packed in: by their largest values, the largest first.
    pub(crate) orders: Vec<Vec<u32>>,
}

/// Bytes of a line's coefficients.
pub(crate) const LINE_BYTES: usize = 16;

/// Texels of a padded row of a depth buffer's copy.
pub(crate) fn pitch(width: u32) -> u32 {
    let texels = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT / 4;
    width.div_ceil(texels) * texels
}

impl Packed {
    pub(crate) fn new(planes: &[PlaneForms]) -> Self {
        let mut packed = Self::default();
        planes.iter().for_each(|plane| packed.add(plane));
        packed
    }

    fn add(&mut self, plane: &PlaneForms) {
        let form_bytes = records::Form::LAYOUT.size() as usize;
        let first_form = (self.forms.len() / form_bytes) as u32;
        let (first_edge, first_slope) = (self.edges.len() / LINE_BYTES, self.slopes.len() / LINE_BYTES);
        let forms = &plane.forms;
        self.forms.reserve(form_bytes * forms.forms.len());
        let most_of = |(form, i): (&Form, u32)| (most(form, forms.slopes_of(form)), i);
        let mut order: Vec<_> = forms.forms.iter().zip(0..).map(most_of).collect();
        order.sort_unstable_by(|a, b| b.cmp(a));
        for &(most, i) in &order {
            let form = &forms.forms[i as usize];
            let record = records::Form {
                bounds: form.bounds,
                first_edge: form.first_edge + first_edge as u32,
                n_edges: form.n_edges,
                first_slope: form.first_slope + first_slope as u32,
                n_slopes: form.n_slopes,
                least: form.floor,
                most,
                ..Default::default()
            };
            record.put(&mut self.forms);
        }
        self.orders.push(order.into_iter().map(|(_, i)| i).collect());
        put_lines(&forms.edges, &mut self.edges);
        put_lines(&forms.slopes, &mut self.slopes);
        let [width, height] = plane.texels;
        let n_forms = forms.forms.len() as u32;
        self.planes.push(records::Plane {
            width,
            height,
            first_form,
            n_forms,
            pitch: pitch(width),
            ..Default::default()
        });
    }
}

/// Appends coefficients of lines, each with a word of padding.
pub(crate) fn put_lines(lines: &[[i32; 3]], out: &mut Vec<u8>) {
    out.reserve(LINE_BYTES * lines.len());
    for word in lines.iter().flat_map(|&[a, b, c]| [a, b, c, 0]) {
        out.extend_from_slice(&word.to_le_bytes());
    }
}

/// The largest value that a form can have within its bounds.
fn most(form: &Form, slopes: &[[i32; 3]]) -> u32 {
    let [x0, y0, x1, y1] = form.bounds;
    let (right, top) = (x1 - x0 - 1, y1 - y0 - 1);
    let largest = |&[p, q, r]: &[i32; 3]| (r + (p * right).max(0) + (q * top).max(0)).max(0) as u32;
    slopes.iter().map(largest).fold(form.floor, u32::max)
}
