// The module against the program: the same bytes of the same files, in Node and in a page, and the playground as visitors use it. SIGHTLINES_WASM is the module,
// SIGHTLINES_CASES a folder with a case in each file: NAME and NAME.json with the request, NAME.pvs with the table that the crates make.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import test from "node:test";
import { fileURLToPath } from "node:url";
import { Instance } from "../src/bake.js";
import { joined } from "../minify.mjs";
import { inChromium } from "./chromium.mjs";

const here = path.dirname(fileURLToPath(import.meta.url));
const { SIGHTLINES_WASM: file, SIGHTLINES_CASES: folder, SIGHTLINES_CHROMIUM: browser } = process.env;
const module = await WebAssembly.compile(fs.readFileSync(file));
const cases = fs.readdirSync(folder).filter((name) => name.endsWith(".json"));

test("tables have the bytes of the crates", () => {
  let [told, times] = [0, []];
  const tables = new Set();
  for (const name of cases) {
    const { file, map, request } = JSON.parse(fs.readFileSync(path.join(folder, name)));
    const instance = new Instance(module, (phase, share) => {
      assert.ok(phase.length > 0 && share >= 0 && share <= 1, `${phase}: ${share}`);
      told++;
    });
    const begun = performance.now();
    const { json, bytes } = instance.ask({ ask: "bake", name: file, map, request }, fs.readFileSync(path.join(folder, file)));
    times.push(`${file} ${Math.round(performance.now() - begun)} ms`);
    const expected = fs.readFileSync(path.join(folder, `${name.slice(0, -5)}.pvs`));
    assert.ok(expected.equals(bytes), `${name}: ${JSON.stringify(json)}`);
    tables.add(expected.toString("latin1"));
  }
  assert.ok(told > 10, `${told}`);
  // Requests are heeded: those of one scene make tables that differ.
  assert.equal(tables.size, cases.length);
  console.log(`${cases.length} cases: ${times.join(", ")}`);
});

test("what cannot be answered is refused, and the module goes on", () => {
  const instance = new Instance(module);
  const bake = (name, bytes, request = {}) => instance.ask({ ask: "bake", name, request }, bytes);
  const bytes = (text) => new TextEncoder().encode(text);
  assert.throws(() => instance.ask({ ask: "page", title: "" }), /nothing was baked/);
  assert.throws(() => instance.ask({ ask: "everything" }), /unknown variant/);
  assert.throws(() => instance.ask({ ask: "sample", name: "castle" }), /there is no sample 'castle'/);
  assert.throws(() => bake("x.glb", bytes("glTF")), /./);
  assert.throws(() => bake("x.txt", bytes("words")), /nothing from which a table can be baked/);
  assert.throws(() => bake("x.obj", bytes("mtllib other.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")), /./);
  const { json, bytes: plan } = instance.ask({ ask: "sample", name: "plan" });
  assert.throws(() => bake(json.file, plan, { grid: [1, 1, 1] }), /grid is for scenes in space, and this is a plan/);
  assert.throws(() => bake(json.file, plan, { size: 4 }), /unknown field `size`/);
  // Damage: a message or a table, and never a trap.
  const sample = instance.ask({ ask: "sample", name: "house" });
  let [state, refused] = [7, 0];
  const random = (n) => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) % n;
  for (let k = 0; k < 200; k++) {
    const [name, whole] = k % 8 ? [json.file, plan] : [sample.json.file, sample.bytes];
    const damaged = whole.slice(0, k % 3 ? whole.length : random(whole.length));
    if (damaged.length) damaged[random(Math.min(damaged.length, 400))] = random(256);
    try {
      bake(name, damaged, name === json.file ? {} : { n_cells: 2, method: "shafts" });
    } catch (error) {
      assert.ok(error.isRefused, `${k}: ${error.stack}`);
      refused++;
    }
  }
  assert.ok(refused > 50, `${refused}`);
  assert.ok(bake(json.file, plan).json.cells > 10);
});

test("tables made in a page have the bytes of the crates", { skip: !browser }, async () => {
  const base64 = (name) => fs.readFileSync(name).toString("base64");
  const carried = cases.map((name) => {
    const { file, map, request } = JSON.parse(fs.readFileSync(path.join(folder, name)));
    return { file, request: { ...request, map }, bytes: base64(path.join(folder, file)), table: base64(path.join(folder, `${name.slice(0, -5)}.pvs`)) };
  });
  const page = path.join(folder, "all.html");
  const script = joined([fs.readFileSync(path.join(here, "../src/bake.js"), "utf8")]);
  const data = JSON.stringify({ module: base64(file), carried });
  fs.writeFileSync(page, `<!DOCTYPE html><script>const data = ${data};</script><script type="module">${script}\nBaker.source = ${JSON.stringify(script)};\nglobalThis.Baker = Baker;</script>`);
  const run = async () => {
    const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const baker = await Baker.load(bytes(data.module));
    const wrong = [];
    let told = 0;
    for (const { file, request, bytes: given, table: expected } of data.carried) {
      const { table } = await baker.bake({ name: file, bytes: bytes(given) }, request, { tell: () => told++ });
      const right = bytes(expected);
      if (table.length !== right.length || table.some((byte, k) => byte !== right[k])) wrong.push(file);
    }
    const refused = await baker.bake({ name: "x", bytes: bytes("") }).then(() => "", (error) => error.message);
    const odd = await baker.bake({ name: "x", bytes: bytes("") }, { gap: () => 0 }).then(() => "", (error) => error.name);
    const both = await Promise.allSettled([0, 1].map(() => baker.ask({ ask: "about" })));
    baker.stop();
    // As a minifier leaves the classes: by other names.
    const renamed = new (new Function(`${Baker.source.replace(/(?<!\.)\bInstance\b/g, "e")}; return Baker;`)())(baker.module);
    const { json } = await renamed.ask({ ask: "about" });
    return { wrong, told, refused, odd, renamed: json.version, both: both.map(({ status }) => status), again: (await baker.ask({ ask: "about" })).json.version };
  };
  const { value, asked, thrown } = await inChromium(browser, page, run);
  assert.deepEqual([value.wrong, asked, thrown], [[], [], []]);
  assert.ok(value.told > 10 && value.again, JSON.stringify(value));
  assert.match(value.refused, /nothing from which a table can be baked/);
  assert.deepEqual([value.odd, value.renamed], ["DataCloneError", value.again]);
  assert.deepEqual(value.both, ["fulfilled", "rejected"]);
});

