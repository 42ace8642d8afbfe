//! From text to portals.

use super::error::point_range;
use super::lexer::{Lexer, Token};
use super::{LeafList, MAX_CLUSTERS, Prt, PrtDialect, PrtError, PrtErrorKind, PrtItem};
use sightlines_cells::Point3;
use std::ops::RangeInclusive;

/// Reads a portal file of any known dialect.
///
/// Takes time and memory in proportion to the text, whatever counts it claims.
///
/// # Errors
/// [`PrtError`] with line and column.
///
/// # Source
/// The grammar is what compilers write: `PRT1` of id Software's qbsp, `PRT2` of ericw-tools, `PRT1-AM` of
/// bjptools. Chosen here: text behind the end is refused, and so are a portal from a cluster to itself and a
/// leaf in no or two clusters, and portals whose corners go round the wrong way ([`Prt::inside_out`]): through these a search would see
/// nothing of what is seen in truth. Portals without area are kept ([`PrtPortal::is_degenerate`]).
///
/// [`PrtPortal::is_degenerate`]: super::PrtPortal::is_degenerate
pub fn parse_prt(text: &[u8]) -> Result<Prt, PrtError> {
    let mut reader = Reader { lexer: Lexer::new(text) };
    let magic = reader.lexer.next();
    let dialect = PrtDialect::ALL.into_iter().find(|d| magic.bytes == Some(d.magic().as_bytes()));
    let dialect = dialect.ok_or_else(|| unexpected(&magic, PrtItem::Magic))?;
    let header = reader.header(dialect)?;
    let mut prt = Prt::new(header.n_clusters).map_err(|kind| at(&magic, kind))?;
    let (mut points, mut places) = (Vec::new(), Vec::new());
    for portal in 0..header.n_portals as usize {
        places.push(reader.portal(portal, &mut prt, &mut points)?);
    }
    if let Some(portal) = prt.inside_out() {
        let clusters = prt.portal(portal).clusters;
        return Err(at(&places[portal], PrtErrorKind::InsideOut { portal, clusters }));
    }
    let prt = match dialect {
        PrtDialect::Prt1 => prt,
        PrtDialect::Prt2 => {
            let leafs = reader.leafs_of_clusters(&header)?;
            prt.with_leafs(LeafList::PerCluster, leafs).map_err(|kind| at(&magic, kind))?
        }
        PrtDialect::Prt1Am => {
            let leafs = reader.clusters_of_leafs(&header)?;
            prt.with_leafs(LeafList::PerLeaf, leafs).map_err(|kind| at(&magic, kind))?
        }
    };
    let end = reader.lexer.next();
    if end.bytes.is_some() { Err(unexpected(&end, PrtItem::End)) } else { Ok(prt) }
}

/// The line on which a portal of a portal file begins, counted from 1; `None` if the text has no such portal that can be read. For messages about
/// portals after the text was read.
pub fn line_of_portal(text: &[u8], portal: usize) -> Option<usize> {
    let mut reader = Reader { lexer: Lexer::new(text) };
    let magic = reader.lexer.next();
    let dialect = PrtDialect::ALL.into_iter().find(|d| magic.bytes == Some(d.magic().as_bytes()))?;
    let header = reader.header(dialect).ok()?;
    let mut prt = Prt::new(header.n_clusters).ok()?;
    let n_before = (portal < header.n_portals as usize).then_some(portal)?;
    let mut points = Vec::new();
    (0..n_before).try_for_each(|k| reader.portal(k, &mut prt, &mut points).map(drop)).ok()?;
    reader.portal(portal, &mut prt, &mut points).ok().map(|place| place.line)
}

struct Header {
    n_clusters: u32,
    n_portals: u32,
    n_leafs: u32,
}

struct Reader<'t> {
    lexer: Lexer<'t>,
}

impl<'t> Reader<'t> {
    fn header(&mut self, dialect: PrtDialect) -> Result<Header, PrtError> {
        let (mut n_clusters, mut n_portals, mut n_leafs) = (0, 0, 0);
        let order: &[PrtItem] = match dialect {
            PrtDialect::Prt1 => &[PrtItem::Clusters, PrtItem::Portals],
            PrtDialect::Prt2 => &[PrtItem::Leafs, PrtItem::Clusters, PrtItem::Portals],
            PrtDialect::Prt1Am => &[PrtItem::Clusters, PrtItem::Portals, PrtItem::Leafs],
        };
        for &item in order {
            match item {
                PrtItem::Clusters => n_clusters = self.number(item, 1..=u64::from(MAX_CLUSTERS))?.1,
                PrtItem::Leafs => n_leafs = self.leaf_count()?,
                _ => n_portals = self.number(item, 0..=u64::from(u32::MAX))?.1,
            }
        }
        Ok(Header { n_clusters, n_portals, n_leafs })
    }

    /// The number of leafs, which is believed only if the text is long enough to list them.
    fn leaf_count(&mut self) -> Result<u32, PrtError> {
        let (token, n_leafs) = self.number(PrtItem::Leafs, 1..=u64::from(u32::MAX))?;
        // Each takes a digit, and something between it and the next.
        let n_bytes = self.lexer.n_left();
        let fits = 2 * u64::from(n_leafs) <= n_bytes as u64 + 1;
        if fits { Ok(n_leafs) } else { Err(at(&token, PrtErrorKind::LeafClaim { n_leafs, n_bytes })) }
    }

