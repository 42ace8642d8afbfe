//! What single options take, by the definition of the program's arguments: nothing is run.

use sightlines::bake::methods::BufferOptions;
use sightlines::kdtree::SceneOptions;
use std::any::Any;
use std::time::Duration;

/// The value of an option of a command with some other arguments, or the error.
fn value<T: Any + Clone + Send + Sync>(command: &[&str], option: &str, text: &str) -> Result<T, String> {
    let line = ["sightlines"].iter().chain(command).map(|word| (*word).to_owned());
    let line = line.chain([format!("--{option}={text}")]);
    let matches = sightlines_cli::command().try_get_matches_from(line).map_err(|error| error.to_string())?;
    let (_, matches) = matches.subcommand().expect("a command");
    Ok(matches.get_one::<T>(&option.replace('-', "_")).expect("it was given").clone())
}

/// The help on an option of `build`.
fn help(option: &str) -> String {
    let command = sightlines_cli::command();
    let build = command.find_subcommand("build").expect("a command");
    let option = build.get_arguments().find(|argument| argument.get_long() == Some(option)).expect(option);
    option.get_help().expect("a help").to_string()
}

#[test]
fn the_help_names_the_defaults() {
    let BufferOptions { planes, texels, occluders, sheets, backend, .. } = BufferOptions::default();
    let defaults = [
        ("planes", planes.to_string()),
        ("texels", texels.to_string()),
        ("occluders", occluders.to_string()),
        ("sheets", sheets.to_string()),
        ("backend", backend.name().to_owned()),
        ("max-cells", SceneOptions::default().max_cells.to_string()),
    ];
    for (option, default) in defaults {
        let help = help(option);
        assert!(help.contains(&format!("[default: {default}]")), "--{option}: {help}");
    }
}

#[test]
fn eyes_and_sizes_are_parsed() {
    const LIGHT: [&str; 6] = ["light", "a.glb", "--light=0,0,0,1,1,1", "--look-at=0,0,0", "-o", "a.png"];
    let eye = |text: &str| value::<[f64; 3]>(&LIGHT, "eye", text);
    assert_eq!(eye("1, -2.5,3e2"), Ok([1.0, -2.5, 300.0]));
    for bad in ["", "1,2", "1,2,3,4", "1,2,x", "1,2,NaN", "inf,0,0", "1e300,0,0"] {
        assert!(eye(bad).is_err(), "{bad}");
    }
    let with_eye = [&LIGHT[..], &["--eye=1,1,1"]].concat();
    let size = |text: &str| value::<[u32; 2]>(&with_eye, "size", text);
    assert_eq!([size("640x480"), size("1 X 2")], [Ok([640, 480]), Ok([1, 2])]);
    for bad in ["", "640", "x", "1x", "1x2x3", "-1x2", "1.5x2", "4294967296x1"] {
        assert!(size(bad).is_err(), "{bad}");
    }
}

#[test]
fn durations_have_units() {
    let seconds = |text: &str| {
        value::<Duration>(&["build", "a.glb", "-o", "a.pvs"], "time-limit", text).map(|time| time.as_secs_f64())
    };
    let times = ["90s", "10m", "2h", "45", "0", "0.5m"].map(|text| seconds(text).expect(text));
    assert_eq!(times, [90.0, 600.0, 7200.0, 45.0, 0.0, 30.0]);
    for text in ["", "s", "-1", "1d", "1 hour", "inf", "nan", "1e30h"] {
        let error = seconds(text).expect_err(text);
        assert!(error.contains("not a duration such as 90s, 10m or 2h"), "{text}: {error}");
    }
}

#[test]
fn lenses_are_parsed() {
    const WALK: [&str; 4] = ["walk", "a.pvs", "--random", "9"];
    let fov = |text: &str| value::<f64>(&WALK, "fov", text);
    assert_eq!([fov("75"), fov("360"), fov("1e-3")], [Ok(75.0), Ok(360.0), Ok(1e-3)]);
    for bad in ["0", "-1", "360.1", "NaN", "inf", "x", ""] {
        assert!(fov(bad).is_err(), "{bad}");
    }
    let aspect = |text: &str| value::<f64>(&WALK, "aspect", text);
    assert_eq!([aspect("16/9"), aspect("1.5"), aspect(" 4 / 3 ")], [Ok(16.0 / 9.0), Ok(1.5), Ok(4.0 / 3.0)]);
    for bad in ["0", "1/0", "0/0", "-4/3", "NaN", "inf/inf", "4/3/2", "1e300/1"] {
        assert!(aspect(bad).is_err(), "{bad}");
    }
    let bounces = |text: &str| value::<usize>(&WALK, "bounces", text);
    assert!(bounces("8") == Ok(8) && bounces("9").is_err() && bounces("-1").is_err());
}
