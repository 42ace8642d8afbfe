// Starts the page: reads what it carries, and ties the pictures to pointer, touch and keys.

/** The angle of view on the map. */
const MAP_ANGLE = (75 * Math.PI) / 180;

class App {
  constructor(model) {
    this.model = model;
    this.flatCanvas = document.getElementById("flat");
    this.spaceCanvas = document.getElementById("space");
    this.map = new FlatMap(this.flatCanvas, model);
    this.space = null;
    this.view = "map";
    this.held = new Set();
    this.pending = false;
    const actions = {
      savePng: () => this.savePng(),
      saveSvg: () => this.save(new Blob([this.map.svg()], { type: "image/svg+xml" }), "view.svg"),
      goToCell: (cell) => this.goToCell(cell),
      chooseObject: (object) => this.chooseObject(object),
      explain: (from, to) => this.explain(from, to),
      compareMethods: () => this.compareMethods(),
      endWhy: () => this.endWhy(),
      explainObject: (from, object) => this.explainObject(from, object),
    };
    this.panel = new Panel(model, actions);
    model.onChange(() => this.redraw());
    this.bindPointer(this.flatCanvas);
    this.bindPointer(this.spaceCanvas);
    this.bindKeys();
    document.getElementById("fit").addEventListener("click", () => {
      this.frameAll();
      this.redraw();
    });
    document.getElementById("ask").addEventListener("click", ({ currentTarget }) => {
      this.isAsking = !this.isAsking;
      currentTarget.setAttribute("aria-pressed", String(this.isAsking));
    });
    document.getElementById("view-space").addEventListener("click", () => this.setView("space"));
    document.getElementById("view-map").addEventListener("click", () => this.setView("map"));
    new ResizeObserver(() => this.redraw()).observe(document.getElementById("stage"));
    darkPage.addEventListener("change", () => this.redraw());
    window.addEventListener("hashchange", () => this.openLink(location.hash));
  }

  /** Shows the scene in space, or the map. */
  setView(view) {
    if (view === "space" && !this.space) {
      try {
        this.space = new Space(this.spaceCanvas, this.model);
        this.frameAll();
        this.enter();
      } catch (error) {
        this.notice(String(error.message));
        return;
      }
    }
    this.view = view;
    this.model.view = view;
    this.panel.showHeight();
    this.flatCanvas.hidden = view !== "map";
    this.spaceCanvas.hidden = view !== "space";
    document.getElementById("view-space").setAttribute("aria-pressed", String(view === "space"));
    document.getElementById("view-map").setAttribute("aria-pressed", String(view === "map"));
    this.redraw();
  }

  /** Puts the camera where all of the scene is in view. */
  frameAll() {
    const { model } = this;
    this.map.fitted = false;
    if (!this.space) return;
    if (model.lock && model.ceiling === Infinity) {
      // From outside, the ceiling would hide the place that is kept.
      const [eye, tops] = [model.table.toTable(model.lock), model.cells.map((cell) => model.table.cells[cell].max[model.up])];
      if (tops.length > 0) model.ceiling = 0.25 * eye[model.up] + 0.75 * Math.max(...tops);
      this.panel.showHeight();
    }
    const { camera } = this.space;
    const middle = model.table.toScene([0, 1, 2].map((k) => (model.bounds.min[k] + model.bounds.max[k]) / 2));
    camera.near = model.size / 5000;
    camera.far = model.size * 4;
    camera.yaw = 0.8;
    camera.pitch = -0.6;
    camera.pivot = null;
    const forward = camera.direction();
    camera.eye = middle.map((x, k) => x - 0.9 * model.size * forward[k]);
  }

