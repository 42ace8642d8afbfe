//! A thousand drawings of clipped inserts in clipped inserts, against points that are followed outwards and counted by crossings.

use super::clips::{IDENTITY, clipped, file, filter};
use super::{lines, read};
use crate::common::dxf::Dxf;
use sightlines_geometry::Random;
use sightlines_testkit::siblings;

type P = [f64; 2];

/// How a clip is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// There is none.
    Absent,
    Off,
    /// Two corners of a box.
    Corners,
    Polygon,
    /// As the polygon that was inverted, or as the rest with a slit.
    Inverted,
    Rest,
}

const KINDS: [Kind; 6] = [Kind::Absent, Kind::Off, Kind::Corners, Kind::Polygon, Kind::Inverted, Kind::Rest];

/// An insert: where it puts its block, and what of it is drawn.
#[derive(Debug)]
struct Level {
    base: P,
    at: P,
    scale: P,
    degrees: f64,
    kind: Kind,
    /// In the coordinates of the block.
    polygon: Vec<P>,
}

fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * random.unit()
}

/// A polygon around a middle that it sees all of, so that it does not cross itself.
fn star(random: &mut Random) -> Vec<P> {
    let n = 3 + random.below(5);
    let middle = [between(random, -4.0, 4.0), between(random, -4.0, 4.0)];
    let turn = random.unit();
    let corner = |k: usize| {
        let angle = (k as f64 + turn) / n as f64 * std::f64::consts::TAU;
        let far = between(random, 2.0, 8.0);
        [middle[0] + far * angle.cos(), middle[1] + far * angle.sin()]
    };
    let mut all: Vec<P> = (0..n).map(corner).collect();
    if random.below(2) == 0 {
        all.reverse();
    }
    all
}

impl Level {
    fn any(random: &mut Random) -> Self {
        let scale = [0.5, 1.0, 2.0, -1.0, -0.5];
        let kind = KINDS[random.below(KINDS.len())];
        let polygon = if kind == Kind::Corners {
            // Two corners, in any order.
            let [low, high] = [-8.0, 0.0].map(|low| [(); 2].map(|()| between(random, low, low + 8.0)));
            let [[x0, y0], [x1, y1]] =
                if random.below(2) == 0 { [low, high] } else { [[high[0], low[1]], [low[0], high[1]]] };
            vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
        } else {
            star(random)
        };
        Self {
            base: [random.below(5) as f64, random.below(5) as f64],
            at: [between(random, -5.0, 5.0), between(random, -5.0, 5.0)],
            scale: [scale[random.below(5)], scale[random.below(5)]],
            degrees: if random.below(2) == 0 { 90.0 * random.below(4) as f64 } else { between(random, 0.0, 360.0) },
            kind,
            polygon,
        }
    }

    fn insert(&self, block: &str) -> Dxf {
        let insert = Dxf::new().insert(block, self.at).put(41, self.scale[0]).put(42, self.scale[1]);
        insert.put(50, self.degrees)
    }

    /// Where a point of the block is drawn.
    fn point(&self, p: P) -> P {
        let [x, y] = [0, 1].map(|k| (p[k] - self.base[k]) * self.scale[k]);
        let (s, c) = self.degrees.to_radians().sin_cos();
        [self.at[0] + c * x - s * y, self.at[1] + s * x + c * y]
    }

    /// Whether a point of the block is drawn; `None` near the border.
    fn shows(&self, p: P) -> Option<bool> {
        let n = self.polygon.len();
        let sides = || (0..n).map(|k| (self.polygon[k], self.polygon[(k + 1) % n]));
        if sides().any(|(a, b)| distance(p, a, b) < 1e-6) {
            return None;
        }
        let crosses = |&(a, b): &(P, P)| {
            (a[1] <= p[1]) != (b[1] <= p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        };
        let is_in = sides().filter(crosses).count() % 2 == 1;
        Some(match self.kind {
            Kind::Absent | Kind::Off => true,
            Kind::Corners | Kind::Polygon => is_in,
            Kind::Inverted | Kind::Rest => !is_in,
        })
    }

    /// The objects of the clip; it was made where the insert was turned by quarters and moved.
    fn objects(&self, random: &mut Random, handle: u32) -> Dxf {
        let (quarters, shift) = (random.below(4), [random.below(9) as f64, random.below(9) as f64]);
        let (s, c) = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][quarters];
        let to_block = [c, -s, 0.0, shift[0], s, c, 0.0, shift[1], 0.0, 0.0, 1.0, 0.0];
        let to_block = if random.below(2) == 0 { to_block } else { IDENTITY };
        // The other way: a turn is undone by the turn back.
        let stored = |p: P| {
            let [x, y] = [p[0] - to_block[3], p[1] - to_block[7]];
            [to_block[0] * x + to_block[4] * y, to_block[1] * x + to_block[5] * y]
        };
        let hole: Vec<P> = self.polygon.iter().map(|&p| stored(p)).collect();
        // Around all that there is.
        let outer = [[-99.0, -99.0], [99.0, -99.0], [99.0, 99.0], [-99.0, 99.0]].map(stored);
        let rest: Vec<P> = hole.iter().chain([&hole[0]]).chain(&outer).chain([&outer[0]]).copied().collect();
        let own = match self.kind {
            Kind::Corners => vec![hole[0], hole[2]],
            Kind::Rest => rest.clone(),
            _ => hole.clone(),
        };
        let on = Dxf::new().put(71, u8::from(self.kind != Kind::Off));
        if self.kind != Kind::Inverted && (self.kind != Kind::Rest || random.below(2) == 0) {
            return filter(handle, &own, &on, [to_block, IDENTITY]);
        }
        let points = |dxf: Dxf, all: &[P]| all.iter().fold(dxf, |dxf, &p| dxf.at(10, p).put(30, 0));
        let (to, at) = (format!("{:X}", handle + 3), format!("{:X}", handle + 4));
        let leads = Dxf::new().put(102, "{ACAD_XDICTIONARY").put(360, &to).put(102, "}").add(&on);
        let dictionary = Dxf::new().put(0, "DICTIONARY").put(5, &to).put(3, "ACAD_XREC_ROUNDTRIP").put(360, &at);
        let record = Dxf::new().put(0, "XRECORD").put(5, &at).put(280, 1).put(102, "ACAD_INVERTEDCLIP_ROUNDTRIP");
        let record = points(points(record, &hole).put(102, "ACAD_INVERTEDCLIP_ROUNDTRIP_COMPARE"), &rest);
        dictionary.add(&record).add(&filter(handle, &own, &leads, [to_block, IDENTITY]))
    }
}

