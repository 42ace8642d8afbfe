//! What is seen from points of a plan, such as isovists: areas as GeoJSON, their numbers as CSV, and pictures in one hue.

use crate::canvas::{Canvas, parsed};
use crate::draw::{MAX_SIZE, MIN_SIZE};
use crate::frame::{Frame, Px};
use crate::png::{Pixels, encode_small};
use crate::{PngError, letters, theme};
use sightlines_geometry::{Aabb, Point2, Segment2};
use std::fmt::Write;

/// What an edge of an area is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AreaEdge {
    /// On this line of the plan.
    Wall(u32),
    /// Along a ray past the end of a wall.
    Occluding,
    /// Where the plan ends.
    Frame,
    /// Where the view ends.
    Limit,
}

impl AreaEdge {
    /// Its name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Wall(_) => "wall",
            Self::Occluding => "occluding",
            Self::Frame => "frame",
            Self::Limit => "limit",
        }
    }
}

/// What is seen from a point.
#[derive(Debug, Clone)]
pub struct Area {
    /// What the point is called.
    pub name: Option<String>,
    /// The point.
    pub eye: Point2,
    /// Vertices, counter-clockwise.
    pub outline: Vec<Point2>,
    /// What the edge from each vertex to the next is.
    pub edges: Vec<AreaEdge>,
    /// Numbers about it, one for each name that is given with the areas.
    pub values: Vec<f64>,
}

/// Areas as a GeoJSON FeatureCollection: a Polygon each, with `index`, `name`, the eye as `x` and `y`, all values by name, what each edge is
/// as `edges`, and the line of the plan that it lies on as `walls`, null where there is none.
///
/// * `crs`: a member `crs` as JSON, written as it is
///
/// Numbers are as short as they can be without losing anything.
///
/// # Panics
/// If an area has not as many values as names, or not as many edges as vertices.
pub fn areas_geojson(areas: &[Area], names: &[&str], crs: Option<&str>) -> String {
    let mut out = String::from("{\"type\":\"FeatureCollection\",");
    if let Some(crs) = crs {
        out.extend(["\"crs\":", crs, ","]);
    }
    out.push_str("\"features\":[");
    for (index, area) in areas.iter().enumerate() {
        assert_eq!((area.values.len(), area.edges.len()), (names.len(), area.outline.len()));
        let comma = if index == 0 { "" } else { "," };
        let _ = write!(out, "{comma}\n{{\"type\":\"Feature\",\"properties\":{{\"index\":{index},");
        if let Some(name) = &area.name {
            let _ = write!(out, "\"name\":{},", serde_json::Value::from(name.as_str()));
        }
        let _ = write!(out, "\"x\":{},\"y\":{}", area.eye.x, area.eye.y);
        for (name, value) in names.iter().zip(&area.values) {
            let _ = write!(out, ",\"{name}\":{}", Number(*value));
        }
        let edges: Vec<String> = area.edges.iter().map(|edge| format!("\"{}\"", edge.name())).collect();
        let wall = |edge: &AreaEdge| if let AreaEdge::Wall(line) = edge { line.to_string() } else { "null".to_owned() };
        let walls: Vec<String> = area.edges.iter().map(wall).collect();
        let _ = write!(out, ",\"edges\":[{}],\"walls\":[{}]}}", edges.join(","), walls.join(","));
        let ring: Vec<String> =
            area.outline.iter().chain(area.outline.first()).map(|p| format!("[{},{}]", p.x, p.y)).collect();
        let _ = write!(out, ",\"geometry\":{{\"type\":\"Polygon\",\"coordinates\":[[{}]]}}}}", ring.join(","));
    }
    out.push_str("\n]}\n");
    out
}

/// A number in JSON; null if it is not finite.
struct Number(f64);

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0.is_finite() { write!(f, "{}", self.0) } else { f.write_str("null") }
    }
}

