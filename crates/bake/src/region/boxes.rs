//! Pairs of given boxes that are in doubt, and what sightlines decide of them.

use sightlines_pvs::BitMatrix;
use sightlines_stabtree::{BoxVisibility, PairMask};

/// Clears in matrices of boxes and of objects what was in doubt and turned out to be hidden.
pub(super) fn clear_hidden(of: [&mut BitMatrix; 2], doubt: &PairMask, answer: &BoxVisibility) {
    let [rows, objects] = of;
    let pairs = [(rows, &doubt.boxes, &answer.boxes), (objects, &doubt.objects, &answer.objects)];
    for (matrix, doubt, answer) in pairs {
        for row in 0..doubt.n_rows() {
            let words = matrix.row_mut(row).iter_mut().zip(doubt.row(row)).zip(answer.row(row));
            words.for_each(|((word, doubt), answer)| *word &= !doubt | answer);
        }
    }
}

/// What is visible and neither proven so nor touching.
pub(super) fn in_doubt(rows: &BitMatrix, objects: &BitMatrix, proven: &PairMask, touching: &[Vec<u32>]) -> PairMask {
    let mut doubt = PairMask { boxes: rows.clone(), objects: objects.clone() };
    for (row, touched) in touching.iter().enumerate() {
        let less = |matrix: &mut BitMatrix, known: &BitMatrix| {
            matrix.row_mut(row).iter_mut().zip(known.row(row)).for_each(|(word, known)| *word &= !known);
        };
        less(&mut doubt.boxes, &proven.boxes);
        less(&mut doubt.objects, &proven.objects);
        doubt.boxes.set(row, row, false);
        touched.iter().for_each(|&o| doubt.objects.set(row, o as usize, false));
    }
    doubt
}

/// Adds pairs to others.
pub(super) fn add(all: &mut PairMask, more: &PairMask) {
    for (all, more) in [(&mut all.boxes, &more.boxes), (&mut all.objects, &more.objects)] {
        for row in 0..more.n_rows() {
            all.row_mut(row).iter_mut().zip(more.row(row)).for_each(|(word, more)| *word |= more);
        }
    }
}

/// Removes pairs that are not visible, or need no decision.
pub(super) fn keep_visible(left: &mut PairMask, rows: &BitMatrix, objects: &BitMatrix, touching: &[Vec<u32>]) {
    for (left, visible) in [(&mut left.boxes, rows), (&mut left.objects, objects)] {
        for row in 0..visible.n_rows() {
            left.row_mut(row).iter_mut().zip(visible.row(row)).for_each(|(word, visible)| *word &= visible);
        }
    }
    for (row, touched) in touching.iter().enumerate() {
        left.boxes.set(row, row, false);
        touched.iter().for_each(|&o| left.objects.set(row, o as usize, false));
    }
}
