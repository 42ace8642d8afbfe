// The table: the same rules as the crate `sightlines-pvs`, number for number. Doubles in JavaScript are those of Rust, and
// no operation here is reordered, so a point is found in the same cells.

const EPSILON = 2 ** -52;
const SMALLEST_NORMAL = 2 ** -1022;
const LEAF = 0xffffffff;
const CELL_FLAG = 0x80000000;
const QUAKE_PORTAL_FILE = 5;
const QUAKE_MAP = 6;

class Table {
  /** Reads the bytes of a `.pvs` file, which Rust has checked before it wrote them here. */
  constructor(bytes) {
    const sections = sectionsOf(bytes);
    const open = (id) => (sections.has(id) ? new Reader(sections.get(id)) : null);
    this.readCells(open("CELL"), open("POLY"), open("CNAM"));
    this.readPortals(open("PORT"));
    this.readObjects(open("OBJS"), open("COBJ"), open("OPOL"));
    this.rows = sections.get("ROWS");
    this.seen = sections.get("SEEN") ?? null;
    this.readLocator(open("LOCA"));
    this.readPlanes(open("PLNS"));
    this.readFrame(open("FRAM"));
    const kind = open("KIND");
    [this.kind, , this.up] = kind ? [kind.u32(), kind.u32(), kind.u32() - 1] : [0, 0, -1];
    this.info = readInfo(open("INFO"));
    // Clusters of Quake maps are not their boxes: only planes locate points in them.
    this.hasPlaces = (this.kind !== QUAKE_PORTAL_FILE && this.kind !== QUAKE_MAP) || this.planes !== null;
  }

  readCells(r, polygons, names) {
    this.dimension = r.u32();
    const n = r.u32();
    this.cells = [];
    for (let i = 0; i < n; i++) {
      const [min, max] = [r.point(this.dimension), r.point(this.dimension)];
      const hasGroup = r.u32() === 1;
      const group = r.u32();
      this.cells.push({ min, max, group: hasGroup ? group : null, polygon: [], name: null });
    }
    if (polygons) {
      const lengths = polygons.u32s(n);
      this.cells.forEach((cell, i) => {
        for (let k = 0; k < lengths[i]; k++) cell.polygon.push([polygons.f64(), polygons.f64()]);
      });
    }
    if (names) this.cells.forEach((cell) => (cell.name = names.text()));
  }

  readPortals(r) {
    this.portals = [];
    const n = r ? r.u32() : 0;
    for (let i = 0; i < n; i++) {
      const cells = [r.u32(), r.u32()];
      r.u32s(2);
      const points = [];
      for (let k = r.u32(); k > 0; k--) points.push(r.point(this.dimension));
      this.portals.push({ cells, points });
    }
  }

  readObjects(r, touching, polygons) {
    this.objects = [];
    for (let n = r.u32(); n > 0; n--) {
      const [min, max] = [r.point(this.dimension), r.point(this.dimension)];
      this.objects.push({ name: r.text(), min, max, polygons: 0 });
    }
    if (polygons) this.objects.forEach((object) => (object.polygons = polygons.u32()));
    const lengths = touching.u32s(this.cells.length);
    this.cellObjects = this.cells.map((_, i) => touching.u32s(lengths[i]));
  }

  readLocator(r) {
    const [nNodes, nEntries] = [r.u32(), r.u32()];
    const nodes = [];
    let start = 0;
    for (let i = 0; i < nNodes; i++) {
      const [tag, second] = [r.u32(), r.u32()];
      const split = r.f64();
      if (tag === LEAF) {
        nodes.push({ axis: -1, start, end: start + second });
        start += second;
      } else {
        nodes.push({ axis: tag, split, high: second });
      }
    }
    this.locator = { nodes, entries: r.u32s(nEntries) };
  }

  readPlanes(r) {
    this.planes = null;
    if (!r) return;
    const slack = r.f64();
    const nodes = [];
    for (let n = r.u32(); n > 0; n--) {
      nodes.push({ normal: r.point(3), offset: r.f64(), children: [r.u32(), r.u32()] });
    }
    this.planes = { slack, nodes };
  }

  readFrame(r) {
    this.frame = r ? { axes: [r.point(3), r.point(3), r.point(3)], gap: r.f64() } : null;
  }

