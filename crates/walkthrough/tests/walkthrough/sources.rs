//! Tables in memory and packed ones satisfy the contract of cell sources, and impostors are refused.

use sightlines_bake::{PlanBakeOptions, StabOptions, bake_plan, with_stab_trees};
use sightlines_eye_to_cell::TableCells;
use sightlines_packed::{PackOptions, Packed, pack};
use sightlines_pvs::Table;
use sightlines_scenes::{OfficeOptions, office};
use sightlines_testkit::conformance::{CellSources, Impostor, Suite};
use sightlines_walkthrough::PackedCells;

fn table() -> Table {
    let plan = office(OfficeOptions { furniture: true, ..OfficeOptions::default() }).expect("an office");
    let baked = bake_plan(&plan, &PlanBakeOptions::default()).expect("a plan");
    let few = StabOptions { max_nodes: Some(64), threads: 1, ..StabOptions::default() };
    with_stab_trees(baked.table, &baked.graph, &few).expect("the graph of the table").table
}

fn packed(table: &Table) -> PackedCells<Vec<u8>> {
    let bytes = pack(table, &PackOptions::default()).expect("a table");
    PackedCells::new(Packed::open(bytes, 1 << 20).expect("what was packed opens"))
}

#[test]
fn tables_in_memory_and_packed_conform() {
    let table = table();
    let mut cells = TableCells::new(&table);
    let own =
        CellSources { reference: None::<&TableCells<Table>> }.run(&mut cells).expect("a table in memory conforms");
    assert!(own["cells"] > 50 && own["portals of cells"] > 2 * own["cells"], "{own:?}");
    assert!(own["visible cells"] > own["portals of cells"] && own["objects"] > 10, "{own:?}");
    assert!(own["visible objects"] > own["objects"] && own["nodes of stab trees"] > own["cells"], "{own:?}");
    let compared = CellSources { reference: Some(&cells) }.run(&mut packed(&table)).expect("a packed table conforms");
    assert_eq!(compared["cells compared"], own["cells"]);
    assert_eq!(compared["portals of cells"], own["portals of cells"]);
    assert_eq!(compared["nodes of stab trees"], own["nodes of stab trees"]);
}

#[test]
fn impostors_are_refused() {
    let table = table();
    let cells = TableCells::new(&table);
    CellSources { reference: Some(&cells) }.refuse_all(|fault| Impostor::new(TableCells::new(&table), fault));
}
