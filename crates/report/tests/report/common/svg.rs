//! Pictures, read back.

/// The lines of the first path of two-point lines that is drawn in a colour, in pixels; a legend's lines are no such path.
pub(crate) fn lines_of(svg: &str, colour: &str) -> Vec<[[f64; 2]; 2]> {
    let end = format!("\" fill=\"none\" stroke=\"{colour}\"");
    let is_picture = |line: &&str| line.starts_with("<path") && line.contains(&end) && !line.contains(['H', 'Z']);
    // Words are drawn in the same ink, each in a group of its own behind its title.
    let lines: Vec<&str> = svg.lines().collect();
    let found =
        (0..lines.len()).find(|&i| is_picture(&lines[i]) && !lines[i.saturating_sub(1)].starts_with("<g><title>"));
    let Some(path) = found.and_then(|i| lines[i].strip_prefix("<path d=\"")?.split('"').next()) else {
        return Vec::new();
    };
    let point = |text: &str| -> [f64; 2] {
        let (x, y) = text.split_once(' ').expect("two coordinates");
        [x, y].map(|x| x.parse().expect("a number"))
    };
    let line = |text: &str| {
        let (a, b) = text.split_once('L')?;
        (!b.contains('L')).then(|| [point(a), point(b)])
    };
    path.split('M').skip(1).map(line).collect::<Option<Vec<_>>>().unwrap_or_default()
}

/// What the titles within a picture say, in order.
pub(crate) fn words_of(svg: &str) -> Vec<String> {
    svg.lines().filter_map(|line| Some(line.strip_prefix("<g><title>")?.split("</title>").next()?.to_owned())).collect()
}
