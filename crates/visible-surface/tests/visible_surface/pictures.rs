//! The pictures of the examples: what is on them, and that it is within their frames.

#[expect(dead_code, reason = "the main function of the example")]
#[path = "../../examples/bsp_planes.rs"]
mod bsp_planes;
#[expect(dead_code, reason = "the main function of the example")]
#[path = "../../examples/newell_cycle.rs"]
mod newell_cycle;

/// The numbers of an attribute, wherever it is.
fn numbers<'a>(svg: &'a str, attribute: &'a str) -> impl Iterator<Item = f64> + 'a {
    svg.split(attribute).skip(1).filter_map(|rest| rest.split('"').next()?.parse().ok())
}

fn count(svg: &str, text: &str) -> usize {
    svg.matches(text).count()
}

#[test]
fn a_tree_is_drawn_with_all_its_planes() {
    let svg = bsp_planes::picture().unwrap();
    let (planes, branches) = (count(&svg, "class=\"plane\""), count(&svg, "class=\"branch\""));
    // Every node has a plane that meets its region, and every one but the root a branch; each has a label in both.
    assert!(planes > 6 && branches + 1 == planes, "{planes}, {branches}");
    assert_eq!(count(&svg, "text-anchor=\"middle\""), 2 * planes);
    assert_eq!(count(&svg, "class=\"wall\""), 6);
    let pieces = svg.split("lie in: ").nth(1).and_then(|rest| rest.split("</text>").next()).unwrap();
    let mut pieces: Vec<&str> = pieces.split(' ').collect();
    pieces.sort_unstable();
    pieces.dedup();
    assert_eq!(pieces.len(), planes, "one piece in each plane: {pieces:?}");
    let mut n = 0;
    for (attribute, most) in
        [(" x1=\"", 1000.0), (" x2=\"", 1000.0), (" y1=\"", 620.0), (" y2=\"", 620.0), (" cx=\"", 1000.0)]
    {
        n += numbers(&svg, attribute).inspect(|x| assert!((0.0..=most).contains(x), "{attribute}{x}")).count();
    }
    assert!(n > 60, "{n}");
    assert!(["wall</text>", "eye</text>", "plane, within"].iter().all(|label| svg.contains(label)));
}

#[test]
fn the_cycle_is_wrong_by_the_painter_only() {
    let svg = newell_cycle::picture().unwrap();
    assert_eq!((count(&svg, "class=\"bar\""), count(&svg, "class=\"rim\"")), (9, 1));
    assert!(svg.contains("Newell: wrong pixels 0, splits 1<"), "{svg:.900}");
    assert!(svg.contains("painter's sort: wrong pixels ") && !svg.contains("painter's sort: wrong pixels 0,"));
    assert!(svg.contains("around pixels that show the wrong bar</text>"));
}
