// How long lookups take: `node bench.mjs TABLE.pvs…`, in the package or, once pack.mjs has run, in the sources. Each answer is checked against one
// that is put together pair by pair.

import fs from "node:fs";
import path from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const here = path.dirname(fileURLToPath(import.meta.url));
const script = [path.join(here, "index.js"), path.join(here, "../../target/npm/index.js")].find((file) => fs.existsSync(file));
if (!script) throw new Error("pack the package first: node integrations/web/pack.mjs");
const { Table } = await import(pathToFileURL(script));

let seed = 1;
const chance = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
/** Microseconds for each of a list. */
function time(list, call) {
  const began = performance.now();
  for (const item of list) call(item);
  return ((1000 * (performance.now() - began)) / list.length).toFixed(2);
}

for (const file of process.argv.slice(2)) {
  const bytes = fs.readFileSync(file);
  const began = performance.now();
  const table = Table.read(bytes);
  const ms = performance.now() - began;
  const point = ({ min, max }) => table.toScene(min.map((x, k) => x + chance() * (max[k] - x)));
  const eyes = Array.from({ length: 20000 }, () => point(table.cells[Math.floor(chance() * table.cells.length)]));
  for (const eye of eyes.slice(0, 50)) {
    const place = table.at(eye);
    const pairs = table.objects.filter(({ id }) => place.sees(id)).map(({ id }) => id);
    if (pairs.join() !== place.objects().join()) throw new Error(`${file}: the sets differ at ${eye}`);
  }
  let n = 0;
  const cold = time(eyes.slice(0, 2000), (eye) => (n += table.at(eye).objects().length));
  time(eyes, (eye) => (n += table.at(eye).objects().length));
  const lookups = {
    "at a point": time(eyes, (eye) => (n += table.at(eye).cells.length)),
    "one object": time(eyes, (eye) => (n += table.at(eye).sees(eyes.length % table.objects.length) ? 1 : 0)),
    "all objects as bits": time(eyes, (eye) => (n += table.at(eye).objectBits[0])),
    "all objects as a list": time(eyes, (eye) => (n += table.at(eye).objects().length)),
    "the same at first": cold,
    "a narrowed view": time(eyes.slice(0, 300), (eye) => (n += table.at(eye).narrow({ direction: [1, 0.1, 0.2], fov: 1.2, aspect: 1.5 }).objects().length)),
  };
  console.log(`${file}: ${table.cells.length} cells, ${table.objects.length} objects, read in ${ms.toFixed(0)} ms`);
  for (const [what, us] of Object.entries(lookups)) console.log(`  ${what.padEnd(24)} ${us.padStart(9)} µs`);
}
