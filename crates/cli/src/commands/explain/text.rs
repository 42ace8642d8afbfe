//! An explanation for people.

use super::report::Report;
use crate::output::{coordinate, count, point};
use sightlines::bake::GraphKind;
use sightlines::bake::explain::{Answer, BlockedWay, Blocks, Corner, ExactLine, Reason, SightLine};
use sightlines::cells::PortalId;
use sightlines::sightline::{ConvexCertificate, ProofSize};
use sightlines::stabtree::{AxialProof, Blocking};
use std::fmt;

impl fmt::Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cells = self.explanation.cells;
        let cell = if cells == GraphKind::Convex { "cluster" } else { "cell" };
        let [from, to] = self.pair;
        match &self.explanation.answer {
            Answer::Same if cells == GraphKind::Convex => {
                writeln!(f, "both are cluster {from}, and a cluster sees itself")?;
            }
            Answer::Same => writeln!(f, "both are in cell {from}, and a cell sees itself")?,
            Answer::Visible(line, exact) => {
                write!(f, "{cell} {from} sees {cell} {to}")?;
                write_line(f, cell, line, exact)?;
            }
            Answer::Hidden(reason) => {
                write!(f, "{cell} {from} does not see {cell} {to}: ")?;
                self.write_reason(f, reason)?;
            }
            Answer::GivenUp(limit) => {
                write!(f, "{cell} {from} and {cell} {to}: ")?;
                match cells {
                    GraphKind::Planar => writeln!(f, "given up after {limit} cells; see --max-visits")?,
                    GraphKind::Convex => {
                        writeln!(f, "given up after {}; see --max-questions", count(*limit, "question"))?;
                    }
                    _ => writeln!(
                        f,
                        "no line was found, and no proof that there is none, with the digits of doubles and in {}; see \
                         --max-programs",
                        count(*limit, "linear program")
                    )?,
                }
            }
            Answer::Undecided(way) => {
                let list = list(&way.portals);
                writeln!(f, "{cell} {from} and {cell} {to}: undecided whether a line passes portals {list}")?;
            }
            Answer::Unknown { n_rays, hidden_by } => {
                write!(f, "{cell} {from} and {cell} {to}: ")?;
                write_unknown(f, *n_rays, hidden_by)?;
            }
        }
        self.write_listed(f)
    }
}

impl Report<'_> {
    fn write_reason(&self, f: &mut fmt::Formatter<'_>, reason: &Reason) -> fmt::Result {
        let is_of_clusters = self.explanation.cells == GraphKind::Convex;
        match reason {
            Reason::NotConnected => writeln!(f, "no way through portals joins them"),
            Reason::Blocked { n_blocked: 0, .. } if is_of_clusters => writeln!(f, "no way through portals joins them"),
            Reason::Blocked { start, n_blocked, blocked } => {
                if is_of_clusters {
                    let n = count(*n_blocked, "sequence");
                    writeln!(f, "every way from cluster {start} passes one of {n} of portals that no line passes")?;
                } else {
                    let n = count(*n_blocked, "way");
                    writeln!(f, "{n} through portals lead that way, and all are blocked")?;
                }
                let shown = &blocked[..blocked.len().min(self.n_shown)];
                shown.iter().try_for_each(|way| write_blocked(f, way))?;
                write_more(f, *n_blocked, shown.len())
            }
            Reason::Walls(found) => write_walls(f, found, self.n_shown),
        }
    }

    /// How the table compares with the answer, and whether the checker accepts it.
    fn write_listed(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = self.explanation.answer.verdict();
        let undecided = match self.explanation.cells {
            GraphKind::Axial => "the table assumes that they see each other",
            GraphKind::Boxes => "the table says that they see each other: no method has hidden them",
            GraphKind::Planar | GraphKind::Convex => "the table says that they see each other",
        };
        match (verdict, self.listed) {
            (None, Some(true)) => writeln!(f, "{undecided}")?,
            (None, Some(false)) => writeln!(f, "the table says that they do not see each other")?,
            (Some(false), Some(true)) => writeln!(f, "the table lists them as visible all the same")?,
            (Some(true), Some(false)) => match self.past_portals {
                Some(what) => writeln!(f, "the table hides them: {what}")?,
                None => writeln!(f, "the table says that they do not: it is wrong")?,
            },
            _ => {}
        }
        match self.explanation.checked.filter(|_| verdict.is_some()) {
            None => Ok(()),
            Some(true) => writeln!(f, "the independent checker accepts this"),
            Some(false) => writeln!(f, "the independent checker does not accept this"),
        }
    }
}

fn list(portals: &[PortalId]) -> String {
    portals.iter().map(PortalId::to_string).collect::<Vec<_>>().join(" ")
}

