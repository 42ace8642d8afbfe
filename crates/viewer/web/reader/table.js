// The table: the same rules as the crate `sightlines-pvs`, number for number. Doubles in JavaScript are those of Rust, and
// no operation here is reordered, so a point is found in the same cells.

import { EPSILON, SMALLEST_NORMAL } from "./geometry.js";
import { TableError } from "./bytes.js";
import { hasBit, ones, Rows, setBit } from "./rows.js";

/** Longest way from the root of a tree. */
const MAX_DEPTH = 1024;
const LEAF = 255;
const CELL_FLAG = 0x80000000;
const QUAKE_PORTAL_FILE = 5;
const QUAKE_MAP = 6;

/** What a file says of cells, portals and objects, and what may be seen from where. */
export class Table {
  /** Of what `readPlain` or another reader makes of a file. */
  constructor(parts) {
    Object.assign(this, parts);
    const n = this.cells.length;
    this.hasPolygons = this.cells.some(({ polygon }) => polygon.length > 0);
    this.boxes = new Float64Array(6 * n);
    this.cells.forEach(({ min, max }, i) => this.boxes.set([...min, ...max], 6 * i));
    // Clusters of Quake maps are not their boxes: only planes locate points in them.
    this.isQuake = this.kind === QUAKE_PORTAL_FILE || this.kind === QUAKE_MAP;
    this.hasPlaces = !this.isQuake || this.planes !== null;
    // Without rows of their own, objects are seen with the cells that they touch.
    this.seen ??= new Rows(this.objects.length, (cell) => {
      const row = new Uint32Array(this.seen.nWords);
      for (const seen of ones(this.rows.row(cell))) for (const object of this.cellObjects[seen]) setBit(row, object);
      return row;
    });
    this.pending = [];
  }

  /** The cells that contain a point of the scene, ascending: none outside, several on borders. */
  locate(p) {
    const found = [];
    const point = this.dimension === 2 ? [p[0], p[1], 0] : p;
    if (!this.hasPlaces || !(Number.isFinite(point[0]) && Number.isFinite(point[1]) && Number.isFinite(point[2]))) return found;
    if (this.frame) {
      const [min, max] = aroundInFrame(this.frame, point, point);
      if (this.planes) locateByPlanes(this.planes, (node) => sidesOfBox(node, min, max, this.planes.slack), found);
      else this.locateBox(min, max, false, found);
    } else if (this.planes) {
      locateByPlanes(this.planes, (node) => sidesOfPoint(node, point, this.planes.slack), found);
    } else {
      this.locateBox(point, point, this.hasPolygons, found);
    }
    if (found.length < 2) return found;
    found.sort((a, b) => a - b);
    return found.filter((cell, k) => cell !== found[k - 1]);
  }

  /** Adds the cells whose boxes meet a box; with `asPoint`, those whose polygons may contain it. */
  locateBox(min, max, asPoint, found) {
    const { boxes, pending } = this;
    const { axes, splits, first, second, entries } = this.locator;
    let [at, n] = [0, 0];
    for (;;) {
      const axis = axes[at];
      if (axis === LEAF) {
        for (let k = first[at]; k < second[at]; k++) {
          const cell = entries[k];
          const b = 6 * cell;
          const isIn =
            boxes[b] <= max[0] && min[0] <= boxes[b + 3] &&
            boxes[b + 1] <= max[1] && min[1] <= boxes[b + 4] &&
            boxes[b + 2] <= max[2] && min[2] <= boxes[b + 5];
          if (isIn && !(asPoint && !polygonMayContain(this.cells[cell].polygon, min))) found.push(cell);
        }
        if (n === 0) return;
        at = pending[--n];
        continue;
      }
      const isHigh = !(max[axis] < splits[at]);
      if (!(min[axis] > splits[at])) {
        if (isHigh) pending[n++] = second[at];
        at += 1;
      } else {
        at = second[at];
      }
    }
  }

  /** Whether a pair of cells is listed as visible. */
  sees(a, b) {
    return hasBit(this.rows.row(a), b);
  }

  /** The cells that may be seen from any of these, ascending. */
  visibleCells(from) {
    return from.length === 0 ? [] : ones(this.rows.union(from));
  }

  /** The objects that may be seen from any of these cells, ascending. */
  visibleObjects(from) {
    return from.length === 0 ? [] : ones(this.seen.union(from));
  }

  /** A point of the scene along the axes of the table. */
  toTable(p) {
    if (!this.frame) return p;
    return this.frame.axes.map((a) => a[0] * p[0] + a[1] * p[1] + a[2] * p[2]);
  }

  /** A point along the axes of the table as one of the scene. */
  toScene(p) {
    if (!this.frame) return p;
    const [x, y, z] = this.frame.axes;
    return [0, 1, 2].map((k) => x[k] * p[0] + y[k] * p[1] + z[k] * p[2]);
  }

  /** A box along the axes of the table in which a point of the scene is. */
  boxOf(p) {
    const [min, max] = this.frame ? aroundInFrame(this.frame, p, p) : [p, p];
    return { min, max };
  }
}

/**
 * The tree that locates cells, of `n` nodes in preorder. `node` reads one: its axis, or null for a leaf; its split; and the number of its high
 * child, or of the first entry of the leaf and of the one behind its last. Whatever it reads, what comes out is a tree.
 */
