// Unpacks Zstandard frames (RFC 8878) whose size is known, without dictionaries. Checksums of content are not looked at: files have their own.

import { TableError } from "../../../crates/viewer/web/reader/bytes.js";

const ZSTD_MAGIC = 0xfd2fb528;
/** Bits after the codes of literals' lengths and of matches' lengths. Each code begins where the one before ends. */
const LITERAL_BITS = [...Array(16).fill(0), 1, 1, 1, 1, 2, 2, 3, 3, 4, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16];
const MATCH_BITS = [...Array(32).fill(0), 1, 1, 1, 1, 2, 2, 3, 3, 4, 4, 5, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16];
const LITERAL_BASES = bases(LITERAL_BITS, 0);
const MATCH_BASES = bases(MATCH_BITS, 3);
/** The kinds of tables of a sequence: predefined counts, and the largest logarithm of a table and code. */
const KINDS = [
  { log: 6, most: 9, counts: [4, 3, ...Array(11).fill(2), 1, 1, 1, ...Array(9).fill(2), 3, 2, 1, 1, 1, 1, 1, -1, -1, -1, -1] },
  { log: 5, most: 8, counts: [...Array(6).fill(1), 2, 2, 2, ...Array(15).fill(1), -1, -1, -1, -1, -1] },
  { log: 6, most: 9, counts: [1, 4, 3, ...Array(6).fill(2), ...Array(37).fill(1), ...Array(7).fill(-1)] },
];
const N_CODES = [36, 32, 53];
/** The largest code of an offset: more bits are no offset within what may be unpacked. */
const MOST_OFFSET_BITS = 25;

function bases(bits, first) {
  return bits.map((_, code) => bits.slice(0, code).reduce((sum, n) => sum + 2 ** n, first));
}

/** What is wrong with it in particular helps nobody. */
function broken() {
  return new TableError("a packed block is broken");
}

/** Bits from the end of bytes to their beginning, from the highest one that is set. Before the beginning all are 0. */
class BackBits {
  constructor(bytes) {
    const last = bytes[bytes.length - 1];
    if (!last) throw broken();
    this.bytes = bytes;
    this.left = 8 * bytes.length - 1 - Math.clz32(last) + 24;
  }

  /** The next `n` bits, at most 25, which stay. */
  peek(n) {
    const { bytes } = this;
    const at = this.left - n;
    if (at < 0) return this.left <= 0 ? 0 : ((bytes[0] | (bytes[1] << 8) | (bytes[2] << 16) | (bytes[3] << 24)) & ((1 << this.left) - 1)) << -at;
    const i = at >> 3;
    return ((bytes[i] | (bytes[i + 1] << 8) | (bytes[i + 2] << 16) | (bytes[i + 3] << 24)) >>> (at & 7)) & ((1 << n) - 1);
  }

  read(n) {
    const bits = this.peek(n);
    this.left -= n;
    return bits;
  }
}

/** Reads the counts of a table of FSE, and says where they end. */
function readCounts(bytes, most, nCodes) {
  let at = 0;
  const read = (n) => {
    let bits = 0;
    for (let k = 0; k < n; k++, at++) bits |= ((bytes[at >> 3] >> (at & 7)) & 1) << k;
    if (at > 8 * bytes.length) throw broken();
    return bits;
  };
  const log = 5 + read(4);
  if (log > most) throw broken();
  const counts = [];
  let left = 1 << log;
  while (left > 0) {
    if (counts.length >= nCodes) throw broken();
    const n = 32 - Math.clz32(left + 1);
    // The low numbers take a bit less.
    let count = read(n - 1);
    const short = (1 << n) - 2 - left;
    if (count >= short) {
      if (read(1)) count += (1 << (n - 1)) - short;
    }
    counts.push(count - 1);
    left -= Math.abs(count - 1);
    for (let more = count === 1 ? 3 : 0; more === 3; ) {
      more = read(2);
      for (let k = 0; k < more; k++) counts.push(0);
    }
  }
  if (left < 0 || counts.length > nCodes) throw broken();
  return { log, counts, size: (at + 7) >> 3 };
}

/** A table of FSE: for each state its code, and the bits and the base of the next one. */
function fseTable({ log, counts }) {
  const size = 1 << log;
  const [codes, bits, nexts] = [new Uint8Array(size), new Uint8Array(size), new Uint16Array(size)];
  let high = size;
  counts.forEach((count, code) => count < 0 && (codes[--high] = code));
  let at = 0;
  counts.forEach((count, code) => {
    for (let k = 0; k < count; k++) {
      codes[at] = code;
      do at = (at + (size >> 1) + (size >> 3) + 3) & (size - 1);
      while (at >= high);
    }
  });
  const next = counts.map(Math.abs);
  codes.forEach((code, state) => {
    const n = next[code]++;
    bits[state] = log - 31 + Math.clz32(n);
    nexts[state] = (n << bits[state]) - size;
  });
  return { log, codes, bits, nexts };
}

