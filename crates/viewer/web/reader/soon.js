// How soon bodies could see each other: how far they have to move, straight, before there is sight. As `time_to_sight` of `sightlines-relevance`.

import { EPSILON } from "./geometry.js";
import { hasBit } from "./rows.js";

/** The distance between two boxes, rounded down; along each axis one of them may be off by `gap`. */
export function apart(d, p, q, gap = 0) {
  let sum = 0;
  for (let k = 0; k < d; k++) {
    const between = Math.max(p.min[k] - q.max[k] - gap, q.min[k] - p.max[k] - gap, 0);
    sum += between * between;
  }
  return Math.sqrt(sum) * (1 - 8 * EPSILON);
}

/**
 * The shortest way at which bodies at two points of the scene may come to see each other, if each moves that far times its share; no more than the
 * true one. O(n log n + n²/32) at worst for n cells.
 */
export function wayToSight(table, points, shares = [1, 1]) {
  const { dimension: d, cells, rows } = table;
  const boxes = points.map((p) => table.boxOf(d === 2 ? [p[0], p[1], 0] : p));
  const time = (far, share) => (far > 0 ? (far / share) * (1 - 2 ** -40) : 0);
  // Cells come in by the time at which one of the two may be there; the first that sees one of the other's ends it.
  // Maps of Quake state the boxes of their leafs in whole units.
  const gap = table.frame?.gap ?? (table.isQuake ? 1 : 0);
  const arrivals = boxes.flatMap((box, side) => cells.map((cell, i) => ({ at: time(apart(d, box, cell, gap), shares[side]), side, i })));
  arrivals.sort((a, b) => a.at - b.at);
  const visible = [0, 1].map(() => new Uint32Array(rows.nWords));
  for (const { at, side, i } of arrivals) {
    if (at === Infinity) break;
    if (hasBit(visible[1 - side], i)) return at;
    const row = rows.row(i);
    for (let k = 0; k < row.length; k++) visible[side][k] |= row[k];
  }
  return Infinity;
}
