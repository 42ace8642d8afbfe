//! GLBs for tests, put together without the code that they test.

use serde_json::{Value, json};

/// A GLB of these chunks, padded as the format wants.
pub(crate) fn glb(text: &str, binary: &[u8]) -> Vec<u8> {
    let pad = |bytes: &[u8], with: u8| {
        let mut bytes = bytes.to_vec();
        while !bytes.len().is_multiple_of(4) {
            bytes.push(with);
        }
        bytes
    };
    let (text, binary) = (pad(text.as_bytes(), b' '), pad(binary, 0));
    let len = 12 + 8 + text.len() + if binary.is_empty() { 0 } else { 8 + binary.len() };
    let mut file = [b"glTF", &2u32.to_le_bytes()[..], &(len as u32).to_le_bytes()].concat();
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &binary)] {
        if !chunk.is_empty() {
            file.extend([&(chunk.len() as u32).to_le_bytes()[..], kind, chunk].concat());
        }
    }
    file
}

/// A document that grows, with one buffer.
#[derive(Debug, Clone)]
pub(crate) struct Doc {
    pub json: Value,
    pub binary: Vec<u8>,
}

impl Doc {
    /// A document with these nodes; the roots are all nodes without a parent, in one scene.
    pub(crate) fn new(nodes: Value) -> Self {
        let list = nodes.as_array().unwrap();
        let children: Vec<u64> = list
            .iter()
            .flat_map(|n| n["children"].as_array().into_iter().flatten())
            .map(|c| c.as_u64().unwrap_or(u64::MAX))
            .collect();
        let roots: Vec<u64> = (0..list.len() as u64).filter(|k| !children.contains(k)).collect();
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": roots}], "nodes": nodes,
            "meshes": [], "accessors": [], "bufferViews": [], "buffers": [{"byteLength": 0}]
        });
        Self { json, binary: Vec::new() }
    }

    pub(crate) fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.json[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    /// A buffer view of new bytes.
    pub(crate) fn view(&mut self, bytes: &[u8], stride: Option<usize>) -> usize {
        while !self.binary.len().is_multiple_of(4) {
            self.binary.push(0);
        }
        let mut view = json!({"buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len()});
        if let Some(stride) = stride {
            view["byteStride"] = json!(stride);
        }
        self.binary.extend(bytes);
        self.json["buffers"][0]["byteLength"] = json!(self.binary.len());
        self.push("bufferViews", view)
    }

    pub(crate) fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes, None);
        self.push("accessors", json!({"bufferView": view, "componentType": component, "type": kind, "count": count}))
    }

    pub(crate) fn positions(&mut self, points: &[[f32; 3]]) -> usize {
        let bytes: Vec<u8> = points.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let accessor = self.accessor(&bytes, 5126, "VEC3", points.len());
        // What the format wants and the reader does not need.
        let ends = |pick: fn(f32, f32) -> f32| [0, 1, 2].map(|k| points.iter().map(|p| p[k]).reduce(pick).unwrap());
        self.json["accessors"][accessor]["min"] = json!(ends(f32::min));
        self.json["accessors"][accessor]["max"] = json!(ends(f32::max));
        accessor
    }

    /// Indices of one, two or four bytes each.
    pub(crate) fn indices(&mut self, indices: &[u32], size: usize) -> usize {
        let component = [(1, 5121), (2, 5123), (4, 5125)].iter().find(|(s, _)| *s == size).unwrap().1;
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()[..size].to_vec()).collect();
        self.accessor(&bytes, component, "SCALAR", indices.len())
    }

    pub(crate) fn mesh(&mut self, primitives: Value) -> usize {
        self.push("meshes", json!({"primitives": primitives}))
    }

    /// A mesh of the triangle (0,0,0), (1,0,0), (0,1,0).
    pub(crate) fn triangle(&mut self) -> usize {
        let positions = self.positions(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
        self.mesh(json!([{"attributes": {"POSITION": positions}}]))
    }

    pub(crate) fn text(&self) -> String {
        self.json.to_string()
    }

    pub(crate) fn glb(&self) -> Vec<u8> {
        glb(&self.text(), &self.binary)
    }
}

/// A GLB with a little of everything: nested nodes, strips, sparse and quantised positions, two meshes.
pub(crate) fn small_doc() -> Doc {
    let mut doc = Doc::new(json!([
        {"name": "hall", "children": [2, 1], "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 10, 0, -3, 1]},
        {"name": "wall", "mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0.5, 0, 0.5]},
        {"mesh": 1, "scale": [-1, 1, 1]},
    ]));
    let square = doc.positions(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.]]);
    let list = doc.indices(&[0, 1, 2, 2, 1, 3, 3, 3, 0], 2);
    doc.mesh(
        json!([{"attributes": {"POSITION": square}, "indices": list}, {"attributes": {"POSITION": square}, "mode": 5}]),
    );
    let bytes: Vec<u8> =
        [[0i16, 0, 0, 0], [32767, 0, 0, 0], [0, 16384, 0, 0]].iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let view = doc.view(&bytes, Some(8));
    let (at, values) = (doc.view(&[2], None), doc.view(&[0, 0, 255, 127, 0, 64], None));
    let sparse =
        json!({"count": 1, "indices": {"bufferView": at, "componentType": 5121}, "values": {"bufferView": values}});
    let quantised = json!({"bufferView": view, "componentType": 5122, "normalized": true, "type": "VEC3", "count": 3, "sparse": sparse});
    let quantised = doc.push("accessors", quantised);
    let bytes = doc.indices(&[0, 1, 2], 1);
    doc.mesh(json!([{"attributes": {"POSITION": quantised}, "indices": bytes, "mode": 6}]));
    doc.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    doc
}

