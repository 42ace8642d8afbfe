//! What pages look like: the pictures of the documents, drawn again in a browser and compared within a tolerance, as letters and
//! edges are drawn a little differently everywhere.

use crate::common::Folder;
use crate::common::picture::Picture;
use serde_json::{Value, json};
use sightlines::pvs::Table;
use sightlines_testkit::browser::{Opened, chromium};
use std::path::Path;

/// A view of a page.
struct Look {
    /// Of the picture.
    name: &'static str,
    page: &'static str,
    /// The end of the address.
    link: &'static str,
    /// What is done on the page.
    script: &'static str,
    /// An address whose view is another one.
    other: &'static str,
}

const LOOKS: [Look; 6] = [
    Look {
        name: "view-set.png",
        page: "tower.html",
        link: "#eye=9,1.7,5&lock=1&view=space",
        script: "app.frameAll(); document.getElementById('ghosts').click();",
        other: "#eye=20,1.7,15&lock=1&view=space",
    },
    Look {
        name: "view-why.png",
        page: "tower.html",
        link: "#cell=48&view=map&why=48-141",
        script: "app.frameAll();",
        other: "#cell=60&view=map",
    },
    Look {
        name: "view-heat.png",
        page: "office.html",
        link: "#heat=cells",
        script: "app.frameAll(); document.getElementById('numbers').open = true;",
        other: "#cell=7",
    },
    Look {
        name: "view-methods.png",
        page: "tower.html",
        link: "#eye=12,1.7,15&view=map",
        script: "const heading = document.getElementById('heading'); heading.value = 52; \
                 heading.dispatchEvent(new Event('input')); app.model.method = 'exact'; app.model.changed(); app.frameAll(); \
                 const methods = document.getElementById('methods'); methods.open = true; app.panel.listMethods(); \
                 document.querySelector('aside').scrollTop = methods.offsetTop - 60;",
        other: "#eye=12,1.7,3&view=map",
    },
    Look {
        name: "view-change.png",
        page: "change.html",
        link: "#cell=72",
        script: "app.frameAll(); const change = document.getElementById('change'); change.open = true; \
                 document.querySelector('aside').scrollTop = change.offsetTop - 60;",
        other: "#cell=100",
    },
    Look {
        name: "view-walk.png",
        page: "office.html",
        link: "#view=map",
        script: "app.frameAll(); document.getElementById('walk').open = true; const frame = document.getElementById('frame'); \
                 frame.value = 40; frame.dispatchEvent(new Event('input')); \
                 document.querySelector('aside').scrollTop = document.getElementById('walk').offsetTop - 60;",
        other: "#heat=cells",
    },
];

/// Pages of a tower and of an office, one with a walk, and one beside another bake that hides what two corridors see.
fn pages() -> Folder {
    let folder = Folder::new();
    folder.run(&["generate", "tower", "--floors", "2", "-o", "tower.glb"]).expect(0);
    folder.run(&["build", "tower.glb", "-o", "tower.pvs"]).expect(0);
    let named = ["--title", "A tower of two floors", "-o", "tower.html"];
    folder.run(&[&["view", "tower.pvs", "--scene", "tower.glb"], &named[..]].concat()).expect(0);
    folder.run(&["demo", "--out", "."]).expect(0);
    let frames: Vec<Value> = (0..60).map(|k| json!({ "eye": [1.0 + f64::from(k), 22.2], "dir": [1.0, 0.0] })).collect();
    folder.write("walk.json", json!({ "frames": frames }).to_string());
    let view = ["view", "plan.pvs", "--scene", "plan.geojson"];
    let named = ["--walk", "walk.json", "--title", "An office floor", "-o", "office.html"];
    folder.run(&[&view, &named[..]].concat()).expect(0);
    let mut parts = Table::from_bytes(&folder.read("plan.pvs")).expect("a table").into_parts();
    let n_cells = parts.cells.len();
    for (a, b) in (20..60).flat_map(|a| (70..n_cells).map(move |b| (a, b))) {
        parts.rows.set(a, b, false);
        parts.rows.set(b, a, false);
    }
    parts.stab = None;
    folder.write("old.pvs", Table::new(parts).expect("a table").to_bytes());
    let named = ["--against", "old.pvs", "--title", "An office floor, baked twice", "-o", "change.html"];
    folder.run(&[&view, &named[..]].concat()).expect(0);
    folder
}

