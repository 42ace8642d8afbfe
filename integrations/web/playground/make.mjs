// Writes the playground, one HTML file that asks nobody for anything: `node integrations/web/playground/make.mjs MODULE.wasm OUT.html`.

import fs from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { deflateRawSync } from "node:zlib";
import { joined } from "../minify.mjs";

const [module, out] = process.argv.slice(2);
if (!out) {
  console.error("node make.mjs MODULE.wasm OUT.html");
  process.exit(2);
}
const here = path.dirname(fileURLToPath(import.meta.url));
const read = (...name) => fs.readFileSync(path.join(here, ...name), "utf8");
const scripts = joined([read("../src/bake.js"), read("main.js")]);
const html = read("page.html")
  .replace("/* module */", () => deflateRawSync(fs.readFileSync(module), { level: 9 }).toString("base64"))
  .replace("/* scripts */", () => scripts);
fs.writeFileSync(out, html);
console.log(`${out}: ${html.length} bytes`);