/// A GLB with a little of everything that a reader of triangles skips: attributes in one buffer view and in several, a pool
/// of vertices for two primitives, morph targets, a picture, an animation, a camera, extras, a second scene.
pub(crate) fn rich_doc() -> Doc {
    let mut doc = Doc::new(json!([
        {"name": "root", "children": [1, 2, 5], "translation": [0.1, 0.2, 0.3], "extras": {"bufferView": 9}},
        {"name": "left", "mesh": 0, "scale": [1, 1, -1]},
        {"name": "right", "mesh": 0, "translation": [5, 0, 0], "children": [3]},
        {"name": "below", "mesh": 1, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 7, 0, 1]},
        {"name": "elsewhere", "mesh": 2},
        {"camera": 0},
    ]));
    doc.json["scenes"] = json!([{"nodes": [0], "name": "first"}, {"nodes": [4]}]);
    doc.json["asset"] = json!({"version": "2.0", "generator": "a test", "extras": {"by": ["hand"]}});
    doc.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}]);
    doc.json["extensionsUsed"] = json!(["KHR_materials_unlit", "KHR_lights_punctual"]);
    doc.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    // A grid of nine points, each with a normal and a coordinate of textures in the same buffer view.
    let mut bytes = Vec::new();
    for k in 0..9u8 {
        let point = [f32::from(k % 3), f32::from(k / 3), f32::from(k * k) / 8.0, 0.0, 0.0, 1.0];
        bytes.extend(point.iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([f32::from(k) / 8.0, 0.25].iter().flat_map(|x| x.to_le_bytes()));
    }
    let view = doc.view(&bytes, Some(32));
    let part = |offset: usize, kind: &str| json!({"bufferView": view, "byteOffset": offset, "componentType": 5126, "type": kind, "count": 9});
    let mut position = part(0, "VEC3");
    (position["min"], position["max"]) = (json!([0, 0, 0]), json!([2, 2, 8]));
    position["name"] = json!("places");
    let pool = [("POSITION", position), ("NORMAL", part(12, "VEC3")), ("TEXCOORD_0", part(24, "VEC2"))];
    let pool: Vec<(&str, usize)> = pool.into_iter().map(|(name, a)| (name, doc.push("accessors", a))).collect();
    // Colours of three bytes, each at a multiple of four; a word of one byte for each corner of our own making.
    let colours: Vec<u8> = (0..9u8).flat_map(|k| [k, 2 * k, 255 - k, 77]).collect();
    let colours = doc.view(&colours, Some(4));
    let colours = doc.push(
        "accessors",
        json!({"bufferView": colours, "componentType": 5121, "normalized": true, "type": "VEC3", "count": 9}),
    );
    let mut attributes = json!({"COLOR_0": colours});
    for (name, accessor) in &pool {
        attributes[name] = json!(accessor);
    }
    let moved = doc.positions(&[[0.0, 0.0, 0.5]; 9]);
    let first = doc.indices(&[0, 1, 3, 1, 4, 3, 1, 2, 4], 1);
    let second = doc.indices(&[3, 4, 6, 7, 5, 8], 2);
    doc.push("meshes", json!({"name": "grid", "extras": [1, 2], "weights": [0], "primitives": [
        {"attributes": attributes, "indices": first, "material": 1, "targets": [{"POSITION": moved}], "extras": "x"},
        {"attributes": attributes, "indices": second, "material": 0, "mode": 5, "targets": [{"POSITION": moved}]},
    ]}));
    let alone = doc.positions(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]]);
    let ends = doc.indices(&[0, 1, 2, 0, 2, 3], 4);
    let line = doc.indices(&[0, 3], 1);
    doc.mesh(json!([{"attributes": {"POSITION": alone}, "indices": ends}, {"attributes": {"POSITION": alone}, "indices": line, "mode": 1}]));
    doc.triangle();
    let picture = doc.view(b"\x89PNG and so on", None);
    doc.json["images"] = json!([{"bufferView": picture, "mimeType": "image/png"}, {"uri": "nowhere.png"}]);
    doc.json["textures"] = json!([{"source": 0}, {"source": 1}]);
    doc.json["materials"] = json!([
        {"name": "plain", "extensions": {"KHR_materials_unlit": {}}},
        {"name": "painted", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}},
    ]);
    let times = doc.accessor(&[0, 0, 0, 0, 0, 0, 128, 63], 5126, "SCALAR", 2);
    (doc.json["accessors"][times]["min"], doc.json["accessors"][times]["max"]) = (json!([0]), json!([1]));
    let weights = doc.accessor(&[0; 8], 5126, "SCALAR", 2);
    let turns: Vec<u8> = [[0f32; 3], [1.0; 3]].iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let moves = doc.accessor(&turns, 5126, "VEC3", 2);
    doc.json["animations"] = json!([{
        "samplers": [{"input": times, "output": moves}, {"input": times, "output": weights}],
        "channels": [
            {"sampler": 0, "target": {"node": 0, "path": "translation"}},
            {"sampler": 1, "target": {"node": 1, "path": "weights"}},
        ],
    }]);
    doc
}

/// An OBJ with a little of everything.
pub(crate) const SMALL_OBJ: &str = "# a room
mtllib x.mtl
v 0 0 0
v 4 0 0 1.0
v 4 3 0 0.5 0.5 0.5
v 0 3 0
vt 0 0
vn 0 0 1
o floor
usemtl wood
f 1//1 2/1/1 3/1 4
v 2.5e0 1 0
o notch
s off
f 1 2 5 \\
  4
f -5 -4 -1
l 1 2
";
