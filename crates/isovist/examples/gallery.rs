//! Isovists in a gallery of three rooms: `cargo run -p sightlines-isovist --example gallery`.

use sightlines_cells::Plan;
use sightlines_geometry::Point2;
use sightlines_isovist::WallMesh;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let walls = [
        [0, 0, 12, 0],
        [12, 0, 12, 5],
        [12, 5, 0, 5],
        [0, 5, 0, 0],
        // Two walls with a doorway each.
        [4, 0, 4, 2],
        [4, 3, 4, 5],
        [8, 0, 8, 1],
        [8, 2, 8, 5],
    ];
    let point = |x: i32, y: i32| Point2::new(f64::from(x), f64::from(y));
    let plan = Plan::from_walls(walls.map(|[ax, ay, bx, by]| (point(ax, ay), point(bx, by))))?;
    let mesh = WallMesh::new(&plan)?;
    println!("eye         area  occlusivity  mean radial  walls seen");
    for eye in [Point2::new(1.0, 1.0), Point2::new(2.0, 2.5), Point2::new(6.0, 2.0), Point2::new(10.0, 1.5)] {
        let isovist = mesh.isovist(eye)?;
        let m = isovist.measures();
        let walls = isovist.walls().len();
        println!("{eye:<10} {:5.2}  {:11.2}  {:11.2}  {walls:10}", m.area, m.occlusivity, m.mean_radial);
    }
    Ok(())
}
