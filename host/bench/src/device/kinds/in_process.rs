//! `inproc`: the drive in this process, called directly.

use std::fmt;
use std::marker::PhantomData;

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_link::in_process::InProcess;

use crate::device::drive_host::DriveHost;
use crate::device::error::DeviceError;
use crate::device::in_process_bench::InProcessBench;
use crate::device::kind::{DeviceKind, Opened, Syntax};
use crate::device::pin_plant::PinPlant;
use crate::supervisor::Supervisor;
use crate::timing::ClockName;

const NAME: &str = "inproc";

/// How a user names the drive with these laws in this process.
#[must_use]
pub const fn syntax<L: LawSet>() -> Syntax {
    Syntax {
        form: NAME,
        parse: |text| {
            (text == NAME).then(|| Ok(Box::new(InProcessDrive::<L>::default()) as Box<dyn DeviceKind>))
        },
    }
}

/// The drive with these laws in this process.
pub struct InProcessDrive<L = Laws> {
    /// The plant behind its pins; `None` for a drive without pins.
    pins: Option<PinPlant>,
    laws: PhantomData<fn() -> L>,
}

impl<L> Default for InProcessDrive<L> {
    fn default() -> Self {
        Self { pins: None, laws: PhantomData }
    }
}

impl<L> fmt::Debug for InProcessDrive<L> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("InProcessDrive")
    }
}

impl<L: LawSet> DeviceKind for InProcessDrive<L> {
    fn name(&self) -> String {
        NAME.to_owned()
    }

    fn open(&self, _baud: u32, _supervisor: &Supervisor) -> Result<Opened, DeviceError> {
        if let Some(pins) = &self.pins {
            let link = InProcessBench::<L>::new(pins, NAME)?;
            return Ok(Opened { link: Box::new(link), host: DriveHost::External });
        }
        let link = InProcess::<L>::default();
        let host = DriveHost::InProcess(link.suspension.clone());
        Ok(Opened { link: Box::new(link), host })
    }

    fn with_plant(&self, pins: &PinPlant) -> Result<Option<Box<dyn DeviceKind>>, DeviceError> {
        Ok(Some(Box::new(Self { pins: Some(pins.clone()), ..Self::default() })))
    }

    fn keeps_bench_clock(&self, clock: ClockName) -> bool {
        clock == if self.pins.is_some() { ClockName::Lockstep } else { ClockName::RealTime }
    }
}
