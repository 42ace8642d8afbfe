//! Integers on the device: the bits that the integer form says, whatever the forms and sizes.

use crate::common::{Chance, expected, gpu, random_carry, random_forms};
use sightlines_multifocal::{Buffer, Forms};
use sightlines_multifocal_gpu::{GpuBackend, GpuPath, PlaneForms};

const WAYS: [GpuPath; 2] = [GpuPath::Compute, GpuPath::Raster];

/// Compares each way's buffers with `expected`; says where they differ.
fn difference(found: &[Buffer], expected: &[Buffer]) -> Option<String> {
    assert_eq!(found.len(), expected.len(), "a buffer for each plane");
    for (plane, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert_eq!(found.texels(), expected.texels());
        let pairs = found.values().iter().zip(expected.values());
        if let Some(at) = pairs.clone().position(|(a, b)| a != b) {
            let w = found.texels()[0] as usize;
            let (a, b) = (found.values()[at], expected.values()[at]);
            let n = pairs.filter(|(a, b)| a != b).count();
            return Some(format!("plane {plane}, texel ({}, {}): {a}, not {b}; {n} differ", at % w, at / w));
        }
    }
    None
}

fn check(test: &str, planes: &[PlaneForms]) -> Option<usize> {
    let gpu = gpu(test)?;
    let expected = expected(planes);
    for way in WAYS {
        let backend = GpuBackend::new(gpu.clone(), way);
        let ticket = backend.submit_forms(planes).expect("it is submitted");
        let found = backend.wait(&ticket).expect("it is done");
        if let Some(difference) = difference(&found, &expected) {
            panic!("{test}, {}: {difference}", way.name());
        }
    }
    Some(expected.iter().map(Buffer::n_blocked).sum())
}

/// Sizes that are one, that fill tiles, and that do not.
const SIZES: [[u32; 2]; 9] = [[1, 1], [1, 40], [33, 1], [16, 16], [32, 32], [64, 32], [65, 31], [100, 77], [129, 257]];

#[test]
fn forms_equality_on_one_plane_of_any_size() {
    let mut n_blocked = 0;
    for (seed, texels) in (0..5).flat_map(|seed| SIZES.map(|texels| (seed, texels))) {
        let mut chance = Chance::new(seed);
        let n = [0, 1, 7, 60, 300][seed as usize];
        let planes = [PlaneForms { texels, forms: random_forms(&mut chance, texels, n), carry: None }];
        let Some(n) = check(&format!("one plane of {texels:?}, seed {seed}"), &planes) else { return };
        n_blocked += n;
    }
    assert!(n_blocked > 50_000, "only {n_blocked} texels were blocked");
}

#[test]
fn forms_equality_on_sweeps() {
    let mut n_blocked = 0;
    for seed in 0..12 {
        let mut chance = Chance::new(seed);
        let n_planes = 2 + seed as usize % 4;
        let mut planes: Vec<PlaneForms> = Vec::new();
        for i in 0..n_planes {
            let texels = if seed % 2 == 0 { [90, 47] } else { SIZES[chance.int(0, 9) as usize] };
            let carry = (i > 0).then(|| random_carry(&mut chance, planes[i - 1].texels, texels));
            planes.push(PlaneForms { texels, forms: random_forms(&mut chance, texels, 30), carry });
        }
        let Some(n) = check(&format!("sweep, seed {seed}"), &planes) else { return };
        n_blocked += n;
    }
    assert!(n_blocked > 50_000, "only {n_blocked} texels were blocked");
}

#[test]
fn forms_what_is_carried_shows() {
    // Twin of the sweeps: with an empty second plane, whatever is there was carried.
    let mut chance = Chance::new(3);
    let texels = [90, 47];
    let first = PlaneForms { texels, forms: random_forms(&mut chance, texels, 60), carry: None };
    let carry = Some(random_carry(&mut chance, texels, texels));
    let second = PlaneForms { texels, forms: Forms::default(), carry };
    let n_first = expected(std::slice::from_ref(&first))[0].n_blocked();
    let Some(n) = check("carried to an empty plane", &[first, second]) else { return };
    assert!(n > n_first, "{n} and {n_first}");
}

#[test]
fn forms_equality_beyond_one_round() {
    let mut chance = Chance::new(11);
    let texels = [70, 50];
    let planes = [PlaneForms { texels, forms: random_forms(&mut chance, texels, 3000), carry: None }];
    let Some(n) = check("three rounds", &planes) else { return };
    assert!(n > 3000, "{n}");
}

#[test]
fn forms_equality_on_the_longest_rows() {
    let mut chance = Chance::new(12);
    let (before, after) = ([8192, 3], [5, 8192]);
    let first = PlaneForms { texels: before, forms: random_forms(&mut chance, before, 20), carry: None };
    let carry = Some(random_carry(&mut chance, before, after));
    let second = PlaneForms { texels: after, forms: random_forms(&mut chance, after, 20), carry };
    check("the longest rows", &[first, second]);
}

#[test]
fn forms_same_job_same_bits() {
    let Some(gpu) = gpu("same job, same bits") else { return };
    let mut chance = Chance::new(13);
    let texels = [150, 90];
    let planes = [PlaneForms { texels, forms: random_forms(&mut chance, texels, 500), carry: None }];
    for way in WAYS {
        let backend = GpuBackend::new(gpu.clone(), way);
        let run = || backend.wait(&backend.submit_forms(&planes).expect("submitted")).expect("done");
        let first = run();
        assert!((0..5).all(|_| run() == first), "{}", way.name());
    }
}

#[test]
fn impostor_one_unit_is_noticed() {
    let mut chance = Chance::new(14);
    let texels = [40, 40];
    let planes = [PlaneForms { texels, forms: random_forms(&mut chance, texels, 20), carry: None }];
    let right = expected(&planes);
    let mut wrong = right.clone();
    wrong[0].values_mut()[77] += 1;
    assert!(difference(&right, &right).is_none());
    assert!(difference(&wrong, &right).is_some_and(|d| d.contains("texel (37, 1)") && d.ends_with("1 differ")));
}
