//! Programs in C and C++ against the static library, under the sanitizers of the compiler and under valgrind.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The static library that was built with this test.
fn library() -> PathBuf {
    let own = std::env::current_exe().expect("a test is a program");
    let deps = own.parent().expect("in a folder");
    let name = "libsightlines_capi.a";
    let found = [deps.join(name), deps.join("..").join(name)].into_iter().find(|path| path.exists());
    found.unwrap_or_else(|| panic!("no {name} in {}", deps.display()))
}

fn has(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success())
}

/// Whether a program is there; says loudly that a test does not run where it is not.
fn wanted(program: &str) -> bool {
    let there = has(program);
    if !there {
        // Past what the test program captures, so that it is seen where the tests pass.
        let told = writeln!(std::io::stderr(), "SKIPPED: {program} is not there, so nothing is run with it");
        told.expect("standard error is open");
    }
    there
}

fn succeeded(what: &str, output: &Output) -> String {
    let [out, err] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
    assert!(output.status.success(), "{what}: {}\n{out}\n{err}", output.status);
    out
}

/// A program to be compiled.
struct Source<'a> {
    path: &'a Path,
    compilers: [&'static str; 2],
    standard: &'static str,
}

const C: ([&str; 2], &str) = (["gcc", "clang"], "-std=c11");
const CPP: ([&str; 2], &str) = (["g++", "clang++"], "-std=c++17");

const SANITIZERS: [&str; 3] = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer"];

