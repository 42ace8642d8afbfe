//! The arguments of `sightlines-vis`: those of the compilers' `vis`, which have any number of dashes.

use crate::error::Result;
use clap::error::ErrorKind;
use clap::{ArgAction, CommandFactory, FromArgMatches, Parser};
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;

/// Computes the visibility of a Quake or Quake II map, exactly, in the place of a map editor's `vis`
#[derive(Debug, Parser)]
#[command(name = "sightlines-vis", version, long_about = None, disable_help_flag = true, disable_version_flag = true)]
#[command(args_override_self = true)]
#[command(
    after_help = "Options may have one dash: -level 4. A 0 behind one that takes no value turns it off: -lowpriority 0.\n\
                        Exit codes: 0 success; 2 bad input or usage."
)]
pub(super) struct VisProgramArgs {
    /// The map, MAP.bsp; MAP.map and MAP without extension stand for it. Its portal file MAP.prt is beside it
    #[arg(value_name = "MAP")]
    pub(super) map: PathBuf,

    /// Compute only a coarse bound; fast, and reports much that is hidden as visible
    #[arg(long, help_heading = "Method", overrides_with = "full")]
    pub(super) fast: bool,
    /// Compute the exact answer, as without this option
    #[arg(long, help_heading = "Method", overrides_with = "fast")]
    pub(super) full: bool,
    /// Test level; all give the same, exact answer
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 4)]
    pub(super) level: i64,
    /// Hide leafs that are farther from each other than N, though they see each other; 0 hides none
    #[arg(
        long,
        help_heading = "Method",
        value_name = "N",
        visible_alias = "maxdistance",
        allow_hyphen_values = true,
        default_value_t = 0.0
    )]
    pub(super) visdist: f64,
    /// Number of threads; 0 uses every core
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 0, value_parser = crate::numbers::threads)]
    pub(super) threads: usize,
    /// Run at low priority, so that other programs stay responsive
    #[arg(long, help_heading = "Method", visible_alias = "low")]
    pub(super) lowpriority: bool,
    /// Compute only what is heard, from the visibility that the map has, and leave that as it is; of Quake II maps
    #[arg(long, help_heading = "Method")]
    pub(super) phsonly: bool,

    /// Neither go on from an interrupted run nor keep results of this one
    #[arg(long, help_heading = "Resuming")]
    pub(super) nostate: bool,
    /// Keep the results after the end, in MAP.bsp.state
    #[arg(long, help_heading = "Resuming", overrides_with = "autoclean")]
    pub(super) noautoclean: bool,
    /// Remove the results at the end, as without this option
    #[arg(long, help_heading = "Resuming", overrides_with = "noautoclean")]
    pub(super) autoclean: bool,
    /// Seconds after which the file of results is made; a run that is over sooner leaves none
    #[arg(long, help_heading = "Resuming", hide = true, value_name = "SECONDS", default_value_t = crate::kept::SAVE_AFTER)]
    pub(super) save_after: u64,

    /// Make no part of the map sound of wind, water, slime or lava nearby
    #[arg(long, help_heading = "Ambient sounds")]
    pub(super) noambient: bool,
    /// Make no part of the map sound of wind
    #[arg(long, help_heading = "Ambient sounds")]
    pub(super) noambientsky: bool,
    /// Make no part of the map sound of water
    #[arg(long, help_heading = "Ambient sounds")]
    pub(super) noambientwater: bool,
    /// Make no part of the map sound of slime
    #[arg(long, help_heading = "Ambient sounds")]
    pub(super) noambientslime: bool,
    /// Make no part of the map sound of lava
    #[arg(long, help_heading = "Ambient sounds")]
    pub(super) noambientlava: bool,

    /// Print more
    #[arg(long, help_heading = "Messages", visible_aliases = ["v", "vv"])]
    pub(super) verbose: bool,
    /// Print less: as -nopercent -nostat -noprogress
    #[arg(long, help_heading = "Messages", visible_alias = "noverbose")]
    pub(super) quiet: bool,
    /// Print no share of what is done
    #[arg(long, help_heading = "Messages")]
    pub(super) nopercent: bool,
    /// Print no numbers about the map
    #[arg(long, help_heading = "Messages")]
    pub(super) nostat: bool,
    /// Print nothing about what is going on
    #[arg(long, help_heading = "Messages")]
    pub(super) noprogress: bool,
    /// Print no colours; there are some only in terminals
    #[arg(long, help_heading = "Messages")]
    pub(super) nocolor: bool,
    /// Write what is printed to MAP-vis.log too
    #[arg(long, help_heading = "Messages", overrides_with = "nolog")]
    pub(super) log: bool,
    /// Write no log, as without this option
    #[arg(long, help_heading = "Messages", overrides_with = "log")]
    pub(super) nolog: bool,

    /// No effect: belongs to another method
    #[arg(long, help_heading = "Without effect", value_name = "N")]
    pub(super) targetchecks: Option<OsString>,
    /// No effect: no file of the game is needed
    #[arg(long, help_heading = "Without effect", value_name = "FOLDER")]
    pub(super) gamedir: Option<OsString>,
    /// No effect: no file of the game is needed
    #[arg(long, help_heading = "Without effect", value_name = "FOLDER")]
    pub(super) basedir: Option<OsString>,
    /// No effect: no file of the game is needed
    #[arg(long, help_heading = "Without effect", value_name = "FOLDER", action = ArgAction::Append)]
    pub(super) path: Vec<OsString>,
    /// No effect: no file of the game is needed
    #[arg(long, help_heading = "Without effect", value_name = "KIND")]
    pub(super) filepriority: Option<OsString>,
    /// No effect: no file of the game is needed
    #[arg(long, help_heading = "Without effect", visible_alias = "nodefaultpaths")]
    pub(super) defaultpaths: bool,

    /// No effect: belongs to a game
    #[arg(long, help_heading = "Without effect")]
    pub(super) q2rtx: bool,
    /// No effect, as the following of Half-Life's compilers: how long a run takes is printed where there is something to wait for
    #[arg(long, help_heading = "Without effect", visible_alias = "noestimate")]
    pub(super) estimate: bool,
    /// No effect: nothing takes the priority of other programs
    #[arg(long, help_heading = "Without effect", visible_alias = "normal")]
    pub(super) high: bool,
    /// No effect: there are no limits to report
    #[arg(long, help_heading = "Without effect")]
    pub(super) chart: bool,
    /// No effect: settings are not printed
    #[arg(long, help_heading = "Without effect")]
    pub(super) noinfo: bool,
    /// No effect: portal files stay as they are
    #[arg(long, help_heading = "Without effect")]
    pub(super) nofixprt: bool,

    /// Print help; -h prints a summary
    #[arg(long, help_heading = "General", visible_alias = "h", alias = "?", action = ArgAction::Help)]
    help: Option<bool>,
    /// Print version
    #[arg(long, help_heading = "General", action = ArgAction::Version)]
    version: Option<bool>,
}

