//! Tables against what the data folder says was seen.

use sightlines::pvs::{CellId, Table};
use sightlines_tests::CellWitness;

/// What a table hides of what was seen.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Hidden {
    /// Pairs of a place and an object that was seen from it.
    pub n_seen: u64,
    /// Places that no cell overlaps.
    pub n_places_outside: u64,
    /// Place by place, objects that none of the cells that overlap it sees.
    pub hidden: Vec<(String, Vec<u32>)>,
}

impl Hidden {
    /// Pairs of a place and an object that is hidden from it.
    pub fn n_hidden(&self) -> u64 {
        self.hidden.iter().map(|(_, objects)| objects.len() as u64).sum()
    }
}

/// Asks a table for everything that was seen: an object is shown from a place if any cell that has more than
/// its border in common with the place sees it.
pub fn compare(table: &Table, witness: &[CellWitness]) -> Hidden {
    let mut found = Hidden::default();
    for place in witness {
        let mut shown = vec![false; table.objects().len()];
        let mut n_cells = 0;
        for (cell, record) in (0u32..).map(CellId).zip(table.cells()) {
            if (0..3).all(|k| record.min[k] < place.max[k] && place.min[k] < record.max[k]) {
                n_cells += 1;
                table.visible_objects(cell).into_iter().for_each(|o| shown[o.idx()] = true);
            }
        }
        found.n_seen += place.objects.len() as u64;
        found.n_places_outside += u64::from(n_cells == 0);
        let is_shown = |o: &u32| shown.get(*o as usize).copied().unwrap_or(false);
        let hidden: Vec<u32> = place.objects.iter().copied().filter(|o| !is_shown(o)).collect();
        if !hidden.is_empty() {
            found.hidden.push((place.id.clone(), hidden));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines::bake::{SceneBakeOptions, bake_scene};
    use sightlines::scenes::{TowerOptions, tower};

    #[test]
    fn what_is_hidden_is_found() {
        let options = TowerOptions { floors: 1, rooms_x: 1, rooms_y: 1, furniture: 0, ..TowerOptions::default() };
        let table = bake_scene(&tower(options).unwrap(), &SceneBakeOptions::default()).unwrap().table;
        let n_objects = table.objects().len() as u32;
        let cell = &table.cells()[0];
        let seen: Vec<u32> = table.visible_objects(CellId(0)).into_iter().map(|o| o.0).collect();
        let place =
            |id: &str, objects: Vec<u32>, max: [f64; 3]| CellWitness { id: id.into(), min: cell.min, max, objects };
        let all = [place("in", seen.clone(), cell.max), place("flat", vec![0], cell.min)];
        let found = compare(&table, &all);
        assert_eq!((found.n_seen, found.n_places_outside), (seen.len() as u64 + 1, 1));
        assert_eq!((found.n_hidden(), found.hidden), (1, vec![("flat".to_owned(), vec![0])]));
        // An object that the table does not have.
        assert_eq!(compare(&table, &[place("in", vec![n_objects], cell.max)]).n_hidden(), 1);
    }
}
