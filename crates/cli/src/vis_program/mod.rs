//! The program `sightlines-vis`: what a map editor calls in the place of its `vis`.
//!
//! It takes the options of the compilers' `vis` and computes what `sightlines vis` does. What it prints goes to standard output, progress and
//! warnings to standard error, with `-log` also to a file.

mod arguments;
mod console;
mod hearing;
mod priority;

use crate::command::Answer;
use crate::commands::vis::outcome::Wishes;
use crate::commands::vis::{Beginning, Sound, VisArgs, VisRun, compute};
use crate::error::Result;
use crate::kept::Keeping;
use crate::map_portals::MADE;
use crate::output::{bytes, count};
use arguments::VisProgramArgs;
use clap::CommandFactory;
use console::{Console, Kind};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

pub(crate) fn command() -> clap::Command {
    VisProgramArgs::command()
}

/// Does what a command line asks for, which begins with the name of the program.
pub(crate) fn main(line: impl IntoIterator<Item = OsString>) -> ExitCode {
    let args = VisProgramArgs::parse(line).unwrap_or_else(|error| error.exit());
    let map = map_path(&args.map);
    let console = Console::new(&args, &map);
    let result = console.and_then(|console| {
        console.log_warnings();
        run(&args, &map, &console).inspect_err(|error| console.log_error(error))
    });
    crate::exit_code(result)
}

fn run(args: &VisProgramArgs, map: &Path, console: &Console) -> Result<Answer> {
    let start = Instant::now();
    console.say(Kind::Always, &format!("---- sightlines-vis {} ----", env!("CARGO_PKG_VERSION")))?;
    for note in args.without_effect() {
        console.say(Kind::Progress, &format!("note       {note}"))?;
    }
    if args.lowpriority
        && let Err(why) = priority::lower()
    {
        console.say(Kind::Progress, &format!("note       -lowpriority has no effect: {why}"))?;
    }
    if args.phsonly {
        hearing::renew(map, console)?;
    } else {
        see(args, map, console)?;
    }
    console.say(Kind::Always, &format!("elapsed    {}", elapsed(start.elapsed())))?;
    Ok(Answer::Yes)
}

fn see(args: &VisProgramArgs, map: &Path, console: &Console) -> Result<()> {
    let mut vis = VisArgs::of_map(map.to_owned());
    (vis.fast, vis.threads, vis.resume.save_after) = (args.fast, args.threads, args.save_after);
    vis.silence = args.silenced();
    vis.visdist = (args.visdist > 0.0 && args.visdist.is_finite()).then_some(args.visdist);
    let how = if args.fast { "a coarse bound of the visibility" } else { "the exact visibility" };
    let mut begin = |&Beginning { bsp, prt, prt_path, resumed }: &Beginning<'_>| {
        let leafs = count(bsp.n_visible_leafs() as u64, "leaf");
        let clusters = count(prt.n_clusters(), "cluster");
        let all = count(prt.n_portals() as u64, "portal");
        console.say(Kind::Progress, &format!("map        {}: {}", map.display(), bsp.format().name()))?;
        let portals =
            if prt_path == map { MADE.to_owned() } else { format!("{}: {}", prt_path.display(), prt.dialect()) };
        console.say(Kind::Progress, &format!("portals    {portals}"))?;
        console.say(Kind::Statistics, &format!("counts     {leafs}, {clusters}, {all}"))?;
        if resumed {
            console.say(Kind::Progress, "resumed    from where an earlier run was stopped")?;
        }
        console.say(Kind::Progress, &format!("computing  {how}"))
    };
    let run = VisRun {
        show_progress: !(args.quiet || args.nopercent || args.noprogress),
        keeping: if args.nostate { Keeping::Nowhere } else { Keeping::FileIfItFits(&vis.resume) },
        keep_after: args.noautoclean,
        begin: &mut begin,
    };
    let outcome = compute(&vis, run)?;
    console.say(Kind::Statistics, &format!("pairs      {}", outcome.clusters.brief_pairs()))?;
    for line in outcome.wishes.iter().flat_map(Wishes::lines) {
        console.say(Kind::Always, &format!("wishes     {line}"))?;
    }
    if args.verbose {
        console.say(Kind::Statistics, outcome.clusters.to_string().trim_end())?;
        let pairs = outcome.clusters.undecided_pairs().to_string();
        pairs.lines().try_for_each(|line| console.say(Kind::Statistics, line))?;
    }
    console.say(Kind::Always, &format!("wrote      {}, {}", map.display(), bytes(outcome.n_bytes as u64)))
}

