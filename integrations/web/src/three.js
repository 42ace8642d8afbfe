// Culls a scene of three.js by a table: what cannot be seen from the camera is not drawn for this camera. Nothing of three is imported.

/** A hook of an object with another call before it; the function returned undoes it. */
function before(object, name, call) {
  const own = Object.getOwnPropertyDescriptor(object, name);
  const usual = object[name];
  const hook = function (...values) {
    call(...values);
    return usual?.apply(this, values);
  };
  object[name] = hook;
  return () => {
    if (object[name] !== hook) return;
    if (own) object[name] = usual;
    else delete object[name];
  };
}

/** Finds the objects of the table that an object of the scene shows: by its name alone, or by what the loader of glTF made it of. */
function finder(table, associations) {
  // The loader makes names fit for animations, and leaves the true ones here.
  if (!associations) return (object) => table.named(object.userData.name ?? object.name);
  const byPlace = new Map(table.objects.map(({ id, node, primitive }) => [`${node}/${primitive}`, id]));
  // Some versions of the loader let copies of a mesh share one entry, which then has the node of only one of them.
  const uses = new Map();
  for (const place of associations.values()) uses.set(place, (uses.get(place) ?? 0) + 1);
  return (object) => {
    const own = associations.get(object);
    // What others hang into the scene is not of the file.
    if (own?.primitives === undefined) return [];
    for (let at = object; at; at = at.parent) {
      const place = associations.get(at);
      if (place?.nodes === undefined) continue;
      const id = uses.get(place) === 1 ? byPlace.get(`${place.nodes}/${own.primitives}`) : undefined;
      return id === undefined ? [] : [id];
    }
    return [];
  };
}

/** The class Object3D: the last with this method. */
function baseOf(object) {
  let base = Object.getPrototypeOf(object);
  for (let next = base; next; next = Object.getPrototypeOf(next)) if (next.updateMatrixWorld) base = next;
  return base.constructor;
}

/** What `cull` returns. */
class Culling {
  constructor(scene, table, camera, { gltf, root = gltf?.scene ?? scene, find, narrow = false, doors = null, batches = [] } = {}) {
    Object.assign(this, { table, camera, root, narrow, doors, find: find ?? finder(table, gltf?.parser?.associations) });
    this.masked = [];
    this.key = null;
    this.hidden = [];
    this.update();
    // The renderer asks for levels of detail when it gathers what to draw. At the end of that shadows, which come next, and all other cameras find
    // the scene as it was.
    const end = new (baseOf(scene))();
    Object.assign(end, { isLOD: true, autoUpdate: true, update: () => this.show() });
    end.layers.mask = -1;
    scene.add(end);
    this.undo = [
      before(scene, "onBeforeRender", (_renderer, _scene, by) => {
        this.show();
        if (by !== camera) return;
        if (scene.children.at(-1) !== end) scene.add(end);
        this.hide();
      }),
      before(scene, "onAfterRender", () => this.show()),
      () => scene.remove(end),
      ...batches.map((batch) => this.batch(batch)),
    ];
  }

  /** Looks for the objects of the scene anew, after some were added or removed. */
  update() {
    this.meshes = [];
    this.root.traverse((object) => {
      const ids = object.geometry && !object.isBatchedMesh ? this.find(object) : null;
      // What the table does not have is always drawn.
      if (ids?.length > 0) this.meshes.push({ object, ids });
    });
    this.key = null;
    return this;
  }

  /** What may be seen from the camera. */
  look() {
    const { camera, root, table, doors } = this;
    const eye = root.worldToLocal(camera.position.clone().setFromMatrixPosition(camera.matrixWorld));
    this.place = table.at(eye);
    if (!this.narrow && !doors) return this.place;
    const matrix = this.narrow && camera.isPerspectiveCamera ? camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse).multiply(root.matrixWorld) : null;
    return this.place.narrow(matrix && { viewProjection: matrix.elements }, { doors });
  }

  hide() {
    const seen = this.look();
    // Within the same cells the same is seen.
    const key = seen === this.place ? this.place.cells.join() : null;
    if (key === null || key !== this.key) {
      const set = seen.objectBits;
      const sees = set ? (id) => (set[id >>> 5] >>> (id & 31)) & 1 : (id) => seen.sees(id);
      this.hidden = this.meshes.filter(({ ids }) => !ids.some(sees));
    }
    this.key = key;
    this.masked = this.hidden.map(({ object }) => {
      const { mask } = object.layers;
      object.layers.mask = 0;
      return { object, mask };
    });
  }

  show() {
    for (const { object, mask } of this.masked) object.layers.mask = mask;
    this.masked = [];
  }

  /** Hides instances of a BatchedMesh while it is drawn for the camera. `objects` has the object of each instance, or -1. */
  batch({ mesh, objects }) {
    const usual = mesh.onBeforeRender;
    mesh.onBeforeRender = (renderer, scene, by, ...rest) => {
      const seen = by === this.camera ? this.look() : null;
      const hidden = [];
      objects.forEach((object, instance) => {
        if (seen && object >= 0 && !seen.sees(object) && mesh.getVisibleAt(instance)) hidden.push(instance);
      });
      for (const instance of hidden) mesh.setVisibleAt(instance, false);
      usual.call(mesh, renderer, scene, by, ...rest);
      for (const instance of hidden) mesh.setVisibleAt(instance, true);
    };
    return () => delete mesh.onBeforeRender;
  }

  /** Draws everything again. */
  dispose() {
    this.show();
    for (const undo of this.undo) undo();
    this.undo = [];
  }
}

/** Draws for this camera only what the table says may be seen from it. Shadows and other cameras keep everything. */
export function cull(scene, table, camera, options) {
  return new Culling(scene, table, camera, options);
}
