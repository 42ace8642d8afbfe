// The panel beside the picture. Every text of the scene goes in as text, never as markup.

/** What each method keeps. */
const METHOD_HELP = {
  "cell-to-cell": "all that the table lists for the cell",
  "disjoint-cell": "cells whose box the view meets",
  "connected-component": "those reached through such cells",
  "incident-portals": "those reached through portals in view",
  exact: "those that a line from the eye leads to",
};

function element(name, properties = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key.startsWith("aria-") || key === "role" || key === "for") made.setAttribute(key, value);
    else made[key] = value;
  }
  made.append(...children);
  return made;
}

function percent(share) {
  return `${(100 * share).toFixed(share < 0.1 ? 2 : 1)} %`;
}

function counted(n, noun) {
  return `${n.toLocaleString("en")} ${noun}${n === 1 ? "" : "s"}`;
}

/** A point of the table in words, in the scene's coordinates. */
function placeText(table, p) {
  return `(${table.toScene(p).slice(0, table.dimension).map((x) => Number(x.toFixed(2))).join(", ")})`;
}

class Panel {
  constructor(model, actions) {
    this.model = model;
    this.actions = actions;
    this.bind("lock", "change", (input) => model.setLock(input.checked));
    this.bind("ghosts", "change", (input) => this.show("ghosts", input.checked));
    this.bind("cells", "change", (input) => this.show("cells", input.checked));
    this.bind("portals", "change", (input) => this.show("portals", input.checked));
    this.bind("isovist", "change", (input) => {
      model.pointer = null;
      this.show("isovist", input.checked);
    });
    this.bind("heat", "change", (input) => {
      model.heat = input.value === "none" ? null : input.value;
      model.changed();
    });
    // Short ways have most of the slider.
    this.bind("reach", "input", (input) => {
      model.reach = Math.max(Number(input.value) ** 3, 1e-6) * model.size;
      model.changed();
    });
    this.bind("find", "input", (input) => this.listFound(input.value));
    this.bind("ceiling", "input", (input) => this.setCeiling(Number(input.value)));
    this.bind("png", "click", () => actions.savePng());
    this.bind("svg", "click", () => actions.saveSvg());
    this.bind("help", "click", () => document.getElementById("keys").showModal());
    this.bind("why-ask", "click", () => this.ask());
    this.bind("why-here", "click", () => {
      if (model.cells.length > 0) document.getElementById("why-from").value = model.cells[0];
    });
    this.bind("why-end", "click", () => actions.endWhy());
    this.bind("numbers", "toggle", (details) => details.open && this.showNumbers());
    this.bind("methods", "toggle", () => this.showMethods());
    this.bind("heading", "input", (input) => {
      model.heading = (Number(input.value) * Math.PI) / 180;
      model.changed();
    });
    const inSpace = model.table.dimension === 3;
    for (const name of document.querySelectorAll(".space-only")) name.hidden = !inSpace;
    for (const name of document.querySelectorAll(".plan-only")) name.hidden = inSpace;
    this.showChange();
    model.onChange(() => this.refresh());
  }

  bind(id, event, action) {
    const found = document.getElementById(id);
    found?.addEventListener(event, () => action(found));
  }

  show(what, on) {
    this.model.shows[what] = on;
    this.model.changed();
  }

  /** Cuts the scene at a share of its height, or moves the map there. */
  setCeiling(share) {
    const { model } = this;
    const [low, high] = [model.bounds.min[model.up], model.bounds.max[model.up]];
    if (model.view === "map") model.height = low + Math.min(share, 0.999) * (high - low);
    else model.ceiling = share >= 1 ? Infinity : low + share * (high - low);
    model.changed();
  }

  refresh() {
    const { model } = this;
    document.getElementById("lock").checked = model.lock !== null;
    this.showObject();
    this.showHeight();
    document.getElementById("brief").textContent = model.why ? document.getElementById("why-text").textContent : "";
    for (const legend of document.querySelectorAll(".keys")) {
      legend.hidden = legend.id === "marks" ? model.why === null : (model.heat !== null) !== (legend.id === "scale");
    }
    const [low, high] = darkPage.matches ? ["dark", "light"] : ["light", "dark"];
    const isSoon = model.heat === "soon";
    document.getElementById("scale").textContent = isSoon
      ? this.soonText(low, high)
      : `${low}: few, ${high}: many`;
    document.getElementById("reach-row").hidden = !isSoon;
    document.getElementById("reach-text").textContent = `${Number(model.reach.toPrecision(3))}${this.unit()}`;
    document.getElementById("reach").value = Math.cbrt(model.reach / model.size);
    document.getElementById("here").textContent = this.hereText();
    this.showMethods();
    const list = document.getElementById("seen");
    const shown = [...model.objects].slice(0, 60);
    list.replaceChildren(...shown.map((o) => this.objectButton(o)));
    const rest = model.objects.size - shown.length;
    if (rest > 0) list.append(element("li", {}, `and ${counted(rest, "object")} more`));
  }

