//! What is built: an input with all files that belong to it.

use super::announce::{Announcer, Plan};
use super::{plan, quake, space};
use crate::buffers::method_failed;
use crate::clusters::warn_of_repeats;
use crate::error::{Result, anyhow};
use crate::input::{self, of_map};
use crate::map_portals::{portal_file, portals_for};
use crate::output;
use crate::progress::Bar;
use crate::refuse::meaningless;
use sightlines::bake::{BakeError, BakeInput, BakeRequest, Bakeable, Baked, PreparedBake, Report, Runtime};
use sightlines::checkpoint::Identity;
use sightlines::formats::{Input, SceneFile};
use std::path::{Path, PathBuf};

/// An input with all files that belong to it.
#[derive(Debug)]
pub(super) struct Source {
    pub(super) content: Bakeable,
    /// The portal file of a Quake map; the map itself, if there is none.
    portals: Option<PathBuf>,
    /// Whether the portals of a Quake map were made from it.
    pub(super) is_made: bool,
}

impl Source {
    /// Completes an input that came from `path`: chooses the map of a WAD, and reads the portal file of a Quake map, which is `prt` or
    /// beside it, or makes the portals.
    pub(super) fn new(
        path: &Path,
        input: Input,
        (map, prt): (Option<&str>, Option<&Path>),
        out: &Path,
    ) -> Result<Self> {
        let read = match &input {
            Input::Bsp(bsp) => {
                portal_file(path, prt).iter().try_for_each(|file| output::refuse_same(file, out))?;
                Some(portals_for(bsp, path, prt)?)
            }
            _ => None,
        };
        let is_made = read.as_ref().is_some_and(|portals| portals.is_made);
        let (portals, prt) = read.map(|portals| (portals.path, portals.prt)).unzip();
        let content = input::bakeable(path, input, map, prt)?;
        if let Bakeable::Portals(prt) | Bakeable::Map(_, prt) = &content {
            warn_of_repeats(portals.as_deref().unwrap_or(path), prt);
        }
        Ok(Self { content, portals, is_made })
    }

    /// Adds what decides what is baked from it, beside the files, to what tells the results of one command from those of another.
    pub(super) fn identify(&self, identity: &mut Identity) {
        // Files that a scene names are part of it too.
        if let Bakeable::Scene(SceneFile { scene, info }) = &self.content {
            identity.debug("content", &(scene.checksum(), info));
        }
    }

    pub(super) fn names(&self, objects: &[u32]) -> Vec<String> {
        let Bakeable::Scene(SceneFile { scene, .. }) = &self.content else { return Vec::new() };
        objects.iter().map(|&object| scene.objects()[object as usize].name.clone()).collect()
    }

    /// The error, with the name of the file that it is about.
    pub(super) fn failed(&self, path: &Path, source: BakeError) -> anyhow::Error {
        let map = match &self.content {
            Bakeable::Plan { map, .. } => map.map(|name| name.to_string()),
            _ => None,
        };
        match (source, &self.portals) {
            (BakeError::Prt(source), Some(portals)) => quake::failed(path, portals, source),
            (BakeError::Prt(source), None) => anyhow!("{}: {source}", path.display()),
            (BakeError::Meaningless(option), _) => meaningless(path, option),
            (BakeError::Method(source), _) => method_failed(path, source),
            (source, _) => anyhow!("{}: {}{source}", path.display(), of_map(map.as_ref())),
        }
    }
}

/// Bakes with a progress bar, and warns of what is only approximate in the answer.
pub(crate) fn bake_visibly<'i>(
    path: &Path,
    input: impl Into<BakeInput<'i>>,
    request: &BakeRequest,
    show_progress: bool,
) -> Result<Baked, BakeError> {
    let runtime = Runtime::default();
    bake_announced(path, &request.prepare(input, &runtime)?, &runtime, Plan::default(), show_progress)
}

/// The same of what was prepared; says before what is going to be done.
pub(super) fn bake_announced(
    path: &Path,
    prepared: &PreparedBake<'_>,
    runtime: &Runtime<'_>,
    plan: Plan,
    show_progress: bool,
) -> Result<Baked, BakeError> {
    let what = match prepared.input() {
        BakeInput::Portals(_) | BakeInput::Map(..) => "visibility of clusters",
        BakeInput::Plan(_) | BakeInput::Scene(..) => "visibility",
    };
    let bar = Bar::new(what, show_progress);
    let announcer = Announcer::new(&bar, &plan, show_progress);
    let baked = prepared.run(&Runtime { progress: Some(&announcer), ..*runtime })?;
    drop(bar);
    match &baked.report {
        Report::Plan(report) => plan::warn(path, report),
        Report::Scene(report) => space::warn(path, report),
        _ => {}
    }
    Ok(baked)
}
