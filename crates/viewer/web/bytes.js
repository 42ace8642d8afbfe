// Bytes that the page carries: deflated, in base64, in elements that are never executed.

/** The bytes of the element with this id, inflated; null if the page has none. */
async function carriedBytes(id) {
  const element = document.getElementById(id);
  if (!element) return null;
  const text = atob(element.textContent.trim());
  element.remove();
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Reads little-endian fields one after the other, and never past the end: a RangeError is thrown there. */
class Reader {
  constructor(bytes) {
    this.bytes = bytes;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    this.at = 0;
  }
  u32() {
    const x = this.view.getUint32(this.at, true);
    this.at += 4;
    return x;
  }
  f64() {
    const x = this.view.getFloat64(this.at, true);
    this.at += 8;
    return x;
  }
  point(d) {
    const p = [0, 0, 0];
    for (let k = 0; k < d; k++) p[k] = this.f64();
    return p;
  }
  u32s(n) {
    const list = new Uint32Array(n);
    for (let i = 0; i < n; i++) list[i] = this.u32();
    return list;
  }
  text() {
    const n = this.u32();
    const text = new TextDecoder().decode(this.bytes.subarray(this.at, this.at + n));
    this.at += n;
    return text;
  }
}
