// Tables of visibility in a browser: loading one, and asking what may be seen from a point.

import { TableError } from "../../../crates/viewer/web/reader/bytes.js";
import { lookBy, METHODS, View } from "../../../crates/viewer/web/reader/methods.js";
import { readPlain } from "../../../crates/viewer/web/reader/plain.js";
import { hasBit, ones } from "../../../crates/viewer/web/reader/rows.js";
import { wayToSight } from "../../../crates/viewer/web/reader/soon.js";
import { Table } from "../../../crates/viewer/web/reader/table.js";
import { isPacked, readPacked } from "./packed.js";

export { LoadedTable as Table, METHODS, TableError };

/** A point or direction: a list of numbers, or an object with x, y and z such as the vectors of engines. */
function numbers(p) {
  const list = p.x === undefined ? p : [p.x, p.y, p.z];
  return [list[0], list[1], list[2] ?? 0];
}

/** A table, plain or packed. */
class LoadedTable extends Table {
  /** Reads the bytes of a file. Throws a TableError if anything is wrong with them. */
  static read(bytes) {
    const all = ArrayBuffer.isView(bytes) ? new Uint8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength) : new Uint8Array(bytes);
    try {
      return new LoadedTable(isPacked(all) ? readPacked(all) : readPlain(all));
    } catch (error) {
      if (error instanceof RangeError) throw new TableError(`the file needs more memory than there is: ${error.message}`);
      throw error;
    }
  }

  /** What may be seen from a point of the scene. */
  at(point) {
    const p = numbers(point);
    if (this.dimension === 2) p[2] = 0;
    return new Place(this, p, this.locate(p));
  }

  /** The objects that may be seen from a point, or of those the ones that a view may show. */
  visibleItems(eye, view, options) {
    const place = this.at(eye);
    return (view ? place.narrow(view, options) : place).objects().map((object) => this.objects[object]);
  }

  /** The objects of a name, as ids; names may repeat. */
  named(name) {
    if (!this.byName) {
      this.byName = new Map(this.objects.map((object) => [object.name, []]));
      for (const object of this.objects) this.byName.get(object.name).push(object.id);
    }
    return this.byName.get(name) ?? [];
  }

  /** All doors, open. */
  openDoors() {
    return new Doors(this);
  }

  /**
   * A lower bound of the time until bodies at two points may see each other, if they are no faster than these speeds; of the way that each has to go, if
   * no speeds are given. 0 if they may see each other now, or one is outside of all cells.
   */
  timeToSight(a, b, speeds = [1, 1]) {
    const points = [numbers(a), numbers(b)];
    if (points.some((p) => this.locate(p).length === 0) || !speeds.every((speed) => speed >= 0)) return 0;
    return wayToSight(this, points, speeds);
  }

  /** Tells when what may be seen from an eye changes. */
  watch(options) {
    return new Watch(this, options);
  }
}

/** Reads a table from bytes, from a Blob or a Response, or from an address. */
export async function load(source, init) {
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return LoadedTable.read(source);
  const isAddress = typeof source?.arrayBuffer !== "function" || (typeof Request !== "undefined" && source instanceof Request);
  const body = isAddress ? await fetch(source, init) : source;
  if (body.ok === false) throw new TableError(`${body.url || source} was answered by ${body.status} ${body.statusText}`);
  return LoadedTable.read(await body.arrayBuffer());
}

/** What may be seen from a point: from outside of all cells everything, since nothing is known there. */
class Place {
  constructor(table, point, cells) {
    this.table = table;
    this.point = point;
    /** The cells with the point, ascending: none outside, several on borders. */
    this.cells = cells;
    this.isOutside = cells.length === 0;
  }

  /** Whether an object may be seen. */
  sees(object) {
    const { seen } = this.table;
    return this.isOutside || this.cells.some((cell) => hasBit(seen.row(cell), object));
  }

  /** Whether something in a cell may be seen. */
  seesCell(cell) {
    return this.isOutside || this.cells.some((at) => this.table.sees(at, cell));
  }

  /** The objects that may be seen as bits, 32 in each word, the lowest first. Not to be written to. */
  get objectBits() {
    return this.isOutside ? allBits(this.table.objects.length, this.table.seen.nWords) : this.table.seen.union(this.cells);
  }

  /** The same for cells. */
  get cellBits() {
    return this.isOutside ? allBits(this.table.cells.length, this.table.rows.nWords) : this.table.rows.union(this.cells);
  }

  /** The objects that may be seen, ascending. */
  objects() {
    return ones(this.objectBits);
  }

  /** The cells that may be seen, ascending. */
  visibleCells() {
    return ones(this.cellBits);
  }

  /**
   * What of this a view may show, and what may be seen through open doors. Without a view in all directions. From outside of all cells this is
   * everything still: nothing is known there.
   */
  narrow(view = null, { method = "exact", doors = null } = {}) {
    if (!METHODS.includes(method)) throw new TypeError(`'${method}' is none of ${METHODS.join(", ")}`);
    if (this.isOutside) return new Narrowed(this.table, this.visibleCells(), this.objects(), "cell-to-cell");
    const { cells, objects, answered } = lookBy(this.table, this.cells, method, viewOf(this, view), (portal) => doors?.isClosed(portal) ?? false);
    const sorted = (set) => [...set].sort((a, b) => a - b);
    return new Narrowed(this.table, sorted(cells), sorted(objects), answered);
  }
}

