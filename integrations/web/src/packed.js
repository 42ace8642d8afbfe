// The bytes of a packed table (`.pvz`), as the module `format` of `sightlines-packed` describes them. Rows are unpacked when they are asked for,
// all else at once.

import { crc32, Reader, TableError } from "../../../crates/viewer/web/reader/bytes.js";
import { NONE, openSection, readFrame, readHead, readKind, readPoints, readSections, startsWith } from "../../../crates/viewer/web/reader/plain.js";
import { asWords, clearPast, Rows, setBit, wordsOf } from "../../../crates/viewer/web/reader/rows.js";
import { locatorOf, planesOf } from "../../../crates/viewer/web/reader/table.js";
import { unpackZstd } from "./zstd.js";

const PACKED_MAGIC = "\x89PVP\r\n\x1a\n";
const PACKED_END = "\x89PVE\r\n\x1a\n";
/** Major version of large files, whose boxes and locator are in blocks too. */
const LARGE = 2;
const PACKED_KNOWN = ["HEAD", "BOXS", "LOCA", "LOCT", "FRAM", "INFO", "COAR", "CLAS", "SCLR", "SCLC", "BLKS"];
/** Largest block, and largest sum of the blocks that are unpacked at once, in bytes: a small file can claim much. */
const MOST_BLOCK = 2 ** 24;
const MOST_UNPACKED = 2 ** 30;
/** Unpacked blocks of a store that are kept. */
const KEPT_BLOCKS = 4;
/** Flags of `HEAD`. */
const [POLYGONS_KNOWN, HAS_SEEN] = [1, 2];

export function isPacked(bytes) {
  return startsWith(bytes, PACKED_MAGIC);
}

/** The sections of a file, where its blocks begin and end, and whether it is a large one. */
function readFile(bytes) {
  const { major, n: nSmall, begin: first } = readHead(bytes, 24, LARGE, false);
  if (major < LARGE) {
    const { sections, end } = readSections(bytes, { at: 24, n: nSmall, size: 24, known: PACKED_KNOWN, begin: first });
    return { sections, begin: end, end: bytes.length, isLarge: false };
  }
  const at = bytes.length - 32;
  if (at < 24 || !startsWith(bytes.subarray(at + 24), PACKED_END)) throw new TableError("the file is cut off");
  const tail = new Reader(bytes.subarray(at), "the end of the file");
  const [begin, stated, n] = [tail.u32() + 2 ** 32 * tail.u32(), tail.u32() + 2 ** 32 * tail.u32(), tail.u32()];
  const table = at - 24 * n;
  if (stated !== bytes.length || !(24 <= begin && begin <= table)) throw new TableError("the end of the file is damaged");
  const crc = crc32(bytes.subarray(at, at + 20), crc32(bytes.subarray(table, at), crc32(bytes.subarray(0, 24))));
  if (crc !== tail.u32()) throw new TableError("the table of sections is damaged");
  const read = readSections(bytes, { at: table, n, size: 24, known: PACKED_KNOWN, begin });
  if (read.end !== table) throw new TableError("the sections are not in their places");
  return { sections: read.sections, begin: 24, end: begin, isLarge: true };
}

/** Records in blocks. */
class Store {
  constructor(bytes, id, nRecords) {
    Object.assign(this, { bytes, id, nRecords, blocks: [], kept: new Map(), nListed: 0 });
  }

  /** Adds a block, of which `r` reads lengths and checksum. */
  list(r, at, n) {
    const [length, raw, crc] = [r.u32(), r.u32(), r.u32()];
    if (raw > MOST_BLOCK || length > raw || !(at + length <= this.bytes.length)) throw r.fail("a block has an impossible length");
    if (crc32(this.bytes.subarray(at, at + length)) !== crc) throw new TableError(`a block of ${this.id} is damaged`);
    this.blocks.push({ at, length, raw, first: this.nListed, n });
    this.nListed += n;
    return at + length;
  }

  get nBytes() {
    return this.blocks.reduce((sum, { raw }) => sum + raw, 0);
  }

