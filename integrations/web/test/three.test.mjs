// The adapter for three.js, on a small stand-in for it: what is hidden is not gathered for the camera, and shadows and other cameras find all of it.
// SIGHTLINES_PACKAGE is the packed package.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import test from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { smallTable } from "./small.mjs";

const here = path.dirname(fileURLToPath(import.meta.url));
const folder = process.env.SIGHTLINES_PACKAGE ?? fs.mkdtempSync(path.join(os.tmpdir(), "sightlines-"));
if (!process.env.SIGHTLINES_PACKAGE) execFileSync("node", [path.join(here, "../pack.mjs"), folder]);
const { Table } = await import(pathToFileURL(path.join(folder, "index.js")));
const { cull } = await import(pathToFileURL(path.join(folder, "three.js")));

class Layers {
  mask = 1;

  test(layers) {
    return (this.mask & layers.mask) !== 0;
  }
}

class Vector3 {
  constructor(x = 0, y = 0, z = 0) {
    Object.assign(this, { x, y, z });
  }

  clone() {
    return new Vector3(this.x, this.y, this.z);
  }

  setFromMatrixPosition({ elements }) {
    [this.x, this.y, this.z] = elements.slice(12, 15);
    return this;
  }
}

class Object3D {
  layers = new Layers();
  children = [];
  parent = null;
  position = new Vector3();
  userData = {};
  name = "";

  add(child) {
    child.parent?.remove(child);
    child.parent = this;
    this.children.push(child);
    return this;
  }

  remove(child) {
    this.children = this.children.filter((one) => one !== child);
    child.parent = null;
  }

  traverse(call) {
    call(this);
    this.children.forEach((child) => child.traverse(call));
  }

  updateMatrixWorld() {
    const { x, y, z } = this.position;
    this.matrixWorld = { elements: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1] };
  }

  worldToLocal(v) {
    return v;
  }
}

class Scene extends Object3D {
  isScene = true;

  onBeforeRender() {}
}

class Mesh extends Object3D {
  isMesh = true;
  geometry = {};

  constructor(name) {
    super();
    this.name = name;
  }
}

/** The order of things in the renderer of three: hooks, then what is gathered, then shadows, then what was gathered. */
function render(scene, camera) {
  camera.updateMatrixWorld();
  scene.onBeforeRender(null, scene, camera, null);
  const [drawn, shadows] = [[], []];
  const gather = (object) => {
    if (object.layers.test(camera.layers)) {
      if (object.isLOD) object.update(camera);
      else if (object.isMesh) drawn.push(object.name);
    }
    object.children.forEach(gather);
  };
  gather(scene);
  scene.traverse((object) => object.isMesh && object.layers.test(camera.layers) && shadows.push(object.name));
  scene.onAfterRender?.(null, scene, camera);
  return { drawn, shadows };
}

function world() {
  const table = Table.read(smallTable());
  const scene = new Scene();
  const [chair, lamp, vase, sky] = ["chair", "lamp", "vase", "sky"].map((name) => new Mesh(name));
  // The lamp hangs from the vase: to hide the one must not hide the other.
  vase.add(lamp);
  for (const mesh of [chair, vase, sky]) scene.add(mesh);
  const camera = new Object3D();
  camera.position = new Vector3(0.5, 0.5, 0);
  return { table, scene, camera, chair, lamp, vase, sky };
}

const ALL = ["chair", "vase", "lamp", "sky"];

