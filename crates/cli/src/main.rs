//! The program `sightlines`: visibility tables from a shell.

fn main() -> std::process::ExitCode {
    sightlines_cli::sightlines()
}
