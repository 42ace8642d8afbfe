//! Random sequences of calls across the border, as a fuzzer draws them.
//!
//! [`drive`] takes bytes for instructions: which function, which handles, how large the buffers. Handles are those that calls made, of
//! any kind, null, or memory that is no handle; pointers are null, misaligned or to memory of this module. What callers must never do (use
//! what was freed, state more than there is) is never done, so nothing here may be undefined behaviour, and every defect is a panic: a
//! status that is none, a buffer written beyond its size or in part, a call that reports a defect.

mod draw;

use crate::*;
use draw::{Bytes, Marked};
use std::ffi::{c_char, c_void};
use std::ptr;

/// A handle, by its kind.
#[derive(Clone, Copy)]
enum Held {
    Table(*mut SlTable),
    Viewer(*mut SlViewer),
    Scene(*mut SlScene),
    Relevance(*mut SlRelevance),
}

impl Held {
    fn address(self) -> *mut c_void {
        match self {
            Self::Table(handle) => handle.cast(),
            Self::Viewer(handle) => handle.cast(),
            Self::Scene(handle) => handle.cast(),
            Self::Relevance(handle) => handle.cast(),
        }
    }
}

struct Driver<'a> {
    bytes: Bytes<'a>,
    held: Vec<Held>,
    /// Memory that is no handle.
    nothing: Box<[u64; 64]>,
    n_ok: usize,
}

type List<H, T> = unsafe extern "C" fn(*const H, *mut T, usize, *mut usize) -> SlStatus;
type ListOf<H, T> = unsafe extern "C" fn(*const H, u32, *mut T, usize, *mut usize) -> SlStatus;

extern "C" fn progress(user: *mut c_void, progress: *const SlProgress) -> i32 {
    // SAFETY: the driver passes a counter, which lives while it bakes; the report lives during the call.
    let (left, share) = unsafe { (&mut *user.cast::<u32>(), (*progress).share) };
    assert!((0.0..=1.0).contains(&share), "{share}");
    *left = left.saturating_sub(1);
    i32::from(*left == 0)
}

/// Runs the instructions in `bytes`; returns how many calls succeeded.
///
/// # Panics
/// If the border does something that it promises not to do.
pub fn drive(bytes: &[u8]) -> usize {
    let mut driver = Driver { bytes: Bytes { left: bytes }, held: Vec::new(), nothing: Box::new([0; 64]), n_ok: 0 };
    while !driver.bytes.left.is_empty() {
        driver.step();
    }
    while let Some(held) = driver.held.pop() {
        free(held);
    }
    driver.n_ok
}

fn free(held: Held) {
    // SAFETY: each handle is held once, and freed when it is no longer held.
    unsafe {
        match held {
            Held::Table(handle) => sl_table_free(handle),
            Held::Viewer(handle) => sl_viewer_free(handle),
            Held::Scene(handle) => sl_scene_free(handle),
            Held::Relevance(handle) => sl_relevance_free(handle),
        }
    }
}

