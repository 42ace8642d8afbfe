//! Plans: opaque lines stop sight.

use super::{RayOracle, Sample, at, chosen, clip, extreme, neighbours_of, scale_of};
use crate::borders::middles;
use crate::exact::{segments_apart, snapped, strictly_in_polygon};
use crate::shapes::{ends, outlines};
use crate::sight::{SightSegment, Target};
use sightlines_cells::{CellId, Plan};
use sightlines_geometry::{Aabb, BoxTree, Point2, Point3, Random, Segment2, orient2d, polygon_contains};
use sightlines_pvs::{PortalRecord, Table};

mod slit;

/// A plan with the cells of a table.
#[derive(Debug)]
pub(crate) struct PlanWorld {
    walls: Vec<[Point2; 2]>,
    wall_tree: BoxTree<2>,
    cells: Vec<Vec<Point2>>,
    cell_tree: BoxTree<2>,
    objects: Vec<Aabb<2>>,
    next: Vec<Vec<u32>>,
    /// For each cell its portals: where they lead, and their left and right ends going there.
    gates: Vec<Vec<(u32, Point2, Point2)>>,
    /// Around boxes in rounded questions.
    slack: f64,
    /// How near to a wall no segment may begin or end.
    clearance: f64,
    size: f64,
}

impl PlanWorld {
    /// `None` if the table has no outlines of its cells.
    pub(crate) fn new(table: &Table, plan: &Plan) -> Option<Self> {
        let cells = outlines(table)?;
        let walls: Vec<[Point2; 2]> = plan.walls().map(|wall| [wall.a, wall.b]).collect();
        let around = |points: &[Point2]| Aabb::around(points.iter().map(|p| [p.x, p.y]));
        let wall_boxes: Vec<Aabb<2>> = walls.iter().map(|w| around(w)).collect();
        let cell_boxes: Vec<Aabb<2>> = cells.iter().map(|c| around(c)).collect();
        let scale = scale_of(plan.points().flat_map(|p| [p.x, p.y]));
        let bounds = cell_boxes.iter().fold(Aabb::EMPTY, |all: Aabb<2>, b| all.with(b.min).with(b.max));
        let size = if bounds.is_empty() { 0.0 } else { Point2::from(bounds.max).distance(Point2::from(bounds.min)) };
        let wall_tree = BoxTree::build(&wall_boxes, 4);
        let rounded = !plan.joints().is_empty() || has_rounded_crossings(plan);
        let mut gates = vec![Vec::new(); cells.len()];
        for record in table.portals() {
            let [left, right] = ends(record);
            let [a, b] = record.cells;
            gates[a.idx()].push((b.0, left, right));
            gates[b.idx()].push((a.0, right, left));
        }
        Some(Self {
            wall_tree,
            walls,
            cell_tree: BoxTree::build(&cell_boxes, 4),
            cells,
            objects: plan.objects().iter().map(|o| o.bounds).collect(),
            next: neighbours_of(table),
            gates,
            slack: scale * 2f64.powi(-40),
            // Where lines cross at a point that is no pair of doubles, walls are bent by up to 2^-49 of its coordinates in each
            // of at most eight rounds (`triangulation::noding`), and who stands that near may be counted to the cell
            // behind. Walls are bent through ends that are joined to them by 2^-46 at most, once. 2^-40 is 64 times all of that.
            clearance: if rounded { scale * 2f64.powi(-40) } else { 0.0 },
            size,
        })
    }

    fn is_inside(&self, cell: u32, p: Point2) -> bool {
        strictly_in_polygon(&self.cells[cell as usize], p)
    }

    /// A random point strictly inside of a cell: a mixture of its corners.
    fn place(&self, cell: u32, random: &mut Random) -> Option<Point2> {
        let corners = &self.cells[cell as usize];
        for _ in 0..8 {
            let i = random.below(corners.len());
            let fan = [corners[i], corners[random.below(corners.len())], corners[random.below(corners.len())]];
            let middle = corners.iter().fold(Point2::ZERO, |s, &c| s + c / corners.len() as f64);
            let (u, v, w) = (random.unit(), random.unit(), extreme(random));
            let [x, y] = [fan[1] - fan[0], fan[2] - fan[0]];
            let on_fan = fan[0] + x * u.min(v) + y * (1.0 - u.max(v));
            let p = on_fan + (middle - on_fan) * w.clamp(2f64.powi(-30), 1.0);
            let [x, y, _] = snapped([p.x, p.y, 0.0]);
            if self.is_inside(cell, Point2::new(x, y)) {
                return Some(Point2::new(x, y));
            }
        }
        None
    }