  /** What the colours of ways to sight say, and how many cells stay out of sight. */
  soonText(low, high) {
    const { model } = this;
    if (model.isOutside) return "Outside of all cells nothing is known: anybody may see this place.";
    const hidden = model.ways().reduce((n, way) => n + Number(way > model.reach), 0);
    const share = percent(hidden / model.table.cells.length);
    return `${high}: at once, ${low}: after that way, grey: not within it (${counted(hidden, "cell")}, ${share})`;
  }

  unit() {
    return this.model.table.info.find(([key]) => key === "unit")?.[1] === "metre" ? " m" : "";
  }

  /** Names the chosen object, and says whether it is seen. */
  showObject() {
    const { model } = this;
    const { chosen } = model;
    const under = document.getElementById("under");
    if (chosen === null || chosen >= model.table.objects.length) {
      under.textContent = "";
      return;
    }
    const { name, polygons } = model.table.objects[chosen];
    const triangles = model.figure ? model.figure.nTriangles(chosen) : polygons;
    const isSeen = model.isOutside || (model.narrow?.objects ?? model.objects).has(chosen);
    const isListed = model.isOutside || model.objects.has(chosen);
    const verdict = isSeen ? "may be seen" : isListed ? "may be seen from this cell, but not in this view" : "is hidden";
    under.textContent = `Object ${chosen} (${name}), ${counted(triangles, "triangle")}, ${verdict}. `;
    if (model.cells.length > 0) {
      const ask = () => this.actions.explainObject(model.cells[0], chosen);
      under.append(element("button", { type: "button", onclick: ask }, "Why?"));
    }
  }

  /** The slider says where the map is, or where the scene is cut. */
  showHeight() {
    const { model } = this;
    const [low, high] = [model.bounds.min[model.up], model.bounds.max[model.up]];
    const onMap = model.view === "map";
    const height = onMap ? model.height : Math.min(model.ceiling, high);
    const unit = this.unit();
    document.getElementById("ceiling").value = (height - low) / (high - low || 1);
    document.getElementById("ceiling-text").textContent = `${onMap ? "map" : "cut"} at a height of ${height.toFixed(2)}${unit}`;
    document.getElementById("heading-text").textContent = `${Math.round((model.heading * 180) / Math.PI)}°`;
  }

  hereText() {
    const { model } = this;
    const { table } = model;
    if (!model.eye && model.cells.length === 0) {
      return "On the map, a click puts the eye there. In space it is where you are: fly with W, A, S and D.";
    }
    if (model.isOutside) return "The eye is outside every cell: nothing is known there, so everything is drawn.";
    const names = model.cells.map((cell) => this.cellText(cell)).join(" and ");
    const parts = [`${model.lock ? "Kept: the eye was" : "The eye is"} in ${names}.`];
    parts.push(`From there ${model.visible.size} of ${counted(table.cells.length, "cell")} may be seen`);
    if (table.objects.length > 0) parts.push(`and ${model.objects.size} of ${counted(table.objects.length, "object")}`);
    const text = `${parts.join(" ")}.`;
    if (!model.narrow) return text;
    const { cells, objects, method } = model.narrow;
    return `${text} The viewer sees ${cells.size} of these cells and ${objects.size} of these objects in this view (${method}).`;
  }

  cellText(cell) {
    const { name, group } = this.model.table.cells[cell];
    const label = name ?? (group === null ? null : `group ${group}`);
    return label === null ? `cell ${cell}` : `cell ${cell} (${label})`;
  }

  objectButton(id) {
    const { name } = this.model.table.objects[id];
    const choose = () => this.actions.chooseObject(id);
    return element("li", {}, element("button", { type: "button", onclick: choose }, `${id} ${name}`));
  }

