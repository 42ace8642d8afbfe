//! All measures against a program in Python that shares nothing with the crate, on plans of some hundred points.

use crate::dense::{At, Matrix, Walls, is_near};
use sightlines_geometry::Random;
use sightlines_visibility_graph::{
    Analysis, AnalysisOptions, Measure, PixelGrid, Points, Turns, VisibilityGraph, WorkOptions,
};
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// A box with random walls.
fn random(seed: u64) -> Walls {
    let mut random = Random::new(seed);
    let (w, h) = (27, 19);
    let mut walls = vec![[[1, 1], [w, 1]], [[w, 1], [w, h]], [[w, h], [1, h]], [[1, h], [1, 1]]];
    while walls.len() < 12 {
        let mut at = || [1 + random.below(w as usize - 1) as i64, 1 + random.below(h as usize - 1) as i64];
        let (a, mut b) = (at(), at());
        if walls.len() % 3 > 0 {
            b[walls.len() % 2] = a[walls.len() % 2];
        }
        if a != b {
            walls.push([a, b]);
        }
    }
    Walls(walls)
}

/// What the program finds: names of columns, and a row for each point. `None` without Python.
fn oracle(folder: &Path, walls: &Walls, at: &[At], points: &Points) -> Option<(Vec<String>, Vec<Vec<f64>>)> {
    let (mut lines, mut places) = (String::new(), String::new());
    walls.0.iter().for_each(|[a, b]| _ = writeln!(lines, "{},{},{},{}", a[0], a[1], b[0], b[1]));
    for (k, p) in at.iter().enumerate() {
        let _ = writeln!(places, "{},{},{}", p[0], p[1], u8::from(points.is_near_wall(k as u32)));
    }
    let files = [folder.join("walls.csv"), folder.join("points.csv")];
    std::fs::write(&files[0], lines).unwrap();
    std::fs::write(&files[1], places).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/visibility-graph/oracle.py");
    let output = match Command::new("python3").arg(script).args(&files).output() {
        Ok(output) => output,
        Err(error) => {
            eprintln!("SKIPPED: python3 cannot be run: {error}");
            return None;
        }
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let mut rows = text.lines();
    let names = rows.next().unwrap().split(',').map(str::to_owned).collect();
    Some((names, rows.map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()))
}

/// How often columns of the program and of the crate differ, by name.
fn wrong(names: &[String], rows: &[Vec<f64>], graph: &VisibilityGraph, points: &Points) -> Vec<String> {
    let of = |turns| {
        let options = AnalysisOptions { turns, ..AnalysisOptions::default() };
        Analysis::of(graph, points, &Measure::ALL, &options, &WorkOptions::default()).unwrap()
    };
    let (near, anywhere) = (of(Turns::NearWalls), of(Turns::Anywhere));
    let mut all = Vec::new();
    for (k, name) in names.iter().enumerate() {
        let values = if name == "any-length" {
            anywhere.values(Measure::MetricLength)
        } else {
            let measure = Measure::ALL.into_iter().find(|measure| measure.name() == name);
            near.values(measure.expect("a measure"))
        };
        let values = values.unwrap();
        assert_eq!(values.len(), rows.len());
        if rows.iter().zip(&values).any(|(row, &value)| !is_near(row[k], value)) {
            all.push(name.clone());
        }
    }
    all
}

#[test]
fn measures_are_those_of_a_program_in_python() {
    let folder = std::env::temp_dir().join(format!("sightlines-visibility-graph-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (mut n_points, mut n_longer) = (0, 0);
    for seed in 0..3 {
        let walls = random(seed);
        let points = PixelGrid::over(&walls.plan(), 2.0).unwrap().enclosed().unwrap();
        let at: Vec<At> = points.coordinates().iter().map(|p| [p.x as i64, p.y as i64]).collect();
        let matrix = Matrix::of(&walls, &at);
        let graph = matrix.graph(&WorkOptions::default()).unwrap();
        let Some((names, rows)) = oracle(&folder, &walls, &at, &points) else { return };
        assert_eq!((names.len(), rows.len()), (17, at.len()));
        assert_eq!(wrong(&names, &rows, &graph, &points), [""; 0], "seed {seed}");
        n_points += at.len();
        n_longer += rows.iter().filter(|row| row[14] > row[16] + 1e-9).count();
        // Impostor: the graph without one pair has other values in every column of local measures and of depths.
        let mut other = matrix.clone();
        let (i, j) = (0..at.len()).flat_map(|i| (0..i).map(move |j| (i, j))).find(|&(i, j)| matrix.0[i][j]).unwrap();
        (other.0[i][j], other.0[j][i]) = (false, false);
        let found = wrong(&names, &rows, &other.graph(&WorkOptions::default()).unwrap(), &points);
        assert!(found.len() >= 10, "{found:?}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(n_points > 200, "{n_points}");
    eprintln!("{n_points} points; at {n_longer} paths that turn near walls only are longer");
}
