// How soon bodies in other cells could see one at the eye: how far both have to move, straight, before there is sight. As `may_see_within` of
// `sightlines-relevance`, for bodies in the middles of cells.

/**
 * For each cell the shortest way at which a body in its middle may come to see one at a point (along the axes of the table), if both move that far; infinite
 * if never. O(n²) at worst for n cells.
 */
function waysToSight(table, point) {
  const [n, d, eye] = [table.cells.length, table.dimension, { min: point, max: point }];
  // How far the one at the eye has to go to see anything in each cell.
  const own = table.cells.map((cell) => apart(d, eye, cell));
  const toSee = new Float64Array(n).fill(Infinity);
  for (let a = 0; a < n; a++) {
    for (const b of table.visibleCells([a])) toSee[b] = Math.min(toSee[b], own[a]);
  }
  const order = [...toSee.keys()].sort((a, b) => toSee[a] - toSee[b]);
  return Float64Array.from(table.cells, ({ min, max }) => {
    const point = min.map((x, k) => (x + max[k]) / 2);
    const middle = { min: point, max: point };
    let best = Infinity;
    for (const b of order) {
      if (toSee[b] >= best) break;
      best = Math.min(best, Math.max(toSee[b], apart(d, table.cells[b], middle)));
    }
    return best;
  });
}
