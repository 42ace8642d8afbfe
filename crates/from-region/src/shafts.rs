//! View shafts: what one convex occluder hides from a volume.
//!
//! The shaft between a volume and a target is all segments from one to the other. If one convex occluder cuts
//! all of them, the target is hidden. Two occluders that each cut a part of the shaft say nothing together: between their
//! edges a line may pass, whatever the corners see. So occluders are never put together here; the shaft may be cut
//! instead, and its parts asked one by one.

use sightlines_geometry::vector::{cross, dot, sub};
use sightlines_geometry::{Aabb, BoxTree, Point3, check_coordinate, orient3d};
use sightlines_multifocal::{BackendError, FromRegion, Guarantee, Occluder, Umbra, Volume};

/// Occluders, prepared for shaft tests.
#[derive(Debug, Clone)]
pub struct ViewShafts {
    occluders: Vec<Occluder>,
    /// Twice the area of each outline, rounded: for the order only.
    areas: Vec<f64>,
    tree: BoxTree<3>,
    n_halvings: u32,
}

impl ViewShafts {
    /// Makes occluders ready. O(n log² n).
    ///
    /// Walls count as many occluders as they have polygons, so put together what lies in one plane before.
    pub fn new(occluders: Vec<Occluder>) -> Self {
        let boxes: Vec<_> = occluders.iter().map(|o| *o.bounds()).collect();
        let areas = occluders.iter().map(|o| area(o.outline())).collect();
        Self { tree: BoxTree::build(&boxes, 4), occluders, areas, n_halvings: 0 }
    }

    /// Cuts shafts that no occluder cuts, up to this many times one after the other: the longer of volume and target in two halves. 0 is
    /// the classical method, and what [`Self::new`] begins with.
    ///
    /// All halves have to be hidden, each by an occluder of its own, so this stays sound. A shaft is tested in up to
    /// `2^n` parts.
    #[must_use]
    pub fn with_halvings(mut self, n: u32) -> Self {
        self.n_halvings = n;
        self
    }

    /// The occluders.
    pub fn occluders(&self) -> &[Occluder] {
        &self.occluders
    }

    /// What is hidden from a volume.
    pub fn umbra_of(&self, volume: &Volume) -> ShaftUmbra<'_> {
        ShaftUmbra { shafts: self, volume: *volume, last: None, candidates: Vec::new() }
    }
}

impl FromRegion for ViewShafts {
    fn name(&self) -> String {
        if self.n_halvings == 0 { "shafts".to_owned() } else { format!("shafts-halved-{}", self.n_halvings) }
    }

    fn only_in_air(&self) -> bool {
        true
    }

    fn guarantee(&self) -> Guarantee {
        Guarantee::Conservative
    }

    fn umbra(&mut self, volume: &Volume) -> Result<Box<dyn Umbra + '_>, BackendError> {
        Ok(Box::new(self.umbra_of(volume)))
    }
}

/// What single occluders hide from one volume.
#[derive(Debug)]
pub struct ShaftUmbra<'a> {
    shafts: &'a ViewShafts,
    volume: Volume,
    /// The occluder that cut the last shaft that was cut.
    last: Option<u32>,
    candidates: Vec<u32>,
}

impl ShaftUmbra<'_> {
    /// An occluder that cuts the whole shaft from the volume to the convex hull of `points`, by its index; the
    /// last that was found if it does, else the largest, then the first.
    pub fn blocker(&mut self, points: &[Point3]) -> Option<u32> {
        let volume = self.volume;
        self.cutter(&volume, points)
    }

    fn cutter(&mut self, volume: &Volume, points: &[Point3]) -> Option<u32> {
        let shafts = self.shafts;
        let eyes = volume.corners();
        let cuts = |i: u32| cuts(&shafts.occluders[i as usize], &eyes, points);
        if let Some(last) = self.last.filter(|&i| cuts(i)) {
            return Some(last);
        }
        // An occluder that cuts the shaft cuts the line between the middles, which lie in the two hulls. Rounded, this
        // may miss an occluder, and never adds one.
        let line = Line { from: mean(&eyes), to: mean(points) };
        let mut found = std::mem::take(&mut self.candidates);
        found.clear();
        shafts.tree.visit(
            |b| line.may_meet(b),
            |i| {
                if line.may_meet(shafts.occluders[i as usize].bounds()) {
                    found.push(i);
                }
            },
        );
        let area = |i: u32| shafts.areas[i as usize];
        found.sort_unstable_by(|&a, &b| area(b).total_cmp(&area(a)).then(a.cmp(&b)));
        let cutter = found.iter().copied().find(|&i| line.may_cut(&shafts.occluders[i as usize]) && cuts(i));
        self.candidates = found;
        self.last = cutter.or(self.last);
        cutter
    }

    /// Whether the shaft from a part of the volume to a part of a target is cut, whole or in halves.
    fn is_cut(&mut self, volume: &Volume, target: &Aabb<3>, n_halvings: u32) -> bool {
        // A target is a box like a volume, with the same corners and halves.
        let Ok(target) = Volume::new(*target) else { return false };
        if self.cutter(volume, &target.corners()).is_some() {
            return true;
        }
        if n_halvings == 0 {
            return false;
        }
        let longest = |v: &Volume| (0..3).map(|k| v.bounds().max[k] - v.bounds().min[k]).fold(0.0, f64::max);
        if longest(volume) > longest(&target) {
            let halves = volume.halves();
            halves.is_some_and(|h| h.iter().all(|v| self.is_cut(v, target.bounds(), n_halvings - 1)))
        } else {
            let halves = target.halves();
            halves.is_some_and(|h| h.iter().all(|t| self.is_cut(volume, t.bounds(), n_halvings - 1)))
        }
    }
}

