//! Circles in small programs, and none where there is none.

use super::program::Read;
use super::*;

/// A program of files, the first of which is the root.
fn program(files: &[(&str, &str)]) -> Program {
    let read: Read<'_> = &|path: &Path| files.iter().find(|(p, _)| Path::new(p) == path).map(|f| f.1.to_owned());
    Program::read(Path::new(files[0].0), read)
}

/// The members of all circles.
fn found(files: &[(&str, &str)]) -> Vec<String> {
    circles(&program(files)).iter().map(|c| c.members.join(" ")).collect()
}

#[test]
fn two_files_that_use_each_other_are_a_circle() {
    let lib = ("src/lib.rs", "mod a; mod b;");
    let a = ("src/a.rs", "use crate::b::B;\npub struct A(B);");
    let circle = circles(&program(&[lib, a, ("src/b.rs", "\n\npub struct B(Option<Box<super::a::A>>);")]));
    let text = "circle of modules a, b\n    a uses b: src/a.rs:1: crate::b::B\n    b uses a: src/b.rs:3: super::a::A";
    assert_eq!(circle.iter().map(Circle::to_string).collect::<Vec<_>>(), [text]);
    // The honest twin: one way only, or the other use in unit tests only.
    assert!(found(&[lib, a, ("src/b.rs", "pub struct B;")]).is_empty());
    for tests in [
        "#[cfg(test)]\nmod tests { use crate::a::A; fn f() { crate::a::g() } }",
        "#[cfg(test)]\n#[derive(Debug)]\nstruct T(crate::a::A);",
        "#[cfg(test)]\npub(crate) use crate::a::{A, g};",
        "#[cfg(test)]\nmod tests;",
    ] {
        let b = format!("pub struct B;\n{tests}");
        assert!(found(&[lib, a, ("src/b.rs", &b), ("src/b/tests.rs", "use crate::a::A;")]).is_empty(), "{tests}");
    }
    // What stands in comments, strings and attributes is no use.
    let b = "//! [`A`](crate::a::A)\npub struct B; // crate::a::A\nconst S: &str = \"crate::a::A\";\n#[doc(alias = crate::a::A)]";
    assert!(found(&[lib, a, ("src/b.rs", b)]).is_empty());
}

#[test]
fn parents_and_children_may_use_each_other() {
    let files = [
        ("src/lib.rs", "mod a;\npub use a::A;\npub struct Root;\nfn f() { a::inner::g() }"),
        ("src/a/mod.rs", "pub mod inner; pub struct A; use inner::g; use crate::Root;"),
        ("src/a/inner.rs", "use super::A; use crate::{A as Again, Root}; pub fn g() {}"),
    ];
    assert!(found(&files).is_empty());
}

#[test]
fn re_exports_are_followed_to_where_things_are_defined() {
    let b = ("src/b.rs", "use crate::a::A; pub struct B;");
    for (lib, a) in [
        ("mod a; mod b; pub use b::B;", "use crate::B; pub struct A;"),
        ("mod a; mod b; pub use b::*;", "pub struct A; fn f() -> crate::B { todo() }"),
        ("mod a; mod b; pub use b::B as Renamed;", "use super::Renamed; pub struct A;"),
        (
            "mod a; mod b; use b::{self, B};",
            "use super::program::Read;
use super::*; pub struct A(B);",
        ),
        ("mod a; mod b;", "use crate::b; pub struct A; fn f() { b::g(); }"),
        ("mod a; mod b;", "use crate::{b::{B}}; pub struct A;"),
        ("mod a; mod b;", "pub struct A; mod deep { fn f() { super::super::b::g() } }"),
    ] {
        assert_eq!(found(&[("src/lib.rs", lib), ("src/a.rs", a), b]), ["a b"], "{lib} {a}");
    }
    // The same names of other crates, and of methods and fields.
    let a = "use other::b::B; pub struct A; fn f(x: X) { x.b::<u8>(); ::b::g(); x.b() } pub(in crate::b) fn h() {}";
    assert!(found(&[("src/lib.rs", "mod a; mod b; pub use b::B;"), ("src/a.rs", a), b]).is_empty());
    // An import of itself ends.
    assert!(
        found(&[("src/lib.rs", "mod a; pub use a::X;"), ("src/a.rs", "pub use crate::X; fn f(x: X::Y) {}")]).is_empty()
    );
}

#[test]
fn circles_of_three_and_of_folders_are_found() {
    let lib = ("src/lib.rs", "mod a; mod b; mod c; mod d;");
    let chain = |c: &'static str| {
        found(&[
            lib,
            ("src/a.rs", "use crate::b::X;"),
            ("src/b/mod.rs", "mod below; pub struct X; pub struct Y;"),
            ("src/b/below.rs", "use crate::c::X;"),
            ("src/c.rs", c),
            ("src/d.rs", "use crate::{a, c};"),
        ])
    };
    assert_eq!(chain("pub struct X; use crate::a::f;"), ["a b c"]);
    assert_eq!(chain("pub struct X; use crate::b::Y;"), ["b c"], "though no single file uses one that uses it");
    assert!(chain("pub struct X;").is_empty());
}

#[test]
fn circles_below_a_module_have_its_name() {
    let files = [
        ("src/main.rs", "mod m { pub mod x; pub mod y; }"),
        ("src/m/x.rs", "use super::y;"),
        ("src/m/y.rs", "use super::x;"),
    ];
    assert_eq!(found(&files), ["m::x m::y"]);
}

#[test]
fn this_workspace_is_looked_through() {
    let starts = roots(&root().join("xtask")).expect("the folder of this program");
    let program = Program::read(&starts[0], &|path| fs::read_to_string(path).ok());
    assert!(program.files.iter().any(|f| f.module == ["circles", "resolve"]), "{:?}", program.files);
    let to_resolve = |u: &Use| program.files[u.to].module == ["circles", "resolve"];
    assert!(uses(&program).iter().any(to_resolve));
}
