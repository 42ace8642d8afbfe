//! Inserts, against another way to place points; and blocks that never end.

use super::{lines, read, refused};
use crate::common::dxf::Dxf;
use proptest::prelude::*;

/// An insert in numbers: the place, scales, rotation, columns and rows with their spacing, and whether it is seen from below.
#[derive(Debug, Clone)]
struct Placed {
    at: [f64; 2],
    scale: [f64; 2],
    degrees: f64,
    counts: [u8; 2],
    spacing: [f64; 2],
    is_below: bool,
    base: [f64; 2],
}

impl Placed {
    fn of(&self, block: &str) -> Dxf {
        let below = if self.is_below { -1 } else { 1 };
        Dxf::new()
            .insert(block, self.at)
            .put(41, self.scale[0])
            .put(42, self.scale[1])
            .put(50, self.degrees)
            .put(70, self.counts[0])
            .put(71, self.counts[1])
            .put(44, self.spacing[0])
            .put(45, self.spacing[1])
            .put(230, below)
    }

    /// Where a point of the block goes, for each column and row: as complex numbers, with the functions of the system.
    fn places(&self, [x, y]: [f64; 2]) -> Vec<[f64; 2]> {
        let (sin, cos) = self.degrees.to_radians().sin_cos();
        let mut out = Vec::new();
        for row in 0..self.counts[1] {
            for column in 0..self.counts[0] {
                let re = (x - self.base[0]) * self.scale[0] + f64::from(column) * self.spacing[0];
                let im = (y - self.base[1]) * self.scale[1] + f64::from(row) * self.spacing[1];
                let turned = [re * cos - im * sin + self.at[0], re * sin + im * cos + self.at[1]];
                out.push([if self.is_below { -turned[0] } else { turned[0] }, turned[1]]);
            }
        }
        out
    }
}

fn placed(quarters_only: bool) -> impl Strategy<Value = Placed> {
    let whole = || (-8i8..8).prop_map(f64::from);
    let scale = || prop_oneof![Just(1.0), Just(-1.0), Just(2.0), Just(-0.5), Just(3.0)];
    let degrees = (-8i16..8, -360i16..360)
        .prop_map(move |(quarter, any)| if quarters_only { f64::from(quarter) * 90.0 } else { f64::from(any) * 0.7 });
    (
        (whole(), whole()),
        (scale(), scale()),
        degrees,
        (1u8..3, 1u8..3),
        (whole(), whole()),
        any::<bool>(),
        (whole(), whole()),
    )
        .prop_map(|(at, scale, degrees, counts, spacing, is_below, base)| Placed {
            at: at.into(),
            scale: scale.into(),
            degrees,
            counts: counts.into(),
            spacing: spacing.into(),
            is_below,
            base: base.into(),
        })
}

/// The lines of an L, which has no symmetry, inserted in a block that is inserted.
fn lines_of(outer: &Placed, inner: &Placed) -> Vec<[f64; 4]> {
    let leaf =
        Dxf::new().line("0", [1.0, 1.0], [1.0, 4.0]).line("0", [1.0, 4.0], [3.0, 4.0]).as_block("Leaf", inner.base);
    let twig = inner.of("LEAF").as_block("twig", outer.base);
    let file = read(&outer.of("Twig").model(&leaf.add(&twig)));
    let all = lines(&file);
    let n_copies = [outer, inner].iter().map(|p| usize::from(p.counts[0] * p.counts[1])).product::<usize>();
    assert_eq!(all.len() + file.dropped.n_doubled, 2 * n_copies);
    all
}

/// The same by the other way, with all copies, each end with an end.
fn expected(outer: &Placed, inner: &Placed) -> Vec<[f64; 4]> {
    let ends = |p| -> Vec<[f64; 2]> { inner.places(p).into_iter().flat_map(|p| outer.places(p)).collect() };
    let corners = [[1.0, 1.0], [1.0, 4.0], [3.0, 4.0]].map(ends);
    let pairs = corners.windows(2).flat_map(|pair| pair[0].iter().zip(&pair[1]));
    pairs.map(|(a, b)| [a[0], a[1], b[0], b[1]]).collect()
}

fn is_near(a: &[f64; 4], b: &[f64; 4], tolerance: f64) -> bool {
    let turned = [b[2], b[3], b[0], b[1]];
    [*b, turned].iter().any(|b| a.iter().zip(b).all(|(x, y)| (x - y).abs() <= tolerance))
}

/// Whether each line of one is in the other.
fn are_same(found: &[[f64; 4]], expected: &[[f64; 4]], tolerance: f64) -> bool {
    let all = |a: &[[f64; 4]], b: &[[f64; 4]]| a.iter().all(|x| b.iter().any(|y| is_near(x, y, tolerance)));
    all(found, expected) && all(expected, found)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// Invariant: nested inserts place what is in them, whatever their scales, angles, arrays and sides.
    #[test]
    fn inserts_place_blocks(outer in placed(false), inner in placed(false)) {
        prop_assert!(are_same(&lines_of(&outer, &inner), &expected(&outer, &inner), 1e-10));
    }

    /// Invariant: quarter turns of whole numbers are exact.
    #[test]
    fn quarter_turns_are_exact(outer in placed(true), inner in placed(true)) {
        let whole: Vec<[f64; 4]> = expected(&outer, &inner).iter().map(|l| l.map(|x| (x * 4.0).round() / 4.0)).collect();
        let found = lines_of(&outer, &inner);
        prop_assert!(are_same(&found, &whole, 0.0), "{:?} {:?}", found, whole);
    }
}

