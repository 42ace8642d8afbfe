// Which occludees are hidden: each has a footprint on a plane, and is hidden if all texels of it are known to be
// blocked in front of it. Flags and numbers of instances of those that are hidden become 0; the others are left as they
// are, so that several planes may follow each other.

struct Footprints {
    width: u32,
    n_footprints: u32,
    // Words in a record of the draw buffer; 0 without one. The second word is the number of instances.
    draw_words: u32,
    // Workgroups in a row of the dispatch.
    groups: u32,
}

struct Footprint {
    // x0, y0, x1, y1: half-open, in texels.
    bounds: vec4<i32>,
    first_edge: u32,
    n_edges: u32,
    // The texels' values have to be more than this.
    limit: u32,
    // Whether all of the footprint is within the plane's window.
    inside: u32,
}

const LANES: u32 = 64u;

@group(0) @binding(0) var<uniform> footprints: Footprints;
@group(0) @binding(1) var<storage, read> records: array<Footprint>;
@group(0) @binding(2) var<storage, read> outer_edges: array<vec4<i32>>;
@group(0) @binding(3) var<storage, read> values: array<u32>;
@group(0) @binding(4) var<storage, read_write> flags: array<u32>;
@group(0) @binding(5) var<storage, read_write> draws: array<u32>;

// Whether any texel of the footprint is not known to be blocked in front of the occludee.
var<workgroup> open: atomic<u32>;

fn touches(record: Footprint, at: vec2<i32>) -> bool {
    for (var i = 0u; i < record.n_edges; i++) {
        let edge = outer_edges[record.first_edge + i];
        if edge.x * at.x + edge.y * at.y + edge.z < 0 {
            return false;
        }
    }
    return true;
}

@compute @workgroup_size(64)
fn hide(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let object = group.y * footprints.groups + group.x;
    if object >= footprints.n_footprints {
        return;
    }
    if lane == 0u {
        atomicStore(&open, 0u);
    }
    workgroupBarrier();
    let record = records[object];
    let width = u32(max(record.bounds.z - record.bounds.x, 0));
    let n = width * u32(max(record.bounds.w - record.bounds.y, 0));
    if record.inside != 0u {
        for (var i = lane; i < n && atomicLoad(&open) == 0u; i += LANES) {
            let at = record.bounds.xy + vec2<i32>(i32(i % width), i32(i / width));
            let value = values[u32(at.y) * footprints.width + u32(at.x)];
            if value <= record.limit && touches(record, at) {
                atomicStore(&open, 1u);
            }
        }
    }
    workgroupBarrier();
    if lane == 0u && record.inside != 0u && atomicLoad(&open) == 0u {
        flags[object] = 0u;
        if footprints.draw_words != 0u {
            draws[object * footprints.draw_words + 1u] = 0u;
        }
    }
}
