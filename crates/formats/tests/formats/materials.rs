//! Which objects of a scene hide, and which are only seen: by materials, roles, names and options.

use crate::common::glb::Doc;
use serde_json::{Value, json};
use sightlines_cells::{MovingObject, Scene, SceneObject};
use sightlines_formats::input::Neighbours;
use sightlines_formats::scene::{
    BackFaces, Role, SceneReadOptions, parse_glb, parse_gltf_with, parse_obj, parse_obj_with, write_glb,
};
use sightlines_formats::{Malformed, SceneFile};
use sightlines_geometry::Aabb;
use std::io;
use std::path::Path;

/// A document of a triangle for each of some nodes, with a material each.
pub(crate) fn doc(nodes: &[Value], materials: &[Value]) -> Doc {
    let list: Vec<Value> = nodes
        .iter()
        .enumerate()
        .map(|(k, node)| {
            let mut node = node.clone();
            node["mesh"] = json!(k);
            node
        })
        .collect();
    let mut doc = Doc::new(json!(list));
    for k in 0..nodes.len() {
        let positions = doc.positions(&[[0., 0., k as f32], [1., 0., 0.], [0., 1., 0.]]);
        doc.mesh(json!([{"attributes": {"POSITION": positions}}]));
        if k < materials.len() {
            doc.json["meshes"][k]["primitives"][0]["material"] = json!(k);
        }
    }
    doc.json["materials"] = json!(materials);
    doc
}

/// Reads a scene all walls of which hide from both sides, so that sides are asked about where a test is about sides.
pub(crate) fn read(doc: &Doc) -> SceneFile {
    read_with(doc, &options(&[], &[]))
}

pub(crate) fn options(opaque: &[&str], see_through: &[&str]) -> SceneReadOptions {
    let parse = |list: &[&str]| list.iter().map(|text| text.parse().unwrap()).collect();
    let backs = BackFaces::Drawn;
    SceneReadOptions { opaque: parse(opaque), see_through: parse(see_through), backs, ..SceneReadOptions::default() }
}

pub(crate) fn read_with(doc: &Doc, options: &SceneReadOptions) -> SceneFile {
    parse_gltf_with(&doc.glb(), None, options).unwrap()
}

/// How each object that is not simply a wall is classified, and why.
pub(crate) fn classified(file: &SceneFile) -> Vec<(u32, Role, &str)> {
    file.info.surfaces.iter().map(|t| (t.object, t.role, t.reason.as_str())).collect()
}