  /** The block with a record. */
  block(i) {
    let [low, high] = [0, this.blocks.length];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.blocks[middle].first <= i) low = middle;
      else high = middle;
    }
    const block = this.blocks[low];
    let unpacked = this.kept.get(low);
    if (!unpacked) {
      const packed = this.bytes.subarray(block.at, block.at + block.length);
      unpacked = block.length === block.raw ? packed : unpackZstd(packed, block.raw);
      if (this.kept.size >= KEPT_BLOCKS) this.kept.delete(this.kept.keys().next().value);
      this.kept.set(low, unpacked);
    }
    return { unpacked, k: i - block.first, n: block.n };
  }

  /** A record of a block that begins with the ends of its records. */
  record(i) {
    const { unpacked, k, n } = this.block(i);
    const view = new DataView(unpacked.buffer, unpacked.byteOffset, unpacked.length);
    const place = `a block of ${this.id}`;
    if (4 * n > unpacked.length) throw new TableError(`${place} is cut off`);
    const [begin, end] = [k - 1, k].map((at) => 4 * n + (at < 0 ? 0 : view.getUint32(4 * at, true)));
    if (!(begin <= end && end <= unpacked.length)) throw new TableError(`${place} has a record outside of it`);
    return new Reader(unpacked.subarray(begin, end), place);
  }

  /** What `read` makes of each record. */
  all(read) {
    return Array.from({ length: this.nRecords }, (_, i) => read(this.record(i), i));
  }
}

function readStores(bytes, { sections, begin, end, isLarge }) {
  const r = openSection(sections, "BLKS", true);
  const stores = [];
  let at = begin;
  for (let n = r.count(isLarge ? 8 : 12); n > 0; n--) {
    const id = String.fromCharCode(...r.bytes.subarray(r.skip(4), r.at));
    const store = new Store(bytes, id, r.u32());
    stores.push(store);
    if (isLarge) continue;
    const perBlock = r.u32();
    if (perBlock === 0) throw r.fail("a block has no records");
    while (store.nListed < store.nRecords) at = store.list(r, at, Math.min(perBlock, store.nRecords - store.nListed));
  }
  for (let n = isLarge ? r.count(16) : 0; n > 0; n--) {
    const both = r.u32();
    const store = stores[both & 0xffff];
    if (!store || both >>> 16 === 0) throw r.fail("a block is of no store");
    at = store.list(r, at, both >>> 16);
  }
  r.finish();
  if (at !== end || stores.some(({ nListed, nRecords }) => nListed !== nRecords)) throw r.fail("blocks do not add up");
  return new Map(stores.map((store) => [store.id, store]));
}

/** The classes of so many things; null if each is its own. */
function readClasses(sections, id, n, nClasses) {
  const r = openSection(sections, id, true);
  if (r.bytes.length === 0 && n === nClasses) return null;
  const raw = r.below(MOST_BLOCK + 1);
  if (raw < n) throw r.fail("it has too few classes");
  const unpacked = new Reader(unpackZstd(r.bytes.subarray(4), raw), r.place);
  const classes = new Uint32Array(n);
  let next = 0;
  for (let i = 0; i < n; i++) {
    classes[i] = next - unpacked.below(next + 1, unpacked.varint);
    next = Math.max(next, classes[i] + 1);
  }
  unpacked.finish();
  if (next !== nClasses) throw r.fail(`${next} classes instead of ${nClasses}`);
  return classes;
}

/** Rows of a small file: bits between classes. */
function classRows(sections, store, ids, [nRows, nItems, nRowClasses, nColumns]) {
  const rowOf = readClasses(sections, ids[0], nRows, nRowClasses);
  const columnOf = readClasses(sections, ids[1], nItems, nColumns);
  const nBytes = 4 * wordsOf(nColumns);
  if (store.nRecords !== nRowClasses || store.blocks.some(({ n, raw }) => raw !== n * nBytes)) throw new TableError(`rows of ${store.id} have a wrong length`);
  return new Rows(nItems, (i) => {
    const { unpacked, k } = store.block(rowOf ? rowOf[i] : i);
    const bits = clearPast(asWords(unpacked.slice(k * nBytes, (k + 1) * nBytes)), nColumns);
    if (!columnOf) return bits;
    const row = new Uint32Array(wordsOf(nItems));
    columnOf.forEach((column, item) => (bits[column >>> 5] >>> (column & 31)) & 1 && setBit(row, item));
    return row;
  });
}

