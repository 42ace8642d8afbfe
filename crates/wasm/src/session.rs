//! Questions and answers, as JSON and bytes.

use crate::samples::SAMPLES;
use serde::Deserialize;
use serde_json::{Value, json};
use sightlines_bake::lines::{LineOptions, lines};
use sightlines_bake::{BakeRequest, Bakeable, Runtime, stated_gap};
use sightlines_formats::Source;
use sightlines_progress::Observer;
use sightlines_pvs::Table;
use sightlines_viewer::{Figure, Page};
use std::path::Path;

/// The most lines of sight on a page.
const MAX_LINES: usize = 20_000;

/// A question.
#[derive(Debug, Deserialize)]
#[serde(tag = "ask", rename_all = "lowercase", deny_unknown_fields)]
enum Question {
    /// A table of a file, whose bytes follow.
    Bake {
        /// The name of the file, which may tell its format.
        name: String,
        /// Which map of a WAD.
        #[serde(default)]
        map: Option<String>,
        /// What to bake.
        #[serde(default)]
        request: Box<BakeRequest>,
    },
    /// The page of the last table.
    Page {
        /// Its heading.
        title: String,
    },
    /// The file of a built-in sample.
    Sample {
        /// Its name.
        name: String,
    },
    /// What is built in.
    About,
}

/// An answer: JSON, and bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct PageAnswer {
    /// Facts; `{"error": "…"}` if the question cannot be answered.
    pub json: Value,
    /// A table, a page or a file.
    pub bytes: Vec<u8>,
}

/// The last input of a page, and its table.
#[derive(Debug, Default)]
pub struct Session {
    last: Option<(Bakeable, Table)>,
}

impl Session {
    /// Answers a question.
    ///
    /// * `question`: `{"ask": "bake", "name": "level.glb", "map": null, "request": {}}` with the bytes of the file, as
    ///   [`BakeRequest::from_json`] reads a request; `{"ask": "page", "title": "…"}` for the last table as one HTML file, `{"ask": "sample",
    ///   "name": "…"}` for the file of a [`Sample`](crate::Sample), `{"ask": "about"}`
    /// * `observer`: receives reports, and may cancel
    pub fn answer(&mut self, question: &[u8], bytes: &[u8], observer: &dyn Observer) -> PageAnswer {
        let answer = serde_json::from_slice(question)
            .map_err(|error| error.to_string())
            .and_then(|question| self.try_answer(question, bytes, observer));
        answer.unwrap_or_else(|error| PageAnswer { json: json!({ "error": error }), bytes: Vec::new() })
    }

    fn try_answer(&mut self, question: Question, bytes: &[u8], observer: &dyn Observer) -> Result<PageAnswer, String> {
        match question {
            Question::Bake { name, map, request } => {
                self.last = None;
                let source = Source::Memory { name: Path::new(&name), bytes, beside: None };
                let input = Bakeable::read(&source, map.as_deref()).map_err(|error| error.to_string())?;
                let runtime = Runtime { progress: Some(observer), ..Runtime::default() };
                let table = runtime.bake(&input, &request).map_err(|error| format!("{name}: {error}"))?.table;
                let json = json!({
                    "cells": table.n_cells(),
                    "objects": table.objects().len(),
                    "dimension": table.dimension(),
                    "method": table.info_value("method"),
                });
                let bytes = table.to_bytes();
                self.last = Some((input, table));
                Ok(PageAnswer { json, bytes })
            }
            Question::Page { title } => {
                let (input, table) = self.last.as_ref().ok_or("nothing was baked")?;
                page(&title, input, table, observer)
            }
            Question::Sample { name } => {
                let sample = SAMPLES.iter().find(|sample| sample.name == name);
                let sample = sample.ok_or_else(|| format!("there is no sample '{name}'"))?;
                let bytes = (sample.make)()?;
                Ok(PageAnswer { json: json!({ "file": sample.file }), bytes })
            }
            Question::About => {
                let samples: Vec<_> = SAMPLES.iter().map(|s| json!({ "name": s.name, "about": s.about })).collect();
                Ok(PageAnswer {
                    json: json!({ "version": env!("CARGO_PKG_VERSION"), "samples": samples }),
                    bytes: Vec::new(),
                })
            }
        }
    }
}

/// The page of a table, as `sightlines view` writes it.
fn page(title: &str, input: &Bakeable, table: &Table, observer: &dyn Observer) -> Result<PageAnswer, String> {
    let text = |error: &dyn std::fmt::Display| error.to_string();
    let figure = match input {
        Bakeable::Plan { plan, .. } => {
            let joined = plan.joined(stated_gap(table)).map_err(|error| text(&error))?;
            Some(Figure::of_plan(&joined))
        }
        Bakeable::Scene(file) => {
            let is_single_sided = file.info.n_single_sided_triangles > 0;
            Some(Figure::of_scene(&file.scene).with_single_sided(is_single_sided))
        }
        Bakeable::Map(bsp, _) => {
            let faces = bsp.world_faces().map_err(|error| text(&error))?;
            Some(Figure::of_polygons((0..faces.n_faces()).map(|k| faces.polygons(k))))
        }
        Bakeable::Portals(_) => None,
    };
    let options = LineOptions { max_lines: MAX_LINES, max_hidden: MAX_LINES / 2 };
    let reasons = lines(table, options, Some(observer)).map_err(|error| text(&error))?.map(Into::into);
    let page = Page { figure: figure.as_ref(), reasons: reasons.as_ref(), ..Page::new(title, title, table) };
    let written = page.html().map_err(|error| text(&error))?;
    let json = json!({ "left_out": written.n_left_out, "lines": written.n_lines });
    Ok(PageAnswer { json, bytes: written.html.into_bytes() })
}