/// Draws at once, and tells where the canvas is on the page and the average colour of each block of it.
const MEANS: &str = r"
app.drawNow();
const canvas = app.view === 'space' ? app.spaceCanvas : app.flatCanvas;
const copy = document.createElement('canvas');
[copy.width, copy.height] = [canvas.width, canvas.height];
const context = copy.getContext('2d');
context.drawImage(canvas, 0, 0);
const { left, top } = canvas.getBoundingClientRect();
const means = [];
for (let y = 0; y + 10 <= copy.height; y += 10) {
  for (let x = 0; x + 10 <= copy.width; x += 10) {
    const sums = [0, 0, 0];
    context.getImageData(x, y, 10, 10).data.forEach((value, i) => i % 4 < 3 && (sums[i % 4] += value));
    means.push([x, y, ...sums.map((sum) => sum / 100)]);
  }
}
tell([left, top, means]);";

/// A page as it is opened, with a script that ends like this.
fn with_page<R>(folder: &Folder, page: &str, link: &str, script: &str, then: impl Fn(&Opened<'_>) -> R) -> R {
    let html = String::from_utf8(folder.read(page)).expect("a text");
    // Windows without frames are not as high as they are told to be in every mode, and letters not as high everywhere.
    let high = "document.documentElement.style.height = document.body.style.height = '700px'; \
                const head = document.querySelector('header').style; \
                [head.height, head.flexShrink, head.overflow] = ['49px', '0', 'hidden'];";
    let script = format!("ready.then((app) => {{ {high} {script} }});");
    then(&Opened { html: &html, script: &script, given: &Value::Null, size: [1100, 700], link })
}

/// The share of blocks of the map or the scene that look different in a picture of the whole page.
fn difference(browser: &Path, folder: &Folder, look: &Look, link: &str, picture: &Picture) -> f64 {
    let script = format!("{}{MEANS}", look.script);
    let told = with_page(folder, look.page, link, &script, |opened| opened.result(browser));
    let number = |value: &Value| value.as_f64().expect("a number");
    let (left, top) = (number(&told[0]).round() as usize, number(&told[1]).round() as usize);
    let [width, height] = picture.size.map(|x| x as usize);
    let (mut n, mut differ) = (0, 0);
    for block in told[2].as_array().expect("blocks") {
        let (x, y) = (left + number(&block[0]) as usize, top + number(&block[1]) as usize);
        if x + 10 > width || y + 10 > height {
            continue;
        }
        let pixels = (y..y + 10).flat_map(|row| &picture.pixels[row * width + x..row * width + x + 10]);
        let sums =
            pixels.fold([0.0; 3], |sums: [f64; 3], pixel| std::array::from_fn(|k| sums[k] + f64::from(pixel[k])));
        n += 1;
        differ += usize::from((0..3).any(|k| (sums[k] / 100.0 - number(&block[k + 2])).abs() > 20.0));
    }
    assert!(n > 2000, "{n} blocks");
    differ as f64 / f64::from(n)
}

#[test]
fn pages_look_like_the_pictures_of_the_documents() {
    let Some(browser) = chromium() else { return };
    let folder = pages();
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/pictures");
    for look in &LOOKS {
        let (name, path) = (look.name, kept.join(look.name));
        if std::env::var_os("BLESS").is_some_and(|value| value == "1") {
            let script = format!("{} app.redraw();", look.script);
            let png = with_page(&folder, look.page, look.link, &script, |opened| opened.picture(&browser));
            std::fs::write(&path, png).expect("the picture can be written");
        }
        let picture = Picture::decode(&std::fs::read(path).expect("a picture"));
        let share = difference(&browser, &folder, look, look.link, &picture);
        println!("{name}: {:.2} % of the blocks differ", 100.0 * share);
        assert!(share < 0.03, "{name}: {share}; BLESS=1 draws it anew");
        // The comparison can fail: by the same view from another place, or of other cells.
        let share = difference(&browser, &folder, look, look.other, &picture);
        println!("{name}: {:.2} % from another eye", 100.0 * share);
        assert!(share > 0.06, "{name}: {share}");
    }
}
