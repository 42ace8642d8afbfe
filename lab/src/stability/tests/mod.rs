//! The frame: that it can fail, that its files hold what was counted, that threads change nothing.

use super::method::{Answer, Kind, Outcome, method};
use super::run::{Options, RunError, complaints, run};
use super::sweep::{Sweep, caught};
use super::table::{HEADER, Row, TableError, from_csv, to_csv};
use super::{draw, page};
use sightlines::geometry::Random;

/// Numbers from 0 to 1; those above the level are open.
fn sweep(kind: Kind) -> Sweep {
    let methods = vec![
        method::<(f64, bool)>("knows", kind, |&(_, open)| if open { Answer::Seen } else { Answer::Hidden }),
        method("hides all", Kind::Naive, |_| Answer::Hidden),
        method("shows all", Kind::Reference, |_| Answer::Seen),
        method("panics", Kind::Solver, |&(x, _)| if x > 0.5 { panic!("as solvers do") } else { Answer::Failed }),
    ];
    Sweep::of_cases(["test-level", "About numbers.", "level"], vec![0.25, 0.5, 2.0], 60, methods, |level, random| {
        let x = random.unit();
        (x < 0.9).then_some(((x, x > level), x > level))
    })
}

#[test]
fn impostors_are_counted() {
    let (rows, findings) = sweep(Kind::Shipped).measure();
    assert_eq!(rows.len(), 12);
    for level in rows.chunks(4) {
        let [knows, hides, shows, panics] = level else { panic!("four methods") };
        assert!(level.iter().all(|r| r.cases == 75 && r.open == knows.open && r.parameter == knows.parameter));
        assert_eq!([knows.n_unsafe, knows.loose, knows.errors], [0; 3]);
        assert_eq!([hides.n_unsafe, hides.loose, hides.errors], [hides.open, 0, 0]);
        assert_eq!([shows.n_unsafe, shows.loose, shows.errors], [0, 75 - shows.open, 0]);
        assert_eq!([panics.n_unsafe, panics.loose, panics.errors], [0, 0, 75]);
    }
    assert!(rows[0].open > rows[4].open && rows[4].open > 0 && rows[8].open == 0);
    // The first finding of each level, for who hides and who panics.
    let hidden: Vec<_> = findings.iter().filter(|f| f.method == "hides all").map(|f| (f.level, f.outcome)).collect();
    assert_eq!(hidden, [(0.25, Outcome::Unsafe), (0.5, Outcome::Unsafe)]);
    assert_eq!(findings.iter().filter(|f| f.outcome == Outcome::Error).count(), 3);
    assert!(findings[0].case.ends_with("true)"), "{}", findings[0].case);
}

#[test]
fn panics_are_no_answer_and_leave_no_trace() {
    assert_eq!(caught(|| panic!("not printed")), Answer::Failed);
    assert_eq!(caught(|| Answer::Hidden), Answer::Hidden);
    assert_eq!(Outcome::of(true, Answer::Seen), Outcome::Right);
    assert_eq!(Outcome::of(false, Answer::Hidden), Outcome::Right);
}

#[test]
fn what_must_not_be_is_noticed() {
    let (rows, _) = sweep(Kind::Shipped).measure();
    assert_eq!(complaints(&rows, true), Vec::<String>::new());
    let changed = |change: &dyn Fn(&mut Row)| {
        let mut rows = rows.clone();
        rows.iter_mut().for_each(change);
        rows
    };
    // A shipped method that hides, one that has no answer, a naive one that is never wrong, a sweep without cases.
    let hides = changed(&|r| {
        if r.method == "hides all" {
            r.kind = Kind::Shipped
        }
    });
    assert_eq!(complaints(&hides, true).len(), 2, "at two levels something is open");
    let silent = changed(&|r| {
        if r.method == "panics" {
            r.kind = Kind::Shipped
        }
    });
    assert_eq!(complaints(&silent, false).len(), 3);
    let harmless = changed(&|r| {
        if r.method == "knows" {
            r.kind = Kind::Naive
        }
    });
    assert_eq!(complaints(&harmless, true), ["knows is naive and has no unsafe failure in any sweep"]);
    assert!(complaints(&harmless, false).is_empty());
    let empty = changed(&|r| (r.cases, r.open, r.n_unsafe, r.loose, r.errors) = (0, 0, 0, 0, 0));
    assert!(complaints(&empty, false).len() == 12);
}

