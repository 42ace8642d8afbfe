// What the page shows: the eye, what it may see, and how that is shown. No drawing, no elements.

class Model {
  constructor(table, figure, head) {
    this.table = table;
    this.figure = figure;
    this.head = head;
    this.up = table.up >= 0 ? table.up : table.dimension === 3 ? 1 : 2;
    this.eye = null;
    /** The cells at the eye, what they may see, and whether the eye is in no cell. */
    this.cells = [];
    this.visible = new Set();
    this.objects = new Set();
    this.isOutside = true;
    /** The eye whose set is kept while the camera flies on. */
    this.lock = null;
    this.chosen = null;
    /** What is explained, and what the page knows about reasons. */
    this.why = null;
    this.reasons = null;
    /** The eye-to-cell method that is shown, or null for the table alone; what it keeps; and where the view looks to on the map. */
    this.method = null;
    this.narrow = null;
    this.heading = 0;
    this.walk = null;
    this.heat = null;
    /** How far both move, where cells are coloured by how soon they may be seen; and the ways from the eye. */
    this.reach = null;
    this.soon = null;
    this.change = null;
    this.shows = { ghosts: false, cells: false, portals: false, isovist: false };
    /** The point of the map under the pointer, while isovists are shown. */
    this.pointer = null;
    this.bounds = boundsOf(table);
    this.size = Math.hypot(...[0, 1, 2].map((k) => this.bounds.max[k] - this.bounds.min[k])) || 1;
    this.height = (this.bounds.min[this.up] + this.bounds.max[this.up]) / 2;
    this.ceiling = Infinity;
    /** Whether the map or the scene is shown. */
    this.view = "map";
    this.reach = this.size / 20;
    this.shares = null;
    this.listeners = [];
  }

  /** Calls `listener` after every change. */
  onChange(listener) {
    this.listeners.push(listener);
  }

  changed() {
    for (const listener of this.listeners) listener();
  }

  /** Puts the eye at a point of the scene. While a set is kept, only the camera moves. */
  look(eye) {
    this.eye = eye;
    if (this.lock) return this.changed();
    const at = this.table.locate(eye);
    if (at.length !== this.cells.length || at.some((cell, k) => cell !== this.cells[k])) this.see(at);
    this.changed();
  }

  /** Shows what may be seen from these cells; from none, all. */
  see(at) {
    this.cells = at;
    this.isOutside = at.length === 0;
    const visible = this.table.visibleCells(at);
    this.visible = new Set(visible);
    this.objects = new Set(this.table.visibleObjects(at));
  }

  /** Puts the eye into the middle of a cell; where cells are not their boxes, shows its set all the same. */
  goTo(cell) {
    const { min, max, polygon } = this.table.cells[cell];
    let middle = min.map((x, k) => (x + max[k]) / 2);
    if (polygon.length > 0) {
      middle = [0, 1].map((k) => polygon.reduce((sum, p) => sum + p[k], 0) / polygon.length);
      middle.push(0);
    }
    if (this.table.dimension === 3) this.height = middle[this.up];
    this.lock = null;
    this.eye = this.table.toScene(middle);
    this.see(this.table.locate(this.eye).includes(cell) ? this.table.locate(this.eye) : [cell]);
    this.changed();
  }

  /** Keeps the set of the eye, or lets it go. */
  setLock(on) {
    this.lock = on && this.eye ? [...this.eye] : null;
    if (!this.lock && this.eye) this.see(this.table.locate(this.eye));
    this.changed();
  }

  colourOf(cell) {
    const colours = theme();
    if (this.change) {
      const found = this.change.stateOf(this.cells, cell);
      if (found > 0) return colours.gained;
      if (found < 0) return colours.lost;
    }
    if (this.why && this.why.to === cell && this.why.from !== cell) return colours.target;
    if (this.why && this.why.from === cell) return colours.from;
    if (this.cells.includes(cell)) return colours.from;
    if (this.heat && this.heat !== "soon") return heatColour(this.share(this.heat, cell));
    if (this.isOutside) return colours.paper;
    if (this.heat) {
      const way = this.ways()[cell];
      return way > this.reach ? colours.hidden : heatColour(1 - (0.8 * way) / this.reach);
    }
    if (this.narrow && !this.narrow.cells.has(cell) && this.visible.has(cell)) return colours.pale;
    return this.visible.has(cell) ? colours.seen : colours.hidden;
  }

  /** The state of each object, as the graphics device has it. */
  objectStates() {
    const n = Math.max(this.table.objects.length, this.figure?.nObjects() ?? 0);
    const states = new Uint8Array(n).fill(this.isOutside ? STATE.seen : STATE.hidden);
    if (this.narrow) for (const object of this.objects) states[object] = STATE.pale;
    for (const object of this.narrow?.objects ?? this.objects) states[object] = STATE.seen;
    // What belongs to no object of the table is always drawn.
    states.fill(STATE.seen, this.table.objects.length);
    if (this.chosen !== null && states[this.chosen] === STATE.seen) states[this.chosen] = STATE.chosen;
    return states;
  }

  /** How far a body in the middle of each cell, and one at the eye, have to move before there may be sight. */
  ways() {
    const eye = this.table.toTable(this.lock ?? this.eye);
    const key = eye.join(",");
    if (this.soon?.key !== key) this.soon = { key, ways: waysToSight(this.table, eye) };
    return this.soon.ways;
  }

  /** For each cell what share of the other cells it sees, and of all polygons; computed when it is first asked for. */
  measure() {
    if (this.shares) return this.shares;
    const { table } = this;
    const n = table.cells.length;
    const all = table.objects.reduce((sum, object) => sum + object.polygons, 0);
    const [cells, polygons] = [new Float64Array(n), new Float64Array(n)];
    for (let a = 0; a < n; a++) {
      const visible = table.visibleCells([a]);
      cells[a] = n > 1 ? (visible.length - 1) / (n - 1) : 0;
      const objects = all > 0 ? table.visibleObjects([a]) : [];
      polygons[a] = objects.reduce((sum, o) => sum + table.objects[o].polygons, 0) / (all || 1);
    }
    this.shares = { cells, polygons, hasPolygons: all > 0 };
    return this.shares;
  }

  /** The share of a cell, of the largest one. */
  share(kind, cell) {
    const shares = this.measure()[kind];
    this.largest ??= {};
    this.largest[kind] ??= shares.reduce((most, x) => Math.max(most, x), 0) || 1;
    return shares[cell] / this.largest[kind];
  }

  /** The cells of the storey of the eye: those at its height, or all in a plane. */
  storeyCells() {
    const { table, up } = this;
    const height = this.eye ? table.toTable(this.eye)[up] : this.height;
    return table.cells.flatMap(({ min, max }, cell) => (min[up] <= height && height <= max[up] ? [cell] : []));
  }

  storeyKey() {
    return this.storeyCells().join(",");
  }

  /** Cells and objects whose number or name has this text, the first few. */
  find(text, most) {
    const wanted = text.trim().toLowerCase();
    const found = [];
    if (wanted === "") return found;
    const fits = (id, name) => String(id) === wanted || (name ?? "").toLowerCase().includes(wanted);
    this.table.cells.forEach(({ name, group }, cell) => {
      const isGroup = group !== null && (wanted === `sector ${group}` || wanted === `group ${group}`);
      if (found.length < most && (fits(cell, name) || isGroup)) found.push({ kind: "cell", id: cell, name });
    });
    this.table.objects.forEach(({ name }, id) => {
      if (found.length < most && fits(id, name)) found.push({ kind: "object", id, name });
    });
    return found;
  }
}
