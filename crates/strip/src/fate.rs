//! What becomes of parts of a scene, and why.

use sightlines_geometry::Point3;

/// Why a part is hidden from all eyes. Later ones promise less.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum HiddenReason {
    /// A closed surface is between it and every eye, or walls along the axes leave no way to it, exactly.
    Enclosed,
    /// Chains of surfaces block all lines from the eyes, exactly.
    LineSpace,
    /// A table hides it from all of its cells, as far as the table promises.
    Table,
    /// No ball as wide as the stated gap touches it on its way from the eyes: it is seen only through narrower openings, which count as closed.
    Gap,
}

impl HiddenReason {
    /// All of them, the strongest first.
    pub const ALL: [Self; 4] = [Self::Enclosed, Self::LineSpace, Self::Table, Self::Gap];

    /// As reports have it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Enclosed => "enclosed",
            Self::LineSpace => "line-space",
            Self::Table => "table",
            Self::Gap => "gap",
        }
    }
}

/// What is known of a part: an object, or a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fate {
    /// It is seen. The segment leads from an eye through a point of it, and nothing that hides touches it before, or behind it
    /// up to its end; decided exactly.
    Seen([Point3; 2]),
    /// No eye sees it.
    Hidden(HiddenReason),
    /// Neither was found. It is kept.
    Undecided,
    /// It was not asked about, and is kept: at the caller's wish, because it has no triangles, or because it moves and may be anywhere.
    Kept,
}

impl Fate {
    /// Whether it can go.
    pub const fn is_hidden(&self) -> bool {
        matches!(self, Self::Hidden(_))
    }
}

/// What becomes of an object.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectFate {
    /// What is known of it: seen if any triangle of it is, hidden if all are, for the reason of them that promises least.
    pub fate: Fate,
    /// Of each of its triangles, if these count one by one; else empty.
    pub triangles: Vec<Fate>,
}

impl ObjectFate {
    pub(crate) const fn whole(fate: Fate) -> Self {
        Self { fate, triangles: Vec::new() }
    }

    pub(crate) fn of_triangles(triangles: Vec<Fate>) -> Self {
        let seen = triangles.iter().find(|fate| matches!(fate, Fate::Seen(_)));
        let reasons = triangles.iter().map(|fate| match fate {
            Fate::Hidden(reason) => Some(*reason),
            _ => None,
        });
        let hidden = reasons.collect::<Option<Vec<_>>>().and_then(|reasons| reasons.into_iter().max());
        let fate = match (seen, hidden) {
            (Some(seen), _) => *seen,
            (None, Some(reason)) => Fate::Hidden(reason),
            (None, None) => Fate::Undecided,
        };
        Self { fate, triangles }
    }

    /// How many parts of it are undecided.
    pub(crate) fn n_undecided(&self) -> usize {
        let each = if self.triangles.is_empty() { std::slice::from_ref(&self.fate) } else { &self.triangles[..] };
        each.iter().filter(|fate| **fate == Fate::Undecided).count()
    }

    /// Whether a triangle of the object can go.
    pub fn hides(&self, triangle: usize) -> bool {
        self.triangles.get(triangle).map_or(self.fate.is_hidden(), Fate::is_hidden)
    }
}

/// How many parts have which fate.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct FateCounts {
    /// All.
    pub all: usize,
    /// Seen, with a free segment.
    pub seen: usize,
    /// Hidden, by the reasons in the order of [`HiddenReason::ALL`].
    pub hidden: [usize; HiddenReason::ALL.len()],
    /// Neither.
    pub undecided: usize,
    /// Not asked about.
    pub kept: usize,
}

impl FateCounts {
    pub(crate) fn add(&mut self, fate: &Fate, n: usize) {
        self.all += n;
        match fate {
            Fate::Seen(_) => self.seen += n,
            Fate::Hidden(reason) => self.hidden[*reason as usize] += n,
            Fate::Undecided => self.undecided += n,
            Fate::Kept => self.kept += n,
        }
    }

    /// Hidden for any reason.
    pub fn n_hidden(&self) -> usize {
        self.hidden.iter().sum()
    }
}