function allBits(n, nWords) {
  const words = new Uint32Array(nWords).fill(0xffffffff, 0, Math.ceil(n / 32));
  if (n & 31) words[n >>> 5] = (1 << (n & 31)) - 1;
  return words;
}

/** What of a place a view shows. */
class Narrowed {
  constructor(table, cells, objects, method) {
    Object.assign(this, { table, method });
    this.lists = [cells, objects];
    this.sets = null;
  }

  get set() {
    return (this.sets ??= this.lists.map((list) => new Set(list)));
  }

  sees(object) {
    return this.set[1].has(object);
  }

  seesCell(cell) {
    return this.set[0].has(cell);
  }

  objects() {
    return this.lists[1];
  }

  visibleCells() {
    return this.lists[0];
  }
}

/** The view of a camera along the axes of the table: by an angle and a direction, or by a matrix as engines have it. */
function viewOf({ table, point }, view) {
  const eye = table.toTable(point);
  const turned = (v) => table.toTable(v);
  const check = (list) => {
    if (!list.every(Number.isFinite)) throw new TypeError("the view has a number that is not finite");
    return list;
  };
  if (!view) return new View(table, eye);
  if (view.viewProjection) {
    // By columns: at a point p the picture has x, y and w, and shows what has |x| and |y| below w.
    const m = check(Array.from(view.viewProjection));
    if (m.length !== 16) throw new TypeError(`a matrix has 16 numbers, not ${m.length}`);
    const row = (r) => [m[r], m[4 + r], m[8 + r]];
    const w = row(3);
    if (!w.some((x) => x !== 0)) throw new TypeError("a parallel projection has no eye: narrow without a view");
    const sides = [0, 1].flatMap((r) => [1, -1].map((sign) => row(r).map((x, k) => w[k] + sign * x)));
    return new View(table, eye, sides.map(turned));
  }
  const { direction, fov, aspect = 1, up } = view;
  const isRight = fov > 0 && fov < Math.PI && aspect > 0;
  if (!isRight) throw new TypeError("a view has a horizontal angle above 0 and below half a turn, and an aspect above 0");
  const axis = table.up >= 0 ? table.up : 1;
  const upwards = check(up ? numbers(up) : [0, 1, 2].map((k) => (k === axis ? 1 : 0)));
  const ahead = check(numbers(direction));
  if (!ahead.some((x) => x !== 0)) throw new TypeError("a view has a direction");
  return View.picture(table, turned(upwards), eye, turned(ahead), check([fov])[0], check([aspect])[0]);
}

/** Which doors are shut, and which portals are closed on their own account. */
class Doors {
  constructor(table) {
    this.table = table;
    this.shut = new Set();
    this.own = new Set();
    this.closed = new Set();
  }

  /** The doors of a number or a name. */
  find(door) {
    const { doors } = this.table;
    const found = typeof door === "number" ? (doors[door] ? [door] : []) : [...doors.keys()].filter((id) => doors[id].name === door);
    if (found.length === 0) throw new TypeError(`the table has no door '${door}'`);
    return found;
  }

  /** Shuts the door of a number, or all doors of a name. */
  close(door) {
    for (const id of this.find(door)) this.shut.add(id);
    return this.update();
  }

  /** Opens them again; portals that another shut door closes stay closed. */
  open(door) {
    for (const id of this.find(door)) this.shut.delete(id);
    return this.update();
  }

  /** Whether one of these doors is shut. */
  isShut(door) {
    return this.find(door).some((id) => this.shut.has(id));
  }

  closePortal(portal) {
    this.own.add(portal);
    return this.update();
  }

  openPortal(portal) {
    this.own.delete(portal);
    return this.update();
  }

  openAll() {
    this.shut.clear();
    this.own.clear();
    return this.update();
  }

  /** Whether a portal can not be passed. */
  isClosed(portal) {
    return this.closed.has(portal);
  }

  update() {
    this.closed = new Set(this.own);
    for (const id of this.shut) for (const portal of this.table.doors[id].portals) this.closed.add(portal);
    return this;
  }
}

/** What changed: the objects that may be seen from now on, and those that no longer may. */
export class VisibilityEvent extends Event {
  constructor(place, gained, lost) {
    super("change");
    Object.assign(this, { place, gained, lost });
  }
}

/** Follows an eye. Its event `change` tells what may be seen from now on, and what no longer. */
class Watch extends EventTarget {
  /** At first nothing is seen, so the first update tells all that is; with `all`, everything is. */
  constructor(table, { from = "nothing" } = {}) {
    super();
    this.table = table;
    this.place = null;
    const { length } = table.objects;
    this.bits = from === "everything" ? allBits(length, table.seen.nWords) : new Uint32Array(table.seen.nWords);
    this.key = null;
  }

  /** The eye is at a point now. Whether what may be seen has changed. */
  update(eye) {
    const place = this.table.at(eye);
    const key = place.cells.join();
    this.place = place;
    // Within the same cells the same is seen.
    if (key === this.key) return false;
    this.key = key;
    const [now, before] = [place.objectBits, this.bits];
    this.bits = now;
    const gained = ones(now.map((word, k) => word & ~before[k]));
    const lost = ones(before.map((word, k) => word & ~now[k]));
    if (gained.length === 0 && lost.length === 0) return false;
    this.dispatchEvent(new VisibilityEvent(place, gained, lost));
    return true;
  }
}
