// The playground: a file in, its table out, and the page of the table below.

import { Baker } from "../src/bake.js";

/** The longest link, in characters. */
const MOST_LINK = 60_000;

const at = (id) => document.getElementById(id);
/** What is shown: the file, the request, and what was made of them. */
let shown = null;
let stopper = null;

const bytesOf = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
const through = async (bytes, stream) => new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
const unpacked = (bytes) => through(bytes, new DecompressionStream("deflate-raw"));

const baker = (async () => {
  if (typeof WebAssembly === "undefined") throw new Error("this browser has no WebAssembly");
  return Baker.load(await unpacked(bytesOf(at("carried").textContent)));
})();

function say(text, isWrong = false) {
  at("said").textContent = text;
  at("said").classList.toggle("wrong", isWrong);
}

/** The options that are typed. */
function typed() {
  const text = at("request").value.trim();
  let request = {};
  if (text) {
    try {
      request = JSON.parse(text);
    } catch (error) {
      throw new Error(`The options are no JSON: ${error.message}`);
    }
    if (request === null || typeof request !== "object" || Array.isArray(request)) throw new Error('Options are an object, such as {"cell_size": 4}');
  }
  const map = at("map").value.trim();
  return map ? { ...request, map } : request;
}

/** Makes the table of a file, and shows it. */
async function build(file) {
  stopper?.abort();
  const mine = (stopper = new AbortController());
  const options = {
    signal: mine.signal,
    tell(phase, share) {
      at("share").value = share;
      at("phase").textContent = `${phase}, ${Math.floor(100 * share)} %`;
    },
  };
  at("work").hidden = false;
  at("share").removeAttribute("value");
  at("phase").textContent = "";
  at("again").disabled = true;
  say(`${file.name}: ${file.bytes.length.toLocaleString("en")} bytes`);
  try {
    const request = typed();
    const begun = performance.now();
    const { table, facts } = await (await baker).bake(file, request, options);
    const seconds = ((performance.now() - begun) / 1000).toFixed(2);
    const html = await (await baker).page(file.name, options);
    show(html);
    shown = { file, request, table, html };
    at("results").hidden = false;
    const objects = facts.objects ? `, ${facts.objects.toLocaleString("en")} objects` : "";
    say(`${file.name}: ${facts.cells.toLocaleString("en")} cells${objects}, in ${seconds} s`);
  } catch (error) {
    if (mine === stopper) say(error.name === "AbortError" ? "Cancelled" : error.message, error.name !== "AbortError");
  } finally {
    if (mine === stopper) {
      at("work").hidden = true;
      at("again").disabled = false;
      document.body.dataset.done = "true";
    }
  }
}

function show(html) {
  const view = at("view");
  URL.revokeObjectURL(view.src);
  view.src = URL.createObjectURL(new Blob([html], { type: "text/html" }));
  view.hidden = false;
  at("drop").hidden = true;
}

let last = null;
const open = (file) => build((last = file));

async function openBlob(blob) {
  open({ name: blob.name, bytes: new Uint8Array(await blob.arrayBuffer()) });
}

async function sample(name) {
  stopper?.abort();
  try {
    const { json, bytes } = await (await baker).ask({ ask: "sample", name });
    open({ name: json.file, bytes, sample: name });
  } catch (error) {
    say(error.message, true);
  }
}

function save(name, data, type) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([data], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

const stem = (name) => name.replace(/\.[^.]*$/, "");

/** What a link holds: the name of a sample or the whole file, and the options. */
async function linkOf({ file, request }) {
  const head = new TextEncoder().encode(JSON.stringify({ name: file.name, sample: file.sample, request }));
  const body = file.sample ? new Uint8Array() : file.bytes;
  const all = new Uint8Array(4 + head.length + body.length);
  new DataView(all.buffer).setUint32(0, head.length, true);
  all.set(head, 4);
  all.set(body, 4 + head.length);
  const packed = await through(all, new CompressionStream("deflate-raw"));
  let text = "";
  for (const byte of packed) text += String.fromCharCode(byte);
  return btoa(text).replace(/\+/g, "-").replace(/\//g, "_").replace(/=/g, "");
}

async function follow(link) {
  try {
    const all = await unpacked(bytesOf(link.replace(/-/g, "+").replace(/_/g, "/")));
    const length = new DataView(all.buffer).getUint32(0, true);
    const { name, sample: of, request } = JSON.parse(new TextDecoder().decode(all.subarray(4, 4 + length)));
    const { map = "", ...options } = request;
    at("map").value = map;
    at("request").value = Object.keys(options).length ? JSON.stringify(options) : "";
    if (of) await sample(of);
    else open({ name, bytes: all.slice(4 + length) });
  } catch {
    say("The link is damaged", true);
  }
}

at("file").onchange = ({ target }) => target.files[0] && openBlob(target.files[0]);
at("cancel").onclick = () => stopper?.abort();
at("again").onclick = () => last && build(last);
for (const id of ["request", "map"]) at(id).onkeydown = ({ key }) => key === "Enter" && last && build(last);
at("save-table").onclick = () => save(`${stem(shown.file.name)}.pvs`, shown.table, "application/octet-stream");
at("save-page").onclick = () => save(`${stem(shown.file.name)}.html`, shown.html, "text/html");
at("link").onclick = async () => {
  const link = await linkOf(shown);
  if (link.length > MOST_LINK) return say("The file is too large for a link", true);
  history.replaceState(null, "", `#${link}`);
  const isCopied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
  say(isCopied ? "The link is in the address, and on the clipboard" : "The link is in the address");
};
document.ondragover = (event) => {
  event.preventDefault();
  document.body.classList.add("over");
};
document.ondragleave = () => document.body.classList.remove("over");
document.ondrop = (event) => {
  event.preventDefault();
  document.body.classList.remove("over");
  const blob = event.dataTransfer.files[0];
  if (blob) openBlob(blob);
};

(async () => {
  try {
    const { json } = await (await baker).ask({ ask: "about" });
    for (const { name, about } of json.samples) {
      const button = document.createElement("button");
      button.textContent = about;
      button.onclick = () => sample(name);
      at("samples").append(button);
    }
    if (location.hash.length > 1) await follow(location.hash.slice(1));
    document.body.dataset.ready = "true";
  } catch (error) {
    say(error.message, true);
  }
})();