  listFound(text) {
    const found = this.model.find(text, 40);
    const list = document.getElementById("found");
    list.replaceChildren(
      ...found.map(({ kind, id, name }) => {
        const act = kind === "cell" ? () => this.actions.goToCell(id) : () => this.actions.chooseObject(id);
        return element("li", {}, element("button", { type: "button", onclick: act }, `${kind} ${id} ${name ?? ""}`));
      }),
    );
    document.getElementById("n-found").textContent = text.trim() === "" ? "" : `${found.length} found`;
  }

  /** Asks why for the two places of the fields. */
  ask() {
    const numberIn = (id, n) => {
      const text = document.getElementById(id).value.trim();
      return /^\d+$/.test(text) && Number(text) < n ? Number(text) : null;
    };
    const { cells, objects } = this.model.table;
    const toObject = document.getElementById("why-kind").value === "object";
    const n = toObject ? objects.length : cells.length;
    const [from, to] = [numberIn("why-from", cells.length), numberIn("why-to", n)];
    if (from === null || to === null) {
      const kinds = [`Cells have the numbers from 0 to ${cells.length - 1}`];
      if (objects.length > 0) kinds.push(`objects from 0 to ${objects.length - 1}`);
      document.getElementById("why-text").textContent = `${kinds.join(", ")}.`;
      return;
    }
    if (toObject) this.actions.explainObject(from, to);
    else this.actions.explain(from, to);
  }

  /** Says why in words: the way door by door, or what is in the way. */
  showWhy(why) {
    const [text, way] = ["why-text", "why-way"].map((id) => document.getElementById(id));
    way.replaceChildren();
    document.getElementById("why-end").hidden = !why;
    if (!why) {
      text.textContent = "";
      return;
    }
    document.getElementById("why").open = true;
    document.getElementById("why-from").value = why.from;
    document.getElementById("why-kind").value = why.object === null ? "cell" : "object";
    document.getElementById("why-to").value = why.object ?? why.to;
    const words = this.whyText(why);
    text.textContent = words[0].toUpperCase() + words.slice(1);
    const step = (cell, words) => {
      const go = () => this.actions.goToCell(cell);
      return element("li", {}, element("button", { type: "button", onclick: go }, words));
    };
    if (why.line) {
      const { cells, portals, points } = why.line;
      const at = (p) => (p ? ` at ${placeText(this.model.table, p)}` : "");
      way.append(step(cells[0], `from ${this.cellText(cells[0])}`));
      portals.forEach((portal, k) => {
        way.append(step(cells[k + 1], `through portal ${portal}${at(points[k])} into ${this.cellText(cells[k + 1])}`));
      });
    }
    for (const { min, max } of why.obstacle?.walls ?? []) {
      way.append(element("li", {}, `wall from ${placeText(this.model.table, min)} to ${placeText(this.model.table, max)}`));
    }
  }

  whyText({ from, to, object, isSeen, line, obstacle, around }) {
    const { head, table } = this.model;
    const target = object === null ? this.cellText(to) : `object ${object} (${table.objects[object].name})`;
    const here = this.cellText(from);
    const ask = `sightlines explain ${head.table} ${from} ${to}`;
    if (object !== null && around.length === 0) return `${target} touches no cell, so the table says nothing of it by cells.`;
    if (isSeen) {
      const by = object === null || to === from ? "" : ` It touches ${this.cellText(to)}.`;
      if (from === to) return object === null ? `It is one cell, which sees itself.` : `${target} touches ${here} itself.`;
      if (line) return `A line leads from somewhere in ${here} to ${target}, through ${counted(line.portals.length, "portal")}.${by}`;
      return `${here} and ${target} may see each other.${by} This page has no line for them; ask ${ask}`;
    }
    const hidden = `${target} is hidden from ${here}.`;
    if (object !== null && table.sees(from, to)) return `${hidden} What is seen of the cells that it touches is not where it is.`;
    if (obstacle?.kind === "not connected") return `${hidden} No way through portals joins them.`;
    if (obstacle?.kind === "walls") {
      const n = obstacle.walls.length;
      return `${hidden} Every line meets ${n === 1 ? "one wall, which is drawn" : `one of ${n} walls, which are drawn`}:`;
    }
    if (obstacle) return `${hidden} Every way through portals ends where no line passes; the first at portals ${obstacle.portals.join(", ")}.`;
    return `${hidden} For the proof ask ${ask}`;
  }

  /** The methods side by side, with what each keeps; one of them can be shown. */
  showMethods() {
    if (!document.getElementById("methods").open) return;
    clearTimeout(this.methodsTimer);
    this.methodsTimer = setTimeout(() => this.listMethods(), 150);
  }