impl VisProgramArgs {
    /// The arguments of a command line, which begins with the name of the program.
    pub(super) fn parse(line: impl IntoIterator<Item = OsString>) -> Result<Self, clap::Error> {
        let mut command = Self::command();
        command.build();
        match with_two_dashes(&command, line) {
            Ok(line) => Self::from_arg_matches(&command.try_get_matches_from(line)?),
            Err(option) => Err(command.error(ErrorKind::UnknownArgument, format!("there is no option {option}"))),
        }
    }
}

/// A command line with options as `clap` takes them: with two dashes, in small letters, joined with their values; flags that a 0 turns off are
/// left out. Fails with an option that there is not, as it was given.
fn with_two_dashes(command: &clap::Command, line: impl IntoIterator<Item = OsString>) -> Result<Vec<OsString>, String> {
    let mut line = line.into_iter();
    let mut found: Vec<OsString> = line.next().into_iter().collect();
    let mut line = line.peekable();
    while let Some(argument) = line.next() {
        let Some(name) = option_name(&argument) else {
            found.push(argument);
            continue;
        };
        let (name, value) = match name.split_once('=') {
            Some((name, value)) => (name.to_ascii_lowercase(), Some(OsString::from(value))),
            None => (name.to_ascii_lowercase(), None),
        };
        let known = command.get_arguments().find(|known| is_named(known, &name));
        let takes_value = known.ok_or_else(|| argument.to_string_lossy().into_owned())?.get_action().takes_values();
        let is_switch = |value: &OsStr| SWITCHES.iter().any(|switch| value == *switch);
        let value = match value {
            None if takes_value => line.next(),
            None => line.next_if(|next| is_switch(next)),
            value => value,
        };
        let mut option = OsString::from(format!("--{name}"));
        match value {
            Some(value) if !takes_value && value == OFF => match INVERSES.iter().find(|(flag, _)| *flag == name) {
                Some((_, inverse)) => option = OsString::from(format!("--{inverse}")),
                None => continue,
            },
            Some(value) if takes_value || !is_switch(&value) => {
                option.push("=");
                option.push(value);
            }
            _ => {}
        }
        found.push(option);
    }
    Ok(found)
}

