// Records of planes and forms.

struct Plane {
    width: u32,
    height: u32,
    first_form: u32,
    n_forms: u32,
    // Words in a row of the depth buffer's copy.
    pitch: u32,
    unused_a: u32,
    unused_b: u32,
    unused_c: u32,
}

struct Form {
    // x0, y0, x1, y1: half-open, in texels.
    bounds: vec4<i32>,
    first_edge: u32,
    n_edges: u32,
    first_slope: u32,
    n_slopes: u32,
    // The least value, and one that it never exceeds within its bounds.
    least: u32,
    most: u32,
    unused_a: u32,
    unused_b: u32,
}
