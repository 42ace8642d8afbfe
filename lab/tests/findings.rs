//! What the sweeps found, kept: for each naive method and each solver a sequence of portals that an open set of lines
//! passes and that it calls hidden. Shipped methods see it.
//!
//! Coordinates are those of the sweep, to the last bit. Who brings a new version of a solver that is right about its
//! sequence may look for another one: `stability --show METHOD` prints them.

use sightlines::geometry::{Aabb, AxialDoor, Point2, Portal2, Portal3};
use sightlines::sightline::{ConvexStabber, StabLimits, Verdict};
use sightlines_lab::stability::sweep::caught;
use sightlines_lab::stability::{Answer, Decide, Kind, axial, convex, plane};
use sightlines_testkit::axial_stabbable_brute_force;

/// Methods and portals that each of them hides wrongly.
type Found<T> = (&'static [&'static str], &'static [T]);

/// Axis, whether crossed forwards, low and high corner.
type AxialNumbers = (u8, bool, [f64; 3], [f64; 3]);

/// Asks: shipped methods have to see the case, and those named to hide it.
fn check<C>(methods: &[Decide<C>], names: &[&str], case: &C) {
    let mut n_shipped = 0;
    for (method, decide) in methods {
        let answer = caught(|| decide(case));
        if method.kind == Kind::Shipped {
            n_shipped += 1;
            assert_eq!(answer, Answer::Seen, "{} is wrong about what was found with {names:?}", method.name);
        }
        assert!(!names.contains(&method.name) || answer == Answer::Hidden, "{} is not wrong any more", method.name);
    }
    assert!(n_shipped > 0);
}

/// Whether there is a finding for each naive method.
fn are_complete<C>(methods: &[Decide<C>], found: impl Iterator<Item = &'static str> + Clone) {
    let naive = methods.iter().filter(|(method, _)| method.kind == Kind::Naive);
    let missing: Vec<&str> = naive.map(|(m, _)| m.name).filter(|name| !found.clone().any(|f| f == *name)).collect();
    assert!(missing.is_empty(), "nothing was found for {missing:?}");
    let unknown: Vec<&str> = found.filter(|name| !methods.iter().any(|(m, _)| m.name == *name)).collect();
    assert!(unknown.is_empty(), "there is no {unknown:?}");
}

#[test]
fn doors_in_the_plane_that_were_hidden_wrongly() {
    are_complete(&plane::methods(), PLANE.iter().flat_map(|f| f.0.iter().copied()));
    for (names, doors) in PLANE {
        let end = |[x, y]: [f64; 2]| Point2::new(x, y);
        let doors: Vec<Portal2> = doors.iter().map(|&[l, r]| Portal2 { left: end(l), right: end(r) }).collect();
        assert!(plane::truth::is_chain(&doors) && plane::truth::is_open(&doors), "{names:?}");
        check(&plane::methods(), names, &plane::Doors(doors));
    }
}

#[test]
fn axial_doors_that_were_hidden_wrongly() {
    are_complete(&axial::methods(), AXIAL.iter().flat_map(|f| f.0.iter().copied()));
    for (names, doors) in AXIAL {
        let door = |&(axis, forward, min, max): &AxialNumbers| AxialDoor { extent: Aabb { min, max }, axis, forward };
        let doors: Vec<AxialDoor> = doors.iter().map(door).collect();
        assert!(axial_stabbable_brute_force(&doors), "{names:?}");
        check(&axial::methods(), names, &axial::AxialDoors(doors));
    }
}

#[test]
fn convex_portals_that_were_hidden_wrongly() {
    are_complete(&convex::methods(true), CONVEX.iter().flat_map(|f| f.0.iter().copied()));
    for (names, portals) in CONVEX {
        let portals: Vec<Portal3> = portals.iter().map(|p| Portal3::of_corners(p.to_vec()).unwrap()).collect();
        let refs: Vec<&Portal3> = portals.iter().collect();
        // A line that has every edge on its inner side, exactly, is proof enough.
        let Verdict::Visible(line) = ConvexStabber::new(StabLimits::default()).stab(&refs, None) else {
            panic!("no line for what was found with {names:?}")
        };
        assert!(portals.iter().all(|portal| line.passes(portal)), "{names:?}");
        check(&convex::methods(true), names, &convex::ConvexPortals(portals));
    }
}

/// The impostor: nothing is found with a method that is right.
#[test]
#[should_panic(expected = "funnel proven is not wrong any more")]
fn findings_have_to_be_wrong() {
    let doors = [[0.0, 1.0], [2.0, 3.0]];
    let door = |[x, y]: [f64; 2]| Portal2 { left: Point2::new(x, y), right: Point2::new(x, -1.0) };
    check(&plane::methods(), &["funnel proven"], &plane::Doors(doors.map(door).to_vec()));
}

