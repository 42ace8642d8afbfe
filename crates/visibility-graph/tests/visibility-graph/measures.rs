//! Measures against full matrices.

use crate::dense::{At, Matrix, Walls, distance, global, is_near, point, walls};
use proptest::prelude::*;
use sightlines_visibility_graph::{
    AngularMeasures, GlobalMeasures, LocalMeasures, MetricMeasures, PixelGrid, Points, Turns, UNDEFINED,
    VisibilityGraph, WorkOptions,
};

/// Points with distinct places, and walls.
fn scattered() -> impl Strategy<Value = (Walls, Vec<At>)> {
    let points = prop::collection::vec([1i64..400, 1i64..400], 2..40);
    (walls(400, 7, 0..12), points).prop_map(|(walls, mut points)| {
        points.sort_unstable();
        points.dedup();
        (walls, points)
    })
}

/// The pixels of a grid of spacing 2, of which walls lie on whole numbers.
fn gridded() -> impl Strategy<Value = (Walls, Vec<At>, Points)> {
    walls(20, 1, 0..8).prop_filter_map("something is enclosed", |walls| {
        let points = PixelGrid::over(&walls.plan(), 2.0).ok()?.enclosed().ok()?;
        let at = points.coordinates().iter().map(|p| [p.x as i64, p.y as i64]).collect();
        Some((walls, at, points))
    })
}

fn of(at: &[At]) -> Points {
    Points::new(at.iter().map(|&p| point(p))).unwrap()
}

/// How local measures differ from their definitions.
fn differences(graph: &VisibilityGraph, matrix: &Matrix, at: &[At], points: &Points) -> usize {
    let found = LocalMeasures::of(graph, points, &WorkOptions::default()).unwrap();
    let of_point = |i: usize| {
        let [k, clustering, control, controllability] = matrix.local(i);
        let seen = || (0..at.len()).filter(|&j| matrix.0[i][j]);
        let first: f64 = seen().map(|j| distance(at[i], at[j])).sum();
        let second: i64 = seen().map(|j| (0..2).map(|k| (at[i][k] - at[j][k]).pow(2)).sum::<i64>()).sum();
        let pairs = [
            (f64::from(found.connectivity[i]), k),
            (found.first_moment[i], first),
            (found.second_moment[i], second as f64),
            (found.clustering[i], clustering),
            (found.control[i], control),
            (found.controllability[i], controllability),
        ];
        pairs.into_iter().filter(|&(a, b)| !is_near(a, b)).count()
    };
    (0..at.len()).map(of_point).sum()
}

