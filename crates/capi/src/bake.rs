//! Making tables.

use crate::border::{self, Plain};
use crate::info::SlBox;
use crate::scene::{SlScene, scene};
use crate::status::{Failure, SL_ERROR_BAKE, SL_ERROR_CANCELLED, SL_ERROR_GEOMETRY, SlStatus, guard};
use crate::table::{SlTable, new_table};
use sightlines_bake::eye_level::EyeLevelOptions;
use sightlines_bake::places::PlaceOptions;
use sightlines_bake::region::CellsFrom;
use sightlines_bake::{BakeError, BakeInput, BakeRequest, Baked, Gap, Report, Runtime, SceneMethod};
use sightlines_cells::Plan;
use sightlines_formats::ViewCells;
use sightlines_formats::view_cells::ViewCell;
use sightlines_geometry::{Aabb, Point2, check_coordinate};
use sightlines_progress::{Observer, Progress};
use sightlines_pvs::{Axis, Table};
use std::ffi::{CString, c_char, c_void};
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::time::Instant;

/// How far a bake is.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SlProgress {
    /// What is being done, in a word or two of English, with a zero byte at the end; valid during the call only.
    pub phase: *const c_char,
    /// Units of this phase that are done.
    pub done: u64,
    /// Units of this phase.
    pub total: u64,
    /// The share of this phase that is done, from 0 to 1, as an estimate of time.
    pub share: f64,
}

/// Receives the progress of a bake.
///
/// It is called from any thread, by one at a time, and may come some thousand times; never again once it has returned something else
/// than 0. It must return: an exception that leaves it, or a `longjmp` out of it, is undefined behaviour. It may call any function of
/// this library but with the scene that is being baked, which is in use.
///
/// @param user      The pointer that was given with the callback; the library does not look at it.
/// @param progress  How far the bake is; valid during the call only.
/// @return 0 to go on; anything else cancels, as soon as what is under way is finished.
pub type SlProgressFn = Option<unsafe extern "C" fn(user: *mut c_void, progress: *const SlProgress) -> i32>;

/// Chosen by the scene, as the program `sightlines` does: those of a k-d tree where nearly all walls are perpendicular to an axis, else
/// cells at the height of eyes above floors, or boxes cut where views differ if no file says what is up.
pub const SL_CELLS_CHOSEN: u32 = 0;
/// Those of a k-d tree along the walls, with portals.
pub const SL_CELLS_KD_TREE: u32 = 1;
/// `place_count` boxes, cut where rays show that views differ; without portals.
pub const SL_CELLS_PLACES: u32 = 2;
/// A grid of `grid` boxes in the view region; without portals.
pub const SL_CELLS_GRID: u32 = 3;
/// The boxes at `boxes`; without portals.
pub const SL_CELLS_BOXES: u32 = 4;
/// Cells above floors, as high as eyes are; without portals. Viewers elsewhere see everything.
pub const SL_CELLS_EYE_LEVEL: u32 = 5;

