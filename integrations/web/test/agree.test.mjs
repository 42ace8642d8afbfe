// What the package finds in tables is what the crates find. SIGHTLINES_PACKAGE is the packed package, SIGHTLINES_CASES a folder with one table in
// several forms, and with what the crates say of it.

import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";

const cases = process.env.SIGHTLINES_CASES;
const { load, METHODS, Table } = await import(pathToFileURL(path.join(process.env.SIGHTLINES_PACKAGE, "index.js")));
const expected = JSON.parse(fs.readFileSync(path.join(cases, "case.json"), "utf8"));
const read = (name) => fs.readFileSync(path.join(cases, name));
const FORMS = ["plain.pvs", "small.pvz", "large.pvz"];

const bitsOf = (list, n) => {
  const words = new Uint32Array(2 * Math.ceil(n / 64));
  for (const i of list) words[i >>> 5] |= 1 << (i & 31);
  return words;
};
const equal = (a, b) => a.length === b.length && a.every((x, i) => x === b[i]);

/** How many eyes have other sets than the crate says. */
function wrongEyes(table) {
  const [nCells, nObjects] = [table.cells.length, table.objects.length];
  const all = (n) => Array.from({ length: n }, (_, i) => i);
  return expected.eyes.filter(({ eye, at, cells, objects }) => {
    const place = table.at(eye);
    // From outside of all cells everything may be seen.
    const seen = [at.length === 0 ? all(nCells) : cells, at.length === 0 ? all(nObjects) : objects];
    const found = [place.visibleCells(), place.objects()];
    const isRight =
      equal(place.cells, at) && place.isOutside === (at.length === 0) && found.every((list, k) => equal(list, seen[k])) &&
      equal(place.cellBits, bitsOf(seen[0], nCells)) && equal(place.objectBits, bitsOf(seen[1], nObjects)) &&
      all(nObjects).every((object) => place.sees(object) === ((bitsOf(seen[1], nObjects)[object >>> 5] >>> (object & 31)) & 1) > 0);
    return !isRight;
  }).length;
}

for (const form of FORMS) {
  test(`${form}: eyes, names, sources and doors`, async (t) => {
    const table = await load(read(form));
    assert.deepEqual(table.objects.map(({ name }) => name), expected.names);
    const sources = table.objects.map(({ node, primitive }) => (node === null ? null : [node, primitive]));
    assert.deepEqual(sources, expected.names.map((_, k) => expected.sources[k] ?? null));
    assert.deepEqual(table.doors.map(({ name, portals }) => [name, portals]), expected.doors);
    assert.equal(table.hasPlaces, expected.hasPlaces);
    assert.equal(wrongEyes(table), 0);
    const n = expected.eyes.filter(({ at }) => at.length > 1).length;
    t.diagnostic(`compared ${expected.eyes.length} eyes, ${n} of them on borders`);
  });
}

test("all forms are the same table", () => {
  const [plain, ...packed] = FORMS.map((form) => Table.read(read(form)));
  for (const table of packed) {
    for (const key of ["dimension", "cells", "portals", "objects", "doors", "up", "frame", "info", "cellObjects"]) assert.deepEqual(table[key], plain[key], key);
  }
});

test("the impostor with one pair hidden is found out", () => {
  assert.ok(wrongEyes(Table.read(read("impostor.pvs"))) > 0);
});

/** The sixteen numbers of a camera of this view, by columns, as engines make them. */
function viewProjection({ eye, dir, fov, aspect, up }) {
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (v) => v.map((x) => x / Math.hypot(...v));
  const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
  const ahead = unit(dir);
  const right = unit(cross(ahead, up));
  const above = cross(right, ahead);
  const [f, near, far] = [1 / Math.tan(fov / 2), 0.1, 1000];
  const row = (axis, scale) => [...axis.map((x) => x * scale), -scale * dot(axis, eye)];
  const depth = (far + near) / (far - near);
  const z = row(ahead, depth);
  z[3] -= (2 * far * near) / (far - near);
  const rows = [row(right, f), row(above, f * aspect), z, row(ahead, 1)];
  return Array.from({ length: 16 }, (_, i) => rows[i % 4][i >> 2]);
}

