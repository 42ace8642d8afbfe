//! Tables in memory and packed ones satisfy the contract of cell sources, and impostors are refused.

use sightlines_bake::{PlanBakeOptions, StabOptions, bake_plan, with_stab_trees};
use sightlines_eye_to_cell::TableCells;
use sightlines_eye_to_cell::conformance::impostors::{Fault, Impostor};
use sightlines_eye_to_cell::conformance::run;
use sightlines_packed::{PackOptions, Packed, pack};
use sightlines_pvs::Table;
use sightlines_scenes::{OfficeOptions, office};
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
    let cells = TableCells::new(&table);
    let own = run(&cells, None::<&TableCells<Table>>).expect("a table in memory conforms");
    assert!(own.cells > 50 && own.edges > 2 * own.cells && own.visible > own.edges, "{own:?}");
    assert!(own.objects > 10 && own.objects_seen > own.objects && own.nodes > own.cells, "{own:?}");
    let compared = run(&packed(&table), Some(&cells)).expect("a packed table conforms");
    assert_eq!((compared.compared, compared.edges, compared.nodes), (own.cells, own.edges, own.nodes));
}

#[test]
fn impostors_are_refused() {
    let table = table();
    let cells = TableCells::new(&table);
    for fault in Fault::ALL {
        match run(&Impostor::new(TableCells::new(&table), fault), Some(&cells)) {
            Ok(report) => panic!("{fault:?} goes unnoticed: {report:?}"),
            Err(violation) => assert_eq!(violation.clause(), fault.clause(), "{fault:?}: {violation}"),
        }
    }
}