/// What may be behind a flag, and turns it on or off.
const SWITCHES: [&str; 3] = [OFF, "1", "-1"];
const OFF: &str = "0";
/// Flags that say what holds without them; turned off, they are these.
const INVERSES: [(&str, &str); 2] = [("autoclean", "noautoclean"), ("nolog", "log")];

/// What is behind the dashes of an option.
fn option_name(argument: &OsStr) -> Option<&str> {
    let name = argument.to_str()?.strip_prefix('-')?.trim_start_matches('-');
    (!name.is_empty()).then_some(name)
}

fn is_named(known: &clap::Arg, name: &str) -> bool {
    known.get_long() == Some(name) || known.get_all_aliases().is_some_and(|all| all.contains(&name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Result<VisProgramArgs, String> {
        let line = ["sightlines-vis"].into_iter().chain(line.split_whitespace()).map(OsString::from);
        VisProgramArgs::parse(line).map_err(|error| error.to_string())
    }

    #[test]
    fn options_have_any_number_of_dashes() {
        for dashes in ["-", "--", "---", "-----"] {
            let args = parse(&format!("{dashes}level 2 {dashes}Threads 3 {dashes}v {dashes}noambientsky e1m1.map"))
                .expect(dashes);
            assert_eq!(
                (args.level, args.threads, args.verbose, args.noambientsky, args.fast),
                (2, 3, true, true, false)
            );
            assert_eq!(args.map, PathBuf::from("e1m1.map"));
        }
        assert_eq!(parse("-level=3 a").unwrap().level, 3);
        assert_eq!(parse("a -level 1 -level 2").unwrap().level, 2);
    }

    #[test]
    fn values_may_have_dashes_and_flags_a_number() {
        assert_eq!(parse("-visdist -5 a").unwrap().visdist, -5.0);
        assert_eq!(parse("-path -log -path b a").unwrap().path, ["-log", "b"]);
        let flags = ["", " 1", " -1", " 0"].map(|value| parse(&format!("-lowpriority{value} a")).unwrap().lowpriority);
        assert_eq!(flags, [true, true, true, false]);
        let cleans = |line: &str| !parse(line).unwrap().noautoclean;
        let all =
            ["a", "-autoclean a", "-autoclean 0 a", "-noautoclean a", "-noautoclean 0 a", "-noautoclean -autoclean a"];
        assert_eq!(all.map(cleans), [true, true, false, false, true, true]);
        assert!(parse("-nolog 0 a").unwrap().log && parse("-vv -level 5 a").unwrap().verbose);
        // The last of two that contradict each other counts.
        let fast = |line: &str| parse(line).map(|args| (args.fast, args.full)).unwrap();
        assert_eq!([fast("-fast -full a"), fast("-full -fast a")], [(false, true), (true, false)]);
    }

    #[test]
    fn what_is_unknown_or_missing_is_refused() {
        for (line, what) in [
            ("-nosuch a", "error: there is no option -nosuch\n"),
            ("a ---NoSuch=3", "error: there is no option ---NoSuch=3\n"),
            ("-level x a", "invalid value 'x' for '--level <N>'"),
            ("-threads many a", "invalid value 'many' for '--threads <N>'"),
            ("a -level", "a value is required for '--level <N>'"),
            ("-fast=2 a", "unexpected value '2' for '--fast'"),
            ("a b", "unexpected argument 'b'"),
            ("-fast", "<MAP>"),
        ] {
            let error = parse(line).expect_err(line);
            assert!(error.contains(what), "{line}: {error}");
        }
    }

    #[test]
    fn the_definition_is_sound() {
        VisProgramArgs::command().debug_assert();
    }
}
