//! What is built: an input with all files that belong to it.

use super::quake::{self, Portals};
use super::{BakeArgs, Error, plan, space};
use crate::buffers::MethodFailed;
use crate::input::{Input, PlanFile};
use crate::progress::Bar;
use sightlines::bake::{BakeError, BakeInput, BakeOptions, Baked, Report, bake};
use sightlines::formats::quake::Bsp;
use sightlines::formats::{Prt, SceneFile};
use std::path::Path;

/// An input with all files that belong to it.
#[derive(Debug)]
pub(super) enum Source {
    Plan(PlanFile),
    Scene(SceneFile),
    Portals(Prt),
    Map(Bsp, Portals),
}

impl Source {
    /// Completes an input that came from `path`: a map by its portal file, which is `prt` or beside it. Refuses options that
    /// mean nothing for it.
    pub(super) fn new(
        path: &Path,
        input: Input,
        prt: Option<&Path>,
        out: &Path,
        args: &BakeArgs,
    ) -> Result<Self, Error> {
        let source = match input {
            Input::Plan(file) => Self::Plan(file),
            Input::Scene(file) => Self::Scene(file),
            Input::Portals(prt) => Self::Portals(prt),
            Input::Map(bsp) => Self::Map(bsp, Portals::read(path, prt, out)?),
        };
        match source {
            Self::Plan(_) => args.check_for_plan(path)?,
            Self::Scene(_) => args.check_for_space(path)?,
            Self::Portals(_) | Self::Map(..) => args.check_for_portals(path)?,
        }
        Ok(source)
    }

    /// The input of the bake.
    pub(super) fn input(&self) -> BakeInput<'_> {
        match self {
            Self::Plan(file) => (&file.plan).into(),
            Self::Scene(file) => file.into(),
            Self::Portals(prt) => prt.into(),
            Self::Map(bsp, portals) => (bsp, &portals.prt).into(),
        }
    }

    /// The error, with the name of the file that it is about.
    pub(super) fn failed(&self, path: &Path, source: BakeError) -> Error {
        let path = path.to_owned();
        match (self, source) {
            (Self::Map(_, portals), BakeError::Prt(source)) => quake::failed(&path, portals, source),
            (_, BakeError::Prt(source)) => Error::BakePrt { path, source },
            (_, BakeError::Method(source)) => MethodFailed { path, source }.into(),
            (Self::Plan(file), source) => Error::Bake { path, map: file.map.clone(), source: Box::new(source) },
            (_, source) => Error::Bake { path, map: None, source: Box::new(source) },
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
    let what = match input {
        BakeInput::Portals(_) | BakeInput::Map(..) => "visibility of clusters",
        BakeInput::Plan(_) | BakeInput::Scene(..) => "visibility",
    };
    let bar = Bar::new(what, show_progress);
    let baked = bake(input, &BakeOptions { progress: Some(&bar), ..options.clone() })?;
    drop(bar);
    match &baked.report {
        Report::Plan(report) => plan::warn(path, report),
        Report::Scene(report) => space::warn(path, report),
        _ => {}
    }
    Ok(baked)
}
