// What is drawn beside the table: triangles of a scene in space, or walls of a plan.

class Figure {
  /** `head` says how much there is; `bytes` has it: see `figure.rs`. */
  constructor(head, bytes) {
    this.origin = head.origin;
    this.notice = head.notice;
    const take = (make, n) => {
      const list = new make(bytes.buffer, bytes.byteOffset + at, n);
      at += 4 * n;
      return list;
    };
    let at = 0;
    /** Four numbers for a wall of a plan, from the origin. */
    this.walls = take(Float32Array, 4 * head.walls);
    /** Three numbers for a vertex, from the origin. */
    this.vertices = take(Float32Array, 3 * head.vertices);
    this.triangles = take(Uint32Array, 3 * head.triangles);
    /** The first triangle of each object, and the end. */
    this.firsts = take(Uint32Array, head.objects > 0 ? head.objects + 1 : 0);
  }

  nObjects() {
    return Math.max(this.firsts.length - 1, 0);
  }

  nTriangles(object) {
    return object < this.nObjects() ? this.firsts[object + 1] - this.firsts[object] : 0;
  }

  vertex(i) {
    return [0, 1, 2].map((k) => this.vertices[3 * i + k] + this.origin[k]);
  }

  /** The segments in which a plane at a height cuts the triangles, as pairs of points along the axes of the table. */
  cut(table, up, height) {
    const segments = [];
    const n = this.triangles.length / 3;
    const corners = [null, null, null];
    for (let t = 0; t < n; t++) {
      for (let k = 0; k < 3; k++) corners[k] = table.toTable(this.vertex(this.triangles[3 * t + k]));
      const ends = [];
      for (let k = 0; k < 3; k++) {
        const [p, q] = [corners[k], corners[(k + 1) % 3]];
        const [h, g] = [p[up] - height, q[up] - height];
        if (h < 0 === g < 0) continue;
        const s = h / (h - g);
        ends.push(p.map((x, i) => x + s * (q[i] - x)));
      }
      if (ends.length === 2) segments.push(ends);
    }
    return segments;
  }
}
