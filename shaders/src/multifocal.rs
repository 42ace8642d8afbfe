//! The shaders that fill multifocal buffers, and those that use them.

use crate::record::record;
use crate::{Access, Record, Shader};

record! {
    /// One plane of a job.
    Plane as "Plane" {
        /// Texels along the first axis.
        width: u32,
        /// Texels along the second axis.
        height: u32,
        /// The plane's first form.
        first_form: u32,
        /// How many forms it has.
        n_forms: u32,
        /// Words in a row of the copy of its depth buffer.
        pitch: u32,
        /// Nothing.
        unused_a: u32,
        /// Nothing.
        unused_b: u32,
        /// Nothing.
        unused_c: u32,
    }
}

record! {
    /// Where an occluder blocks, in integers.
    Form as "Form" {
        /// `x0, y0, x1, y1`, half-open, in texels.
        bounds: [i32; 4],
        /// The first of its edges.
        first_edge: u32,
        /// How many edges.
        n_edges: u32,
        /// The first of its slopes.
        first_slope: u32,
        /// How many slopes.
        n_slopes: u32,
        /// The least value.
        least: u32,
        /// One that its values never exceed within its bounds.
        most: u32,
        /// Nothing.
        unused_a: u32,
        /// Nothing.
        unused_b: u32,
    }
}

record! {
    /// One of the two passes that carry a plane over to the next.
    Carry as "Carry" {
        /// Length of the rows that are read, at most [`MAX_ROW`].
        width: u32,
        /// How many rows.
        height: u32,
        /// How many ranges of each row are asked for.
        n_ranges: u32,
        /// The first of them.
        first_range: u32,
        /// Added to what is known.
        rise: u32,
        /// 1 for the second pass, else 0.
        last: u32,
        /// Nothing.
        unused_a: u32,
        /// Nothing.
        unused_b: u32,
    }
}

record! {
    /// What all footprints of a dispatch share.
    Footprints as "Footprints" {
        /// Texels in a row of the plane.
        width: u32,
        /// How many footprints.
        n_footprints: u32,
        /// Words in a record of the draw buffer; 0 without one.
        draw_words: u32,
        /// Workgroups in a row of the dispatch.
        groups: u32,
    }
}

record! {
    /// Which texels an occludee can be seen against.
    Footprint as "Footprint" {
        /// `x0, y0, x1, y1`, half-open, in texels.
        bounds: [i32; 4],
        /// The first of its edges.
        first_edge: u32,
        /// How many edges.
        n_edges: u32,
        /// What the values of all touched texels have to exceed.
        limit: u32,
        /// 1 if all of it is within the window, else 0.
        inside: u32,
    }
}

record! {
    /// The volume and the plane for the shader in floats.
    FloatScene as "Scene" {
        /// Texels along the first axis.
        width: u32,
        /// Texels along the second axis.
        height: u32,
        /// How many occluders.
        n_occluders: u32,
        /// The axis that the plane is perpendicular to.
        axis: u32,
        /// Half the size of the volume.
        half_size: [f32; 3],
        /// Of the plane, along its axis.
        at: f32,
        /// 1 if viewers look along the axis, else -1.
        direction: f32,
        /// Units of the values in one of the scene.
        per_unit: f32,
        /// Nothing.
        unused_a: f32,
        /// Nothing.
        unused_b: f32,
    }
}

record! {
    /// An occluder for the shader in floats.
    FloatOccluder as "Occluder" {
        /// The first corner of its outline.
        first_corner: u32,
        /// How many corners.
        n_corners: u32,
        /// The first point of its facets.
        first_facet: u32,
        /// How many facets, of three points each.
        n_facets: u32,
        /// 1 if the volume is in front of its facets, -1 if behind.
        sign: f32,
        /// Nothing.
        unused_a: f32,
        /// Nothing.
        unused_b: f32,
        /// Nothing.
        unused_c: f32,
    }
}

