//! From text to portals.

use super::lexer::{Token, next};
use super::{LeafList, MAX_CLUSTERS, PORTAL_POINTS, Prt, PrtDialect, SolidFace, beyond};
use crate::cursor::{Cursor, Place};
use crate::error::{Malformed, Within, malformed};
use crate::point::check_point;
use sightlines_cells::Point3;
use std::fmt::Arguments;
use std::ops::RangeInclusive;

/// Reads a portal file of any known dialect.
///
/// Takes time and memory in proportion to the text, whatever counts it claims.
///
/// # Errors
/// [`Malformed`] with line and column.
///
/// # Source
/// The grammar is what compilers write: `PRT1` of id Software's qbsp, `PRT2` of ericw-tools, `PRT1-AM` of
/// bjptools, that of Half-Life's as VHLT's vis reads it, that of Quake III's as id Software's published q3map reads it. Chosen here: text behind
/// the end is refused, and so are a portal from a cluster to itself and a
/// leaf in no or two clusters, and portals whose corners go round the wrong way ([`Prt::inside_out`]): through these a search would see
/// nothing of what is seen in truth. Portals without area are kept ([`PrtPortal::is_degenerate`]).
///
/// [`PrtPortal::is_degenerate`]: super::PrtPortal::is_degenerate
pub fn parse_prt(text: &[u8]) -> Result<Prt, Malformed> {
    let mut reader = Reader(Cursor::new(text));
    let (magic, header) = reader.header()?;
    let mut prt = Prt::new(header.n_clusters).map_err(|what| magic.place.error(what))?;
    let (mut points, mut places, mut hints) = (Vec::new(), Vec::new(), Vec::new());
    for portal in 0..header.n_portals as usize {
        let (place, hint) = reader.portal(portal, header.dialect, &mut prt, &mut points)?;
        places.push(place);
        hints.extend(hint);
    }
    if let Some(portal) = prt.inside_out() {
        let [a, b] = prt.portal(portal).clusters;
        return Err(places[portal].error(malformed!(
            "portal {portal}: its corners are in the wrong order: the other portals of clusters {a} and {b} lie on the wrong side of it, so what is visible through it would be hidden"
        )));
    }
    let prt = match header.dialect {
        PrtDialect::Prt1 => Ok(prt),
        PrtDialect::Prt2 => prt.with_leafs(LeafList::PerCluster, reader.leafs_of_clusters(&header)?),
        PrtDialect::Prt1Am => prt.with_leafs(LeafList::PerLeaf, reader.clusters_of_leafs(&header)?),
        PrtDialect::HalfLife => prt.with_leafs(LeafList::Counts, header.clusters),
        PrtDialect::Quake3 => {
            let faces = (0..header.n_faces as usize).map(|face| reader.face(face, header.n_clusters));
            prt.with_faces(hints, faces.collect::<Result<_, _>>()?)
        }
    };
    let prt = prt.map_err(|what| magic.place.error(what))?;
    let end = next(&mut reader.0);
    if end.bytes.is_some() { Err(end.unexpected("the end of the file")) } else { Ok(prt) }
}

/// The line on which a portal of a portal file begins, counted from 1; `None` if the text has no such portal that can be read. For messages about
/// portals after the text was read.
pub fn line_of_portal(text: &[u8], portal: usize) -> Option<usize> {
    let mut reader = Reader(Cursor::new(text));
    let (_, header) = reader.header().ok()?;
    let mut prt = Prt::new(header.n_clusters).ok()?;
    let n_before = (portal < header.n_portals as usize).then_some(portal)?;
    let mut points = Vec::new();
    let mut read = |k: usize| reader.portal(k, header.dialect, &mut prt, &mut points);
    (0..n_before).try_for_each(|k| read(k).map(drop)).ok()?;
    read(portal).ok().map(|(place, _)| place.line)
}

struct Header {
    dialect: PrtDialect,
    n_clusters: u32,
    n_portals: u32,
    n_leafs: u32,
    n_faces: u32,
    /// The cluster of each leaf, where the numbers of leafs stand before the portals.
    clusters: Vec<u32>,
}

struct Reader<'t>(Cursor<'t>);

