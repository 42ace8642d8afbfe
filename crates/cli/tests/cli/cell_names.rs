//! Names of cells, as the commands tell them.

use crate::common::Folder;
use crate::common::looks::{middle, table};
use serde_json::json;
use sightlines::pvs::{CellId, Table};

/// The office with a name for each cell, beside the office itself.
fn named(folder: &Folder) -> Table {
    let mut parts = table(folder, "office.pvs").into_parts();
    parts.cell_names = (0..parts.cells.len()).map(|i| format!("room{i}_\"Büro\"")).collect();
    let named = Table::new(parts).unwrap();
    folder.write("named.pvs", named.to_bytes());
    named
}

#[test]
fn query_tells_the_name_beside_the_number() {
    let folder = Folder::with_office();
    let table = named(&folder);
    folder.run(&["pack", "named.pvs", "-o", "named.pvz"]).expect(0);
    let mut n = 0;
    for cell in [0, table.n_cells() / 2, table.n_cells() - 1] {
        let eye = middle(&table, cell);
        let name = table.cell_name(CellId(cell as u32)).unwrap();
        for file in ["named.pvs", "named.pvz"] {
            for more in [&[][..], &["--method", "exact"]] {
                let ask = |file: &str, json: &[&str]| {
                    folder.run(&[&["query", file, "--eye", &eye][..], more, json].concat()).expect(0)
                };
                let reply = ask(file, &[]).out;
                assert!(reply.contains(&format!(" is in cell {cell} ({name:?})\n")), "{reply}");
                let reply = ask(file, &["--json"]).json();
                assert_eq!((&reply["cells"], &reply["cell_names"]), (&json!([cell]), &json!([name])));
                // The twin: a table without names says nothing of them.
                assert!(ask("office.pvs", &[]).out.contains(&format!(" is in cell {cell}\n")));
                assert!(ask("office.pvs", &["--json"]).json().get("cell_names").is_none());
                n += 1;
            }
        }
    }
    assert_eq!(n, 12);
    let outside = folder.run(&["query", "named.pvs", "--eye", "-1e5,2"]).expect(1).out;
    assert_eq!(outside, "the point (-100000, 2) is outside every cell\n");
}

/// On the border of two cells each has its own name.
#[test]
fn cells_at_a_border_are_named_one_by_one() {
    let folder = Folder::with_office();
    let table = named(&folder);
    let [a, b] = table.portals()[0].points[..] else { panic!("a portal of the plane has two ends") };
    let eye = format!("{},{}", (a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0);
    let found = folder.run(&["query", "named.pvs", "--eye", &eye, "--json"]).expect(0).json();
    let ids: Vec<u64> = found["cells"].as_array().unwrap().iter().map(|id| id.as_u64().unwrap()).collect();
    assert!(ids.len() > 1);
    let names: Vec<&str> = ids.iter().map(|&id| table.cell_name(CellId(id as u32)).unwrap()).collect();
    assert_eq!(found["cell_names"], json!(names));
    let listed: Vec<String> = ids.iter().zip(&names).map(|(id, name)| format!("{id} ({name:?})")).collect();
    let reply = folder.run(&["query", "named.pvs", "--eye", &eye]).expect(0).out;
    assert!(reply.contains(&format!(" is on the border of cells {}\n", listed.join(" "))), "{reply}");
}

#[test]
fn names_survive_packing_and_are_exported() {
    let folder = Folder::with_office();
    let table = named(&folder);
    folder.run(&["pack", "named.pvs", "-o", "named.pvz"]).expect(0);
    folder.run(&["unpack", "named.pvz", "-o", "back.pvs"]).expect(0);
    assert!(folder.read("back.pvs") == folder.read("named.pvs"));
    for (file, has_names) in [("named.pvs", true), ("named.pvz", true), ("office.pvs", false)] {
        let info = folder.run(&["info", file, "--json"]).expect(0).json();
        assert_eq!(info["has_cell_names"], has_names, "{file}");
        assert_eq!(folder.run(&["info", file]).expect(0).out.contains(", with names\n"), has_names, "{file}");
    }
    let info = folder.run(&["info", "named.pvz"]).expect(0).out;
    assert!(info.contains("CNAM") && info.contains("names of cells"), "{info}");
    let [with, without] = ["named.pvs", "office.pvs"].map(|file| folder.run(&["export", file]).expect(0).json());
    for (cell, (with, without)) in
        with["cells"].as_array().unwrap().iter().zip(without["cells"].as_array().unwrap()).enumerate()
    {
        assert_eq!(with["name"], table.cell_name(CellId(cell as u32)).unwrap());
        assert!(without.get("name").is_none());
    }
}
