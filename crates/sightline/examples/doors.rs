//! Walks down a corridor door by door, and prints the line that passes them or the proof that none does.
//!
//! Run as `cargo run -p sightlines-sightline --example doors`.

use sightlines_geometry::{Adaptive, Point2, Portal2};
use sightlines_sightline::{End, Funnel, PlanarCertificate, PlanarWitness, SightlineError, Verdict, stabbing_line};
use sightlines_testkit::lp::{LpAnswer, stab};

/// A door across a corridor that runs towards +x, from `low` to `high`.
fn door(x: f64, low: f64, high: f64) -> Portal2 {
    Portal2 { left: Point2::new(x, high), right: Point2::new(x, low) }
}

fn print_witness(line: &PlanarWitness, doors: &[Portal2]) {
    let [a, b, c] = line.coefficients();
    println!("  open: the line {a} x + {b} y + {c} = 0 passes every door:");
    for &portal in doors {
        println!("    {} is on its left, {} on its right", portal.left, portal.right);
    }
    match line.rounded(doors) {
        Some([p, q]) => println!("  so does, exactly, the line through the doubles {p} and {q}"),
        None => println!("  no line through two of the doubles tried does"),
    }
}

fn print_proof(proof: &PlanarCertificate, doors: &[Portal2]) {
    let name = |end: &End| {
        let portal = doors[end.portal];
        format!("{} of door {}", if end.left { portal.left } else { portal.right }, end.portal)
    };
    let names = |ends: &[End]| ends.iter().map(name).collect::<Vec<_>>().join(", ");
    println!("  blocked: no line has on its left   {}", names(&proof.lefts));
    println!("                   and on its right  {}", names(&proof.rights));
    println!("  doors {:?} are enough to block; the proof holds: {}", proof.portals(), proof.holds(doors));
}

fn explain(doors: &[Portal2]) -> Result<(), SightlineError> {
    match stabbing_line(doors)? {
        None => println!("  no doors, nothing to pass"),
        Some(Verdict::Visible(line)) => print_witness(&line, doors),
        Some(Verdict::Hidden(proof)) => print_proof(&proof, doors),
    }
    match stab(doors) {
        LpAnswer::Open { margin } => println!("  the linear program agrees, with a margin of {margin:.3}"),
        answer => println!("  the linear program: {answer:?}"),
    }
    Ok(())
}

fn main() -> Result<(), SightlineError> {
    let mut doors = vec![door(0.0, 0.0, 3.0), door(3.0, 2.0, 4.0), door(7.0, 3.0, 6.0)];
    println!("three doors");
    explain(&doors)?;

    println!("\na fourth, low down behind them");
    doors.push(door(9.0, 0.0, 2.0));
    explain(&doors)?;

    // A search drives a funnel door by door in the same way, and undoes doors when it backtracks.
    let mut funnel = Funnel::new(Adaptive);
    funnel.start(doors[0]);
    let passed = doors[1..].iter().take_while(|&&portal| funnel.push(portal).is_some()).count();
    println!("\nthe funnel passes {} doors of {}", passed + 1, doors.len());
    let (from, to) = funnel.clockwise_limit();
    println!("  its most clockwise line goes from {from} to {to}");
    let (from, to) = funnel.counter_clockwise_limit();
    println!("  its most counter-clockwise line goes from {from} to {to}");
    Ok(())
}
