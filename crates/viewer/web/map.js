// The map: a plan, or the cells of a scene in space that a plane at a height cuts.

class FlatMap {
  constructor(canvas, model) {
    this.canvas = canvas;
    this.model = model;
    this.centre = [0, 0];
    this.scale = 1;
    this.fitted = false;
  }

  /** Two coordinates on the map, the second upwards, of a point along the axes of the table. */
  flat(p) {
    const { table, up } = this.model;
    if (table.dimension === 2) return [p[0], p[1]];
    return up === 1 ? [p[0], -p[2]] : up === 2 ? [p[0], p[1]] : [p[1], p[2]];
  }

  /** The point along the axes of the table at a place of the map, at the height of the map. */
  unflat([u, v]) {
    const { table, up, height } = this.model;
    if (table.dimension === 2) return [u, v, 0];
    return up === 1 ? [u, height, -v] : up === 2 ? [u, v, height] : [height, u, v];
  }

  /** The cells on the map, each as a polygon. */
  outlines() {
    const { table, up, height } = this.model;
    if (this.made && this.madeFor === height) return this.made;
    this.madeFor = height;
    this.made = [];
    table.cells.forEach(({ min, max, polygon }, cell) => {
      if (table.dimension === 3 && !(min[up] <= height && height <= max[up])) return;
      let points = polygon;
      if (polygon.length === 0) {
        const [[a, b], [c, d]] = [this.flat(min), this.flat(max)];
        points = [[a, b], [c, b], [c, d], [a, d]];
      }
      this.made.push({ cell, points });
    });
    this.walls = this.wallsAt(height);
    this.doors = this.doorsAt(height);
    return this.made;
  }

  wallsAt(height) {
    const { figure, table, up } = this.model;
    if (!figure) return null;
    if (table.dimension === 3) {
      return figure.cut(table, up, height).map(([p, q]) => [this.flat(p), this.flat(q)]);
    }
    const walls = [];
    const [x, y] = figure.origin;
    for (let i = 0; i < figure.walls.length; i += 4) {
      const w = figure.walls.subarray(i, i + 4);
      walls.push([[w[0] + x, w[1] + y], [w[2] + x, w[3] + y]]);
    }
    return walls;
  }

  /** Portals as segments on the map. */
  doorsAt(height) {
    const { table, up } = this.model;
    const doors = [];
    for (const { points } of table.portals) {
      if (table.dimension === 2) {
        doors.push(points.map((p) => this.flat(p)));
        continue;
      }
      const ends = [];
      points.forEach((p, k) => {
        const q = points[(k + 1) % points.length];
        const [h, g] = [p[up] - height, q[up] - height];
        if (h < 0 === g < 0) return;
        ends.push(p.map((x, i) => x + (h / (h - g)) * (q[i] - x)));
      });
      if (ends.length === 2) doors.push(ends.map((p) => this.flat(p)));
    }
    return doors;
  }

  fit() {
    const points = this.model.table.cells.flatMap(({ min, max }) => [this.flat(min), this.flat(max)]);
    const low = [Infinity, Infinity];
    const high = [-Infinity, -Infinity];
    for (const p of points) {
      for (const k of [0, 1]) {
        low[k] = Math.min(low[k], p[k]);
        high[k] = Math.max(high[k], p[k]);
      }
    }
    this.centre = [0, 1].map((k) => (low[k] + high[k]) / 2);
    const { clientWidth, clientHeight } = this.canvas;
    const size = [0, 1].map((k) => Math.max(high[k] - low[k], 1e-9));
    this.scale = 0.94 * Math.min(clientWidth / size[0], clientHeight / size[1]);
    this.fitted = true;
  }

  toScreen([u, v]) {
    const { clientWidth, clientHeight } = this.canvas;
    return [clientWidth / 2 + (u - this.centre[0]) * this.scale, clientHeight / 2 - (v - this.centre[1]) * this.scale];
  }

