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
  for (const { eye, at, cells, objects } of given) {
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
  // Fingers: a tap puts the eye there, one that drags moves the map, two zoom; Shift and a click ask why.
  app.setView("map");
  app.map.draw();
  const canvas = app.flatCanvas;
  canvas.setPointerCapture = () => {};
  const { left, top, width, height } = canvas.getBoundingClientRect();
  const finger = (type, pointerId, x, y, shiftKey = false) => {
    const at = { clientX: left + x * width, clientY: top + y * height };
    canvas.dispatchEvent(new PointerEvent(type, { pointerId, pointerType: "touch", bubbles: true, shiftKey, ...at }));
  };
  const before = { eye: [...model.eye], centre: [...app.map.centre], scale: app.map.scale };
  finger("pointerdown", 1, 0.4, 0.45);
  finger("pointerup", 1, 0.4, 0.45);
  const tapped = model.eye.some((x, k) => x !== before.eye[k]);
  finger("pointerdown", 1, 0.5, 0.5);
  finger("pointermove", 1, 0.6, 0.5);
  finger("pointerup", 1, 0.6, 0.5);
  const dragged = app.map.centre[0] !== before.centre[0];
  finger("pointerdown", 1, 0.4, 0.5);
  finger("pointerdown", 2, 0.6, 0.5);
  finger("pointermove", 2, 0.9, 0.5);
  finger("pointerup", 2, 0.9, 0.5);
  finger("pointerup", 1, 0.4, 0.5);
  const pinched = app.map.scale > 1.5 * before.scale;
  app.goToCell(0);
  app.frameAll();
  app.map.draw();
  const [x, y] = app.map.toScreen(app.map.flat(model.table.toTable(model.eye)));
  finger("pointerdown", 1, x / width, y / height, true);
  finger("pointerup", 1, x / width, y / height, true);
  const asked = model.cells.length === 0 || model.why.from === model.cells[0];
  const svg = app.map.svg();
  app.drawNow();
  const result = {
    wrong, problems, walked, locked, helped, found, tapped, dragged, pinched, asked,
    requests: performance.getEntriesByType("resource").length,
    link: location.hash, isSvg: svg.startsWith("<svg") && svg.includes("polygon"),
    facts: document.getElementById("facts").rows.length, worst: document.querySelectorAll("#worst button").length,
    wide: document.documentElement.scrollWidth <= innerWidth, injected: typeof globalThis.injected,
    notice: document.getElementById("notice").hidden ? null : document.getElementById("notice").textContent,
  };
  tell(result);
});