impl<'t> Reader<'t> {
    fn header(&mut self) -> Result<(Token<'t>, Header), Malformed> {
        let magic = next(&mut self.0);
        let named = PrtDialect::ALL.into_iter().find(|d| d.magic().is_some_and(|m| magic.bytes == Some(m.as_bytes())));
        let is_number = magic.bytes.is_some_and(|bytes| bytes.iter().all(u8::is_ascii_digit));
        let dialect = named.or(is_number.then_some(PrtDialect::HalfLife));
        let dialect = dialect.ok_or_else(|| magic.unexpected("PRT1, PRT2, PRT1-AM or the number of clusters"))?;
        let (n_clusters, n_portals, clusters) = (0, 0, Vec::new());
        let mut header = Header { dialect, n_clusters, n_portals, n_leafs: 0, n_faces: 0, clusters };
        if dialect == PrtDialect::Prt2 {
            header.n_leafs = self.leaf_count()?;
        }
        let range = 1..=u64::from(MAX_CLUSTERS);
        let clusters = format_args!("the number of clusters");
        header.n_clusters = match dialect {
            PrtDialect::HalfLife => whole(&magic, clusters, range)?,
            _ => self.number(clusters, range)?.1,
        };
        header.n_portals = self.number(format_args!("the number of portals"), ANY)?.1;
        match dialect {
            PrtDialect::Prt1Am => header.n_leafs = self.leaf_count()?,
            PrtDialect::HalfLife => header.clusters = self.leaf_counts(header.n_clusters)?,
            PrtDialect::Prt1 if self.has_faces(header.n_portals) => {
                header.dialect = PrtDialect::Quake3;
                header.n_faces = self.number(format_args!("the number of solid faces"), ANY)?.1;
            }
            _ => {}
        }
        Ok((magic, header))
    }

    /// Whether a `PRT1` is that of Quake III, told by the pieces behind its two counts; see [`PrtDialect::Quake3`].
    fn has_faces(&self, n_portals: u32) -> bool {
        let mut ahead = self.0.clone();
        let is_number = |token: Token<'_>| token.bytes.is_some_and(|bytes| bytes.iter().all(u8::is_ascii_digit));
        let n_numbers = if n_portals == 0 { 1 } else { 5 };
        (0..n_numbers).all(|_| is_number(next(&mut ahead))) && (n_portals == 0 || next(&mut ahead).bytes == Some(b"("))
    }

    /// The numbers of leafs of clusters, as the cluster of each leaf. In all there are as many as maps of that kind can have at most.
    fn leaf_counts(&mut self, n_clusters: u32) -> Result<Vec<u32>, Malformed> {
        let mut clusters = Vec::new();
        for cluster in 0..n_clusters {
            let left = u64::from(MAX_CLUSTERS) - clusters.len() as u64;
            let (_, count) = self.number(format_args!("the number of leafs of cluster {cluster}"), 0..=left)?;
            clusters.resize(clusters.len() + count as usize, cluster);
        }
        Ok(clusters)
    }

    /// The number of leafs, which is believed only if the text is long enough to list them.
    fn leaf_count(&mut self) -> Result<u32, Malformed> {
        let (place, n_leafs) = self.number(format_args!("the number of leafs"), 1..=u64::from(u32::MAX))?;
        // Each takes a digit, and something between it and the next.
        let n_bytes = self.0.rest().len();
        let fits = 2 * u64::from(n_leafs) <= n_bytes as u64 + 1;
        let claims = || malformed!("{n_leafs} leafs cannot be listed in the {n_bytes} bytes that follow");
        if fits { Ok(n_leafs) } else { Err(place.error(claims())) }
    }

    /// Adds a portal, and returns where it begins, and its hint where the dialect has them.
    fn portal(
        &mut self,
        portal: usize,
        dialect: PrtDialect,
        prt: &mut Prt,
        points: &mut Vec<Point3>,
    ) -> Result<(Place, Option<u32>), Malformed> {
        let (place, n_points) = self.number(format_args!("the number of points of portal {portal}"), point_range())?;
        let clusters = 0..=u64::from(prt.n_clusters() - 1);
        let mut cluster = || self.number(format_args!("a cluster of portal {portal}"), clusters.clone());
        let (a, b) = (cluster()?.1, cluster()?.1);
        let hint = match dialect {
            PrtDialect::Quake3 => Some(self.number(format_args!("the hint of portal {portal}"), ANY)?.1),
            _ => None,
        };
        points.clear();
        for point in 0..n_points as usize {
            self.sign(b"(", format_args!("the \"(\" before point {point} of portal {portal}"))?;
            points.push(self.point(format_args!("a coordinate of point {point} of portal {portal}"))?);
            self.sign(b")", format_args!("the \")\" behind point {point} of portal {portal}"))?;
        }
        prt.push_portal([a, b], points).map_err(|what| place.error(what))?;
        Ok((place, hint))
    }