#[test]
fn materials_that_let_light_through_hide_nothing() {
    let extension = |name: &str| json!({"extensions": {name: {}}});
    let materials = [
        (json!({}), None),
        (json!({"alphaMode": "OPAQUE", "name": "wall", "doubleSided": true}), None),
        // Alpha below 1 means nothing in an opaque material.
        (json!({"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.1]}}), None),
        (extension("KHR_materials_clearcoat"), None),
        (extension("KHR_materials_pbrSpecularGlossiness"), None),
        (extension("KHR_materials_dispersion"), None),
        (
            json!({"extensions": {"KHR_materials_dispersion": {}, "KHR_materials_transmission": {}}}),
            Some("KHR_materials_transmission"),
        ),
        (extension("KHR_materials_nothing_yet"), Some("the unknown extension KHR_materials_nothing_yet")),
        (extension("KHR_techniques_webgl"), Some("the unknown extension KHR_techniques_webgl")),
        (json!({"alphaMode": "BLEND"}), Some("alphaMode BLEND")),
        (json!({"alphaMode": "MASK", "alphaCutoff": 0.9}), Some("alphaMode MASK")),
        (json!({"alphaMode": "ADD"}), Some("alphaMode ADD")),
        (extension("KHR_materials_transmission"), Some("KHR_materials_transmission")),
        (extension("KHR_materials_volume"), Some("KHR_materials_volume")),
        (extension("KHR_materials_diffuse_transmission"), Some("KHR_materials_diffuse_transmission")),
        (json!({"name": "Leaves-alpha"}), Some("a material named -alpha")),
        (json!({"alphaMode": 7}), Some("a material that cannot be read")),
        (json!(3), Some("a material that cannot be read")),
    ];
    let list: Vec<Value> = materials.iter().map(|m| m.0.clone()).collect();
    let file = read(&doc(&vec![json!({}); list.len() + 1], &list));
    let expected: Vec<(u32, Role, &str)> =
        (0..).zip(&materials).filter_map(|(k, m)| Some((k, Role::SeeThrough, m.1?))).collect();
    assert_eq!(classified(&file), expected);
    assert_eq!(file.scene.see_through().len(), expected.len());
    // All are there and seen; of those that hide, all but one are single-sided.
    assert_eq!((file.info.n_triangles, file.info.n_single_sided_triangles), (19, 6));
    let unknown = |name: &str| {
        format!(
            "1 material has the extension {name}, which is not known: they count as see-through; name what is opaque (--opaque)"
        )
    };
    assert_eq!(file.info.warnings, [unknown("KHR_materials_nothing_yet"), unknown("KHR_techniques_webgl")]);
    // A material that does not exist, and one that a variant brings.
    let mut other = doc(&[json!({}), json!({}), json!({})], &[json!({}), json!({"alphaMode": "BLEND"})]);
    other.json["meshes"][0]["primitives"][0]["material"] = json!(9);
    other.json["meshes"][2]["primitives"][0]["extensions"] = json!({"KHR_materials_variants": {"mappings": [{"material": 0, "variants": [0]}, {"material": 1, "variants": [1]}]}});
    let reasons: Vec<_> = read(&other).info.surfaces.into_iter().map(|t| (t.object, t.reason)).collect();
    assert_eq!(
        reasons,
        [
            (0, "a material that cannot be read".to_owned()),
            (1, "alphaMode BLEND".to_owned()),
            (2, "alphaMode BLEND of a variant".to_owned())
        ]
    );
}

/// A variant shows a primitive with another material: what hides with one of them only hides nothing.
#[test]
fn variants_count_by_their_roles_and_names() {
    let role = |role: &str| json!({"extras": {"sightlines": {"role": role}}});
    let mappings =
        |material: usize| json!({"KHR_materials_variants": {"mappings": [{"material": material, "variants": [0]}]}});
    let of = |own: Value, variant: Value, options: &SceneReadOptions| {
        let mut doc = doc(&[json!({"name": "pane"}), json!({})], &[own, variant]);
        doc.json["meshes"][0]["primitives"][0]["extensions"] = mappings(1);
        let file = read_with(&doc, options);
        let found = file.info.surfaces.iter().find(|found| found.object == 0);
        (found.map(|found| (found.role, found.reason.clone())), file.scene.is_opaque(0))
    };
    let none = options(&[], &[]);
    let found = |role: Role, reason: &str, hides: bool| (Some((role, reason.to_owned())), hides);
    assert_eq!(of(json!({}), json!({}), &none), (None, true));
    assert_eq!(of(json!({}), role("detail"), &none), found(Role::Detail, "extras of a variant", false));
    assert_eq!(of(role("detail"), role("occluder"), &none), found(Role::Detail, "extras", false));
    assert_eq!(of(role("occluder"), role("occluder"), &none), found(Role::Occluder, "extras", true));
    assert_eq!(of(json!({}), role("ignore"), &none), found(Role::SeeThrough, "extras of a variant", false));
    // A name that only a variant has.
    let glass = json!({"name": "Glass"});
    assert_eq!(
        of(json!({}), glass.clone(), &options(&[], &["glass"])),
        found(Role::SeeThrough, "the pattern glass of a variant", false)
    );
    // The own material is vouched for, the variant's is glass all the same; both may be vouched for by the name of the object.
    let blend = json!({"name": "Glass", "alphaMode": "BLEND"});
    let wall = json!({"name": "Wall"});
    let seen = of(wall.clone(), blend.clone(), &options(&["wall"], &[]));
    assert_eq!(seen, found(Role::SeeThrough, "alphaMode BLEND of a variant", false));
    assert_eq!(of(wall, blend, &options(&["pane"], &[])), (None, true));
    // Single-sided with one of them.
    let sided = SceneReadOptions::default();
    assert_eq!(of(json!({"doubleSided": true}), json!({"doubleSided": true}), &sided), (None, true));
    assert_eq!(of(json!({"doubleSided": true}), json!({}), &sided), (None, false));
}

/// Viewers have no room in what is flat; a flat volume beside others is a part of the box around all.
#[test]
fn flat_view_volumes_are_ignored_and_named() {
    let volume = |name: &str, scale: [f64; 3], z: f64| json!({"name": name, "scale": scale, "translation": [0.0, 0.0, z], "extras": {"sightlines": {"role": "view-volume"}}});
    let wall = || json!({"name": "wall"});
    let deck = |z: f64| volume("deck", [1.0, 1.0, 0.0], z);
    let line = || volume("line", [1.0, 0.0, 0.0], 0.0);
    let found = |nodes: &[Value]| {
        let info = read(&doc(nodes, &[])).info;
        (info.view_region().is_some(), info.view_volumes.len(), info.ignored_view_volumes, info.warnings)
    };
    let none = Vec::<String>::new;
    let warning = |volumes: &str, name: &str| {
        vec![format!("{volumes} flat and ignored, the first is called {name:?}: viewers have no room there")]
    };
    assert_eq!(found(&[wall()]), (false, 0, vec![], none()));
    assert_eq!(found(&[wall(), deck(0.0)]), (false, 1, vec![1], warning("1 view volume is", "deck")));
    assert_eq!(found(&[wall(), line(), deck(2.0)]), (false, 1, vec![1, 2], warning("2 view volumes are", "line")));
    // The twins: what has room alone, or with others.
    let room = || volume("room", [1.0; 3], 0.0);
    assert_eq!(found(&[wall(), room()]), (true, 1, vec![], none()));
    assert_eq!(found(&[wall(), deck(0.0), deck(2.0)]), (true, 2, vec![], none()));
    assert_eq!(found(&[wall(), room(), deck(2.0), line()]), (true, 2, vec![3], warning("1 view volume is", "line")));
}

#[test]
fn artists_say_otherwise() {
    let role = |role: &str| json!({"extras": {"sightlines": {"role": role}}});
    let named = |name: &str| json!({"name": name});
    let nodes = [
        role("occluder"),
        role("see-through"),
        role("detail"),
        role("door"),
        role("portal"),
        role("view-volume"),
        role("ignore"),
        role("mirror"),
        role("wall"),
        named("Fence-colonly"),
        named("House-occ"),
    ];
    let file = read(&doc(&nodes, &[json!({"alphaMode": "BLEND"})]));
    let all: Vec<(u32, Role)> = classified(&file).iter().map(|t| (t.0, t.1)).collect();
    let roles =
        [Role::Occluder, Role::SeeThrough, Role::Detail, Role::Door, Role::Portal, Role::ViewVolume, Role::Ignore];
    let expected: Vec<(u32, Role)> = (0..).zip(roles).chain([(9, Role::SeeThrough), (10, Role::Occluder)]).collect();
    assert_eq!(all, expected);
    assert_eq!((file.scene.see_through(), file.scene.mirrors()), (&[1, 2, 3, 4, 5, 6, 9][..], &[7][..]));
    // Places and helpers are not drawn; their ids stay.
    let n_triangles: Vec<usize> = file.scene.objects().iter().map(|o| o.triangles.len()).collect();
    assert_eq!(n_triangles, [1, 1, 1, 1, 0, 0, 0, 1, 1, 1, 1]);
    let [warning] = &file.info.warnings[..] else { panic!("{:?}", file.info.warnings) };
    assert_eq!(
        warning,
        "extras of nodes state a role that is none of occluder, see-through, detail, door, portal, view-volume, ignore, \
         mirror: 1, the first called \"\""
    );
    // A mirror of glass is both.
    let glass = doc(&[role("mirror")], &[json!({"alphaMode": "BLEND"})]);
    let file = read(&glass);
    assert_eq!((file.scene.mirrors(), file.scene.see_through()), (&[0][..], &[0][..]));
    // Meshes and materials have roles for all that has them; the most specific one counts.
    let blend = json!({"alphaMode": "BLEND"});
    let of = |node: Option<&str>, mesh: Option<&str>, material: Option<&str>| {
        let mut doc = doc(&[json!({})], std::slice::from_ref(&blend));
        let places = [("/nodes/0", node), ("/meshes/0", mesh), ("/materials/0", material)];
        for (path, stated) in places.into_iter().filter_map(|(path, stated)| Some((path, stated?))) {
            doc.json.pointer_mut(path).unwrap()["extras"] = role(stated)["extras"].clone();
        }
        let file = read(&doc);
        let &[(0, role, "extras")] = &classified(&file)[..] else { panic!("{:?}", file.info.surfaces) };
        (role, file.scene.is_opaque(0))
    };
    assert_eq!(of(None, None, Some("detail")), (Role::Detail, false));
    assert_eq!(of(None, Some("door"), None), (Role::Door, false));
    assert_eq!(of(Some("occluder"), None, None), (Role::Occluder, true));
    assert_eq!(of(Some("occluder"), Some("door"), None), (Role::Door, false));
    assert_eq!(of(Some("occluder"), Some("door"), Some("detail")), (Role::Detail, false));
    assert_eq!(of(Some("detail"), Some("detail"), Some("occluder")), (Role::Occluder, true));
    // A mirror says nothing of what hides.
    assert_eq!(of(Some("occluder"), None, Some("mirror")), (Role::Occluder, true));
}

#[test]
fn what_holds_for_a_node_holds_below_it() {
    let below = |parent: Value| {
        let mut doc = Doc::new(json!([parent, {"mesh": 0}]));
        doc.json["nodes"][0]["children"] = json!([1]);
        doc.json["scenes"][0]["nodes"] = json!([0]);
        doc.triangle();
        read(&doc)
    };
    let seen =
        |parent: Value| classified(&below(parent)).into_iter().map(|t| (t.1, t.2.to_owned())).collect::<Vec<_>>();
    let one = |role: Role, reason: &str| vec![(role, reason.to_owned())];
    assert_eq!(seen(json!({"name": "props-noimp"})), one(Role::SeeThrough, "a name with noimp"));
    assert_eq!(seen(json!({"extras": {"sightlines": {"role": "detail"}}})), one(Role::Detail, "extras"));
    let hidden = json!({"extensions": {"KHR_node_visibility": {"visible": false}}});
    assert_eq!(seen(hidden), one(Role::SeeThrough, "KHR_node_visibility"));
    assert_eq!(seen(json!({"extensions": {"KHR_node_visibility": {"visible": true}}})), []);
    assert_eq!(seen(json!({"name": "walls-occ"})), []);
    assert_eq!(seen(json!({"name": "hall-mirror"})), []);
}

#[test]
fn users_have_the_last_word() {
    let nodes = [json!({"name": "Front"}), json!({"name": "Pane.001"}), json!({"name": "Hedge"})];
    let materials = [json!({"name": "Brick"}), json!({"name": "Glass", "alphaMode": "BLEND"}), json!({"name": "Leaf"})];
    let doc = doc(&nodes, &materials);
    assert_eq!(read(&doc).scene.see_through(), [1]);
    let file = read_with(&doc, &options(&["glass"], &["leaf"]));
    assert_eq!(file.scene.see_through(), [2]);
    assert_eq!(
        classified(&file),
        [(1, Role::Occluder, "the pattern glass"), (2, Role::SeeThrough, "the pattern leaf")]
    );
    assert_eq!(file.info.read_with, options(&["glass"], &["leaf"]));
    let file = read_with(&doc, &options(&["*"], &["Pane*", "no such"]));
    assert_eq!(file.scene.see_through(), [1]);
    assert_eq!(file.info.warnings, ["no object, node, mesh or material is called no such"]);
}

#[test]
fn single_sides_hide_by_default_and_not_if_asked() {
    let mut doc = doc(&[json!({"name": "a"}), json!({}), json!({})], &[json!({}), json!({"doubleSided": true})]);
    // The third one is a closed tetrahedron.
    let closed = doc.positions(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]]);
    let sides = doc.indices(&[0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3], 1);
    doc.json["meshes"][2]["primitives"][0] = json!({"attributes": {"POSITION": closed}, "indices": sides});
    let asked = |backs: BackFaces| SceneReadOptions { backs, ..SceneReadOptions::default() };
    let single_sided = |file: &SceneFile| (0..3).filter(|&k| file.scene.is_single_sided(k)).collect::<Vec<_>>();
    for backs in BackFaces::ALL {
        let file = read_with(&doc, &asked(backs));
        let fronts: &[u32] = if backs == BackFaces::Drawn { &[] } else { &[0] };
        assert_eq!((file.scene.see_through(), file.scene.front_occluders()), (fronts, fronts), "{backs:?}");
        assert_eq!((file.info.n_single_sided_triangles, file.info.n_front_occluding_triangles), (5, fronts.len()));
        let seen_from_front: &[u32] = if backs == BackFaces::Culled { &[0, 2] } else { &[] };
        assert_eq!((single_sided(&file), classified(&file)), (seen_from_front.to_vec(), vec![]), "{backs:?}");
    }
    let opaque = options(&["a"], &[]).opaque;
    let file = read_with(&doc, &SceneReadOptions { opaque, ..SceneReadOptions::default() });
    assert_eq!(classified(&file), [(0, Role::Occluder, "the pattern a")]);
    assert!(file.scene.see_through().is_empty() && file.scene.front_occluders().is_empty());
}

/// A closed prism over a bow tie has one lobe inside out, through which engines show what is in it: it hides from its fronts only. The twin, over the
/// same corners in another order, is closed; the impostor is that only edges are looked at, in which the two do not differ.
#[test]
fn closed_things_that_cross_themselves_hide_from_their_fronts() {
    let asked = SceneReadOptions::default();
    let fronts_of = |outline: [[f32; 2]; 4]| {
        let mut doc = doc(&[json!({"name": "a"})], &[json!({})]);
        let corners: Vec<[f32; 3]> = [0.0, 3.0].iter().flat_map(|&z| outline.map(|[x, y]| [x, y, z])).collect();
        let closed = doc.positions(&corners);
        let walls = (0..4u32).flat_map(|i| [i, (i + 1) % 4, (i + 1) % 4 + 4, i, (i + 1) % 4 + 4, i + 4]);
        let sides: Vec<u32> = [0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7].into_iter().chain(walls).collect();
        let sides = doc.indices(&sides, 1);
        doc.json["meshes"][0]["primitives"][0] = json!({"attributes": {"POSITION": closed}, "indices": sides});
        let scene = read_with(&doc, &asked).scene;
        (scene.is_opaque(0), scene.front_occluders().to_vec())
    };
    assert_eq!(fronts_of([[0., 0.], [8., 0.], [2., 3.], [8., 3.]]), (false, vec![0]));
    assert_eq!(fronts_of([[0., 0.], [8., 0.], [8., 3.], [2., 3.]]), (true, vec![]));
}

/// A closed thing hides what is in it only if it is certain that its fronts are outwards: engines draw a mirrored instance inside out or do not.
/// The twins are a mirrored node, whose fronts glTF states, and instances that do not mirror; the impostor is that closed things always hide.
#[test]
fn closed_things_hide_only_if_their_fronts_are_certain() {
    const FLAT: f32 = 1.0 + 1e-6;
    let [plain, mirror, skew] = [
        json!({}),
        json!({"scale": [-1, 1, 1]}),
        json!({"matrix": [1, 1, 0, 0, 1, FLAT, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}),
    ];
    let tetrahedron = |node: &Value, instance: Option<[f32; 3]>, backs: BackFaces| {
        let mut doc = Doc::new(json!([node]));
        doc.json["nodes"][0]["mesh"] = json!(0);
        let corners = doc.positions(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]]);
        let sides = doc.indices(&[0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3], 1);
        doc.mesh(json!([{"attributes": {"POSITION": corners}, "indices": sides}]));
        if let Some(scale) = instance {
            let scales = doc.positions(&[scale]);
            doc.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": {"SCALE": scales}}});
        }
        let file = read_with(&doc, &SceneReadOptions { backs, ..SceneReadOptions::default() });
        assert!(file.scene.front_occluders().is_empty());
        file.scene.is_opaque(0)
    };
    for (node, instance, hides) in [
        (&plain, None, true),
        (&mirror, None, true),
        (&plain, Some([2., 1., 1.]), true),
        (&plain, Some([-1., -1., 1.]), true),
        (&mirror, Some([2., 1., 1.]), true),
        (&plain, Some([-1., 1., 1.]), false),
        (&mirror, Some([-1., 1., 1.]), false),
        (&skew, None, false),
    ] {
        for backs in BackFaces::ALL {
            let expected = hides || backs == BackFaces::Drawn;
            assert_eq!(tetrahedron(node, instance, backs), expected, "{node} {instance:?} {backs:?}");
        }
    }
}