/// The numbers of areas as CSV: a header, then `x`, `y`, `index`, all values, and `name` if any area has one.
///
/// # Panics
/// If an area has not as many values as names.
pub fn areas_csv(areas: &[Area], names: &[&str]) -> String {
    let has_names = areas.iter().any(|area| area.name.is_some());
    let mut out = String::from("x,y,index");
    names.iter().for_each(|name| _ = write!(out, ",{name}"));
    out.push_str(if has_names { ",name\n" } else { "\n" });
    for (index, area) in areas.iter().enumerate() {
        assert_eq!(area.values.len(), names.len());
        let _ = write!(out, "{},{},{index}", area.eye.x, area.eye.y);
        area.values.iter().for_each(|value| _ = write!(out, ",{value}"));
        if has_names {
            let name = area.name.as_deref().unwrap_or_default();
            let quoted = name.contains([',', '"', '\n', '\r']);
            let _ = if quoted { write!(out, ",\"{}\"", name.replace('"', "\"\"")) } else { write!(out, ",{name}") };
        }
        out.push('\n');
    }
    out
}

/// What an eye sees of a scene in space: estimates, each with the ends of the interval in which it is.
#[derive(Debug, Clone, PartialEq)]
pub struct SeenInSpace {
    /// The eye.
    pub eye: [f64; 3],
    /// The volume that it sees.
    pub volume: [f64; 3],
    /// The share of each object that it sees.
    pub shares: Vec<[f64; 3]>,
}

/// What eyes see as CSV: a row for each eye and object, with what is seen of the object, and the volume of the eye.
///
/// * `names`: of the objects
pub fn seen_csv(all: &[SeenInSpace], names: &[&str]) -> String {
    let mut out =
        String::from("x,y,z,index,volume,volume_low,volume_high,object,visible_share,share_low,share_high,name\n");
    for (index, SeenInSpace { eye: [x, y, z], volume: [v, vl, vh], shares }) in all.iter().enumerate() {
        for (object, ([s, sl, sh], name)) in shares.iter().zip(names).enumerate() {
            let name = name.replace('"', "\"\"");
            let _ = writeln!(out, "{x},{y},{z},{index},{v},{vl},{vh},{object},{s},{sl},{sh},\"{name}\"");
        }
    }
    out
}

/// Draws areas over each other as SVG, in one transparent hue, with the walls and the eyes; where more eyes see, it is darker. Edges that are
/// no wall are dashed.
///
/// * `size`: pixels of the longer side of the plan, brought to [`MIN_SIZE`] to [`MAX_SIZE`]
/// * `legend`: a line of text below
pub fn areas_svg(areas: &[Area], walls: &[Segment2], size: u32, legend: &str) -> String {
    let Layout { frame, text, stroke, size: [width, height] } = Layout::of(areas, walls, size, legend);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         stroke-linecap=\"round\" stroke-linejoin=\"round\">\n<title>{legend}</title>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>\n",
        theme::PAPER
    );
    // Walls beyond the frame of the plan end no view, and what is seen beyond them is cut off by the picture.
    let opacity = opacity(areas.len());
    for area in areas {
        let mut path = String::new();
        frame.polygon(&mut path, &area.outline);
        let _ =
            writeln!(out, "<path class=\"area\" fill=\"{}\" fill-opacity=\"{opacity:.3}\" d=\"{path}\"/>", theme::AREA);
    }
    let mut open = String::new();
    open_edges(areas).for_each(|ends| frame.polyline(&mut open, &ends));
    let _ = writeln!(
        out,
        "<path class=\"open\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-dasharray=\"{} {}\" d=\"{open}\"/>",
        theme::AREA,
        Px(0.7 * stroke),
        Px(3.0 * stroke),
        Px(3.0 * stroke)
    );
    let lines = frame.lines(walls.iter().copied());
    let _ = writeln!(
        out,
        "<path class=\"walls\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" d=\"{lines}\"/>",
        theme::WALL,
        Px(stroke)
    );
    for area in areas {
        let [x, y] = frame.place(area.eye);
        let _ = writeln!(
            out,
            "<circle class=\"eye\" cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"/>",
            Px(x),
            Px(y),
            Px(2.5 * stroke),
            theme::FROM
        );
    }
    let _ = writeln!(
        out,
        "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>\n</svg>",
        letters::path(legend, [text, f64::from(frame.height) + 1.5 * text], text),
        theme::INK,
        Px(letters::stroke(text))
    );
    out
}