#[test]
fn impostors_are_noticed() {
    let plain = Placed {
        at: [1.0, 2.0],
        scale: [1.0, 1.0],
        degrees: 30.0,
        counts: [2, 1],
        spacing: [5.0, 0.0],
        is_below: false,
        base: [0.0; 2],
    };
    let others = [
        Placed { scale: [-1.0, 1.0], ..plain.clone() },
        Placed { degrees: -30.0, ..plain.clone() },
        Placed { is_below: true, ..plain.clone() },
        Placed { base: [1.0, 0.0], ..plain.clone() },
        Placed { spacing: [0.0, 5.0], ..plain.clone() },
    ];
    assert!(are_same(&lines_of(&plain, &plain), &expected(&plain, &plain), 1e-10));
    for other in others {
        assert!(!are_same(&lines_of(&other, &plain), &expected(&plain, &plain), 1e-10), "{other:?}");
        assert!(!are_same(&lines_of(&plain, &other), &expected(&plain, &plain), 1e-10), "{other:?}");
    }
}

#[test]
fn a_mirrored_door_swings_to_the_other_side() {
    let swing =
        Dxf::new().entity("ARC", "0").at(10, [0.0, 0.0]).put(40, 1).put(50, 0).put(51, 90).as_block("door", [0.0; 2]);
    let file = read(&Dxf::new().insert("door", [10.0, 0.0]).put(41, -1).model(&swing));
    let found = super::vertices(&file);
    assert_eq!((found[0], found[found.len() - 1]), ([9.0, 0.0], [10.0, 1.0]));
    assert!(found.iter().all(|p| (9.0..=10.0).contains(&p[0]) && (0.0..=1.0).contains(&p[1])));
    // A circle that is scaled in one direction only is an ellipse.
    let round = Dxf::new().entity("CIRCLE", "0").at(10, [0.0, 0.0]).put(40, 1).as_block("round", [0.0; 2]);
    let file = read(&Dxf::new().insert("round", [0.0, 0.0]).put(41, 3).put(42, 2).model(&round));
    assert!(file.plan.points().all(|p| ((p.x / 3.0).powi(2) + (p.y / 2.0).powi(2) - 1.0).abs() < 1e-12));
    assert_eq!((file.plan.bounds().min, file.plan.bounds().max), ([-3.0, -2.0], [3.0, 2.0]));
}

#[test]
fn blocks_that_contain_themselves_are_refused() {
    let itself = Dxf::new().insert("A", [0.0, 0.0]).as_block("a", [0.0; 2]);
    let error = refused(&Dxf::new().insert("A", [0.0, 0.0]).model(&itself)).to_string();
    assert!(error.ends_with("the block \"a\" contains itself"), "{error}");
    let b = Dxf::new().insert("c", [0.0, 0.0]).as_block("b", [0.0; 2]);
    let c = Dxf::new().line("0", [0.0, 0.0], [1.0, 0.0]).insert("b", [0.0, 0.0]).as_block("c", [0.0; 2]);
    let error = refused(&Dxf::new().insert("c", [0.0, 0.0]).model(&b.add(&c))).to_string();
    assert!(error.ends_with("the block \"c\" contains itself"), "{error}");
    // One that nothing inserts does no harm.
    assert_eq!(read(&Dxf::new().line("0", [0.0, 0.0], [1.0, 0.0]).model(&itself)).plan.lines().len(), 1);
}

#[test]
fn inserts_of_other_files_are_counted() {
    let block = Dxf::new()
        .entity("BLOCK", "0")
        .put(2, "site")
        .put(70, 4)
        .at(10, [0.0, 0.0])
        .put(1, "site.dwg")
        .put(0, "ENDBLK");
    let file = read(&Dxf::new().line("0", [0.0, 0.0], [1.0, 0.0]).insert("site", [0.0, 0.0]).model(&block));
    assert_eq!(file.warnings, ["ignored what is no line or curve: 1 INSERT of another file"]);
}

#[test]
fn what_grows_without_bound_is_refused() {
    let grown = |n: usize, many: &dyn Fn(usize) -> Dxf| {
        let leaf = Dxf::new().as_block("b0", [0.0; 2]);
        let blocks = (1..=n).fold(leaf, |blocks, k| blocks.add(&many(k - 1).as_block(&format!("b{k}"), [0.0; 2])));
        many(n).model(&blocks)
    };
    let once = |k: usize| Dxf::new().insert(&format!("b{k}"), [0.0, 0.0]);
    let twice = |k: usize| once(k).add(&once(k));
    let array = |k: usize| once(k).put(70, 32767).put(71, 32767);
    assert!(read(&grown(20, &once)).plan.lines().is_empty());
    let error = |bytes: &[u8]| refused(bytes).to_string();
    assert!(error(&grown(100, &once)).ends_with("blocks are nested more than 64 deep"));
    for many in [&twice as &dyn Fn(usize) -> Dxf, &array] {
        assert!(
            error(&grown(40, many)).ends_with("the drawing, with its blocks inserted, has more than 2097152 elements")
        );
    }
}