#[test]
fn sides_are_left_out_only_where_that_is_certain() {
    let flat = json!({"scale": [-1.0, 1.0, 0.0]});
    let nodes = [
        json!({}),
        json!({}),
        json!({}),
        json!({}),
        json!({"scale": [-1.0, 1.0, 1.0]}),
        flat,
        json!({"name": "crate-rigid"}),
    ];
    let materials = [
        json!({}),
        json!({"extensions": {"KHR_materials_volume": {"thicknessFactor": 1.0}}}),
        json!({"extensions": {"NEEDLE_techniques_webgl": {}}}),
        json!({"name": 5}),
    ];
    let culled = SceneReadOptions { backs: BackFaces::Culled, ..SceneReadOptions::default() };
    let file = read_with(&doc(&nodes, &materials), &culled);
    let single: Vec<u32> = (0..7).filter(|&k| file.scene.is_single_sided(k)).collect();
    // The first is the twin: nothing speaks against it.
    assert_eq!(single, [0], "volumes, unknown extensions, what cannot be read, mirrored, flat, and what physics move");
    assert_eq!(file.scene.moving().len(), 1);
    assert!(!file.scene.is_opaque(6));
    // Of what is mirrored, flattened or moved nobody knows the front.
    let fronts = file.scene.front_occluders();
    assert!(fronts.contains(&0) && [4, 5, 6].iter().all(|object| !fronts.contains(object)), "{fronts:?}");
}

