// A camera that flies, or goes round a point.

const VERTICAL_ANGLE = (65 * Math.PI) / 180;

class Camera {
  constructor(up) {
    this.up = up;
    this.eye = [0, 0, 0];
    this.yaw = 0;
    this.pitch = 0;
    this.near = 0.05;
    this.far = 1000;
    /** The point that the camera goes round; null if it flies. */
    this.pivot = null;
  }

  /** The two axes of the floor, so that they and the axis upwards are right-handed. */
  floor() {
    return [(this.up + 1) % 3, (this.up + 2) % 3];
  }

  direction() {
    const [a, b] = this.floor();
    const forward = [0, 0, 0];
    forward[a] = Math.cos(this.pitch) * Math.cos(this.yaw);
    forward[b] = Math.cos(this.pitch) * Math.sin(this.yaw);
    forward[this.up] = Math.sin(this.pitch);
    return forward;
  }

  right() {
    const [a, b] = this.floor();
    const right = [0, 0, 0];
    right[a] = Math.sin(this.yaw);
    right[b] = -Math.cos(this.yaw);
    return right;
  }

  turn(dx, dy) {
    const limit = Math.PI / 2 - 0.01;
    const distance = this.pivot ? Math.hypot(...this.pivot.map((x, k) => x - this.eye[k])) : 0;
    this.yaw -= dx;
    this.pitch = Math.min(Math.max(this.pitch - dy, -limit), limit);
    if (this.pivot) {
      const forward = this.direction();
      this.eye = this.pivot.map((x, k) => x - distance * forward[k]);
    }
  }

  /** Moves forward, to the right and upwards, in scene units. */
  move(ahead, aside, upwards) {
    const [forward, right] = [this.direction(), this.right()];
    this.eye = this.eye.map((x, k) => x + ahead * forward[k] + aside * right[k] + (k === this.up ? upwards : 0));
  }

  lookAt(p) {
    const away = p.map((x, k) => x - this.eye[k]);
    const length = Math.hypot(...away);
    if (length === 0) return;
    const [a, b] = this.floor();
    this.yaw = Math.atan2(away[b], away[a]);
    this.pitch = Math.asin(Math.min(Math.max(away[this.up] / length, -1), 1));
  }

  /** The matrix by columns from positions relative to an origin to clip space. */
  toClip(aspect, origin) {
    const [forward, right] = [this.direction(), this.right()];
    const upwards = [
      right[1] * forward[2] - right[2] * forward[1],
      right[2] * forward[0] - right[0] * forward[2],
      right[0] * forward[1] - right[1] * forward[0],
    ];
    const f = 1 / Math.tan(VERTICAL_ANGLE / 2);
    const { near, far } = this;
    const depth = [(far + near) / (far - near), (-2 * far * near) / (far - near)];
    const eye = this.eye.map((x, k) => x - origin[k]);
    const row = (axis, scale) => [...axis.map((x) => x * scale), -scale * dot3(axis, eye)];
    const rows = [row(right, f / aspect), row(upwards, f), row(forward, depth[0]), row(forward, 1)];
    rows[2][3] += depth[1];
    const matrix = new Float32Array(16);
    rows.forEach((values, r) => values.forEach((x, c) => (matrix[4 * c + r] = x)));
    return matrix;
  }
}

/** Directions along the edges of a view, around it; in a plan there are two. */
function edgesOf(view, dimension) {
  const ahead = unit3([0, 1, 2].map((k) => view.sides.reduce((sum, side) => sum + side[k], 0)));
  const [left, right, below, above] = view.sides;
  const edges = dimension === 2
    ? [left, right].map((side) => [side[1], -side[0], 0])
    : [[left, below], [right, below], [right, above], [left, above]].map(([a, b]) => cross3(a, b));
  // One unit ahead.
  return edges.map((edge) => edge.map((x) => x / dot3(edge, ahead)));
}
