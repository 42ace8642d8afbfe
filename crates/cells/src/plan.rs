//! Scenes in the plane: lines that block sight or only divide, and objects.

mod joints;
mod precision;

pub use joints::Joint;

use sightlines_geometry::{Aabb, CoordinateError, Point2, SmallGrid, check_coordinate};

/// Index of a line of a [`Plan`], in input order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LineId(pub u32);

/// A line of a plan, from `a` to `b`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanLine {
    /// Start.
    pub a: Point2,
    /// End, different from the start.
    pub b: Point2,
    /// Whether it blocks sight. A line that does not block only divides the plane into groups.
    pub opaque: bool,
    /// Group (a Doom sector) of the region to the left of `a` to `b`, if the line names one.
    pub left: Option<u32>,
    /// Group of the region to the right of `a` to `b`, if the line names one.
    pub right: Option<u32>,
}

impl PlanLine {
    /// An opaque wall that names no group.
    pub const fn wall(a: Point2, b: Point2) -> Self {
        Self { a, b, opaque: true, left: None, right: None }
    }
}

/// Something in a plan that is seen or not, but never hides anything: a box, often a single point.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanObject {
    /// What users call it.
    pub name: String,
    /// Its extent in scene units.
    pub bounds: Aabb<2>,
}

/// A scene in the plane, checked: coordinates that the predicates accept, no line of length zero.
///
/// Lines may cross, overlap, touch and repeat as they like.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Plan {
    lines: Vec<PlanLine>,
    objects: Vec<PlanObject>,
    mirrors: Vec<LineId>,
    n_groups: u32,
    precision: Option<f64>,
    joints: Vec<Joint>,
    gap: f64,
}

/// Why lines and objects do not make a plan.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// A coordinate of a line cannot be used.
    #[error("line {line}: {kind}")]
    Line {
        /// Index of the line.
        line: usize,
        /// What is wrong with it.
        #[source]
        kind: CoordinateError,
    },
    /// Start and end of a line are one point.
    #[error("line {line} has length zero at ({x}, {y})")]
    ZeroLength {
        /// Index of the line.
        line: usize,
        /// Where.
        x: f64,
        /// Where.
        y: f64,
    },
    /// A coordinate of an object cannot be used.
    #[error("object {object}: {kind}")]
    Object {
        /// Index of the object.
        object: usize,
        /// What is wrong with it.
        #[source]
        kind: CoordinateError,
    },
    /// A box of an object has its corners exchanged.
    #[error("object {object} has a lower corner above its upper one")]
    Inverted {
        /// Index of the object.
        object: usize,
    },
    /// A line names a group whose number has no successor.
    #[error("line {line} names group {}, which is too large", u32::MAX)]
    Group {
        /// Index of the line.
        line: usize,
    },
    /// What is marked as a mirror is no line, or one that does not block sight.
    #[error("line {line} cannot be a mirror: there is no such opaque line")]
    Mirror {
        /// Index of the line.
        line: usize,
    },
    /// Coordinates cannot be taken to be as imprecise as was stated.
    #[error(
        "a gap of {gap:?} is neither 0 nor at least {least:.2e}, what the coordinates of the plan are off by when it is turned"
    )]
    Gap {
        /// The gap.
        gap: f64,
        /// The least one.
        least: f64,
    },
    /// More lines than ids.
    #[error("{0} lines are more than a plan can hold")]
    TooMany(usize),
}

impl Plan {
    /// Checks `lines` and `objects`. Negative zeros become zeros.
    ///
    /// # Errors
    /// [`PlanError`] with the index of the first offender.
    pub fn new(lines: Vec<PlanLine>, objects: Vec<PlanObject>) -> Result<Self, PlanError> {
        if u32::try_from(lines.len()).is_err() {
            return Err(PlanError::TooMany(lines.len()));
        }
        let (mut lines, mut objects) = (lines, objects);
        for (line, l) in lines.iter_mut().enumerate() {
            for p in [&mut l.a, &mut l.b] {
                *p = check_point(*p).map_err(|kind| PlanError::Line { line, kind })?;
            }
            if l.a == l.b {
                return Err(PlanError::ZeroLength { line, x: l.a.x, y: l.a.y });
            }
            if [l.left, l.right].contains(&Some(u32::MAX)) {
                return Err(PlanError::Group { line });
            }
        }
        for (object, o) in objects.iter_mut().enumerate() {
            for x in o.bounds.min.iter_mut().chain(&mut o.bounds.max) {
                *x = check_coordinate(*x).map_err(|kind| PlanError::Object { object, kind })?;
            }
            if o.bounds.is_empty() {
                return Err(PlanError::Inverted { object });
            }
        }
        let named = lines.iter().flat_map(|l| [l.left, l.right]).flatten().max();
        Ok(Self { lines, objects, n_groups: named.map_or(0, |g| g + 1), ..Self::default() })
    }

