//! The program `sightlines-vis`: what a map editor calls in the place of its `vis`.

fn main() -> std::process::ExitCode {
    sightlines_cli::sightlines_vis()
}
