//! Choosing methods by the properties of an input: for a scene, no more than it needs.
//!
//! Nothing here decides what is hidden; a bad choice costs time, or hides less than another one would.

use crate::eye_level::EyeLevelOptions;
use crate::input::BakeInput;
use crate::methods::OcclusionMethod;
use crate::options::{Recipe, SceneMethod};
use crate::places::PlaceOptions;
use crate::region::CellsFrom;
use sightlines_cells::Scene;
use sightlines_geometry::vector::{length, normal};
use sightlines_geometry::{Aabb, Point3, Random};
use sightlines_multifocal::mesh::Mesh;
use sightlines_multifocal::{Layout, RaySampler};
use sightlines_packed::format::MAX_SMALL_CELLS;
use sightlines_progress::{Observer, Progress};
use std::fmt;

/// Properties of what hides in a scene in space. Shares are of the area of all its triangles, unless stated otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneFacts {
    /// Triangles.
    pub n_triangles: usize,
    /// Objects.
    pub n_objects: usize,
    /// The share of triangles perpendicular to an axis, which are walls to sightlines.
    pub axial: f64,
    /// The share of flat pieces that stand alone, such as screens and signs: surfaces that are connected to nothing in another plane.
    /// Measured only where it matters, as it takes longer.
    pub loose: Option<f64>,
    /// The share of rays from anywhere in the scene's box that leave it without meeting anything: 0 for rooms, nearly 1 for a plain.
    /// Measured only where it matters.
    pub openness: Option<f64>,
    /// The longest side of the object in the middle, by that side, as a share of the scene's longest side.
    pub object_size: f64,
}

/// Number of rays that measure how open a scene is: the share is within 0.02 of the truth in 98 scenes of 100.
const N_RAYS: u32 = 4096;

impl SceneFacts {
    /// Measures what is quickly measured: everything but `loose` and `openness`. O(n) of triangles.
    fn quick(scene: &Scene) -> Self {
        let flat = |t: &[Point3; 3]| (0..3).any(|k| t[0][k] == t[1][k] && t[1][k] == t[2][k]);
        let all: Vec<[Point3; 3]> = triangles_of(scene);
        let total: f64 = all.iter().map(area).sum();
        let share = |part: f64| if total > 0.0 { (part / total).min(1.0) } else { 0.0 };
        let longest = |b: &Aabb<3>| (0..3).map(|k| b.max[k] - b.min[k]).fold(0.0, f64::max);
        let mut sizes: Vec<f64> = scene.occluders().chain(scene.fronts()).map(|(_, o)| longest(&o.bounds())).collect();
        sizes.sort_by(f64::total_cmp);
        let (whole, middle) = (longest(&scene.bounds()), sizes.get(sizes.len() / 2).copied().unwrap_or(0.0));
        Self {
            n_triangles: all.len(),
            n_objects: sizes.len(),
            axial: share(all.iter().filter(|t| flat(t)).map(area).fold(0.0, |sum, area| sum + area)),
            loose: None,
            openness: None,
            object_size: if whole > 0.0 { middle / whole } else { 0.0 },
        }
    }

    /// A k-d tree follows walls that are perpendicular to an axis, and no others. Where nothing hides, one cell is enough.
    fn own_cells(&self) -> CellsFrom {
        if self.axial >= AXIAL || self.n_triangles == 0 {
            CellsFrom::KdTree
        } else {
            CellsFrom::EyeLevel(EyeLevelOptions::default())
        }
    }
}

/// The cells of a scene for which none are named: those of a k-d tree where nearly all walls are perpendicular to an axis, else cells at the height of
/// [eyes](crate::eye_level), or [`places`](crate::places) where viewers may fly. O(n log n) of objects, O(n) of triangles.
///
/// * `flying`: whether viewers may be anywhere, as in a region that is stated for them, or where nobody says what is up
pub fn own_cells(scene: &Scene, flying: bool) -> CellsFrom {
    match SceneFacts::quick(scene).own_cells() {
        CellsFrom::EyeLevel(_) if flying => CellsFrom::Places(PlaceOptions::default()),
        cells => cells,
    }
}