/// Files beside an OBJ.
#[derive(Debug)]
struct Files<'a>(&'a [(&'a str, &'a str)]);

impl Neighbours for Files<'_> {
    fn read(&self, path: &Path) -> io::Result<Option<Vec<u8>>> {
        let found = self.0.iter().find(|(name, _)| Path::new(name) == path);
        found.map(|(_, text)| Some(text.as_bytes().to_vec())).ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}

const FACES: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

fn obj(text: &str, files: &[(&str, &str)], options: &SceneReadOptions) -> Result<SceneFile, Malformed> {
    parse_obj_with(format!("{FACES}{text}").as_bytes(), Some(&Files(files)), options)
}

/// Names of objects, and whether each hides.
fn hiding(file: &SceneFile) -> Vec<(&str, bool)> {
    (0..).zip(file.scene.objects()).map(|(k, o)| (o.name.as_str(), file.scene.is_opaque(k))).collect()
}

#[test]
fn materials_of_an_obj_are_looked_up() {
    let mtl = "newmtl brick\nd 1\nnewmtl glass\nd 0.5\n";
    let text = "mtllib my walls.mtl\no house\nusemtl brick\nf 1 2 3\nusemtl glass\nf 1 2 4\no pane\nf 2 3 4\no post\n\
                usemtl brick\nf 1 3 4\no bare\nusemtl\nf 1 2 3\n";
    let none = SceneReadOptions::default();
    let file = obj(text, &[("my walls.mtl", mtl)], &none).unwrap();
    let split = [("house", true), ("house#see-through", false), ("pane", false), ("post", true), ("bare", true)];
    assert_eq!(hiding(&file), split);
    assert_eq!(classified(&file), [(1, Role::SeeThrough, "d 0.5"), (2, Role::SeeThrough, "d 0.5")]);
    assert!(file.info.warnings.is_empty());
    // Several libraries on a line, and in folders as Windows has them.
    let two = text.replace("my walls.mtl", r"a.mtl sub\b.mtl");
    let files = [("a.mtl", "newmtl brick\n"), ("sub/b.mtl", "newmtl glass\nTr 0.1\n")];
    assert_eq!(hiding(&obj(&two, &files, &none).unwrap()), split);
    // What nobody knows hides nothing; who knows says so.
    let file = obj(text, &[], &none).unwrap();
    assert_eq!(hiding(&file), [("house", false), ("pane", false), ("post", false), ("bare", true)]);
    assert_eq!(
        file.info.warnings,
        [
            "the material library \"my walls.mtl\" cannot be read: put it beside the OBJ; without it, faces with its materials \
          hide nothing"
        ]
    );
    assert_eq!(parse_obj(format!("{FACES}{text}").as_bytes()).unwrap(), file);
    assert_eq!(hiding(&obj(text, &[], &options(&["brick"], &[])).unwrap()), split);
    let file = obj(text, &[("my walls.mtl", "newmtl glass")], &none).unwrap();
    assert_eq!(classified(&file)[0].2, "a material that is in no library");
    // Without a library there are no materials.
    let bare = text.replace("mtllib", "#");
    let file = obj(&bare, &[], &none).unwrap();
    assert!(file.scene.see_through().is_empty());
    assert_eq!(
        file.info.warnings,
        [
            "4 faces have materials, such as \"brick\", and the file names no library (mtllib): they count as opaque; name what is \
             glass (--see-through)"
        ]
    );
    let file = obj(&bare, &[], &options(&[], &["glass"])).unwrap();
    assert_eq!(hiding(&file), split);
    // Names say as much as in a glTF.
    let file = obj("o walls-colonly\nf 1 2 3\no hall-mirror\nf 1 2 4\n", &[], &none).unwrap();
    assert_eq!((file.scene.see_through(), file.scene.mirrors()), (&[0][..], &[1][..]));
}