    /// Opaque walls only, without groups or objects.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn from_walls(walls: impl IntoIterator<Item = (Point2, Point2)>) -> Result<Self, PlanError> {
        Self::new(walls.into_iter().map(|(a, b)| PlanLine::wall(a, b)).collect(), Vec::new())
    }

    /// The same plan, with these lines as mirrors, on both sides, and no others.
    ///
    /// # Errors
    /// [`PlanError::Mirror`] for a line that does not exist or is not opaque.
    pub fn with_mirrors(mut self, mut mirrors: Vec<LineId>) -> Result<Self, PlanError> {
        mirrors.sort_unstable();
        mirrors.dedup();
        let is_wall = |id: &LineId| self.lines.get(id.0 as usize).is_some_and(|line| line.opaque);
        if let Some(id) = mirrors.iter().find(|id| !is_wall(id)) {
            return Err(PlanError::Mirror { line: id.0 as usize });
        }
        self.mirrors = mirrors;
        Ok(self)
    }

    /// The lines that are mirrors, ascending.
    pub fn mirrors(&self) -> &[LineId] {
        &self.mirrors
    }

    /// The lines, in input order.
    pub fn lines(&self) -> &[PlanLine] {
        &self.lines
    }

    /// The objects, in input order.
    pub fn objects(&self) -> &[PlanObject] {
        &self.objects
    }

    /// One more than the largest group that a line names; 0 if none does.
    pub fn n_groups(&self) -> u32 {
        self.n_groups
    }

    /// Smallest box around all lines; empty for a plan without lines.
    pub fn bounds(&self) -> Aabb<2> {
        Aabb::around(self.points().map(|p| [p.x, p.y]))
    }

    /// Whether every line is parallel to an axis, so that a k-d tree can follow all of them.
    pub fn is_axial(&self) -> bool {
        self.lines.iter().all(|l| l.a.x == l.b.x || l.a.y == l.b.y)
    }

    /// The predicate for small grids, if all end points are on one.
    pub fn small_grid(&self) -> Option<SmallGrid> {
        SmallGrid::covering(self.points())
    }

    /// All end points, repeated as often as they occur.
    pub fn points(&self) -> impl Iterator<Item = Point2> + Clone + '_ {
        self.lines.iter().flat_map(|l| [l.a, l.b])
    }
}

fn check_point(p: Point2) -> Result<Point2, CoordinateError> {
    Ok(Point2::new(check_coordinate(p.x)?, check_coordinate(p.y)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(ax: f64, ay: f64, bx: f64, by: f64) -> PlanLine {
        PlanLine::wall(Point2::new(ax, ay), Point2::new(bx, by))
    }

    #[test]
    fn plans_are_checked() {
        let bad = Plan::new(vec![line(0., 0., 1., 0.), line(0., f64::NAN, 1., 0.)], vec![]);
        assert_eq!(bad.unwrap_err().to_string(), "line 1: coordinate NaN is not a finite number");
        let bad = Plan::new(vec![line(2., 3., 2., 3.)], vec![]);
        assert_eq!(bad.unwrap_err().to_string(), "line 0 has length zero at (2, 3)");
        let bad = PlanLine { left: Some(u32::MAX), ..line(0., 0., 1., 0.) };
        let bad = Plan::new(vec![bad], vec![]).unwrap_err();
        assert_eq!(bad.to_string(), "line 0 names group 4294967295, which is too large");
        let bounds = Aabb { min: [1., 0.], max: [0., 0.] };
        let bad = Plan::new(vec![], vec![PlanObject { name: String::new(), bounds }]).unwrap_err();
        assert_eq!(bad.to_string(), "object 0 has a lower corner above its upper one");
    }

    #[test]
    fn mirrors_are_opaque_lines() {
        let glass = PlanLine { opaque: false, ..line(0., 1., 1., 1.) };
        let plan = Plan::new(vec![line(0., 0., 1., 0.), glass, line(0., 2., 1., 2.)], vec![]).unwrap();
        assert!(plan.mirrors().is_empty());
        let marked = plan.clone().with_mirrors([2, 0, 2].map(LineId).to_vec()).unwrap();
        assert_eq!(marked.mirrors(), [LineId(0), LineId(2)]);
        for bad in [1, 3] {
            let error = plan.clone().with_mirrors(vec![LineId(bad)]).unwrap_err().to_string();
            assert_eq!(error, format!("line {bad} cannot be a mirror: there is no such opaque line"));
        }
    }

    #[test]
    fn plans_know_their_shape() {
        let mut lines = vec![line(-0.0, 0., 4., 0.), line(0., 0., 0., 3.)];
        lines[1].left = Some(6);
        let plan = Plan::new(lines.clone(), vec![]).unwrap();
        assert!(plan.is_axial() && plan.small_grid().is_some());
        assert_eq!((plan.n_groups(), plan.bounds().max), (7, [4.0, 3.0]));
        assert_eq!(plan.lines()[0].a.x.to_bits(), 0);
        lines.push(line(0., 0., 0.1, 1.));
        let plan = Plan::new(lines, vec![]).unwrap();
        assert!(!plan.is_axial() && plan.small_grid().is_none());
    }
}
