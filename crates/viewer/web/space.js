// The scene in space, by WebGL 2: flat-shaded triangles, and lines for cells and portals.

const SOLID_VERTEX = `#version 300 es
in vec3 position;
in uint object;
uniform mat4 toClip;
uniform highp usampler2D states;
out vec3 place;
flat out uint state;
flat out uint id;
void main() {
  place = position;
  id = object;
  state = texelFetch(states, ivec2(int(object & 2047u), int(object >> 11)), 0).r;
  gl_Position = toClip * vec4(position, 1.0);
}`;

const SOLID_FRAGMENT = `#version 300 es
precision highp float;
in vec3 place;
flat in uint state;
flat in uint id;
uniform vec3 up;
uniform float ceiling;
uniform uint wanted;
uniform uint picking;
uniform vec3 palette[6];
uniform float opacity;
out vec4 colour;
void main() {
  if (state != wanted || dot(place, up) > ceiling) discard;
  if (picking == 1u) {
    uint n = id + 1u;
    colour = vec4(float(n & 255u), float(n >> 8 & 255u), float(n >> 16 & 255u), 255.0) / 255.0;
    return;
  }
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  vec3 light = normalize(up * 2.0 + vec3(0.6, 0.5, 0.3));
  float shade = 0.62 + 0.38 * abs(dot(normal, light));
  colour = vec4(palette[state] * shade, opacity);
}`;

const LINE_VERTEX = `#version 300 es
in vec3 position;
uniform mat4 toClip;
uniform vec3 up;
out float height;
void main() {
  height = dot(position, up);
  gl_Position = toClip * vec4(position, 1.0);
}`;

const LINE_FRAGMENT = `#version 300 es
precision highp float;
in float height;
uniform float ceiling;
uniform vec4 ink;
out vec4 colour;
void main() {
  if (height > ceiling) discard;
  colour = ink;
}`;

/** What is known of an object, as its state on the graphics device. */
const STATE = { hidden: 0, seen: 1, chosen: 2, gained: 3, lost: 4, pale: 5 };

class Space {
  constructor(canvas, model) {
    this.canvas = canvas;
    this.model = model;
    this.camera = new Camera(model.up);
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
    if (!gl) throw new Error("this browser shows no scenes in space: it has no WebGL 2");
    this.gl = gl;
    this.solid = program(gl, SOLID_VERTEX, SOLID_FRAGMENT);
    this.line = program(gl, LINE_VERTEX, LINE_FRAGMENT);
    this.upload();
    this.linesFor = null;
    this.lines = new Map();
  }

  /** Sends the triangles to the device once; without a figure, the boxes of the objects stand for them. */
  upload() {
    const { gl } = this;
    const figure = this.model.figure ?? boxesOf(this.model.table);
    this.figure = figure;
    const owners = new Uint32Array(figure.vertices.length / 3);
    for (let o = 0; o < figure.nObjects(); o++) {
      for (let k = 3 * figure.firsts[o]; k < 3 * figure.firsts[o + 1]; k++) owners[figure.triangles[k]] = o;
    }
    this.solidArray = gl.createVertexArray();
    gl.bindVertexArray(this.solidArray);
    buffer(gl, gl.ARRAY_BUFFER, figure.vertices);
    const position = gl.getAttribLocation(this.solid, "position");
    gl.enableVertexAttribArray(position);
    gl.vertexAttribPointer(position, 3, gl.FLOAT, false, 0, 0);
    buffer(gl, gl.ARRAY_BUFFER, owners);
    const object = gl.getAttribLocation(this.solid, "object");
    gl.enableVertexAttribArray(object);
    gl.vertexAttribIPointer(object, 1, gl.UNSIGNED_INT, 0, 0);
    buffer(gl, gl.ELEMENT_ARRAY_BUFFER, figure.triangles);
    gl.bindVertexArray(null);
    this.states = gl.createTexture();
    this.stateRows = Math.max(1, Math.ceil(figure.nObjects() / 2048));
  }

  uploadStates() {
    const { gl } = this;
    const texels = new Uint8Array(2048 * this.stateRows);
    texels.set(this.model.objectStates());
    gl.bindTexture(gl.TEXTURE_2D, this.states);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    const format = [gl.R8UI, 2048, this.stateRows, 0, gl.RED_INTEGER, gl.UNSIGNED_BYTE];
    gl.texImage2D(gl.TEXTURE_2D, 0, ...format, texels);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    this.drawn = texels;
  }

  /** Draws the runs of objects in one state, so that what is left out costs nothing. */
  drawState(state) {
    const { gl, figure, drawn } = this;
    gl.uniform1ui(gl.getUniformLocation(this.solid, "wanted"), state);
    const n = figure.nObjects();
    for (let o = 0; o < n; o++) {
      if (drawn[o] !== state) continue;
      const first = o;
      while (o + 1 < n && drawn[o + 1] === state) o++;
      const [from, to] = [figure.firsts[first], figure.firsts[o + 1]];
      if (to > from) gl.drawElements(gl.TRIANGLES, 3 * (to - from), gl.UNSIGNED_INT, 12 * from);
    }
  }

