//! Why pairs of cells see each other, or do not: what the page can say by itself.

/// A line through portals.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// The cells that it passes, in order.
    pub cells: Vec<u32>,
    /// The portals between them, one fewer.
    pub portals: Vec<u32>,
    /// Two points of it, along the axes of the table: in the first cell and in the last. `None` if they are not known; then
    /// only the portals are shown.
    pub ends: Option<[[f64; 3]; 2]>,
}

/// What keeps two cells apart.
#[derive(Debug, Clone, PartialEq)]
pub enum Obstacle {
    /// No chain of portals joins them.
    NotConnected,
    /// Portals that no line passes in this order.
    Portals(Vec<u32>),
    /// Walls, one of which every line meets, as boxes that are flat along one axis.
    Walls(Vec<[[f64; 3]; 2]>),
}

/// The reasons that a page carries.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reasons {
    /// Lines; each stands for all pairs of cells that it passes.
    pub lines: Vec<Line>,
    /// Hidden pairs, the lower number first.
    pub hidden: Vec<([u32; 2], Obstacle)>,
    /// Visible pairs of the table, and how many of them some line joins.
    pub n_pairs: usize,
    /// See `n_pairs`.
    pub n_joined: usize,
}

/// A number of the page: what is larger than 32 bits does not fit on one.
fn number(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}

impl Reasons {
    /// Little-endian, as `why.js` reads it: numbers of lines and hidden pairs; for each line its number of portals, its cells, its
    /// portals, and six coordinates, which are no numbers if there are none; for each hidden pair its cells, its kind, a count, and
    /// that many portals or boxes.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut put = |n: u32| bytes.extend_from_slice(&n.to_le_bytes());
        put(number(self.lines.len()));
        put(number(self.hidden.len()));
        // Alike things together: they deflate better.
        self.lines.iter().for_each(|line| put(number(line.portals.len())));
        self.lines.iter().flat_map(|line| &line.cells).for_each(|cell| put(*cell));
        self.lines.iter().flat_map(|line| &line.portals).for_each(|portal| put(*portal));
        for ([a, b], obstacle) in &self.hidden {
            let (kind, list) = match obstacle {
                Obstacle::NotConnected => (0, &[][..]),
                Obstacle::Portals(portals) => (1, &portals[..]),
                Obstacle::Walls(_) => (2, &[][..]),
            };
            let n = if let Obstacle::Walls(walls) = obstacle { walls.len() } else { list.len() };
            [*a, *b, kind, number(n)].into_iter().chain(list.iter().copied()).for_each(&mut put);
        }
        let ends = self.lines.iter().flat_map(|line| line.ends.unwrap_or([[f64::NAN; 3]; 2]));
        let walls = self.hidden.iter().filter_map(|(_, obstacle)| match obstacle {
            Obstacle::Walls(walls) => Some(walls),
            _ => None,
        });
        let coordinates = ends.flatten().chain(walls.flatten().flatten().flatten().copied());
        bytes.extend(coordinates.flat_map(f64::to_le_bytes));
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_those_that_are_described() {
        let line = Line { cells: vec![4, 5, 6], portals: vec![7, 8], ends: None };
        let hidden = vec![([1, 2], Obstacle::NotConnected), ([1, 3], Obstacle::Walls(vec![[[0.5; 3]; 2]]))];
        let bytes = Reasons { lines: vec![line], hidden, n_pairs: 3, n_joined: 3 }.to_bytes();
        let words: Vec<u32> = bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        assert_eq!(words[..16], [1, 2, 2, 4, 5, 6, 7, 8, 1, 2, 0, 0, 1, 3, 2, 1]);
        let reals = &bytes[64..];
        assert_eq!(reals.len(), 8 * 12);
        let real = |k: usize| f64::from_le_bytes(reals[8 * k..8 * k + 8].try_into().unwrap());
        assert!((0..6).all(|k| real(k).is_nan()) && (6..12).all(|k| real(k) == 0.5));
    }
}