export function locatorOf(n, node, entries, nCells) {
  const wrong = (i) => new TableError(`the locator is no tree at node ${i}`);
  const tree = { axes: new Uint8Array(n), splits: new Float64Array(n), first: new Uint32Array(n), second: new Uint32Array(n), entries };
  // The ends of the subtrees around a node.
  const ends = [n];
  for (let i = 0; i < n; i++) {
    const { axis, split, high, first, end } = node(i);
    const until = ends.at(-1);
    if (axis === null) {
      if (i + 1 !== until || !(first <= end && end <= entries.length)) throw wrong(i);
      ends.pop();
      [tree.axes[i], tree.first[i], tree.second[i]] = [LEAF, first, end];
    } else {
      if (!(i + 1 < high && high < until && axis < 3 && ends.length < MAX_DEPTH)) throw wrong(i);
      ends.push(high);
      [tree.axes[i], tree.splits[i], tree.second[i]] = [axis, split, high];
    }
  }
  if (n === 0 || ends.length > 0) throw wrong(n);
  if (entries.some((cell) => cell >= nCells)) throw new TableError("the locator lists a cell that does not exist");
  return tree;
}

/** A tree of planes, after a check that it is one. Children are 0 for nothing, the number of a node, or 2^31 plus a cell. */
export function planesOf(slack, nodes, nCells) {
  const depth = new Uint16Array(nodes.length);
  depth[0] = 1;
  nodes.forEach(({ children }, i) => {
    for (const child of children) {
      const isRight =
        child === 0 || (child >= CELL_FLAG ? child - CELL_FLAG < nCells : child > i && child < nodes.length && depth[child] === 0);
      if (!isRight || depth[i] === 0 || depth[i] > MAX_DEPTH) throw new TableError(`the planes are no tree at node ${i}`);
      if (child > 0 && child < CELL_FLAG) depth[child] = depth[i] + 1;
    }
  });
  if (nodes.length === 0) throw new TableError("the planes are no tree: there are none");
  return { slack, nodes };
}

/** Whether `c` is certainly to the right of the line from `a` to `b`; see `side.rs` of `sightlines-pvs` for the bound. */
function certainlyRight(a, b, c) {
  const relative = (3 + 8 * EPSILON) * (0.5 * EPSILON);
  const left = (a[0] - c[0]) * (b[1] - c[1]);
  const right = (a[1] - c[1]) * (b[0] - c[0]);
  const bound = relative * (Math.abs(left) + Math.abs(right)) + SMALLEST_NORMAL;
  return left - right < -bound;
}

function polygonMayContain(corners, p) {
  for (let i = 0; i < corners.length; i++) {
    if (certainlyRight(corners[i], corners[i + 1 < corners.length ? i + 1 : 0], p)) return false;
  }
  return true;
}

function locateByPlanes(planes, sidesOf, found) {
  const pending = [0];
  while (pending.length > 0) {
    const node = planes.nodes[pending.pop()];
    sidesOf(node).forEach((isOpen, k) => {
      const child = node.children[k];
      if (!isOpen || child === 0) return;
      if (child >= CELL_FLAG) found.push(child - CELL_FLAG);
      else pending.push(child);
    });
  }
}

/** Whether a point may be above a plane, and below it; see `planes.rs` of `sightlines-pvs` for the bound. */
function sidesOfPoint({ normal, offset }, p, slack) {
  const [x, y, z] = [normal[0] * p[0], normal[1] * p[1], normal[2] * p[2]];
  const height = x + y + z - offset;
  const size = Math.abs(x) + Math.abs(y) + Math.abs(z) + Math.abs(offset) + slack;
  const near = slack + (4 * EPSILON * size + SMALLEST_NORMAL);
  return [!(height < -near), !(height > near)];
}

function sidesOfBox({ normal, offset }, min, max, slack) {
  const up = (k) => normal[k] * (normal[k] >= 0 ? max[k] : min[k]);
  const down = (k) => normal[k] * (normal[k] >= 0 ? min[k] : max[k]);
  const largest = (k) => Math.max(Math.abs(normal[k] * min[k]), Math.abs(normal[k] * max[k]));
  const [top, bottom] = [up(0) + up(1) + up(2) - offset, down(0) + down(1) + down(2) - offset];
  const size = largest(0) + largest(1) + largest(2) + Math.abs(offset) + slack;
  const near = slack + (4 * EPSILON * size + SMALLEST_NORMAL);
  return [!(top < -near), !(bottom > near)];
}

/** A box along the axes of a frame around everything within its gap of a box of the scene; see `frame.rs` there. */
function aroundInFrame({ axes, gap }, min, max) {
  const [lower, upper] = [[], []];
  for (const a of axes) {
    let [low, high, size] = [0, 0, 0];
    for (let i = 0; i < 3; i++) {
      if (a[i] === 0) continue;
      const [from, to] = a[i] > 0 ? [a[i] * min[i], a[i] * max[i]] : [a[i] * max[i], a[i] * min[i]];
      low += Math.min(from, to);
      high += Math.max(to, from);
      size += Math.max(Math.abs(from), Math.abs(to));
    }
    const wide = gap * (1 + 8 * EPSILON) + size * (128 * EPSILON) + SMALLEST_NORMAL;
    lower.push(low - wide);
    upper.push(high + wide);
  }
  return [lower, upper];
}