/// Draws the same as PNG.
///
/// # Errors
/// [`PngError`]
///
/// # Cost
/// O(pixels) for each area, and 4 bytes of memory for each pixel.
pub fn areas_png(areas: &[Area], walls: &[Segment2], size: u32, legend: &str) -> Result<Vec<u8>, PngError> {
    let Layout { frame, text, stroke, size } = Layout::of(areas, walls, size, legend);
    let [paper, hue, wall, from, ink] = [theme::PAPER, theme::AREA, theme::WALL, theme::FROM, theme::INK].map(parsed);
    let pixels = size.map(|x| x as u32);
    let mut canvas = Canvas::new(pixels);
    canvas.fill([0.0, 0.0, size[0], size[1]], paper);
    for area in areas {
        let corners: Vec<[f64; 2]> = area.outline.iter().map(|&p| frame.place(p)).collect();
        canvas.fill_polygon(&corners, opacity(areas.len()), hue);
    }
    for ends in open_edges(areas) {
        let [a, b] = ends.map(|p| frame.place(p));
        // Dashes and gaps are equally long.
        let (dash, length) = (3.0 * stroke, (b[0] - a[0]).hypot(b[1] - a[1]));
        let at = |along: f64| [0, 1].map(|k| a[k] + (b[k] - a[k]) * (along.min(length) / length));
        let n = (length / (2.0 * dash)).ceil() as u32;
        (0..n).map(|k| 2.0 * dash * f64::from(k)).for_each(|along| {
            canvas.stroke([at(along), at(along + dash)], 0.7 * stroke, hue);
        });
    }
    walls.iter().for_each(|line| canvas.stroke([frame.place(line.a), frame.place(line.b)], stroke, wall));
    areas.iter().for_each(|area| canvas.stroke([frame.place(area.eye); 2], 5.0 * stroke, from));
    for line in letters::lines(legend, [text, f64::from(frame.height) + 1.5 * text], text) {
        line.windows(2).for_each(|ends| canvas.stroke([ends[0], ends[1]], letters::stroke(text), ink));
    }
    encode_small(pixels, canvas.bytes(), Pixels::Rgba)
}

/// Where everything is in a picture of areas.
struct Layout {
    frame: Frame,
    /// Height of the legend's letters, in pixels.
    text: f64,
    /// Width of walls, in pixels.
    stroke: f64,
    /// Width and height of the picture, whole pixels.
    size: [f64; 2],
}

impl Layout {
    fn of(areas: &[Area], walls: &[Segment2], size: u32, legend: &str) -> Self {
        let ends = walls.iter().flat_map(|wall| [wall.a, wall.b]).map(|p| [p.x, p.y]);
        let eyes = areas.iter().map(|area| [area.eye.x, area.eye.y]);
        let frame = Frame::around(Aabb::around(ends.chain(eyes)), size.clamp(MIN_SIZE, MAX_SIZE));
        let longer = f64::from(frame.width.max(frame.height));
        let (text, stroke) = ((longer / 45.0).clamp(11.0, 26.0), (longer / 600.0).max(1.2));
        let width = f64::from(frame.width).max(letters::width(legend, text) + 2.0 * text).ceil();
        Self { frame, text, stroke, size: [width, (f64::from(frame.height) + 3.0 * text).ceil()] }
    }
}

/// How opaque each of so many areas is.
fn opacity(n_areas: usize) -> f64 {
    (1.0 / n_areas.max(1) as f64).clamp(0.06, 0.55)
}