/// All that hide, if only from one side.
fn triangles_of(scene: &Scene) -> Vec<[Point3; 3]> {
    scene.occluding_triangles().chain(scene.front_occluding_triangles()).collect()
}

fn area(t: &[Point3; 3]) -> f64 {
    length(normal(*t)) / 2.0
}

/// Triangles between two reports.
const STEP: usize = 1 << 12;

/// Tells an observer how far a measurement is; it cannot cancel.
fn tell(progress: Option<&dyn Observer>, phase: &'static str, done: usize, total: usize) {
    if let Some(observer) = progress {
        let _ = observer.report(Progress::new(phase, done as u64, total as u64));
    }
}

/// The share of the area in connected surfaces that lie in one plane.
fn loose_share(triangles: &[[Point3; 3]], progress: Option<&dyn Observer>) -> f64 {
    let total: f64 = triangles.iter().map(area).sum();
    let mesh = Mesh::weld(triangles);
    let n = mesh.triangles().len();
    let mut loose = 0.0;
    let mut done = vec![false; n];
    for first in 0..n as u32 {
        if (first as usize).is_multiple_of(STEP) {
            tell(progress, "loose surfaces", first as usize, n);
        }
        let (mut stack, mut flat, mut here) = (vec![first], true, 0.0);
        let plane = mesh.corners(first);
        while let Some(t) = stack.pop() {
            if std::mem::replace(&mut done[t as usize], true) {
                continue;
            }
            let corners = mesh.corners(t);
            let [a, b, c] = plane;
            flat = flat && corners.iter().all(|&p| sightlines_geometry::orient3d(a, b, c, p) == 0.0);
            here += area(&corners);
            let near = mesh.outline_edges(t).iter().flat_map(|&edge| mesh.triangles_at(edge));
            stack.extend(near.filter(|&&other| !done[other as usize]));
        }
        if flat {
            loose += here;
        }
    }
    if total > 0.0 { (loose / total).min(1.0) } else { 0.0 }
}

fn openness(scene: &Scene) -> f64 {
    let witness = RaySampler::of(triangles_of(scene));
    let mut random = Random::new(0);
    let bounds = scene.bounds();
    let leaves = |_: &u32| {
        let (origin, way) = (random.point(&bounds), random.direction());
        witness.first_hit(origin, way).is_none()
    };
    (0..N_RAYS).filter(leaves).count() as f64 / f64::from(N_RAYS)
}

/// Share of axial walls from which sight lines alone are used: the few slanted walls then hide little that the others
/// do not.
const AXIAL: f64 = 0.9;

/// The share of loose pieces from which buffers are used in the open: they fuse pieces that do not touch, which sheets cannot.
const LOOSE: f64 = 0.5;

/// The openness below which a scene counts as rooms, whose walls are connected.
const ROOMS: f64 = 0.1;

/// Up to this product of given cells and triangles, line space is used as well, whatever the direction of the walls: about a second of work.
const QUICK: u64 = 1 << 16;

/// How to bake a scene. Sightlines, the default, are always used as well, so for the same cells no table is looser than by
/// default.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneChoice {
    /// Whether sheets are used as well: surfaces in any direction.
    pub sheets: bool,
    /// Whether line space is used in place of sheets: it also finds what several surfaces hide only together, and takes longer.
    pub line_space: bool,
    /// Planes of buffers on each side of a cell; 0 for none.
    pub planes: u32,
    /// Texels along the longer side of such a plane.
    pub texels: u32,
    /// Why, a sentence each.
    pub reasons: Vec<String>,
}

/// A fact that a choice depends on, and that is not measured yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Missing {
    Loose,
    Openness,
}

/// Measures a scene as far as that matters, and chooses. The same scene gives the same choice. O(n log n) of triangles.
pub fn choose(scene: &Scene) -> (SceneFacts, SceneChoice) {
    choose_observed(scene, None)
}

/// The same; an observer is told of each measurement, and cannot cancel.
fn choose_observed(scene: &Scene, progress: Option<&dyn Observer>) -> (SceneFacts, SceneChoice) {
    let mut facts = SceneFacts::quick(scene);
    loop {
        match SceneChoice::of(&facts) {
            Ok(choice) => return (facts, choice),
            Err(Missing::Loose) => facts.loose = Some(loose_share(&triangles_of(scene), progress)),
            Err(Missing::Openness) => {
                tell(progress, "openness", 0, 1);
                facts.openness = Some(openness(scene));
            }
        }
    }
}