  resize() {
    const { canvas } = this;
    const ratio = window.devicePixelRatio || 1;
    const size = [canvas.clientWidth, canvas.clientHeight].map((x) => Math.max(1, Math.round(x * ratio)));
    if (canvas.width !== size[0]) canvas.width = size[0];
    if (canvas.height !== size[1]) canvas.height = size[1];
  }

  draw() {
    this.resize();
    const { gl, canvas, model } = this;
    const colours = theme();
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...channelsOf(colours.paper), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    this.uploadStates();
    this.useSolid(0);
    for (const state of [STATE.seen, STATE.chosen, STATE.gained, STATE.lost]) this.drawState(state);
    if (model.shows.ghosts) {
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
      gl.depthMask(false);
      gl.uniform1f(gl.getUniformLocation(this.solid, "opacity"), 0.16);
      this.drawState(STATE.hidden);
      this.drawState(STATE.pale);
      gl.depthMask(true);
      gl.disable(gl.BLEND);
    }
    this.drawLines(colours);
  }

  useSolid(picking) {
    const { gl, model } = this;
    const colours = theme();
    gl.useProgram(this.solid);
    gl.bindVertexArray(this.solidArray);
    const at = (name) => gl.getUniformLocation(this.solid, name);
    gl.uniformMatrix4fv(at("toClip"), false, this.clip());
    gl.uniform3fv(at("up"), axisVector(model.up));
    gl.uniform1f(at("ceiling"), model.ceiling - this.figure.origin[model.up]);
    gl.uniform1ui(at("picking"), picking);
    gl.uniform1f(at("opacity"), 1);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.states);
    gl.uniform1i(at("states"), 0);
    const palette = [colours.lost, colours.seen, colours.target, colours.gained, colours.lost, colours.seen];
    gl.uniform3fv(at("palette"), new Float32Array(palette.flatMap(channelsOf)));
  }

  clip() {
    const { clientWidth, clientHeight } = this.canvas;
    return this.camera.toClip(Math.max(clientWidth, 1) / Math.max(clientHeight, 1), this.figure.origin);
  }

  drawLines(colours) {
    const { gl, model } = this;
    gl.useProgram(this.line);
    gl.uniformMatrix4fv(gl.getUniformLocation(this.line, "toClip"), false, this.clip());
    gl.uniform3fv(gl.getUniformLocation(this.line, "up"), axisVector(model.up));
    const ceiling = model.ceiling - this.figure.origin[model.up];
    gl.uniform1f(gl.getUniformLocation(this.line, "ceiling"), ceiling);
    if (model.shows.cells) this.stroke("cells", () => cellEdges(model), colours.wall);
    if (model.shows.portals) this.stroke("portals", () => portalEdges(model), colours.portal);
    gl.uniform1f(gl.getUniformLocation(this.line, "ceiling"), 1e30);
    const here = model.cells.flatMap((cell) => boxEdges(model.table, model.table.cells[cell]));
    this.strokeNow(here, colours.from);
    this.drawWhy(colours);
    if (model.lock) this.strokeNow(crossAt(model.lock, model.size / 60), colours.target);
    if (model.lock && model.narrow) {
      const { eye } = model.narrow.view;
      const rays = edgesOf(model.narrow.view, model.table.dimension);
      const far = (ray) => eye.map((x, k) => x + (0.2 * model.size * ray[k]) / Math.hypot(...ray));
      this.strokeNow(rays.flatMap((ray) => [eye, far(ray)]).map((p) => model.table.toScene(p)), colours.from);
    }
    if (model.walk) {
      const path = model.walk.frames.map((frame) => frame.eye);
      this.strokeNow(path.slice(1).flatMap((p, i) => [path[i], p]), colours.line);
    }
  }

  /** The line between two cells with the portals that it crosses, or the walls in the way. */
  drawWhy(colours) {
    const { why, table } = this.model;
    if (!why) return;
    // It is shown through walls, so that it is found.
    this.gl.disable(this.gl.DEPTH_TEST);
    if (why.to !== why.from) this.strokeNow(boxEdges(table, table.cells[why.to]), colours.target);
    const ring = (points) => points.flatMap((p, k) => [p, points[(k + 1) % points.length]]).map((p) => table.toScene(p));
    const portals = why.line?.portals ?? why.obstacle?.portals ?? [];
    this.strokeNow(portals.flatMap((portal) => ring(table.portals[portal].points)), why.line ? colours.portal : colours.lost);
    this.strokeNow((why.obstacle?.walls ?? []).flatMap((wall) => boxEdges(table, wall)), colours.lost);
    if (why.line?.ends[0]) {
      const places = placesOf(why.line).map((p) => table.toScene(p));
      this.strokeNow(places.slice(1).flatMap((p, i) => [places[i], p]), colours.line);
    }
    this.gl.enable(this.gl.DEPTH_TEST);
  }

  /** Draws pairs of points that change seldom. */
  stroke(name, make, colour) {
    const key = this.model.storeyKey();
    if (this.lines.get(name)?.key !== key) {
      const old = this.lines.get(name);
      if (old) this.gl.deleteBuffer(old.buffer);
      this.lines.set(name, { key, ...this.lineBuffer(make()) });
    }
    this.strokeBuffer(this.lines.get(name), colour);
  }

  strokeNow(points, colour) {
    if (points.length === 0) return;
    const lines = this.lineBuffer(points);
    this.strokeBuffer(lines, colour);
    this.gl.deleteBuffer(lines.buffer);
  }

  lineBuffer(points) {
    const { origin } = this.figure;
    const list = new Float32Array(3 * points.length);
    points.forEach((p, i) => [0, 1, 2].forEach((k) => (list[3 * i + k] = p[k] - origin[k])));
    this.gl.bindVertexArray(null);
    return { buffer: buffer(this.gl, this.gl.ARRAY_BUFFER, list), n: points.length };
  }

  strokeBuffer({ buffer, n }, colour) {
    const { gl } = this;
    gl.bindVertexArray(null);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    const position = gl.getAttribLocation(this.line, "position");
    gl.enableVertexAttribArray(position);
    gl.vertexAttribPointer(position, 3, gl.FLOAT, false, 0, 0);
    gl.uniform4f(gl.getUniformLocation(this.line, "ink"), ...channelsOf(colour), 1);
    gl.drawArrays(gl.LINES, 0, n);
  }

  /** The object under a place of the canvas, or null. */
  pick(x, y) {
    const { gl, canvas } = this;
    this.resize();
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.uploadStates();
    this.useSolid(1);
    for (const state of Object.values(STATE)) {
      if (state !== STATE.hidden || this.model.shows.ghosts) this.drawState(state);
    }
    const ratio = canvas.width / Math.max(canvas.clientWidth, 1);
    const pixel = new Uint8Array(4);
    const row = canvas.height - 1 - Math.floor(y * ratio);
    gl.readPixels(Math.floor(x * ratio), row, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    const n = pixel[0] + 256 * pixel[1] + 65536 * pixel[2];
    return n > 0 ? n - 1 : null;
  }
}

