//! Views as callers state them.

use crate::border::Plain;
use crate::status::{Failure, SL_ERROR_VIEW};
use sightlines_eye_to_cell::View;

/// All directions. Only `eye` counts.
pub const SL_VIEW_ALL_ROUND: u32 = 0;
/// A picture whose height takes the angle `field_of_view`, below half a turn, and whose width is `aspect` times its height: the angle
/// of view of most engines. Tables of space only.
pub const SL_VIEW_PERSPECTIVE: u32 = 1;
/// A picture whose width takes the angle `field_of_view`, at most a full turn. Tables of space only.
pub const SL_VIEW_PERSPECTIVE_HORIZONTAL: u32 = 2;
/// The directions within half of `field_of_view`, at most a full turn, on both sides of `direction`; z does not count. Tables of the
/// plane only.
pub const SL_VIEW_PLANAR: u32 = 3;
/// What a view-projection matrix shows: `eye` and `matrix`. Tables of space only. Either hand, and any range of depth is right: 0 to 1,
/// -1 to 1, reversed, infinite; lenses may be shifted. Only the four sides count, so what is nearer than the near plane or beyond the
/// far one is in the picture.
pub const SL_VIEW_MATRIX: u32 = 4;
/// The same with the matrix transposed in memory.
pub const SL_VIEW_MATRIX_TRANSPOSED: u32 = 5;

/// An eye, and the directions that it looks at. What a kind does not use is ignored, and may be 0.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlView {
    /// `SL_VIEW_…`.
    pub kind: u32,
    /// Where the eye is, in scene units; z does not count in a table of the plane.
    pub eye: [f64; 3],
    /// The middle of the view; of any length but 0.
    pub direction: [f64; 3],
    /// What is up in the picture; need not be at a right angle to the direction.
    pub up: [f64; 3],
    /// An angle in radians.
    pub field_of_view: f64,
    /// The width of the picture, divided by its height.
    pub aspect: f64,
    /// From the scene to clip space: projection times view. For `SL_VIEW_MATRIX` column by column for column vectors, as OpenGL, glm
    /// and Vulkan keep it; row by row for row vectors, as DirectXMath keeps it, is the same in memory. For
    /// `SL_VIEW_MATRIX_TRANSPOSED` row by row for column vectors. It has to be that of a camera at `eye`, to within single precision.
    pub matrix: [f64; 16],
}

impl Plain for SlView {}

/// The view for a table of that dimension.
pub(crate) fn view_of(view: &SlView, dimension: u8) -> Result<View, Failure> {
    let needs = match view.kind {
        SL_VIEW_ALL_ROUND => dimension,
        SL_VIEW_PLANAR => 2,
        SL_VIEW_PERSPECTIVE | SL_VIEW_PERSPECTIVE_HORIZONTAL | SL_VIEW_MATRIX | SL_VIEW_MATRIX_TRANSPOSED => 3,
        kind => return Err(Failure::argument(format!("{kind} is no kind of a view"))),
    };
    if needs != dimension {
        let message = format!("the view is one of {needs} dimensions, and the table has {dimension}");
        return Err(Failure::new(SL_ERROR_VIEW, message));
    }
    let SlView { eye, direction, up, field_of_view, aspect, .. } = *view;
    let flat = |v: [f64; 3]| [v[0], v[1]];
    let made = match view.kind {
        SL_VIEW_PERSPECTIVE => View::perspective_vertical(eye, direction, up, field_of_view, aspect),
        SL_VIEW_PERSPECTIVE_HORIZONTAL => View::perspective_horizontal(eye, direction, up, field_of_view, aspect),
        SL_VIEW_PLANAR => View::planar(flat(eye), flat(direction), field_of_view),
        SL_VIEW_MATRIX | SL_VIEW_MATRIX_TRANSPOSED => {
            let given: [[f64; 4]; 4] = std::array::from_fn(|i| std::array::from_fn(|j| view.matrix[4 * i + j]));
            let turned = std::array::from_fn(|i| std::array::from_fn(|j| given[j][i]));
            View::from_view_projection(eye, if view.kind == SL_VIEW_MATRIX { given } else { turned })
        }
        _ if dimension == 2 => View::all_round([eye[0], eye[1], 0.0]),
        _ => View::all_round(eye),
    };
    made.map_err(|error| Failure::new(SL_ERROR_VIEW, error.to_string()))
}