    /// Adds a portal, and returns where it begins.
    fn portal(&mut self, portal: usize, prt: &mut Prt, points: &mut Vec<Point3>) -> Result<Token<'t>, PrtError> {
        let (place, n_points) = self.number(PrtItem::Points { portal }, point_range())?;
        let clusters = 0..=u64::from(prt.n_clusters() - 1);
        let (_, a) = self.number(PrtItem::Cluster { portal }, clusters.clone())?;
        let (_, b) = self.number(PrtItem::Cluster { portal }, clusters)?;
        points.clear();
        for point in 0..n_points as usize {
            self.sign(b"(", PrtItem::Open { portal, point })?;
            points.push([
                self.coordinate(portal, point)?,
                self.coordinate(portal, point)?,
                self.coordinate(portal, point)?,
            ]);
            self.sign(b")", PrtItem::Close { portal, point })?;
        }
        prt.push_portal([a, b], points).map_err(|kind| at(&place, kind))?;
        Ok(place)
    }

    /// The lists of a `PRT2`, as the cluster of each leaf.
    fn leafs_of_clusters(&mut self, header: &Header) -> Result<Vec<u32>, PrtError> {
        // `u32::MAX` is no cluster: there are at most `MAX_CLUSTERS`. The length is backed by the text.
        let mut owners = vec![u32::MAX; header.n_leafs as usize];
        for cluster in 0..header.n_clusters {
            let item = PrtItem::LeafOfCluster { cluster: cluster as usize };
            loop {
                let token = self.token(item)?;
                if token.bytes == Some(b"-1") {
                    break;
                }
                let leaf = whole(&token, item, 0..=u64::from(header.n_leafs - 1))?;
                let owner = &mut owners[leaf as usize];
                if *owner != u32::MAX {
                    return Err(at(&token, PrtErrorKind::LeafTwice { leaf, first: *owner, second: cluster }));
                }
                *owner = cluster;
            }
        }
        match owners.iter().position(|&owner| owner == u32::MAX) {
            Some(leaf) => Err(at(&self.lexer.next(), PrtErrorKind::LeafMissing { leaf })),
            None => Ok(owners),
        }
    }

    /// The list of a `PRT1-AM`.
    fn clusters_of_leafs(&mut self, header: &Header) -> Result<Vec<u32>, PrtError> {
        let clusters = 0..=u64::from(header.n_clusters - 1);
        let leafs = 0..header.n_leafs as usize;
        leafs.map(|leaf| Ok(self.number(PrtItem::ClusterOfLeaf { leaf }, clusters.clone())?.1)).collect()
    }

    fn token(&mut self, item: PrtItem) -> Result<Token<'t>, PrtError> {
        let token = self.lexer.next();
        if token.bytes.is_some() { Ok(token) } else { Err(unexpected(&token, item)) }
    }

    fn number(&mut self, item: PrtItem, range: RangeInclusive<u64>) -> Result<(Token<'t>, u32), PrtError> {
        let token = self.token(item)?;
        let number = whole(&token, item, range)?;
        Ok((token, number))
    }

    fn sign(&mut self, sign: &[u8], item: PrtItem) -> Result<(), PrtError> {
        let token = self.lexer.next();
        if token.bytes == Some(sign) { Ok(()) } else { Err(unexpected(&token, item)) }
    }

    fn coordinate(&mut self, portal: usize, point: usize) -> Result<f64, PrtError> {
        let item = PrtItem::Coordinate { portal, point };
        let token = self.token(item)?;
        // Rust would read "nan" and "inf" too; they are not decimals.
        let is_decimal = |b: &u8| matches!(b, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E');
        let text = token.bytes.filter(|bytes| bytes.iter().all(is_decimal));
        let number = text.and_then(|bytes| std::str::from_utf8(bytes).ok()?.parse().ok());
        number.ok_or_else(|| unexpected(&token, item))
    }
}

/// A whole number in a range whose end fits 32 bits.
fn whole(token: &Token<'_>, item: PrtItem, range: RangeInclusive<u64>) -> Result<u32, PrtError> {
    let text = token.bytes.and_then(|bytes| std::str::from_utf8(bytes).ok()).unwrap_or_default();
    let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return Err(unexpected(token, item));
    }
    let number = text.parse::<u64>().ok().filter(|n| range.contains(n)).and_then(|n| u32::try_from(n).ok());
    number.ok_or_else(|| at(token, count_error(item, token.shown(), range)))
}

pub(super) fn count_error(item: PrtItem, found: impl ToString, range: RangeInclusive<u64>) -> PrtErrorKind {
    PrtErrorKind::Count { item, found: found.to_string(), min: *range.start(), max: *range.end() }
}

fn at(token: &Token<'_>, kind: PrtErrorKind) -> PrtError {
    PrtError { line: token.line, column: token.column, kind }
}

fn unexpected(token: &Token<'_>, item: PrtItem) -> PrtError {
    let kind = match token.bytes {
        Some(_) => PrtErrorKind::Unexpected { item, found: token.shown() },
        None => PrtErrorKind::Truncated { item },
    };
    at(token, kind)
}