#[test]
fn what_is_written_hides_no_more() {
    let nodes = [json!({"name": "a"}), json!({"name": "b"}), json!({"name": "c-mirror"})];
    let blend = json!({"alphaMode": "BLEND"});
    let scene = read(&doc(&nodes, &[json!({}), blend.clone(), blend])).scene;
    let again = parse_glb(&write_glb(&scene).unwrap(), None).unwrap().scene;
    assert_eq!((again.see_through(), &again), (&[1, 2][..], &scene));
    // What moves may be anywhere afterwards, even if nothing of it has an area at rest.
    let within = Aabb { min: [0.0; 3], max: [5.0; 3] };
    let flat = SceneObject { vertices: vec![[1.0; 3]; 3], ..scene.objects()[0].clone() };
    let objects = scene.objects().iter().cloned().chain([flat]).collect();
    let marks = [(2, Some(within)), (3, None)].map(|(object, within)| MovingObject { object, within });
    let moving = Scene::new(objects).unwrap().with_mirrors(vec![2]).unwrap().with_moving(marks.to_vec()).unwrap();
    let again = parse_glb(&write_glb(&moving).unwrap(), None).unwrap().scene;
    let anywhere = |object| MovingObject { object, within: None };
    assert_eq!((again.moving(), again.mirrors()), (&[anywhere(2), anywhere(3)][..], &[2][..]));
    assert_eq!(again.objects(), moving.objects());
}

