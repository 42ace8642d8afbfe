//! Floor plans as DXF: lines and curves of a drawing are walls.
//!
//! The reader takes the text form of DXF, of any version from R12 on. It reads the model, not the sheets, as seen from above: x and y
//! of the world's coordinates as they are, heights ignored.
//!
//! | entity | becomes |
//! | --- | --- |
//! | LINE, LWPOLYLINE, POLYLINE | lines; bulges are arcs; of a POLYLINE that was smoothed the points of the smooth curve count |
//! | ARC, CIRCLE, ELLIPSE, SPLINE with control points | straight pieces |
//! | INSERT | the entities of its block: nested, scaled, mirrored, turned, in rows and columns, and of a clipped one (XCLIP) what is inside of the clip |
//! | MLINE | the lines of its elements, without caps |
//! | SOLID, TRACE | their outline |
//! | HATCH that is filled, on a layer that is named in [`PlanReadOptions::layers`] | its borders, if these are polylines, lines and arcs; on others it is ignored, as it may be a floor or a shade |
//! | anything else (TEXT, other HATCHes, DIMENSION, POINT, meshes …) | ignored, and counted in a warning; so are inserts of other files (external references) |
//!
//! **Curves.** All vertices lie on the curve up to rounding, and no point of the curve is further from its pieces than the deviation
//! ([`PlanReadOptions::deviation`], by default [`DEFAULT_DEVIATION`] of the longer side of the plan). Pieces are chords, so they err
//! towards the hollow side: around a round column a little more is seen than is true, in a round room a little less. Ends of lines and
//! vertices of polylines in the model are taken bit by bit; ends of arcs, and all that a block places, are computed and rounded.
//! So two walls that meet only there may leave a gap in the last digit, through which sight passes.
//!
//! **Extrusion.** Entities in coordinates of their own (arcs, circles, polylines, inserts) are placed by their extrusion direction
//! as DXF defines it; (0, 0, -1) mirrors x.
//!
//! **Layers.** What is on a layer that is frozen or off is left out, as it is not drawn, unless the layer is named in
//! [`PlanReadOptions::layers`]. In a block the layer `0` is that of the insert. Names are compared without case. What is marked as
//! invisible, and what is in paper space, is left out.
//!
//! **Clips.** What is clipped away is not drawn and no wall; ends at the border of a clip are rounded. Inserts with a clip in a plane of
//! its own, or in rows and columns, are left out, and counted in a warning with their blocks.
//!
//! Binary DXF is refused. A file without its end mark is refused, since walls could be missing. Texts that are not UTF-8 are read as
//! Latin-1. Lines without length and lines that repeat others are dropped and counted ([`PlanFile`]).

mod affine;
mod clip;
mod curve;
mod drawing;
mod entity;
mod expand;
mod filters;
mod flatten;
mod groups;
mod layers;
mod spline;
mod text;

pub(crate) use groups::is_dxf;

use crate::error::{Malformed, malformed};
use crate::{PlanFile, PlanReadOptions};

/// The deviation of curves that is taken where none is given, as a share of the longer side of the box around the plan: 5 mm for 50 m.
pub const DEFAULT_DEVIATION: f64 = 1e-4;

/// The most entities, counted as often as blocks are inserted, corners of curves and lines together that a drawing may have: blocks
/// in blocks could ask for any number.
pub const MAX_ELEMENTS: usize = 1 << 21;

/// How deep blocks may be nested.
pub const MAX_NESTING: usize = 64;

/// Reads a plan from a DXF text; see the module for what means what.
///
/// Lines come in the order of the entities, those of a block where it is inserted. O(length of the text + elements), up to
/// [`MAX_ELEMENTS`].
///
/// # Errors
/// [`Malformed`] with the line of the text.
pub fn parse_dxf(text: &[u8], options: &PlanReadOptions) -> Result<PlanFile, Malformed> {
    let deviation = options.deviation;
    if let Some(other) = deviation.filter(|&deviation| !(deviation.is_finite() && deviation > 0.0)) {
        return Err(malformed!("{other} is no deviation of curves, which is a number above 0"));
    }
    let drawing = drawing::read(text)?;
    let chosen = drawing.layers.choose(options.layers.as_deref())?;
    let expanded = expand::expand(&drawing, &chosen)?;
    let left_out = expanded.warnings(&drawing);
    let mut file = flatten::flatten(&expanded, deviation)?;
    file.layers = drawing.layers.into_names();
    file.warnings.extend(left_out);
    Ok(file)
}

fn too_many() -> Malformed {
    malformed!("the drawing, with its blocks inserted, has more than {MAX_ELEMENTS} elements")
}