/// How global measures differ from those of Floyd's and Warshall's depths.
fn global_differences(graph: &VisibilityGraph, matrix: &Matrix, radius: Option<u32>) -> usize {
    let found = GlobalMeasures::of(graph, radius, &WorkOptions::default()).unwrap();
    let depths = matrix.depths();
    let of_point = |i: usize| {
        let expected = global(&depths[i], radius);
        let row = [
            f64::from(found.node_count[i]),
            found.mean_depth[i],
            found.integration_hh[i],
            found.integration_tekl[i],
            found.integration_p[i],
            found.entropy[i],
            found.relativised_entropy[i],
        ];
        row.into_iter().zip(expected).filter(|&(a, b)| !is_near(a, b)).count()
    };
    (0..matrix.n()).map(of_point).sum()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]

    #[test]
    fn local_measures_are_those_of_the_matrix((walls, at, points) in gridded()) {
        let matrix = Matrix::of(&walls, &at);
        let graph = matrix.graph(&WorkOptions::default()).unwrap();
        prop_assert_eq!(graph.first_one_sided(), None);
        prop_assert_eq!(differences(&graph, &matrix, &at, &points), 0);
    }

    #[test]
    fn global_measures_are_those_of_the_matrix((walls, at) in scattered(), radius in prop::option::of(0u32..4)) {
        let matrix = Matrix::of(&walls, &at);
        let graph = matrix.graph(&WorkOptions::default()).unwrap();
        prop_assert_eq!(global_differences(&graph, &matrix, radius), 0);
    }

    #[test]
    fn paths_are_as_long_as_those_of_the_matrix((walls, at, points) in gridded()) {
        let matrix = Matrix::of(&walls, &at);
        let graph = matrix.graph(&WorkOptions::default()).unwrap();
        for turns in [Turns::Anywhere, Turns::NearWalls] {
            let found = MetricMeasures::of(&graph, &points, turns, None, &WorkOptions::default()).unwrap();
            let lengths = matrix.lengths(&at, |k| turns == Turns::Anywhere || points.is_near_wall(k as u32));
            for (i, row) in lengths.iter().enumerate() {
                let reached: Vec<usize> = (0..at.len()).filter(|&j| row[j].is_finite()).collect();
                let mean = |of: &dyn Fn(usize) -> f64| {
                    reached.iter().map(|&j| of(j)).sum::<f64>() / reached.len() as f64
                };
                prop_assert_eq!(found.node_count[i] as usize, reached.len());
                prop_assert!(is_near(found.mean_path_length[i], mean(&|j| row[j])), "{}", i);
                prop_assert!(is_near(found.mean_straight_distance[i], mean(&|j| distance(at[i], at[j]))), "{}", i);
            }
        }
    }

    /// The depth is 0 for what is seen, and never less than the least sum of turns.
    #[test]
    fn angles_are_between_bounds((walls, at) in scattered()) {
        let (matrix, points) = (Matrix::of(&walls, &at), of(&at));
        let graph = matrix.graph(&WorkOptions::default()).unwrap();
        let depths = |radius: f64| {
            AngularMeasures::of(&graph, &points, Turns::Anywhere, Some(radius), &WorkOptions::default()).unwrap()
        };
        let (all, direct) = (depths(f64::INFINITY), depths(0.0));
        for i in 0..at.len().min(3) {
            let least = least_turns(&matrix, &at, i);
            let reached = least.iter().filter(|least| least.is_finite()).count();
            prop_assert_eq!(all.node_count[i] as usize, reached);
            let sum: f64 = least.iter().filter(|least| least.is_finite()).sum();
            prop_assert!(all.total_depth[i] >= sum - 1e-9, "{} < {}", all.total_depth[i], sum);
            prop_assert!(is_near(all.mean_depth[i], all.total_depth[i] / reached as f64));
            let seen = matrix.0[i].iter().filter(|&&sees| sees).count();
            prop_assert_eq!(direct.node_count[i] as usize, seen + 1);
        }
    }

    /// Depths are those of the same steps in full matrices, where no two paths are alike.
    #[test]
    fn angles_and_turns_are_those_of_the_matrix((walls, at) in scattered(), from in any::<prop::sample::Index>()) {
        let (matrix, points) = (Matrix::of(&walls, &at), of(&at));
        let graph = matrix.graph(&WorkOptions::default()).unwrap();
        let i = from.index(at.len());
        let (angles, _) = settled(&matrix, &at, i, false);
        let (lengths, turns) = settled(&matrix, &at, i, true);
        let angular = AngularMeasures::of(&graph, &points, Turns::NearWalls, None, &WorkOptions::default()).unwrap();
        let metric = MetricMeasures::of(&graph, &points, Turns::NearWalls, None, &WorkOptions::default()).unwrap();
        let n = f64::from(angular.node_count[i]);
        prop_assert!(is_near(angular.total_depth[i], angles.iter().sum()));
        prop_assert!(is_near(metric.mean_path_length[i], lengths.iter().sum::<f64>() / n));
        prop_assert!(is_near(metric.mean_path_angle[i], turns.iter().sum::<f64>() / n));
    }
}