/// Programs write names such as `Material #25`; two of them are two, in the OBJ and in its library. Comments behind names are still
/// understood.
#[test]
fn names_of_an_obj_may_have_a_hash() {
    let none = SceneReadOptions::default();
    let library =
        "newmtl Material #25\nd 0.5\nnewmtl Material #26\nd 1 # solid\nnewmtl pane\nd 0.1\nnewmtl brick # red\nd 1\n";
    let face = |object: &str, material: &str| format!("o {object}\nusemtl {material}\nf 1 2 3 # a face\n");
    let text = ["#1 Wall", "Wall #2", "Wall #3", "Wall", "Rest"];
    let materials = ["Material #26", "Material #25", "pane # of glass", "brick", "Material #27"];
    let all: String = text.iter().zip(materials).map(|(object, material)| face(object, material)).collect();
    let file = obj(&format!("mtllib a#1.mtl\n{all}"), &[("a#1.mtl", library)], &none).unwrap();
    // Of what is called only like the beginning of others, the one that lets light through counts.
    assert_eq!(
        hiding(&file),
        [("#1 Wall", true), ("Wall #2", false), ("Wall #3", false), ("Wall", true), ("Rest", false)]
    );
    let file = obj(&format!("mtllib a.mtl # materials\n{all}"), &[("a.mtl", library)], &none).unwrap();
    assert_eq!((hiding(&file).len(), file.info.warnings), (5, vec![]));
}

