//! What is hidden, worked out where the values are.

use crate::Values;
use crate::context::Gpu;
use crate::pack::put_lines;
use crate::recording::{part, whole};
use sightlines_multifocal::{BackendError, Footprint};
use sightlines_shaders::Record;
use sightlines_shaders::multifocal as records;
use wgpu::{Buffer, BufferUsages, CommandEncoder};

/// Whom errors name.
const NAME: &str = "gpu flags";

/// A buffer with one record for each object, from its beginning, for indirect draws.
#[derive(Debug, Clone, Copy)]
pub enum DrawRecords<'a> {
    /// `DrawIndirectArgs`: four words.
    Plain(&'a Buffer),
    /// `DrawIndexedIndirectArgs`: five words.
    Indexed(&'a Buffer),
}

impl Gpu {
    /// Records into `encoder` which objects are hidden behind the values of a plane: the flags of those that are, one
    /// word for each, become 0, and so do the numbers of instances of their draws. The others are left as they are: the
    /// host writes ones, and the numbers of instances, before the first plane, and several planes may follow.
    ///
    /// * `footprints`: one for each object, on this plane, for values that are heights; bounds within the window if it
    ///   is `inside`
    /// * `flags`: usable as storage, a word for each object
    /// * `draws`: usable as storage
    ///
    /// Does not wait, and submits nothing: the host does, with the rest of its frame. O(touched texels · edges) on the
    /// device.
    ///
    /// # Errors
    /// [`BackendError`]
    ///
    /// # Panics
    /// If there is no such plane.
    pub fn hide(
        &self,
        encoder: &mut CommandEncoder,
        values: &Values,
        plane: usize,
        footprints: &[Footprint],
        flags: &Buffer,
        draws: Option<DrawRecords<'_>>,
    ) -> Result<(), BackendError> {
        if footprints.is_empty() {
            return self.check_alive(NAME);
        }
        let [width, height] = values.texels(plane);
        let (mut bytes, mut edges) = (Vec::new(), Vec::new());
        let mut first_edge = 0;
        for footprint in footprints {
            let n_edges = footprint.edges.len() as u32;
            let inside = footprint.inside && is_within(footprint.bounds, [width, height]);
            let record = records::Footprint {
                bounds: footprint.bounds,
                first_edge,
                n_edges,
                limit: footprint.limit,
                inside: inside.into(),
            };
            record.put(&mut bytes);
            put_lines(&footprint.edges, &mut edges);
            first_edge += n_edges;
        }
        let largest = (bytes.len() as u64).max(edges.len() as u64);
        self.check_size(NAME, largest, true)?;
        let n_footprints = footprints.len() as u32;
        let most = self.device().limits().max_compute_workgroups_per_dimension;
        let groups = n_footprints.min(most);
        let draw_words = match draws {
            None => 0,
            Some(DrawRecords::Plain(_)) => 4,
            Some(DrawRecords::Indexed(_)) => 5,
        };
        let scene = records::Footprints { width, n_footprints, draw_words, groups };
        self.guarded(NAME, largest, || {
            let mut uniform = Vec::new();
            scene.put(&mut uniform);
            let uniform = self.upload("footprints", &uniform, 16, BufferUsages::UNIFORM);
            let bytes = self.upload("footprint list", &bytes, 32, BufferUsages::STORAGE);
            let edges = self.upload("outer edges", &edges, 16, BufferUsages::STORAGE);
            let none;
            let draws = match draws {
                Some(DrawRecords::Plain(draws) | DrawRecords::Indexed(draws)) => draws,
                None => {
                    none = self.buffer("no draws", 16, BufferUsages::STORAGE);
                    &none
                }
            };
            let shader = &self.pipelines().flags;
            let values = part(&values.buffer, values.offset(plane), values.parts[plane].bytes());
            let parts = [whole(&uniform), whole(&bytes), whole(&edges), values, whole(flags), whole(draws)];
            let bindings = self.bind(&shader.layout, &parts);
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&shader.pipeline);
            pass.set_bind_group(0, &bindings, &[]);
            pass.dispatch_workgroups(groups, n_footprints.div_ceil(groups), 1);
        })
    }
}

/// Whether bounds are not empty, and reach over no texel that is not there.
fn is_within([x0, y0, x1, y1]: [i32; 4], [width, height]: [u32; 2]) -> bool {
    0 <= x0 && x0 < x1 && x1 as u32 <= width && 0 <= y0 && y0 < y1 && y1 as u32 <= height
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_within_a_window() {
        assert!(is_within([0, 0, 8, 4], [8, 4]) && is_within([7, 3, 8, 4], [8, 4]));
        for outside in [[0, 0, 9, 4], [0, -1, 8, 4], [0, 0, 8, 5], [3, 3, 3, 4], [-1, 0, 1, 1], [5, 0, 4, 1]] {
            assert!(!is_within(outside, [8, 4]), "{outside:?}");
        }
    }
}