/// The ends of the edges that are no wall.
fn open_edges(areas: &[Area]) -> impl Iterator<Item = [Point2; 2]> + '_ {
    areas.iter().flat_map(|area| {
        let next = area.outline.iter().skip(1).chain(area.outline.first());
        let edges = area.outline.iter().zip(next).zip(&area.edges);
        edges.filter(|(_, edge)| !matches!(edge, AreaEdge::Wall(_))).map(|((&a, &b), _)| [a, b])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(name: Option<&str>) -> Area {
        let corners = [(0.0, 0.0), (2.0, 0.0), (0.1 + 0.2, 1.0)].map(Point2::from).to_vec();
        Area {
            name: name.map(str::to_owned),
            eye: Point2::new(0.5, 0.25),
            outline: corners,
            edges: vec![AreaEdge::Wall(3), AreaEdge::Occluding, AreaEdge::Frame],
            values: vec![1.0, 0.1],
        }
    }

    #[test]
    fn areas_are_polygons_with_their_edges() {
        let text = areas_geojson(&[area(Some("a \"b\"")), area(None)], &["area", "drift"], Some("{\"type\":\"name\"}"));
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(json["crs"]["type"], "name");
        let feature = &json["features"][0];
        assert_eq!(feature["properties"]["name"], "a \"b\"");
        assert_eq!(feature["properties"]["drift"].as_f64(), Some(0.1));
        assert_eq!(feature["properties"]["edges"], serde_json::json!(["wall", "occluding", "frame"]));
        assert_eq!(feature["properties"]["walls"], serde_json::json!([3, null, null]));
        let ring = feature["geometry"]["coordinates"][0].as_array().unwrap();
        assert_eq!((ring.len(), &ring[0]), (4, &ring[3]));
        assert_eq!(ring[2][0].as_f64(), Some(0.1 + 0.2));
        assert!(json["features"][1]["properties"].get("name").is_none());
    }

    #[test]
    fn numbers_of_areas_are_rows() {
        assert_eq!(areas_csv(&[area(None)], &["area", "drift"]), "x,y,index,area,drift\n0.5,0.25,0,1,0.1\n");
        let seen = SeenInSpace { eye: [1.0; 3], volume: [2.0, 1.0, 3.0], shares: vec![[0.5, 0.0, 1.0]] };
        let rows = seen_csv(&[seen], &["a \"b\""]);
        assert_eq!(rows.lines().nth(1), Some("1,1,1,0,2,1,3,0,0.5,0,1,\"a \"\"b\"\"\""));
        let named = areas_csv(&[area(Some("a, \"b\"")), area(None)], &["area", "drift"]);
        assert_eq!(named, "x,y,index,area,drift,name\n0.5,0.25,0,1,0.1,\"a, \"\"b\"\"\"\n0.5,0.25,1,1,0.1,\n");
    }

    #[test]
    fn pictures_have_an_area_and_an_eye_for_each() {
        let svg = areas_svg(
            &[area(None), area(None)],
            &[Segment2::new(Point2::ZERO, Point2::new(2.0, 0.0))],
            400,
            "two isovists",
        );
        assert_eq!((svg.matches("class=\"area\"").count(), svg.matches("class=\"eye\"").count()), (2, 2));
        assert!(svg.contains("fill-opacity=\"0.500\""));
    }

    /// The pixels of both kinds of pictures agree where nothing but areas and paper is.
    #[test]
    fn pixels_are_filled_as_far_as_areas_reach() {
        let walls =
            [Segment2::new(Point2::ZERO, Point2::new(2.0, 0.0)), Segment2::new((0.0, 1.0).into(), (2.0, 1.0).into())];
        let png = areas_png(&[area(None), area(None)], &walls, 400, "two isovists").unwrap();
        let picture = image::load_from_memory_with_format(&png, image::ImageFormat::Png).unwrap().to_rgba8();
        let layout = Layout::of(&[area(None)], &walls, 400, "two isovists");
        assert_eq!([picture.width(), picture.height()].map(f64::from), layout.size);
        let at = |x: f64, y: f64| {
            let [x, y] = layout.frame.place((x, y).into()).map(|x| x as u32);
            picture.get_pixel(x, y).0
        };
        let [[r, g, b], paper] = [theme::AREA, theme::PAPER].map(parsed);
        let opaque = |[r, g, b]: [u8; 3]| [r, g, b, 255];
        // Twice half of the hue is three quarters of it.
        let mixed: [u8; 3] =
            std::array::from_fn(|k| (0.75 * f64::from([r, g, b][k]) + 0.25 * f64::from(paper[k])).round() as u8);
        let near = |found: [u8; 4], wanted: [u8; 4]| found.iter().zip(wanted).all(|(a, b)| a.abs_diff(b) <= 1);
        for (x, y) in [(0.4, 0.6), (1.0, 0.3), (1.4, 0.2)] {
            assert!(near(at(x, y), opaque(mixed)), "{:?} at {x}, {y}, where {mixed:?} was expected", at(x, y));
        }
        // The twin: outside of the area there is paper.
        for (x, y) in [(0.05, 0.8), (1.5, 0.8)] {
            assert_eq!(at(x, y), opaque(paper), "at {x}, {y}");
        }
        assert_eq!(at(0.5, 0.25), opaque(parsed(theme::FROM)));
        // A thin line covers its pixels in part.
        assert!(at(1.0, 1.0)[0] < paper[0] / 2 + 30, "{:?}", at(1.0, 1.0));
    }
}