    /// Whether nothing opaque touches the closed segment, and neither end is nearer to a wall than walls may be bent.
    fn is_free(&self, p: Point2, q: Point2) -> bool {
        let (start, d) = ([p.x, p.y], [q.x - p.x, q.y - p.y]);
        let free = std::cell::Cell::new(true);
        self.wall_tree.visit(
            |b| free.get() && clip(start, d, b, [0.0, 1.0], self.slack).is_some(),
            |w| {
                let [a, b] = self.walls[w as usize];
                if free.get() && !segments_apart(p, q, a, b) {
                    free.set(false);
                }
            },
        );
        free.get() && self.is_clear(p) && self.is_clear(q)
    }

    fn is_clear(&self, p: Point2) -> bool {
        if self.clearance == 0.0 {
            return true;
        }
        let reach = 2.0 * self.clearance;
        let near = |b: &Aabb<2>| (0..2).all(|k| b.min[k] - reach <= p[k] && p[k] <= b.max[k] + reach);
        let mut clear = true;
        self.wall_tree.visit(near, |w| {
            let [a, b] = self.walls[w as usize];
            clear &= distance(p, a, b) > reach;
        });
        clear
    }

    /// Where a ray meets a wall, as a multiple of its direction; rounded.
    fn hit(&self, p: Point2, d: Point2) -> f64 {
        let nearest = std::cell::Cell::new(2.0 * self.size / d.length());
        let (start, direction) = ([p.x, p.y], [d.x, d.y]);
        self.wall_tree.visit(
            |b| clip(start, direction, b, [0.0, nearest.get()], self.slack).is_some(),
            |w| {
                let [a, b] = self.walls[w as usize];
                let along = d.perp_dot(b - a);
                let (t, s) = ((a - p).perp_dot(b - a) / along, (a - p).perp_dot(d) / along);
                if t >= 0.0 && (0.0..=1.0).contains(&s) && t < nearest.get() {
                    nearest.set(t);
                }
            },
        );
        nearest.get()
    }

    /// The part of the line `p + t d` in a cell, rounded.
    fn within(&self, cell: u32, p: Point2, d: Point2, range: [f64; 2]) -> Option<[f64; 2]> {
        let corners = &self.cells[cell as usize];
        let [mut low, mut high] = range;
        for (i, &a) in corners.iter().enumerate() {
            let e = corners[(i + 1) % corners.len()] - a;
            // Inside is where the cross product of edge and place is positive.
            let (height, slope) = (e.perp_dot(p - a), e.perp_dot(d));
            if slope == 0.0 {
                if height < 0.0 {
                    return None;
                }
            } else if slope > 0.0 {
                low = low.max(-height / slope);
            } else {
                high = high.min(-height / slope);
            }
        }
        (low < high).then_some([low, high])
    }

    /// A place of a cell, each as likely as another; `None` if rounding led out of it.
    fn any_place(&self, cell: u32, random: &mut Random) -> Option<Point2> {
        let corners = &self.cells[cell as usize];
        let first = *corners.first()?;
        let fan = || corners.windows(2).skip(1).map(|w| [w[0] - first, w[1] - first]);
        let mut sum = 0.0;
        let sums: Vec<f64> = fan()
            .map(|[x, y]| {
                sum += x.perp_dot(y).abs();
                sum
            })
            .collect();
        let [x, y] = fan().nth(chosen(&sums, random)?)?;
        let (u, v) = (random.unit(), random.unit());
        let p = first + x * u.min(v) + y * (1.0 - u.max(v));
        let [x, y, _] = snapped([p.x, p.y, 0.0]);
        Some(Point2::new(x, y)).filter(|&p| self.is_inside(cell, p))
    }

    fn sight(from: u32, target: Target, p: Point2, q: Point2) -> SightSegment {
        let lift = |p: Point2| snapped([p.x, p.y, 0.0]);
        SightSegment { from: CellId(from), target, segment: [lift(p), lift(q)] }
    }

