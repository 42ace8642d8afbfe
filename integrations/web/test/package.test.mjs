// What the package declares is what it has, and broken files are refused in words. SIGHTLINES_PACKAGE is the packed package; without it, it is
// packed here. SIGHTLINES_CASES may be a folder with more tables to break.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import test from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { gzipSync } from "node:zlib";
import { crcRepaired, smallTable } from "./small.mjs";

const here = path.dirname(fileURLToPath(import.meta.url));
const folder = process.env.SIGHTLINES_PACKAGE ?? fs.mkdtempSync(path.join(os.tmpdir(), "sightlines-"));
if (!process.env.SIGHTLINES_PACKAGE) execFileSync("node", [path.join(here, "../pack.mjs"), folder]);
const read = (name) => fs.readFileSync(path.join(folder, name), "utf8");
const main = await import(pathToFileURL(path.join(folder, "index.js")));
const { load, Table, TableError, VisibilityEvent } = main;

test("the package is whole and small", () => {
  const manifest = JSON.parse(read("package.json"));
  const { dependencies, peerDependencies, devDependencies } = manifest;
  assert.deepEqual([dependencies, peerDependencies, devDependencies], [undefined, undefined, undefined]);
  for (const entry of Object.values(manifest.exports)) {
    for (const name of typeof entry === "string" ? [entry] : [entry.types, entry.default]) assert.ok(read(name).length > 0, name);
  }
  for (const name of ["README.md", "LICENSE-MIT", "LICENSE-APACHE"]) assert.ok(read(name).length > 0);
  const most = { "bake.js": 3 * 1024, "index.js": 15 * 1024, "three.js": 2 * 1024 };
  const scripts = fs.readdirSync(folder).filter((name) => name.endsWith(".js"));
  assert.deepEqual(scripts, Object.keys(most));
  for (const name of scripts) {
    const bytes = gzipSync(read(name), { level: 9 }).length;
    assert.ok(bytes <= most[name], `${name}: ${bytes} bytes, compressed`);
  }
  for (const name of scripts) assert.ok(!/https?:\/\/(?!github)/.test(read(name)), "nothing is asked from outside");
});

