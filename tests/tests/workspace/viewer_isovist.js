// The areas of isovists from all eyes, and whether the pointer draws one.
ready.then((app) => {
  const areas = given.map((eye) => app.isovistAt(eye).area);
  app.setView("map");
  const before = app.map.svg();
  document.getElementById("isovist").click();
  const canvas = app.flatCanvas;
  const { left, top, width, height } = canvas.getBoundingClientRect();
  const [x, y] = app.map.toScreen(app.map.flat(app.model.table.toTable(given[0])));
  canvas.dispatchEvent(new PointerEvent("pointermove", { clientX: left + x, clientY: top + y, pointerId: 1 }));
  const hovered = app.map.svg();
  tell({ areas, isDrawn: !before.includes("<path") && hovered.includes("<path"), text: document.getElementById("area").textContent });
});
