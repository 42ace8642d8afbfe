//! Checks a true table and one with a pair hidden that is seen: `cargo run -p sightlines-verify --example check_a_table`.

use sightlines_bake::{PlanBakeOptions, bake_plan};
use sightlines_pvs::{CellId, Table};
use sightlines_scenes::{OfficeOptions, office};
use sightlines_verify::{Truth, VerifyOptions, verify};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let plan = office(OfficeOptions { rooms_x: 4, rooms_y: 2, ..OfficeOptions::default() })?;
    let table = bake_plan(&plan, &PlanBakeOptions::default())?.table;
    let options = VerifyOptions::default();

    let found = verify(&table, &Truth::Plan(&plan), &options)?;
    println!(
        "{} violations; {:.0} % of the visible pairs confirmed by rays",
        found.n_violations,
        100.0 * found.cells.share()
    );

    // Hide the farthest cell that the first one sees.
    let far = table.visible(CellId(0)).last().ok_or("a cell sees itself")?;
    let mut parts = table.into_parts();
    parts.rows.set(0, far.idx(), false);
    parts.rows.set(far.idx(), 0, false);
    let found = verify(&Table::new(parts)?, &Truth::Plan(&plan), &options)?;
    for violation in &found.violations {
        println!("{violation}");
    }
    assert!(!found.is_true(), "the pair is seen");
    Ok(())
}