    /// A random point of an object, its corners included.
    fn of_object(&self, object: u32, random: &mut Random) -> Point2 {
        let b = &self.objects[object as usize];
        let x: [f64; 2] = std::array::from_fn(|k| {
            let t = if random.below(3) == 0 { random.below(2) as f64 } else { random.unit() };
            (b.min[k] + (b.max[k] - b.min[k]) * t).clamp(b.min[k], b.max[k])
        });
        Point2::from(x)
    }
}

/// Whether two lines of a plan cross where no pair of doubles may be.
fn has_rounded_crossings(plan: &Plan) -> bool {
    let lines: Vec<Segment2> = plan.lines().iter().map(|l| Segment2::new(l.a, l.b)).collect();
    let boxes: Vec<Aabb<2>> = lines.iter().map(|l| Aabb::around([[l.a.x, l.a.y], [l.b.x, l.b.y]])).collect();
    let tree = BoxTree::build(&boxes, 4);
    let is_axial = |s: &Segment2| s.a.x == s.b.x || s.a.y == s.b.y;
    lines.iter().zip(&boxes).enumerate().any(|(i, (line, b))| {
        let mut found = false;
        tree.visit(
            |other| (0..2).all(|k| b.min[k] <= other.max[k] && other.min[k] <= b.max[k]),
            |j| {
                let other = &lines[j as usize];
                let exact = is_axial(line) && is_axial(other);
                found |= (j as usize) < i && !exact && line.crosses(other);
            },
        );
        found
    })
}

impl RayOracle for PlanWorld {
    const CELLS_ARE_CONVEX: bool = true;

    fn shoot(&self, from: u32, random: &mut Random, visit: &mut dyn FnMut(SightSegment)) -> Option<()> {
        let p = self.place(from, random)?;
        if !self.objects.is_empty() && random.below(8) == 0 {
            let object = random.below(self.objects.len()) as u32;
            visit(Self::sight(from, Target::Object(object), p, self.of_object(object, random)));
        }
        let d = loop {
            let d = Point2::new(2.0 * random.unit() - 1.0, 2.0 * random.unit() - 1.0);
            if (0.01..=1.0).contains(&d.length_squared()) {
                break d;
            }
        };
        let far = self.hit(p, d);
        let (start, direction) = ([p.x, p.y], [d.x, d.y]);
        self.cell_tree.visit(
            |b| clip(start, direction, b, [0.0, far], self.slack).is_some(),
            |cell| {
                if let Some([s, t]) = self.within(cell, p, d, [0.0, far]) {
                    let q = Point2::from(at(start, direction, 0.5 * (s + t)));
                    visit(Self::sight(from, Target::Cell(CellId(cell)), p, q));
                }
            },
        );
        Some(())
    }

    fn proves(&self, sight: &SightSegment) -> bool {
        let [p, q] = flat(sight.segment);
        let arrives = || match sight.target {
            Target::Cell(cell) => self.is_inside(cell.0, q),
            Target::Object(object) => {
                let in_object = self.objects[object as usize].contains([q.x, q.y]);
                let mut in_cell = false;
                self.cell_tree.visit(
                    |b| b.contains([q.x, q.y]),
                    |cell| in_cell |= polygon_contains(&self.cells[cell as usize], q),
                );
                in_object && in_cell
            }
        };
        p != q && self.is_inside(sight.from.0, p) && arrives() && self.is_free(p, q)
    }

    fn aim(&self, table: &Table, from: u32, target: Target, tries: u32, random: &mut Random) -> Option<SightSegment> {
        if let Target::Cell(to) = target
            && let Some(sight) = self.through_slits(table, from, to.0, tries)
        {
            return Some(sight);
        }
        (0..tries).find_map(|_| {
            let p = self.place(from, random)?;
            let q = match target {
                Target::Cell(to) => self.place(to.0, random)?,
                Target::Object(object) => self.of_object(object, random),
            };
            let sight = Self::sight(from, target, p, q);
            self.proves(&sight).then_some(sight)
        })
    }

    const SAMPLES: [bool; 2] = [true, true];

    fn sample(
        &self,
        from: u32,
        target: Target,
        random: &mut Random,
        may_lead: &dyn Fn(&SightSegment) -> bool,
    ) -> Sample {
        let Some(p) = self.any_place(from, random) else { return Sample::Nowhere };
        let end = match target {
            Target::Cell(to) => self.any_place(to.0, random),
            Target::Object(object) => {
                let b = &self.objects[object as usize];
                let x = |k: usize, t: f64| (b.min[k] + (b.max[k] - b.min[k]) * t).clamp(b.min[k], b.max[k]);
                Some(Point2::new(x(0, random.unit()), x(1, random.unit())))
            }
        };
        let Some(q) = end else { return Sample::Nowhere };
        let sight = Self::sight(from, target, p, q);
        Sample::of((may_lead(&sight) && self.proves(&sight)).then_some(sight))
    }

