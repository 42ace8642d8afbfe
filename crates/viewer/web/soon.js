// How soon bodies in other cells could see one in the eye's: how far both have to move, straight, before there is sight. As `Reaches` of
// `sightlines-relevance`, for any distance in place of a ladder.

/** The distance between the boxes of two cells, rounded down. */
function apart(table, a, b) {
  const [p, q] = [table.cells[a], table.cells[b]];
  let sum = 0;
  for (let k = 0; k < table.dimension; k++) {
    const gap = Math.max(p.min[k] - q.max[k], q.min[k] - p.max[k], 0);
    sum += gap * gap;
  }
  return Math.sqrt(sum) * (1 - 8 * EPSILON);
}

/**
 * For each cell the shortest way at which a body in it may come to see one in these cells, if both move that far; infinite if never. O(n²) at worst
 * for n cells.
 */
function waysToSight(table, from) {
  const n = table.cells.length;
  // How far the one at the eye has to go to see anything in each cell.
  const own = Array.from({ length: n }, (_, cell) => Math.min(...from.map((a) => apart(table, a, cell))));
  const toSee = new Float64Array(n).fill(Infinity);
  for (let a = 0; a < n; a++) {
    for (const b of table.visibleCells([a])) toSee[b] = Math.min(toSee[b], own[a]);
  }
  const order = [...toSee.keys()].sort((a, b) => toSee[a] - toSee[b]);
  return Float64Array.from({ length: n }, (_, cell) => {
    let best = toSee[cell];
    for (const b of order) {
      if (toSee[b] >= best) break;
      best = Math.min(best, Math.max(toSee[b], apart(table, b, cell)));
    }
    return best;
  });
}