/// How to make a table. Set everything to 0 but `struct_size`, which is `sizeof(sl_bake_options)`: 0 is the default of every field.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SlBakeOptions {
    /// The size of this structure, in bytes.
    pub struct_size: usize,
    /// What decides, by the name that the program has for it: "sightlines", "auto", "both", "multifocal", "line-space", "shafts".
    /// Null: "auto", which measures the scene.
    pub method: *const c_char,
    /// Where the cells come from: `SL_CELLS_…`.
    pub cells: u32,
    /// How many boxes to cut, for `SL_CELLS_PLACES`; 0 for 256. A number for cells of another kind is refused, as are `grid` and `box_count`.
    pub place_count: u32,
    /// Number of boxes along each axis, for `SL_CELLS_GRID`.
    pub grid: [u32; 3],
    /// The most cells that may be made; 0 for 65,536.
    pub max_cells: u32,
    /// The boxes, for `SL_CELLS_BOXES`.
    pub boxes: *const SlBox,
    /// Number of boxes.
    pub box_count: usize,
    /// Where viewers can be; null for everywhere within the scene.
    pub view_region: *const SlBox,
    /// How precise coordinates are, in scene units: walls within half of this of a plane across an axis of the building, which may be
    /// turned by any angle, are taken to lie in it, and openings narrower than this may count as closed. 0: what single precision explains,
    /// about a millionth of the building's size, where that puts many walls into planes and all objects were added in single precision;
    /// else nothing. Anything below 0 takes every coordinate as it is.
    pub gap: f64,
    /// Objects smaller than this in every direction hide nothing; 0 for what suits the scene, anything below 0 for none.
    pub detail_below: f64,
    /// 1 to keep the insides of solid things as cells, for eyes that can get into them.
    pub keep_solid: u32,
    /// Number of threads; 0 for one for each core, and 1024 at most. The table does not depend on it.
    pub threads: u32,
    /// Decide for about so many seconds; what is not decided by then counts as visible, and the table depends on the machine. 0 for no
    /// limit.
    pub time_limit: f64,
    /// Receives progress, and may cancel; null for none.
    pub progress: SlProgressFn,
    /// Passed to it.
    pub user: *mut c_void,
    /// Width of cells, at most, in scene units, for `SL_CELLS_CHOSEN`, `SL_CELLS_PLACES` and `SL_CELLS_EYE_LEVEL`; 0 for what suits the kind.
    pub cell_size: f64,
    /// From how far to how far above floors eyes are, in scene units, for `SL_CELLS_EYE_LEVEL`; 0 and 0 for 0 to 2.5 m.
    pub eye_height: [f64; 2],
    /// The axis that points upwards, for `SL_CELLS_EYE_LEVEL`: 1, 2 or 3 for x, y or z; 0 for what the file says, or else z.
    pub up: u64,
    /// Scenes: objects of more triangles than this are split into parts of at most that many, and the table lists which cells may see each part
    /// (`sl_table_visible_ranges`); 0 to split none.
    pub parts: u64,
    /// What to bake as JSON, by the names of the options of `sightlines build` with `_` for `-`: `{"method": "multifocal", "planes": 4}`. Null: as the
    /// other fields say. With it, of these only `threads`, `time_limit`, `progress` and `user` may be set.
    pub request: *const c_char,
}

impl Plain for SlBakeOptions {}

/// What a bake did. Set `struct_size` to `sizeof(sl_bake_report)` before.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlBakeReport {
    /// The size of this structure, in bytes.
    pub struct_size: usize,
    /// Number of cells.
    pub cell_count: u64,
    /// Pairs of different cells that see each other.
    pub visible_pairs: u64,
    /// Pairs that count as visible because deciding them took too much effort.
    pub assumed_pairs: u64,
    /// Pairs of a cell and another, or an object, that count as visible because the time was up.
    pub undecided_pairs: u64,
    /// Seconds that it took.
    pub seconds: f64,
}

/// A callback and its pointer, called by one thread at a time.
struct Callback {
    call: unsafe extern "C" fn(*mut c_void, *const SlProgress) -> i32,
    user: *mut c_void,
    /// Whether it cancelled.
    cancelled: Mutex<bool>,
}

// SAFETY: `user` is not looked at here; the header tells callers that the callback is called with it from any thread.
unsafe impl Sync for Callback {}