/// Costs (lengths or turns) and sums of turns of all points that are reached, by Dijkstra's algorithm on the matrix without a queue.
fn settled(matrix: &Matrix, at: &[At], from: usize, by_length: bool) -> (Vec<f64>, Vec<f64>) {
    let n = at.len();
    let (mut cost, mut turns, mut before) = (vec![f64::INFINITY; n], vec![0.0; n], vec![None; n]);
    let mut open: Vec<usize> = (0..n).collect();
    let mut all = (Vec::new(), Vec::new());
    cost[from] = 0.0;
    while let Some(&here) = open.iter().min_by(|&&a, &&b| cost[a].total_cmp(&cost[b]).then(a.cmp(&b))) {
        if cost[here].is_infinite() {
            break;
        }
        open.retain(|&other| other != here);
        all.0.push(cost[here]);
        all.1.push(turns[here]);
        for &next in open.iter().filter(|&&next| matrix.0[here][next]) {
            let turned = before[here].map_or(0.0, |a| turn(at, a, here, next));
            let reached = cost[here] + if by_length { distance(at[here], at[next]) } else { turned };
            if reached < cost[next] {
                (cost[next], turns[next], before[next]) = (reached, turns[here] + turned, Some(here));
            }
        }
    }
    all
}

fn turn(at: &[At], a: usize, b: usize, c: usize) -> f64 {
    let [u, v] = [(a, b), (b, c)].map(|(p, q)| [(at[q][0] - at[p][0]) as f64, (at[q][1] - at[p][1]) as f64]);
    (u[0] * v[1] - u[1] * v[0]).abs().atan2(u[0] * v[0] + u[1] * v[1]) / std::f64::consts::FRAC_PI_2
}

/// The least sums of turns from a point, over all ways to come to each: Bellman and Ford on pairs of points.
fn least_turns(matrix: &Matrix, at: &[At], from: usize) -> Vec<f64> {
    let n = at.len();
    let mut cost = vec![vec![f64::INFINITY; n]; n];
    (0..n).filter(|&j| matrix.0[from][j]).for_each(|j| cost[from][j] = 0.0);
    loop {
        let mut is_done = true;
        for (a, b) in (0..n).flat_map(|a| (0..n).map(move |b| (a, b))) {
            if cost[a][b].is_finite() {
                for c in (0..n).filter(|&c| matrix.0[b][c]) {
                    let sum = cost[a][b] + turn(at, a, b, c);
                    if sum < cost[b][c] - 1e-12 {
                        cost[b][c] = sum;
                        is_done = false;
                    }
                }
            }
        }
        if is_done {
            let least = |j: usize| (0..n).map(|a| cost[a][j]).fold(f64::INFINITY, f64::min);
            return (0..n).map(|j| if j == from { 0.0 } else { least(j) }).collect();
        }
    }
}

/// A room with a wall in it.
fn room() -> (Walls, Vec<At>) {
    let walls = Walls(vec![
        [[0, 0], [40, 0]],
        [[40, 0], [40, 40]],
        [[40, 40], [0, 40]],
        [[0, 40], [0, 0]],
        [[20, 0], [20, 25]],
        [[8, 30], [30, 33]],
    ]);
    let at = (1..9).flat_map(|x| (1..9).map(move |y| [4 * x + 1, 4 * y + 1])).collect();
    (walls, at)
}

/// Impostors: a pair that is missing, and a pair too many, change local and global measures.
#[test]
fn wrong_rows_are_noticed() {
    let (walls, at) = room();
    let matrix = Matrix::of(&walls, &at);
    let right = matrix.graph(&WorkOptions::default()).unwrap();
    let points = of(&at);
    let all =
        |graph: &VisibilityGraph| [differences(graph, &matrix, &at, &points), global_differences(graph, &matrix, None)];
    assert_eq!(all(&right), [0, 0]);
    for (i, j) in [(0, 1), (3, 60), (10, 50), (0, 63), (20, 21)] {
        let mut wrong = matrix.clone();
        wrong.0[i][j] = !wrong.0[i][j];
        let graph = wrong.graph(&WorkOptions::default()).unwrap();
        assert_eq!(graph.first_one_sided().map(|(a, b)| (a.min(b), a.max(b))), Some((i as u32, j as u32)));
        wrong.0[j][i] = wrong.0[i][j];
        let graph = wrong.graph(&WorkOptions::default()).unwrap();
        assert_eq!(graph.first_one_sided(), None);
        assert!(all(&graph).iter().all(|&n| n > 2), "{i} and {j}: {:?}", all(&graph));
    }
}