function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  return made;
}

function buffer(gl, target, content) {
  const made = gl.createBuffer();
  gl.bindBuffer(target, made);
  gl.bufferData(target, content, gl.STATIC_DRAW);
  return made;
}

function axisVector(axis) {
  return [0, 1, 2].map((k) => (k === axis ? 1 : 0));
}

/** A box by its corners, the first bit of whose number is the first coordinate. */
function cornersOf({ min, max }) {
  return Array.from({ length: 8 }, (_, i) => [0, 1, 2].map((k) => ((i >> k) & 1 ? max[k] : min[k])));
}

/** The edges of a box along the axes of the table, as pairs of points of the scene. */
function boxEdges(table, box) {
  const corners = cornersOf(box).map((p) => table.toScene(p));
  const edges = [];
  for (let i = 0; i < 8; i++) {
    for (const bit of [1, 2, 4]) if (!(i & bit)) edges.push(corners[i], corners[i | bit]);
  }
  return edges;
}

function cellEdges(model) {
  return model.storeyCells().flatMap((cell) => boxEdges(model.table, model.table.cells[cell]));
}

function portalEdges(model) {
  const { table } = model;
  const inStorey = new Set(model.storeyCells());
  const portals = table.portals.filter(({ cells }) => cells.some((cell) => inStorey.has(cell)));
  return portals.flatMap(({ points }) => {
    const corners = points.map((p) => table.toScene(p));
    return corners.flatMap((p, k) => [p, corners[(k + 1) % corners.length]]);
  });
}

function crossAt(p, size) {
  return [0, 1, 2].flatMap((k) => [-size, size].map((step) => p.map((x, i) => (i === k ? x + step : x))));
}

/** The boxes of the objects as a figure, for a page without a scene. */
function boxesOf(table) {
  const n = table.objects.length;
  const [vertices, triangles] = [new Float32Array(24 * n), new Uint32Array(36 * n)];
  const firsts = Uint32Array.from({ length: n + 1 }, (_, o) => 12 * o);
  const quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
  const origin = table.objects.length > 0 ? table.toScene(table.objects[0].min) : [0, 0, 0];
  table.objects.forEach((object, o) => {
    cornersOf(object).forEach((p, i) => {
      table.toScene(p).forEach((x, k) => (vertices[24 * o + 3 * i + k] = x - origin[k]));
    });
    const corners = quads.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]);
    corners.forEach((i, k) => (triangles[36 * o + k] = 8 * o + i));
  });
  const figure = Object.create(Figure.prototype);
  return Object.assign(figure, { origin, notice: null, walls: new Float32Array(0), vertices, triangles, firsts });
}
