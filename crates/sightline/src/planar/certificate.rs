//! Proof that no open set of lines passes a sequence of doors.
//!
//! A line passes all doors strictly if and only if it separates their left ends from their right ends.
//! By Kirchberger's theorem, two finite sets in the plane that no line separates strictly contain at
//! most four points that no line separates: a point in a triangle of the others, or two segments that
//! meet. Those four points are the certificate; orientations alone check it.
//!
//! Source: Kirchberger, Math. Ann. 57, 1903.

use crate::stabber::Proof;
use sightlines_geometry::{Point2, Portal2, Segment2, orient2d};

/// One end of a door of a sequence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct End {
    /// Index of the door in the sequence.
    pub portal: usize,
    /// Whether it is the left end.
    pub left: bool,
}

impl End {
    fn of(self, portals: &[Portal2]) -> Option<Point2> {
        portals.get(self.portal).map(|p| if self.left { p.left } else { p.right })
    }
}

/// Left and right ends that no line separates: one to three of each, four at most together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlanarCertificate {
    /// The left ends.
    pub lefts: Vec<End>,
    /// The right ends.
    pub rights: Vec<End>,
}

impl PlanarCertificate {
    /// The doors that the proof names, ascending. No sequence that contains them is passable.
    pub fn portals(&self) -> Vec<usize> {
        let mut portals: Vec<usize> = self.lefts.iter().chain(&self.rights).map(|e| e.portal).collect();
        portals.sort_unstable();
        portals.dedup();
        portals
    }

    /// Whether it proves what it claims about `portals`. Exact; shares no code with the solver.
    pub fn holds(&self, portals: &[Portal2]) -> bool {
        let points = |ends: &[End], left: bool| -> Option<Vec<Point2>> {
            ends.iter().map(|e| if e.left == left { e.of(portals) } else { None }).collect()
        };
        let (Some(l), Some(r)) = (points(&self.lefts, true), points(&self.rights, false)) else { return false };
        match (&l[..], &r[..]) {
            ([p], [q]) => p == q,
            ([p], [a, b]) | ([a, b], [p]) => Segment2::new(*a, *b).contains(*p),
            ([a, b], [c, d]) => Segment2::new(*a, *b).meets(&Segment2::new(*c, *d)),
            ([p], [a, b, c]) | ([a, b, c], [p]) => in_triangle(*p, *a, *b, *c),
            _ => false,
        }
    }

    /// Finds a certificate; `None` if a line separates the ends. Exact; O(n²).
    pub fn find(portals: &[Portal2]) -> Option<Self> {
        let ends = |left: bool| (0..portals.len()).map(move |portal| End { portal, left }).collect::<Vec<_>>();
        let (lefts, rights) = (hull(portals, ends(true)), hull(portals, ends(false)));
        let made = |l: &[End], r: &[End]| Self { lefts: l.to_vec(), rights: r.to_vec() };
        crossing(portals, &lefts, &rights)
            .map(|(l, r)| made(&l, &r))
            .or_else(|| covered(portals, &lefts, &rights).map(|(p, t)| made(&[p], &t)))
            .or_else(|| covered(portals, &rights, &lefts).map(|(p, t)| made(&t, &[p])))
    }
}

fn in_triangle(p: Point2, a: Point2, b: Point2, c: Point2) -> bool {
    let turn = orient2d(a, b, c);
    let sides = [orient2d(a, b, p), orient2d(b, c, p), orient2d(c, a, p)];
    (turn > 0.0 && sides.iter().all(|&s| s >= 0.0)) || (turn < 0.0 && sides.iter().all(|&s| s <= 0.0))
}