/** Rows of a large file: bytes that are not 0, each after how many are. */
function maskRows(store, nRows, nItems) {
  if (store.nRecords !== nRows) throw new TableError(`there are ${store.nRecords} rows of ${store.id} instead of ${nRows}`);
  return new Rows(nItems, (i) => {
    const row = new Uint32Array(wordsOf(nItems));
    const r = store.record(i);
    for (let next = 0; r.at < r.bytes.length; next++) {
      next += r.varint();
      if (!(8 * next < nItems)) throw r.fail("a row is too long");
      row[next >>> 2] |= r.bytes[r.skip(1)] << (8 * (next & 3));
    }
    return clearPast(row, nItems);
  });
}

/** A node of a locator: axis, second field, and what is left: a split, or a number. */
function readNode(r, d) {
  const [tag, second] = [r.u32(), r.u32()];
  const at = r.at;
  const split = r.f64();
  const rest = tag === NONE ? r.view.getUint32(at, true) + 2 ** 32 * r.view.getUint32(at + 4, true) : 0;
  return { axis: tag === NONE ? null : tag < d ? tag : NONE, second, split, rest };
}

function packedLocator(sections, d, nCells) {
  const r = openSection(sections, "LOCA", true);
  const [n, nEntries] = [r.u32(), r.u32()];
  const nodes = new Reader(r.bytes.subarray(r.skip(16 * n), r.at), r.place);
  const entries = r.u32s(nEntries);
  const node = () => {
    const { axis, second, split, rest } = readNode(nodes, d);
    return { axis, split, high: second, first: rest, end: rest + second };
  };
  return locatorOf(n, node, entries, nCells);
}

/** The locator of a large file, with all pages in their places. */
function pagedLocator(sections, pages, d, nCells) {
  const r = openSection(sections, "LOCT", true);
  const [n, nPages] = [r.u32(), r.u32()];
  const [nodes, entries, begins, tops] = [[], [], [], []];
  for (let i = 0; i < n; i++) {
    const { axis, second, split, rest } = readNode(r, d);
    begins.push(nodes.length);
    if (axis !== null) {
      tops.push(nodes.length);
      nodes.push({ axis, split, high: second });
      continue;
    }
    if (!(rest < nPages && rest < pages.nRecords)) throw r.fail("there is no such page");
    const page = pages.record(rest);
    const [nNodes, nEntries, nOwn] = [page.u32(), page.u32(), page.u32()];
    page.skip(4);
    const [base, first] = [nodes.length, entries.length];
    for (let k = 0; k < nNodes; k++) {
      const own = readNode(page, d);
      nodes.push({ axis: own.axis, split: own.split, high: base + own.second, first: first + own.rest, end: first + own.rest + own.second });
    }
    const places = page.u32s(nEntries);
    const cells = page.u32s(nOwn);
    // A place outside of the page becomes no cell, which is found out below.
    for (const place of places) entries.push(cells[place] ?? NONE);
  }
  // High children of the top were numbers of its nodes.
  for (const top of tops) nodes[top].high = begins[nodes[top].high] ?? NONE;
  return locatorOf(nodes.length, (i) => nodes[i], Uint32Array.from(entries), nCells);
}

function packedPlanes(r, nCells) {
  if (!r) return null;
  const slack = r.f64();
  const child = () => {
    const [kind, id] = [r.u32(), r.u32()];
    // No child is the root.
    return kind === 2 ? 0 : kind === 1 ? 2 ** 31 + id : id || NONE;
  };
  const nodes = Array.from({ length: r.count(48) }, () => ({ normal: r.point(3), offset: r.f64(), children: [child(), child()] }));
  return planesOf(slack, nodes, nCells);
}

function packedDoors(r, nObjects, nPortals) {
  const doors = [];
  for (let n = r ? r.count(3, r.varint) : 0; n > 0; n--) {
    const object = r.below(nObjects + 1, r.varint) - 1;
    const name = r.text(r.varint());
    doors.push({ name, object: object < 0 ? null : object, portals: [...r.ascending(nPortals)] });
  }
  return doors;
}