impl Observer for Callback {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        let Ok(mut cancelled) = self.cancelled.lock() else { return ControlFlow::Break(()) };
        if !*cancelled {
            let phase = CString::new(progress.phase).unwrap_or_default();
            let Progress { done, total, share, .. } = progress;
            let report = SlProgress { phase: phase.as_ptr(), done, total, share };
            // SAFETY: the header demands of the callback that it can be called so; the report lives until it returns.
            *cancelled = unsafe { (self.call)(self.user, &report) } != 0;
        }
        if *cancelled { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// What of the options does not depend on the input, and what they point to.
struct Given<'a> {
    options: &'a SlBakeOptions,
    method: Option<SceneMethod>,
    boxes: &'a [SlBox],
    view_region: Option<SlBox>,
    request: Option<BakeRequest>,
    callback: Option<Callback>,
}

/// The options that a pointer points to; the default ones for null.
///
/// # Safety
/// As for the module `border`.
unsafe fn given<'a>(options: *const SlBakeOptions) -> Result<Given<'a>, Failure> {
    // SAFETY: as for this function.
    unsafe {
        let options = if options.is_null() { &DEFAULT } else { border::read_sized(options, "the options")? };
        let parse =
            |text: &str| text.parse().map_err(|_| Failure::argument(format!("'{text}' is no method for scenes")));
        let method = if options.method.is_null() {
            None
        } else {
            Some(parse(border::text(options.method, "the name of the method")?)?)
        };
        let view_region = if options.view_region.is_null() {
            None
        } else {
            Some(*border::read(options.view_region, "the view region")?)
        };
        let boxes = if options.cells == SL_CELLS_BOXES { options.box_count } else { 0 };
        let boxes = border::slice(options.boxes, boxes, "the place of the boxes")?;
        let request = if options.request.is_null() {
            None
        } else {
            let text = border::text(options.request, "the request")?;
            Some(BakeRequest::from_json(text).map_err(|error| Failure::argument(format!("the request: {error}")))?)
        };
        let callback = options.progress.map(|call| Callback { call, user: options.user, cancelled: Mutex::new(false) });
        Ok(Given { options, method, boxes, view_region, request, callback })
    }
}

/// All defaults.
pub(crate) const DEFAULT_OPTIONS: SlBakeOptions = SlBakeOptions {
    struct_size: size_of::<SlBakeOptions>(),
    method: std::ptr::null(),
    cells: SL_CELLS_CHOSEN,
    place_count: 0,
    grid: [0; 3],
    max_cells: 0,
    boxes: std::ptr::null(),
    box_count: 0,
    view_region: std::ptr::null(),
    gap: 0.0,
    detail_below: 0.0,
    keep_solid: 0,
    threads: 0,
    time_limit: 0.0,
    progress: None,
    user: std::ptr::null_mut(),
    cell_size: 0.0,
    eye_height: [0.0; 2],
    up: 0,
    parts: 0,
    request: std::ptr::null(),
};

/// The same. It holds no pointer but null, so it may be shared between threads.
static DEFAULT: Shareable = Shareable(DEFAULT_OPTIONS);

struct Shareable(SlBakeOptions);

// SAFETY: its pointers are all null.
unsafe impl Sync for Shareable {}

impl std::ops::Deref for Shareable {
    type Target = SlBakeOptions;