  /** Whether a point along the axes of the table is on the canvas. */
  isInView(p) {
    const [x, y] = this.toScreen(this.flat(p));
    return x >= 0 && y >= 0 && x <= this.canvas.clientWidth && y <= this.canvas.clientHeight;
  }

  fromScreen(x, y) {
    const { clientWidth, clientHeight } = this.canvas;
    return [
      this.centre[0] + (x - clientWidth / 2) / this.scale,
      this.centre[1] - (y - clientHeight / 2) / this.scale,
    ];
  }

  /** The point of the scene under a place of the canvas. */
  pick(x, y) {
    return this.model.table.toScene(this.unflat(this.fromScreen(x, y)));
  }

  pan(dx, dy) {
    this.centre = [this.centre[0] - dx / this.scale, this.centre[1] + dy / this.scale];
  }

  /** Zooms so that the place under the pointer stays there. */
  zoom(factor, x, y) {
    const before = this.fromScreen(x, y);
    this.scale *= factor;
    const after = this.fromScreen(x, y);
    this.centre = this.centre.map((c, k) => c + before[k] - after[k]);
  }

  goTo(p) {
    this.centre = this.flat(this.model.table.toTable(p));
  }

  draw() {
    const { canvas } = this;
    const ratio = window.devicePixelRatio || 1;
    canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (!this.fitted) this.fit();
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.paint(new CanvasPen(context), canvas.clientWidth, canvas.clientHeight);
  }

  /** The picture as SVG. */
  svg() {
    const { clientWidth, clientHeight } = this.canvas;
    const pen = new SvgPen(clientWidth, clientHeight);
    this.paint(pen, clientWidth, clientHeight);
    return pen.text();
  }

  paint(pen, width, height) {
    const colours = theme();
    const { model } = this;
    const onScreen = (points) => points.map((p) => this.toScreen(p));
    pen.fill([[0, 0], [width, 0], [width, height], [0, height]], colours.paper);
    for (const { cell, points } of this.outlines()) pen.fill(onScreen(points), model.colourOf(cell));
    this.paintIsovist(pen, colours);
    if (this.walls) {
      for (const wall of this.walls) pen.stroke(onScreen(wall), colours.wall, 1.2);
    } else {
      for (const { points } of this.outlines()) pen.stroke(onScreen([...points, points[0]]), colours.wall, 1.2);
    }
    if (model.shows.portals || !this.walls) {
      const [colour, width] = model.shows.portals ? [colours.portal, 2] : [colours.paper, 1];
      for (const door of this.doors) pen.stroke(onScreen(door), colour, width);
    }
    if (model.shows.cells && this.walls) {
      for (const { points } of this.outlines()) pen.stroke(onScreen([...points, points[0]]), colours.portal, 0.5);
    }
    const flatOf = (p) => this.toScreen(this.flat(model.table.toTable(p)));
    if (model.walk) pen.stroke(model.walk.frames.map((frame) => flatOf(frame.eye)), colours.line, 1);
    this.paintWhy(pen, colours);
    this.paintView(pen, colours);
    if (model.eye) pen.dot(flatOf(model.eye), 6, colours.from, colours.paper);
    if (model.lock) pen.dot(flatOf(model.lock), 6, colours.target, colours.paper);
  }

  /** What is seen from the point under the pointer, or from the eye. */
  paintIsovist(pen, colours) {
    const { model } = this;
    const at = model.pointer ?? model.eye;
    const isShown = model.shows.isovist && model.table.dimension === 2 && at;
    const { pieces, area } = isShown ? isovistAt(model.table, at) : { pieces: [], area: 0 };
    if (pieces.length > 0) pen.fillAll(pieces.map((piece) => piece.map((p) => this.toScreen(p))), colours.isovist);
    document.getElementById("area").textContent = pieces.length > 0 ? `area ${Number(area.toPrecision(5))}` : "";
  }