    fn neighbours(&self) -> &[Vec<u32>] {
        &self.next
    }

    fn misses(&self, portal: &PortalRecord, segment: [Point3; 2]) -> bool {
        let ([p, q], [a, b]) = (flat(segment), ends(portal));
        // Of segments that are apart, an end of one is nearest to the other.
        let reach = [(p, a, b), (q, a, b), (a, p, q), (b, p, q)].map(|(p, a, b)| distance(p, a, b));
        segments_apart(p, q, a, b) && reach.into_iter().all(|d| self.clearance == 0.0 || d > 2.0 * self.clearance)
    }

    fn crosses(&self, portal: &PortalRecord, segment: [Point3; 2]) -> bool {
        let ([p, q], [a, b]) = (flat(segment), ends(portal));
        let across = |s: f64, t: f64| (s > 0.0 && t < 0.0) || (s < 0.0 && t > 0.0);
        across(orient2d(p, q, a), orient2d(p, q, b)) && across(orient2d(a, b, p), orient2d(a, b, q))
    }

    fn through_borders(&self, from: u32, portals: &[&PortalRecord]) -> Vec<SightSegment> {
        let corners = &self.cells[from as usize];
        let mut found = Vec::new();
        for (i, &start) in corners.iter().enumerate() {
            let d = corners[(i + 1) % corners.len()] - start;
            let square = d.length_squared();
            if square == 0.0 {
                continue;
            }
            // What is on the border changes only where something ends.
            let around = Aabb::around([[start.x, start.y], [start.x + d.x, start.y + d.y]]);
            let reach = self.slack;
            let near =
                |b: &Aabb<2>| (0..2).all(|k| b.min[k] - reach <= around.max[k] && around.min[k] <= b.max[k] + reach);
            let is_on = |p: &Point2| distance(*p, start, start + d) <= 4.0 * reach;
            let mut points: Vec<Point2> = portals.iter().flat_map(|portal| ends(portal)).filter(is_on).collect();
            self.wall_tree.visit(near, |w| points.extend(self.walls[w as usize].iter().filter(|p| is_on(p))));
            let mut others = Vec::new();
            self.cell_tree.visit(near, |cell| others.push(cell));
            others.sort_unstable();
            // Cells have no corners within the sides of others, but where one of the two has a corner on the border.
            let touches = |&other: &u32| {
                let corners = &self.cells[other as usize];
                let sides = corners.iter().zip(corners.iter().cycle().skip(1));
                corners.iter().any(is_on) || sides.into_iter().any(|(&a, &b)| distance(start, a, b) <= 4.0 * reach)
            };
            others.retain(|other| *other > from && touches(other));
            points.extend(others.iter().flat_map(|&cell| &self.cells[cell as usize]).filter(|p| is_on(p)));
            let along = points.into_iter().map(|p| (p - start).dot(d) / square).collect();
            let inwards = d.perp();
            for t in middles([0.0, 1.0], along) {
                for share in DEPTHS {
                    let [p, q] = [share, -share].map(|share| start + d * t + inwards * share);
                    if let Some(&to) = others.iter().find(|&&other| self.is_inside(other, q)) {
                        found.push(Self::sight(from, Target::Cell(CellId(to)), p, q));
                    }
                }
            }
        }
        found
    }
}

/// How far segments through a border reach into cells, as shares of the length of that side of a cell: little, as something may be near, and more, as
/// ends have to be clear of bent walls.
const DEPTHS: [f64; 4] = [1.0 / (1u64 << 20) as f64, 1.0 / 1024.0, 1.0 / 32.0, 0.25];

fn flat(segment: [Point3; 2]) -> [Point2; 2] {
    segment.map(|[x, y, _]| Point2::new(x, y))
}

/// How far a point is from a segment; rounded.
fn distance(p: Point2, a: Point2, b: Point2) -> f64 {
    if a == b {
        return p.distance(a);
    }
    let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    (a + (b - a) * along).distance(p)
}