/// Corners of the convex hull, counter-clockwise, without points on its sides: Andrew's monotone chain.
fn hull(portals: &[Portal2], mut ends: Vec<End>) -> Vec<End> {
    let at = |e: &End| if e.left { portals[e.portal].left } else { portals[e.portal].right };
    ends.sort_by(|e, f| {
        let (p, q) = (at(e), at(f));
        p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(e.cmp(f))
    });
    ends.dedup_by(|e, f| at(e) == at(f));
    if ends.len() < 3 {
        return ends;
    }
    let half = |order: &mut dyn Iterator<Item = End>| {
        let mut chain: Vec<End> = Vec::new();
        for e in order {
            while let [.., p, q] = chain[..] {
                if orient2d(at(&p), at(&q), at(&e)) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(e);
        }
        chain.pop();
        chain
    };
    let mut corners = half(&mut ends.iter().copied());
    corners.extend(half(&mut ends.iter().rev().copied()));
    corners
}

/// Sides of a hull: none for a point, one for a segment.
fn sides(hull: &[End]) -> Vec<[End; 2]> {
    match hull {
        [] | [_] => Vec::new(),
        [a, b] => vec![[*a, *b]],
        _ => (0..hull.len()).map(|i| [hull[i], hull[(i + 1) % hull.len()]]).collect(),
    }
}

/// Sides of the two hulls that meet, or points that meet sides or each other.
fn crossing(portals: &[Portal2], lefts: &[End], rights: &[End]) -> Option<(Vec<End>, Vec<End>)> {
    let at = |e: End| e.of(portals).unwrap_or_default();
    for &l in lefts {
        if let Some(&r) = rights.iter().find(|&&r| at(l) == at(r)) {
            return Some((vec![l], vec![r]));
        }
    }
    let segment = |[a, b]: [End; 2]| Segment2::new(at(a), at(b));
    let on = |point: End, side: [End; 2]| segment(side).contains(at(point));
    for side in sides(rights) {
        if let Some(&l) = lefts.iter().find(|&&l| on(l, side)) {
            return Some((vec![l], side.to_vec()));
        }
    }
    for side in sides(lefts) {
        if let Some(&r) = rights.iter().find(|&&r| on(r, side)) {
            return Some((side.to_vec(), vec![r]));
        }
    }
    for l in sides(lefts) {
        if let Some(r) = sides(rights).into_iter().find(|&r| segment(l).meets(&segment(r))) {
            return Some((l.to_vec(), r.to_vec()));
        }
    }
    None
}

/// A corner of `inner` inside a triangle of the fan that makes up `outer`.
fn covered(portals: &[Portal2], inner: &[End], outer: &[End]) -> Option<(End, Vec<End>)> {
    let at = |e: End| e.of(portals).unwrap_or_default();
    let (&apex, rest) = outer.split_first()?;
    let triangles = rest.windows(2).map(|w| [apex, w[0], w[1]]);
    let found = triangles.flat_map(|t| inner.iter().map(move |&p| (p, t)));
    found
        .into_iter()
        .find(|&(p, [a, b, c])| in_triangle(at(p), at(a), at(b), at(c)))
        .map(|(p, triangle)| (p, triangle.to_vec()))
}

impl Proof<Portal2> for PlanarCertificate {
    fn holds(&self, portals: &[Portal2]) -> bool {
        self.holds(portals)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn door(lx: f64, ly: f64, rx: f64, ry: f64) -> Portal2 {
        Portal2 { left: Point2::new(lx, ly), right: Point2::new(rx, ry) }
    }

    #[test]
    fn certificates_of_each_kind_are_found_and_hold() {
        let cases = [
            vec![door(0., 0., 1., 0.), door(1., 5., 2., 5.), door(0., 9., 1., 9.)],
            vec![door(-3., 0., 3., 0.), door(2., 4., 3., 4.), door(-3., 8., -2., 8.), door(2., 12., 3., 12.)],
            vec![door(0., 0., 1., 0.), door(-1., 1., 0., 0.)],
        ];
        for portals in cases {
            let certificate = PlanarCertificate::find(&portals).expect("blocked");
            assert!(certificate.holds(&portals), "{certificate:?}");
            assert!(certificate.lefts.len() + certificate.rights.len() <= 4);
        }
    }

    /// The impostors: certificates that prove nothing.
    #[test]
    fn certificates_that_prove_nothing_are_refused() {
        let portals = [door(0., 0., 1., 0.), door(0., 5., 1., 5.)];
        assert_eq!(PlanarCertificate::find(&portals), None);
        let l = |portal| End { portal, left: true };
        let r = |portal| End { portal, left: false };
        for (lefts, rights) in [
            (vec![l(0), l(1)], vec![r(0), r(1)]),
            (vec![l(0)], vec![r(0)]),
            (vec![l(0)], vec![r(7)]),
            (vec![r(0)], vec![r(0)]),
            (vec![], vec![]),
        ] {
            assert!(!PlanarCertificate { lefts, rights }.holds(&portals));
        }
    }
}