  /** The cells that contain a point of the scene, ascending: none outside, several on borders. */
  locate(p) {
    const point = this.dimension === 2 ? [p[0], p[1], 0] : p;
    const found = new Set();
    if (this.hasPlaces && point.every(Number.isFinite)) {
      if (this.frame) {
        const [min, max] = aroundInFrame(this.frame, point, point);
        this.locateBox(min, max, found);
      } else if (this.planes) {
        locateByPlanes(this.planes, (node) => sidesOfPoint(node, point, this.planes.slack), found);
      } else {
        this.locatePoint(point, found);
      }
    }
    return [...found].sort((a, b) => a - b);
  }

  locatePoint(p, found) {
    const { nodes, entries } = this.locator;
    const pending = [0];
    while (pending.length > 0) {
      const at = pending.pop();
      const node = nodes[at];
      if (node.axis < 0) {
        for (let k = node.start; k < node.end; k++) {
          const cell = this.cells[entries[k]];
          const inBox = [0, 1, 2].every((a) => cell.min[a] <= p[a] && p[a] <= cell.max[a]);
          if (inBox && polygonMayContain(cell.polygon, p)) found.add(entries[k]);
        }
        continue;
      }
      const x = p[node.axis];
      if (!(x < node.split)) pending.push(node.high);
      if (!(x > node.split)) pending.push(at + 1);
    }
  }

  locateBox(min, max, found) {
    if (this.planes) {
      locateByPlanes(this.planes, (node) => sidesOfBox(node, min, max, this.planes.slack), found);
      return;
    }
    const { nodes, entries } = this.locator;
    const pending = [0];
    while (pending.length > 0) {
      const at = pending.pop();
      const node = nodes[at];
      if (node.axis < 0) {
        for (let k = node.start; k < node.end; k++) {
          const cell = this.cells[entries[k]];
          if (![0, 1, 2].some((a) => cell.min[a] > max[a] || cell.max[a] < min[a])) found.add(entries[k]);
        }
        continue;
      }
      if (!(max[node.axis] < node.split)) pending.push(node.high);
      if (!(min[node.axis] > node.split)) pending.push(at + 1);
    }
  }

  /** Whether a pair of cells is listed as visible. Of the symmetric matrix, the file has the half below the diagonal. */
  sees(a, b) {
    const [row, column] = a >= b ? [a, b] : [b, a];
    return ((this.rows[8 * wordsBefore(row) + (column >> 3)] >> (column & 7)) & 1) === 1;
  }

  /** The cells that may be seen from any of these, ascending. */
  visibleCells(from) {
    const seen = [];
    for (let b = 0; b < this.cells.length; b++) {
      if (from.some((a) => this.sees(a, b))) seen.push(b);
    }
    return seen;
  }

  /** The objects that may be seen from any of these cells, ascending; `visible` are the cells that may. */
  visibleObjects(from, visible) {
    const mark = new Uint8Array(this.objects.length);
    if (this.seen) {
      const stride = 8 * Math.ceil(this.objects.length / 64);
      for (let o = 0; o < mark.length; o++) {
        if (from.some((a) => (this.seen[a * stride + (o >> 3)] >> (o & 7)) & 1)) mark[o] = 1;
      }
    } else {
      for (const cell of visible) for (const object of this.cellObjects[cell]) mark[object] = 1;
    }
    const objects = [];
    mark.forEach((on, o) => on && objects.push(o));
    return objects;
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
}

/** The sections of a file by their names. */
function sectionsOf(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const sections = new Map();
  for (let i = 0; i < view.getUint32(12, true); i++) {
    const at = 24 + 32 * i;
    const id = String.fromCharCode(...bytes.subarray(at, at + 4));
    // Both are below 2^53: the page could not hold more.
    const [begin, length] = [Number(view.getBigUint64(at + 8, true)), Number(view.getBigUint64(at + 16, true))];
    sections.set(id, bytes.subarray(begin, begin + length));
  }
  return sections;
}

function readInfo(r) {
  const info = [];
  for (let n = r.u32(); n > 0; n--) info.push([r.text(), r.text()]);
  return info;
}

/** Number of words of the rows before this one. */
function wordsBefore(row) {
  const full = Math.floor(row / 64);
  return 32 * full * (full + 1) + (row - 64 * full) * (full + 1);
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
  return !corners.some((corner, i) => certainlyRight(corner, corners[(i + 1) % corners.length], p));
}

function locateByPlanes(planes, sidesOf, found) {
  const pending = [0];
  while (pending.length > 0) {
    const node = planes.nodes[pending.pop()];
    sidesOf(node).forEach((isOpen, k) => {
      const child = node.children[k];
      if (!isOpen || child === 0) return;
      if (child >= CELL_FLAG) found.add(child - CELL_FLAG);
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
