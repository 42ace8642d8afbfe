//! The page about what commands print with `--json`: made from the schemas of the results.

use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fmt::Write;

/// What stands above the tables.
const HEAD: &str = include_str!("head.md");

/// The page.
pub(super) fn page() -> String {
    let mut page = Page::default();
    sightlines_cli::json_schemas().iter().for_each(|(titles, schema)| page.add(titles, schema));
    page.text()
}

/// Sections, and the parts that they have in common.
#[derive(Default)]
struct Page {
    sections: String,
    /// By title.
    parts: BTreeMap<String, String>,
}

/// The schemas that a schema refers to, by name.
type Definitions = Map<String, Value>;

impl Page {
    /// Adds the sections of a type of results: of its variants, if it has any.
    fn add(&mut self, titles: &[&str], schema: &Value) {
        let defs = schema["$defs"].as_object().cloned().unwrap_or_default();
        let variants = schema["anyOf"].as_array().cloned().unwrap_or_else(|| vec![schema.clone()]);
        let is_shared = schema["anyOf"].is_array() && schema["properties"].is_object();
        assert_eq!(titles.len() % variants.len(), 0, "a title for each variant: {titles:?}");
        let shared = if is_shared { link_row(&self.part(schema, &defs)) } else { String::new() };
        for (title, variant) in titles.iter().zip(variants.iter().cycle()) {
            let variant = resolve(variant, &defs);
            let rows = self.rows(variant, &defs);
            let text = one_line(variant["description"].as_str().unwrap_or_default());
            let _ = write!(self.sections, "\n## {title}\n\n{text}\n\n{HEADER}{rows}{shared}");
        }
    }

    fn text(self) -> String {
        let parts: String = self.parts.iter().map(|(title, rows)| format!("\n## Part: {title}\n\n{rows}")).collect();
        format!("{HEAD}{}{parts}", self.sections)
    }

    /// Adds the part about an object, and returns its title.
    fn part(&mut self, schema: &Value, defs: &Definitions) -> String {
        let title = title(schema);
        if !self.parts.contains_key(&title) {
            // Before its rows, which may lead back to it.
            self.parts.insert(title.clone(), String::new());
            let rows = self.rows(schema, defs);
            let text = one_line(schema["description"].as_str().unwrap_or_default());
            self.parts.insert(title.clone(), format!("{text}\n\n{HEADER}{rows}"));
        }
        title
    }

    /// The rows of an object, by the names of its fields.
    fn rows(&mut self, schema: &Value, defs: &Definitions) -> String {
        let required = |name: &str| schema["required"].as_array().is_some_and(|all| all.iter().any(|n| n == name));
        let fields = schema["properties"].as_object().into_iter().flatten();
        fields.map(|(name, field)| self.row(name, field, !required(name), defs)).collect()
    }

    fn row(&mut self, name: &str, field: &Value, is_optional: bool, defs: &Definitions) -> String {
        let meaning = field["description"].as_str().map(one_line).unwrap_or_default();
        let Kind { text, part, is_list, is_null } = self.kind(field, defs);
        let null = if is_null && !is_optional { " or null" } else { "" };
        let optional = if is_optional { ", optional" } else { "" };
        let list = if is_list { "[]" } else { "" };
        let part = part.map(|title| format!(" {}", link(&title))).unwrap_or_default();
        format!("| `{name}{list}`{part} | {text}{null}{optional} | {} |\n", meaning.replace('|', "\\|"))
    }

    /// What kind of value a schema describes.
    fn kind(&mut self, schema: &Value, defs: &Definitions) -> Kind {
        let (some, is_null) = without_null(schema);
        let found = resolve(&some, defs);
        let kind = |text: &str| Kind { text: text.to_owned(), part: None, is_list: false, is_null };
        let is_text = found["enum"].is_array() || found["const"].is_string() || found["oneOf"].is_array();
        match found["type"].as_str() {
            _ if is_text => kind("text"),
            Some("string") => kind("text"),
            Some("array") if found["prefixItems"].is_array() => kind("list"),
            Some("array") => {
                if found["items"].as_object().is_none_or(serde_json::Map::is_empty) {
                    return kind("list of trees, free keys");
                }
                let of = self.kind(&found["items"], defs);
                let length = found["maxItems"].as_u64().filter(|n| found["minItems"].as_u64() == Some(*n));
                let length = length.map(|n| format!("{n} ")).unwrap_or_default();
                let (nulls, is_list) = (if of.is_null { " (null for some)" } else { "" }, of.part.is_some());
                Kind { text: format!("list of {length}{}{nulls}", plural(&of.text)), part: of.part, is_list, is_null }
            }
            Some("object") if found["properties"].is_object() => {
                let part = Some(self.part(found, defs));
                Kind { text: "object".to_owned(), part, is_list: false, is_null }
            }
            Some("object") => kind("object, free keys"),
            Some(other) => kind(other),
            None => kind("text or list or object, free keys"),
        }
    }
}

/// The head of a table.
const HEADER: &str = "| field | type | meaning |\n| --- | --- | --- |\n";

/// What a row says of the type of its field.
struct Kind {
    text: String,
    /// The part with the fields below it.
    part: Option<String>,
    /// Whether it is a list of such objects.
    is_list: bool,
    is_null: bool,
}

/// What a schema refers to, or itself.
fn resolve<'a>(schema: &'a Value, defs: &'a Definitions) -> &'a Value {
    let name = schema["$ref"].as_str().and_then(|path| path.strip_prefix("#/$defs/"));
    name.and_then(|name| defs.get(name)).unwrap_or(schema)
}

/// A schema without null among its values, and whether null was one of them.
fn without_null(schema: &Value) -> (Value, bool) {
    if let Some([some, null]) = schema["anyOf"].as_array().map(Vec::as_slice)
        && null["type"] == "null"
    {
        return (some.clone(), true);
    }
    match schema["type"].as_array().map(Vec::as_slice) {
        Some([some, null]) if null == "null" => {
            let mut schema = schema.clone();
            schema["type"] = some.clone();
            (schema, true)
        }
        _ => (schema.clone(), false),
    }
}

/// The title of a part: the first sentence about the type.
fn title(schema: &Value) -> String {
    let text = one_line(schema["description"].as_str().unwrap_or_default());
    let first = text.split(['.', ':', ',', ';']).next().unwrap_or_default();
    let first = ["A ", "An ", "The "].iter().find_map(|article| first.strip_prefix(article)).unwrap_or(first);
    let mut letters = first.chars();
    match (letters.next(), letters.clone().next()) {
        // Not of abbreviations.
        (Some(first), Some(second)) if second.is_lowercase() => first.to_lowercase().chain(letters).collect(),
        _ => first.to_owned(),
    }
}

/// A link to a part.
fn link(title: &str) -> String {
    let heading = format!("part-{}", title.to_lowercase().replace(' ', "-"));
    let anchor: String = heading.chars().filter(|c| c.is_alphanumeric() || *c == '-').collect();
    format!("[{title}](#{anchor})")
}

/// The row that stands for all fields of a part.
fn link_row(title: &str) -> String {
    format!("| {} | | |\n", link(title))
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Several of a kind of values.
fn plural(kind: &str) -> String {
    let end = kind.find([',', ' ']).unwrap_or(kind.len());
    format!("{}s{}", &kind[..end], &kind[end..])
}
