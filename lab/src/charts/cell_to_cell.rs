//! Which cells see which: in the plane, among boxes, through convex portals; exact methods and those that came before.

use super::older::{
    Opening, PortalGraph, axial_portal_graph, connected, convex_portal_graph, planar_portal_graph, sampled,
    shadow_volumes,
};
use super::panels::time_against_over;
use super::row::Row;
use super::slow_stabbers::{ByProgram, Limited};
use super::{ChartError, Family, Settings};
use sightlines::bake::{PortalMode, SceneBakeOptions, bake_scene};
use sightlines::cells::{Axial, CellGraph, Plan, Planar, Scene};
use sightlines::formats::Wad;
use sightlines::formats::doom::{DoomMap, list_maps};
use sightlines::formats::scene::read_scene;
use sightlines::geometry::{Adaptive, AxialDoor, Portal2};
use sightlines::kdtree::{SceneOptions, subdivide_scene};
use sightlines::pvs::BitMatrix;
use sightlines::scenes::{OfficeOptions, doom_like, maze, office};
use sightlines::sightline::{AxialStabber, Funnel, Stabber};
use sightlines::stabtree::{Network, SearchOptions, Zones, axial_visibility, planar_visibility, visible_zones};
use sightlines_benches::chart::Panel;
use sightlines_benches::quake::MapSpec;
use sightlines_benches::quake::job::{self, ClusterMethod};
use sightlines_benches::spec::SceneSpec;
use std::path::Path;
use std::time::Duration;

const NAME: &str = "cell_to_cell";
/// Rays from each cell.
const RAYS: [u64; 4] = [100, 1_000, 10_000, 100_000];
/// Most rays of all cells together.
const MOST_RAYS: [u64; 2] = [1_500_000, 6_000_000];
/// Seconds that a method may work before it is given up.
const LIMIT: [f64; 2] = [4.0, 10.0];

/// Time against over-estimation of cell-to-cell visibility.
#[derive(Debug, Clone, Copy)]
pub struct CellToCell;

impl Family for CellToCell {
    fn name(&self) -> &'static str {
        NAME
    }

    fn title(&self) -> &'static str {
        "Cell to cell: time against over-estimation"
    }

    fn about(&self) -> &'static str {
        "Which cells of a scene see which. Up: ordered pairs of different cells that a method calls visible, over those that \
         are (1 is exact). To the right: milliseconds on one thread, scene and cells already there. What is true is said by our exact search; among \
         convex portals, pairs that it has a line for.\n\
         In the plane: the linear program of the literature, asked anew for each sequence; our funnel in the same search; and \
         the funnel as shipped, after chords have shown what is easily seen. Among boxes: sequences by linear program and by \
         our stabber, where they end in time, and pairs of boxes with the walls between them, as shipped, with exact portals and with the \
         rectangles around them. Through convex portals: the first pass of our search, its lines alone, the classical walk with separating planes as other \
         programs do it, and the exact search.\n\
         What came before: culling by view volumes in a quadtree or octree hides nothing from a whole cell that can be reached from it; \
         shadow volumes of portals ask each portal against the source and the one before it, and clip nothing; random rays find \
         only what they happen to meet."
    }

    fn measure(&self, settings: &Settings) -> Result<Vec<Row>, ChartError> {
        let mut rows = Vec::new();
        for (name, plan) in plans(settings)? {
            in_the_plane(settings, &name, &plan, &mut rows)?;
        }
        for (name, scene, with_sequences) in scenes(settings)? {
            among_boxes(settings, &name, &scene, with_sequences, &mut rows)?;
        }
        for spec in worlds(settings) {
            through_polygons(settings, &spec, &mut rows)?;
        }
        Ok(rows)
    }

    fn panels(&self, rows: &[Row]) -> Vec<Panel> {
        time_against_over(rows, "time, ms", "pairs called visible / pairs visible")
    }
}

fn failed(scene: &str) -> impl Fn(Box<dyn std::error::Error + Send + Sync>) -> ChartError + '_ {
    move |source| ChartError::measure(NAME, scene, source)
}

/// The first map of a file.
fn doom_plan(path: &Path) -> Result<Plan, Box<dyn std::error::Error + Send + Sync>> {
    let wad = Wad::read(path)?;
    let lumps = list_maps(&wad).into_iter().next().ok_or("a WAD without maps")?;
    Ok(DoomMap::parse(&wad, &lumps)?.plan()?)
}

