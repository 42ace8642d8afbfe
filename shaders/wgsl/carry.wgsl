// What is known on one plane, carried over to the next: for each texel the least value in a rectangle of texels of the
// plane before, and more by a constant.
//
// The least in a rectangle is the least of the leasts of its rows. So this runs twice, each time along rows, and
// writes what it finds turned over: rows become columns, and columns rows again.

struct Carry {
    // Length and number of the rows that are read.
    width: u32,
    height: u32,
    // How many ranges of a row are asked for, and where they begin.
    n_ranges: u32,
    first_range: u32,
    // Added to what is known; and whether this is the second time, which keeps the larger of two values.
    rise: u32,
    last: u32,
    unused_a: u32,
    unused_b: u32,
}

const LANES: u32 = 256u;
const BLOCK: u32 = 16u;
const MAX_BLOCKS: u32 = 512u;

@group(0) @binding(0) var<uniform> carry: Carry;
@group(0) @binding(1) var<storage, read> source: array<u32>;
// First and last texel, both inclusive; the first beyond the last if nothing is known.
@group(0) @binding(2) var<storage, read> ranges: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read_write> found: array<u32>;

// The least value in each block of the row.
var<workgroup> blocks: array<u32, MAX_BLOCKS>;

fn least_in(row: u32, first: u32, last: u32) -> u32 {
    if first > last || last >= carry.width {
        return 0u;
    }
    var least = 0xffffffffu;
    var x = first;
    while x <= last && least > 0u {
        if x % BLOCK == 0u && x + BLOCK - 1u <= last {
            least = min(least, blocks[x / BLOCK]);
            x += BLOCK;
        } else {
            least = min(least, source[row + x]);
            x++;
        }
    }
    return least;
}

@compute @workgroup_size(256)
fn carry_rows(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let row = group.y * carry.width;
    // A block that is not whole is never asked for.
    for (var i = lane; i < carry.width / BLOCK; i += LANES) {
        var least = 0xffffffffu;
        for (var x = 0u; x < BLOCK; x++) {
            least = min(least, source[row + i * BLOCK + x]);
        }
        blocks[i] = least;
    }
    workgroupBarrier();
    let i = group.x * LANES + lane;
    if i >= carry.n_ranges {
        return;
    }
    let range = ranges[carry.first_range + i];
    let least = least_in(row, range.x, range.y);
    let place = i * carry.height + group.y;
    if carry.last == 0u {
        found[place] = least;
    } else if least > 0u {
        found[place] = max(found[place], least + carry.rise);
    }
}