impl SceneChoice {
    /// Chooses by the properties of the scene.
    fn of(facts: &SceneFacts) -> Result<Self, Missing> {
        let percent = |share: f64| format!("{:.0} %", 100.0 * share);
        let standard = Layout::default();
        let mut choice =
            Self { sheets: false, line_space: false, planes: 0, texels: standard.texels, reasons: Vec::new() };
        if facts.n_triangles == 0 {
            choice.reasons.push("nothing hides".to_owned());
            return Ok(choice);
        }
        if facts.axial >= AXIAL {
            let axial = percent(facts.axial);
            choice.reasons.push(format!("{axial} of the area is perpendicular to an axis: sightlines use these walls"));
            return Ok(choice);
        }
        let slanted = percent(1.0 - facts.axial);
        choice.reasons.push(format!("{slanted} of the area is slanted: sheets use it, besides sightlines"));
        choice.sheets = true;
        let loose = facts.loose.ok_or(Missing::Loose)?;
        if loose < LOOSE {
            choice.reasons.push(format!("{} of the area stands alone: no buffers", percent(loose)));
            return Ok(choice);
        }
        let openness = facts.openness.ok_or(Missing::Openness)?;
        let (loose, open) = (percent(loose), percent(openness));
        if openness < ROOMS {
            choice.reasons.push(format!("{loose} of the area stands alone, {open} of rays leave: no buffers"));
            return Ok(choice);
        }
        choice.planes = standard.planes;
        choice.texels = texels(facts.object_size);
        let texels = choice.texels;
        choice
            .reasons
            .push(format!("{loose} of the area stands alone, {open} of rays leave: buffers put pieces together"));
        choice
            .reasons
            .push(format!("an object in the middle is {} of the scene: {texels} texels", percent(facts.object_size)));
        Ok(choice)
    }

    fn use_line_space(&mut self) {
        (self.sheets, self.line_space) = (false, true);
        self.reasons.push("cells are given: line space finds what surfaces hide only together".to_owned());
    }

    /// Whether a from-region method is used besides sight lines.
    pub fn uses_region_method(&self) -> bool {
        self.sheets || self.line_space || self.planes > 0
    }
}

/// Two texels for an object in the middle, as a power of two from 32 to 256.
fn texels(object_size: f64) -> u32 {
    [32, 64, 128].into_iter().find(|&n| f64::from(n) * object_size >= 2.0).unwrap_or(256)
}

impl fmt::Display for SceneChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("sightlines")?;
        if self.sheets {
            f.write_str(" and sheets")?;
        }
        if self.line_space {
            f.write_str(" and line space")?;
        }
        if self.planes > 0 {
            write!(f, " and buffers of {} planes with {} texels", self.planes, self.texels)?;
        }
        Ok(())
    }
}

/// The choice for an input, and the reasons.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The methods, in words.
    pub method: String,
    /// Why, a sentence each.
    pub reasons: Vec<String>,
    /// The properties of a scene, as far as they were measured; none for other inputs.
    pub facts: Option<SceneFacts>,
}

