// Looks through many frames of the example page with and without culling: how many pixels differ, what is drawn, and which objects one cannot do
// without. Put behind the page by a test, which has `given` and `tell` as well.
new Promise((loaded) => addEventListener("load", loaded))
  .then(() => window.ready)
  .then(({ table, scene, camera, renderer, draw, culling, setCulling }) => {
    const gl = renderer.getContext();
    const grab = () => {
      const { drawingBufferWidth: width, drawingBufferHeight: height } = gl;
      const bytes = new Uint8Array(4 * width * height);
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
      return new Uint32Array(bytes.buffer);
    };
    const picture = (by) => (by ? renderer.render(scene, by) : draw(), grab());
    const differ = (a, b) => a.reduce((n, pixel, i) => n + (pixel === b[i] ? 0 : 1), 0);
    // Shadows of all, over all.
    renderer.shadowMap.enabled = true;
    scene.traverse((object) => {
      if (object.isMesh) Object.assign(object, { castShadow: true, receiveShadow: true });
      if (!object.isDirectionalLight) return;
      object.castShadow = true;
      Object.assign(object.shadow.camera, { left: -60, right: 60, top: 60, bottom: -60, far: 300 });
      object.shadow.camera.updateProjectionMatrix();
    });
    const other = camera.clone();
    other.position.set(60, 40, 60);
    other.lookAt(15, 5, 10);
    let seed = 7;
    const chance = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
    // Far enough from walls for the near plane.
    const wide = table.cells.filter(({ min, max }) => min.every((x, k) => max[k] - x > 0.8));
    const told = { frames: 0, wrong: 0, wrongElsewhere: 0, flat: 0, calls: 0, callsAll: 0, needed: [] };
    for (; told.frames < given.frames; told.frames++) {
      const { min, max } = wide[Math.floor(chance() * wide.length)];
      camera.position.set(...table.toScene(min.map((x, k) => x + (0.1 + 0.8 * chance()) * (max[k] - x))));
      camera.rotation.y = 2 * Math.PI * chance();
      setCulling(true);
      const [elsewhere, culled] = [picture(other), picture()];
      told.calls += renderer.info.render.calls;
      const { place, meshes, hidden } = culling();
      setCulling(false);
      const [all, elsewhereAll] = [picture(), picture(other)];
      draw();
      told.callsAll += renderer.info.render.calls;
      told.wrong += differ(culled, all);
      told.wrongElsewhere += differ(elsewhere, elsewhereAll);
      told.flat += new Set(all).size < 3 ? 1 : 0;
      if (told.needed.length > 0 || place.cells.length !== 1) continue;
      // An object without which the picture is another, and that is not in the eye's cell.
      const [cell] = place.cells;
      for (const mesh of meshes.filter((mesh) => !hidden.some(({ object }) => object === mesh.object))) {
        const [id] = mesh.ids;
        if (table.cellObjects[cell].includes(id)) continue;
        mesh.object.layers.mask = 0;
        if (differ(picture(), all) > 0) told.needed.push([cell, id]);
        mesh.object.layers.mask = 1;
        if (told.needed.length > 0) break;
      }
    }
    tell(told);
  })
  .catch((error) => tell({ error: String(error.stack) }));
