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
pub struct InProcessDrive<L = Laws>(PhantomData<fn() -> L>);

impl<L> Default for InProcessDrive<L> {
    fn default() -> Self {
        Self(PhantomData)
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
        let link = InProcess::<L>::default();
        let host = DriveHost::InProcess(link.suspension.clone());
        Ok(Opened { link: Box::new(link), host })
    }

    fn with_plant(&self, pins: &PinPlant) -> Result<Option<Box<dyn DeviceKind>>, DeviceError> {
        Ok(Some(Box::new(BenchDrive::<L>(pins.clone(), PhantomData))))
    }
}

/// The drive with these laws in this process, with a plant behind its pins.
struct BenchDrive<L>(PinPlant, PhantomData<fn() -> L>);

impl<L> fmt::Debug for BenchDrive<L> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("BenchDrive")
    }
}

impl<L: LawSet> DeviceKind for BenchDrive<L> {
    fn name(&self) -> String {
        NAME.to_owned()
    }

    fn open(&self, _baud: u32, _supervisor: &Supervisor) -> Result<Opened, DeviceError> {
        let Self(pins, _) = self;
        let torque_per_duty_nm = pins.torque_per_duty_nm(NAME)?;
        let link = InProcessBench::<L>::new(pins.release(NAME)?, pins.scales, torque_per_duty_nm);
        Ok(Opened { link: Box::new(link), host: DriveHost::External })
    }

    fn keeps_bench_clock(&self, clock: ClockName) -> bool {
        clock == ClockName::Lockstep
    }
}