    fn face(&mut self, face: usize, n_clusters: u32) -> Result<SolidFace, Malformed> {
        let (place, n_points) =
            self.number(format_args!("the number of points of solid face {face}"), point_range())?;
        let clusters = 0..=u64::from(n_clusters - 1);
        let (_, cluster) = self.number(format_args!("the cluster of solid face {face}"), clusters)?;
        let mut points = Vec::new();
        for point in 0..n_points as usize {
            let item = format_args!("point {point} of solid face {face} in parentheses");
            self.sign(b"(", item)?;
            let p = check_point(self.point(item)?).within(format_args!("solid face {face}, point {point}"));
            points.push(p.map_err(|what| place.error(what))?);
            self.sign(b")", item)?;
        }
        Ok(SolidFace { cluster, points })
    }

    fn point(&mut self, item: Arguments<'_>) -> Result<Point3, Malformed> {
        Ok([self.coordinate(item)?, self.coordinate(item)?, self.coordinate(item)?])
    }

    /// The lists of a `PRT2`, as the cluster of each leaf.
    fn leafs_of_clusters(&mut self, header: &Header) -> Result<Vec<u32>, Malformed> {
        // `u32::MAX` is no cluster: there are at most `MAX_CLUSTERS`. The length is backed by the text.
        let mut owners = vec![u32::MAX; header.n_leafs as usize];
        for cluster in 0..header.n_clusters {
            let item = format_args!("a leaf of cluster {cluster} or -1");
            loop {
                let token = self.token(item)?;
                if token.bytes == Some(b"-1") {
                    break;
                }
                let leaf = whole(&token, item, 0..=u64::from(header.n_leafs - 1))?;
                let owner = &mut owners[leaf as usize];
                if *owner != u32::MAX {
                    return Err(token
                        .place
                        .error(malformed!("leaf {leaf} is in cluster {owner} and in cluster {cluster}")));
                }
                *owner = cluster;
            }
        }
        match owners.iter().position(|&owner| owner == u32::MAX) {
            Some(leaf) => Err(next(&mut self.0).place.error(malformed!("leaf {leaf} is in no cluster"))),
            None => Ok(owners),
        }
    }

    /// The list of a `PRT1-AM`.
    fn clusters_of_leafs(&mut self, header: &Header) -> Result<Vec<u32>, Malformed> {
        let clusters = 0..=u64::from(header.n_clusters - 1);
        let leafs = 0..header.n_leafs as usize;
        leafs.map(|leaf| Ok(self.number(format_args!("the cluster of leaf {leaf}"), clusters.clone())?.1)).collect()
    }

    fn token(&mut self, item: Arguments<'_>) -> Result<Token<'t>, Malformed> {
        let token = next(&mut self.0);
        if token.bytes.is_some() { Ok(token) } else { Err(token.unexpected(item)) }
    }

    fn number(&mut self, item: Arguments<'_>, range: RangeInclusive<u64>) -> Result<(Place, u32), Malformed> {
        let token = self.token(item)?;
        Ok((token.place, whole(&token, item, range)?))
    }

    fn sign(&mut self, sign: &[u8], item: Arguments<'_>) -> Result<(), Malformed> {
        let token = next(&mut self.0);
        if token.bytes == Some(sign) { Ok(()) } else { Err(token.unexpected(item)) }
    }

    fn coordinate(&mut self, item: Arguments<'_>) -> Result<f64, Malformed> {
        let token = self.token(item)?;
        // Rust would read "nan" and "inf" too; they are not decimals.
        let is_decimal = |b: &u8| matches!(b, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E');
        let text = token.bytes.filter(|bytes| bytes.iter().all(is_decimal));
        let number = text.and_then(|bytes| std::str::from_utf8(bytes).ok()?.parse().ok());
        number.ok_or_else(|| token.unexpected(item))
    }
}

const ANY: RangeInclusive<u64> = 0..=u32::MAX as u64;

fn point_range() -> RangeInclusive<u64> {
    *PORTAL_POINTS.start() as u64..=*PORTAL_POINTS.end() as u64
}

fn whole(token: &Token<'_>, item: Arguments<'_>, range: RangeInclusive<u64>) -> Result<u32, Malformed> {
    let text = token.bytes.and_then(|bytes| std::str::from_utf8(bytes).ok()).unwrap_or_default();
    let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return Err(token.unexpected(item));
    }
    let number = text.parse::<u64>().ok().filter(|n| range.contains(n)).and_then(|n| u32::try_from(n).ok());
    number.ok_or_else(|| token.place.error(beyond(token.shown(), range).within(item)))
}