/** The parts of a table out of the bytes of a packed one. Throws a TableError if anything is wrong with it. */
export function readPacked(bytes) {
  const file = readFile(bytes);
  const { sections, isLarge } = file;
  const open = (id) => openSection(sections, id);
  const head = openSection(sections, "HEAD", true);
  const [d, nCells, nObjects, nPortals, , flags, , , , ...nClasses] = head.u32s(12);
  if (d !== 2 && d !== 3) throw head.fail(`a table has 2 or 3 dimensions, not ${d}`);
  const stores = readStores(bytes, file);
  const store = (id, n) => {
    const found = stores.get(id);
    if (found?.nRecords !== n) throw new TableError(`there are ${found?.nRecords ?? 0} records of ${id} instead of ${n}`);
    return found;
  };
  const eager = ["CELL", "PORT", "OBJS", "CNAM", "PLAC", ...(isLarge ? ["BOXS"] : [])].map((id) => stores.get(id));
  const sum = eager.reduce((all, one) => all + (one?.nBytes ?? 0), 0);
  if (sum > MOST_UNPACKED) throw new TableError(`the file claims ${sum} bytes, which is more than this reader takes`);

  const cells = packedCells(isLarge ? null : sections, isLarge ? store("BOXS", nCells) : null, d, nCells);
  if (stores.has("CNAM")) store("CNAM", nCells).all((r, i) => (cells[i].name = r.text(r.bytes.length)));
  const cellObjects = store("CELL", nCells).all((r, i) => {
    const group = r.varint();
    cells[i].group = group > 0 ? group - 1 : null;
    for (let n = r.count(2, r.varint); n > 0; n--) r.varint(), r.varint();
    return r.ascending(nObjects);
  });
  const portals = store("PORT", nPortals).all((r) => {
    const cells = [r.below(nCells, r.varint), r.below(nCells, r.varint)];
    r.varint(), r.varint();
    return { cells, points: readPoints(r, r.count(8 * d, r.varint), d) };
  });
  const sources = open("OSRC");
  const objects = store("OBJS", nObjects).all((r, id) => {
    const [min, max, polygons] = [r.point(d), r.point(d), r.varint()];
    const node = sources?.varint() || null;
    const primitive = node === null ? null : sources.varint();
    const name = r.text(r.bytes.length - r.at);
    return { id, name, min, max, polygons: flags & POLYGONS_KNOWN ? polygons : 0, node: node === null ? null : node - 1, primitive };
  });
  const rowsOf = (id, ids, nItems, [nRows, nColumns]) => {
    const rows = stores.get(id);
    if (!rows) throw new TableError(`the rows ${id} are missing`);
    return isLarge ? maskRows(rows, nCells, nItems) : classRows(sections, rows, ids, [nCells, nItems, nRows, nColumns]);
  };
  const info = openSection(sections, "INFO", true);
  const texts = Array.from({ length: info.count(2, info.varint) }, () => [info.text(info.varint()), info.text(info.varint())]);
  return {
    dimension: d,
    cells,
    portals,
    objects,
    cellObjects,
    rows: rowsOf("ROWS", ["CLAS", "CLAS"], nCells, [nClasses[0], nClasses[0]]),
    seen: flags & HAS_SEEN ? rowsOf("SEEN", ["SCLR", "SCLC"], nObjects, nClasses.slice(1)) : null,
    locator: isLarge ? pagedLocator(sections, store("PLAC", openSection(sections, "LOCT", true).u32s(2)[1]), d, nCells) : packedLocator(sections, d, nCells),
    planes: packedPlanes(open("PLAN"), nCells),
    frame: readFrame(open("FRAM")),
    doors: packedDoors(open("DOOR"), nObjects, nPortals),
    info: texts,
    ...readKind(open("KIND"), texts),
  };
}

/** Boxes and polygons of cells, from the sections of a small file or the store of a large one. */
function packedCells(sections, boxes, d, nCells) {
  const cell = (r, nCorners) => {
    const [min, max] = [r.point(d), r.point(d)];
    return { min, max, group: null, polygon: readPolygon(r, nCorners), name: null };
  };
  if (boxes) return boxes.all((r) => cell(r, (r.bytes.length - 16 * d) / 16));
  const r = openSection(sections, "BOXS", true);
  if (r.bytes.length !== 16 * d * nCells) throw r.fail("it has a wrong length");
  const cells = Array.from({ length: nCells }, () => cell(r, 0));
  const polygons = openSection(sections, "POLY");
  const starts = polygons?.u32s(nCells + 1);
  if (polygons) cells.forEach((cell, i) => (cell.polygon = readPolygon(polygons, starts[i + 1] - starts[i])));
  return cells;
}

function readPolygon(r, n) {
  const polygon = [];
  for (let k = 0; k < n; k++) polygon.push([r.f64(), r.f64()]);
  return polygon;
}