test("the playground makes tables in a page, and asks nobody for anything", { skip: !browser }, async () => {
  const page = path.join(folder, "playground.html");
  execFileSync("node", [path.join(here, "../playground/make.mjs"), file, page]);
  const run = async () => {
    const at = (id) => document.getElementById(id);
    const until = async (is) => {
      for (let k = 0; k < 1200 && !is(); k++) await new Promise((done) => setTimeout(done, 50));
      if (!is()) throw new Error(`waited in vain for ${is}: ${at("said").textContent}`);
    };
    const said = async (act) => {
      delete document.body.dataset.done;
      act();
      await until(() => document.body.dataset.done);
      return at("said").textContent;
    };
    const saved = () =>
      new Promise((done) => {
        const click = HTMLAnchorElement.prototype.click;
        HTMLAnchorElement.prototype.click = function () {
          HTMLAnchorElement.prototype.click = click;
          fetchBlob(this.href).then(done);
        };
        at("save-table").click();
      });
    // The policy of the page forbids to fetch, blobs included; a frame would do, and so does the interface that made them.
    const blobs = new Map();
    const make = URL.createObjectURL;
    URL.createObjectURL = (blob) => {
      const address = make.call(URL, blob);
      blobs.set(address, blob);
      return address;
    };
    const fetchBlob = async (address) => [...new Uint8Array(await blobs.get(address).arrayBuffer())];
    await until(() => document.body.dataset.ready);
    const samples = [...document.querySelectorAll("#samples button")];
    const told = [];
    for (const sample of samples) told.push(await said(() => sample.click()));
    const table = await saved();
    await until(() => at("view").contentWindow);
    at("link").click();
    await until(() => location.hash.length > 1);
    const drop = (name, text) => {
      const files = new DataTransfer();
      files.items.add(new File([text], name));
      document.dispatchEvent(new DragEvent("drop", { dataTransfer: files, bubbles: true, cancelable: true }));
    };
    const wrong = await said(() => drop("notes.txt", "words"));
    const wasWrong = at("said").classList.contains("wrong");
    at("request").value = "{cell_size: 4}";
    const noJson = await said(() => at("again").click());
    at("request").value = '{"subdivide": "kd"}';
    const square = JSON.stringify({ type: "LineString", coordinates: [[0, 0], [4, 0], [4, 3], [0, 3], [0, 0]] });
    const dropped = await said(() => drop("square.geojson", square));
    at("request").value = "";
    // A longer one, which is cancelled.
    delete document.body.dataset.done;
    at("phase").textContent = "";
    samples[1].click();
    await until(() => at("phase").textContent);
    at("cancel").click();
    await until(() => document.body.dataset.done);
    const cancelled = at("said").textContent;
    const after = await said(() => samples[0].click());
    return { told, table, hash: location.hash, wrong, wasWrong, noJson, dropped, cancelled, after };
  };
  const { value, asked, thrown } = await inChromium(browser, page, run);
  console.log(value.told.join("; "));
  assert.equal(value.told.length, 3);
  for (const text of [...value.told, value.dropped, value.after]) assert.match(text, /^\S+: [\d,]+ cells.*, in [\d.]+ s$/);
  assert.match(value.wrong, /nothing from which a table can be baked/);
  assert.ok(value.wasWrong);
  assert.match(value.noJson, /^The options are no JSON/);
  assert.equal(value.cancelled, "Cancelled");
  assert.deepEqual([asked, thrown], [[], []]);
  const instance = new Instance(module);
  const doom = instance.ask({ ask: "sample", name: "doom" });
  assert.deepEqual(Uint8Array.from(value.table), instance.ask({ ask: "bake", name: doom.json.file }, doom.bytes).bytes);
  const followed = async () => {
    for (let k = 0; k < 600 && !document.body.dataset.done; k++) await new Promise((done) => setTimeout(done, 50));
    return document.getElementById("said").textContent;
  };
  const linked = await inChromium(browser, page, followed, { link: value.hash });
  assert.match(linked.value, /^map\.geojson: [\d,]+ cells/);
});
