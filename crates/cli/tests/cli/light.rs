//! `light`: what the picture shows is what is printed, more depth decides more, and what cannot be drawn is refused in one line.

use crate::common::Folder;
use crate::common::picture::Picture;
use serde_json::Value;

/// A floor, and a board over it.
const BOARD: &str = "v -8 0 -8\nv -8 0 8\nv 8 0 8\nv 8 0 -8\nf 1 2 3\nf 1 3 4\nv -2 3 -2\nv -2 3 2\nv 2 3 2\nv 2 3 -2\n\
                     o board\nf 5 6 7\nf 5 7 8\n";
const VIEW: [&str; 6] = ["--eye", "0.1,2.5,9", "--look-at", "0,0.2,0", "--size", "96x72"];

fn light(folder: &Folder, more: &[&str]) -> Value {
    let args =
        [&["light", "board.obj", "--light", "-1,8,-1,1,8,1", "-o", "out.png", "--json"][..], &VIEW, more].concat();
    folder.run(&args).expect(0).json()
}

fn number(reply: &Value, key: &str) -> f64 {
    reply[key].as_f64().unwrap_or_else(|| panic!("{key}: {reply}"))
}

fn with_board() -> Folder {
    let folder = Folder::new();
    folder.write("board.obj", BOARD);
    folder
}

#[test]
fn more_halves_decide_more() {
    let folder = with_board();
    let reply = [2, 6, 10].map(|depth: u32| light(&folder, &["--depth", &depth.to_string()]));
    let doubt = reply.each_ref().map(|t| number(t, "pixels_in_doubt"));
    assert!(doubt[0] > doubt[1] && doubt[1] > doubt[2] && doubt[2] > 0.0, "{doubt:?}");
    assert!(number(&reply[2], "pixels_umbra") > 50.0 && number(&reply[2], "pixels_lit") > 1000.0, "{}", reply[2]);
    assert!(number(&reply[2], "rays") < 0.5 * number(&reply[2], "rays_else"));
    // The share of the light is the same to the eye whatever is proven: pictures of shares differ by what rays estimate.
    let grey = ["2", "10"].map(|depth| {
        light(&folder, &["--depth", depth, "--grey", "--rays", "256"]);
        Picture::decode(&folder.read("out.png"))
    });
    let [a, b] = grey.each_ref().map(|g| g.pixels.iter().map(|p| i32::from(p[0])).collect::<Vec<_>>());
    let far = a.iter().zip(&b).filter(|(a, b)| (*a - *b).abs() > 64).count();
    assert!(far * 100 < a.len(), "{far}");
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let folder = with_board();
    let run = |args: &[&str]| folder.run(&[&["light", "board.obj"][..], args, &VIEW].concat()).expect(2);
    run(&["--light", "1,8,-1,-1,8,1", "-o", "out.png"]);
    run(&["--light", "NaN,8,-1,1,8,1", "-o", "out.png"]);
    run(&["--light", "-1,8,-1,1,8,1", "-o", "out.jpg"]);
    run(&["--light", "-1,8,-1,1,8,1", "--depth", "99", "-o", "out.png"]);
    run(&["--light", "-1,8,-1,1,8,1", "--method", "guess", "-o", "out.png"]);
    folder.run(&[&["light", "none.obj", "--light", "0,8,0,1,8,1", "-o", "out.png"][..], &VIEW].concat()).expect(2);
    assert_eq!(folder.names(), ["board.obj"]);
}

/// A closed box over the floor: every method finds its umbra, or less of it, and none finds umbra where the others prove light.
#[test]
fn every_method_finds_umbrae() {
    let folder = with_board();
    folder.write(
        "box.obj",
        "v -8 0 -8\nv -8 0 8\nv 8 0 8\nv 8 0 -8\nf 1 2 3 4\n\
         v -2 2 -2\nv 2 2 -2\nv 2 2 2\nv -2 2 2\nv -2 3 -2\nv 2 3 -2\nv 2 3 2\nv -2 3 2\n\
         o box\nf 5 6 7 8\nf 9 12 11 10\nf 5 9 10 6\nf 6 10 11 7\nf 7 11 12 8\nf 8 12 9 5\n",
    );
    let run = |method: &str| {
        let args = ["light", "box.obj", "--light", "-1,8,-1,1,8,1", "--method", method, "-o", "out.png", "--json"];
        let reply = folder.run(&[&args[..], &VIEW].concat()).expect(0).json();
        (number(&reply, "area_umbra"), number(&reply, "area_lit"))
    };
    let all = run("sheets,multifocal,shafts");
    for method in ["sheets", "multifocal", "shafts"] {
        let (umbra, lit) = run(method);
        assert!(umbra > 0.0 && umbra <= all.0 + 1e-9 && (lit - all.1).abs() < 1e-9, "{method}: {umbra} {lit} {all:?}");
    }
}