/** The table of a Huffman tree whose description begins the bytes, and how many bytes that takes. */
function readHuffman(bytes) {
  const head = bytes[0];
  const weights = [];
  let size = 1;
  if (head >= 128) {
    for (let k = 0; k < head - 127; k++) weights.push((bytes[1 + (k >> 1)] >> (k & 1 ? 0 : 4)) & 15);
    size += (head - 126) >> 1;
  } else {
    size += head;
    const fse = readCounts(bytes.subarray(1, size), 6, 13);
    const table = fseTable(fse);
    const stream = new BackBits(bytes.subarray(1 + fse.size, size));
    const states = [stream.read(table.log), stream.read(table.log)];
    // Two states take turns; when the bits of one are used up, the other still has a code.
    for (let k = 0; ; k ^= 1) {
      if (weights.length > 253) throw broken();
      weights.push(table.codes[states[k]]);
      states[k] = table.nexts[states[k]] + stream.read(table.bits[states[k]]);
      if (stream.left < 0) {
        weights.push(table.codes[states[k ^ 1]]);
        break;
      }
    }
  }
  if (size > bytes.length) throw broken();
  const sum = weights.reduce((all, weight) => all + (weight && 2 ** (weight - 1)), 0);
  const log = 32 - Math.clz32(sum);
  const rest = 2 ** log - sum;
  if (sum === 0 || log > 11 || rest & (rest - 1)) throw broken();
  weights.push(32 - Math.clz32(rest));
  const [leaves, bits] = [new Uint8Array(1 << log), new Uint8Array(1 << log)];
  let at = 0;
  for (let weight = 1; weight <= log; weight++) {
    weights.forEach((own, leaf) => {
      if (own !== weight) return;
      const end = at + (1 << (weight - 1));
      leaves.fill(leaf, at, end);
      bits.fill(log + 1 - weight, at, end);
      at = end;
    });
  }
  return { log, leaves, bits, size };
}

function decodeHuffman({ log, leaves, bits }, bytes, out) {
  const stream = new BackBits(bytes);
  for (let i = 0; i < out.length; i++) {
    const next = stream.peek(log);
    out[i] = leaves[next];
    stream.left -= bits[next];
  }
  if (stream.left !== 0) throw broken();
}

/** What one frame keeps from block to block. */
class Frame {
  constructor(out) {
    this.out = out;
    this.at = 0;
    this.huffman = null;
    this.tables = [null, null, null];
    this.offsets = [1, 4, 8];
  }

  put(bytes) {
    if (bytes.length > this.out.length - this.at) throw broken();
    this.out.set(bytes, this.at);
    this.at += bytes.length;
  }

  /** The literals of a block, and how many bytes they take. */
  literals(b) {
    const [kind, form] = [b[0] & 3, (b[0] >> 2) & 3];
    const bits = (from, n) => Math.floor((b[0] + 2 ** 8 * b[1] + 2 ** 16 * b[2] + 2 ** 24 * b[3] + 2 ** 32 * (b[4] ?? 0)) / 2 ** from) % 2 ** n;
    if (kind < 2) {
      const head = form === 1 ? 2 : form === 3 ? 3 : 1;
      const n = head === 1 ? b[0] >> 3 : bits(4, 8 * head - 4);
      if (n > 2 ** 17) throw broken();
      const size = head + (kind === 1 ? 1 : n);
      if (!(size <= b.length)) throw broken();
      return { literals: kind === 1 ? new Uint8Array(n).fill(b[head]) : b.subarray(head, size), size };
    }
    const width = [10, 10, 14, 18][form];
    const head = [3, 3, 4, 5][form];
    const n = bits(4, width);
    const size = head + bits(4 + width, width);
    if (!(size <= b.length && n <= 2 ** 17)) throw broken();
    let packed = b.subarray(head, size);
    if (kind === 2) {
      this.huffman = readHuffman(packed);
      packed = packed.subarray(this.huffman.size);
    }
    if (!this.huffman) throw broken();
    const literals = new Uint8Array(n);
    if (form === 0) {
      decodeHuffman(this.huffman, packed, literals);
      return { literals, size };
    }
    const part = (n + 3) >> 2;
    let begin = 6;
    for (let k = 0; k < 4; k++) {
      const end = k < 3 ? begin + packed[2 * k] + 256 * packed[2 * k + 1] : packed.length;
      if (!(begin < end && end <= packed.length) || 3 * part > n) throw broken();
      decodeHuffman(this.huffman, packed.subarray(begin, end), literals.subarray(k * part, k < 3 ? (k + 1) * part : n));
      begin = end;
    }
    return { literals, size };
  }

