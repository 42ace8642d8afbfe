//! A bake whose decisions are taken.

use crate::auto::{Choice, choose_for, no_choice, own_cells};
use crate::baked::Baked;
use crate::error::{BakeError, Meaningless};
use crate::framed::{Framed, growth_of_cells};
use crate::input::BakeInput;
use crate::options::{Recipe, SceneMethod};
use crate::region::{CellsFrom, PackRegionsError};
use crate::reports::RegionReport;
use crate::request::{BakeRequest, Runtime};
use crate::surroundings::{Surrounding, surroundings};
use crate::{run, threads};
use sightlines_cells::{Plan, Scene};
use sightlines_formats::SceneInfo;
use sightlines_geometry::Aabb;
use sightlines_packed::PackReport;
use sightlines_pvs::Axis;
use std::io::Write;

impl BakeRequest {
    /// Takes all decisions before the work: what the request means for this input, its frame, its cells and its methods, and why.
    ///
    /// Of a scene without a method this measures the scene, which may take seconds for millions of triangles.
    ///
    /// # Errors
    /// [`BakeError::Meaningless`] for an option that means nothing here; [`BakeError::Move`], and of a plan [`BakeError::Plan`], for a stated gap that
    /// cannot be had.
    pub fn prepare<'i>(
        &self,
        input: impl Into<BakeInput<'i>>,
        runtime: &Runtime<'_>,
    ) -> Result<PreparedBake<'i>, BakeError> {
        let input = input.into();
        self.check(&input)?;
        PreparedBake::new(self, input, runtime)
    }
}

impl Runtime<'_> {
    /// Bakes an input as a request says: [`bake`](fn@crate::bake) on this.
    ///
    /// # Errors
    /// [`BakeError`]
    pub fn bake<'i>(&self, input: impl Into<BakeInput<'i>>, request: &BakeRequest) -> Result<Baked, BakeError> {
        request.prepare(input, self)?.run(self)
    }
}

/// What was decided of an input, and why: beside what the request said.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct BakeDecisions {
    /// The box around the view volumes that the file of a scene states, if viewers are there; along the axes of the file.
    pub viewers: Option<StatedViewers>,
    /// How many times the surface of given cells the boxes have that are taken in their place; see [`growth_of_cells`].
    pub cells_growth: f64,
    /// The objects around everything else, ascending: skies and the like, which every cell sees, and without which the rest is baked. None are looked for
    /// where the cells, a view region or the view volumes of the file say where viewers are, or proofs or stab trees are to be made.
    pub surroundings: Vec<u32>,
    /// How the methods were chosen, if that was asked for, or if it was found that more than sightlines pays.
    pub choice: Option<Choice>,
}

/// Where viewers are, by the file of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedViewers {
    /// View volumes that the file states.
    pub n_volumes: usize,
    /// The box around them.
    pub region: Aabb<3>,
}

/// An input with all decisions about its bake: what [`BakeRequest::prepare`] returns.
#[derive(Debug)]
pub struct PreparedBake<'i> {
    input: BakeInput<'i>,
    framed: Option<Framed>,
    /// The plan with its joints, if it has any.
    joined: Option<Plan>,
    /// The scene without its surroundings, along the frame, if it has any.
    rest: Option<Scene>,
    recipe: Recipe,
    decisions: BakeDecisions,
}

impl<'i> PreparedBake<'i> {
    pub(crate) fn new(request: &BakeRequest, input: BakeInput<'i>, runtime: &Runtime<'_>) -> Result<Self, BakeError> {
        let is_auto = request.method == Some(SceneMethod::Auto);
        let mut decisions = BakeDecisions { cells_growth: 1.0, ..BakeDecisions::default() };
        let mut recipe = request.recipe();
        let BakeInput::Scene(of_file, file) = input else {
            decisions.choice = is_auto.then(|| no_choice(&input));
            let joined = match input {
                BakeInput::Plan(plan) => request.gap.join(plan)?,
                _ => None,
            };
            return Ok(Self { input, framed: None, joined, rest: None, recipe, decisions });
        };
        if let Some(cells) = &request.cells {
            recipe.cells = cells.clone();
        }
        if request.view_region.is_none() && !matches!(recipe.cells, CellsFrom::Boxes(_)) {
            decisions.viewers = file.and_then(stated_viewers);
            recipe.cut.view_region = decisions.viewers.map(|viewers| viewers.region);
        }
        let is_open = recipe.cut.view_region.is_none() && !matches!(recipe.cells, CellsFrom::Boxes(_));
        if is_open && !request.for_proofs {
            decisions.surroundings = surroundings(of_file);
        }
        let around = &decisions.surroundings[..];
        let has_some = !around.is_empty();
        let alone = has_some.then(|| of_file.without(around));
        let framed = Framed::of_parts([of_file, alone.as_ref().unwrap_or(of_file)], file, request, around)?;
        decisions.cells_growth = growth_of_cells(request.cells.as_ref(), framed.as_ref());
        if let Some(framed) = &framed {
            framed.put_into(&mut recipe);
        }
        let whole = framed.as_ref().map_or(of_file, |framed| &framed.moved.scene);
        let rest = if framed.is_some() { has_some.then(|| whole.without(around)) } else { alone };
        if has_some {
            recipe.digest = Some(of_file.digest());
            recipe.surroundings = around.iter().map(|&object| Surrounding::of(whole, object)).collect();
        }
        let scene = rest.as_ref().unwrap_or(whole);
        let sightlines = request.method == Some(SceneMethod::Sightlines);
        // Mirrors reflect the cells of a k-d tree.
        let are_own = request.cells.is_none() && !sightlines && !request.for_proofs && scene.mirrors().is_empty();
        if are_own {
            let has_no_up = file.is_none_or(|file| file.up_is_assumed);
            let flying = request.is_for_places() || recipe.cut.view_region.is_some() || has_no_up;
            recipe.cells = request.of_width(own_cells(scene, flying));
        } else if request.cells.is_none() {
            recipe.cells = request.of_width(recipe.cells);
        }
        if let CellsFrom::EyeLevel(how) = &mut recipe.cells {
            let up = how.up.or(file.map(|file| file.up)).unwrap_or(Axis::Z);
            match upwards(up, framed.as_ref()) {
                Ok(up) => how.up = Some(up),
                Err(_) if are_own => recipe.cells = CellsFrom::Places(how.places()),
                Err(leans) => return Err(leans.into()),
            }
        }
        match request.method {
            Some(method) if !is_auto => recipe.method = method,
            None if request.is_for_proofs_alone() || !recipe.has_given_cells() && !scene.mirrors().is_empty() => {}
            _ => {
                let choose = || {
                    let mut recipe = recipe.clone();
                    let choice = choose_for(scene, &mut recipe, runtime.progress);
                    (choice, recipe)
                };
                let (choice, chosen) = threads::on(runtime.threads, choose);
                // Of sightlines that nobody asked about there is nothing to tell.
                let is_told = is_auto || chosen.method != SceneMethod::Sightlines;
                (recipe, decisions.choice) = (chosen, is_told.then_some(choice));
            }
        }
        Ok(Self { input, framed, joined: None, rest, recipe, decisions })
    }

