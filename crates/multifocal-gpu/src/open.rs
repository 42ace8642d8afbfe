//! Finding a device.

use crate::{Gpu, OpenError};
use wgpu::{Device, DeviceDescriptor, Instance, InstanceDescriptor, InstanceFlags, Limits, PowerPreference, Queue};

impl Gpu {
    /// Finds the fastest adapter and opens a device on it, without optional features. Waits for the driver.
    ///
    /// # Errors
    /// [`OpenError`]
    pub fn open() -> Result<Self, OpenError> {
        pollster::block_on(Self::open_async())
    }

    /// As [`Self::open`], without waiting.
    ///
    /// # Errors
    /// [`OpenError`]
    pub async fn open_async() -> Result<Self, OpenError> {
        let flags = InstanceFlags::empty();
        let instance = Instance::new(InstanceDescriptor { flags, ..InstanceDescriptor::new_without_display_handle() });
        let options =
            wgpu::RequestAdapterOptions { power_preference: PowerPreference::HighPerformance, ..Default::default() };
        let adapter = instance.request_adapter(&options).await.map_err(|e| OpenError::NoAdapter(e.to_string()))?;
        let offered = adapter.limits();
        // Larger buffers make larger jobs possible; everything else is what every device has.
        let required_limits = Limits {
            max_buffer_size: offered.max_buffer_size,
            max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size,
            ..Limits::default()
        };
        let descriptor = DeviceDescriptor { label: Some("sightlines"), required_limits, ..Default::default() };
        let name = adapter.get_info().name;
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|e| OpenError::NoDevice { adapter: name.clone(), reason: e.to_string() })?;
        let gpu = Self::new(device, queue, name)?;
        gpu.hear_of_loss();
        Ok(gpu)
    }

    /// Works on the device and the queue of a host. If the device is lost, results fail; the loss is then recognized
    /// from the failure, or reported by [`Self::tell_lost`], since a device calls only one callback, and that is the
    /// host's.
    ///
    /// # Errors
    /// [`OpenError::Limit`], [`OpenError::Shaders`]
    pub fn from_device(device: Device, queue: Queue) -> Result<Self, OpenError> {
        check(&device.limits())?;
        Self::new(device, queue, "the host's device".to_owned())
    }
}

/// Whether a device can run all shaders.
fn check(limits: &Limits) -> Result<(), OpenError> {
    let needed = [
        ("invocations of a workgroup", limits.max_compute_invocations_per_workgroup, 256),
        ("size of a workgroup", limits.max_compute_workgroup_size_x, 256),
        ("memory of a workgroup", limits.max_compute_workgroup_storage_size, 16384),
        ("storage buffers of a stage", limits.max_storage_buffers_per_shader_stage, 5),
        ("bindings of a group", limits.max_bindings_per_bind_group, 6),
    ];
    for (limit, offered, needed) in needed {
        if offered < needed {
            return Err(OpenError::Limit { limit, offered: offered.into(), needed: needed.into() });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_every_device_has_suffices_and_less_is_named() {
        assert_eq!(check(&Limits::default()), Ok(()));
        let small = Limits { max_compute_workgroup_storage_size: 8192, ..Limits::default() };
        let error = check(&small).expect_err("too little").to_string();
        assert_eq!(error, "the device offers 8192 as memory of a workgroup, and 16384 are needed");
        let few = Limits { max_storage_buffers_per_shader_stage: 4, ..Limits::default() };
        assert!(check(&few).is_err());
    }
}