fn plans(settings: &Settings) -> Result<Vec<(String, Plan)>, ChartError> {
    let (rooms, paths, size) = settings.pick((3, 10, 4), (8, 32, 10));
    let made = [
        (
            format!("office {rooms} x {rooms}"),
            office(OfficeOptions { rooms_x: rooms, rooms_y: rooms, ..OfficeOptions::default() }),
        ),
        (format!("maze {paths} x {paths}"), maze(1, paths, paths)),
        (format!("doom-like {size}"), doom_like(1, size)),
    ];
    let mut plans = Vec::new();
    // Real maps take the place of generated ones.
    let n_made = if settings.data.is_some() { 2 } else { 3 };
    for (name, plan) in made.into_iter().take(n_made) {
        plans.push((name.clone(), plan.map_err(|e| failed(&name)(e.into()))?));
    }
    if let Some(data) = &settings.data {
        for name in ["freedoom1_E1M1", "freedm_MAP05"] {
            let plan = doom_plan(&data.join("doom").join(name).with_extension("wad")).map_err(failed(name))?;
            plans.push((name.to_owned(), plan));
        }
    }
    Ok(plans)
}

/// Scenes in space, and whether sequences may be searched: of larger ones there are more than can be counted.
fn scenes(settings: &Settings) -> Result<Vec<(String, Scene, bool)>, ChartError> {
    let specs: &[(&str, bool)] = settings.pick(
        &[("tower:1:1:1:0", true), ("tower:1:3:2:1", false)],
        &[("tower:1:2:1:0", true), ("tower:2:6:4:2", false)],
    );
    let mut scenes = Vec::new();
    for &(name, with_sequences) in specs {
        let scene = name.parse::<SceneSpec>().and_then(|spec| spec.load()).map_err(|e| failed(name)(e.into()))?;
        scenes.push((name.to_owned(), scene, with_sequences));
    }
    if let Some(data) = &settings.data {
        for name in ["whale_large", "duplex"] {
            let path = data.join("scenes").join(name).join(format!("{name}.glb"));
            let scene = read_scene(path).map_err(|e| failed(name)(e.into()))?.scene;
            scenes.push((name.to_owned(), scene, false));
        }
    }
    Ok(scenes)
}

fn worlds(settings: &Settings) -> Vec<MapSpec> {
    let names: &[&str] = settings.pick(&["world:1:2:2:1", "world:1:3:2:2"], &["world:1:3:3:2", "world:1:6:6:3"]);
    let generated = names.iter().map(|name| name.parse().expect("worlds have four numbers"));
    let real = settings
        .data
        .iter()
        .flat_map(|data| ["dm3", "e1m1"].map(|map| MapSpec::File(data.join("quake").join(map).with_extension("prt"))));
    generated.chain(real).collect()
}

/// Ordered pairs of different cells.
fn n_pairs(matrix: &BitMatrix) -> u64 {
    let n = (0..matrix.n_rows()).filter(|&i| matrix.get(i, i)).count();
    matrix.count_ones() - n as u64
}

fn n_missing(truth: &BitMatrix, answer: &BitMatrix) -> u64 {
    let words = (0..truth.n_rows()).flat_map(|i| truth.row(i).iter().zip(answer.row(i)));
    words.map(|(t, a)| u64::from((t & !a).count_ones())).sum()
}

/// A scene whose truth is known.
struct Case<'a> {
    settings: &'a Settings,
    name: &'a str,
    truth: BitMatrix,
    truth_by: &'a str,
    rows: &'a mut Vec<Row>,
}