impl Driver<'_> {
    fn heed(&mut self, status: SlStatus) -> bool {
        assert!((SL_OK..=SL_ERROR_POISONED).contains(&status), "{status} is no status");
        assert!(!matches!(status, SL_ERROR_INTERNAL | SL_ERROR_POISONED), "a defect was reported");
        self.n_ok += usize::from(status == SL_OK);
        status == SL_OK
    }

    fn hold(&mut self, status: SlStatus, made: Held) {
        let is_ok = self.heed(status);
        assert_eq!(is_ok, !made.address().is_null(), "a handle is made exactly if the call succeeds");
        if !is_ok {
            return;
        }
        if self.held.len() >= 12 {
            let oldest = self.held.remove(0);
            free(oldest);
        }
        self.held.push(made);
    }

    /// A handle of that kind as a rule; else of another kind, null, or none at all.
    fn pick<H>(&mut self, is_kind: fn(&Held) -> bool) -> *mut H {
        let of_kind: Vec<Held> = self.held.iter().copied().filter(is_kind).collect();
        let choice = self.bytes.byte();
        let pick =
            |all: &[Held]| all.get(usize::from(choice) % all.len().max(1)).map_or(ptr::null_mut(), |h| h.address());
        match choice {
            255 => ptr::null_mut(),
            254 => self.nothing.as_mut_ptr().cast(),
            253 => self.nothing.as_mut_ptr().cast::<u8>().wrapping_add(3).cast(),
            240.. => pick(&self.held).cast(),
            _ => pick(&of_kind).cast(),
        }
    }

    fn table(&mut self) -> *mut SlTable {
        self.pick(|held| matches!(held, Held::Table(_)))
    }

    fn viewer(&mut self) -> *mut SlViewer {
        self.pick(|held| matches!(held, Held::Viewer(_)))
    }

    fn scene(&mut self) -> *mut SlScene {
        self.pick(|held| matches!(held, Held::Scene(_)))
    }

    /// A text that ends with a zero, UTF-8 or not, or null.
    fn name(&mut self) -> Option<Vec<u8>> {
        match self.bytes.below(8) {
            0 => None,
            1 => Some(vec![self.bytes.byte() | 1, 0xff, 0]),
            k => Some([format!("thing{}", k % 4).as_bytes(), &[0]].concat()),
        }
    }

    /// A place for a result, or null.
    fn out<T>(&mut self, value: &mut T) -> *mut T {
        if self.bytes.below(16) == 0 { ptr::null_mut() } else { value }
    }

    fn list<H, T: Copy + PartialEq + std::fmt::Debug>(&mut self, handle: *mut H, call: List<H, T>, mark: T) {
        let mut buffer = Marked::new(&mut self.bytes, mark);
        let (to, capacity) = (buffer.place(), buffer.capacity);
        let mut count = usize::MAX;
        let at = self.out(&mut count);
        // SAFETY: a live handle or none; the buffer has room for more than its capacity.
        let status = unsafe { call(handle, to, if to.is_null() { capacity.min(1) } else { capacity }, at) };
        buffer.count = count;
        buffer.check(status);
        self.heed(status);
    }

    fn list_of<H, T: Copy + PartialEq + std::fmt::Debug>(&mut self, handle: *mut H, call: ListOf<H, T>, mark: T) {
        let number = self.bytes.number();
        let mut buffer = Marked::new(&mut self.bytes, mark);
        let (to, capacity) = (buffer.place(), buffer.capacity);
        let mut count = usize::MAX;
        let at = self.out(&mut count);
        // SAFETY: a live handle or none; the buffer has room for more than its capacity.
        let status = unsafe { call(handle, number, to, if to.is_null() { capacity.min(1) } else { capacity }, at) };
        buffer.count = count;
        buffer.check(status);
        self.heed(status);
    }

    fn step(&mut self) {
        match self.bytes.byte() % 15 {
            0 => self.make_scene(),
            1 | 2 => self.add_object(),
            3 => self.bake(),
            4 => self.new_table(),
            5 | 6 => self.ask_table(),
            7 => self.ask_lists(),
            8 => self.make_viewer(),
            9 => self.look(),
            10 => self.ask_viewer(),
            11 => self.make_relevance(),
            12 => self.tick(),
            13 => self.ask_relevance(),
            _ => self.drop_one(),
        }
    }

    fn drop_one(&mut self) {
        if !self.held.is_empty() {
            let at = self.bytes.below(self.held.len());
            let held = self.held.swap_remove(at);
            free(held);
        }
        // SAFETY: null, or memory that is no handle, which is told apart by its first bytes.
        unsafe {
            sl_table_free(ptr::null_mut());
            sl_viewer_free(self.nothing.as_mut_ptr().cast());
            sl_scene_free(self.nothing.as_mut_ptr().cast::<u8>().wrapping_add(1).cast());
        }
    }

    fn make_scene(&mut self) {
        let mut made = ptr::null_mut();
        // SAFETY: a place of this function.
        let status = unsafe { sl_scene_new(&mut made) };
        self.hold(status, Held::Scene(made));
        // SAFETY: null is refused.
        let status = unsafe { sl_scene_new(ptr::null_mut()) };
        assert_eq!(status, SL_ERROR_NULL);
    }

    fn add_object(&mut self) {
        let scene = self.scene();
        let flags = if self.bytes.below(4) == 0 { self.bytes.number() } else { 0 };
        let (mut vertices, mut indices) = (Vec::new(), Vec::new());
        for _ in 0..1 + self.bytes.below(3) {
            let first = vertices.len() as u32 / 3;
            let low: [f64; 3] = self.bytes.reals();
            let size: [f64; 3] = self.bytes.reals();
            for corner in 0..8usize {
                vertices.extend((0..3).map(|k| low[k] + if corner >> k & 1 == 1 { size[k].abs() } else { 0.0 }));
            }
            const SIDES: [[u32; 4]; 6] =
                [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
            indices.extend(SIDES.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).map(|i| first + i));
        }
        if self.bytes.below(16) == 0 {
            indices.push(self.bytes.number());
        }
        let n_indices = indices.len() - self.bytes.below(16) / 15;
        let name = self.name();
        let name = name.as_ref().map_or(ptr::null(), |name| name.as_ptr().cast::<c_char>());
        let mut object = 0;
        let out = self.out(&mut object);
        let n = vertices.len() / 3;
        let single: Vec<f32> = vertices.iter().map(|x| *x as f32).collect();
        let (at, at_single) = match self.bytes.below(32) {
            0 => (ptr::null(), ptr::null()),
            1 => (vertices.as_ptr().wrapping_byte_add(4), single.as_ptr().wrapping_byte_add(2)),
            _ => (vertices.as_ptr(), single.as_ptr()),
        };
        // SAFETY: a live handle or none; everything else is null, misaligned, or as large as stated.
        let status = unsafe {
            if self.bytes.below(2) == 0 {
                sl_scene_add_object(scene, name, at, n, indices.as_ptr(), n_indices, flags, out)
            } else {
                sl_scene_add_object_f32(scene, name, at_single, n, indices.as_ptr(), n_indices, flags, out)
            }
        };
        self.heed(status);
        if self.bytes.below(4) == 0 {
            let (object, within) = (self.bytes.number(), SlBox { min: self.bytes.reals(), max: self.bytes.reals() });
            let within: *const SlBox = if self.bytes.below(4) == 0 { ptr::null() } else { &within };
            // SAFETY: a live handle or none, a box of this function.
            let status = unsafe { sl_scene_set_motion(scene, object, within) };
            self.heed(status);
        }
    }

    fn bake(&mut self) {
        const METHODS: [&std::ffi::CStr; 7] =
            [c"sightlines", c"auto", c"both", c"multifocal", c"shafts", c"magic", c"\xff"];
        const REQUESTS: [&std::ffi::CStr; 4] =
            [c"{\"n_cells\": 4}", c"{\"method\": \"shafts\", \"grid\": [1, 2, 1]}", c"{\"planes\": 0}", c"{"];
        let scene = self.scene();
        let boxes: Vec<SlBox> =
            (0..self.bytes.below(3)).map(|_| SlBox { min: self.bytes.reals(), max: self.bytes.reals() }).collect();
        let region = SlBox { min: self.bytes.reals(), max: self.bytes.reals() };
        let mut left = 1 + u32::from(self.bytes.byte());
        let stated = size_of::<SlBakeOptions>() - self.bytes.below(16) / 15;
        let method = self.bytes.below(14);
        let cells = self.bytes.below(7) as u32;
        // What cells of another kind need is refused.
        let is_odd = self.bytes.below(16) == 0;
        let options =
            SlBakeOptions {
                struct_size: stated,
                method: METHODS.get(method).map_or(ptr::null(), |name| name.as_ptr()),
                cells,
                place_count: if is_odd || cells == SL_CELLS_PLACES { self.bytes.below(9) as u32 } else { 0 },
                grid: std::array::from_fn(|_| {
                    if is_odd || cells == SL_CELLS_GRID { self.bytes.below(3) as u32 } else { 0 }
                }),
                max_cells: 200,
                boxes: boxes.as_ptr(),
                box_count: if is_odd || cells == SL_CELLS_BOXES { boxes.len() } else { 0 },
                view_region: if self.bytes.below(4) == 0 { &region } else { ptr::null() },
                gap: if self.bytes.below(8) == 0 { self.bytes.real() } else { 0.0 },
                detail_below: if self.bytes.below(4) == 0 { self.bytes.real() } else { -1.0 },
                keep_solid: u32::from(self.bytes.byte()) % 2,
                threads: 1,
                time_limit: [0.0, 0.05, f64::NAN][self.bytes.below(24) / 11 % 3],
                progress: if self.bytes.below(2) == 0 { Some(progress) } else { None },
                user: ptr::from_mut(&mut left).cast(),
                cell_size: if self.bytes.below(8) == 0 { self.bytes.real() } else { 0.0 },
                parts: if self.bytes.below(8) == 0 { u64::from(self.bytes.number()) } else { 0 },
                eye_height: if cells == SL_CELLS_EYE_LEVEL && self.bytes.below(4) == 0 {
                    [self.bytes.real(), self.bytes.real()]
                } else {
                    [0.0; 2]
                },
                up: if cells == SL_CELLS_EYE_LEVEL || is_odd { self.bytes.below(5) as u64 } else { 0 },
                request: ptr::null(),
            };
        // A request says it all, but mostly for threads and progress.
        let options = match self.bytes.below(16) {
            0 => SlBakeOptions { request: REQUESTS[0].as_ptr(), ..options },
            k @ 1..5 => {
                let SlBakeOptions { struct_size, threads, progress, user, .. } = options;
                let request = REQUESTS[k - 1].as_ptr();
                SlBakeOptions { struct_size, threads, progress, user, request, ..crate::bake::DEFAULT_OPTIONS }
            }
            _ => options,
        };
        let mut report = SlBakeReport {
            struct_size: size_of::<SlBakeReport>() + self.bytes.below(16) / 15,
            cell_count: 0,
            visible_pairs: 0,
            assumed_pairs: 0,
            undecided_pairs: 0,
            seconds: 0.0,
        };
        let out = self.out(&mut report);
        let mut made = ptr::null_mut();
        // SAFETY: a live handle or none; what the options point to is of this function.
        let status = unsafe {
            if self.bytes.below(4) == 0 {
                let walls: Vec<f64> = (0..4 * (3 + self.bytes.below(6))).map(|_| self.bytes.real()).collect();
                sl_bake_plan(walls.as_ptr(), walls.len() / 4, &options, &mut made, out)
            } else {
                sl_bake(scene, &options, &mut made, out)
            }
        };
        self.hold(status, Held::Table(made));
    }

    /// A table from the bytes of another, damaged or not.
    fn new_table(&mut self) {
        let (table, form) = (self.table(), self.bytes.below(3) as u32);
        let mut n = 0;
        // SAFETY: a live handle or none, a place of this function.
        if !self.heed(unsafe { sl_table_bytes(table, form, ptr::null_mut(), 0, &mut n) }) {
            return;
        }
        let mut bytes = vec![0u8; n];
        // SAFETY: a live handle, a buffer of the stated size.
        let status = unsafe { sl_table_bytes(table, form, bytes.as_mut_ptr(), n, &mut n) };
        assert!(self.heed(status) && n == bytes.len());
        let damage = self.bytes.below(3);
        for _ in 0..damage {
            let at = usize::from(u16::from_le_bytes([self.bytes.byte(), self.bytes.byte()])) % n;
            bytes[at] ^= self.bytes.byte();
        }
        let mut made = ptr::null_mut();
        // SAFETY: bytes and a place of this function.
        let status = unsafe { sl_table_from_bytes(bytes.as_ptr(), n, &mut made) };
        assert!(damage > 0 || status == SL_OK, "what was written is read");
        self.hold(status, Held::Table(made));
    }

    fn ask_table(&mut self) {
        let (table, number) = (self.table(), self.bytes.number());
        let name = self.name();
        let name = name.as_ref().map_or(ptr::null(), |name| name.as_ptr().cast::<c_char>());
        let mut answer = 7;
        // SAFETY: a live handle or none; results go to places of this function, or to null.
        let status = unsafe {
            match self.bytes.below(11) {
                0 => {
                    let mut info = std::mem::zeroed::<SlTableInfo>();
                    info.struct_size = size_of::<SlTableInfo>() + self.bytes.below(16) / 15;
                    sl_table_get_info(table, self.out(&mut info))
                }
                1 => sl_table_cell(table, number, self.out(&mut std::mem::zeroed())),
                2 => sl_table_object(table, number, self.out(&mut std::mem::zeroed())),
                3 => sl_table_portal(table, number, self.out(&mut std::mem::zeroed())),
                4 => sl_table_door(table, number, self.out(&mut std::mem::zeroed())),
                5 => sl_table_object_source(table, number, self.out(&mut std::mem::zeroed())),
                6 => sl_table_find_object(table, name, self.out(&mut answer)),
                7 => sl_table_sees(table, number, self.bytes.number(), self.out(&mut answer)),
                8 => self.ask_row(table, number),
                9 => self.ask_ranges(table, number),
                _ => self.ask_points(table),
            }
        };
        self.heed(status);
    }

    /// Ranges of the triangles of objects are within those of the parts.
    fn ask_ranges(&mut self, table: *mut SlTable, number: u32) -> SlStatus {
        let (mut ranges, mut n) = ([SlRange { object: 0, start: 0, end: 0 }; 16], 0);
        let capacity = self.bytes.below(17);
        // SAFETY: a live handle or none, places of this function.
        let status = unsafe { sl_table_visible_ranges(table, number, ranges.as_mut_ptr(), capacity, &mut n) };
        if status == SL_OK {
            assert!(ranges[..n].iter().all(|range| range.start < range.end));
        }
        status
    }

    fn ask_row(&mut self, table: *mut SlTable, number: u32) -> SlStatus {
        let (mut words, mut n) = (ptr::null(), 0);
        let to = self.out(&mut words);
        // SAFETY: a live handle or none, places of this function.
        let status = unsafe { sl_table_row(table, number, to, &mut n) };
        if status == SL_OK {
            // SAFETY: the row lives as long as the table.
            let row = unsafe { std::slice::from_raw_parts(words, n) };
            assert!(row[number as usize / 64] >> (number % 64) & 1 == 1, "a cell sees itself");
        }
        status
    }

    fn ask_points(&mut self, table: *mut SlTable) -> SlStatus {
        let mut buffer = Marked::new(&mut self.bytes, 0xabcd_ef01u32);
        let point: [f64; 3] = self.bytes.reals();
        let bounds = SlBox { min: point, max: self.bytes.reals() };
        let point = if self.bytes.below(16) == 0 { ptr::null() } else { point.as_ptr() };
        let (to, mut count, mut outside) = (buffer.place(), usize::MAX, 0);
        let capacity = if to.is_null() { 0 } else { buffer.capacity };
        let is_outside = self.out(&mut outside);
        // SAFETY: a live handle or none; the buffer has room for more than its capacity; the point has three coordinates.
        let status = unsafe {
            match self.bytes.below(5) {
                0 => sl_table_cells_at(table, point, to, capacity, &mut count),
                1 => sl_table_visible_cells_at(table, point, to, capacity, &mut count, is_outside),
                2 => sl_table_visible_objects_at(table, point, to, capacity, &mut count, is_outside),
                3 => sl_table_cells_touching(table, &bounds, to, capacity, &mut count),
                _ => sl_table_portals_within(table, &bounds, to, capacity, &mut count),
            }
        };
        buffer.count = count;
        buffer.check(status);
        status
    }

    fn ask_lists(&mut self) {
        let table = self.table();
        match self.bytes.below(11) {
            0 => self.list_of(table, sl_table_cell_corners, f64::MAX),
            1 => self.list_of(table, sl_table_cell_name, 0x55),
            2 => self.list_of(table, sl_table_object_name, 0x55),
            3 => self.list_of(table, sl_table_portal_corners, f64::MAX),
            4 => self.list_of(table, sl_table_visible_cells, 0xabcd_ef01),
            5 => self.list_of(table, sl_table_visible_objects, 0xabcd_ef01),
            6 => self.list_of(table, sl_table_objects_in_cell, 0xabcd_ef01),
            7 => self.list_of(table, sl_table_visible_object_bits, 0x0123_4567_89ab_cdef),
            8 => self.list_of(table, sl_table_door_name, 0x55),
            9 => self.list_of(table, sl_table_door_portals, 0xabcd_ef01),
            _ => self.list_of(table, sl_table_objects_of_node, 0xabcd_ef01),
        }
    }

    fn make_viewer(&mut self) {
        let table = self.table();
        let mut made = ptr::null_mut();
        // SAFETY: a live handle or none, a place of this function.
        let status = unsafe { sl_viewer_new(table, &mut made) };
        self.hold(status, Held::Viewer(made));
    }

    fn look(&mut self) {
        let viewer = self.viewer();
        let view = SlView {
            kind: self.bytes.below(7) as u32,
            eye: self.bytes.reals(),
            direction: self.bytes.reals(),
            up: self.bytes.reals(),
            field_of_view: self.bytes.real(),
            aspect: self.bytes.real(),
            matrix: if self.bytes.below(4) == 0 { self.bytes.reals() } else { [1.0; 16] },
        };
        let mut answer = SlAnswer { is_outside: 0, method: 0, cell_count: 0, object_count: 0, mirror_view_count: 0 };
        let out = self.out(&mut answer);
        // SAFETY: a live handle or none, a view and a place of this function.
        let status = unsafe { sl_viewer_look(viewer, &view, out) };
        if self.heed(status) && !out.is_null() {
            let mut n = 0;
            // SAFETY: a live handle, a place of this function.
            let status = unsafe { sl_viewer_cells(viewer, ptr::null_mut(), 0, &mut n) };
            assert!(self.heed(status) && n == answer.cell_count as usize);
            assert!(n > 0 || answer.is_outside == 1, "the eye's own cell is seen");
        }
    }

    fn relevance(&mut self) -> *mut SlRelevance {
        self.pick(|held| matches!(held, Held::Relevance(_)))
    }

    fn make_relevance(&mut self) {
        let table = self.table();
        let path = if self.bytes.below(8) == 0 { c"/dev/null".as_ptr() } else { ptr::null() };
        let mut options = SlRelevanceOptions {
            struct_size: size_of::<SlRelevanceOptions>() + self.bytes.below(16) / 15,
            hold: self.bytes.real(),
            slack: self.bytes.real(),
            walk: self.bytes.real(),
            looks: u64::from(self.bytes.number()),
        };
        let at: *const SlRelevanceOptions = match self.bytes.below(3) {
            0 => ptr::null(),
            1 => &options,
            _ => {
                // SAFETY: a live handle or none, a place of this function.
                let status = unsafe { sl_relevance_default_options(table, &mut options) };
                self.heed(status);
                &options
            }
        };
        let mut made = ptr::null_mut();
        // SAFETY: a live handle or none; texts, options and a place of this function.
        let status = unsafe { sl_relevance_new(table, path, at, &mut made) };
        self.hold(status, Held::Relevance(made));
    }

    fn player(&mut self) -> SlPlayer {
        let low: [f64; 3] = self.bytes.reals();
        let body = SlBox { min: low, max: low.map(|x| x + 0.25 * self.bytes.below(4) as f64) };
        SlPlayer {
            eyes: if self.bytes.below(8) == 0 {
                SlBox { min: self.bytes.reals(), max: self.bytes.reals() }
            } else {
                body
            },
            seen: body,
            reach: if self.bytes.below(4) == 0 { self.bytes.real() } else { 0.5 },
            arm: if self.bytes.below(8) == 0 { self.bytes.real() } else { 0.0 },
            sees_always: if self.bytes.below(8) == 0 { u64::MAX } else { 0 },
            team: if self.bytes.below(16) == 0 { self.bytes.number() } else { 0 },
            flags: if self.bytes.below(16) == 0 { self.bytes.number() } else { SL_PLAYER_VIEWS | SL_PLAYER_IS_SEEN },
        }
    }

    fn tick(&mut self) {
        let relevance = self.relevance();
        let now = self.bytes.real();
        let players: Vec<SlPlayer> = (0..self.bytes.below(9)).map(|_| self.player()).collect();
        let mut changes =
            SlChanges { gained_count: 0, lost_count: 0, look_count: 0, coarse_count: 0, outside_count: 0 };
        let out = self.out(&mut changes);
        // SAFETY: a live handle or none, players and a place of this function.
        let status = unsafe { sl_relevance_update(relevance, now, players.as_ptr(), players.len(), out) };
        if self.heed(status) && !out.is_null() {
            let mut n = 0;
            // SAFETY: a live handle, a place of this function.
            let status = unsafe { sl_relevance_gained(relevance, ptr::null_mut(), 0, &mut n) };
            assert!(self.heed(status) && n == 2 * changes.gained_count);
            assert!(changes.outside_count <= players.len());
        }
    }

    fn ask_relevance(&mut self) {
        let (relevance, number) = (self.relevance(), self.bytes.number());
        let [a, b] = [(); 2].map(|()| self.player());
        let (mut shown, mut seconds, speeds) = (7, 0.0, self.bytes.reals::<2>());
        // SAFETY: a live handle or none; results go to places of this function, or to null.
        let status = unsafe {
            match self.bytes.below(6) {
                0 => return self.list(relevance, sl_relevance_gained, 0xabcd_ef01),
                1 => return self.list(relevance, sl_relevance_lost, 0xabcd_ef01),
                2 => return self.list_of(relevance, sl_relevance_shown_to, 0xabcd_ef01),
                3 => sl_relevance_is_shown(relevance, number, self.bytes.number(), self.out(&mut shown)),
                4 => sl_relevance_may_see_within(relevance, &a, &b, self.out(&mut shown)),
                _ => sl_relevance_time_to_sight(relevance, &a, &b, speeds.as_ptr(), self.out(&mut seconds)),
            }
        };
        assert!(!self.heed(status) || seconds >= 0.0, "{seconds} seconds");
    }

    fn ask_viewer(&mut self) {
        let (viewer, number) = (self.viewer(), self.bytes.number());
        let name = self.name();
        let name = name.as_ref().map_or(ptr::null(), |name| name.as_ptr().cast::<c_char>());
        // SAFETY: a live handle or none; results go to places of this function, or to null.
        let status = unsafe {
            match self.bytes.below(18) {
                0 => sl_viewer_set_method(viewer, number % 8, u64::from(self.bytes.number())),
                1 => sl_viewer_set_memory(viewer, number as usize * 100),
                2 => sl_viewer_close_portal(viewer, number),
                3 => sl_viewer_open_portal(viewer, number),
                4 => sl_viewer_open_all(viewer),
                5 => sl_viewer_close_door(viewer, number),
                6 => sl_viewer_open_door(viewer, number),
                7 => sl_viewer_close_doors_named(viewer, name),
                8 => sl_viewer_open_doors_named(viewer, name),
                9 => sl_viewer_follow_mirrors(viewer, number % 4, self.out(&mut 0)),
                10 => sl_viewer_image(viewer, number, self.out(&mut std::mem::zeroed())),
                11 => return self.list(viewer, sl_viewer_cells, 0xabcd_ef01),
                12 => return self.list(viewer, sl_viewer_objects, 0xabcd_ef01),
                13 => return self.list(viewer, sl_viewer_portals, 0xabcd_ef01),
                14 => return self.list(viewer, sl_viewer_closed_portals, 0xabcd_ef01),
                15 => return self.list_of(viewer, sl_viewer_image_mirrors, 0xabcd_ef01),
                16 => return self.list_of(viewer, sl_viewer_image_cells, 0xabcd_ef01),
                _ => return self.list_of(viewer, sl_viewer_image_objects, 0xabcd_ef01),
            }
        };
        self.heed(status);
    }
}
