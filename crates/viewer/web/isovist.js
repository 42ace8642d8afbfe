// What is seen from one point of a plan, piece by piece: each piece is what two rays leave of a cell behind a portal. In doubles: to be looked
// at, not to decide by.

/** Pieces that are followed at most. */
const MOST_PIECES = 20000;

/** The isovist of a point: polygons that do not overlap, together all that is seen; and their area. Empty outside every cell. */
function isovistAt(table, point) {
  const eye = table.toTable(point);
  const from = (p) => [p[0] - eye[0], p[1] - eye[1]];
  const turn = (a, b) => a[0] * b[1] - a[1] * b[0];
  const roots = table.locate(point);
  const pieces = [];
  const stack = roots.map((cell) => ({ cell, entry: -1, right: null, left: null }));
  let area = 0;
  while (stack.length > 0 && pieces.length < MOST_PIECES) {
    const { cell, entry, right, left } = stack.pop();
    const outline = outlineOf(table.cells[cell]).map(from);
    const piece = right ? between(outline, right, left, turn) : outline;
    if (piece.length < 3) continue;
    pieces.push(piece.map(([x, y]) => [x + eye[0], y + eye[1]]));
    area += piece.reduce((sum, p, k) => sum + turn(p, piece[(k + 1) % piece.length]), 0) / 2;
    const middle = [0, 1].map((k) => outline.reduce((sum, p) => sum + p[k], 0) / outline.length);
    for (const portal of portalsByCell(table)[cell]) {
      const { cells, points } = table.portals[portal];
      const next = cells[0] === cell ? cells[1] : cells[0];
      if (portal === entry || roots.includes(next)) continue;
      let [p, q] = points.map(from);
      if (turn(p, q) < 0) [p, q] = [q, p];
      // The cell lies on the eye's side of a portal that is seen from inside.
      if (turn([q[0] - p[0], q[1] - p[1]], [middle[0] - p[0], middle[1] - p[1]]) <= 0) continue;
      const window = { right: right && turn(right, p) < 0 ? right : p, left: left && turn(left, q) > 0 ? left : q };
      if (turn(window.right, window.left) > 0) stack.push({ cell: next, entry: portal, ...window });
    }
  }
  return { pieces, area };
}

/** The corners of a cell of a plan, counter-clockwise. */
function outlineOf({ min, max, polygon }) {
  if (polygon.length > 0) return polygon;
  return [[min[0], min[1]], [max[0], min[1]], [max[0], max[1]], [min[0], max[1]]];
}

/** What of a polygon lies between two rays from the origin that are less than half a turn apart. */
function between(polygon, right, left, turn) {
  const sides = [(p) => turn(right, p), (p) => turn(p, left)];
  return sides.reduce((points, side) => {
    const at = points.map(side);
    return points.flatMap((p, i) => {
      const j = (i + 1) % points.length;
      const kept = at[i] >= 0 ? [p] : [];
      if (at[i] >= 0 === at[j] >= 0) return kept;
      const share = at[i] / (at[i] - at[j]);
      return [...kept, p.map((x, k) => x + share * (points[j][k] - x))];
    });
  }, polygon);
}
