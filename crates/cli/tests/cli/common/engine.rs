//! DarkPlaces, a Quake engine, as a server without a screen that is asked which points of a map see each other.
//!
//! The engine's own code loads the map and decides. What asks it is a game of the smallest kind, assembled here: when the map is there, it asks for each pair
//! of points whether the one is in the visible set of the other (`checkpvs`), prints the answers and quits.

use crate::common::Folder;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The name of the program and of the package in Debian.
const SERVER: &str = "darkplaces-server";

/// What the engine made of a map.
pub(crate) struct Loaded {
    /// Row `a` has what is seen from point `a`.
    pub(crate) seen: Vec<Vec<bool>>,
    /// What it complained about in the visibility.
    pub(crate) complaints: Vec<String>,
    /// All that it printed.
    pub(crate) text: String,
}

/// The program, if it is installed; Debian has it where only games are looked for.
pub(crate) fn server() -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::env::split_paths(&path).chain([PathBuf::from("/usr/games")]);
    folders.map(|folder| folder.join(SERVER)).find(|path| path.is_file())
}

/// Lets the engine load a map, and asks it about all pairs of points.
pub(crate) fn load(server: &PathBuf, map: &[u8], points: &[[f32; 3]]) -> Loaded {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.path("base/id1/maps")).expect("a folder");
    folder.write("base/id1/maps/map.bsp", map);
    folder.write("base/id1/progs.dat", game(points));
    let out = std::fs::File::create(folder.path("out")).expect("a file");
    let mut child = Command::new(server)
        .args(["-basedir", "base", "-nohome", "-port", "26998", "+developer", "1", "+map", "map"])
        .current_dir(folder.path("."))
        .env("HOME", folder.path("."))
        .stdin(Stdio::null())
        .stderr(out.try_clone().expect("a second handle"))
        .stdout(out)
        .spawn()
        .expect("the engine starts");
    let start = Instant::now();
    while child.try_wait().expect("a child").is_none() {
        if start.elapsed() > Duration::from_secs(60) {
            child.kill().expect("a child can be killed");
            panic!("the engine did not quit: {}", String::from_utf8_lossy(&folder.read("out")));
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let text = String::from_utf8_lossy(&folder.read("out")).into_owned();
    let rows = text.lines().filter_map(|line| line.strip_prefix(ROW));
    let seen = rows.map(|row| row.chars().map(|answer| answer == '1').collect()).collect();
    let is_complaint =
        |line: &&str| ["DecompressVis", "visofs", "corrupt", "Host_Error"].iter().any(|word| line.contains(word));
    let complaints = text.lines().filter(is_complaint).map(str::to_owned).collect();
    Loaded { seen, complaints, text }
}

/// What a line of answers begins with.
const ROW: &str = "row ";

/// Numbers of instructions of the virtual machine of games.
mod op {
    pub(super) const DONE: u16 = 0;
    pub(super) const ADDRESS: u16 = 30;
    pub(super) const STORE_V: u16 = 32;
    pub(super) const STORE: u16 = 33;
    pub(super) const STORE_ENT: u16 = 34;
    pub(super) const STOREP_V: u16 = 38;
    pub(super) const IFNOT: u16 = 50;
    pub(super) const CALL0: u16 = 51;
    pub(super) const CALL1: u16 = 52;
    pub(super) const CALL2: u16 = 53;
    pub(super) const GOTO: u16 = 61;
}

/// Places of variables: of what a function returns, of its first two arguments, and of the first that is no one else's.
const RETURNED: u16 = 1;
const FIRST: u16 = 4;
const SECOND: u16 = 7;
const OWN: usize = 92;

/// The variables that the engine shares with a game, by type (1 text, 2 number, 3 vector, 4 thing) and place.
const SHARED: [(&str, u16, u16); 38] = [
    ("self", 4, 28),
    ("other", 4, 29),
    ("world", 4, 30),
    ("time", 2, 31),
    ("frametime", 2, 32),
    ("force_retouch", 2, 33),
    ("mapname", 1, 34),
    ("deathmatch", 2, 35),
    ("coop", 2, 36),
    ("teamplay", 2, 37),
    ("serverflags", 2, 38),
    ("total_secrets", 2, 39),
    ("total_monsters", 2, 40),
    ("found_secrets", 2, 41),
    ("killed_monsters", 2, 42),
    ("parm1", 2, 43),
    ("parm2", 2, 44),
    ("parm3", 2, 45),
    ("parm4", 2, 46),
    ("parm5", 2, 47),
    ("parm6", 2, 48),
    ("parm7", 2, 49),
    ("parm8", 2, 50),
    ("parm9", 2, 51),
    ("parm10", 2, 52),
    ("v_forward", 3, 59),
    ("v_up", 3, 62),
    ("v_right", 3, 65),
    ("trace_allsolid", 2, 68),
    ("trace_startsolid", 2, 69),
    ("trace_fraction", 2, 70),
    ("trace_endpos", 3, 71),
    ("trace_plane_normal", 3, 74),
    ("trace_plane_dist", 2, 77),
    ("trace_ent", 4, 78),
    ("trace_inopen", 2, 79),
    ("trace_inwater", 2, 80),
    ("msg_entity", 4, 81),
];

/// Functions that the engine calls, in the last places of those that it shares.
const CALLED: [&str; 10] = [
    "main",
    "StartFrame",
    "PlayerPreThink",
    "PlayerPostThink",
    "ClientKill",
    "ClientConnect",
    "PutClientInServer",
    "ClientDisconnect",
    "SetNewParms",
    "SetChangeParms",
];

/// A game under construction.
struct Game {
    texts: Vec<u8>,
    globals: Vec<i32>,
    statements: Vec<[u16; 4]>,
    /// First statement, or minus the number of a function of the engine; name.
    functions: Vec<[i32; 2]>,
}

impl Game {
    fn text(&mut self, text: &str) -> i32 {
        let at = self.texts.len() as i32;
        self.texts.extend(text.bytes().chain([0]));
        at
    }

    /// A variable of its own, and its place.
    fn global(&mut self, value: i32) -> u16 {
        self.globals.push(value);
        u16::try_from(self.globals.len() - 1).expect("few variables")
    }

    fn vector(&mut self, point: [f32; 3]) -> u16 {
        let at = point.map(|x| self.global(x.to_bits().cast_signed()));
        at[0]
    }

    fn text_variable(&mut self, text: &str) -> u16 {
        let text = self.text(text);
        self.global(text)
    }

    /// A function; its number.
    fn function(&mut self, name: &str, first: i32) -> i32 {
        let name = self.text(name);
        self.functions.push([first, name]);
        self.functions.len() as i32 - 1
    }

    /// A variable with a function of the engine.
    fn builtin(&mut self, name: &str, number: i32) -> u16 {
        let function = self.function(name, -number);
        self.global(function)
    }

    fn here(&self) -> i32 {
        self.statements.len() as i32
    }

    fn call_with(&mut self, function: u16, argument: u16) {
        self.statements.extend([[op::STORE, argument, FIRST, 0], [op::CALL1, function, 0, 0]]);
    }

    /// The file: a head of 15 numbers, then statements, names of variables and of fields, functions, texts, values.
    fn bytes(mut self, fields: &[(&str, u16, u16)]) -> Vec<u8> {
        let named = |game: &mut Self, list: &[(&str, u16, u16)]| -> Vec<u8> {
            let mut bytes = Vec::new();
            for &(name, kind, at) in list {
                let text = game.text(name).to_le_bytes();
                bytes.extend([&kind.to_le_bytes()[..], &at.to_le_bytes(), &text].concat());
            }
            bytes
        };
        let (globals, own_fields) = (named(&mut self, &SHARED), named(&mut self, fields));
        let statements: Vec<u8> = self.statements.iter().flatten().flat_map(|word| word.to_le_bytes()).collect();
        // First statement; place, number and time of its variables; name, file; number and sizes of arguments.
        let function = |&[first, name]: &[i32; 2]| [first, 0, 0, 0, name, 0, 0, 0, 0];
        let functions: Vec<u8> = self.functions.iter().flat_map(function).flat_map(i32::to_le_bytes).collect();
        let values: Vec<u8> = self.globals.iter().flat_map(|value| value.to_le_bytes()).collect();
        // The version, and the checksum of the variables that are shared.
        let mut head: Vec<i32> = vec![6, 5927];
        let mut body = Vec::new();
        for (bytes, record) in
            [(&statements, 8), (&globals, 8), (&own_fields, 8), (&functions, 36), (&self.texts, 1), (&values, 4)]
        {
            body.resize(body.len().next_multiple_of(4), 0);
            head.extend([60 + body.len() as i32, (bytes.len() / record) as i32]);
            body.extend(bytes);
        }
        head.push(105);
        head.into_iter().flat_map(i32::to_le_bytes).chain(body).collect()
    }
}

/// The game that asks about all pairs of points.
fn game(points: &[[f32; 3]]) -> Vec<u8> {
    let mut game = Game { texts: vec![0], globals: vec![0; OWN], statements: vec![[0; 4]; 2], functions: vec![[0; 2]] };
    for (place, name) in (OWN - CALLED.len()..).zip(CALLED) {
        game.globals[place] = game.function(name, 1);
    }
    let [spawn, dprint, localcmd, checkpvs] =
        [("spawn", 14), ("dprint", 25), ("localcmd", 46), ("checkpvs", 240)].map(|(name, n)| game.builtin(name, n));
    // The lowest and the highest corner of a thing, as fields.
    let [low, high] = [1, 4].map(|field| game.global(field));
    let [thing, pointer] = [0, 0].map(|nothing| game.global(nothing));
    let eye = game.vector([0.0; 3]);
    let [yes, no, end, row_text, quit] = ["1", "0", "\n", ROW, "quit\n"].map(|text| game.text_variable(text));
    let places: Vec<u16> = points.iter().map(|&point| game.vector(point)).collect();

    let row = game.here();
    game.call_with(dprint, row_text);
    for &place in &places {
        for corner in [low, high] {
            game.statements.extend([[op::ADDRESS, thing, corner, pointer], [op::STOREP_V, place, pointer, 0]]);
        }
        game.statements.extend([
            [op::STORE_V, eye, FIRST, 0],
            [op::STORE_ENT, thing, SECOND, 0],
            [op::CALL2, checkpvs, 0, 0],
            [op::IFNOT, RETURNED, 3, 0],
            [op::STORE, yes, FIRST, 0],
            [op::GOTO, 2, 0, 0],
            [op::STORE, no, FIRST, 0],
            [op::CALL1, dprint, 0, 0],
        ]);
    }
    game.call_with(dprint, end);
    game.statements.push([op::DONE, 0, 0, 0]);
    let row = game.function("row", row);
    let row = game.global(row);

    let ask = game.here();
    game.statements.extend([[op::CALL0, spawn, 0, 0], [op::STORE_ENT, RETURNED, thing, 0]]);
    for &place in &places {
        game.statements.extend([[op::STORE_V, place, eye, 0], [op::CALL0, row, 0, 0]]);
    }
    game.call_with(localcmd, quit);
    game.statements.push([op::DONE, 0, 0, 0]);
    game.function("worldspawn", ask);
    game.bytes(&[("classname", 1, 28), ("absmin", 3, 1), ("absmax", 3, 4)])
}
