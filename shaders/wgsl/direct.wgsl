// The buffer of one plane, from its forms: the largest value of any form at each texel, 0 without one.
//
// A workgroup has a tile of TILE x TILE texels, each invocation ROWS texels of one column. In rounds, each
// invocation sifts some forms for the whole tile; what is left is then drawn by all. Maxima commute, so it does not
// matter in which order forms are found.

const TILE: i32 = 32;
const ROWS: i32 = 4;
const STEP: i32 = TILE / ROWS;
const LANES: u32 = u32(TILE * STEP);
// Forms sifted in one round; what is left of a round has room in any case.
const ROUND: u32 = 1024u;
// Bit of an edge mask: this edge, and for the last all that follow.
const LAST_EDGE: u32 = 30u;
// Bit of an edge mask: the form does not reach over all of the tile.
const PARTLY: u32 = 0x80000000u;

@group(0) @binding(4) var<storage, read_write> values: array<u32>;

// What is left of a round: the form, which of its edges pass through the tile, and the largest value it can have there.
var<workgroup> left_form: array<u32, ROUND>;
var<workgroup> left_mask: array<u32, ROUND>;
var<workgroup> left_most: array<u32, ROUND>;
var<workgroup> n_left: atomic<u32>;
// What all texels of the tile have at least.
var<workgroup> everywhere: atomic<u32>;

// The least and the largest of a linear function's terms over a rectangle, from low to high, both inclusive.
fn extremes(line: vec4<i32>, low: vec2<i32>, high: vec2<i32>) -> vec2<i32> {
    let at_low = line.xy * low;
    let at_high = line.xy * high;
    let least = min(at_low, at_high);
    let most = max(at_low, at_high);
    return vec2<i32>(least.x + least.y + line.z, most.x + most.y + line.z);
}

// Finds out what a form has to do with the tile from low to high, both inclusive.
fn sift(form_idx: u32, low: vec2<i32>, high: vec2<i32>, known: u32) {
    let bounds = forms[form_idx].bounds;
    let inner_low = max(low, bounds.xy);
    let inner_high = min(high, bounds.zw - vec2<i32>(1));
    if any(inner_low > inner_high) || forms[form_idx].most <= known {
        return;
    }
    var mask = select(PARTLY, 0u, all(inner_low == low) && all(inner_high == high));
    let first_edge = forms[form_idx].first_edge;
    let n_edges = forms[form_idx].n_edges;
    for (var i = 0u; i < n_edges; i++) {
        let f = extremes(edges[first_edge + i], inner_low, inner_high);
        if f.y < 0 {
            return;
        }
        if f.x < 0 {
            mask |= 1u << min(i, LAST_EDGE);
        }
    }
    var least = forms[form_idx].least;
    var most = least;
    let first_slope = forms[form_idx].first_slope;
    let n_slopes = forms[form_idx].n_slopes;
    for (var i = 0u; i < n_slopes; i++) {
        let f = extremes(slopes[first_slope + i], inner_low - bounds.xy, inner_high - bounds.xy);
        least = max(least, u32(max(f.x, 0)));
        most = max(most, u32(max(f.y, 0)));
    }
    if mask == 0u {
        atomicMax(&everywhere, least);
        if least == most {
            return;
        }
    }
    if most <= known {
        return;
    }
    let place = atomicAdd(&n_left, 1u);
    left_form[place] = form_idx;
    left_mask[place] = mask;
    left_most[place] = most;
}

// The values of a form that is left, at x and four y, or 0.
fn draw(form_idx: u32, mask: u32, x: i32, y: vec4<i32>) -> vec4<u32> {
    var inside = vec4<bool>(true);
    let bounds = forms[form_idx].bounds;
    if (mask & PARTLY) != 0u {
        let within = x >= bounds.x && x < bounds.z;
        inside = vec4<bool>(within) & (y >= bounds.yyyy) & (y < bounds.wwww);
    }
    let first_edge = forms[form_idx].first_edge;
    var rest = mask & ~PARTLY;
    while rest != 0u {
        let i = firstTrailingBit(rest);
        rest &= rest - 1u;
        let end = select(i + 1u, forms[form_idx].n_edges, i == LAST_EDGE);
        for (var e = i; e < end; e++) {
            let edge = edges[first_edge + e];
            inside &= (edge.y * y + vec4<i32>(edge.x * x + edge.z)) >= vec4<i32>(0);
        }
    }
    var value = vec4<i32>(i32(forms[form_idx].least));
    let first_slope = forms[form_idx].first_slope;
    let n_slopes = forms[form_idx].n_slopes;
    for (var i = 0u; i < n_slopes; i++) {
        let slope = slopes[first_slope + i];
        value = max(value, slope.y * (y - bounds.yyyy) + vec4<i32>(slope.x * (x - bounds.x) + slope.z));
    }
    return select(vec4<u32>(0u), vec4<u32>(value), inside);
}

@compute @workgroup_size(32, 8)
fn direct(
    @builtin(workgroup_id) tile: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let low = vec2<i32>(tile.xy) * TILE;
    let high = min(low + vec2<i32>(TILE), vec2<i32>(i32(plane.width), i32(plane.height))) - vec2<i32>(1);
    let x = low.x + i32(local.x);
    let y = low.y + i32(local.y) + vec4<i32>(0, STEP, 2 * STEP, 3 * STEP);
    var best = vec4<u32>(0u);
    if lane == 0u {
        atomicStore(&everywhere, 0u);
    }
    for (var first = 0u; first < plane.n_forms; first += ROUND) {
        if lane == 0u {
            atomicStore(&n_left, 0u);
        }
        workgroupBarrier();
        // Whatever is read here is a lower bound, also while others raise it.
        let known = atomicLoad(&everywhere);
        let end = min(first + ROUND, plane.n_forms);
        for (var i = first + lane; i < end; i += LANES) {
            sift(plane.first_form + i, low, high, known);
        }
        workgroupBarrier();
        let n = atomicLoad(&n_left);
        best = max(best, vec4<u32>(atomicLoad(&everywhere)));
        for (var i = 0u; i < n; i++) {
            let least = min(min(best.x, best.y), min(best.z, best.w));
            if left_most[i] > least {
                best = max(best, draw(left_form[i], left_mask[i], x, y));
            }
        }
        workgroupBarrier();
    }
    for (var row = 0; row < ROWS; row++) {
        if x <= high.x && y[row] <= high.y {
            values[u32(y[row]) * plane.width + u32(x)] = best[row];
        }
    }
}
