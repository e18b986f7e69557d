//! The device of a run, with the faults on its link.

use lashloop_link::{Link, TimeBase};

use crate::device::{Device, DeviceChoice, DeviceError};
use crate::fault::link::LinkFaults;
use crate::scenario::Scenario;
use crate::supervisor::Supervisor;
use crate::timing::ClockName;

/// A device and the faults on its link.
pub struct DeviceUnderTest {
    /// The device.
    pub device: Device,
    /// The faults that its link was wrapped in; `None` if it has none.
    pub link_faults: Option<LinkFaults>,
}

impl DeviceUnderTest {
    /// Opens a device for a scenario: at its line speed, with its faults on the link, and in bench mode with its plant behind
    /// the pins. `middleware` wraps the link on the
    /// bench's side of the faults.
    ///
    /// # Errors
    /// What could not be reached, and what to do.
    pub fn open(
        scenario: &Scenario,
        choice: &DeviceChoice,
        clock: ClockName,
        supervisor: &Supervisor,
        middleware: impl FnOnce(Box<dyn Link>) -> Box<dyn Link>,
    ) -> Result<Self, DeviceError> {
        let link_faults = LinkFaults::new(scenario);
        let inject = |mut link: Box<dyn Link>| {
            // Until the run chooses its clock: the start of a program counts against no limit.
            link.set_time_base(TimeBase::Virtual);
            match &link_faults {
                Some(faults) => faults.wrap(link, scenario),
                None => link,
            }
        };
        let choice = choice.for_run(scenario, clock)?;
        let device =
            Device::open_through(&choice, &scenario.link, supervisor, |link| middleware(inject(link)))?;
        Ok(Self { device, link_faults })
    }
}

impl From<Device> for DeviceUnderTest {
    /// A device without faults on its link.
    fn from(device: Device) -> Self {
        Self { device, link_faults: None }
    }
}