impl Umbra for ShaftUmbra<'_> {
    fn hides(&mut self, target: &Aabb<3>) -> bool {
        let volume = self.volume;
        self.is_cut(&volume, target, self.shafts.n_halvings)
    }

    fn hides_points(&mut self, points: &[Point3]) -> bool {
        let are_usable = points.iter().flatten().all(|&x| check_coordinate(x).is_ok());
        are_usable
            && !points.is_empty()
            && (self.blocker(points).is_some()
                || (self.shafts.n_halvings > 0 && self.hides(&Aabb::around(points.iter().copied()))))
    }
}

/// Whether an occluder cuts all segments from the hull of `eyes` to the hull of `points`, before they end.
///
/// That eyes are strictly in front of all facets, that points are strictly behind them, and that segments pass an edge on
/// one side are conditions that are affine in the eye and in the point: they hold in the hulls if they hold at the corners.
/// A segment may touch lines of edges as long as it passes one edge properly: then the outline, seen along the
/// segment, still goes all the way round it, or the segment meets the outline itself. In either case it meets the surface,
/// and does so between the planes' front and back. Exact.
fn cuts(occluder: &Occluder, eyes: &[Point3], points: &[Point3]) -> bool {
    let Some(in_front) = occluder.hiding_side_of(eyes) else { return false };
    if occluder.side_of(points) != Some(!in_front) {
        return false;
    }
    // From the front the outline runs counter-clockwise, and the segment runs away: it has the edges on its right.
    let sign = if in_front { -1.0 } else { 1.0 };
    let outline = occluder.outline();
    let edges = || outline.iter().zip(outline.iter().cycle().skip(1));
    eyes.iter().all(|&v| {
        points.iter().all(|&p| {
            let mut properly = false;
            edges().all(|(&a, &b)| {
                let side = sign * orient3d(v, p, a, b);
                properly |= side > 0.0;
                side >= 0.0
            }) && properly
        })
    })
}

/// The segment between the middles of two hulls, in rounded numbers.
struct Line {
    from: Point3,
    to: Point3,
}

impl Line {
    /// Whether it meets a box, but for rounding.
    fn may_meet(&self, b: &Aabb<3>) -> bool {
        let mut part = [0.0f64, 1.0];
        for k in 0..3 {
            let (v, d) = (self.from[k], self.to[k] - self.from[k]);
            if d == 0.0 {
                if !(b.min[k]..=b.max[k]).contains(&v) {
                    return false;
                }
                continue;
            }
            let (s, t) = ((b.min[k] - v) / d, (b.max[k] - v) / d);
            part = [part[0].max(s.min(t)), part[1].min(s.max(t))];
        }
        part[0] <= part[1]
    }

    /// Whether it may pass the outline on one side; a rejection is cheap, and decides nothing else.
    fn may_cut(&self, occluder: &Occluder) -> bool {
        let outline = occluder.outline();
        let ray = sub(self.to, self.from);
        let mut edges = outline
            .iter()
            .zip(outline.iter().cycle().skip(1))
            .map(|(&a, &b)| dot(ray, cross(sub(a, self.from), sub(b, self.from))));
        let first = edges.next().unwrap_or(0.0);
        first != 0.0 && edges.all(|side| side * first.signum() >= 0.0)
    }
}

fn mean(points: &[Point3]) -> Point3 {
    let n = points.len() as f64;
    std::array::from_fn(|k| points.iter().map(|p| p[k] / n).sum())
}

/// Twice the area of a polygon, rounded.
fn area(outline: &[Point3]) -> f64 {
    let fan = outline.windows(2).map(|w| cross(sub(w[0], outline[0]), sub(w[1], outline[0])));
    let sum = fan.fold([0.0; 3], |sum: Point3, c| std::array::from_fn(|k| sum[k] + c[k]));
    dot(sum, sum).sqrt()
}