    fn deref(&self) -> &SlBakeOptions {
        &self.0
    }
}

fn aabb(b: &SlBox, what: &str) -> Result<Aabb<3>, Failure> {
    for x in b.min.iter().chain(&b.max) {
        check_coordinate(*x).map_err(|error| Failure::new(SL_ERROR_GEOMETRY, format!("{what}: {error}")))?;
    }
    if (0..3).any(|k| b.min[k] > b.max[k]) {
        return Err(Failure::new(SL_ERROR_GEOMETRY, format!("{what}: a lower corner above the upper one")));
    }
    Ok(Aabb { min: b.min, max: b.max })
}

impl Given<'_> {
    /// As the crate `bake` takes them.
    ///
    /// * `is_scene`: for a plan only what it has in common with scenes is checked, and nothing of scenes asked for
    fn request(&self, is_scene: bool, is_single: bool) -> Result<BakeRequest, Failure> {
        let SlBakeOptions { cells, place_count, grid, max_cells, gap, detail_below, keep_solid, threads, .. } =
            *self.options;
        if threads > 1024 {
            return Err(Failure::argument(format!("{threads} threads: there can be 1024 at most")));
        }
        let limit = self.options.time_limit;
        let are_numbers = gap.is_finite() && limit.is_finite() && limit >= 0.0 && !detail_below.is_nan();
        if !are_numbers {
            return Err(Failure::argument(
                "gap, time limit or size of detail is no finite number, or the limit is below 0",
            ));
        }
        let SlBakeOptions { cell_size, eye_height, up, parts, .. } = *self.options;
        let parts = u32::try_from(parts).map_err(|_| Failure::argument(format!("parts of {parts} triangles")))?;
        let axis = match up {
            0 => None,
            1..=3 => Some(Axis::ALL[up as usize - 1]),
            _ => return Err(Failure::argument(format!("up is {up}, where 0, 1, 2 or 3 is expected"))),
        };
        for (field, is_given, kind) in [
            ("place_count", place_count != 0, SL_CELLS_PLACES),
            ("grid", grid != [0; 3], SL_CELLS_GRID),
            ("box_count", self.options.box_count != 0, SL_CELLS_BOXES),
            ("eye_height", eye_height != [0.0; 2], SL_CELLS_EYE_LEVEL),
            ("up", up != 0, SL_CELLS_EYE_LEVEL),
        ] {
            if is_given && cells != kind {
                return Err(Failure::argument(format!(
                    "{field} is for cells of kind {kind}, and these are of kind {cells}"
                )));
            }
        }
        let n_cells = if place_count == 0 { None } else { Some(place_count) };
        let cell_size = if cell_size == 0.0 { None } else { Some(cell_size) };
        let eyes = EyeLevelOptions {
            cell_size,
            eye_height: if eye_height == [0.0; 2] { None } else { Some(eye_height) },
            up: axis,
            ..EyeLevelOptions::default()
        };
        let mut width = cell_size;
        let cells = match cells {
            SL_CELLS_CHOSEN => None,
            SL_CELLS_KD_TREE => Some(CellsFrom::KdTree),
            SL_CELLS_PLACES => {
                width = None;
                Some(CellsFrom::Places(PlaceOptions { n_cells, cell_size }))
            }
            SL_CELLS_EYE_LEVEL => {
                width = None;
                Some(CellsFrom::EyeLevel(eyes))
            }
            SL_CELLS_GRID => Some(CellsFrom::Grid(grid)),
            SL_CELLS_BOXES => {
                let cell = |(i, b): (usize, &SlBox)| {
                    let bounds = aabb(b, &format!("box {i}"))?;
                    Ok(ViewCell { id: i.to_string(), bounds })
                };
                let cells: Vec<ViewCell> = self.boxes.iter().enumerate().map(cell).collect::<Result<_, Failure>>()?;
                if cells.is_empty() {
                    return Err(Failure::argument("no boxes were given"));
                }
                Some(CellsFrom::Boxes(ViewCells { cells, axes: None }))
            }
            _ => return Err(Failure::argument(format!("{cells} is no kind of cells"))),
        };
        let view_region = self.view_region.as_ref().map(|b| aabb(b, "the view region")).transpose()?;
        let by_fields = BakeRequest {
            cells,
            cell_size: width,
            method: self.method,
            gap: if gap == 0.0 { Gap::OfFile } else { Gap::Width(gap.max(0.0)) },
            view_region,
            detail_below: if detail_below == 0.0 { None } else { Some(detail_below.max(0.0)) },
            max_cells: if max_cells == 0 { None } else { Some(max_cells) },
            keep_solid: keep_solid != 0,
            parts: if parts == 0 { None } else { Some(parts) },
            ..BakeRequest::default()
        };
        let mut request = match &self.request {
            Some(_) if by_fields != BakeRequest::default() => {
                return Err(Failure::argument("what to bake is said by the request and by other fields"));
            }
            Some(request) => request.clone(),
            None if is_scene => by_fields,
            None => BakeRequest::default(),
        };
        if is_scene && is_single && request.gap == Gap::OfFile {
            request.gap = Gap::OfSingle;
        }
        Ok(request)
    }

    /// Makes a table, and tells what was done.
    ///
    /// * `is_single`: whether all coordinates of a scene are in single precision
    fn bake(&self, input: BakeInput<'_>, is_single: bool) -> Result<(Table, SlBakeReport), Failure> {
        let (start, limit) = (Instant::now(), self.options.time_limit);
        let spent = move || start.elapsed().as_secs_f64() / limit;
        let request = self.request(matches!(input, BakeInput::Scene(..)), is_single)?;
        let runtime = Runtime {
            threads: self.options.threads as usize,
            progress: self.callback.as_ref().map(|callback| callback as &dyn Observer),
            budget: if limit > 0.0 { Some(&spent) } else { None },
            ..Runtime::default()
        };
        let done = request.prepare(input, &runtime).and_then(|prepared| prepared.run(&runtime));
        let Baked { table, report, .. } = done.map_err(|error| {
            let status = if matches!(error, BakeError::Cancelled(_)) { SL_ERROR_CANCELLED } else { SL_ERROR_BAKE };
            Failure::new(status, error.to_string())
        })?;
        let (pairs, assumed, left) = match &report {
            Report::Plan(did) => (did.n_visible_pairs, 0, None),
            Report::Scene(did) => (did.n_visible_pairs, did.n_assumed, did.limit),
            Report::Regions(did) => (did.n_visible_pairs, did.n_assumed, did.limit),
            _ => (0, 0, None),
        };
        let report = SlBakeReport {
            struct_size: size_of::<SlBakeReport>(),
            cell_count: table.n_cells() as u64,
            visible_pairs: pairs,
            assumed_pairs: assumed,
            undecided_pairs: left.map_or(0, |left| left.n_cell_pairs + left.n_object_pairs),
            seconds: start.elapsed().as_secs_f64(),
        };
        Ok((table, report))
    }
}