fn compile(source: &Source<'_>, compiler: &str, options: &[&str], to: &Path) {
    let output = Command::new(compiler)
        .args([source.standard, "-g", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Werror"])
        .args(options)
        .arg("-I")
        .arg(folder().join("include"))
        .arg(source.path)
        .arg(library())
        .args(["-lpthread", "-ldl", "-lm", "-o"])
        .arg(to)
        .output()
        .expect("the compiler runs");
    succeeded(&format!("{compiler} {}", source.path.display()), &output);
}

/// Compiles and runs a program with every compiler that is there, with sanitizers and under valgrind; what it prints each time, and
/// which compilers there were. None are 0 runs.
fn run_all(path: &Path, (compilers, standard): ([&'static str; 2], &'static str)) -> Vec<String> {
    let source = Source { path, compilers, standard };
    let there: Vec<&str> = source.compilers.into_iter().filter(|compiler| wanted(compiler)).collect();
    let scratch = tempfile::tempdir().expect("a folder");
    let mut printed = Vec::new();
    for (i, compiler) in there.iter().enumerate() {
        let program = scratch.path().join("sanitized");
        compile(&source, compiler, &SANITIZERS, &program);
        let output = Command::new(&program).current_dir(scratch.path()).output().expect("the program runs");
        printed.push(succeeded(&format!("{} with sanitizers", path.display()), &output));
        if i == 0 && wanted("valgrind") {
            compile(&source, compiler, &[], &program);
            let options =
                ["--quiet", "--error-exitcode=9", "--leak-check=full", "--errors-for-leak-kinds=definite,indirect"];
            let output = Command::new("valgrind").args(options).arg(&program).current_dir(scratch.path()).output();
            let output = output.expect("valgrind runs");
            printed.push(succeeded(&format!("{} under valgrind", path.display()), &output));
        }
    }
    printed
}

#[test]
fn careless_callers_get_statuses() {
    for printed in run_all(&folder().join("tests/c/border.c"), C) {
        let n: u32 = printed.trim().strip_suffix(" checks").and_then(|n| n.parse().ok()).expect("a number of checks");
        assert!(n > 100, "{n} checks");
    }
}

#[test]
fn the_example_in_c_runs() {
    for printed in run_all(&folder().join("examples/c/rooms.c"), C) {
        let lines: Vec<&str> = printed.lines().collect();
        assert!(lines.len() == 6 && lines[0].starts_with("baked "), "{printed}");
        // The table in the other room is seen through the door, and only while that is open.
        assert!(lines[2].contains(" table") && !lines[3].contains(" table"), "{printed}");
        assert!(lines[2].contains(" chair") && !lines[2].contains(" lamp"), "{printed}");
        assert!(lines[4].ends_with("(outside: everything)") && lines[4].contains(" lamp"), "{printed}");
        assert!(lines[5].starts_with("SL_ERROR_ARGUMENT: there is no cell"), "{printed}");
    }
}

#[test]
fn the_example_of_a_server_runs() {
    for printed in run_all(&folder().join("examples/c/transmit.c"), C) {
        let told =
            |what: &str| printed.lines().find_map(|l| l.strip_suffix(what)?.strip_prefix("tick ")?.parse::<u32>().ok());
        // Those of one room from the first tick; those of the other room before the first steps into the corridor after 1.4 seconds; no others ever.
        assert_eq!((told(": 0 is told of 1"), told(": 2 is told of 3")), (Some(0), Some(0)), "{printed}");
        assert!(told(": 0 is told of 2").is_some_and(|tick| (100..179).contains(&tick)), "{printed}");
        assert!(told(": 1 is told of 2").is_none() && told(": 3 is told of 1").is_none(), "{printed}");
        let share = printed.lines().last().and_then(|line| line.split(' ').next()?.parse::<u32>().ok());
        assert!(share.is_some_and(|share| (20..80).contains(&share)), "{printed}");
    }
}

#[test]
fn the_example_in_cpp_runs() {
    for printed in run_all(&folder().join("examples/cpp/rooms.cpp"), CPP) {
        let lines: Vec<&str> = printed.lines().collect();
        assert!(lines.len() == 4 && lines[0].ends_with("the first room is a place"), "{printed}");
        assert!(lines[1].contains("through the open door") && lines[2] == "the bake ended with: enough", "{printed}");
        assert!(lines[3].starts_with("SL_ERROR_NOT_FOUND: "), "{printed}");
    }
}

/// The code in the README is a program that compiles and runs.
#[test]
fn the_examples_of_the_readme_run() {
    let readme = fs::read_to_string(folder().join("README.md")).expect("a README");
    let scratch = tempfile::tempdir().expect("a folder");
    let mut n_programs = 0;
    for (fence, extension, language) in [("```c\n", "c", C), ("```cpp\n", "cpp", CPP)] {
        for block in readme.split(fence).skip(1) {
            let code = block.split("```").next().expect("a block ends");
            let path = scratch.path().join(format!("readme{n_programs}.{extension}"));
            fs::write(&path, code).expect("a file is written");
            for printed in run_all(&path, language) {
                assert!(printed.contains("to draw"), "{printed}");
            }
            n_programs += 1;
        }
    }
    assert_eq!(n_programs, 2, "one in C and one in C++");
}

/// Headers, the static library and the files of `cmake/` as they are installed.
fn install(prefix: &Path) {
    let [include, lib] = ["include", "lib"].map(|name| prefix.join(name));
    let cmake = lib.join("cmake/sightlines");
    for folder in [&include, &cmake] {
        fs::create_dir_all(folder).expect("a folder is made");
    }
    let copy = |from: PathBuf, to: &Path| {
        let name = from.file_name().expect("a file has a name").to_owned();
        fs::copy(from, to.join(name)).expect("a file is copied");
    };
    for name in ["sightlines.h", "sightlines.hpp"] {
        copy(folder().join("include").join(name), &include);
    }
    for name in ["sightlines-config.cmake", "sightlines-system.cmake"] {
        copy(folder().join("cmake").join(name), &cmake);
    }
    copy(library(), &lib);
    let template = fs::read_to_string(folder().join("cmake/sightlines.pc.in")).expect("a template");
    let prefix = prefix.to_str().expect("UTF-8");
    let text = template.replace("@PREFIX@", prefix).replace("@VERSION@", env!("CARGO_PKG_VERSION"));
    fs::write(lib.join("sightlines.pc"), text).expect("a file is written");
}

#[test]
fn an_installed_library_is_found_by_pkg_config() {
    if !wanted("pkg-config") || !wanted("gcc") {
        return;
    }
    let scratch = tempfile::tempdir().expect("a folder");
    install(scratch.path());
    let output = Command::new("pkg-config")
        .args(["--static", "--cflags", "--libs", "sightlines"])
        .env("PKG_CONFIG_PATH", scratch.path().join("lib"))
        .output();
    let flags = succeeded("pkg-config", &output.expect("it runs"));
    let program = scratch.path().join("rooms");
    let output = Command::new("gcc")
        .args(["-std=c11", "-o"])
        .args([&program, &folder().join("examples/c/rooms.c")])
        .args(flags.split_whitespace())
        .output();
    succeeded("gcc with the flags of pkg-config", &output.expect("it runs"));
    let printed = succeeded("the program", &Command::new(&program).output().expect("it runs"));
    assert!(printed.starts_with("baked "), "{printed}");
}

#[test]
fn an_installed_library_is_found_by_cmake() {
    if !wanted("cmake") || !wanted("gcc") {
        return;
    }
    let scratch = tempfile::tempdir().expect("a folder");
    let [prefix, build] = ["prefix", "build"].map(|name| scratch.path().join(name));
    install(&prefix);
    let rooms = folder().join("examples/c/rooms.c");
    let project = format!(
        "cmake_minimum_required(VERSION 3.16)\nproject(game C)\nfind_package(sightlines CONFIG REQUIRED)\n\
         add_executable(rooms \"{}\")\ntarget_link_libraries(rooms PRIVATE sightlines::sightlines)\n",
        rooms.display()
    );
    fs::write(scratch.path().join("CMakeLists.txt"), project).expect("a file is written");
    let output = Command::new("cmake")
        .args([Path::new("-S"), scratch.path(), Path::new("-B"), &build])
        .arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display()))
        .output();
    succeeded("cmake", &output.expect("it runs"));
    succeeded("cmake --build", &Command::new("cmake").arg("--build").arg(&build).output().expect("it runs"));
    let printed = succeeded("the program", &Command::new(build.join("rooms")).output().expect("it runs"));
    assert!(printed.starts_with("baked "), "{printed}");
}

/// A program that reads what was freed, and one that leaks, are found: the checks above can fail.
#[test]
fn impostor_programs_with_faults_are_caught() {
    let scratch = tempfile::tempdir().expect("a folder");
    let faults = [
        (
            "use",
            "sl_scene_free(s); return sl_scene_set_motion(s, 0, NULL) == SL_OK ? 0 : *(volatile unsigned char *)s & 0;",
        ),
        (
            "overflow",
            "char *b = malloc(4); strcpy(b, sl_status_name(SL_ERROR_BUFFER)); free(b); sl_scene_free(s); return 0;",
        ),
    ];
    for (name, fault) in faults {
        let path = scratch.path().join(format!("{name}.c"));
        let code = format!(
            "#include <sightlines.h>\n#include <stdlib.h>\n#include <string.h>\n\
             int main(void) {{ sl_scene *s = NULL; if (sl_scene_new(&s) != SL_OK) return 0; {fault} }}\n"
        );
        fs::write(&path, code).expect("a file is written");
        let program = scratch.path().join(name);
        let source = Source { path: &path, compilers: C.0, standard: C.1 };
        if wanted("gcc") {
            let quiet = [
                "-Wno-error=use-after-free",
                "-Wno-use-after-free",
                "-Wno-error=stringop-overflow",
                "-Wno-stringop-overflow",
            ];
            compile(&source, "gcc", &[&SANITIZERS[..], &quiet].concat(), &program);
            let output = Command::new(&program).output().expect("the program runs");
            assert!(!output.status.success(), "the sanitizers find nothing in '{name}'");
            if wanted("valgrind") {
                compile(&source, "gcc", &quiet, &program);
                let output = Command::new("valgrind").args(["--quiet", "--error-exitcode=9"]).arg(&program).output();
                assert_eq!(output.expect("valgrind runs").status.code(), Some(9), "valgrind finds nothing in '{name}'");
            }
        }
    }
}
