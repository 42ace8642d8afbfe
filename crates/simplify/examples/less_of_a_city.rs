//! What is left of a city for a viewer at a street crossing, by budget.

use sightlines_geometry::Point3;
use sightlines_multifocal::mesh::{SheetMethod, Sheets};
use sightlines_multifocal::{FromRegion, Volume};
use sightlines_scenes::{CityOptions, city, city_crossings};
use sightlines_simplify::{HiddenBy, MeasureOptions, SimplifyOptions, Views, measure, simplify};
use std::sync::Arc;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let options = CityOptions { blocks_x: 4, blocks_z: 4, ..CityOptions::default() };
    let scene = city(options)?;
    let crossings = city_crossings(options)?;
    let views = Views::new([Volume::new(crossings[crossings.len() / 2])?])?;
    let triangles: Vec<[Point3; 3]> = scene.objects().iter().flat_map(|o| o.corners()).collect();
    let sheets = Arc::new(Sheets::new(&triangles));
    let make = || Box::new(SheetMethod::shared(Arc::clone(&sheets))) as Box<dyn FromRegion + Send>;
    let by = HiddenBy { method: Some(&make), table: None };
    println!("budget   triangles left   promised   measured   worst eye");
    for budget in [0.0, 1e-4, 1e-3, 1e-2, 1e-1] {
        let less = simplify(&scene, &views, &by, &SimplifyOptions::default().with_budget(budget))?;
        let measured = measure(&scene, &less, &views, &MeasureOptions { n_eyes: 20, ..MeasureOptions::default() })?;
        let left = less.counts.left as f64 / less.counts.before as f64;
        let (bound, worst) = (less.bound, measured.worst);
        println!("{budget:<8} {:>13.1} %  {bound:<9.2e}  {:<9.2e}  {worst:.2e}", 100.0 * left, measured.changed);
    }
    Ok(())
}
