// The bytes of a `.pvs` file, as the module `format` of `sightlines-pvs` describes them.

import { crc32, Reader, TableError } from "./bytes.js";
import { locatorOf, planesOf } from "./table.js";
import { halfRows, wholeRows, wordsOf } from "./rows.js";

const PLAIN_MAGIC = "\x89PVS\r\n\x1a\n";
const PLAIN_MAJOR = 1;
export const NONE = 0xffffffff;
/** Sections that a reader may not pass over. */
const PLAIN_KNOWN = ["CELL", "ROWS", "LOCA", "OBJS", "COBJ", "FRAM", "INFO"];

/** Whether the bytes begin like a file. */
export function startsWith(bytes, magic) {
  return [...magic].every((c, i) => bytes[i] === c.charCodeAt(0));
}

/**
 * The major version of a file, at most `most`; of `most` itself in a packed file nothing more. Else how many sections there are, by a table with entries
 * of `size` bytes that is checked, and where it ends.
 */
export function readHead(bytes, size, most, isWhole = true) {
  const head = new Reader(bytes, "the file");
  head.skip(8);
  const versions = head.u32();
  const major = versions & 0xffff;
  if (major > most) throw new TableError(`the file has version ${major}.${versions >>> 16} of its format, and this reader knows version ${most}`);
  if (!isWhole && major === most) return { major };
  const n = head.u32();
  const stated = head.u32() + 2 ** 32 * head.u32();
  if (stated !== bytes.length) throw head.fail(`${bytes.length} bytes instead of ${stated}: it is cut off, or something follows it`);
  head.skip(size * n);
  const end = head.at;
  if (crc32(bytes.subarray(0, end)) !== head.u32()) throw head.fail("its table of sections is damaged");
  return { major, n, begin: head.at };
}

/**
 * The sections of a file by their names, of which the table begins at `at` and has entries of `size` bytes; all are checked against their
 * checksums, and by `next` against where they have to be. Unknown ones are refused, unless they are optional.
 */
export function readSections(bytes, { at, n, size, known, begin }) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const sections = new Map();
  const isWide = size === 32;
  // Sections of plain files begin at multiples of eight; what is between is zero.
  const pass = (end) => {
    const next = isWide ? 8 * Math.ceil(end / 8) : end;
    if (bytes.subarray(end, next).some((byte) => byte !== 0) || next > bytes.length) throw new TableError("what is between sections is damaged");
    return next;
  };
  begin = pass(begin);
  for (let i = 0; i < n; i++, at += size) {
    const id = String.fromCharCode(...bytes.subarray(at, at + 4));
    const offset = Number(view.getBigUint64(at + 8, true));
    const length = isWide ? Number(view.getBigUint64(at + 16, true)) : view.getUint32(at + 16, true);
    if (offset !== begin || !(length <= bytes.length - offset)) throw new TableError(`the section ${id} is not in its place`);
    if (view.getUint32(at + 4, true) !== 1 && !known.includes(id)) {
      throw new TableError(`the section ${id} is unknown to this reader: a newer version is needed`);
    }
    const section = bytes.subarray(offset, offset + length);
    if (crc32(section) !== view.getUint32(at + (isWide ? 24 : 20), true)) throw new TableError(`the section ${id} is damaged`);
    if (sections.has(id)) throw new TableError(`the section ${id} is there twice`);
    sections.set(id, section);
    begin = pass(offset + length);
  }
  return { sections, end: begin };
}

/** A reader of a section; null if there is none and it is not `needed`. */
export function openSection(sections, id, needed = false) {
  if (sections.has(id)) return new Reader(sections.get(id), `the section ${id}`);
  if (needed) throw new TableError(`the section ${id} is missing`);
  return null;
}

/** The parts of a table out of the bytes of a `.pvs` file. Throws a TableError if anything is wrong with it. */
export function readPlain(bytes) {
  if (!startsWith(bytes, PLAIN_MAGIC)) throw new TableError("this is no table of visibility");
  const { major, n, begin } = readHead(bytes, 32, PLAIN_MAJOR);
  if (major !== PLAIN_MAJOR) throw new TableError("version 0 of the format is unknown");
  const { sections } = readSections(bytes, { at: 24, n, size: 32, known: PLAIN_KNOWN, begin });
  const open = (id) => openSection(sections, id);
  const parts = readCells(openSection(sections, "CELL", true), open("POLY"), open("CNAM"));
  const { dimension: d, cells } = parts;
  parts.portals = readPortals(open("PORT"), d, cells.length);
  Object.assign(parts, readObjects(openSection(sections, "OBJS", true), openSection(sections, "COBJ", true), open("OPOL"), open("OSRC"), parts));
  const row = (id, length) => {
    const section = openSection(sections, id, id === "ROWS");
    if (section && section.bytes.length !== length) throw section.fail(`has ${section.bytes.length} bytes instead of ${length}`);
    return section?.bytes;
  };
  let half = 0;
  for (let i = 0; i < cells.length; i++) half += 8 * (Math.floor(i / 64) + 1);
  parts.rows = halfRows(row("ROWS", half), cells.length);
  const seen = row("SEEN", 4 * cells.length * wordsOf(parts.objects.length));
  parts.seen = seen ? wholeRows(seen, parts.objects.length) : null;
  parts.locator = readLocator(openSection(sections, "LOCA", true), cells.length, d);
  parts.planes = readPlanes(open("PLNS"), cells.length);
  parts.frame = readFrame(open("FRAM"));
  parts.doors = readDoors(open("DOOR"), parts);
  const info = openSection(sections, "INFO", true);
  parts.info = Array.from({ length: info.count(8) }, () => [info.text(), info.text()]);
  return Object.assign(parts, readKind(open("KIND"), parts.info));
}