/// Straight corridors have values that can be written down.
#[test]
fn small_graphs_have_known_values() {
    let path = |n: usize| {
        let rows: Vec<Vec<bool>> = (0..n).map(|i| (0..n).map(|j| i.abs_diff(j) == 1).collect()).collect();
        Matrix(rows).graph(&WorkOptions::default()).unwrap()
    };
    let global = |n: usize| GlobalMeasures::of(&path(n), None, &WorkOptions::default()).unwrap();
    let one = global(1);
    assert_eq!((one.node_count[0], one.total_depth[0]), (1, 0));
    assert_eq!([one.mean_depth[0], one.entropy[0], one.integration_hh[0]], [UNDEFINED; 3]);
    let two = global(2);
    assert_eq!((two.mean_depth[0], two.entropy[0], two.integration_hh[0]), (1.0, 0.0, UNDEFINED));
    // q is exp(-1) / 2!.
    assert!(is_near(two.relativised_entropy[0], 1.0 + std::f64::consts::LOG2_E));
    let three = global(3);
    assert_eq!((three.mean_depth[0], three.mean_depth[1]), (1.5, 1.0));
    assert_eq!([three.integration_hh[1], three.integration_tekl[0], three.entropy[0]], [UNDEFINED, UNDEFINED, 1.0]);
    // From the end of four: depths 1, 2, 3. RA = 2 (2 - 1) / 2 = 1, D(4) = 2 (4 (log2 2 - 1) + 1) / 6.
    let four = global(4);
    assert!(is_near(four.integration_hh[0], 1.0 / 3.0) && is_near(four.integration_p[0], 1.0 / 3.0));
    assert_eq!([four.integration_tekl[0], four.mean_depth[0]], [0.0, 2.0]);

    let points = Points::new((0..3).map(|k| point([3 * k, 0]))).unwrap();
    let local = LocalMeasures::of(&path(3), &points, &WorkOptions::default()).unwrap();
    assert_eq!(local.connectivity, [1, 2, 1]);
    assert_eq!((local.first_moment, local.second_moment), (vec![3.0, 6.0, 3.0], vec![9.0, 18.0, 9.0]));
    // The ends see the middle alone: their neighbourhood of one has no pairs. Around the middle nobody sees anybody else.
    assert_eq!(local.clustering, [UNDEFINED, 0.0, UNDEFINED]);
    assert_eq!((local.control[1], local.controllability[1]), (2.0, 2.0));
    let turns = MetricMeasures::of(&path(3), &points, Turns::NearWalls, Some(3.0), &WorkOptions::default()).unwrap();
    assert_eq!((turns.node_count, turns.mean_path_length[0]), (vec![2, 3, 2], 1.5));
}

/// A corner of a right angle: paths around it turn by it.
#[test]
fn turns_are_in_right_angles() {
    let rows = vec![vec![false, true, false], vec![true, false, true], vec![false, true, false]];
    let graph = Matrix(rows).graph(&WorkOptions::default()).unwrap();
    for (last, angle) in [([4, 4], 1.0), ([8, 0], 0.0), ([8, 4], 0.5), ([1, 0], 2.0), ([0, 4], 1.5)] {
        let points = of(&[[0, 0], [4, 0], last]);
        let metric = MetricMeasures::of(&graph, &points, Turns::NearWalls, None, &WorkOptions::default()).unwrap();
        let angular = AngularMeasures::of(&graph, &points, Turns::NearWalls, None, &WorkOptions::default()).unwrap();
        assert_eq!((metric.mean_path_angle[0], angular.total_depth[0]), (angle / 3.0, angle), "{last:?}");
        assert_eq!((angular.mean_depth[0], angular.node_count[0]), (angle / 3.0, 3));
    }
}