/// Doors in the plane: left and right end.
const PLANE: &[Found<[[f64; 2]; 2]>] = &[
    // plane-length at 2.
    (&["lp good_lp"], &[[[0.0, 533706.0], [0.0, 533704.0]], [[36.0, 499995.0], [36.0, 499993.0]]]),
    // plane-length at 2.
    (&["lp good_lp unit"], &[[[0.0, -477295.0], [0.0, -477297.0]], [[31.0, -702851.0], [31.0, -702853.0]]]),
    // plane-distance at 10000000.
    (
        &["lp minilp"],
        &[
            [[9780964.98034656, -7770235.369785163], [9780965.93754449, -7770234.891186198]],
            [[9780967.373341383, -7770233.933988269], [9780966.894742418, -7770234.412587234]],
        ],
    ),
    // plane-length at 2.
    (&["lp minilp unit"], &[[[0.0, -477295.0], [0.0, -477297.0]], [[31.0, -702851.0], [31.0, -702853.0]]]),
    // plane-grazing at 3.
    (
        &["lp microlp"],
        &[
            [[-0.058, 0.026000000000000002], [-0.049, 0.014]],
            [[-0.045000000000000005, 0.017], [-0.036000000000000004, 0.005]],
            [[-0.05, 0.032], [-0.041, 0.019999999999999997]],
        ],
    ),
    // plane-length at 2.
    (&["lp microlp unit"], &[[[0.0, -477295.0], [0.0, -477297.0]], [[31.0, -702851.0], [31.0, -702853.0]]]),
    // plane-grazing at 3.
    (
        &["funnel f64"],
        &[
            [[-4.000000000000001, -10.0], [17.0, -37.0]],
            [[-16.0, 24.0], [5.0, -3.0]],
            [[13.999999999999998, 4.0], [21.0, -5.0]],
        ],
    ),
    // plane-distance at 1000.
    (
        &["funnel f64 coefficients"],
        &[
            [[598.4513635980802, 465.62824194747935], [599.1492429278907, 466.3261212772899]],
            [[597.7534842682697, 468.4197592667211], [598.4513635980802, 467.37294027200556]],
        ],
    ),
    // plane-grazing at 3.
    (
        &["funnel f32"],
        &[
            [[-0.04900000000000001, -0.024], [-0.043000000000000003, -0.025]],
            [[-0.06, -0.016], [-0.048, -0.018000000000000006]],
            [[-0.047, -0.012], [-0.029, -0.015]],
        ],
    ),
    // plane-distance at 100000000.
    (
        &["funnel of stored f32"],
        &[
            [[98435843.25031486, 74958580.46354365], [98435843.25031488, 74958579.95370273]],
            [[98435844.01507623, 74958580.71846412], [98435844.01507623, 74958580.2086232]],
        ],
    ),
    // plane-grazing at 3.
    (
        &["funnel f64 strict 1e-9"],
        &[
            [[-0.039, -0.016], [-0.033, -0.043000000000000003]],
            [[-0.036000000000000004, 0.013000000000000001], [-0.03, -0.014000000000000002]],
            [[-0.021, -0.012000000000000002], [-0.015, -0.039]],
        ],
    ),
    // plane-distance at 1000000.
    (
        &["funnel f64 lenient 1e-9"],
        &[
            [[593410.7106352603, 542034.8581782763], [593410.7106352604, 542035.2383373794]],
            [[593410.3304761573, 542035.6184964825], [593410.7106352603, 542035.6184964825]],
            [[593409.570157951, 542035.6184964825], [593409.5701579513, 542036.3788146888]],
        ],
    ),
];

/// Axis-aligned doors: axis, whether crossed forwards, low and high corner.
const AXIAL: &[Found<AxialNumbers>] = &[
    // axial-gap at 16.
    (
        &["axial lp good_lp", "axial lp good_lp unit", "axial lp minilp", "axial lp microlp", "axial lp microlp unit"],
        &[
            (2, false, [702.0, 700.0, -703.0], [703.0, 701.9999999999982, -703.0]),
            (1, true, [703.9999999999982, 703.0, -705.0], [705.0, 703.0, -704.0]),
            (2, false, [704.0, 703.9999999999982, -707.0], [705.0, 705.0, -707.0]),
        ],
    ),
    // axial-gap at 1048576.
    (
        &["axial lp minilp unit"],
        &[
            (2, true, [700.0, -702.0, 703.0], [701.0, -700.0, 703.0]),
            (0, true, [702.0, -702.0, 703.0], [702.0, -700.0, 704.0]),
            (2, true, [702.0, -702.0, 705.0], [703.0000001192093, -700.0000001192093, 705.0]),
        ],
    ),
    // axial-distance at 100000000.
    (
        &["axial clipping f32", "axial of stored f32"],
        &[
            (
                1,
                false,
                [76465578.11029816, -50982700.78541751, -74389733.06860015],
                [76465578.30120775, -50982700.78541751, -74389732.49587141],
            ),
            (
                0,
                true,
                [76465578.49211733, -50982701.35814627, -74389732.68678099],
                [76465578.49211733, -50982700.78541751, -74389732.49587142],
            ),
        ],
    ),
    // axial-scale at 10000.
    (
        &["axial clipping f64"],
        &[
            (
                2,
                true,
                [-1058.1506747291933, 1058.150674729193, 3174.4520241875794],
                [0.0, 2116.301349458386, 3174.4520241875794],
            ),
            (
                1,
                true,
                [-2116.3013494583856, 2116.301349458386, 4232.602698916772],
                [0.0, 2116.301349458386, 5290.753373645965],
            ),
            (
                1,
                true,
                [0.0, 5290.753373645965, 6348.904048375158],
                [2116.301349458386, 5290.753373645965, 7407.054723104351],
            ),
        ],
    ),
];