fn write_line(f: &mut fmt::Formatter<'_>, cell: &str, line: &SightLine, exact: &ExactLine) -> fmt::Result {
    if let (ExactLine::Segment, Some([p, q])) = (exact, line.ends) {
        return writeln!(f, ": nothing is on the segment from {} to {}", point(&p), point(&q));
    }
    writeln!(f, " through {}", count(line.portals.len() as u64, "portal"))?;
    for ((portal, entered), at) in line.portals.iter().zip(&line.cells[1..]).zip(exact.crossings()) {
        write!(f, "  portal {portal} into {cell} {entered}")?;
        match (exact, at) {
            (ExactLine::Planar(..), Some([x, y, _])) => writeln!(f, " at {}", point(&[x, y]))?,
            (_, Some(at)) => writeln!(f, " at {}", point(&at))?,
            (_, None) => writeln!(f)?,
        }
    }
    let ends = match exact {
        ExactLine::Planar(witness, _) => {
            let [a, b, c] = witness.coefficients();
            writeln!(f, "along the line a x + b y + c = 0 with")?;
            return writeln!(f, "  a = {a}\n  b = {b}\n  c = {c}");
        }
        ExactLine::Convex(points, _) => Some(*points),
        ExactLine::Axial(..) | ExactLine::Segment => line.ends,
    };
    match (ends, exact) {
        (Some([p, q]), _) => writeln!(f, "along the line from {} to {}", point(&p), point(&q)),
        (None, ExactLine::Axial(witness, _)) => {
            let words = |x: [String; 3]| x.join(", ");
            let point = words(witness.point().each_ref().map(ToString::to_string));
            let direction = words(witness.direction().each_ref().map(ToString::to_string));
            writeln!(f, "along the line through ({point}) in direction ({direction})")
        }
        (None, _) => Ok(()),
    }
}

fn write_blocked(f: &mut fmt::Formatter<'_>, BlockedWay { way, proof }: &BlockedWay) -> fmt::Result {
    write!(f, "  blocked: portals {}", list(&way.portals))?;
    match proof {
        Blocks::Corners { lefts, rights } => {
            writeln!(f, "\n    a line would have to pass {}", side("on the right of the left end", lefts))?;
            writeln!(f, "    and {}", side("on the left of the right end", rights))?;
            writeln!(f, "    but no line separates these points")
        }
        Blocks::Convex(why) => writeln!(f, ": {}", words(why)),
    }
}

/// One side of a certificate in words.
fn side(what: &str, corners: &[Corner]) -> String {
    let corner = |c: &Corner| format!("of portal {} at ({}, {})", c.portal, c.point.x, c.point.y);
    let list = corners.iter().map(corner).collect::<Vec<_>>().join(", ");
    let plural = if corners.len() == 1 { "" } else { "s" };
    format!("{what}{plural} {list}")
}

fn words(why: &Blocking) -> String {
    let Blocking::Certificate(certificate) = why else {
        return "one of the two is not ahead of the other".to_owned();
    };
    match &**certificate {
        ConvexCertificate::Plane(_) => {
            "a plane has the first, the next and the last of them on alternate sides".to_owned()
        }
        ConvexCertificate::Boxes(_) => {
            format!("sums of edges are negative for all lines, in {}", count(certificate.n_leaves() as u64, "part"))
        }
        ConvexCertificate::Hulls(_) => "a sum of edges is positive for no line".to_owned(),
        _ => "a certificate of another kind".to_owned(),
    }
}

fn write_more(f: &mut fmt::Formatter<'_>, n: u64, n_shown: usize) -> fmt::Result {
    let n_more = n.saturating_sub(n_shown as u64);
    if n_more > 0 && n_shown > 0 { writeln!(f, "  and {n_more} more") } else { Ok(()) }
}

fn write_walls(f: &mut fmt::Formatter<'_>, found: &AxialProof, n_shown: usize) -> fmt::Result {
    let n_walls = found.walls.len();
    let walls = if n_walls == 1 { "one wall".to_owned() } else { format!("one of {n_walls} walls") };
    writeln!(f, "every line meets {walls} (of {})", found.n_blockers)?;
    for (bounds, n_nodes) in found.most_important().into_iter().take(n_shown) {
        let extent = |k: usize| {
            let (name, min, max) = (["x", "y", "z"][k], bounds.min[k], bounds.max[k]);
            let [low, high] = [min, max].map(coordinate);
            if min == max { format!("{name} = {low}") } else { format!("{name} from {low} to {high}") }
        };
        writeln!(f, "  wall {}, in {}", [0, 1, 2].map(extent).join(", "), count(n_nodes as u64, "step"))?;
    }
    write_more(f, n_walls as u64, n_shown)?;
    let ProofSize { n_leaves, depth, .. } = found.proof.size();
    let (cases, walls) = (count(n_leaves as u64, "case"), count(depth as u64, "wall"));
    writeln!(
        f,
        "the proof has {cases}, by the sides on which a line passes up to {walls}; in none of them a line is left"
    )
}

fn write_unknown(f: &mut fmt::Formatter<'_>, n_rays: Option<u32>, hidden_by: &[String]) -> fmt::Result {
    match n_rays {
        None => {
            writeln!(
                f,
                "the cells of this table have no portals to look through; give the scene that it was made of, --scene SCENE, to shoot rays between them"
            )?;
        }
        Some(n) => writeln!(f, "{} from each found no line between them, which proves nothing", count(n, "ray"))?,
    }
    match hidden_by {
        [] => Ok(()),
        [one] => writeln!(f, "hidden by {one}"),
        some => writeln!(f, "hidden by {}; which one is not recorded", some.join(" or ")),
    }
}
