//! Every way keeps the contract of backends.

use crate::common::gpu;
use sightlines_multifocal::conformance::impostors::{Fault, Impostor};
use sightlines_multifocal::conformance::{Effort, Slack, run};
use sightlines_multifocal_cpu::Reference;
use sightlines_multifocal_gpu::{GpuBackend, GpuPath};

#[test]
fn integers_keep_the_contract() {
    let Some(gpu) = gpu("the contract, in integers") else { return };
    for way in [GpuPath::Compute, GpuPath::Raster] {
        let effort = Effort { rounds: 3, ..Effort::quick(Slack::INTEGER) };
        let report = run(&mut GpuBackend::new(gpu.clone(), way), &mut Reference, &effort);
        let report = report.unwrap_or_else(|v| panic!("{}: {v}", way.name()));
        assert!(report.blocked > 300 && report.tight > 300 && report.carried > 50, "{}: {report:?}", way.name());
    }
}

#[test]
fn impostors_on_a_device_are_refused() {
    let Some(gpu) = gpu("impostors") else { return };
    for fault in Fault::ALL {
        let mut impostor = Impostor::new(GpuBackend::new(gpu.clone(), GpuPath::Compute), fault);
        let violation = run(&mut impostor, &mut Reference, &Effort::quick(Slack::INTEGER));
        let violation = violation.expect_err(&format!("{fault:?} passes"));
        assert_eq!(violation.clause(), fault.clause(), "{fault:?}: {violation}");
    }
}