  listMethods() {
    const { model } = this;
    const found = this.actions.compareMethods();
    const row = ({ method, cells, objects, answered }) => {
      const shown = model.method ?? "cell-to-cell";
      const choose = () => {
        model.method = method === "cell-to-cell" ? null : method;
        model.changed();
      };
      const radio = element("input", { type: "radio", name: "method", checked: shown === method, onchange: choose });
      const note = answered === method ? METHOD_HELP[method] : `too much to do: as ${answered}`;
      const label = element("label", {}, radio, ` ${method}`, element("small", {}, note));
      return element(
        "tr", {}, element("th", { scope: "row" }, label), element("td", {}, String(cells.size)), element("td", {}, String(objects.size)),
      );
    };
    document.getElementById("method-rows").replaceChildren(...found.map(row));
    const text = found.length > 0 ? "" : "The eye is in no cell.";
    document.getElementById("methods-text").textContent = text;
  }

  showNumbers() {
    const { model } = this;
    const { table } = model;
    const { cells, polygons, hasPolygons } = model.measure();
    const n = table.cells.length;
    const pairs = cells.reduce((sum, share) => sum + share * (n - 1), 0) / 2;
    const all = (n * (n - 1)) / 2;
    const mean = (list) => list.reduce((sum, x) => sum + x, 0) / Math.max(list.length, 1);
    const rows = [
      ["cells", n.toLocaleString("en")],
      ["portals", table.portals.length.toLocaleString("en")],
      ["objects", table.objects.length.toLocaleString("en")],
      ["visible pairs of cells", `${Math.round(pairs).toLocaleString("en")} of ${all.toLocaleString("en")}, ${percent(mean(cells))}`],
    ];
    if (hasPolygons) rows.push(["polygons that a cell sees, on average", percent(mean(polygons))]);
    const body = rows.map(([key, value]) =>
      element("tr", {}, element("th", { scope: "row" }, key), element("td", {}, value)),
    );
    document.getElementById("facts").replaceChildren(...body);
    this.showHistogram(hasPolygons ? polygons : cells, hasPolygons ? "polygons" : "cells");
    this.listWorst(hasPolygons ? polygons : cells, hasPolygons ? "polygons" : "cells");
  }

  showHistogram(shares, noun) {
    const bins = new Array(20).fill(0);
    for (const share of shares) bins[Math.min(19, Math.floor(20 * share))] += 1;
    const most = Math.max(...bins, 1);
    const bars = bins.map((n, k) => {
      const bar = element("span", { title: `${n} cells see ${5 * k} to ${5 * k + 5} % of the ${noun}` });
      bar.style.height = `${(100 * n) / most}%`;
      return bar;
    });
    const box = document.getElementById("histogram");
    box.replaceChildren(...bars);
    const text = bins.flatMap((n, k) => (n > 0 ? [`${n} cells see ${5 * k} to ${5 * k + 5} %`] : [])).join(", ");
    box.setAttribute("aria-label", `Share of the ${noun} that cells see: ${text}`);
    document.getElementById("histogram-text").textContent = `Number of cells by the share of the ${noun} that each sees.`;
  }

  listWorst(shares, noun) {
    const worst = [...shares.keys()].sort((a, b) => shares[b] - shares[a] || a - b).slice(0, 12);
    document.getElementById("worst").replaceChildren(
      ...worst.map((cell) => {
        const text = `${this.cellText(cell)}: ${percent(shares[cell])} of the ${noun}`;
        const go = () => this.actions.goToCell(cell);
        return element("li", {}, element("button", { type: "button", onclick: go }, text));
      }),
    );
  }

  showChange() {
    const { change } = this.model;
    document.getElementById("change").hidden = !change;
    if (!change) return;
    const text = `${counted(change.gained.length, "pair")} became visible, ${counted(change.lost.length, "pair")} hidden. On the map, for the eye's cell: green and red.`;
    document.getElementById("change-text").textContent = text;
    const line = (sign) => ([a, b]) => {
      const go = () => this.actions.goToCell(a);
      return element("li", {}, element("button", { type: "button", onclick: go }, `${sign} ${a} and ${b}`));
    };
    const all = [...change.gained.map(line("visible:")), ...change.lost.map(line("hidden:"))];
    document.getElementById("changes").replaceChildren(...all.slice(0, 200));
  }
}
