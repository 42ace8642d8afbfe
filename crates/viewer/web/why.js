// Why two cells see each other, or do not: lines through portals, each for all the cells that it passes, and reasons.

class Reasons {
  /** Reads what `reasons.rs` wrote. */
  constructor(table, bytes) {
    this.table = table;
    const r = new Reader(bytes);
    const [nLines, nHidden] = [r.u32(), r.u32()];
    const lengths = r.u32s(nLines);
    this.lines = [...lengths].map((n) => ({ cells: r.u32s(n + 1) }));
    this.lines.forEach((line, i) => (line.portals = r.u32s(lengths[i])));
    this.hidden = new Map();
    const withWalls = [];
    for (let i = 0; i < nHidden; i++) {
      const [a, b, kind, n] = [r.u32(), r.u32(), r.u32(), r.u32()];
      const reason = { kind: ["not connected", "portals", "walls"][kind], portals: kind === 1 ? [...r.u32s(n)] : [], walls: [] };
      if (kind === 2) withWalls.push([reason, n]);
      this.hidden.set(`${a},${b}`, reason);
    }
    for (const line of this.lines) {
      const ends = [r.point(3), r.point(3)];
      line.ends = Number.isNaN(ends[0][0]) ? null : ends;
    }
    for (const [reason, n] of withWalls) {
      for (let k = 0; k < n; k++) reason.walls.push({ min: r.point(3), max: r.point(3) });
    }
    /** For each cell the lines that pass it, in order. */
    this.through = table.cells.map(() => []);
    this.lines.forEach((line, i) => line.cells.forEach((cell) => this.through[cell].push(i)));
  }

  /** The line from one cell to another: its cells, portals, where it crosses them, and its two ends; null if there is none here. */
  line(from, to) {
    const others = new Set(this.through[to]);
    const shared = this.through[from].filter((i) => others.has(i)).map((i) => this.lines[i]);
    // The line that was found for this very pair comes first.
    const isOwn = ({ cells }) => [[from, to], [to, from]].some(([a, b]) => cells[0] === a && cells.at(-1) === b);
    const line = shared.find(isOwn) ?? shared[0];
    if (!line) return null;
    const [i, j] = [line.cells.indexOf(from), line.cells.indexOf(to)];
    const [low, high] = [Math.min(i, j), Math.max(i, j)];
    const cells = [...line.cells.subarray(low, high + 1)];
    const portals = [...line.portals.subarray(low, high)];
    const points = portals.map((portal) => this.crossing(line, portal));
    const ends = [this.between(line, low - 1), this.between(line, high - 1)];
    const part = { cells, portals, points, ends, isOwn: isOwn(line) };
    if (i > j) for (const list of [cells, portals, points, ends]) list.reverse();
    return part;
  }

  /** Where a line crosses a portal, rounded; null if it has no known points. */
  crossing(line, portal) {
    if (!line.ends) return null;
    const { points } = this.table.portals[portal];
    const [a, b] = line.ends;
    const step = b.map((x, k) => x - a[k]);
    const normal = this.table.dimension === 2 ? [points[0][1] - points[1][1], points[1][0] - points[0][0], 0] : normalOf(points);
    const middle = [0, 1, 2].map((k) => points.reduce((sum, p) => sum + p[k], 0) / points.length);
    const share = dot3(normal, middle.map((x, k) => x - a[k])) / dot3(normal, step);
    return Number.isFinite(share) ? a.map((x, k) => x + share * step[k]) : null;
  }

  /** A point of a line in the cell behind a portal of it: an end, or halfway to the next. */
  between(line, portal) {
    if (!line.ends) return null;
    if (portal < 0) return line.ends[0];
    if (portal === line.portals.length - 1) return line.ends[1];
    const [p, q] = [portal, portal + 1].map((k) => this.crossing(line, line.portals[k]));
    return p && q ? p.map((x, k) => (x + q[k]) / 2) : p;
  }

  /** Why a hidden pair is hidden; null if it is not here. */
  obstacle(from, to) {
    return this.hidden.get(`${Math.min(from, to)},${Math.max(from, to)}`) ?? null;
  }
}

/** What is known about two cells: whether the table lists them, and the line or the obstacle where the page has it. */
function explainCells(model, from, to) {
  const { table, reasons } = model;
  const isSeen = table.sees(from, to);
  const line = isSeen && from !== to ? (reasons?.line(from, to) ?? null) : null;
  const obstacle = isSeen ? null : (reasons?.obstacle(from, to) ?? null);
  return { from, to, isSeen, line, obstacle, object: null };
}

/** The same for a cell and an object: by one of the cells that the object touches. */
function explainObject(model, from, object) {
  const { table } = model;
  const around = table.cells.flatMap((_, cell) => (table.cellObjects[cell].includes(object) ? [cell] : []));
  const isSeen = table.visibleObjects([from]).includes(object);
  const all = around.map((cell) => explainCells(model, from, cell));
  const fits = all.filter((why) => why.isSeen === isSeen);
  const best = fits.find((why) => why.to === from || why.line || why.obstacle) ?? fits[0] ?? all[0];
  return { ...(best ?? { from, to: from, line: null, obstacle: null }), isSeen, object, around };
}

/** The places that are drawn of a line: its ends, and where it crosses portals. */
function placesOf(line) {
  return [line.ends[0], ...line.points, line.ends[1]].filter((p) => p !== null);
}
