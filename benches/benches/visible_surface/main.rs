//! Methods of visible-surface determination side by side: wrong pixels and time against the number of faces, each method's bad
//! cases, what precision of depth is worth, and what a table saves a BSP tree.
//!
//! Measuring and drawing are two steps: `--csv` keeps what was measured, `--draw` makes charts of such a file, always the
//! same ones. The reference is the ray caster; what must hold of exact methods is checked with every picture.

mod families;
mod measured;
mod precision;
mod table;

use clap::Parser;
use families::Family;
use measured::{Limits, Row};
use sightlines_benches::chart::{Panel, Series, svg};
use sightlines_benches::program::{Common, Files, exit, read_csv, write_csv};
use std::error::Error;
use std::process::ExitCode;

/// Visible surfaces for one viewpoint.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Families of scenes, of: soup, cycles, lattice, split_worst, coplanar, slivers, interleaved, real.
    #[arg(long, value_delimiter = ',', default_values_t = Family::ALL.map(|f| f.name().to_owned()))]
    families: Vec<String>,
    /// Numbers of faces; families that grow with the square stop at 10^4.
    #[arg(long, value_delimiter = ',', default_values_t = [100, 1_000, 10_000, 100_000])]
    sizes: Vec<u32>,
    /// Pixels to the right and down.
    #[arg(long, value_delimiter = ',', num_args = 1, default_values_t = [640, 480])]
    picture: Vec<u32>,
    /// A method is not asked for more if that is expected to take so many seconds.
    #[arg(long, default_value_t = 120.0)]
    limit: f64,
    /// Leaves out depth precision and tables.
    #[arg(long)]
    only_families: bool,
    #[command(flatten)]
    files: Files,
}

fn main() -> ExitCode {
    let mut args = Args::parse();
    if !args.common.is_wanted("visible_surface") {
        return ExitCode::SUCCESS;
    }
    if args.common.test {
        (args.sizes, args.picture) = (vec![30, 100], vec![96, 64]);
        args.families.retain(|f| f != Family::Real.name());
    }
    exit(run(&args))
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    let rows = args.files.rows(read_csv, || measure(args))?;
    if args.common.test {
        check(&rows)?;
    }
    args.files.save_chart(|| chart(&rows))?;
    if let Some(row) = rows.iter().find(|r| r.is_exact && r.wrong > 0) {
        return Err(format!("{} of {} is wrong in {} pixels", row.method, row.family, row.wrong).into());
    }
    if args.files.draw.is_none() {
        measured::print(&rows);
        if !args.only_families {
            precision::print(size(args)?);
            table::print(args.common.test, size(args)?)?;
        }
    }
    Ok(())
}

fn size(args: &Args) -> Result<[u32; 2], Box<dyn Error>> {
    <[u32; 2]>::try_from(&args.picture[..]).map_err(|_| "--picture takes two numbers".into())
}

fn measure(args: &Args) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut rows = Vec::new();
    for name in &args.families {
        let family = Family::named(name).ok_or_else(|| format!("there is no family {name}"))?;
        let mut limits = Limits::new(args.limit);
        for scene in family.scenes(&args.sizes) {
            rows.extend(measured::all(family, &scene, size(args)?, &mut limits));
            args.files.save_rows(|| write_csv(&rows))?;
        }
    }
    Ok(rows)
}

/// Time of each method on the soup, wrong pixels of those that err, and what each bad case does to its method.
fn chart(rows: &[Row]) -> String {
    let of = |family: &str, method: &str, y: &dyn Fn(&Row) -> f64| {
        let rows = rows.iter().filter(|r| r.family == family && r.method == method);
        let points = rows.map(|r| [r.faces as f64, y(r)]).collect();
        Series::line(method, points)
    };
    let panel = |title: &str, series: Vec<Series>| Panel::of_lines(title, "faces", series);
    let ms = |r: &Row| r.draw_s * 1e3;
    let panels = [
        panel(
            "soup: ms to draw",
            ["painter", "newell", "bsp", "schumacker", "zbuffer", "raycast"].map(|m| of("soup", m, &ms)).to_vec(),
        ),
        panel(
            "soup: ms to prepare",
            ["bsp", "schumacker", "raycast"].map(|m| of("soup", m, &|r| r.prepare_s * 1e3)).to_vec(),
        ),
        panel(
            "wrong pixels (of exact methods: 0)",
            [
                ("coplanar", "painter"),
                ("soup", "painter"),
                ("interleaved", "painter"),
                ("cycles", "painter"),
                ("soup", "zbuffer-f32"),
            ]
            .map(|(family, method)| Series {
                name: format!("{family}, {method}"),
                ..of(family, method, &|r| r.wrong as f64)
            })
            .to_vec(),
        ),
        panel(
            "pieces for each face",
            [("lattice", "newell"), ("lattice", "bsp"), ("split_worst", "bsp"), ("soup", "newell"), ("soup", "bsp")]
                .map(|(family, method)| Series {
                    name: format!("{family}, {method}"),
                    ..of(family, method, &|r| r.pieces as f64 / r.faces as f64)
                })
                .to_vec(),
        ),
    ];
    svg("Visible surfaces", &panels)
}

/// What must hold of small scenes, whatever the machine.
fn check(rows: &[Row]) -> Result<(), Box<dyn Error>> {
    assert!(rows.len() > 50, "only {} pictures", rows.len());
    for row in rows.iter().filter(|r| r.is_exact) {
        assert_eq!(row.wrong, 0, "{} of {} on {} faces", row.method, row.family, row.faces);
    }
    let wrong = |family: &str, method: &str| -> u64 {
        rows.iter().filter(|r| r.family == family && r.method == method).map(|r| r.wrong).sum()
    };
    assert!(wrong("cycles", "painter") > 0 && wrong("interleaved", "painter") > 0, "painter errs where it must");
    let text = write_csv(rows);
    assert_eq!(read_csv::<Row>(&text)?, rows, "what was measured is read back");
    assert_eq!(chart(&read_csv(&text)?), chart(rows), "the same numbers make the same chart");
    assert!(read_csv::<Row>(&text.replacen("painter,", "", 1)).is_err());
    Ok(())
}