#[test]
fn tables_are_read_as_they_were_written() {
    let (mut rows, _) = sweep(Kind::Shipped).measure();
    rows[0].parameter = 1e-300;
    rows[1].parameter = -0.1;
    rows[2].parameter = 1_099_511_627_776.0;
    let text = to_csv(&rows);
    assert!(text.starts_with(HEADER) && text.ends_with('\n'));
    assert_eq!(from_csv(&text), Ok(rows));
    assert_eq!(from_csv(""), Err(TableError::Header));
    let with = |line: &str| from_csv(&format!("{HEADER}\n{line}\n"));
    assert_eq!(with("a,b,naive,1,5,3,3,2,0").unwrap().len(), 1);
    assert_eq!(with("a,b,naive,1,5,3,3,2"), Err(TableError::Fields { line: 2, found: 8 }));
    assert_eq!(with("a,b,good,1,5,3,3,2,0"), Err(TableError::Field { line: 2, field: "kind" }));
    assert_eq!(with("a,b,naive,inf,5,3,3,2,0"), Err(TableError::Field { line: 2, field: "parameter" }));
    for wrong in ["5,6,0,0,0", "5,3,4,0,0", "5,3,0,3,0", "5,3,3,2,1"] {
        assert_eq!(with(&format!("a,b,naive,1,{wrong}")), Err(TableError::Counts(2)), "{wrong}");
    }
}

#[test]
fn threads_change_no_byte() {
    let bytes = |n_threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        pool.install(|| {
            let plane = super::plane::sweeps(true).into_iter().find(|s| s.name == "plane-gap").unwrap();
            [sweep(Kind::Shipped), plane].map(|s| {
                let (rows, findings) = s.measure();
                (to_csv(&rows), findings, draw::svg(s.name, s.parameter, &rows).unwrap())
            })
        })
    };
    assert!(bytes(1) == bytes(2));
}

#[test]
fn files_are_written_and_drawn_again_from_the_numbers_alone() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_owned();
    let sweeps = [sweep(Kind::Shipped)];
    let options = Options { out: out.clone(), ..Options::default() };
    let (text, complaints) = run(&sweeps, &options).unwrap();
    assert!(complaints.is_empty() && text.contains("| hides all | naive"), "{text} {complaints:?}");
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    let [csv, svg, md] = ["stability/test-level.csv", "stability/test-level.svg", "stability.md"].map(read);
    assert_eq!(csv.lines().count(), 13);
    assert!(svg.starts_with("<svg") && svg.contains("hides all") && svg.contains("errors"));
    assert!(md.contains("About numbers.") && md.contains("(stability/test-level.svg)"));
    for name in ["stability/test-level.svg", "stability.md"] {
        std::fs::remove_file(out.join(name)).unwrap();
    }
    run(&sweeps, &Options { draw: true, ..options.clone() }).unwrap();
    assert_eq!([read("stability/test-level.svg"), read("stability.md")], [svg, md]);
    // Without numbers there is nothing to draw, and a sweep that is not there is an error.
    std::fs::remove_file(out.join("stability/test-level.csv")).unwrap();
    assert!(matches!(run(&sweeps, &Options { draw: true, ..options.clone() }), Err(RunError::File { .. })));
    std::fs::write(out.join("stability/test-level.csv"), "nonsense").unwrap();
    let error = run(&sweeps, &Options { draw: true, ..options.clone() }).unwrap_err();
    assert!(error.to_string().contains("test-level.csv: line 1: the header"), "{error}");
    let only = Some("no such".to_owned());
    assert!(matches!(run(&sweeps, &Options { only, ..options }), Err(RunError::NoSweep(_))));
}

#[test]
fn names_are_fit_for_files_and_tables() {
    for quick in [true, false] {
        let sweeps = super::all(quick);
        assert!(sweeps.len() >= 20);
        let mut names: Vec<&str> = sweeps.iter().map(|s| s.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), sweeps.len());
        for s in &sweeps {
            let is_word = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
            assert!(s.name.chars().all(is_word), "{}", s.name);
            assert!(s.levels.windows(2).all(|w| w[0] < w[1]), "{}", s.name);
            assert!(s.methods.iter().any(|m| m.kind == Kind::Shipped), "{}", s.name);
            assert!(s.methods.iter().all(|m| !m.name.contains([',', '|', '\n'])), "{}", s.name);
            assert!(s.batches > 0 && !s.levels.is_empty(), "{}", s.name);
        }
    }
}

/// The sums of a page are those of its tables.
#[test]
fn pages_add_up() {
    let (rows, _) = sweep(Kind::Shipped).measure();
    let sums = page::sums(&rows);
    assert_eq!(sums.iter().map(|s| s.counts[0]).sum::<u64>(), rows.iter().map(|r| r.cases).sum::<u64>());
    assert_eq!(sums[0].kind, Kind::Shipped);
    assert!(draw::svg("none", "level", &[]).is_none());
}

/// Seeds differ from batch to batch: no two draw the same numbers.
#[test]
fn batches_differ() {
    let sweep = Sweep {
        name: "test-seeds",
        about: "",
        parameter: "",
        levels: vec![1.0, 2.0],
        batches: 3,
        methods: vec![method::<()>("prints", Kind::Naive, |()| Answer::Failed).0],
        batch: Box::new(|_, random: &mut Random, board| {
            let bits = random.bits();
            board.ask(0, true, &bits, || Answer::Hidden);
        }),
    };
    let (rows, findings) = sweep.measure();
    assert_eq!(rows.iter().map(|r| r.cases).collect::<Vec<_>>(), [3, 3]);
    assert_ne!(findings[0].case, findings[1].case);
}