fn distance(p: P, a: P, b: P) -> f64 {
    let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let t = ((d[0] * e[0] + d[1] * e[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
    (e[0] - t * d[0]).hypot(e[1] - t * d[1])
}

/// Of the lines of a block, which is in up to three inserts with clips of any kind, those points are drawn that all clips show. Points that must be
/// drawn are the twin of those that must not; the impostors draw all, or leave out what is clipped.
#[test]
fn clips_in_clips_draw_what_all_of_them_show() {
    let [mut n, mut n_shown, mut n_hidden, mut n_off, mut n_mixed] = [0; 5];
    let mut of_kind = [[0usize; 2]; KINDS.len()];
    for seed in siblings() {
        let mut random = Random::new(seed);
        let levels: Vec<Level> = (0..1 + random.below(3)).map(|_| Level::any(&mut random)).collect();
        let all: Vec<[P; 2]> = (0..1 + random.below(3))
            .map(|_| [(); 2].map(|()| [between(&mut random, -9.0, 9.0), between(&mut random, -9.0, 9.0)]))
            .collect();
        // The first is the innermost.
        let mut inner = all.iter().fold(Dxf::new(), |dxf, &[a, b]| dxf.line("0", a, b));
        let (mut blocks, mut objects) = (Dxf::new(), Dxf::new());
        for (k, level) in levels.iter().enumerate() {
            let (name, handle) = (format!("B{k}"), 0x40 + 0x10 * k as u32);
            blocks = blocks.add(&inner.as_block(&name, level.base));
            inner = level.insert(&name);
            if level.kind != Kind::Absent {
                inner = clipped(&inner, handle);
                objects = objects.add(&level.objects(&mut random, handle));
            }
        }
        // Without a line a drawing is refused.
        let far = [[5000.0, 0.0], [5001.0, 0.0]];
        let found = read(&file(&blocks, &inner.line("0", far[0], far[1]), &objects));
        assert_eq!(found.warnings, [""; 0], "{seed}: {levels:?}");
        let drawn = lines(&found);
        let mut here = [0, 0];
        for (a, b) in all.iter().map(|&[a, b]| (a, b)) {
            for step in 0..40 {
                let t = (f64::from(step) + 0.37) / 40.0;
                let mut p = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
                let mut shows = Some(true);
                let mut first = None;
                for (k, level) in levels.iter().enumerate() {
                    let one = level.shows(p);
                    shows = shows.zip(one).map(|(a, b)| a && b);
                    first = first.or((one == Some(false)).then_some(k));
                    p = level.point(p);
                }
                let Some(shows) = shows else { continue };
                let is_drawn = drawn.iter().any(|l| distance(p, [l[0], l[1]], [l[2], l[3]]) < 1e-9);
                assert_eq!(is_drawn, shows, "{seed}: {p:?} {levels:?} {drawn:?}");
                here[usize::from(shows)] += 1;
                if let Some(k) = first {
                    of_kind[KINDS.iter().position(|&kind| kind == levels[k].kind).expect("all kinds")][0] += 1;
                }
            }
        }
        for kind in levels.iter().map(|level| level.kind) {
            of_kind[KINDS.iter().position(|&k| k == kind).expect("all kinds")][1] += here[1];
        }
        let is_off = |level: &Level| matches!(level.kind, Kind::Off | Kind::Absent);
        n_off += usize::from(levels.iter().all(is_off) && here[0] == 0 && here[1] > 0);
        // Either impostor is found out here.
        n_mixed += usize::from(here[0] > 0 && here[1] > 0);
        n_hidden += here[0];
        n_shown += here[1];
        n += 1;
    }
    eprintln!("{n} drawings, {n_mixed} in part; points: {n_shown} drawn, {n_hidden} not; by kind {of_kind:?}");
    assert!(n == siblings().len() && 4 * n_mixed > n && 20 * n_off > n, "{n_mixed} {n_off} of {n}");
    assert!(n_shown > 10 * n && n_hidden > 10 * n, "{n_shown} {n_hidden}");
    let hide = of_kind.map(|[n_hidden, n_shown]| (2 * n_hidden > n, 2 * n_shown > n));
    let [no, yes] = [(false, true), (true, true)];
    assert_eq!(hide, [no, no, yes, yes, yes, yes], "{of_kind:?}");
}
