
// A copy of a depth buffer, its rows padded, back to values.

const OFFSET: u32 = 0x00800000u;

@group(0) @binding(0) var<uniform> plane: Plane;
@group(0) @binding(1) var<storage, read> depths: array<u32>;
@group(0) @binding(2) var<storage, read_write> values: array<u32>;

@compute @workgroup_size(64)
fn decode(@builtin(global_invocation_id) at: vec3<u32>) {
    if at.x < plane.width {
        let bits = depths[at.y * plane.pitch + at.x];
        values[at.y * plane.width + at.x] = select(0u, bits - OFFSET, bits >= OFFSET);
    }
}
