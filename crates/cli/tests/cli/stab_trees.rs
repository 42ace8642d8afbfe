//! Stab trees of tables: `build --stab-trees`, and what `info` says of them.

use crate::common::Folder;
use serde_json::Value;
use sightlines::bake::{GraphRef, StabOptions, from_table, with_stab_trees};
use sightlines::pvs::Table;

fn table(folder: &Folder, name: &str) -> Table {
    Table::from_bytes(&folder.read(name)).expect("a sound table")
}

#[test]
fn build_adds_stab_trees_and_info_counts_them() {
    let folder = Folder::with_office();
    let plain = table(&folder, "office.pvs");
    let built = folder.run(&["build", "office.geojson", "-o", "trees.pvs", "--stab-trees", "--json"]).expect(0).json();
    let with = table(&folder, "trees.pvs");
    let graph = from_table::graph(&plain).expect("a table with portals");
    let expected = with_stab_trees(plain.clone(), &graph, &StabOptions::default()).expect("a table with portals");
    assert!(with == expected.table, "the same trees as by the library, and nothing else is new");
    let trees = with.stab().expect("trees were asked for");
    assert_eq!(built["stab"]["n_sequences"], trees.n_sequences() as u64);
    assert_eq!(built["stab"]["n_stab_nodes"], trees.n_nodes());
    assert_eq!(built["stab"]["max_nodes"], expected.report.max_nodes);
    assert_eq!(built["n_bytes"], folder.read("trees.pvs").len());
    let grown = folder.read("trees.pvs").len() - folder.read("office.pvs").len();
    let info = folder.run(&["info", "trees.pvs", "--json"]).expect(0).json();
    assert_eq!(
        (&info["stab"]["n_stab_bytes"], &info["stab"]["n_stab_edges"]),
        (&grown.into(), &trees.n_edges().into())
    );
    let reply = folder.run(&["info", "trees.pvs"]).expect(0).out;
    let line = format!("\nstab trees     {} sequences in {} nodes", trees.n_sequences(), trees.n_nodes());
    assert!(reply.contains(&line) && reply.contains(" bytes a sequence\n"), "{reply}");
    // The twin: a table without trees does not speak of them.
    assert_eq!(folder.run(&["info", "office.pvs", "--json"]).expect(0).json()["stab"], Value::Null);
    assert!(!folder.run(&["info", "office.pvs"]).expect(0).out.contains("stab"));
}

/// Invariant: a limit cuts trees, whatever the number of threads, and it is reported.
#[test]
fn limits_cut_trees() {
    let folder = Folder::with_office();
    let build = |out: &str, more: &[&str]| {
        let args = [&["build", "office.geojson", "-o", out], more].concat();
        let reply = folder.run(&args).expect(0).out;
        (folder.read(out), reply)
    };
    let (one, reply) = build("one.pvs", &["--stab-trees=5", "--threads", "1"]);
    assert!(reply.contains("\ncut trees      ") && reply.contains(" at 5 nodes each\n"), "{reply}");
    assert!(one == build("two.pvs", &["--threads", "2", "--stab-trees=5"]).0, "threads change nothing");
    let (whole, reply) = build("whole.pvs", &["--stab-trees"]);
    assert!(one != whole && !reply.contains("cut trees"), "{reply}");
    for wrong in ["--stab-trees=0", "--stab-trees=-1", "--stab-trees=x", "--stab-trees="] {
        let run = folder.run(&["build", "office.geojson", "-o", "no.pvs", wrong]).expect(2);
        assert!(run.err.contains("--stab-trees"), "{}", run.err);
    }
}

/// The numbers that the help names are those that are taken.
#[test]
fn help_names_the_limits() {
    let folder = Folder::with_office();
    let help = folder.run(&["build", "--help"]).expect(0).out.split_whitespace().collect::<Vec<_>>().join(" ");
    let plan = GraphRef::from(&from_table::graph(&table(&folder, "office.pvs")).expect("a table with portals"))
        .most_nodes()
        .expect("portals");
    assert!(help.contains(&format!("without N {plan} for plans, 16384 for scenes in space, 4096 for")), "{help}");
}