/// Texels along a side of the tile that a workgroup of [`DIRECT`] has.
pub const TILE: u32 = 32;
/// Forms that it sifts in one round.
pub const ROUND: u32 = 1024;
/// Longest row that [`CARRY`] can read: the blocks of one have room in a workgroup.
pub const MAX_ROW: u32 = 16 * 512;
/// Ranges that a workgroup of [`CARRY`] has.
pub const CARRY_LANES: u32 = 256;
/// Texels that a workgroup of [`DECODE`] has.
pub const DECODE_LANES: u32 = 64;
/// Texels along a side of the tile that a workgroup of [`FLOAT`] has.
pub const FLOAT_TILE: u32 = 16;
/// What a value is more as the bits of a depth.
pub const DEPTH_OFFSET: u32 = 0x0080_0000;
/// Values that depths can hold are less than this: a depth is less than 1.
pub const DEPTH_LIMIT: u32 = 0x3f80_0000 - DEPTH_OFFSET;

const FORM_BINDINGS: [Access; 4] = [Access::Uniform, Access::Read, Access::Read, Access::Read];

/// Forms to values: the canonical way. Dispatch a workgroup for each tile.
pub const DIRECT: Shader = Shader {
    name: "multifocal direct",
    text: concat!(
        include_str!("../wgsl/records.wgsl"),
        include_str!("../wgsl/forms.wgsl"),
        include_str!("../wgsl/direct.wgsl")
    ),
    entry_points: &[("direct", [TILE, 2, 1])],
    bindings: &[Access::Uniform, Access::Read, Access::Read, Access::Read, Access::Write],
    layouts: &[Plane::LAYOUT, Form::LAYOUT],
    constants: &[("TILE", TILE as i64), ("ROUND", ROUND as i64)],
};

/// Values of a plane to those of the next. Dispatch, for each of the two passes, `n_ranges / CARRY_LANES` workgroups
/// by `height`.
pub const CARRY: Shader = Shader {
    name: "multifocal carry",
    text: include_str!("../wgsl/carry.wgsl"),
    entry_points: &[("carry_rows", [CARRY_LANES, 1, 1])],
    bindings: &[Access::Uniform, Access::Read, Access::Read, Access::Write],
    layouts: &[Carry::LAYOUT],
    constants: &[("LANES", CARRY_LANES as i64), ("BLOCK", 16), ("MAX_BLOCKS", MAX_ROW as i64 / 16)],
};

/// Forms to depths, by the depth test.
pub const RASTER: Shader = Shader {
    name: "multifocal raster",
    text: concat!(
        include_str!("../wgsl/records.wgsl"),
        include_str!("../wgsl/forms.wgsl"),
        include_str!("../wgsl/raster.wgsl")
    ),
    entry_points: &[("corner", [0; 3]), ("value", [0; 3])],
    bindings: &FORM_BINDINGS,
    layouts: &[Plane::LAYOUT, Form::LAYOUT],
    constants: &[("OFFSET", DEPTH_OFFSET as i64)],
};

/// Depths to values. Dispatch `width / DECODE_LANES` workgroups by `height`.
pub const DECODE: Shader = Shader {
    name: "multifocal decode",
    text: concat!(include_str!("../wgsl/records.wgsl"), include_str!("../wgsl/decode.wgsl")),
    entry_points: &[("decode", [DECODE_LANES, 1, 1])],
    bindings: &[Access::Uniform, Access::Read, Access::Write],
    layouts: &[Plane::LAYOUT],
    constants: &[("OFFSET", DEPTH_OFFSET as i64)],
};

/// Values and footprints to flags. Dispatch a workgroup for each footprint.
pub const FLAGS: Shader = Shader {
    name: "multifocal flags",
    text: include_str!("../wgsl/flags.wgsl"),
    entry_points: &[("hide", [64, 1, 1])],
    bindings: &[Access::Uniform, Access::Read, Access::Read, Access::Read, Access::Write, Access::Write],
    layouts: &[Footprints::LAYOUT, Footprint::LAYOUT],
    constants: &[("LANES", 64)],
};

/// Occluders to values, in floats. Dispatch a workgroup for each tile.
pub const FLOAT: Shader = Shader {
    name: "multifocal float",
    text: include_str!("../wgsl/float.wgsl"),
    entry_points: &[("float_direct", [FLOAT_TILE, FLOAT_TILE, 1])],
    bindings: &[Access::Uniform, Access::Read, Access::Read, Access::Read, Access::Write],
    layouts: &[FloatScene::LAYOUT, FloatOccluder::LAYOUT],
    constants: &[("TILE", FLOAT_TILE as i64)],
};

/// All of them.
pub const ALL: [Shader; 6] = [DIRECT, CARRY, RASTER, DECODE, FLAGS, FLOAT];
