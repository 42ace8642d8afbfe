// Rows of bits, in words of 32.

/** Words that are kept of rows which had to be put together: 64 MB. */
const MOST_WORDS = 2 ** 24;

/** Words of a row of so many bits: an even number, as files have words of 64. */
export function wordsOf(n) {
  return 2 * Math.ceil(n / 64);
}

/** The numbers of the bits that are set, ascending. */
export function ones(words) {
  const list = [];
  for (let i = 0; i < words.length; i++) {
    for (let rest = words[i]; rest !== 0; rest &= rest - 1) list.push(32 * i + 31 - Math.clz32(rest & -rest));
  }
  return list;
}

export function hasBit(words, i) {
  return ((words[i >>> 5] >>> (i & 31)) & 1) === 1;
}

export function setBit(words, i) {
  words[i >>> 5] |= 1 << (i & 31);
}

/** Clears what a row has past its last bit. */
export function clearPast(words, n) {
  if (n & 31) words[n >>> 5] &= (1 << (n & 31)) - 1;
  words.fill(0, Math.ceil(n / 32));
  return words;
}

/** Little-endian bytes as words. A copy, where they do not begin at a multiple of four. */
export function asWords(bytes) {
  const whole = bytes.byteOffset % 4 === 0 ? bytes : bytes.slice();
  return new Uint32Array(whole.buffer, whole.byteOffset, bytes.length >> 2);
}

/** Rows that `make` puts together when they are asked for; they are kept until they take too much memory. */
export class Rows {
  constructor(n, make) {
    this.nWords = wordsOf(n);
    this.make = make;
    this.kept = new Map();
  }

  row(i) {
    let row = this.kept.get(i);
    if (!row) {
      row = this.make(i);
      if ((this.kept.size + 1) * this.nWords > MOST_WORDS) this.kept.clear();
      this.kept.set(i, row);
    }
    return row;
  }

  /** What is in the row of any of these: the row itself if it is one. Not to be written to. */
  union(of) {
    if (of.length === 1) return this.row(of[0]);
    const words = new Uint32Array(this.nWords);
    for (const i of of) {
      const row = this.row(i);
      for (let k = 0; k < words.length; k++) words[k] |= row[k];
    }
    return words;
  }
}

/** The rows of a symmetric matrix of which there is the half below the diagonal, in words of 64 up to that of the diagonal. */
export function halfRows(bytes, n) {
  const half = asWords(bytes);
  const begin = (row) => {
    const full = Math.floor(row / 64);
    return 64 * full * (full + 1) + 2 * (row - 64 * full) * (full + 1);
  };
  const rows = new Rows(n, (i) => {
    const row = new Uint32Array(rows.nWords);
    row.set(half.subarray(begin(i), begin(i + 1)));
    clearPast(row, i + 1);
    for (let j = i + 1; j < n; j++) if ((half[begin(j) + (i >>> 5)] >>> (i & 31)) & 1) setBit(row, j);
    return row;
  });
  return rows;
}

/** Whole rows of so many bits, one after the other. */
export function wholeRows(bytes, n) {
  const all = asWords(bytes);
  const rows = new Rows(n, (i) => clearPast(all.slice(i * rows.nWords, (i + 1) * rows.nWords), n));
  return rows;
}
