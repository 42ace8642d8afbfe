//! Two players in a tower: when the server has to tell one of the other, as that one comes up the stairs.

use sightlines_bake::{BakeRequest, Runtime};
use sightlines_geometry::Aabb;
use sightlines_relevance::{Body, Player, PlayerRole, ReachOptions, Reaches, Relevance, RelevanceOptions};
use sightlines_scenes::{TowerOptions, tower};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = tower(TowerOptions { floors: 3, ..TowerOptions::default() })?;
    let runtime = Runtime::default();
    let table = BakeRequest::default().prepare(&scene, &runtime)?.run(&runtime)?.table;
    let reaches = Reaches::of(&table, &ReachOptions::default())?;
    for (reach, hidden) in reaches.ladder().iter().zip(reaches.hidden_shares()) {
        println!("reach {reach:5}: {:5.1} % of all pairs of cells do not see each other", 100.0 * hidden);
    }
    let options = RelevanceOptions::of(&table);
    let mut relevance = Relevance::new(table, reaches, options);
    let player = |[x, y, z]: [f64; 3]| {
        let eyes = Aabb { min: [x, y + 1.6, z], max: [x, y + 1.7, z] };
        let seen = Aabb { min: [x - 0.3, y, z - 0.3], max: [x + 0.3, y + 1.8, z + 0.3] };
        Player { body: Body::new(eyes, seen).moving(5.0, 0.12), role: PlayerRole::ALONE }
    };
    let still = player([2.0, 0.1, 2.0]);
    for floor in (0..3).rev() {
        let other = player([3.0, 0.1 + 3.25 * f64::from(floor), 3.0]);
        relevance.update(f64::from(3 - floor), &[still, other]);
        let seconds = relevance.time_to_sight(&still.body, &other.body, [5.0, 5.0]);
        println!("floor {floor}: told of the other: {}; no sight within {seconds:.2} s", relevance.is_shown(0, 1));
    }
    Ok(())
}
