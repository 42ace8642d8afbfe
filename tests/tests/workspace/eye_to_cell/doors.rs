//! Portals that are closed: what is behind them is not reached, and what was opened again is as it was.

use crate::eye_to_cell::ask::{Asker, answer};
use crate::eye_to_cell::plan_families::{eye, families, gaze, tables};
use crate::eye_to_cell::plans::{reachable, some_doors};
use sightlines::eye_to_cell::{Doors, Method};
use sightlines_testkit::Random;

/// Invariant: the methods that follow portals show no cell that cannot be walked to; the two that do not are as
/// with all portals open; opening all again gives the first answers, in the same order.
#[test]
fn nothing_behind_closed_portals_is_reached() {
    let (mut n_frames, mut n_cut_off, mut n_restored) = (0, 0, 0);
    for (seed, (name, plan)) in (0..).zip(families()) {
        for table in tables(&plan) {
            let mut asker = Asker::new(&table);
            for place in 0..12 {
                let mut random = Random::new(seed, place);
                let Some(eye) = eye(&plan, &table, place as usize, &mut random) else { continue };
                let roots = table.in_dimension().unwrap().at([eye.x, eye.y]).cells().to_vec();
                let (view, ..) = gaze(&table, eye, &mut random);
                let (mut doors, closed) = some_doors(&table, &mut random);
                let walked = reachable(&table, &roots, &doors);
                let before = Method::ALL.map(|method| asker.ask(&roots, &view, &Doors::all_open(), method));
                let during = Method::ALL.map(|method| answer(&asker.ask(&roots, &view, &doors, method)));
                let what = format!("{name}: eye {eye:?}, closed {closed:?}");
                for (k, seen) in during.iter().enumerate() {
                    if k < 2 {
                        assert_eq!(*seen, answer(&before[k]), "{what}");
                    } else {
                        assert!(seen.cells.is_subset(&walked), "{what}: {}", Method::ALL[k]);
                        n_cut_off += answer(&before[k]).cells.difference(&walked).count();
                    }
                    assert!(seen.cells.is_subset(&answer(&before[k]).cells), "{what}: {}", Method::ALL[k]);
                    assert!(seen.objects.is_subset(&answer(&before[k]).objects), "{what}: {}", Method::ALL[k]);
                }
                doors.open_all();
                for (method, before) in Method::ALL.into_iter().zip(&before) {
                    let after = asker.ask(&roots, &view, &doors, method);
                    assert_eq!(
                        (after.cells(), after.objects()),
                        (before.cells(), before.objects()),
                        "{what}: {method}"
                    );
                    n_restored += usize::from(!closed.is_empty());
                }
                n_frames += 1;
            }
        }
    }
    eprintln!("{n_frames} {n_cut_off} {n_restored}");
    assert!(n_frames > 300 && n_cut_off > 1_000 && n_restored > 500, "{n_frames} {n_cut_off} {n_restored}");
}