impl Case<'_> {
    fn empty(&self, method: &str) -> Row {
        Row {
            size: self.truth.n_rows() as u64,
            size_of: "cells".to_owned(),
            ..self.settings.row(NAME, method, self.name)
        }
    }

    fn add(&mut self, method: &str, answer: &BitMatrix, seconds: f64, repeats: u32, note: &str) {
        let row = Row {
            repeats,
            seconds: Some(seconds),
            reported: Some(n_pairs(answer)),
            truth: Some(n_pairs(&self.truth)),
            truth_by: self.truth_by.to_owned(),
            missed: Some(n_missing(&self.truth, answer)),
            note: note.to_owned(),
            ..self.empty(method)
        };
        self.rows.push(row);
    }

    fn give_up(&mut self, method: &str, limit: f64) {
        let row = Row { note: format!("not done in {limit} s"), ..self.empty(method) };
        self.rows.push(row);
    }

    /// Runs a search that may have to be given up.
    fn add_limited<S: Stabber>(&mut self, method: &str, network: &Network<S::Portal, S::Bounds>, stabber: &S)
    where
        S::Portal: Sync,
        S::Bounds: Sync,
    {
        let limit = self.settings.pick(LIMIT[0], LIMIT[1]);
        let ((answer, is_over), seconds, repeats) = self.settings.best_of(|| {
            let limited = Limited::new(stabber.clone(), Duration::from_secs_f64(limit));
            let known = BitMatrix::identity(network.n_zones());
            let seen = visible_zones(network, &limited, &known, &one_thread()).expect("nobody cancels");
            (seen.zones, limited.is_over())
        });
        if is_over {
            self.give_up(method, limit);
        } else {
            self.add(method, &answer, seconds, repeats, "");
        }
    }

    /// What came before.
    fn add_older<O: Opening>(&mut self, graph: &PortalGraph<O>, tree: &str) {
        let (all, seconds, repeats) = self.settings.best_of(|| connected(graph));
        self.add(&format!("view volumes ({tree})"), &all, seconds, repeats, "");
        let limit = self.settings.pick(LIMIT[0], LIMIT[1]);
        let limited = || shadow_volumes(graph, Duration::from_secs_f64(limit));
        let (lit, seconds, repeats) = self.settings.best_of(limited);
        match lit {
            Some(lit) => self.add("shadow volumes", &lit, seconds, repeats, ""),
            None => self.give_up("shadow volumes", limit),
        }
        let most = self.settings.pick(MOST_RAYS[0], MOST_RAYS[1]);
        for n_rays in RAYS.into_iter().filter(|n| n * graph.n_cells() as u64 <= most) {
            let (found, seconds, repeats) = self.settings.best_of(|| sampled(graph, n_rays, 1));
            self.add(&format!("random rays: {n_rays} a cell"), &found, seconds, repeats, "");
        }
    }
}

/// Long runs say how far they are.
fn say(settings: &Settings, scene: &str) {
    if !settings.quick {
        eprintln!("{NAME}: {scene}");
    }
}

fn one_thread() -> SearchOptions<'static> {
    SearchOptions { threads: 1, ..SearchOptions::default() }
}

fn in_the_plane(settings: &Settings, name: &str, plan: &Plan, rows: &mut Vec<Row>) -> Result<(), ChartError> {
    say(settings, name);
    let graph: CellGraph<Planar> = sightlines::triangulation::subdivide(plan).map_err(|e| failed(name)(e.into()))?.0;
    let zones = Zones::cells(&graph);
    let (truth, seconds, repeats) =
        settings.best_of(|| planar_visibility(&graph, &zones, &one_thread()).expect("nobody cancels").0);
    let mut case = Case { settings, name, truth: truth.clone(), truth_by: "funnel", rows };
    case.add("funnel after chords (shipped)", &truth, seconds, repeats, "");
    let network: Network<Portal2, _> = Network::planar(&graph, &zones);
    case.add_limited("funnel", &network, &Funnel::new(Adaptive));
    case.add_limited("linear program", &network, &ByProgram::<Portal2>::new());
    case.add_older(&planar_portal_graph(&graph), "quadtree");
    Ok(())
}

fn among_boxes(
    settings: &Settings,
    name: &str,
    scene: &Scene,
    with_sequences: bool,
    rows: &mut Vec<Row>,
) -> Result<(), ChartError> {
    say(settings, name);
    let cut = subdivide_scene(scene, &SceneOptions::default()).map_err(|e| failed(name)(e.into()))?;
    let (graph, solid) = (&cut.graph, cut.left_out());
    let see = |graph: &CellGraph<Axial>| {
        settings.best_of(|| axial_visibility(graph, &solid, &[], &[], &one_thread()).expect("nobody cancels"))
    };
    let (seen, seconds, repeats) = see(graph);
    let options = SceneBakeOptions { portals: PortalMode::Bounding, ..SceneBakeOptions::default() };
    let loose = bake_scene(scene, &options).map_err(|e| failed(name)(e.into()))?.graph;
    let (wide, wide_seconds, wide_repeats) = see(&loose);
    // Larger portals let all lines through that exact ones do, so what they hide is hidden: of pairs that the search gave up
    // they decide some.
    let mut truth = seen.cells.clone();
    for row in 0..truth.n_rows() {
        truth.row_mut(row).iter_mut().zip(wide.cells.row(row)).for_each(|(word, wide)| *word &= wide);
    }
    let mut case = Case { settings, name, truth, truth_by: "exact portals and bounding ones", rows };
    let note = format!("{} pairs assumed to be visible", seen.n_assumed);
    case.add("exact portals (shipped)", &seen.cells, seconds, repeats, &note);
    let note = format!("{} pairs assumed to be visible", wide.n_assumed);
    case.add("bounding portals", &wide.cells, wide_seconds, wide_repeats, &note);
    if with_sequences {
        let network: Network<AxialDoor, _> = Network::axial(graph, &Zones::cells(graph), &[]);
        case.add_limited("sequences (axial stabber)", &network, &AxialStabber::new());
        case.add_limited("sequences (linear program)", &network, &ByProgram::<AxialDoor>::new());
    }
    case.add_older(&axial_portal_graph(graph), "octree");
    Ok(())
}

