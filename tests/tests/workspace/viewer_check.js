// Compares the sets of all eyes with what the table says, and gathers what went wrong on the page.
const problems = [];
addEventListener("error", (event) => problems.push("error: " + event.message));
addEventListener("unhandledrejection", (event) => problems.push("rejection: " + event.reason));
addEventListener("securitypolicyviolation", (event) => problems.push("policy: " + event.violatedDirective));
console.error = (...words) => problems.push("console: " + words.join(" "));
const equal = (a, b) => a.length === b.length && a.every((x, i) => x === b[i]);
ready.then(async (app) => {
  const { model } = app;
  let wrong = 0;
  for (const { eye, at, cells, objects } of JSON.parse(document.getElementById("eyes").textContent)) {
    model.look(eye);
    const sets = [[model.cells, at], [[...model.visible], cells], [[...model.objects], objects]];
    if (!sets.every(([a, b]) => equal(a, b))) wrong += 1;
  }
  const press = (key) => document.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
  const moved = [...model.eye];
  press("w");
  const walked = model.eye.some((x, k) => x !== moved[k]);
  dispatchEvent(new KeyboardEvent("keyup", { key: "w" }));
  press("l");
  const locked = model.lock !== null;
  press("l");
  press("?");
  const helped = document.getElementById("keys").open;
  document.getElementById("keys").close();
  document.getElementById("numbers").open = true;
  app.panel.showNumbers();
  app.panel.listFound("0");
  const found = document.querySelectorAll("#found button").length;
  document.querySelector("#found button")?.click();
  app.explain(0, 0);
  const svg = app.map.svg();
  app.drawNow();
  const result = {
    wrong, problems, walked, locked, helped, found,
    requests: performance.getEntriesByType("resource").length,
    link: location.hash, isSvg: svg.startsWith("<svg") && svg.includes("polygon"),
    facts: document.getElementById("facts").rows.length, worst: document.querySelectorAll("#worst button").length,
    wide: document.documentElement.scrollWidth <= innerWidth, injected: typeof globalThis.injected,
    notice: document.getElementById("notice").hidden ? null : document.getElementById("notice").textContent,
  };
  const out = document.createElement("pre");
  out.id = "result";
  out.textContent = JSON.stringify(result);
  document.body.append(out);
});