/// Convex portals: their corners.
const CONVEX: &[Found<&[[f64; 3]]>] = &[
    // convex-length at 2.
    (
        &["separators 0.1"],
        &[
            &[
                [579.60546875, -3.7485753032433635, 0.0],
                [579.6083984375, -2.981449894146649, 0.0],
                [579.6083984375, 1.8226002655906774, 0.0],
                [579.60546875, 4.493479198271121, 0.0],
            ],
            &[
                [575.6611328125, -3.1565506198682027, 0.009765625],
                [575.6640625, -3.2592805459825818, 0.009765625],
                [575.6640625, 3.268045671384583, 0.009765625],
                [575.6611328125, 2.176633412269688, 0.009765625],
            ],
        ],
    ),
    // convex-scale at 0.001.
    (
        &["separators 0.001"],
        &[
            &[
                [-0.0004514093655022439, 0.0009696982644954264, 0.0007718178505886394],
                [-0.0006147674438037003, 0.00042664654056704613, 0.0007718178505886394],
                [0.0009379503630459322, 0.00042664654056704613, 0.0007718178505886394],
                [0.00037674676323430195, 0.0009696982644954264, 0.0007718178505886394],
            ],
            &[
                [-0.0009710895935807621, 0.0009696982644954264, 0.00158639543648121],
                [-0.0009218383307646815, 0.00015512067860285603, 0.0015863954364812097],
                [0.00030247979828661626, 0.00015512067860285603, 0.0015863954364812097],
                [0.0004034454891843132, 0.0009696982644954264, 0.00158639543648121],
            ],
        ],
    ),
    // convex-triangles at 100000.
    (
        &["separators f64"],
        &[
            &[
                [96192.50323162683, -63224.50262975142, 52922.50040112955],
                [96191.64333162634, -63225.3625297519, 52923.360301130015],
                [96192.50323162688, -63226.65237975263, 52922.0704511293],
            ],
            &[
                [96193.36313162732, -63223.642729750914, 52926.369951131725],
                [96193.79308162759, -63226.65237975264, 52928.0897511327],
                [96194.65298162801, -63225.79247975215, 52928.0897511327],
            ],
            &[
                [96195.0829316283, -63225.3625297519, 52930.66945113416],
                [96195.0829316283, -63225.3625297519, 52931.0994011344],
                [96195.0829316283, -63226.22242975239, 52931.529351134646],
            ],
        ],
    ),
    // convex-distance at 10000000.
    (
        &["separators f32", "convex of stored f32", "edges f32"],
        &[
            &[
                [1624525.8340613078, 5092097.725397964, 9087621.496290855],
                [1624525.7258006367, 5092097.617189684, 9087621.496290855],
                [1624525.7258006367, 5092097.920637421, 9087621.496290855],
                [1624525.8340613078, 5092098.020973469, 9087621.496290855],
            ],
            &[
                [1624525.9423219785, 5092097.611787966, 9087621.496290853],
                [1624525.9423219785, 5092097.696117611, 9087621.388030184],
                [1624525.9423219785, 5092098.04387388, 9087621.388030184],
                [1624525.9423219785, 5092097.901370559, 9087621.496290853],
            ],
        ],
    ),
    // convex-triangles at 1000000.
    (
        &["edges f64"],
        &[
            &[
                [959014.9336812906, -708817.1774591197, 342255.7001996567],
                [959014.9336812905, -708816.2048814783, 342254.7276220152],
                [959014.6094887432, -708815.2323038367, 342254.7276220152],
            ],
            &[
                [959017.5272216678, -708816.2048814782, 342255.7001996567],
                [959017.5272216677, -708815.556496384, 342254.0792369209],
                [959017.5272216678, -708815.556496384, 342256.348584751],
            ],
            &[
                [959020.1207620449, -708816.5290740255, 342256.348584751],
                [959021.4175322335, -708815.2323038367, 342256.348584751],
                [959020.444954592, -708816.2048814782, 342256.34858475113],
            ],
        ],
    ),
];
