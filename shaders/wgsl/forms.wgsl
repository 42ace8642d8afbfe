
// What those who draw forms are given.
//
// Integers only, so every device computes the same bits. All sums stay within 32 bits, in any order, within the bounds
// of a form; see the crate that makes them.

@group(0) @binding(0) var<uniform> plane: Plane;
@group(0) @binding(1) var<storage, read> forms: array<Form>;
// A, B, C, and nothing.
@group(0) @binding(2) var<storage, read> edges: array<vec4<i32>>;
// P, Q, R, and nothing.
@group(0) @binding(3) var<storage, read> slopes: array<vec4<i32>>;

