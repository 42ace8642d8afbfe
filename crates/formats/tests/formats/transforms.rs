//! Transforms of nodes: rotations by right angles, and mirrors, which turn triangles round. And what objects have of the corners in a file.

use crate::common::glb::Doc;
use serde_json::{Value, json};
use sightlines_formats::scene::{parse_glb, parse_obj};

/// Corners of an object with these, in nodes one in the other, and whether its triangle was turned round.
fn placed(corners: &[[f32; 3]; 3], nodes: &[Value]) -> Option<(Vec<[f64; 3]>, bool)> {
    let mut nodes = nodes.to_vec();
    let last = nodes.len() - 1;
    (0..last).for_each(|k| nodes[k]["children"] = json!([k + 1]));
    nodes[last]["mesh"] = json!(0);
    let mut doc = Doc::new(json!(nodes));
    let positions = doc.positions(corners);
    doc.mesh(json!([{"attributes": {"POSITION": positions}}]));
    let object = parse_glb(&doc.glb(), None).ok()?.scene.objects()[0].clone();
    Some((object.vertices.clone(), object.triangles[0] == [0, 2, 1]))
}

const AXES: [[f32; 3]; 3] = [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];

#[test]
fn right_angles_are_exact() {
    let h = f64::from(std::f32::consts::FRAC_1_SQRT_2);
    // The images of the axes are the columns of the rotation.
    let quarter = |q: [f64; 4]| {
        let columns = placed(&AXES, &[json!({"rotation": q})]).unwrap().0;
        [0, 1, 2].map(|row| [0, 1, 2].map(|column: usize| columns[column][row]))
    };
    assert_eq!(quarter([h, 0., 0., h]), [[1., 0., 0.], [0., 0., -1.], [0., 1., 0.]]);
    assert_eq!(quarter([0., h, 0., h]), [[0., 0., 1.], [0., 1., 0.], [-1., 0., 0.]]);
    assert_eq!(quarter([0., 0., -h, h]), [[0., 1., 0.], [-1., 0., 0.], [0., 0., 1.]]);
    assert_eq!(quarter([0., h, h, 0.]), [[-1., 0., 0.], [0., 0., 1.], [0., 1., 0.]]);
    assert_eq!(quarter([0.5, 0.5, 0.5, 0.5]), [[0., 0., 1.], [1., 0., 0.], [0., 1., 0.]]);
    assert_eq!(quarter([0., 0., 0., -3.]), [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]]);
    assert_eq!(placed(&AXES, &[json!({"rotation": [0, 0, 0, 0]})]), None);
}

#[test]
fn mirrors_are_distinguished_from_turns() {
    let is_turned = |scale: [f64; 3]| placed(&AXES, &[json!({"scale": scale})]).unwrap().1;
    assert!(is_turned([-1., 1., 1.]) && is_turned([-1., -2., -1.]));
    assert!(!is_turned([-1., -1., 1.]) && !is_turned([2., 1., 1.]) && !is_turned([-1., 0., 1.]));
    let swap = json!({"matrix": [0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]});
    let corners = [[1., 2., 3.], [0., 1., 0.], [0., 0., 1.]];
    let (once, is_mirrored) = placed(&corners, std::slice::from_ref(&swap)).unwrap();
    assert_eq!((once[0], is_mirrored), ([7., 7., 10.], true));
    let (twice, is_mirrored) = placed(&corners, &[swap.clone(), swap.clone()]).unwrap();
    let again = [once[0].map(|x| x as f32), corners[1], corners[2]];
    assert_eq!((twice[0], is_mirrored), (placed(&again, &[swap]).unwrap().0[0], false));
}

/// Objects have the corners that their faces use, in the order of the file.
#[test]
fn unused_corners_are_left_out() {
    let corners: String = (0..10).map(|k| format!("v {k} {} 0\n", k * k)).collect();
    let file = parse_obj(format!("{corners}f 10 5 8\nf 5 5 8\n").as_bytes()).unwrap();
    let object = &file.scene.objects()[0];
    assert_eq!(object.vertices, [[4., 16., 0.], [7., 49., 0.], [9., 81., 0.]]);
    assert_eq!(object.triangles, [[2, 0, 1]]);
}
