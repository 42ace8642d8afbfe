#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: which files there are, and where they lie below the given folder: as below `share/` of an installation.
//! - **Out of scope**: the options themselves.

use clap_complete::Shell;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Shells, with the folder of their completions, and what stands before and after the name of a program there.
const SHELLS: [(Shell, &str, &str, &str); 3] = [
    (Shell::Bash, "bash-completion/completions", "", ""),
    (Shell::Zsh, "zsh/vendor-completions", "_", ""),
    (Shell::Fish, "fish/vendor_completions.d", "", ".fish"),
];

fn main() -> ExitCode {
    let Some(folder) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("usage: sightlines-manuals FOLDER");
        return ExitCode::from(2);
    };
    match write(&folder) {
        Ok(files) => {
            println!("{} files below {}", files.len(), folder.display());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {}: {error}", folder.display());
            ExitCode::from(2)
        }
    }
}

/// Both programs.
fn programs() -> [clap::Command; 2] {
    [sightlines_cli::command(), sightlines_cli::vis_command()]
}

/// Writes all pages and completions below `folder`, and returns their paths, sorted.
fn write(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let pages = folder.join("man/man1");
    std::fs::create_dir_all(&pages)?;
    clap_mangen::generate_to(sightlines_cli::command(), &pages)?;
    add_vis_program(&pages.join("sightlines-vis.1"))?;
    for entry in std::fs::read_dir(&pages)? {
        files.push(entry?.path());
    }
    for (shell, place, before, after) in SHELLS {
        let place = folder.join(place);
        std::fs::create_dir_all(&place)?;
        for mut program in programs() {
            let name = program.get_name().to_owned();
            let path = place.join(format!("{before}{name}{after}"));
            let mut file = std::fs::File::create(&path)?;
            clap_complete::generate(shell, &mut program, name, &mut file);
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// The page of the command `sightlines vis` has the name of that of the program `sightlines-vis`: one page has both.
fn add_vis_program(page: &Path) -> io::Result<()> {
    let manual = clap_mangen::Man::new(sightlines_cli::vis_command());
    let mut file = std::fs::OpenOptions::new().append(true).open(page)?;
    writeln!(file, ".SH THE PROGRAM SIGHTLINES\\-VIS")?;
    writeln!(file, "The rest of this page is about the program of that name. Its options may have one dash or two.")?;
    manual.render_synopsis_section(&mut file)?;
    manual.render_description_section(&mut file)?;
    manual.render_options_section(&mut file)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Long options that `--help` of a command lists.
    fn options(command: &clap::Command) -> Vec<String> {
        let shown = command.get_arguments().filter(|a| !a.is_hide_set());
        shown.filter_map(|a| a.get_long().map(str::to_owned)).collect()
    }

    /// The text of a page without the marks of its format.
    fn plain(page: &str) -> String {
        page.replace("\\-", "-")
    }

    /// The options of a command that a page lacks.
    fn lacking(command: &clap::Command, page: &str) -> Vec<String> {
        let page = plain(page);
        options(command).into_iter().filter(|option| !page.contains(&format!("--{option}"))).collect()
    }

    #[test]
    fn every_command_has_a_page_with_all_of_its_options() {
        let folder = tempfile::tempdir().expect("a folder for files");
        let files = write(folder.path()).expect("it is writable");
        let (mut n_pages, mut n_options) = (0, 0);
        for mut program in programs() {
            program.build();
            let name = program.get_name().to_owned();
            let commands = program.get_subcommands().filter(|c| c.get_name() != "help" && !c.is_hide_set());
            for (page, command) in
                commands.map(|c| (format!("{name}-{}.1", c.get_name()), c)).chain([(format!("{name}.1"), &program)])
            {
                let text = std::fs::read_to_string(folder.path().join("man/man1").join(&page)).expect("it has a page");
                assert_eq!(lacking(command, &text), [""; 0], "{page}");
                n_options += options(command).len();
                n_pages += 1;
            }
        }
        assert!(n_pages > 20 && n_options > 100, "{n_pages} pages, {n_options} options");
        assert!(files.len() >= n_pages + 2 * SHELLS.len());
    }

    #[test]
    fn impostor_a_page_without_an_option_is_caught() {
        let command = sightlines_cli::vis_command();
        let all = options(&command);
        let without = all.iter().skip(1).map(|o| format!("\\-\\-{o}\n")).collect::<String>();
        assert!(lacking(&command, &without).contains(&all[0]), "{all:?}");
    }

    #[test]
    fn completions_name_the_commands() {
        let folder = tempfile::tempdir().expect("a folder for files");
        write(folder.path()).expect("it is writable");
        for file in [
            "bash-completion/completions/sightlines",
            "zsh/vendor-completions/_sightlines",
            "fish/vendor_completions.d/sightlines.fish",
        ] {
            let text = std::fs::read_to_string(folder.path().join(file)).expect("it was written");
            assert!(["build", "vis", "verify", "demo"].iter().all(|c| text.contains(c)), "{file}");
        }
    }
}
