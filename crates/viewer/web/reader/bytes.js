// Numbers and texts out of bytes, each after a check that it is there.

/** What is wrong with a file, in words for its user. */
export class TableError extends Error {
  constructor(message) {
    super(message);
    this.name = "TableError";
  }
}

/** Reads little-endian fields one after the other. A TableError is thrown instead of reading past the end. */
export class Reader {
  /** `place` names the bytes in errors. */
  constructor(bytes, place = "the bytes") {
    this.bytes = bytes;
    this.place = place;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    this.at = 0;
  }

  fail(what) {
    return new TableError(`${this.place}: ${what}`);
  }

  /** Passes over `n` bytes; where they begin. */
  skip(n) {
    const at = this.at;
    if (n > this.bytes.length - at) throw this.fail(`cut off at byte ${at}`);
    this.at += n;
    return at;
  }

  u32() {
    return this.view.getUint32(this.skip(4), true);
  }

  f64() {
    return this.view.getFloat64(this.skip(8), true);
  }

  point(d) {
    const p = [0, 0, 0];
    for (let k = 0; k < d; k++) p[k] = this.f64();
    return p;
  }

  u32s(n) {
    let at = this.skip(4 * n);
    const list = new Uint32Array(n);
    for (let i = 0; i < n; i++, at += 4) list[i] = this.view.getUint32(at, true);
    return list;
  }

  /** Seven bits per byte, the low ones first. Numbers that a double cannot hold are refused. */
  varint() {
    let [x, scale] = [0, 1];
    for (;;) {
      const byte = this.bytes[this.skip(1)];
      x += (byte & 127) * scale;
      if (byte < 128) break;
      scale *= 128;
      if (scale > 2 ** 49) throw this.fail("a number is too large");
    }
    return x;
  }

  /** A number below `limit`, or else an error; read by `read`. */
  below(limit, read = this.u32) {
    const x = read.call(this);
    if (!(x < limit)) throw this.fail(`${x} is not below ${limit}`);
    return x;
  }

  /** The number of items that follow, of at least `size` bytes each: no more than there is room for. */
  count(size, read = this.u32) {
    const n = read.call(this);
    if (n * size > this.bytes.length - this.at) throw this.fail(`${n} items are more than there is room for`);
    return n;
  }

  /** Ascending numbers below `limit`, stored as their differences less one. */
  ascending(limit) {
    const list = new Uint32Array(this.count(1, this.varint));
    let next = 0;
    for (let i = 0; i < list.length; i++) {
      const x = next + this.varint();
      if (!(x < limit)) throw this.fail(`${x} is not below ${limit}`);
      list[i] = x;
      next = x + 1;
    }
    return list;
  }

  text(n = this.u32()) {
    const at = this.skip(n);
    try {
      return new TextDecoder("utf-8", { fatal: true, ignoreBOM: true }).decode(this.bytes.subarray(at, at + n));
    } catch {
      throw this.fail("a text is not in UTF-8");
    }
  }

  /** Checks that nothing is left. */
  finish() {
    if (this.at !== this.bytes.length) throw this.fail("something follows its end");
  }
}

let crcTable = null;

/** The CRC-32 of bytes, and of others before them whose CRC-32 is `before`. */
export function crc32(bytes, before = 0) {
  crcTable ??= Uint32Array.from({ length: 256 }, (_, i) => {
    for (let k = 0; k < 8; k++) i = i & 1 ? (i >>> 1) ^ 0xedb88320 : i >>> 1;
    return i;
  });
  let crc = ~before;
  for (let i = 0; i < bytes.length; i++) crc = crcTable[(crc ^ bytes[i]) & 255] ^ (crc >>> 8);
  return ~crc >>> 0;
}