function readCells(r, polygons, names) {
  const dimension = r.u32();
  if (dimension !== 2 && dimension !== 3) throw r.fail(`a table has 2 or 3 dimensions, not ${dimension}`);
  const cells = [];
  for (let n = r.count(16 * dimension + 8); n > 0; n--) {
    const [min, max] = [r.point(dimension), r.point(dimension)];
    const hasGroup = r.u32() === 1;
    const group = r.u32();
    cells.push({ min, max, group: hasGroup ? group : null, polygon: [], name: null });
  }
  r.finish();
  if (polygons) {
    const lengths = polygons.u32s(cells.length);
    cells.forEach((cell, i) => {
      for (let k = 0; k < lengths[i]; k++) cell.polygon.push([polygons.f64(), polygons.f64()]);
    });
    polygons.finish();
  }
  if (names) for (const cell of cells) cell.name = names.text();
  return { dimension, cells };
}

function readPortals(r, d, nCells) {
  const portals = [];
  for (let n = r ? r.count(20) : 0; n > 0; n--) {
    const cells = [r.below(nCells), r.below(nCells)];
    r.skip(8);
    portals.push({ cells, points: readPoints(r, r.count(8 * d), d) });
  }
  return portals;
}

/** The corners of a portal. */
export function readPoints(r, n, d) {
  if (n < d) throw r.fail(`a portal has ${n} corners`);
  return Array.from({ length: n }, () => r.point(d));
}

function readObjects(r, touching, polygons, sources, { dimension: d, cells }) {
  const objects = [];
  for (let n = r.count(16 * d + 4), id = 0; id < n; id++) {
    const [min, max] = [r.point(d), r.point(d)];
    objects.push({ id, name: r.text(), min, max, polygons: 0, node: null, primitive: null });
  }
  for (const object of objects) {
    if (polygons) object.polygons = polygons.u32();
    if (!sources) continue;
    const [node, primitive] = [sources.u32(), sources.u32()];
    if (node !== NONE) Object.assign(object, { node, primitive });
  }
  const lengths = touching.u32s(cells.length);
  const cellObjects = cells.map((_, i) => touching.u32s(lengths[i]));
  if (cellObjects.some((list) => list.some((object) => object >= objects.length))) throw touching.fail("there is no such object");
  return { objects, cellObjects };
}

function readLocator(r, nCells, d) {
  const [n, nEntries] = [r.u32(), r.u32()];
  const nodes = new Reader(r.bytes.subarray(r.skip(16 * n), r.at), r.place);
  const entries = r.u32s(nEntries);
  r.finish();
  let next = 0;
  const node = () => {
    const [tag, second, split] = [nodes.u32(), nodes.u32(), nodes.f64()];
    if (tag !== NONE) return { axis: tag < d ? tag : NONE, split, high: second };
    const first = next;
    next += second;
    return { axis: null, first, end: next };
  };
  return locatorOf(n, node, entries, nCells);
}

function readPlanes(r, nCells) {
  if (!r) return null;
  const slack = r.f64();
  const nodes = [];
  for (let n = r.count(40); n > 0; n--) nodes.push({ normal: r.point(3), offset: r.f64(), children: [r.u32(), r.u32()] });
  return planesOf(slack, nodes, nCells);
}

/** The axes and the gap of a frame; null if there is none. */
export function readFrame(r) {
  return r ? { axes: [r.point(3), r.point(3), r.point(3)], gap: r.f64() } : null;
}

function readDoors(r, { objects, portals }) {
  const doors = [];
  for (let n = r ? r.count(12) : 0; n > 0; n--) {
    const object = r.below(objects.length + 1) - 1;
    const name = r.text();
    const closes = r.u32s(r.count(4));
    if (closes.some((portal) => portal >= portals.length)) throw r.fail("there is no such portal");
    doors.push({ name, object: object < 0 ? null : object, portals: [...closes] });
  }
  return doors;
}

/** What kind of table it is, and which axis is up, -1 if that is not known. Files without the section say it in texts. */
export function readKind(r, info) {
  if (r) return { kind: r.u32(), up: (r.skip(4), r.u32() - 1) };
  const value = (key) => info.find(([k]) => k === key)?.[1] ?? "";
  const source = value("source");
  const kind = source.startsWith("portal file") ? 5 : source.startsWith("Quake map") ? 6 : 0;
  return { kind, up: value("up") === "" ? -1 : ["x", "y", "z"].indexOf(value("up")) };
}