fn through_polygons(settings: &Settings, spec: &MapSpec, rows: &mut Vec<Row>) -> Result<(), ChartError> {
    let name = spec.name();
    say(settings, &name);
    let graph = spec.graph().map_err(|e| failed(&name)(e.into()))?;
    let limit = settings.pick(30.0, 150.0);
    let run = |method: ClusterMethod| settings.best_of(|| job::measure(&graph, method, 1, limit));
    let ((measured, exact), seconds, repeats) = run(ClusterMethod::Exact);
    if measured.done < 1.0 {
        return Err(failed(&name)(format!("the exact search does not end in {limit} s").into()));
    }
    let (truth, note) = (exact.proven(), format!("{} pairs undecided", 2 * exact.undecided.len()));
    let mut case = Case { settings, name: &name, truth, truth_by: "exact search (a line for each pair)", rows };
    case.add("exact (shipped)", &exact.table, seconds, repeats, &note);
    let others = [
        (ClusterMethod::Base, "first pass of the exact search"),
        (ClusterMethod::Sampling, "lines of the exact search"),
        (ClusterMethod::Separators, "separating planes"),
    ];
    for (method, title) in others {
        let ((measured, answer), seconds, repeats) = run(method);
        if measured.done < 1.0 {
            case.give_up(title, limit);
        } else {
            case.add(title, &answer.table, seconds, repeats, "");
        }
    }
    case.add_older(&convex_portal_graph(&graph), "octree");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings() -> Settings {
        Settings { quick: true, data: None, machine: "test".into(), commit: "test".into() }
    }

    /// One number of a method on a small scene: what it reports, and what it misses.
    fn of(rows: &[Row], method: &str) -> [u64; 2] {
        let row = rows.iter().find(|r| r.method.starts_with(method)).unwrap_or_else(|| panic!("{method}"));
        [row.reported.unwrap(), row.missed.unwrap()]
    }

    #[test]
    fn methods_of_the_plane_are_in_order() {
        let mut rows = Vec::new();
        in_the_plane(&settings(), "maze", &maze(3, 8, 8).unwrap(), &mut rows).unwrap();
        let truth = rows[0].truth.unwrap();
        assert!(truth > 50, "{truth} pairs");
        assert!(of(&rows, "funnel after") == [truth, 0] && of(&rows, "funnel") == [truth, 0]);
        let [program, missed] = of(&rows, "linear program");
        assert_eq!(program + missed, truth, "the program finds nothing that is not there");
        let [shadows, view] = ["shadow", "view"].map(|m| of(&rows, m));
        assert!(shadows[0] < view[0] && shadows[1] == 0 && view[1] == 0 && truth <= shadows[0], "{shadows:?} {view:?}");
        let [rays, missed] = of(&rows, "random rays: 100 a");
        assert!(rays + missed == truth && missed > 0, "rays miss something: {missed}");
    }

    #[test]
    fn what_takes_too_long_is_given_up() {
        let graph = sightlines::triangulation::subdivide(&maze(1, 6, 6).unwrap()).unwrap().0;
        let network: Network<Portal2, _> = Network::planar(&graph, &Zones::cells(&graph));
        let stabber = Limited::new(Funnel::new(Adaptive), Duration::ZERO);
        visible_zones(&network, &stabber, &BitMatrix::identity(network.n_zones()), &one_thread())
            .expect("nobody cancels");
        assert!(stabber.is_over());
        let patient = Limited::new(Funnel::new(Adaptive), Duration::from_secs(3600));
        visible_zones(&network, &patient, &BitMatrix::identity(network.n_zones()), &one_thread())
            .expect("nobody cancels");
        assert!(!patient.is_over());
    }
}