/// The map that a name stands for: editors name the source of the map, or leave the extension out.
fn map_path(name: &Path) -> PathBuf {
    let is_of_map = |extension: &str| ["map", "prt"].iter().any(|e| extension.eq_ignore_ascii_case(e));
    match name.extension().map(|extension| extension.to_string_lossy()) {
        Some(extension) if is_of_map(&extension) => name.with_extension("bsp"),
        Some(extension) if extension.eq_ignore_ascii_case("bsp") || name.is_file() => name.to_owned(),
        // A name with a dot in it, such as map.v2, has no extension for that.
        _ => {
            let mut longer = name.as_os_str().to_owned();
            longer.push(".bsp");
            longer.into()
        }
    }
}

/// A time as compilers print it, with minutes and hours where there are some.
fn elapsed(time: Duration) -> String {
    match time.as_secs() {
        0..60 => crate::output::seconds(time),
        s @ 60..3600 => format!("{} min {} s", s / 60, s % 60),
        s => format!("{} h {} min {} s", s / 3600, s / 60 % 60, s % 60),
    }
}

impl VisProgramArgs {
    fn silenced(&self) -> Vec<Sound> {
        let off = |sound: &Sound| {
            self.noambient
                || match sound {
                    Sound::Sky => self.noambientsky,
                    Sound::Water => self.noambientwater,
                    Sound::Slime => self.noambientslime,
                    Sound::Lava => self.noambientlava,
                }
        };
        Sound::ALL.into_iter().filter(off).collect()
    }

    fn without_effect(&self) -> Vec<&'static str> {
        let given = [
            (self.targetchecks.is_some(), "-targetchecks has no effect: it belongs to another method"),
            (self.gamedir.is_some(), "-gamedir has no effect: no file of the game is needed"),
            (self.basedir.is_some(), "-basedir has no effect: no file of the game is needed"),
            (!self.path.is_empty(), "-path has no effect: no file of the game is needed"),
            (self.filepriority.is_some(), "-filepriority has no effect: no file of the game is needed"),
            (self.defaultpaths, "-defaultpaths has no effect: no file of the game is needed"),
            (self.q2rtx, "-q2rtx has no effect"),
            (self.estimate, "-estimate has no effect"),
            (self.high, "-high has no effect"),
            (self.chart, "-chart has no effect"),
            (self.noinfo, "-noinfo has no effect"),
            (self.nofixprt, "-nofixprt has no effect: portal files stay as they are"),
        ];
        given.into_iter().filter(|(is_given, _)| *is_given).map(|(_, note)| note).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_for_maps() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("odd.dat"), "").unwrap();
        for (name, map) in [
            ("e1m1.bsp", "e1m1.bsp"),
            ("E1M1.BSP", "E1M1.BSP"),
            ("e1m1.map", "e1m1.bsp"),
            ("e1m1.MAP", "e1m1.bsp"),
            ("e1m1.prt", "e1m1.bsp"),
            ("e1m1", "e1m1.bsp"),
            ("my map.v2", "my map.v2.bsp"),
            ("my map.v2.map", "my map.v2.bsp"),
            ("odd.dat", "odd.dat"),
        ] {
            assert_eq!(map_path(&folder.path().join(name)), folder.path().join(map), "{name}");
        }
    }

    #[test]
    fn times_have_minutes_and_hours() {
        let text = |s: f64| elapsed(Duration::from_secs_f64(s));
        assert_eq!([text(1.5), text(59.9), text(61.0)], ["1.50 s", "59.90 s", "1 min 1 s"]);
        assert_eq!([text(3600.0), text(7384.0)], ["1 h 0 min 0 s", "2 h 3 min 4 s"]);
    }
}