/// Why each material of a library lets light through, as the object says that has it; `None` for one that does not.
fn reasons<const N: usize>(library: &str, names: [&str; N]) -> [Option<String>; N] {
    let faces: String = names.iter().map(|name| format!("o a\nusemtl {name}\nf 1 2 3\n")).collect();
    let file = obj(&format!("mtllib a.mtl\n{faces}"), &[("a.mtl", library)], &SceneReadOptions::default()).unwrap();
    let reason = |k: u32| file.info.surfaces.iter().find(|class| class.object == k).map(|class| class.reason.clone());
    std::array::from_fn(|k| reason(k as u32))
}

#[test]
fn glass_is_told_from_walls() {
    let text = "# materials\nd 0.1\nnewmtl wall\nKd 1 1 1\nTf 0.6 0.6 0.6\nd 1.0\nTr 0\nillum 2\nnewmtl glass\r\n  d 0.25\r\n\
                newmtl water\nTr 0.5 # half\nnewmtl leaf\nmap_d leaf mask.png\nnewmtl pane\nillum 4\nnewmtl halo\nd -halo 1\n\
                newmtl odd\nd\nnewmtl old glass\nd 1\nnewmtl old glass\nd 0.9";
    let names = ["wall", "glass", "water", "leaf", "pane", "halo", "odd", "old glass", "none"];
    let none = "a material that is in no library";
    let expected = ["", "d 0.25", "Tr 0.5", "map_d", "illum 4", "d -halo 1", "d", "d 0.9", none];
    // The same with the line ends of other systems.
    for text in [text.to_owned(), text.replace("\r\n", "\n").replace('\n', "\r")] {
        let found = reasons(&text, names);
        assert_eq!(found.each_ref().map(|why| why.as_deref().unwrap_or_default()), expected);
        assert_eq!(found[0], None);
    }
    for (illum, is_glass) in
        [(0, false), (3, false), (5, false), (8, false), (6, true), (9, true), (10, true), (11, true)]
    {
        let [found] = reasons(&format!("newmtl a\nillum {illum} # why"), ["a"]);
        assert_eq!(found.is_some(), is_glass, "illum {illum}");
    }
    let text = "newmtl Material #25\nd 0.5 # half\n#newmtl x\nnewmtl Material #26 # a wall\nd 1#\n# d 0";
    let [half, wall, x] = reasons(text, ["Material #25", "Material #26 # a wall", "x"]);
    assert_eq!((half.as_deref(), wall, x.as_deref()), (Some("d 0.5"), None, Some(none)));
    assert_eq!(reasons("", ["a"])[0].as_deref(), Some(none));
    let bytes = Files(&[]);
    let odd = parse_obj_with(
        format!("{FACES}mtllib \u{fffd}\nusemtl a\nf 1 2 3").as_bytes(),
        Some(&bytes),
        &SceneReadOptions::default(),
    );
    assert_eq!(odd.unwrap().info.warnings.len(), 1);
}

