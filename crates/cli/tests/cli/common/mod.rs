//! Runs the built program on generated files.

#[path = "../../../../formats/tests/formats/common/dxf.rs"]
pub(crate) mod dxf;
pub(crate) mod engine;
pub(crate) mod levels;
pub(crate) mod looks;
pub(crate) mod picture;
pub(crate) mod quake;
#[path = "../../../../formats/tests/formats/common/udmf.rs"]
pub(crate) mod udmf;

use sightlines::formats::doom::{DoomMapSource, ML_TWOSIDED, SourceLine};
use sightlines::formats::geojson;
use sightlines::formats::scene::write_glb;
use sightlines::formats::wad::{LumpName, WadBuilder, WadKind};
use sightlines::scenes::{DoomLike, OfficeOptions, TowerOptions, maze, office, tower};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

/// The environment variable with the time between two lines of progress.
pub(crate) const PROGRESS: &str = "SIGHTLINES_PROGRESS_SECONDS";

/// What a run of the program gave.
pub(crate) struct Run {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Run {
    /// The output, of a run that must have ended with `code`.
    pub(crate) fn expect(self, code: i32) -> Self {
        assert_eq!(self.code, code, "stdout: {}\nstderr: {}", self.out, self.err);
        self
    }

    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error} in {}", self.out))
    }
}

/// A folder of its own for each test, removed afterwards.
pub(crate) struct Folder(tempfile::TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder for temporary files"))
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        std::fs::write(self.path(name), bytes).expect("the folder can be written");
        self.path(name)
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The names in the folder, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        names(self.0.path())
    }

    /// Runs the program in this folder: the one that was built with the tests, or the one that `SIGHTLINES_PROGRAM` names.
    pub(crate) fn run(&self, args: &[&str]) -> Run {
        let program = std::env::var_os("SIGHTLINES_PROGRAM").unwrap_or_else(|| env!("CARGO_BIN_EXE_sightlines").into());
        self.run_command(Command::new(program).args(args))
    }

    /// Runs `sightlines-vis` in this folder.
    pub(crate) fn run_vis(&self, args: &[&str]) -> Run {
        self.run_command(Command::new(env!("CARGO_BIN_EXE_sightlines-vis")).args(args))
    }

    /// Runs a command in this folder.
    pub(crate) fn run_command(&self, command: &mut Command) -> Run {
        // However slow a machine is, no line of progress is among what is compared, unless a test asks for it.
        if command.get_envs().all(|(name, _)| name != PROGRESS) {
            command.env(PROGRESS, "1h");
        }
        let args: Vec<_> = command.get_args().map(ToOwned::to_owned).collect();
        let Output { status, stdout, stderr } =
            command.current_dir(self.0.path()).output().expect("the program is there");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("output is text");
        let code = status.code().expect("the program ends by itself");
        let run = Run { code, out: text(stdout), err: text(stderr) };
        assert!(!run.err.contains("panicked"), "{args:?}: {}", run.err);
        run
    }

    /// A run that must fail as bad input: exit code 2, nothing on standard output, one line of error.
    pub(crate) fn refused(&self, args: &[&str]) -> String {
        let run = self.run(args).expect(2);
        assert_eq!((run.out.as_str(), run.err.lines().count()), ("", 1), "{args:?}: {}", run.err);
        assert!(run.err.starts_with("error: "), "{args:?}: {}", run.err);
        run.err.trim_end().trim_start_matches("error: ").to_owned()
    }

    /// `office.geojson` and its table `office.pvs`.
    pub(crate) fn with_office() -> Self {
        static FILES: LazyLock<Files> = LazyLock::new(|| {
            let folder = Folder::new();
            let plan = office(OfficeOptions { rooms_x: 6, rooms_y: 3, ..OfficeOptions::default() }).expect("an office");
            folder.write("office.geojson", geojson::write_plan(&plan));
            folder.run(&["build", "office.geojson", "-o", "office.pvs"]).expect(0);
            bytes(&folder, ".")
        });
        Self::with(&FILES)
    }

    /// `tower.glb`, a small tower, and its table `tower.pvs`.
    pub(crate) fn with_tower() -> Self {
        static FILES: LazyLock<Files> = LazyLock::new(|| {
            let folder = Folder::new();
            folder.write("tower.glb", small_tower());
            folder.run(&["build", "tower.glb", "-o", "tower.pvs"]).expect(0);
            bytes(&folder, ".")
        });
        Self::with(&FILES)
    }

    /// As [`Self::with_tower`], of a tower with a quarter of the triangles: one room, without furniture.
    pub(crate) fn with_bare_tower() -> Self {
        static FILES: LazyLock<Files> = LazyLock::new(|| {
            let folder = Folder::new();
            folder.write("tower.glb", one_floor(1, 0));
            folder.run(&["build", "tower.glb", "-o", "tower.pvs"]).expect(0);
            bytes(&folder, ".")
        });
        Self::with(&FILES)
    }

    /// Files that were made once for all tests.
    fn with(files: &[(String, Vec<u8>)]) -> Self {
        let folder = Self::new();
        folder.write_all(".", files);
        folder
    }

    /// Writes files into a folder in this one.
    pub(crate) fn write_all(&self, to: &str, files: &[(String, Vec<u8>)]) {
        std::fs::create_dir_all(self.path(to)).expect("the folder can be written");
        for (name, bytes) in files {
            self.write(&format!("{to}/{name}"), bytes);
        }
    }

    /// `maps.wad` with maps MAP01 to MAP03 between other lumps; MAP02 has a REJECT lump made by hand.
    pub(crate) fn with_wad() -> Self {
        let folder = Self::new();
        folder.write("maps.wad", wad(&["MAP01", "MAP02", "MAP03"]));
        folder
    }
}