    /// What is baked: of a scene that has a frame, the scene along it, and of one with surroundings, the rest; of a plan whose walls miss each
    /// other by no more than its gap, the plan with joints.
    pub fn input(&self) -> BakeInput<'_> {
        let moved = self.framed.as_ref().map(|framed| &framed.moved.scene);
        match (self.input, self.rest.as_ref().or(moved), &self.joined) {
            (BakeInput::Scene(_, file), Some(scene), _) => BakeInput::Scene(scene, file),
            (BakeInput::Plan(_), _, Some(plan)) => BakeInput::Plan(plan),
            (input, ..) => input,
        }
    }

    /// The frame of a scene, if it has one.
    pub fn framed(&self) -> Option<&Framed> {
        self.framed.as_ref()
    }

    /// What was decided, in full.
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// What was decided beside what the request said.
    pub fn decisions(&self) -> &BakeDecisions {
        &self.decisions
    }

    /// Cuts the input into cells where it has none, decides what they see, and makes the table.
    ///
    /// Errs towards visible, and gives the same table, byte for byte, with any number of threads.
    ///
    /// # Errors
    /// [`BakeError`]
    pub fn run(&self, runtime: &Runtime<'_>) -> Result<Baked, BakeError> {
        threads::on(runtime.threads, || run::bake_here(self.input(), &self.recipe, runtime))
    }

    /// The same for a scene, and writes a packed table of the large class row by row: for more cells than a table in memory
    /// has room for. See [`pack_regions`](crate::region::pack_regions) for what can be written so.
    ///
    /// # Errors
    /// [`PackRegionsError`]
    ///
    /// # Panics
    /// If the input is no scene.
    pub fn run_packed<W: Write + Send>(
        &self,
        out: W,
        runtime: &Runtime<'_>,
    ) -> Result<(W, RegionReport, PackReport), PackRegionsError> {
        let BakeInput::Scene(scene, file) = self.input() else { panic!("only scenes are written row by row") };
        run::bake_packed(scene, file, &self.recipe, runtime, out)
    }
}

/// The axis of a frame along which what is upwards in the scene is upwards, to within rounding.
fn upwards(up: Axis, framed: Option<&Framed>) -> Result<Axis, Meaningless> {
    let Some(framed) = framed else { return Ok(up) };
    let axes = framed.frame.axes();
    let is_upright = |axis: &Axis| axes[axis.idx()][up.idx()] > 1.0 - 1e-9;
    let found = "a scene that is baked along axes that lean, or point down";
    let refused = Meaningless { option: "eye_height", meant: "scenes that stand upright", found };
    [Axis::X, Axis::Y, Axis::Z].into_iter().find(is_upright).ok_or(refused)
}

/// The box around the view volumes of a file, if it states any.
fn stated_viewers(file: &SceneInfo) -> Option<StatedViewers> {
    let region = file.view_region()?;
    Some(StatedViewers { n_volumes: file.view_volumes.len(), region })
}

/// The cells and the method of a tile's scene: `cells` as they are, the method chosen if none is named.
pub(crate) fn recipe_of_tile(request: &BakeRequest, scene: &Scene, cells: CellsFrom, runtime: &Runtime<'_>) -> Recipe {
    let mut recipe = Recipe { cells, ..request.recipe() };
    match request.method {
        None | Some(SceneMethod::Auto) => {
            choose_for(scene, &mut recipe, runtime.progress);
        }
        Some(method) => recipe.method = method,
    }
    recipe
}
