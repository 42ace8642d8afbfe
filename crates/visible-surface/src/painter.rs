//! The painter's method: whole faces, the farthest first.

use crate::counters::Counters;
use crate::fragment::Fragment;
use crate::method::{RenderInput, RenderOutput, VisibleSurface};

/// Sorts faces by the depth of their mid-points, and paints them from the farthest to the nearest. Wrong where a
/// mid-point does not say which of two faces is in front, and where no order of whole faces is right: it splits nothing
/// and makes no other test.
///
/// Of two mid-points at one depth that of the higher id counts as the farther one. Depths are rounded. Cost: a sort.
///
/// Source: the depth sort without its tests; for what those mend see [`Newell`](crate::Newell).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Painter;

impl VisibleSurface for Painter {
    fn name(&self) -> &'static str {
        "painter"
    }

    fn see(&self, input: &RenderInput<'_>, counters: &mut Counters) -> RenderOutput {
        let mut order: Vec<(f64, u32)> = input
            .mask
            .iter()
            .map(|face| {
                // Three times the depth of the mid-point, times a number that all have in common.
                let depth = |p| input.camera.place(p).scaled[2];
                (input.faces.of(face).map(depth).iter().sum(), face)
            })
            .collect();
        order.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
        counters.polygons += order.len() as u64;
        counters.tested("mid-point", order.len() as u64);
        RenderOutput::BackToFront(order.into_iter().map(|(_, face)| Fragment::whole(face)).collect())
    }
}