pub(crate) fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|e| e.expect("an entry").file_name().into_string().expect("a plain name")).collect();
    names.sort();
    names
}

/// What `demo` prints with `--json` and writes.
pub(crate) static DEMO: LazyLock<(Run, Files)> = LazyLock::new(|| demo(&["demo", "--out", "demo", "--json"]));

/// What `demo tower` prints and writes: as text, and in another run with `--json`.
pub(crate) static DEMO_TOWER: LazyLock<[(Run, Files); 2]> =
    LazyLock::new(|| [&[][..], &["--json"]].map(|more| demo(&[&["demo", "tower", "--out", "demo"], more].concat())));

fn demo(args: &[&str]) -> (Run, Files) {
    let folder = Folder::new();
    let run = folder.run(args).expect(0);
    (run, bytes(&folder, "demo"))
}

/// Names and bytes of files.
pub(crate) type Files = Vec<(String, Vec<u8>)>;

/// A tower of one floor with two rooms side by side, furnished, as `generate tower` writes it.
pub(crate) fn small_tower() -> Vec<u8> {
    one_floor(2, 1)
}

/// A tower of one floor with so many rooms side by side, at this level of furniture.
pub(crate) fn one_floor(rooms_x: u32, furniture: u32) -> Vec<u8> {
    let options = TowerOptions { floors: 1, rooms_x, rooms_y: 1, furniture, ..TowerOptions::default() };
    write_glb(&tower(options).expect("a small tower")).expect("single precision")
}

/// The names and bytes of all files of an output, which may be a folder; a file has no name.
pub(crate) fn bytes(folder: &Folder, out: &str) -> Files {
    let path = folder.path(out);
    if !path.is_dir() {
        return vec![(String::new(), folder.read(out))];
    }
    names(&path).into_iter().map(|name| (name.clone(), folder.read(&format!("{out}/{name}")))).collect()
}

/// A WAD of the maps of these names, with a lump before and one after. The map MAP02, if there is one, has
/// a REJECT lump that blinds sector 0.
pub(crate) fn wad(maps: &[&str]) -> Vec<u8> {
    let mut builder = WadBuilder::new(WadKind::Patch);
    builder.lump("BEFORE", b"some bytes").expect("a short name");
    for (seed, name) in (1u64..).zip(maps) {
        let mut map = doom_map(seed);
        if *name == "MAP02" {
            let n = usize::from(map.n_sectors);
            let mut reject = vec![0; (n * n).div_ceil(8)];
            reject[0] = 1;
            map.reject = Some(reject);
        }
        map.add_to(&mut builder, LumpName::new(name).expect("a short name")).expect("a small map");
    }
    builder.lump("AFTER", b"more bytes").expect("a short name");
    builder.finish().expect("a small file")
}

/// A generated map as it would be written, without a REJECT lump.
pub(crate) fn doom_map(seed: u64) -> DoomMapSource {
    let generated = DoomLike::generate(seed, 3).expect("a small map");
    let line = |l: &sightlines::scenes::DoomLikeLine| SourceLine {
        v1: l.start,
        v2: l.end,
        flags: if l.left.is_some() { ML_TWOSIDED } else { 1 },
        right: Some(l.right),
        left: l.left,
    };
    DoomMapSource {
        lines: generated.lines.iter().map(line).collect(),
        vertices: generated.vertices,
        n_sectors: generated.n_sectors,
        things: Vec::new(),
        reject: None,
        hexen: false,
    }
}

/// A maze as GeoJSON.
pub(crate) fn maze_text(seed: u64) -> String {
    geojson::write_plan(&maze(seed, 6, 5).expect("a maze"))
}