test("views and doors: nothing is left out, and little is more", (t) => {
  const table = Table.read(read("plain.pvs"));
  const count = { views: 0, kept: 0, more: 0, exact: 0, all: 0, gaveUp: 0 };
  for (const view of expected.views) {
    const doors = table.openDoors();
    view.shut.forEach((door) => doors.close(door));
    const place = table.at(view.eye);
    const given = view.dir && { direction: view.dir, fov: view.fov, aspect: view.aspect, up: view.up };
    let before = null;
    METHODS.forEach((method, k) => {
      const found = place.narrow(given, { method, doors });
      const { cells, objects } = view.kept[k];
      assert.ok(cells.every((cell) => found.seesCell(cell)), `${method}: a cell is left out`);
      assert.ok(objects.every((object) => found.sees(object)), `${method}: an object is left out`);
      if (before) assert.ok(found.visibleCells().every((cell) => before.seesCell(cell)), `${method} is within the one before`);
      before = found;
      count.kept += cells.length;
      count.more += found.visibleCells().length - cells.length;
      if (method === "exact") {
        count.exact += found.visibleCells().length;
        count.gaveUp += found.method === method ? 0 : 1;
      }
      if (method === "cell-to-cell") count.all += cells.length;
    });
    if (view.dir && table.dimension === 3) {
      const found = place.narrow({ viewProjection: viewProjection(view) }, { doors, method: "incident-portals" });
      assert.ok(view.kept[3].objects.every((object) => found.sees(object)), "by a matrix: an object is left out");
      count.more += found.visibleCells().length - view.kept[3].cells.length;
    }
    count.views += 1;
  }
  if (expected.hasPlaces) assert.ok(count.views > 20);
  assert.ok(count.more * 100 <= count.kept, JSON.stringify(count));
  if (table.portals.length > 0) assert.ok(count.exact < count.all, JSON.stringify(count));
  t.diagnostic(`compared ${JSON.stringify(count)}`);
});

test("times to sight are lower bounds", (t) => {
  const table = Table.read(read("plain.pvs"));
  const count = { times: 0, above: 0, same: 0 };
  for (const { a, b, speeds, seconds } of expected.times) {
    const found = table.timeToSight(a, b, speeds);
    assert.ok(found <= (seconds ?? Infinity) * (1 + 1e-9), `${found} instead of ${seconds}`);
    count.times += 1;
    count.above += found > 0 ? 1 : 0;
    count.same += found >= (seconds ?? Infinity) * (1 - 1e-9) ? 1 : 0;
  }
  // The crate has its ladder of reaches as well, which says more of some.
  assert.ok(count.same * 2 >= count.times, JSON.stringify(count));
  t.diagnostic(`compared ${JSON.stringify(count)}`);
});

test("a walk tells each change once", () => {
  const table = Table.read(read("plain.pvs"));
  const watch = table.watch();
  const seen = new Set();
  let [events, n] = [0, 0];
  watch.addEventListener("change", ({ gained, lost, place }) => {
    assert.ok(gained.every((object) => !seen.has(object)) && lost.every((object) => seen.has(object)));
    gained.forEach((object) => seen.add(object));
    lost.forEach((object) => seen.delete(object));
    assert.equal(place, watch.place);
    events += 1;
  });
  for (const { eye } of expected.eyes.slice(0, 200)) {
    n += watch.update(eye) ? 1 : 0;
    assert.ok(equal([...seen].sort((a, b) => a - b), table.at(eye).objects()));
    assert.equal(watch.update(eye), false);
  }
  assert.equal(events, n);
});
