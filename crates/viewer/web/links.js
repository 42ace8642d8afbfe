// Links that open the page where somebody was: `#eye=1,2,3&yaw=0.5&pitch=0&lock=1&view=map`.

function readLink(text) {
  const fields = new URLSearchParams(text.replace(/^#/, ""));
  const numbers = (name, n) => {
    const list = (fields.get(name) ?? "").split(",").map(Number);
    return fields.has(name) && list.length === n && list.every(Number.isFinite) ? list : null;
  };
  const cell = numbers("cell", 1);
  return {
    eye: numbers("eye", 3) ?? (numbers("eye", 2) ? [...numbers("eye", 2), 0] : null),
    lock: numbers("lock", 3) ?? (numbers("lock", 2) ? [...numbers("lock", 2), 0] : null),
    isLocked: fields.get("lock") === "1",
    yaw: numbers("yaw", 1)?.[0] ?? null,
    pitch: numbers("pitch", 1)?.[0] ?? null,
    cell: cell && Number.isInteger(cell[0]) ? cell[0] : null,
    view: ["map", "space"].includes(fields.get("view")) ? fields.get("view") : null,
    why: whyOf(fields.get("why")),
    heat: ["cells", "polygons", "soon"].includes(fields.get("heat")) ? fields.get("heat") : null,
    reach: numbers("reach", 1)?.[0] ?? null,
  };
}

/** Two cells, such as 3-17. */
function whyOf(text) {
  const found = /^(\d+)-(\d+)$/.exec(text ?? "");
  return found ? [Number(found[1]), Number(found[2])] : null;
}

function writeLink(model, view, camera) {
  const d = model.table.dimension;
  const fields = [];
  // Shortest texts that are read back as the same doubles.
  if (model.eye) fields.push(`eye=${model.eye.slice(0, d).join(",")}`);
  if (model.lock) fields.push(`lock=${model.lock.slice(0, d).join(",")}`);
  if (view === "space" && camera) fields.push(`yaw=${camera.yaw.toFixed(4)}&pitch=${camera.pitch.toFixed(4)}`);
  if (d === 3) fields.push(`view=${view}`);
  if (model.why) fields.push(`why=${model.why.from}-${model.why.to}`);
  if (model.heat) fields.push(`heat=${model.heat}`);
  if (model.heat === "soon") fields.push(`reach=${model.reach}`);
  return `#${fields.join("&")}`;
}