  /** Puts the camera where the eye is, looking ahead, to where there is most to see. */
  enter() {
    const { model, space } = this;
    if (!model.eye || model.isOutside || model.lock) return;
    const { camera } = space;
    camera.eye = [...model.eye];
    const at = model.table.toTable(model.eye);
    const level = (p) => p.map((x, k) => (k === model.up ? at[k] : x));
    const middle = ({ min, max }) => level(min.map((x, k) => (x + max[k]) / 2));
    const far = (p) => Math.hypot(...p.map((x, k) => x - at[k]));
    const farthest = [...model.visible].map((cell) => middle(model.table.cells[cell])).reduce((a, b) => (far(b) > far(a) ? b : a), at);
    if (far(farthest) > 0) camera.lookAt(model.table.toScene(farthest));
  }

  notice(text) {
    const box = document.getElementById("notice");
    box.textContent = text ?? "";
    box.hidden = !text;
  }

  /** Draws once before the next frame, however often it is called. */
  redraw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.drawNow();
    });
  }

  /** The view of the viewer, along the axes of the table: the camera's in space, and one to the heading on the map. */
  currentView() {
    const { model } = this;
    const { table, up } = model;
    const vertical = table.toTable(axisVector(up));
    if (this.view === "space") {
      const { clientWidth, clientHeight } = this.spaceCanvas;
      const aspect = Math.max(clientWidth, 1) / Math.max(clientHeight, 1);
      const fov = 2 * Math.atan(Math.tan(VERTICAL_ANGLE / 2) * aspect);
      return View.picture(table, vertical, table.toTable(model.eye), table.toTable(this.space.camera.direction()), fov, aspect);
    }
    const at = this.map.flat(table.toTable(model.eye));
    const ahead = this.map.unflat([at[0] + Math.cos(model.heading), at[1] + Math.sin(model.heading)]);
    const from = this.map.unflat(at);
    return View.picture(table, vertical, table.toTable(model.eye), ahead.map((x, k) => x - from[k]), MAP_ANGLE, 4 / 3);
  }

  /** Narrows the set of the cell to that of the viewer. A kept set stays as it is. */
  narrow() {
    const { model } = this;
    const isKept = model.lock !== null && model.narrow !== null && model.narrow.method === model.method;
    if (isKept) return;
    model.narrow = null;
    if (!model.method || !model.eye || model.isOutside) return;
    const view = this.currentView();
    model.narrow = { method: model.method, view, ...lookBy(model.table, model.cells, model.method, view) };
  }

  /** What each method keeps, now. */
  compareMethods() {
    const { model } = this;
    if (!model.eye || model.isOutside) return [];
    return this.keptBy(model.lock && model.narrow ? model.narrow.view : this.currentView());
  }

  keptBy(view) {
    return METHODS.map((method) => ({ method, ...lookBy(this.model.table, this.model.cells, method, view) }));
  }

  /** The isovist of a point of a plan: its pieces and their area; for scripts that look at the page. */
  isovistAt(point) {
    return isovistAt(this.model.table, point);
  }

  /** What each method keeps of a view from a point of the scene. Angles in radians, the horizontal one; for scripts that look at the page. */
  methodsAt(eye, direction, fov, aspect) {
    const { model } = this;
    const { table } = model;
    model.look(eye);
    const up = table.toTable(axisVector(model.up));
    return this.keptBy(View.picture(table, up, table.toTable(eye), table.toTable(direction), fov, aspect));
  }

  drawNow() {
    this.narrow();
    if (this.view === "space") this.space.draw();
    else this.map.draw();
    clearTimeout(this.linkTimer);
    this.linkTimer = setTimeout(() => {
      history.replaceState(null, "", writeLink(this.model, this.view, this.space?.camera));
    }, 300);
  }

  goToCell(cell) {
    const { model } = this;
    model.goTo(cell);
    this.map.goTo(model.eye);
    if (this.space) this.space.camera.eye = [...model.eye];
  }

  /** Marks an object; the panel says what it is. */
  chooseObject(object) {
    this.model.chosen = object;
    this.model.changed();
  }

  explain(from, to) {
    this.showWhy(explainCells(this.model, from, to));
  }

  explainObject(from, object) {
    this.showWhy(explainObject(this.model, from, object));
  }

  endWhy() {
    this.model.why = null;
    this.panel.showWhy(null);
    this.model.changed();
  }

  showWhy(why) {
    this.model.why = why;
    this.panel.showWhy(why);
    const { min } = this.model.table.cells[why.to];
    if (!this.map.isInView(min)) this.map.fitted = false;
    this.model.changed();
  }

  bindPointer(canvas) {
    const pointers = new Map();
    let moved = 0;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.focus({ preventScroll: true });
      canvas.setPointerCapture?.(event.pointerId);
      pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
      moved = 0;
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) {
        this.hover(event.offsetX, event.offsetY);
        return;
      }
      const now = [event.offsetX, event.offsetY];
      const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
      moved += Math.abs(dx) + Math.abs(dy);
      if (pointers.size === 2) {
        const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
        const length = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
        this.zoom(length(now) / length(before), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
      } else {
        this.drag(dx, dy);
      }
      pointers.set(event.pointerId, now);
    });
    const end = (event) => {
      if (pointers.delete(event.pointerId) && event.type === "pointerup" && moved < 6) {
        this.click(event.offsetX, event.offsetY, event);
      }
    };
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY / 500), event.offsetX, event.offsetY);
    }, { passive: false });
  }

  drag(dx, dy) {
    if (this.view === "map") this.map.pan(dx, dy);
    else {
      this.space.camera.turn(dx / 250, dy / 250);
      this.follow();
    }
    this.redraw();
  }

  zoom(factor, x, y) {
    if (this.view === "map") this.map.zoom(factor, x, y);
    else {
      this.space.camera.move(Math.log(factor) * this.model.size * 0.15, 0, 0);
      this.follow();
    }
    this.redraw();
  }

  /** The pointer moves over the map with no button down. */
  hover(x, y) {
    if (!this.model.shows.isovist || this.view !== "map") return;
    this.model.pointer = this.map.pick(x, y);
    this.redraw();
  }

  click(x, y, event) {
    if (this.view === "map") {
      const at = this.map.pick(x, y);
      const [here, there] = [this.model.cells[0], this.model.table.locate(at)[0]];
      if ((event?.shiftKey || this.isAsking) && here !== undefined) {
        this.notice(there === undefined ? "No cell is there." : null);
        if (there !== undefined) this.explain(here, there);
        return;
      }
      this.endWhy();
      this.model.look(at);
      if (this.space && !this.model.lock) this.space.camera.eye = [...this.model.eye];
    } else {
      const object = this.space.pick(x, y);
      this.chooseObject(object);
      const [here] = this.model.cells;
      const isAsked = (event?.shiftKey || this.isAsking) && here !== undefined && object !== null;
      if (isAsked && object < this.model.table.objects.length) this.explainObject(here, object);
    }
  }

  /** The eye is where the camera is. */
  follow() {
    this.model.look([...this.space.camera.eye]);
  }

  bindKeys() {
    const held = this.held;
    const isText = (target) => target instanceof HTMLInputElement && target.type !== "checkbox" && target.type !== "range";
    window.addEventListener("keydown", (event) => {
      if (isText(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.target instanceof HTMLSelectElement || document.getElementById("keys").open) return;
      const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
      const toggle = { l: "lock", g: "ghosts", c: "cells", p: "portals", i: "isovist" }[key];
      if (toggle) document.getElementById(toggle).click();
      else if (key === "?") document.getElementById("keys").showModal();
      else if (key === "m" && this.model.table.dimension === 3) this.setView(this.view === "map" ? "space" : "map");
      else if (key === "f") this.frameAll();
      else if (key === "Escape") this.endWhy();
      else if (key === "o") this.toggleOrbit();
      else if (key === "/") document.getElementById("find").focus();
      else if (!this.isMove(key, event.target)) return;
      event.preventDefault();
      held.add(key);
      held.fast = event.shiftKey;
      this.redraw();
      if (this.isMove(key, event.target)) this.walkOn();
    });
    window.addEventListener("keyup", (event) => {
      held.delete(event.key.length === 1 ? event.key.toLowerCase() : event.key);
    });
    window.addEventListener("blur", () => held.clear());
  }

  isMove(key, target) {
    if (["w", "a", "s", "d", "q", "e"].includes(key)) return true;
    const isPicture = target instanceof HTMLCanvasElement || target === document.body;
    return isPicture && ["ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight", "+", "-", "="].includes(key);
  }

  toggleOrbit() {
    if (this.view !== "space") return;
    const { camera } = this.space;
    const forward = camera.direction();
    camera.pivot = camera.pivot ? null : camera.eye.map((x, k) => x + 0.3 * this.model.size * forward[k]);
    this.notice(camera.pivot ? "Going round the point in front; O flies again." : null);
  }

  /** Moves as long as a key is held. */
  walkOn() {
    if (this.walking) return;
    this.walking = true;
    let last = performance.now();
    const step = (now) => {
      const seconds = Math.min((now - last) / 1000, 0.1) || 1 / 60;
      last = now;
      if (!this.moveBy(seconds)) {
        this.walking = false;
        return;
      }
      requestAnimationFrame(step);
    };
    // The first step is made at once, so that a key that is tapped moves too.
    this.moveBy(1 / 30);
    requestAnimationFrame(step);
  }

  /** Whether a key that moves is held. */
  moveBy(seconds) {
    const { held, model } = this;
    const on = (...keys) => keys.some((key) => held.has(key));
    const axis = (plus, minus) => Number(on(...plus)) - Number(on(...minus));
    const ahead = axis(["w"], ["s"]);
    const aside = axis(["d"], ["a"]);
    const upwards = axis(["e"], ["q"]);
    const [across, along] = [axis(["ArrowRight"], ["ArrowLeft"]), axis(["ArrowUp"], ["ArrowDown"])];
    const near = axis(["+", "="], ["-"]);
    if (!ahead && !aside && !upwards && !across && !along && !near) return false;
    const speed = seconds * (held.fast ? 4 : 1);
    if (this.view === "map") {
      const { clientWidth, clientHeight } = this.flatCanvas;
      if (near) this.map.zoom(Math.exp(near * seconds), clientWidth / 2, clientHeight / 2);
      const from = model.eye ? this.map.flat(model.table.toTable(model.eye)) : [...this.map.centre];
      const length = (speed * 160) / this.map.scale;
      const to = [from[0] + (across + aside) * length, from[1] + (along + ahead) * length];
      if (across || along || ahead || aside) model.look(model.table.toScene(this.map.unflat(to)));
    } else {
      const length = speed * model.size * 0.08;
      this.space.camera.turn(-across * seconds * 1.5, -along * seconds * 1.2);
      this.space.camera.move(ahead * length, aside * length, upwards * length);
      this.follow();
    }
    this.redraw();
    return true;
  }

  savePng() {
    this.drawNow();
    const canvas = this.view === "space" ? this.spaceCanvas : this.flatCanvas;
    canvas.toBlob((blob) => this.save(blob, "view.png"), "image/png");
  }

  save(blob, name) {
    const link = element("a", { href: URL.createObjectURL(blob), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  openLink(text) {
    const link = readLink(text);
    const { model } = this;
    if (link.heat) {
      model.heat = link.heat;
      if (link.reach > 0) model.reach = link.reach;
      document.getElementById("heat").value = link.heat;
    }
    if (link.view) this.setView(model.table.dimension === 3 ? link.view : "map");
    if (this.space && link.yaw !== null) this.space.camera.yaw = link.yaw;
    if (this.space && link.pitch !== null) this.space.camera.pitch = link.pitch;
    if (link.lock || link.isLocked) {
      model.lock = null;
      model.look(link.lock ?? link.eye ?? model.eye ?? [0, 0, 0]);
      model.setLock(true);
    }
    if (link.cell !== null && link.cell >= 0 && link.cell < model.table.cells.length) this.goToCell(link.cell);
    if (link.why?.every((cell) => cell < model.table.cells.length)) this.explain(...link.why);
    if (link.eye) {
      if (model.table.dimension === 3 && !model.lock) model.height = model.table.toTable(link.eye)[model.up];
      model.look(link.eye);
      if (this.space) this.space.camera.eye = [...link.eye];
    }
  }
}

/** The extent of a cell: its area in a plane, or its volume. */
function extentOf(table, cell) {
  const { min, max } = table.cells[cell];
  return [0, 1, 2].slice(0, table.dimension).reduce((size, k) => size * (max[k] - min[k]), 1);
}

/** The height at which most cells are: that of a storey. */
function storeyHeight({ table, up }) {
  const ends = table.cells.flatMap(({ min, max }) => [[min[up], 1], [max[up], -1]]);
  ends.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  let [n, most, height] = [0, 0, 0];
  ends.forEach(([at, step], k) => {
    n += step;
    if (step > 0 && n > most) [most, height] = [n, (at + ends[k + 1][0]) / 2];
  });
  return height;
}

/** The cell where the page opens: the largest in a plane; in space, at the height of most cells, the largest of those that see no more than most do. */
function home(model) {
  const { table, up } = model;
  const largest = (cells) => cells.reduce((best, cell) => (extentOf(table, cell) > extentOf(table, best) ? cell : best), cells[0]);
  const all = table.cells.map((_, cell) => cell);
  if (table.dimension === 2) return largest(all);
  const height = storeyHeight(model);
  const storey = all.filter((cell) => table.cells[cell].min[up] <= height && height <= table.cells[cell].max[up]);
  // Of very many cells, some.
  const there = storey.filter((_, k) => k % Math.ceil(storey.length / 2000) === 0);
  const seen = new Map(there.map((cell) => [cell, table.visibleCells([cell]).length]));
  const median = [...seen.values()].sort((a, b) => a - b)[there.length >> 1];
  return largest(there.filter((cell) => seen.get(cell) <= median));
}

async function start() {
  const head = JSON.parse(document.getElementById("head").textContent);
  const table = new Table(readPlain(await carriedBytes("table")));
  const shapes = await carriedBytes("figure");
  const model = new Model(table, shapes ? new Figure(head.figure, shapes) : null, head);
  const older = await carriedBytes("against");
  const reasons = await carriedBytes("reasons");
  if (reasons) model.reasons = new Reasons(table, reasons);
  if (older) model.change = new Change(table, new Table(readPlain(older)));
  if (head.walk) model.walk = new Walk(table, head.walk);
  document.title = `${head.title} – sightlines`;
  document.getElementById("title").textContent = head.title;
  const app = new App(model);
  bindWalk(model, (frame) => {
    model.lock = null;
    if (app.space) {
      app.space.camera.eye = [...frame.eye];
      app.space.camera.lookAt(frame.eye.map((x, k) => x + frame.dir[k]));
    }
    model.look(frame.eye);
  });
  app.notice(head.figure?.notice ?? (table.hasPlaces ? null : "This table does not store where its cells are."));
  // A link says where the eye is; without one it is in a room, on the map.
  const isAtHome = location.hash.length <= 1 && table.hasPlaces && table.cells.length > 0;
  if (table.dimension === 3) model.height = storeyHeight(model);
  app.setView(table.dimension === 3 && !isAtHome ? "space" : "map");
  if (isAtHome) app.goToCell(home(model));
  else if (location.hash.length > 1) app.openLink(location.hash);
  model.changed();
  window.sightlines = app;
  return app;
}

/** Resolves when the page is ready; for scripts that look at it. */
window.ready = start().catch((error) => {
  const box = document.getElementById("notice");
  box.textContent = `This page cannot be shown: ${error.message}`;
  box.hidden = false;
  throw error;
});