/// Chooses the method of a scene whose cells are decided, and puts it into the recipe.
///
/// Cells that are given are few, and worth more work: line space takes the place of sheets for them, and is used in small scenes with walls along
/// the axes too, of which it finds what several hide together; also where something hides from its front only, which hides nothing by sheets from
/// cells that reach behind it. Of more cells than a square of bits has room for, line space decides alone. An observer receives a report of each
/// measurement, and cannot cancel.
pub(crate) fn choose_for(scene: &Scene, recipe: &mut Recipe, progress: Option<&dyn Observer>) -> Choice {
    if matches!(recipe.cells, CellsFrom::EyeLevel(_)) {
        recipe.method = SceneMethod::FromRegion(OcclusionMethod::LineSpace);
        let reason = "cells are at the height of eyes: shadows are propagated from cell to cell, and whoever is elsewhere sees everything".to_owned();
        return Choice { method: recipe.method.name().to_owned(), reasons: vec![reason], facts: None };
    }
    // Tables with parts are not written row by row.
    if recipe.parts.is_none() && recipe.cells.most().is_some_and(|n| n > MAX_SMALL_CELLS as u64) {
        recipe.method = SceneMethod::FromRegion(OcclusionMethod::LineSpace);
        let reason =
            format!("there may be more than {MAX_SMALL_CELLS} cells: line space decides about each cell by itself");
        return Choice { method: recipe.method.name().to_owned(), reasons: vec![reason], facts: None };
    }
    let (facts, mut choice) = choose_observed(scene, progress);
    let are_given = matches!(recipe.cells, CellsFrom::Grid(_) | CellsFrom::Boxes(_));
    let n_cells = recipe.cells.most().filter(|_| are_given).unwrap_or(u64::MAX);
    let is_quick = facts.n_triangles > 0 && n_cells.saturating_mul(facts.n_triangles as u64) <= QUICK;
    if is_quick || choice.sheets && (are_given || !scene.front_occluders().is_empty()) {
        choice.use_line_space();
    }
    recipe.method = if choice.uses_region_method() { SceneMethod::Both } else { SceneMethod::Sightlines };
    (recipe.buffers.planes, recipe.buffers.texels) = (choice.planes, choice.texels);
    if !choice.sheets {
        recipe.buffers.sheets = 0;
    }
    recipe.buffers.line_space = choice.line_space;
    Choice { method: choice.to_string(), reasons: choice.reasons, facts: Some(facts) }
}

