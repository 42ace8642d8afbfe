//! Tables to look around in.

use super::Folder;
use sightlines::pvs::Table;

pub(crate) fn table(folder: &Folder, name: &str) -> Table {
    Table::from_bytes(&folder.read(name)).expect("a sound table")
}

pub(crate) fn middle(table: &Table, cell: usize) -> String {
    let cell = &table.cells()[cell];
    let middle: Vec<String> =
        (0..usize::from(table.dimension())).map(|k| (0.5 * (cell.min[k] + cell.max[k])).to_string()).collect();
    middle.join(",")
}

/// Folders with a table of a plan and of a tower, and some directions and lenses for each.
pub(crate) fn scenes() -> [(Folder, &'static str, Vec<Vec<&'static str>>); 2] {
    let plan = vec![vec!["--dir", "1,0", "--fov", "40"], vec!["--dir=-1,-2", "--fov", "270"], vec![]];
    let tower = vec![
        vec!["--dir", "1,0,0", "--fov", "40"],
        vec!["--dir=-1,-0.2,2", "--aspect", "16/9", "--up", "y"],
        vec!["--dir", "0,-1,0", "--fov", "200", "--up", "0,1,0.5"],
    ];
    [(Folder::with_office(), "office.pvs", plan), (Folder::with_tower(), "tower.pvs", tower)]
}
