// The same question in floats, to see what they cost: a texel is blocked by an occluder if all lines from the texel to
// the volume pass all edges of the outline on the inner side, and the texel lies behind all facets.
//
// The volume is a box around the origin, half its size given. For an edge (a, b) and a corner t of the texel, with
// n = (a - t) x (b - t), the whole box is on the inner side if dot(-t, n) >= sum of |n_i| h_i. Each side is the sum of
// terms with at most 12.5 roundings, which are worth 2^-23 each, whatever the order of the terms: numbers given are
// rounded to half of that, a difference costs one and a half with its terms, a product of two four, a component of n
// five, a term of the sum seven and a half, and adding six terms five more. So what is larger by MARGIN times
// the same expression over magnitudes is surely not less. For facets it is the same, with fewer terms.

struct Scene {
    width: u32,
    height: u32,
    n_occluders: u32,
    axis: u32,
    // Half the size of the volume, rounded up.
    half_size: vec3<f32>,
    // Of the plane along the axis, in the volume's frame.
    at: f32,
    // 1 if viewers look along the axis, else -1.
    direction: f32,
    // Units of the values in a unit of the scene, a power of two.
    per_unit: f32,
    unused_a: f32,
    unused_b: f32,
}

struct Occluder {
    first_corner: u32,
    n_corners: u32,
    first_facet: u32,
    n_facets: u32,
    // 1 if the box is in front of the facets, -1 if behind.
    sign: f32,
    unused_a: f32,
    unused_b: f32,
    unused_c: f32,
}

// 16 * 2^-23.
const MARGIN: f32 = 0x1p-19;
// For what is flushed to zero on the way, if the scene's size is near 1.
const TINY: f32 = 0x1p-60;
const TILE: u32 = 16u;
const LANES: u32 = 256u;

@group(0) @binding(0) var<uniform> scene: Scene;
@group(0) @binding(1) var<storage, read> occluders: array<Occluder>;
// Corners of outlines, one after the other, and three for each facet.
@group(0) @binding(2) var<storage, read> points: array<vec4<f32>>;
// Lines between texels: those across the first axis, then those across the second.
@group(0) @binding(3) var<storage, read> lines: array<f32>;
@group(0) @binding(4) var<storage, read_write> values: array<u32>;

var<workgroup> left: array<u32, LANES>;
var<workgroup> n_left: atomic<u32>;

// A corner of the grid of texels.
fn grid(x: u32, y: u32) -> vec3<f32> {
    let at = vec3<f32>(scene.at, lines[x], lines[scene.width + 1u + y]);
    if scene.axis == 0u {
        return at;
    }
    return select(at.yzx, at.zxy, scene.axis == 1u);
}

fn magnitudes(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return a.yzx * b.zxy + a.zxy * b.yzx;
}

// Whether the box is surely on the inner side of an edge, seen from t.
fn inner(a: vec3<f32>, b: vec3<f32>, t: vec3<f32>, sign: f32) -> bool {
    let n = cross(a - t, b - t);
    let n_magnitude = magnitudes(abs(a) + abs(t), abs(b) + abs(t));
    let sum = sign * dot(-t, n) - dot(abs(n), scene.half_size);
    let magnitude = dot(abs(t), n_magnitude) + dot(n_magnitude, scene.half_size);
    return sum > MARGIN * magnitude + TINY;
}

// Whether t is surely behind a facet, or on it.
fn behind(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, t: vec3<f32>, sign: f32) -> bool {
    let sum = -sign * dot(t - a, cross(b - a, c - a));
    let magnitude = dot(abs(t) + abs(a), magnitudes(abs(b) + abs(a), abs(c) + abs(a)));
    return sum > MARGIN * magnitude + TINY;
}

fn point_at(i: u32) -> vec3<f32> {
    return points[i].xyz;
}

// Whether an occluder may block anything in the tile from low to high, both corners of the grid: none of its edges has the
// middle of the volume on the outer side from all four corners of the tile.
fn may_block(occluder: Occluder, low: vec2<u32>, high: vec2<u32>) -> bool {
    let t = array<vec3<f32>, 4>(grid(low.x, low.y), grid(high.x, low.y), grid(low.x, high.y), grid(high.x, high.y));
    for (var i = 0u; i < occluder.n_corners; i++) {
        let a = point_at(occluder.first_corner + i);
        let b = point_at(occluder.first_corner + select(i + 1u, 0u, i + 1u == occluder.n_corners));
        let n = cross(a, b) * -occluder.sign;
        if max(max(dot(t[0], n), dot(t[1], n)), max(dot(t[2], n), dot(t[3], n))) < 0.0 {
            return false;
        }
    }
    return true;
}

fn blocks(occluder: Occluder, t: vec3<f32>) -> bool {
    for (var i = 0u; i < occluder.n_corners; i++) {
        let a = point_at(occluder.first_corner + i);
        let b = point_at(occluder.first_corner + select(i + 1u, 0u, i + 1u == occluder.n_corners));
        if !inner(a, b, t, occluder.sign) {
            return false;
        }
    }
    for (var i = 0u; i < occluder.n_facets; i++) {
        let first = occluder.first_facet + 3u * i;
        if !behind(point_at(first), point_at(first + 1u), point_at(first + 2u), t, occluder.sign) {
            return false;
        }
    }
    return true;
}

// The height of the lowest corner of the outline, rounded down, in the code of buffers.
fn value_of(occluder: Occluder) -> u32 {
    var least = 0x1p+100;
    for (var i = 0u; i < occluder.n_corners; i++) {
        let p = point_at(occluder.first_corner + i)[scene.axis];
        let height = scene.direction * (scene.at - p) - MARGIN * (abs(scene.at) + abs(p)) - TINY;
        least = min(least, height);
    }
    return u32(max(floor(least * scene.per_unit), 0.0)) + 1u;
}

@compute @workgroup_size(16, 16)
fn float_direct(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(global_invocation_id) at: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let size = vec2<u32>(scene.width, scene.height);
    let low = group.xy * TILE;
    let high = min(low + vec2<u32>(TILE), size);
    let texel = min(at.xy, size - vec2<u32>(1u));
    var best = 0u;
    for (var first = 0u; first < scene.n_occluders; first += LANES) {
        if lane == 0u {
            atomicStore(&n_left, 0u);
        }
        workgroupBarrier();
        let mine = first + lane;
        if mine < scene.n_occluders {
            if may_block(occluders[mine], low, high) {
                left[atomicAdd(&n_left, 1u)] = mine;
            }
        }
        workgroupBarrier();
        let n = atomicLoad(&n_left);
        for (var i = 0u; i < n; i++) {
            let occluder = occluders[left[i]];
            let value = value_of(occluder);
            if value > best {
                if blocks(occluder, grid(texel.x, texel.y)) && blocks(occluder, grid(texel.x + 1u, texel.y))
                    && blocks(occluder, grid(texel.x, texel.y + 1u)) && blocks(occluder, grid(texel.x + 1u, texel.y + 1u)) {
                    best = value;
                }
            }
        }
        workgroupBarrier();
    }
    if all(at.xy < size) {
        values[at.y * scene.width + at.x] = best;
    }
}
