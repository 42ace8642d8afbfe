use super::*;
use sightlines_geometry::Random;

/// Lines that leave a side of the box beside the window of its plane are not known to be blocked.
#[test]
fn exits_beside_the_window_are_unknown() {
    let volume = Volume::new(Aabb { min: [-1.0; 3], max: [1.0; 3] }).unwrap();
    let target = Aabb { min: [20.0, 6.0, 0.0], max: [20.0, 7.0, 1.0] };
    let plane = |window: f64| BufferPlane::new(0, true, 10.0, [-window; 2], [window; 2], [4, 4]).unwrap();
    let face = [[-9.0, 9.0]; 2];
    assert!(matches!(exits(&volume, &plane(9.0), &face, &target), Exits::Texels(_)));
    assert_eq!(exits(&volume, &plane(3.0), &face, &target), Exits::Unknown);
    assert_eq!(exits(&volume, &plane(9.0), &[[-9.0, 2.0]; 2], &target), Exits::None);
}

/// Boxes so far away that their planes round to one coordinate have one plane.
#[test]
fn planes_that_round_to_one_coordinate_are_left_out() {
    let far = (1u64 << 53) as f64;
    let volume = Volume::new(Aabb { min: [far - 8_388_672.0, -1.0, -1.0], max: [far, 1.0, 1.0] }).unwrap();
    let wide = 4_194_304.0;
    let scene = Aabb { min: [far - 8_388_672.0, -wide, -wide], max: [far + 40.0, wide, wide] };
    let layout = Layout { planes: 400, texels: 1, growth: 1.5, ..Layout::default() };
    let surround = Surround::new(&volume, &scene, &layout).unwrap();
    let up = &surround.directions()[1];
    assert!(up.plane_of_box.contains(&None) && up.plane_of_box.iter().flatten().count() == up.planes.len());
    for growth in [-1.0, f64::NAN, f64::INFINITY, 0.0] {
        // Whatever comes out, planes are in order.
        if let Ok(surround) = Surround::new(&volume, &scene, &Layout { growth, ..layout }) {
            assert!((0..6).all(|side| surround.job(side, []).is_ok()), "{growth}");
        }
    }
}

/// A pseudorandom surround with blocked rectangles in its buffers.
fn blocked(random: &mut Random, buffers: &mut [Vec<Buffer>; 6], surround: &Surround) {
    for (side, buffers) in surround.directions().iter().zip(buffers) {
        buffers.clear();
        for plane in &side.planes {
            let mut buffer = Buffer::new(plane);
            let [width, height] = buffer.texels().map(|n| n as usize);
            for _ in 0..5 {
                let [x, y] = [random.below(width), random.below(height)];
                let [w, h] = [1 + random.below(width - x), 1 + random.below(height - y)];
                let value = 1 + random.below(1 << 22) as u32;
                for row in buffer.values_mut().chunks_mut(width).skip(y).take(h) {
                    row[x..x + w].iter_mut().for_each(|v| *v = (*v).max(value));
                }
            }
            buffers.push(buffer);
        }
    }
}

/// A few lines spare most footprints of what is not hidden, and none of what is.
#[test]
fn single_lines_change_no_answer() {
    let mut random = Random::new(7);
    let volume = Volume::new(Aabb { min: [-1.0; 3], max: [1.0; 3] }).unwrap();
    let scene = Aabb { min: [-40.0, -30.0, -35.0], max: [45.0, 30.0, 20.0] };
    let surround = Surround::new(&volume, &scene, &Layout { texels: 24, ..Layout::default() }).unwrap();
    let mut buffers: [Vec<Buffer>; 6] = Default::default();
    // Of planes and of boxes: those that hide, those that do not and are looked at, and all that do not.
    let (mut counts, mut n_missed) = ([[0; 3]; 2], 0);
    for _ in 0..60 {
        blocked(&mut random, &mut buffers, &surround);
        let units = [2f64.powi(-16); 6];
        let surrounded = Surrounded::new(&surround, &buffers, units);
        for _ in 0..100 {
            let middle = random.point(&scene);
            let points = [0; 3].map(|_| [0, 1, 2].map(|k| middle[k] + random.unit() * 0.5 - 0.25));
            let target = Aabb::around(points);
            let centre = [0, 1, 2].map(|k| points.iter().map(|p| p[k] / 3.0).sum());
            for side in 0..6 {
                for k in 0..surround.directions()[side].planes.len() {
                    let may = surrounded.may_plane_hide(side, k, &points, centre, &target);
                    let hides = surrounded.plane_hides(side, k, &points, &target);
                    assert!(may || !hides, "{points:?} {side} {k}");
                    let [hidden, asked, open] = &mut counts[0];
                    *hidden += usize::from(hides);
                    *asked += usize::from(may && !hides);
                    *open += usize::from(!hides);
                    // An impostor that looks beside the target.
                    let beside = centre.map(|x| x + 3.0);
                    n_missed += usize::from(hides && !surrounded.may_plane_hide(side, k, &points, beside, &target));
                }
            }
            for k in 0..surrounded.n_boxes() {
                let (may, hides) = (surrounded.may_box_hide(k, centre, &target), surrounded.box_hides(k, &target));
                assert!(may || !hides, "{points:?} {k}");
                let [hidden, asked, open] = &mut counts[1];
                *hidden += usize::from(hides);
                *asked += usize::from(may && !hides);
                *open += usize::from(!hides);
            }
        }
    }
    let [planes, boxes] = counts;
    assert!(planes[0] > 1000 && boxes[0] > 500, "{counts:?}");
    assert!(planes[1] * 10 < planes[2] && boxes[1] * 2 < boxes[2], "{counts:?}");
    assert!(n_missed > 100, "{n_missed}");
}