/** The names of members that a block of declarations has. */
function membersOf(text, name) {
  const found = new RegExp(`^export (?:class|interface) ${name}\\b[^{]*\\{\\n([^]*?)^\\}`, "m").exec(text);
  assert.ok(found, `${name} is declared`);
  const body = found[1].replace(/\/\*\*[^]*?\*\//g, "");
  return [...body.matchAll(/^  (?:readonly |static |private )*(\w+)[?]?[(:]/gm)].map(([, member]) => member).filter((member) => member !== "constructor");
}

function declared(text) {
  return [...text.matchAll(/^export (?:const|function|class) (\w+)/gm)].map(([, name]) => name);
}

test("exports and members are those that are declared", async () => {
  const text = read("index.d.ts");
  assert.deepEqual(declared(text).sort(), Object.keys(main).sort());
  const { Baker, ...others } = await import(pathToFileURL(path.join(folder, "bake.js")));
  const ofBake = read("bake.d.ts");
  assert.deepEqual(declared(ofBake).sort(), ["Baker", ...Object.keys(others)].sort());
  for (const name of membersOf(ofBake, "Baker")) assert.ok(name in Baker || name in Baker.prototype, name);
  const table = await load(smallTable());
  const place = table.at([0.5, 0.5]);
  const watch = table.watch();
  watch.addEventListener("change", (event) => (watch.last = event));
  watch.update([0.5, 0.5]);
  const instances = {
    Table: table,
    Cell: table.cells[0],
    Portal: table.portals[0],
    Item: table.objects[0],
    Door: table.doors[0],
    Place: place,
    Visible: place,
    Narrowed: place.narrow(),
    Doors: table.openDoors(),
    Watch: watch,
    VisibilityEvent: watch.last,
  };
  let n = 0;
  for (const [name, instance] of Object.entries(instances)) {
    for (const member of membersOf(text, name)) {
      assert.ok(member in instance || member in instance.constructor, `${name} has no ${member}`);
      n += 1;
    }
  }
  assert.ok(n > 60, `${n} members`);
  assert.ok(watch.last instanceof VisibilityEvent && "read" in Table);
  // What is public is declared: no long name of the source is left but those.
  const words = new Set(text.match(/\w+/g));
  for (const instance of [table, place, place.narrow(), table.openDoors(), watch]) {
    for (let proto = Object.getPrototypeOf(instance); proto !== Object.prototype && proto !== EventTarget.prototype; proto = Object.getPrototypeOf(proto)) {
      for (const name of Object.getOwnPropertyNames(proto)) assert.ok(name.length < 5 || words.has(name) || name in Array.prototype || name in Set.prototype || name === "constructor", name);
    }
  }
});

test("a small table is read, asked and refused", async () => {
  const table = await load(new Blob([smallTable()]));
  assert.deepEqual(table.at({ x: 0.5, y: 0.5 }).objects(), [0, 1]);
  assert.deepEqual(table.visibleItems([2.5, 0.5]).map(({ name }) => name), ["lamp", "vase"]);
  assert.deepEqual(table.at([9, 9]).objects(), [0, 1, 2]);
  assert.ok(table.at([9, 9]).isOutside && table.at([NaN, 0]).isOutside && table.at([9, 9]).sees(2) && table.at([9, 9]).narrow().sees(2));
  assert.deepEqual(table.named("lamp"), [1]);
  assert.deepEqual(table.named("ghost"), []);
  const doors = table.openDoors().close("gate");
  assert.ok(doors.isShut(0) && doors.isClosed(0));
  assert.deepEqual(table.at([0.5, 0.5]).narrow(null, { doors }).objects(), [0]);
  assert.deepEqual(table.at([0.5, 0.5]).narrow(null, { doors: doors.open("gate") }).objects(), [0, 1]);
  assert.deepEqual(table.at([0.5, 0.5]).narrow({ direction: [-1, 0], fov: 1 }, { method: "incident-portals" }).visibleCells(), [0]);
  assert.throws(() => doors.close("portcullis"), /no door 'portcullis'/);
  assert.throws(() => table.at([0.5, 0.5]).narrow({ direction: [0, 0], fov: 1 }), /a view has a direction/);
  assert.throws(() => table.at([0.5, 0.5]).narrow({ direction: [1, 0], fov: 4 }), /below half a turn/);
  assert.throws(() => table.at([0.5, 0.5]).narrow({ viewProjection: [1, 2] }), /16 numbers/);
  assert.throws(() => table.at([0.5, 0.5]).narrow(null, { method: "best" }), /'best' is none of/);
  assert.throws(() => Table.read(new Uint8Array(40)), (error) => error instanceof TableError && /no table of visibility/.test(error.message));
  const newer = smallTable();
  newer[8] = 2;
  assert.throws(() => Table.read(newer), /version 2\.7 of its format, and this reader knows version 1/);
  await assert.rejects(load(new Response("gone", { status: 404, statusText: "Not Found" })), /404 Not Found/);
});

/** Calls `read` with broken bytes: it returns, or says what is wrong. How often it did either. */
function survives(read, broken) {
  const count = { read: 0, refused: 0 };
  for (const bytes of broken) {
    const began = performance.now();
    try {
      read(bytes);
      count.read += 1;
    } catch (error) {
      assert.ok(error instanceof TableError, error.stack);
      count.refused += 1;
    }
    assert.ok(performance.now() - began < 5000, "it takes too long");
  }
  return count;
}

function* truncations(bytes, n) {
  for (let k = 0; k < n; k++) yield bytes.slice(0, Math.floor((bytes.length * k) / n));
}

/** Bytes with a bit flipped; `repair` mends what would give it away. */
function* flips(bytes, n, repair = (all) => all) {
  let seed = 1;
  for (let k = 0; k < n; k++) {
    seed = (seed * 48271) % 2147483647;
    const all = bytes.slice();
    all[seed % all.length] ^= 1 << (seed >> 8 & 7);
    yield repair(all);
  }
}

function use(bytes) {
  const table = Table.read(bytes);
  for (const cell of table.cells.slice(0, 3)) {
    const place = table.at(table.toScene(cell.min.map((x, k) => (x + cell.max[k]) / 2)));
    place.objects();
    place.narrow();
    table.timeToSight([0.5, 0.5, 0.5], place.point);
  }
}

test("broken files are refused or read, and never hang", async (t) => {
  const files = [["small", smallTable()]];
  const cases = process.env.SIGHTLINES_CASES;
  for (const name of cases ? fs.readdirSync(cases) : []) files.push([name, new Uint8Array(fs.readFileSync(path.join(cases, name)))]);
  for (const [name, bytes] of files) {
    use(bytes);
    assert.deepEqual(survives(use, truncations(bytes, 100)), { read: 0, refused: 100 });
    // Each flipped bit is noticed by a checksum.
    assert.deepEqual(survives(use, flips(bytes, 100)), { read: 0, refused: 100 });
    // Fewer of large files.
    const n = Math.min(1000, Math.ceil(6e6 / bytes.length));
    const count = survives(use, flips(bytes, n, crcRepaired));
    assert.ok(count.refused > 5 && count.read > 5, JSON.stringify(count));
    t.diagnostic(`${name}, with checksums mended: ${JSON.stringify(count)}`);
  }
});
