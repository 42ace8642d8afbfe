//! Numbers for Bevy's diagnostics.

use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::prelude::*;
use std::time::Duration;

/// Entities that cameras with [`PvsCamera`](crate::PvsCamera) draw, all of them together.
pub const DRAWN: DiagnosticPath = DiagnosticPath::const_new("sightlines/drawn");
/// Entities in their pictures that cannot be seen and are not drawn.
pub const CULLED: DiagnosticPath = DiagnosticPath::const_new("sightlines/culled");
/// Time of the queries of a frame, in microseconds.
pub const QUERY_US: DiagnosticPath = DiagnosticPath::const_new("sightlines/query_us");

/// Counts of the last frame.
#[derive(Resource, Debug, Clone, Copy, Default)]
pub(crate) struct Counts {
    pub(crate) n_cameras: u32,
    pub(crate) drawn: u32,
    pub(crate) culled: u32,
    pub(crate) query: Duration,
}

/// Makes the diagnostics known.
pub(crate) fn register(app: &mut App) {
    app.init_resource::<Counts>()
        .register_diagnostic(Diagnostic::new(DRAWN))
        .register_diagnostic(Diagnostic::new(CULLED))
        .register_diagnostic(Diagnostic::new(QUERY_US).with_suffix("us"));
}

/// Writes the diagnostics.
pub(crate) fn measure(counts: Res<Counts>, mut diagnostics: Diagnostics<'_, '_>) {
    if counts.n_cameras > 0 {
        diagnostics.add_measurement(&DRAWN, || f64::from(counts.drawn));
        diagnostics.add_measurement(&CULLED, || f64::from(counts.culled));
        diagnostics.add_measurement(&QUERY_US, || counts.query.as_secs_f64() * 1e6);
    }
}
