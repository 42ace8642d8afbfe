// The buffer of one plane by the hardware's depth test: each form is a polygon that reaches somewhat beyond it, each
// fragment asks the integers, and the test keeps the largest value.
//
// A depth is the float whose bits are the value and one more in the exponent: positive and normal, so floats are ordered
// like values, and no bit is lost; and less than 1.

const OFFSET: u32 = 0x00800000u;

struct Corner {
    @builtin(position) at: vec4<f32>,
    @location(0) @interpolate(flat) form_idx: u32,
}

@vertex
fn corner(@location(0) at: vec2<f32>, @location(1) form_idx: u32) -> Corner {
    return Corner(vec4<f32>(at, 0.5, 1.0), form_idx);
}

@fragment
fn value(corner: Corner) -> @builtin(frag_depth) f32 {
    let at = vec2<i32>(floor(corner.at.xy));
    let form = forms[corner.form_idx];
    if any(at < form.bounds.xy) || any(at >= form.bounds.zw) {
        discard;
    }
    for (var i = 0u; i < form.n_edges; i++) {
        let edge = edges[form.first_edge + i];
        if edge.x * at.x + edge.y * at.y + edge.z < 0 {
            discard;
        }
    }
    var value = i32(form.least);
    let inner = at - form.bounds.xy;
    for (var i = 0u; i < form.n_slopes; i++) {
        let slope = slopes[form.first_slope + i];
        value = max(value, slope.x * inner.x + slope.y * inner.y + slope.z);
    }
    return bitcast<f32>(u32(value) + OFFSET);
}
