// Writes one page that opens from disk, without a server or a network: a glTF scene in three.js, culled by its table. Three is not part of the
// package: THREE is the folder of it, such as node_modules/three.
//
//     node examples/make.mjs THREE SCENE.glb TABLE.pvs OUT.html

import fs from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";

const [three, scene, table, out] = process.argv.slice(2);
if (!out) {
  console.error("node make.mjs THREE SCENE.glb TABLE.pvs OUT.html");
  process.exit(2);
}
const here = path.dirname(fileURLToPath(import.meta.url));
// In the package the scripts lie above this folder; in the sources pack.mjs puts them into target/npm.
const ours = [path.join(here, ".."), path.join(here, "../../../target/npm")].find((folder) => fs.existsSync(path.join(folder, "three.js")));
if (!ours) throw new Error("pack the package first: node integrations/web/pack.mjs");

const data = (bytes, type) => `data:${type};base64,${Buffer.from(bytes).toString("base64")}`;
/** A module whose neighbours are found by the names of the map below. */
const module = (file) => {
  const text = fs.readFileSync(file, "utf8");
  return data(text.replace(/(from\s*['"])(\.[^'"]*)(['"])/g, (_, before, name, after) => `${before}page/${path.basename(name)}${after}`), "text/javascript");
};
const imports = {
  three: module(path.join(three, "build/three.module.js")),
  "page/three.core.js": module(path.join(three, "build/three.core.js")),
  "page/GLTFLoader.js": module(path.join(three, "examples/jsm/loaders/GLTFLoader.js")),
  "page/BufferGeometryUtils.js": module(path.join(three, "examples/jsm/utils/BufferGeometryUtils.js")),
  "page/SkeletonUtils.js": module(path.join(three, "examples/jsm/utils/SkeletonUtils.js")),
  sightlines: module(path.join(ours, "index.js")),
  "sightlines/three": module(path.join(ours, "three.js")),
};
const carried = { scene: data(fs.readFileSync(scene), "model/gltf-binary"), table: data(fs.readFileSync(table), "application/octet-stream") };
const html = fs
  .readFileSync(path.join(here, "three.html"), "utf8")
  .replace("/* imports */", () => JSON.stringify({ imports }))
  .replace("/* carried */", () => JSON.stringify(carried));
fs.writeFileSync(out, html);
console.log(`${out}: ${html.length} bytes`);
