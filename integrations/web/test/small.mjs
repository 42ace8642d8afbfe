// A small table in bytes, written by hand: three rooms in a row, of which the first and the last do not see each other.

import { crc32 } from "../../../crates/viewer/web/reader/bytes.js";

class Writer {
  constructor() {
    this.bytes = [];
  }

  u32(...list) {
    for (const x of list) this.bytes.push(x & 255, (x >>> 8) & 255, (x >>> 16) & 255, x >>> 24);
    return this;
  }

  f64(...list) {
    for (const x of list) this.bytes.push(...new Uint8Array(Float64Array.of(x).buffer));
    return this;
  }

  text(text) {
    const bytes = new TextEncoder().encode(text);
    this.u32(bytes.length);
    this.bytes.push(...bytes);
    return this;
  }
}

/** The bytes of a `.pvs` file of version 1.7. */
export function smallTable() {
  const cells = new Writer().u32(2, 3);
  for (let x = 0; x < 3; x++) cells.f64(x, 0, x + 1, 1).u32(0, 0);
  const portals = new Writer().u32(2);
  for (let x = 1; x < 3; x++) portals.u32(x - 1, x, 0, 0, 2).f64(x, 0.7, x, 0.3);
  const objects = new Writer().u32(3);
  ["chair", "lamp", "vase"].forEach((name, x) => objects.f64(x + 0.4, 0.4, x + 0.6, 0.6).text(name));
  const sections = {
    CELL: cells,
    PORT: portals,
    // The half of the rows up to the diagonal: 1, 11, 110.
    ROWS: new Writer().u32(1, 0, 3, 0, 6, 0),
    LOCA: new Writer().u32(1, 3, 0xffffffff, 3, 0, 0, 0, 1, 2),
    OBJS: objects,
    COBJ: new Writer().u32(1, 1, 1, 0, 1, 2),
    OSRC: new Writer().u32(4, 0, 4, 1, 0xffffffff, 0xffffffff),
    DOOR: new Writer().u32(1, 0).text("gate").u32(1, 0),
    INFO: new Writer().u32(0),
  };
  // The rows say that the middle room sees both others; objects are seen with the rooms that they are in, but for these.
  sections.SEEN = new Writer().u32(3, 0, 7, 0, 6, 0);
  const ids = Object.keys(sections);
  const out = new Writer();
  out.bytes.push(0x89, ...new TextEncoder().encode("PVS\r\n\x1a\n"), 1, 0, 7, 0);
  out.u32(ids.length);
  let at = 24 + 32 * ids.length + 8;
  const places = ids.map((id) => {
    const begin = at;
    at = 8 * Math.ceil((begin + sections[id].bytes.length) / 8);
    return begin;
  });
  out.u32(at, 0);
  ids.forEach((id, k) => {
    const { bytes } = sections[id];
    out.bytes.push(...new TextEncoder().encode(id));
    out.u32(0, places[k], 0, bytes.length, 0, crc32(Uint8Array.from(bytes)), 0);
  });
  // Optional sections are flagged; nothing here asks for the flag of known ones.
  for (const [k, id] of ids.entries()) if (["PORT", "SEEN", "OSRC", "DOOR"].includes(id)) out.bytes[24 + 32 * k + 4] = 1;
  out.u32(crc32(Uint8Array.from(out.bytes)), 0);
  ids.forEach((id, k) => {
    while (out.bytes.length < places[k]) out.bytes.push(0);
    out.bytes.push(...sections[id].bytes);
  });
  while (out.bytes.length < at) out.bytes.push(0);
  return Uint8Array.from(out.bytes);
}

/** Mends the checksums of blocks, which the section `BLKS` at `at` lists, as far as they are within `end`. */
function mendBlocks(view, bytes, { at, end, isLarge, first }) {
  let offset = first;
  const u32 = () => view.getUint32((at += 4) - 4, true);
  const mend = () => {
    const [length] = [u32(), u32()];
    if (offset + length <= bytes.length && at + 4 <= end) view.setUint32(at, crc32(bytes.subarray(offset, offset + length)), true);
    at += 4;
    offset += length;
  };
  const nStores = u32();
  for (let n = 0; n < nStores && at + 12 <= end; n++) {
    at += 4;
    const nRecords = u32();
    if (isLarge) continue;
    const nBlocks = Math.ceil(nRecords / u32());
    for (let k = 0; k < nBlocks && at + 12 <= end; k++) mend();
  }
  if (!isLarge || at + 4 > end) return;
  for (let n = u32(); n > 0 && at + 16 <= end; n--) {
    at += 4;
    mend();
  }
}

/** The same bytes with the checksums of blocks, of sections and of their table mended, as far as these can be found. */
export function crcRepaired(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const isPlain = bytes[3] === 0x53;
  const isLarge = !isPlain && bytes[8] === 2;
  const size = isPlain ? 32 : 24;
  const tail = bytes.length - 32;
  const n = view.getUint32(isLarge ? tail + 16 : 12, true);
  const table = isLarge ? tail - size * n : 24;
  if (n > 100 || table < 0 || table + size * n + 4 > bytes.length) return bytes;
  const placeOf = (at) => [view.getUint32(at + 8, true), view.getUint32(at + 16, true)];
  for (let i = 0, at = table; i < n; i++, at += size) {
    const [begin, length] = placeOf(at);
    const [last, lastLength] = placeOf(table + size * (n - 1));
    const isBlocks = String.fromCharCode(...bytes.subarray(at, at + 4)) === "BLKS";
    if (isBlocks && begin + length <= bytes.length) mendBlocks(view, bytes, { at: begin, end: begin + length, isLarge, first: isLarge ? 24 : last + lastLength });
  }
  for (let i = 0, at = table; i < n; i++, at += size) {
    const [offset, length] = placeOf(at);
    if (offset + length <= bytes.length) view.setUint32(at + (isPlain ? 24 : 20), crc32(bytes.subarray(offset, offset + length)), true);
  }
  if (isLarge) {
    const before = crc32(bytes.subarray(table, tail), crc32(bytes.subarray(0, 24)));
    view.setUint32(tail + 20, crc32(bytes.subarray(tail, tail + 20), before), true);
  } else {
    view.setUint32(table + size * n, crc32(bytes.subarray(0, table + size * n)), true);
  }
  return bytes;
}
