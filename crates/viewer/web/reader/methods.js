// What the viewer sees of what their cell may see: the eye-to-cell methods of Teller and Séquin, each within the one before. Mirrors are not
// followed. All but the plain table look through the view only.

import { boundsOf, cross3, dot3, EPSILON, length3, normalOf, unit3 } from "./geometry.js";

export const METHODS = ["cell-to-cell", "disjoint-cell", "connected-component", "incident-portals", "exact"];
/** Portals that the exact method looks at, in all and one behind the other, before it takes the answer of the incident portals. */
const MOST_STEPS = 100000;
const MOST_DEPTH = 1000;

/** A view as half-spaces through the eye: kept is what none of the normals points away from. */
export class View {
  /** All along the axes of the table: the eye, and normals that point inwards; without any, all directions are in view. */
  constructor(table, eye, sides = []) {
    this.eye = eye;
    /** What rounding may move a border by, for vectors of some length. */
    this.share = 2 ** -40;
    /** The eye is known to within the gap of a frame and its rounding; what that may move a side by grows with what is looked at. */
    table.bounds ??= boundsOf(table);
    const { min, max } = table.bounds;
    const reach = [0, 1, 2].reduce((sum, k) => sum + Math.max(Math.abs(min[k] - eye[k]), Math.abs(max[k] - eye[k])), 0);
    const gap = table.frame ? table.frame.gap + 16 * EPSILON * (Math.abs(eye[0]) + Math.abs(eye[1]) + Math.abs(eye[2])) : 0;
    this.slack = 4 * gap * reach;
    this.sides = sides;
    for (const side of sides) side.slack = 4 * gap * (Math.abs(side[0]) + Math.abs(side[1]) + Math.abs(side[2]));
  }

  /** `fov` is the horizontal angle in radians, below a half turn. */
  static picture(table, up, eye, direction, fov, aspect) {
    const f = unit3(direction);
    const w = Math.tan(fov / 2);
    const plane = (by, axis, sign) => f.map((x, k) => x * by + sign * axis[k]);
    if (table.dimension === 2) {
      const right = [f[1], -f[0], 0];
      return new View(table, eye, [plane(w, right, 1), plane(w, right, -1)]);
    }
    const right = unit3(cross3(f, up));
    const above = cross3(right, f);
    return new View(table, eye, [plane(w, right, 1), plane(w, right, -1), plane(w / aspect, above, 1), plane(w / aspect, above, -1)]);
  }

  vector(p) {
    return p.map((x, k) => x - this.eye[k]);
  }

  /** Whether a side certainly keeps none of these vectors. */
  excludes(side, vectors) {
    const size = length3(side);
    return vectors.every((v) => dot3(side, v) < -this.share * size * length3(v) - side.slack);
  }

  /** Whether no side certainly has all of these outside, from the eye. */
  meets(vectors) {
    return !this.sides.some((side) => this.excludes(side, vectors));
  }

  /** Whether no side certainly has all of a box outside: its farthest corner, by the tolerance of its farthest point. */
  meetsBox({ min, max }) {
    const low = this.vector(min);
    const high = this.vector(max);
    const far = length3(low.map((x, k) => Math.max(Math.abs(x), Math.abs(high[k]))));
    return this.sides.every((side) => {
      const corner = side.map((x, k) => (x >= 0 ? high[k] : low[k]));
      return !(dot3(side, corner) < -this.share * length3(side) * far - side.slack);
    });
  }
}

/** A query from one cell: which portals there are between the cells that it may see. Portals are passed unless `isClosed` holds for them. */
class Query {
  constructor(table, view, root, isClosed) {
    this.isClosed = isClosed;
    this.table = table;
    this.view = view;
    this.root = root;
    this.row = new Set(table.visibleCells([root]));
    this.inView = new Map();
    this.known = new Map();
    this.byCell = portalsByCell(table);
    /** Cells without portals are boxes from elsewhere: only whether they are in view can be tested. */
    this.apart = [...this.row].filter((cell) => cell !== root && this.byCell[cell].length === 0);
  }