/// What there is to choose for an input that is no scene: nothing.
pub(crate) fn no_choice(input: &BakeInput<'_>) -> Choice {
    let reason = match input {
        BakeInput::Plan(_) => {
            "a plan is solved in the plane, exactly; its walls' directions and groups say how it is cut"
        }
        _ => "cells and portals are given, convex and in any direction: beams, then sequences",
    };
    Choice { method: "sightlines".to_owned(), reasons: vec![reason.to_owned()], facts: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BakeRequest, Runtime};
    use sightlines_cells::SceneObject;

    fn object(corners: Vec<Point3>, triangles: Vec<[u32; 3]>) -> SceneObject {
        SceneObject { name: String::new(), vertices: corners, triangles }
    }

    /// A box, turned about z by a rotation with rational cosine, or not.
    fn block(min: Point3, max: Point3, turned: bool) -> SceneObject {
        let corner = |i: usize| -> Point3 { std::array::from_fn(|k| if i >> k & 1 == 0 { min[k] } else { max[k] }) };
        let turn = |p: Point3| if turned { [0.8 * p[0] - 0.6 * p[1], 0.6 * p[0] + 0.8 * p[1], p[2]] } else { p };
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        object((0..8).map(|i| turn(corner(i))).collect(), triangles)
    }

    fn facts(objects: Vec<SceneObject>) -> (SceneFacts, f64, f64) {
        let scene = Scene::new(objects).expect("a scene");
        (SceneFacts::quick(&scene), loose_share(&triangles_of(&scene), None), openness(&scene))
    }

    #[test]
    fn facts_are_what_they_say() {
        let (room, loose, openness) =
            facts(vec![block([0.0; 3], [8.0, 6.0, 3.0], false), block([2.0; 3], [3.0; 3], false)]);
        assert_eq!((room.axial, loose, openness), (1.0, 0.0, 0.0));
        assert_eq!((room.n_triangles, room.n_objects, room.object_size), (24, 2, 1.0));
        // The top and bottom of a block that is turned about z stay axial: 2 * 2 of 2 * 2 + 4 * 2 * 5 square units.
        let (turned, loose, _) = facts(vec![block([0.0; 3], [2.0, 1.0, 5.0], true)]);
        assert!((turned.axial - 4.0 / 34.0).abs() < 1e-12 && loose == 0.0, "{turned:?}");
        let screen = |x: f64| {
            object(
                vec![[x, 0.0, 0.0], [x + 1.0, 2.0, 0.0], [x, 0.0, 3.0], [x + 1.0, 2.0, 3.0]],
                vec![[0, 1, 2], [1, 3, 2]],
            )
        };
        let (screens, loose, openness) = facts((0..4).map(|i| screen(f64::from(i))).collect());
        assert!(loose > 0.999 && screens.axial == 0.0, "{screens:?}");
        assert!(openness > 0.2 && openness < 0.9, "{openness}");
    }

    #[test]
    fn choices_follow_the_facts() {
        let room = SceneFacts {
            n_triangles: 1,
            n_objects: 1,
            axial: 0.95,
            loose: Some(0.9),
            openness: Some(0.9),
            object_size: 0.1,
        };
        let choose = |facts: SceneFacts| SceneChoice::of(&facts).expect("all is measured");
        let choice = choose(room);
        assert!(!choice.uses_region_method() && choice.to_string() == "sightlines", "{choice:?}");
        let slanted = choose(SceneFacts { axial: 0.2, loose: Some(0.1), ..room });
        assert_eq!(slanted.to_string(), "sightlines and sheets");
        let screens = choose(SceneFacts { axial: 0.2, ..room });
        assert_eq!(screens.to_string(), "sightlines and sheets and buffers of 9 planes with 32 texels");
        let rooms = choose(SceneFacts { axial: 0.2, openness: Some(0.0), ..room });
        assert_eq!(rooms.to_string(), "sightlines and sheets");
        assert_eq!(room.own_cells(), CellsFrom::KdTree);
        let few = SceneFacts { axial: 0.2, ..room };
        assert_eq!(few.own_cells(), CellsFrom::EyeLevel(EyeLevelOptions::default()));
        assert_eq!([0.5, 0.04, 0.02, 0.001].map(texels), [32, 64, 128, 256]);
        assert!([&choice, &slanted, &screens].iter().all(|c| !c.reasons.is_empty()));
    }

    /// What takes longer is measured only if a choice depends on it.
    #[test]
    fn no_more_is_measured_than_matters() {
        let quick =
            SceneFacts { n_triangles: 1, n_objects: 1, axial: 0.95, loose: None, openness: None, object_size: 0.1 };
        let slanted = SceneFacts { axial: 0.2, ..quick };
        assert!(SceneChoice::of(&quick).is_ok());
        assert_eq!(SceneChoice::of(&slanted), Err(Missing::Loose));
        assert!(SceneChoice::of(&SceneFacts { loose: Some(0.1), ..slanted }).is_ok());
        assert_eq!(SceneChoice::of(&SceneFacts { loose: Some(0.9), ..slanted }), Err(Missing::Openness));
        let room = Scene::new(vec![block([0.0; 3], [8.0, 6.0, 3.0], true)]).expect("a scene");
        let (facts, choice) = choose(&room);
        assert!(facts.loose == Some(0.0) && facts.openness.is_none() && choice.sheets, "{facts:?}");
    }

    /// Line space is used for a few given cells, whatever the walls, and alone for more than a square of bits has room for.
    #[test]
    fn how_many_cells_are_given_matters() {
        let room = Scene::new(vec![block([0.0; 3], [8.0, 6.0, 3.0], false)]).expect("a scene");
        let chosen_with = |cells: CellsFrom, parts: Option<u32>| {
            let request = BakeRequest { cells: Some(cells), parts, ..BakeRequest::default() };
            let prepared = request.prepare(&room, &Runtime::default()).expect("good options");
            (prepared.recipe().method, prepared.recipe().buffers.line_space)
        };
        let chosen = |cells: CellsFrom| chosen_with(cells, None);
        assert_eq!(chosen(CellsFrom::Grid([2, 2, 2])), (SceneMethod::Both, true));
        assert_eq!(chosen(CellsFrom::Grid([32, 32, 32])), (SceneMethod::Sightlines, false));
        assert_eq!(chosen(CellsFrom::KdTree), (SceneMethod::Sightlines, false));
        let places = |n: u32| CellsFrom::Places(PlaceOptions { n_cells: Some(n), cell_size: None });
        let alone = SceneMethod::FromRegion(OcclusionMethod::LineSpace);
        assert_eq!([places(1 << 16), places((1 << 16) + 1)].map(|of| chosen(of).0 == alone), [false, true]);
        assert_ne!(chosen_with(places(1 << 17), Some(8)).0, alone);
    }
}
