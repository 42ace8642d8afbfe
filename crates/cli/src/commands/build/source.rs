//! What is built: an input with all files that belong to it.

use super::announce::{Announcer, Plan};
use super::{BakeArgs, Error, plan, quake, space};
use crate::buffers::MethodFailed;
use crate::clusters::warn_of_repeats;
use crate::input;
use crate::output;
use crate::progress::Bar;
use sightlines::bake::{BakeError, BakeInput, BakeOptions, Bakeable, Baked, Report, bake};
use sightlines::formats::Input;
use sightlines::formats::quake::read_prt;
use std::path::{Path, PathBuf};

/// An input with all files that belong to it.
#[derive(Debug)]
pub(super) struct Source {
    pub(super) content: Bakeable,
    /// The portal file of a Quake map.
    portals: Option<PathBuf>,
}

impl Source {
    /// Completes an input that came from `path`: chooses the map of a WAD, and reads the portal file of a Quake map, which is `prt` or
    /// beside it. Refuses options that mean nothing for the input.
    pub(super) fn new(
        path: &Path,
        input: Input,
        (map, prt): (Option<&str>, Option<&Path>),
        out: &Path,
        args: &BakeArgs,
    ) -> Result<Self, Error> {
        let portals = if matches!(input, Input::Bsp(_)) { Some(input::portal_file(path, prt)?) } else { None };
        portals.iter().try_for_each(|portals| output::refuse_same(portals, out))?;
        let prt = portals.as_ref().map(read_prt).transpose()?;
        let content = input::bakeable(path, input, map, prt)?;
        if let Bakeable::Portals(prt) | Bakeable::Map(_, prt) = &content {
            warn_of_repeats(portals.as_deref().unwrap_or(path), prt);
        }
        match content {
            Bakeable::Plan { .. } => args.check_for_plan(path)?,
            Bakeable::Scene(_) => args.check_for_space(path)?,
            Bakeable::Portals(_) | Bakeable::Map(..) => args.check_for_portals(path)?,
        }
        Ok(Self { content, portals })
    }

    /// The error, with the name of the file that it is about.
    pub(super) fn failed(&self, path: &Path, source: BakeError) -> Error {
        let map = match &self.content {
            Bakeable::Plan { map, .. } => map.map(|name| name.to_string()),
            _ => None,
        };
        match (source, &self.portals) {
            (BakeError::Prt(source), Some(portals)) => quake::failed(path, portals, source),
            (BakeError::Prt(source), None) => Error::BakePrt { path: path.to_owned(), source },
            (BakeError::Method(source), _) => MethodFailed { path: path.to_owned(), source }.into(),
            (source, _) => Error::Bake { path: path.to_owned(), map, source: Box::new(source) },
        }
    }
}

/// Bakes with a progress bar, and warns of what is only approximate in the answer.
pub(crate) fn bake_visibly(
    path: &Path,
    input: BakeInput<'_>,
    options: &BakeOptions<'_>,
    show_progress: bool,
) -> Result<Baked, BakeError> {
    bake_announced(path, input, options, Plan::default(), show_progress)
}

/// The same; says before what is going to be done.
pub(super) fn bake_announced(
    path: &Path,
    input: BakeInput<'_>,
    options: &BakeOptions<'_>,
    plan: Plan,
    show_progress: bool,
) -> Result<Baked, BakeError> {
    let what = match input {
        BakeInput::Portals(_) | BakeInput::Map(..) => "visibility of clusters",
        BakeInput::Plan(_) | BakeInput::Scene(..) => "visibility",
    };
    let bar = Bar::new(what, show_progress);
    let announcer = Announcer::new(&bar, &plan, show_progress);
    let baked = bake(input, &BakeOptions { progress: Some(&announcer), ..options.clone() })?;
    drop(bar);
    match &baked.report {
        Report::Plan(report) => plan::warn(path, report),
        Report::Scene(report) => space::warn(path, report),
        _ => {}
    }
    Ok(baked)
}
