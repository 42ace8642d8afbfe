// The buffer of one plane, from its forms: the largest value of any form at each texel, 0 without one.
//
// A workgroup has a tile of TILE x TILE texels, each invocation ROWS texels of one column: so many that reading a form is
// worth it. In rounds, each invocation sifts some forms for the whole tile; what is left is then drawn by all. Maxima
// commute, so it does not matter in which order forms are found; but those with large values should come first, since
// then most of the others are passed over.

const TILE: i32 = 32;
const ROWS: i32 = 16;
const LANES: u32 = u32(TILE * TILE / ROWS);
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
// The least of what is drawn in a round.
var<workgroup> least_drawn: atomic<u32>;

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
    if forms[form_idx].most <= known {
        return;
    }
    let bounds = forms[form_idx].bounds;
    let inner_low = max(low, bounds.xy);
    let inner_high = min(high, bounds.zw - vec2<i32>(1));
    if any(inner_low > inner_high) {
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

// Four quadruples of rows.
struct Rows {
    a: vec4<i32>,
    b: vec4<i32>,
    c: vec4<i32>,
    d: vec4<i32>,
}

// The least and the largest of each row's two numbers.
fn least_rows(r: Rows, s: Rows) -> Rows {
    return Rows(min(r.a, s.a), min(r.b, s.b), min(r.c, s.c), min(r.d, s.d));
}

fn most_rows(r: Rows, s: Rows) -> Rows {
    return Rows(max(r.a, s.a), max(r.b, s.b), max(r.c, s.c), max(r.d, s.d));
}

fn same_rows(value: i32) -> Rows {
    return Rows(vec4<i32>(value), vec4<i32>(value), vec4<i32>(value), vec4<i32>(value));
}

// base + y * step for ROWS rows from y on.
fn affine_rows(base: i32, step: i32, y: i32) -> Rows {
    let first = vec4<i32>(base + step * y) + step * vec4<i32>(0, 1, 2, 3);
    let four = vec4<i32>(4 * step);
    return Rows(first, first + four, first + 2 * four, first + 3 * four);
}

// The values of a form that is left at x, for ROWS rows from y on, or 0.
fn draw(form_idx: u32, mask: u32, x: i32, y: i32) -> Rows {
    // What is negative outside.
    var inside = same_rows(0);
    let bounds = forms[form_idx].bounds;
    if (mask & PARTLY) != 0u {
        if x < bounds.x || x >= bounds.z || y >= bounds.w || y + ROWS <= bounds.y {
            return same_rows(0);
        }
        inside = least_rows(affine_rows(-bounds.y, 1, y), affine_rows(bounds.w - 1, -1, y));
    }
    let first_edge = forms[form_idx].first_edge;
    var rest = mask & ~PARTLY;
    while rest != 0u {
        let i = firstTrailingBit(rest);
        rest &= rest - 1u;
        var end = i + 1u;
        if i == LAST_EDGE {
            end = forms[form_idx].n_edges;
        }
        for (var e = i; e < end; e++) {
            let edge = edges[first_edge + e];
            inside = least_rows(inside, affine_rows(edge.x * x + edge.z, edge.y, y));
        }
    }
    var value = same_rows(i32(forms[form_idx].least));
    let first_slope = forms[form_idx].first_slope;
    let n_slopes = forms[form_idx].n_slopes;
    for (var i = 0u; i < n_slopes; i++) {
        let slope = slopes[first_slope + i];
        value = most_rows(value, affine_rows(slope.x * (x - bounds.x) + slope.z, slope.y, y - bounds.y));
    }
    let zero = vec4<i32>(0);
    return Rows(
        select(zero, value.a, inside.a >= zero),
        select(zero, value.b, inside.b >= zero),
        select(zero, value.c, inside.c >= zero),
        select(zero, value.d, inside.d >= zero),
    );
}

fn least_of(rows: Rows) -> u32 {
    let all = min(min(rows.a, rows.b), min(rows.c, rows.d));
    return u32(min(min(all.x, all.y), min(all.z, all.w)));
}

fn write_rows(rows: vec4<i32>, x: i32, y: i32) {
    for (var i = 0; i < 4; i++) {
        if y + i < i32(plane.height) {
            values[u32(y + i) * plane.width + u32(x)] = u32(rows[i]);
        }
    }
}

@compute @workgroup_size(32, 2)
fn direct(
    @builtin(workgroup_id) tile: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let low = vec2<i32>(tile.xy) * TILE;
    let high = min(low + vec2<i32>(TILE), vec2<i32>(i32(plane.width), i32(plane.height))) - vec2<i32>(1);
    let x = low.x + i32(local.x);
    let y = low.y + i32(local.y) * ROWS;
    var best = same_rows(0);
    if lane == 0u {
        atomicStore(&everywhere, 0u);
        atomicStore(&least_drawn, 0u);
    }
    for (var first = 0u; first < plane.n_forms; first += ROUND) {
        if first > 0u {
            // All are done with the round before, and say what it left them with.
            atomicMin(&least_drawn, least_of(best));
            workgroupBarrier();
        }
        if lane == 0u {
            atomicStore(&n_left, 0u);
            atomicMax(&everywhere, atomicLoad(&least_drawn));
            atomicStore(&least_drawn, 0xffffffffu);
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
        best = most_rows(best, same_rows(i32(atomicLoad(&everywhere))));
        for (var i = 0u; i < n; i++) {
            if left_most[i] > least_of(best) {
                best = most_rows(best, draw(left_form[i], left_mask[i], x, y));
            }
        }
    }
    if x < i32(plane.width) {
        write_rows(best.a, x, y);
        write_rows(best.b, x, y + 4);
        write_rows(best.c, x, y + 8);
        write_rows(best.d, x, y + 12);
    }
}