  cellInView(cell) {
    if (cell === this.root) return true;
    if (!this.inView.has(cell)) this.inView.set(cell, this.view.meetsBox(this.table.cells[cell]));
    return this.inView.get(cell);
  }

  /** The ways out of a cell that stay within what the root may see: where to, and the corners of the portal, from the eye as well. */
  ways(cell) {
    if (!this.known.has(cell)) {
      const ways = [];
      for (const portal of this.byCell[cell]) {
        const { cells, points } = this.table.portals[portal];
        const to = cells[0] === cell ? cells[1] : cells[0];
        if (!this.row.has(to) || this.isClosed(portal)) continue;
        ways.push({ to, points, vectors: points.map((p) => this.view.vector(p)), forward: cells[0] === cell, inView: null });
      }
      this.known.set(cell, ways);
    }
    return this.known.get(cell);
  }

  /** Whether the eye is certainly behind a portal that is to be crossed. */
  isBehind({ points, vectors: [v], forward }) {
    const { table, view } = this;
    const normal = table.dimension === 2 ? [points[0][1] - points[1][1], points[1][0] - points[0][0], 0] : normalOf(points);
    // Corners are counter-clockwise, or from left to right, as seen on the way from the first cell to the second.
    const ahead = dot3(normal, v) * (table.dimension === 2 ? 1 : -1) * (forward ? 1 : -1);
    const size = length3(normal);
    return ahead < -size * (view.share * length3(v) + 2 * (table.frame?.gap ?? 0));
  }

  wayInView(way) {
    way.inView ??= this.cellInView(way.to) && !this.isBehind(way) && this.view.meets(way.vectors);
    return way.inView;
  }

  /** The cells that are reached from the root through ways that pass. */
  flood(passes) {
    const reached = new Set([this.root]);
    const pending = [this.root];
    while (pending.length > 0) {
      for (const way of this.ways(pending.pop())) {
        if (reached.has(way.to) || !passes(way)) continue;
        reached.add(way.to);
        pending.push(way.to);
      }
    }
    return reached;
  }

  /** The cells that a method keeps; null if the exact one would take too long. */
  cells(method) {
    if (method === "cell-to-cell") return this.row;
    if (method === "disjoint-cell") return new Set([...this.row].filter((cell) => this.cellInView(cell)));
    const reached = this.reach(method);
    for (const cell of reached === null ? [] : this.apart) if (this.cellInView(cell)) reached.add(cell);
    return reached;
  }

  reach(method) {
    if (method === "connected-component") return this.flood((way) => this.cellInView(way.to));
    if (method === "incident-portals") return this.flood((way) => this.wayInView(way));
    return this.exact();
  }

  /** What may be seen although no cell that is seen has it: what touches no cell, and between boxes that leave gaps anything. */
  looseObjects(listed) {
    if (this.apart.length > 0) return listed;
    const touched = new Set();
    for (const cell of this.row) for (const object of this.table.cellObjects[cell]) touched.add(object);
    return [...listed].filter((object) => !touched.has(object));
  }

  /** Follows cones of sight: each portal is clipped by the cone that reaches it, and what is left is the next cone. */
  exact() {
    const { view } = this;
    // Beyond these there is nothing to find.
    const most = this.reach("incident-portals").size;
    const reached = new Set([this.root]);
    const onWay = new Set([this.root]);
    let steps = 0;
    const follow = (cell, sides, depth) => {
      for (const way of this.ways(cell)) {
        if (reached.size === most) return true;
        if (onWay.has(way.to) || !this.wayInView(way)) continue;
        steps += 1;
        if (steps > MOST_STEPS || depth > MOST_DEPTH) return false;
        const left = clip(view, way.vectors, sides);
        if (left.length === 0) continue;
        reached.add(way.to);
        onWay.add(way.to);
        const inner = coneOf(view, left, this.table.dimension) ?? sides;
        const isDone = follow(way.to, inner, depth + 1);
        onWay.delete(way.to);
        if (!isDone) return false;
      }
      return true;
    };
    return follow(this.root, view.sides, 0) ? reached : null;
  }
}