/// Of several libraries in a line those that are there are used, and those that are not are named.
#[test]
fn missing_libraries_take_no_others_with_them() {
    let text = "o house\nusemtl brick\nf 1 2 3\no pane\nusemtl glass\nf 1 2 4\no post\nusemtl lost\nf 1 3 4\n";
    let (a, b) = (("a.mtl", "newmtl brick\nd 1\n"), ("b.mtl", "newmtl glass\nd 0.5\n"));
    let missing = |name: &str| {
        format!(
            "the material library {name:?} cannot be read: put it beside the OBJ; without it, faces with its materials hide nothing"
        )
    };
    for (line, files, missing, hides) in [
        ("a.mtl none.mtl b.mtl", &[a, b][..], Some(missing("none.mtl")), [true, false, false]),
        ("none.mtl a.mtl", &[a], Some(missing("none.mtl")), [true, false, false]),
        ("b.mtl none.mtl", &[a, b], Some(missing("none.mtl")), [false, false, false]),
        ("a.mtl b.mtl", &[a, b], None, [true, false, false]),
        // None of them: it may be one name with spaces.
        ("my walls.mtl", &[a, b], Some(missing("my walls.mtl")), [false, false, false]),
        // So it may if a word is no name of a library; what is beside it by another word is then another one.
        ("my a.mtl", &[a, b], Some(missing("my a.mtl")), [false, false, false]),
        ("my a.mtl", &[("my a.mtl", b.1), a], None, [false, false, false]),
        ("a.mtl of house.MTL", &[a, b], Some(missing("a.mtl of house.MTL")), [false, false, false]),
        ("a.mtl no.MTL", &[a, b], Some(missing("no.MTL")), [true, false, false]),
    ] {
        let file = obj(&format!("mtllib {line}\n{text}"), files, &SceneReadOptions::default()).unwrap();
        assert_eq!(hiding(&file).into_iter().map(|(_, hides)| hides).collect::<Vec<_>>(), hides, "{line}");
        assert_eq!(file.info.warnings, missing.into_iter().collect::<Vec<_>>());
    }
}