  /** The borders of the view, as far as they lie in the plane of the map. */
  paintView(pen, colours) {
    const { narrow, size } = this.model;
    if (!narrow) return;
    const { eye } = narrow.view;
    for (const ray of edgesOf(narrow.view, this.model.table.dimension)) {
      const end = eye.map((x, k) => x + (size * ray[k]) / Math.hypot(...ray));
      pen.stroke([this.toScreen(this.flat(eye)), this.toScreen(this.flat(end))], colours.from, 1);
    }
  }

  /** The line between two cells with the portals that it crosses, or what is in the way. */
  paintWhy(pen, colours) {
    const { why, table } = this.model;
    if (!why) return;
    const onMap = (p) => this.toScreen(this.flat(p));
    const portals = why.line?.portals ?? why.obstacle?.portals ?? [];
    for (const portal of portals) {
      const { points } = table.portals[portal];
      pen.stroke([...points, points[0]].map(onMap), why.line ? colours.portal : colours.lost, 3);
    }
    for (const { min, max } of why.obstacle?.walls ?? []) {
      const [[a, b], [c, d]] = [onMap(min), onMap(max)];
      pen.stroke([[a, b], [c, b], [c, d], [a, d], [a, b]], colours.lost, 3);
    }
    if (why.line?.ends[0]) {
      const places = placesOf(why.line).map(onMap);
      pen.stroke(places, colours.line, 2);
      for (const place of places.slice(1, -1)) pen.dot(place, 3, colours.line, colours.paper);
    }
  }
}

/** Draws on a canvas. */
class CanvasPen {
  constructor(context) {
    this.context = context;
  }
  path(points) {
    this.context.beginPath();
    points.forEach(([x, y], k) => (k ? this.context.lineTo(x, y) : this.context.moveTo(x, y)));
  }
  fill(points, colour) {
    this.path(points);
    this.context.closePath();
    this.context.fillStyle = colour;
    this.context.fill();
  }
  /** Polygons that touch, as one: no seam shows where their colour is transparent. */
  fillAll(polygons, colour) {
    this.context.beginPath();
    for (const points of polygons) {
      points.forEach(([x, y], k) => (k ? this.context.lineTo(x, y) : this.context.moveTo(x, y)));
      this.context.closePath();
    }
    this.context.fillStyle = colour;
    this.context.fill();
  }
  stroke(points, colour, width) {
    this.path(points);
    this.context.strokeStyle = colour;
    this.context.lineWidth = width;
    this.context.stroke();
  }
  dot([x, y], radius, colour, border) {
    this.context.beginPath();
    this.context.arc(x, y, radius, 0, 2 * Math.PI);
    this.context.fillStyle = colour;
    this.context.fill();
    this.context.strokeStyle = border;
    this.context.lineWidth = 2;
    this.context.stroke();
  }
}

/** Writes SVG. Only numbers and our own colours go into it, so nothing needs escaping. */
class SvgPen {
  constructor(width, height) {
    this.head = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}">`;
    this.parts = [];
  }
  points(points) {
    return points.map((p) => p.map((x) => x.toFixed(2)).join(",")).join(" ");
  }
  fill(points, colour) {
    this.parts.push(`<polygon points="${this.points(points)}" fill="${colour}"/>`);
  }
  fillAll(polygons, colour) {
    const path = polygons.map((points) => `M${this.points(points)}Z`).join("");
    this.parts.push(`<path d="${path}" fill="${colour}"/>`);
  }
  stroke(points, colour, width) {
    this.parts.push(
      `<polyline points="${this.points(points)}" fill="none" stroke="${colour}" stroke-width="${width}"/>`,
    );
  }
  dot([x, y], radius, colour, border) {
    this.parts.push(
      `<circle cx="${x.toFixed(2)}" cy="${y.toFixed(2)}" r="${radius}" fill="${colour}" stroke="${border}" stroke-width="2"/>`,
    );
  }
  text() {
    return `${this.head}\n${this.parts.join("\n")}\n</svg>\n`;
  }
}