/** For each cell the portals out of it. */
export function portalsByCell(table) {
  if (!table.portalsByCell) {
    table.portalsByCell = table.cells.map(() => []);
    table.portals.forEach(({ cells }, portal) => cells.forEach((cell) => table.portalsByCell[cell].push(portal)));
  }
  return table.portalsByCell;
}

/** The corners of what half-spaces through the eye keep of a polygon or a segment, from the eye; what lies on a border is kept. */
function clip(view, vectors, sides) {
  let polygon = vectors;
  for (const side of sides) {
    const size = length3(side);
    const at = polygon.map((v) => dot3(side, v) + view.share * size * length3(v) + side.slack);
    const next = [];
    polygon.forEach((v, i) => {
      const j = (i + 1) % polygon.length;
      if (at[i] >= 0) next.push(v);
      if (at[i] >= 0 !== at[j] >= 0) {
        const share = at[i] / (at[i] - at[j]);
        next.push(v.map((x, k) => x + share * (polygon[j][k] - x)));
      }
    });
    polygon = next;
    if (polygon.length === 0) break;
  }
  return polygon;
}

/** The cone from the eye through a polygon; null if the eye is so near its plane that there is none to speak of. */
function coneOf(view, polygon, dimension) {
  const longest = Math.max(...polygon.map((v) => length3(v)));
  const middle = [0, 1, 2].map((k) => polygon.reduce((sum, v) => sum + v[k], 0) / polygon.length);
  if (dimension === 2) {
    // The two ends that are farthest to the sides.
    const turn = (a, b) => a[0] * b[1] - a[1] * b[0];
    const right = polygon.reduce((a, b) => (turn(a, b) < 0 ? b : a));
    const left = polygon.reduce((a, b) => (turn(a, b) > 0 ? b : a));
    if (Math.abs(turn(right, left)) <= view.share * longest * longest) return null;
    const wide = Math.hypot(left[0] - right[0], left[1] - right[1]);
    return [[-right[1], right[0], 0], [left[1], -left[0], 0]].map((side) => Object.assign(side, { slack: view.slack * wide }));
  }
  const sides = [];
  polygon.forEach((v, i) => {
    const next = polygon[(i + 1) % polygon.length];
    const normal = cross3(v, next);
    const size = length3(normal);
    if (size <= view.share * longest * longest) return;
    const at = dot3(normal, middle);
    if (Math.abs(at) <= view.share * size * length3(middle)) return;
    const edge = Math.abs(next[0] - v[0]) + Math.abs(next[1] - v[1]) + Math.abs(next[2] - v[2]);
    sides.push(Object.assign(at > 0 ? normal : normal.map((x) => -x), { slack: view.slack * edge }));
  });
  return sides.length >= 3 ? sides : null;
}

/** What is seen in a view from cells at the eye, by a method: cells, objects, and the method that answered. */
export function lookBy(table, roots, method, view, isClosed = () => false) {
  const cells = new Set();
  const objects = new Set();
  let answered = method;
  for (const root of roots) {
    const query = new Query(table, view, root, isClosed);
    let kept = query.cells(method);
    if (kept === null) {
      answered = "incident-portals";
      kept = query.cells(answered);
    }
    const listed = new Set(table.visibleObjects([root]));
    kept.forEach((cell) => cells.add(cell));
    if (method === "cell-to-cell") {
      listed.forEach((object) => objects.add(object));
      continue;
    }
    const add = (object) => {
      if (!objects.has(object) && view.meetsBox(table.objects[object])) objects.add(object);
    };
    for (const cell of kept) for (const object of table.cellObjects[cell]) if (listed.has(object)) add(object);
    for (const object of query.looseObjects(listed)) add(object);
  }
  return { cells, objects, answered };
}
