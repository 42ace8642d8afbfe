// Vectors and boxes.

export const EPSILON = 2 ** -52;
export const SMALLEST_NORMAL = 2 ** -1022;

export function dot3(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

export function cross3(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

export function length3(v) {
  return Math.sqrt(dot3(v, v));
}

export function unit3(v) {
  const length = Math.hypot(...v) || 1;
  return v.map((x) => x / length);
}

/** A vector across a polygon in space, by Newell's sums. */
export function normalOf(points) {
  const normal = [0, 0, 0];
  points.forEach((p, i) => {
    const q = points[(i + 1) % points.length];
    for (let k = 0; k < 3; k++) {
      const [u, v] = [(k + 1) % 3, (k + 2) % 3];
      normal[k] += (p[u] - q[u]) * (p[v] + q[v]);
    }
  });
  return normal;
}

/** The box around all cells and objects, along the axes of the table. */
export function boundsOf(table) {
  const [min, max] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const list of [table.cells, table.objects]) {
    for (const box of list) {
      for (let k = 0; k < 3; k++) {
        min[k] = Math.min(min[k], box.min[k]);
        max[k] = Math.max(max[k], box.max[k]);
      }
    }
  }
  return min[0] <= max[0] ? { min, max } : { min: [0, 0, 0], max: [1, 1, 1] };
}