test("what cannot be seen is not drawn for the camera, and casts shadows", () => {
  const { table, scene, camera } = world();
  const culling = cull(scene, table, camera);
  assert.equal(culling.meshes.length, 3);
  assert.deepEqual(render(scene, camera), { drawn: ["chair", "lamp", "sky"], shadows: ALL });
  assert.deepEqual(culling.hidden.map(({ object }) => object.name), ["vase"]);
  assert.deepEqual(render(scene, new Object3D()), { drawn: ALL, shadows: ALL });
  camera.position = new Vector3(2.5, 0.5, 0);
  assert.deepEqual(render(scene, camera).drawn, ["vase", "lamp", "sky"]);
  // Outside of all cells nothing is known.
  camera.position = new Vector3(9, 9, 0);
  assert.deepEqual(render(scene, camera).drawn, ALL);
  // What was added is drawn until it is looked for.
  camera.position = new Vector3(0.5, 0.5, 0);
  scene.add(new Mesh("vase"));
  assert.deepEqual(render(scene, camera).drawn, ["chair", "lamp", "sky", "vase"]);
  culling.update();
  assert.deepEqual(render(scene, camera).drawn, ["chair", "lamp", "sky"]);
});

test("all is as before when it is disposed of", () => {
  const { table, scene, camera, vase } = world();
  const [hook, n] = [scene.onBeforeRender, scene.children.length];
  vase.layers.mask = 6;
  camera.layers.mask = 2;
  const culling = cull(scene, table, camera);
  assert.deepEqual(render(scene, camera).drawn, []);
  assert.equal(vase.layers.mask, 6);
  culling.dispose();
  culling.dispose();
  assert.deepEqual(render(scene, camera).drawn, ["vase"]);
  assert.equal(scene.onBeforeRender, hook);
  assert.ok(!Object.hasOwn(scene, "onBeforeRender") && !Object.hasOwn(scene, "onAfterRender") && scene.children.length === n);
});

test("objects are found by node and primitive, by given functions, and behind doors", () => {
  const { table, scene, camera, chair, lamp, vase } = world();
  const associations = new Map([[chair, { nodes: 9 }], [vase, { nodes: 4, meshes: 0, primitives: 0 }], [lamp, { meshes: 0, primitives: 1 }]]);
  chair.name = "";
  // Hung into the scene by somebody else.
  vase.add(new Mesh("hat"));
  const culling = cull(scene, table, camera, { gltf: { scene, parser: { associations } } });
  // The table says of its objects: the node 4 and its primitives 0 and 1, and nothing of the third.
  assert.deepEqual(culling.meshes.map(({ object, ids }) => [object.name, ids]), [["vase", [0]], ["lamp", [1]]]);
  culling.dispose();
  // Copies that share an entry are not told apart, and always drawn.
  const shared = cull(scene, table, camera, { gltf: { scene, parser: { associations: new Map([...associations, [chair, associations.get(vase)]]) } } });
  assert.deepEqual(shared.meshes, []);
  shared.dispose();
  const doors = table.openDoors().close("gate");
  const behind = cull(scene, table, camera, { doors, find: (object) => (object === vase ? [1] : null) });
  assert.deepEqual(render(scene, camera).drawn, ["", "lamp", "hat", "sky"]);
  doors.open("gate");
  assert.deepEqual(render(scene, camera).drawn, ["", "vase", "lamp", "hat", "sky"]);
  behind.dispose();
});

test("instances of a batch are hidden while it is drawn for the camera", () => {
  const { table, scene, camera } = world();
  const visible = [true, true, false, true];
  const mesh = Object.assign(new Mesh("batch"), { isBatchedMesh: true, getVisibleAt: (i) => visible[i], setVisibleAt: (i, on) => (visible[i] = on) });
  let drawn = null;
  Object.getPrototypeOf(mesh).onBeforeRender = () => (drawn = [...visible]);
  scene.add(mesh);
  const culling = cull(scene, table, camera, { batches: [{ mesh, objects: [0, 2, 0, -1] }] });
  render(scene, camera);
  mesh.onBeforeRender(null, scene, camera);
  assert.deepEqual(drawn, [true, false, false, true]);
  mesh.onBeforeRender(null, scene, new Object3D());
  assert.deepEqual([drawn, visible], [[true, true, false, true], [true, true, false, true]]);
  culling.dispose();
  assert.ok(!Object.hasOwn(mesh, "onBeforeRender"));
  delete Mesh.prototype.onBeforeRender;
});
