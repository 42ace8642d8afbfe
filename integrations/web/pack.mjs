// Packs the package into a folder: `node integrations/web/pack.mjs [FOLDER]`, by default target/npm. `npm pack FOLDER` or `npm publish FOLDER` do the rest.
// With the module of WebAssembly that `cargo xtask wasm` builds, if it is there.

import fs from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { joined, minified, words } from "./minify.mjs";

/** What scripts may have, compressed, in bytes. */
const MOST_BYTES = { "index.js": 15 * 1024, "three.js": 2 * 1024 };

const here = path.dirname(fileURLToPath(import.meta.url));
const root = path.resolve(here, "../..");
const reader = path.join(root, "crates/viewer/web/reader");
const out = path.resolve(process.argv[2] ?? path.join(root, "target/npm"));

const read = (folder, name) => fs.readFileSync(path.join(folder, name), "utf8");
const write = (name, text) => fs.writeFileSync(path.join(out, name), text);

fs.mkdirSync(out, { recursive: true });
const main = [
  ...["bytes.js", "geometry.js", "rows.js", "table.js", "plain.js", "soon.js", "methods.js"].map((name) => read(reader, name)),
  ...["zstd.js", "packed.js", "index.js"].map((name) => read(path.join(here, "src"), name)),
];
const head = "// sightlines, MIT OR Apache-2.0\n";
/** The names of what declarations export, and of members. Parameters are between brackets. */
function declared(name) {
  let text = read(here, name).replace(/\/\*\*[^]*?\*\//g, "");
  for (let last = ""; last !== text; text = text.replace(/\([^()]*\)/g, "")) last = text;
  return [.../(\w+)\??:|^export \w+ (\w+)/gm[Symbol.matchAll](text)].map(([, member, exported]) => member ?? exported);
}
const open = ["LoadedTable", ...declared("index.d.ts")];
// The adapter uses these of three.
const ofThree =
  "userData onBeforeRender onAfterRender isLOD autoUpdate layers mask add remove children geometry isBatchedMesh worldToLocal position clone " +
  "setFromMatrixPosition matrixWorld matrixWorldInverse projectionMatrix isPerspectiveCamera multiply elements getVisibleAt setVisibleAt nodes " +
  "primitives updateMatrixWorld";
const scripts = {
  "index.js": `${head}${minified(joined(main), open)}\nexport{load,LoadedTable as Table,METHODS,TableError,VisibilityEvent};\n`,
  "three.js": `${head}${minified(joined([read(path.join(here, "src"), "three.js")]), [...open, ...declared("three.d.ts"), ...words(ofThree)])}\nexport{cull};\n`,
};
for (const [name, text] of Object.entries(scripts)) write(name, text);
fs.copyFileSync(path.join(here, "src/bake.js"), path.join(out, "bake.js"));
const wasm = process.env.SIGHTLINES_WASM ?? path.join(root, "target/wasm/wasm32-unknown-unknown/release/sightlines_wasm.wasm");
const manifest = JSON.parse(read(here, "package.json"));
if (fs.existsSync(wasm)) {
  fs.copyFileSync(wasm, path.join(out, "sightlines.wasm"));
} else {
  delete manifest.exports["./sightlines.wasm"];
  console.log("sightlines.wasm is left out: `cargo xtask wasm` builds it");
}
write("package.json", `${JSON.stringify(manifest, null, 2)}\n`);
for (const name of ["README.md", "index.d.ts", "three.d.ts", "bake.d.ts"]) fs.copyFileSync(path.join(here, name), path.join(out, name));
for (const name of ["bench.mjs", "examples"]) fs.cpSync(path.join(here, name), path.join(out, name), { recursive: true });
for (const name of ["LICENSE-APACHE", "LICENSE-MIT"]) fs.copyFileSync(path.join(root, name), path.join(out, name));

for (const [name, text] of Object.entries(scripts)) {
  const bytes = gzipSync(text, { level: 9 }).length;
  console.log(`${path.join(out, name)}: ${bytes} bytes, compressed`);
  if (bytes > MOST_BYTES[name]) {
    console.error(`that is more than ${MOST_BYTES[name]}`);
    process.exitCode = 1;
  }
}
