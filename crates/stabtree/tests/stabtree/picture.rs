//! The picture of the example: a stab tree beside its plan.

#[expect(dead_code, reason = "the main function of the example")]
#[path = "../../examples/stab_tree.rs"]
mod stab_tree;

#[test]
fn the_tree_is_drawn_beside_its_plan() {
    let svg = stab_tree::picture().unwrap();
    let count = |text: &str| svg.matches(text).count();
    let (cells, nodes, branches) = (count("class=\"cell\""), count("class=\"node\""), count("class=\"branch\""));
    assert!(cells > 8 && nodes > 4 && branches + 1 == nodes, "{cells}, {nodes}, {branches}");
    assert!(svg.contains(&format!(">{nodes} nodes for ")));
    let mut n = 0;
    for (attribute, range) in [(" cx=\"", 520.0..=980.0), (" cy=\"", 50.0..=570.0)] {
        for number in svg.split(attribute).skip(1).filter_map(|rest| rest.split('"').next()?.parse::<f64>().ok()) {
            assert!(range.contains(&number), "{attribute}{number}");
            n += 1;
        }
    }
    for corner in svg.split("points=\"").skip(1).filter_map(|rest| rest.split('"').next()).flat_map(|p| p.split(' ')) {
        let (x, y) = corner.split_once(',').expect("two coordinates");
        let [x, y]: [f64; 2] = [x, y].map(|x| x.parse().expect("a number"));
        assert!((19.0..=481.0).contains(&x) && (59.0..=561.0).contains(&y), "{corner}");
        n += 1;
    }
    assert!(n > 40, "{n}");
    assert_eq!(svg.matches("#f0701a").count(), 3, "the cell in the plan, in the tree and in the legend");
    assert!(["the cell</text>", "not seen</text>", "5 and more</text>"].iter().all(|label| svg.contains(label)));
}
