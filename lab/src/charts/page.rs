//! One page of all charts: a file that needs no other one.

use super::row::Row;
use std::fmt::Write;

/// A family on the page.
#[derive(Debug, Clone, PartialEq)]
pub struct Section<'a> {
    /// What its files are called.
    pub name: &'a str,
    /// What its picture is called.
    pub title: &'a str,
    /// What is measured.
    pub about: &'a str,
    /// The picture.
    pub svg: String,
    /// What was measured.
    pub rows: Vec<Row>,
}

const STYLE: &str = "\
:root { color-scheme: light dark; --ink: #1c2733; --paper: #ffffff; --rule: #d5dae0; --quiet: #56616c; }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e9ee; --paper: #161b21; --rule: #3a444e; --quiet: #a3aeb9; } }
body { background: var(--paper); color: var(--ink); font: 16px/1.5 system-ui, sans-serif; margin: 0 auto; max-width: 1260px; padding: 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.25rem; margin-top: 2.5rem; }
p { max-width: 52rem; } .quiet { color: var(--quiet); font-size: .9rem; }
svg { height: auto; max-width: 100%; }
details { margin: .5rem 0; overflow-x: auto; } summary { cursor: pointer; }
table { border-collapse: collapse; font-size: .8rem; } th, td { border-bottom: 1px solid var(--rule); padding: .15rem .5rem; text-align: left; white-space: nowrap; }
td.n { font-variant-numeric: tabular-nums; text-align: right; }
a { color: inherit; }";

/// The page. The same sections give the same bytes.
pub fn html(sections: &[Section<'_>]) -> String {
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Speed against accuracy</title>\n<style>\n{STYLE}\n</style>\n</head>\n<body>\n\
         <h1>Speed against accuracy</h1>\n\
         <p>Each point is one method on one scene. Time is to the right, what is too much is up, both on logarithmic \
         scales: the nearer to the lower left corner, the better. Ringed points are on the Pareto front: no other method is \
         better in both respects. A cross is a method that hides something that is visible, and so is on no front.</p>\n"
    );
    out.push_str("<ul>\n");
    for s in sections {
        let _ = writeln!(out, "<li><a href=\"#{}\">{}</a></li>", escaped(s.name), escaped(s.title));
    }
    out.push_str("</ul>\n");
    for s in sections {
        let _ = writeln!(out, "<section id=\"{}\">\n<h2>{}</h2>", escaped(s.name), escaped(s.title));
        for paragraph in s.about.split('\n') {
            let _ = writeln!(out, "<p>{}</p>", escaped(paragraph));
        }
        out.push_str(&s.svg);
        let _ = writeln!(out, "<p class=\"quiet\">Measured {}.</p>", escaped(&places(&s.rows)));
        table(&mut out, &s.rows);
        out.push_str("</section>\n");
    }
    out.push_str("</body>\n</html>\n");
    out
}

/// On which machines, at which states, in the order of rows.
fn places(rows: &[Row]) -> String {
    let mut places: Vec<String> = Vec::new();
    for row in rows {
        let place = format!("on {} at {}", row.machine, row.commit);
        if !places.contains(&place) {
            places.push(place);
        }
    }
    places.join("; ")
}

fn table(out: &mut String, rows: &[Row]) {
    let _ = writeln!(out, "<details><summary>{} rows</summary>\n<table>\n<tr>", rows.len());
    let heads = [
        "scene",
        "size",
        "method",
        "seconds",
        "reported",
        "true or seen",
        "by",
        "over",
        "missed",
        "error",
        "bytes",
        "note",
    ];
    heads.iter().for_each(|head| {
        let _ = write!(out, "<th>{head}</th>");
    });
    out.push_str("</tr>\n");
    for row in rows {
        let number = |x: Option<u64>| x.map_or_else(String::new, |x| x.to_string());
        let short = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.4}"));
        let cells = [
            (false, row.scene.clone()),
            (true, format!("{} {}", row.size, row.size_of)),
            (false, row.method.clone()),
            (true, row.seconds.map_or_else(String::new, |s| format!("{s:.3e}"))),
            (true, number(row.reported)),
            (true, number(row.truth)),
            (false, row.truth_by.clone()),
            (true, short(row.over_estimate())),
            (true, number(row.missed)),
            (true, row.error.map_or_else(String::new, |s| format!("{s:.3e}"))),
            (true, number(row.bytes)),
            (false, row.note.clone()),
        ];
        out.push_str("<tr>");
        for (is_number, text) in cells {
            let class = if is_number { " class=\"n\"" } else { "" };
            let _ = write!(out, "<td{class}>{}</td>", escaped(&text));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</table></details>\n");
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_stand_alone_and_repeat() {
        let row = Row { method: "a < b".into(), machine: "m".into(), commit: "c".into(), ..Row::default() };
        let other = Row { machine: "n".into(), ..row.clone() };
        let section = Section {
            name: "one",
            title: "One & two",
            about: "First.\nSecond.",
            svg: "<svg></svg>\n".into(),
            rows: vec![row.clone(), row, other],
        };
        let text = html(std::slice::from_ref(&section));
        assert_eq!(text, html(&[section]));
        assert!(text.contains("<p>Second.</p>") && text.contains("One &amp; two") && text.contains("a &lt; b"));
        assert!(text.contains("Measured on m at c; on n at c."));
        for outside in ["http://", "https://", "src=", "<script", "url("] {
            assert!(!text.contains(outside), "{outside}");
        }
    }
}