/// Makes the table of a scene. The same scene and options give the same table, byte for byte, with any number of threads, unless there is
/// a time limit.
///
/// @param scene    The scene; it is not changed, and may be freed afterwards.
/// @param options  How to make it; null for all defaults.
/// @param table    Where the handle goes; free it with `sl_table_free`. Null is stored there if the call fails.
/// @param report   Where goes what was done, with `struct_size` set; may be null.
/// @return `SL_OK`; `SL_ERROR_GEOMETRY`, `SL_ERROR_BAKE` or `SL_ERROR_ARGUMENT` for what cannot be baked so; `SL_ERROR_CANCELLED`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_bake(
    scene: *const SlScene,
    options: *const SlBakeOptions,
    table: *mut *mut SlTable,
    report: *mut SlBakeReport,
) -> SlStatus {
    // SAFETY: pointers are as the header demands.
    guard(|| unsafe {
        new_table(table, || {
            let parts = self::scene(scene)?;
            let given = given(options)?;
            let scene = parts.scene()?;
            bake_and_report(&given, (BakeInput::Scene(&scene, None), parts.is_single()), report)
        })
    })
}

/// Makes the table of a plan: walls in the plane, which hide from both sides. Objects and doors belong to scenes.
///
/// Of the options only `request`, `threads`, `progress` and `user` change anything; the others have to be valid all the same.
///
/// @param walls       x and y of the two ends of one wall after the other: four numbers each.
/// @param wall_count  Number of walls.
/// @param options     How to make it; null for all defaults.
/// @param table       Where the handle goes; free it with `sl_table_free`. Null is stored there if the call fails.
/// @param report      Where goes what was done, with `struct_size` set; may be null.
/// @return `SL_OK`; `SL_ERROR_GEOMETRY` for walls that are no plan, `SL_ERROR_BAKE` if there is no room in it; `SL_ERROR_CANCELLED`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_bake_plan(
    walls: *const f64,
    wall_count: usize,
    options: *const SlBakeOptions,
    table: *mut *mut SlTable,
    report: *mut SlBakeReport,
) -> SlStatus {
    // SAFETY: pointers are as the header demands; an array has the alignment of what is in it.
    guard(|| unsafe {
        new_table(table, || {
            let walls = border::slice(walls.cast::<[f64; 4]>(), wall_count, "the place of the walls")?;
            let given = given(options)?;
            let plan = Plan::from_walls(walls.iter().map(|w| (Point2::new(w[0], w[1]), Point2::new(w[2], w[3]))))
                .map_err(|error| Failure::new(SL_ERROR_GEOMETRY, error.to_string()))?;
            bake_and_report(&given, (BakeInput::Plan(&plan), false), report)
        })
    })
}

/// Makes a table, and stores what was done where that is asked.
///
/// # Safety
/// As for the module `border`.
unsafe fn bake_and_report(
    given: &Given<'_>,
    (input, is_single): (BakeInput<'_>, bool),
    report: *mut SlBakeReport,
) -> Result<Table, Failure> {
    // SAFETY: as for this function.
    unsafe {
        if !report.is_null() {
            border::check_sized(report, "the report")?;
        }
        let (table, did) = given.bake(input, is_single)?;
        if !report.is_null() {
            border::put_sized(report, did, "the report")?;
        }
        Ok(table)
    }
}
