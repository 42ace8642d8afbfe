use super::*;

/// Size and pixels with their transparency.
fn decoded(png: &[u8]) -> ([u32; 2], Vec<[u8; 4]>) {
    let picture = image::load_from_memory_with_format(png, image::ImageFormat::Png).unwrap();
    let picture = picture.as_rgba8().unwrap();
    ([picture.width(), picture.height()], picture.pixels().map(|pixel| pixel.0).collect())
}

/// Six squares of 10 by 10, the middle one below without a value, in a box.
fn field<'a>(points: &'a [Point2], values: &'a [Option<f64>], walls: &'a [Segment2]) -> Field<'a> {
    Field { title: "Mean Depth [a < b]", unit: "steps", points, side: 10.0, values, walls, size: 400 }
}

fn points() -> Vec<Point2> {
    (0..3).flat_map(|x| (0..2).map(move |y| Point2::new(10.0 * f64::from(x), 10.0 * f64::from(y)))).collect()
}

const VALUES: [Option<f64>; 6] = [Some(1.0), Some(2.0), None, Some(3.0), Some(f64::NAN), Some(5.0)];

#[test]
fn the_scale_is_one_hue_that_only_gets_darker() {
    let linear = |x: u8| (f64::from(x) / 255.0).powf(2.2);
    let lightness = |[r, g, b]: [u8; 3]| 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
    let all: Vec<[u8; 3]> = (0..=255).map(|k| field_colour(f64::from(k) / 255.0)).collect();
    // Steps of a sixty-fourth are seen in every part; bytes do not hold all 256.
    assert!(all.windows(2).all(|pair| lightness(pair[0]) >= lightness(pair[1])));
    for k in 0..252 {
        assert!(lightness(all[k]) > 1.01 * lightness(all[k + 4]), "{k}");
    }
    assert!(all.iter().all(|[r, g, b]| b > g && g > r), "blue");
    assert!(lightness(all[0]) > 0.8 && lightness(all[255]) < 0.03);
    let odd = [f64::NAN, -1.0, 0.0, 1.0, 9.0].map(field_colour);
    assert_eq!((odd[0], odd[1], odd[3]), (odd[2], odd[2], odd[4]));
}

#[test]
fn squares_have_the_colours_of_their_values_and_the_rest_is_transparent() {
    let points = points();
    let walls = [Segment2::new(Point2::new(-5.0, 5.0), Point2::new(25.0, 5.0))];
    let field = field(&points, &VALUES, &walls);
    let (size, pixels) = decoded(&field_png(&field).unwrap());
    let frame = Frame::around(Aabb { min: [-5.0; 2], max: [25.0, 15.0] }, 400);
    let at = |x: f64, y: f64| {
        let [x, y] = frame.place(Point2::new(x, y)).map(|x| x as usize);
        pixels[y * size[0] as usize + x]
    };
    let opaque = |[r, g, b]: [u8; 3]| [r, g, b, 255];
    for (p, value) in points.iter().zip(VALUES) {
        let expected = value.filter(|x| x.is_finite()).map_or([0; 4], |x| opaque(field_colour((x - 1.0) / 4.0)));
        for (dx, dy) in [(0.0, 0.0), (-4.0, 4.0), (4.0, -3.0)] {
            let there = if (p.y + dy - 5.0).abs() < 2.0 { continue } else { at(p.x + dx, p.y + dy) };
            assert_eq!(there, expected, "{p} {value:?}");
        }
        // Grey, of ink and of the paper around it; squares are blue.
        let near = (-9..=9).map(|k| at(p.x, 5.0 + 0.05 * f64::from(k)));
        let has_wall = near.clone().any(|[r, _, b, a]| r < 140 && b < r + 30 && a == 255);
        assert!(has_wall, "{:?}", near.collect::<Vec<_>>());
    }
    assert_eq!(pixels[0], [0; 4], "the margin");
    assert_eq!(pixels[pixels.len() - 1], [255; 4], "the legend has paper");
    // The legend shows the whole scale.
    let legend: std::collections::BTreeSet<[u8; 4]> =
        pixels[frame.height as usize * size[0] as usize..].iter().copied().collect();
    let shown = (0..STEPS).filter(|&k| legend.contains(&opaque(field_colour((f64::from(k) + 0.5) / f64::from(STEPS)))));
    assert_eq!(shown.count() as u32, STEPS);
}

#[test]
fn words_say_what_is_shown() {
    let points = points();
    let svg = field_svg(&field(&points, &VALUES, &[]));
    for text in ["Mean Depth [a &lt; b], in steps", "2 of 6 points have no value", ">1<", ">5<"] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    let squares = |svg: &str| svg.matches('Z').count() - STEPS as usize;
    assert_eq!(squares(&svg), 4);
}

#[test]
fn pictures_of_nothing_and_of_one_value_are_drawn() {
    let (none, alone) = (field_svg(&field(&[], &[], &[])), [Some(7.0)]);
    assert!(none.ends_with("</svg>\n") && !none.contains("inf"));
    assert!(field_png(&field(&[], &[], &[])).is_ok());
    let point = [Point2::new(3.0, 4.0)];
    let svg = field_svg(&field(&point, &alone, &[]));
    let [r, g, b] = field_colour(0.5);
    assert!(svg.contains(&format!("#{r:02x}{g:02x}{b:02x}")) && svg.contains(">7<"));
}

#[cfg(feature = "png")]
#[test]
fn both_kinds_of_picture_are_alike() {
    let points = points();
    let walls = [Segment2::new(Point2::new(-5.0, -5.0), Point2::new(25.0, 15.0))];
    let field = field(&points, &VALUES, &walls);
    let (size, ours) = decoded(&field_png(&field).unwrap());
    let (other, theirs) = decoded(&crate::svg_to_png(&field_svg(&field)).unwrap());
    assert_eq!(size, other);
    let far = |a: &[u8; 4], b: &[u8; 4]| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 60);
    let n_far = ours.iter().zip(&theirs).filter(|(a, b)| far(a, b)).count();
    assert!(n_far * 50 < ours.len(), "{n_far} of {}", ours.len());
}