  block(b) {
    const { literals, size } = this.literals(b);
    let at = size;
    let n = b[at++];
    if (n >= 128) n = n < 255 ? (n - 128) * 256 + b[at++] : b[at++] + 256 * b[at++] + 0x7f00;
    if (n === 0) return this.put(literals);
    const modes = b[at++];
    for (const [k, kind] of KINDS.entries()) {
      const mode = (modes >> (6 - 2 * k)) & 3;
      if (mode === 0) this.tables[k] = fseTable(kind);
      if (mode === 1) {
        if (!(b[at] < N_CODES[k])) throw broken();
        this.tables[k] = { log: 0, codes: [b[at++]], bits: [0], nexts: [0] };
      }
      if (mode === 2) {
        const read = readCounts(b.subarray(at), kind.most, N_CODES[k]);
        this.tables[k] = fseTable(read);
        at += read.size;
      }
      if (!this.tables[k]) throw broken();
    }
    return this.sequences(n, new BackBits(b.subarray(at)), literals);
  }

  sequences(n, stream, literals) {
    const { out } = this;
    const [lengths, offsets, matches] = this.tables;
    let a = stream.read(lengths.log);
    let b = stream.read(offsets.log);
    let c = stream.read(matches.log);
    let used = 0;
    let { at } = this;
    for (let i = 0; i < n; i++) {
      const ll = lengths.codes[a];
      const ml = matches.codes[c];
      const of = offsets.codes[b];
      if (of > MOST_OFFSET_BITS) throw broken();
      const value = (1 << of) + stream.read(of);
      const length = MATCH_BASES[ml] + stream.read(MATCH_BITS[ml]);
      const end = used + LITERAL_BASES[ll] + stream.read(LITERAL_BITS[ll]);
      if (i + 1 < n) {
        a = lengths.nexts[a] + stream.read(lengths.bits[a]);
        c = matches.nexts[c] + stream.read(matches.bits[c]);
        b = offsets.nexts[b] + stream.read(offsets.bits[b]);
      }
      const offset = this.offset(value, end === used);
      if (stream.left < 0 || end > literals.length || end - used + length > out.length - at) throw broken();
      while (used < end) out[at++] = literals[used++];
      if (!(offset > 0 && offset <= at)) throw broken();
      // Byte by byte: a match may go on into what it writes.
      for (const until = at + length; at < until; at++) out[at] = out[at - offset];
    }
    if (stream.left !== 0) throw broken();
    this.at = at;
    this.put(literals.subarray(used));
  }

  /** An offset by its value: a new one, or one of the last three, which then comes first. */
  offset(value, isBare) {
    const { offsets } = this;
    if (value > 3) {
      offsets[2] = offsets[1];
      offsets[1] = offsets[0];
      return (offsets[0] = value - 3);
    }
    const k = value - (isBare ? 0 : 1);
    const offset = k === 3 ? offsets[0] - 1 : offsets[k];
    if (k > 1) offsets[2] = offsets[1];
    if (k > 0) offsets[1] = offsets[0];
    return (offsets[0] = offset);
  }
}

/** Unpacks one frame of so many bytes. Throws a TableError if it is anything else. */
export function unpackZstd(bytes, size) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 6 || view.getUint32(0, true) !== ZSTD_MAGIC) throw broken();
  const head = bytes[4];
  if (head & 11) throw broken();
  const isSingle = (head & 32) !== 0;
  let at = 5 + (isSingle ? 0 : 1) + [isSingle ? 1 : 0, 2, 4, 8][head >> 6];
  const frame = new Frame(new Uint8Array(size));
  for (let isLast = false; !isLast; ) {
    if (at + 3 > bytes.length) throw broken();
    const header = bytes[at] | (bytes[at + 1] << 8) | (bytes[at + 2] << 16);
    const [kind, n] = [(header >> 1) & 3, header >> 3];
    isLast = (header & 1) === 1;
    at += 3;
    const taken = kind === 1 ? 1 : n;
    if (at + taken > bytes.length || n > Math.max(size, 2 ** 17)) throw broken();
    const content = bytes.subarray(at, at + taken);
    at += taken;
    if (kind === 0) frame.put(content);
    else if (kind === 1) frame.put(new Uint8Array(n).fill(content[0]));
    else if (kind === 2) frame.block(content);
    else throw broken();
  }
  if (at + (head & 4 ? 4 : 0) !== bytes.length) throw broken();
  if (frame.at !== size) throw broken();
  return frame.out;
}
