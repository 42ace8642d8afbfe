//! Every way keeps the contract of backends.

use crate::common::gpu;
use sightlines_multifocal_cpu::Reference;
use sightlines_multifocal_gpu::{GpuBackend, GpuPath};
use sightlines_testkit::conformance::{Backends, Impostor, Slack, Suite};

const INTEGER: Backends<Reference> = Backends::quick(Reference, Slack::INTEGER);

#[test]
fn integers_keep_the_contract() {
    let Some(gpu) = gpu("the contract, in integers") else { return };
    for way in [GpuPath::Compute, GpuPath::Raster] {
        let report = Backends { rounds: 3, ..INTEGER }.run(&mut GpuBackend::new(gpu.clone(), way));
        let report = report.unwrap_or_else(|v| panic!("{}: {v}", way.name()));
        assert!(report["blocked texels"] > 300, "{}: {report:?}", way.name());
        assert!(report["texels that one occluder blocks"] > 300, "{}: {report:?}", way.name());
        assert!(report["texels that a plane before blocks"] > 50, "{}: {report:?}", way.name());
    }
}

#[test]
fn impostors_on_a_device_are_refused() {
    let Some(gpu) = gpu("impostors") else { return };
    INTEGER.refuse_all(|fault| Impostor::new(GpuBackend::new(gpu.clone(), GpuPath::Compute), fault));
}
