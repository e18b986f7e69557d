//! The USB class code of the firmware on the kernel's `cdc_acm`. The chip's OTG peripheral takes no part.

use crate::machine::{
    Device, Kind, Machine, RESUMING, SHORT, await_run, check_resumed, check_torques, finish_run, start_run,
};

fn plug(machine: &mut Machine) -> Device<'_> {
    Device::plug(machine, Kind::DrivePort, "LASHC1")
}

pub(crate) fn listed(machine: &mut Machine) {
    let device = plug(machine);
    let ports = device.machine.lashloop(&["doctor"]).with_code(0).stdout;
    let name = Kind::DrivePort.stable_name("LASHC1");
    for line in ["USB 1209:0001  Lashloop, Lashloop drive, serial number LASHC1", &name] {
        assert!(ports.contains(line), "{line} in\n{ports}");
    }
}

pub(crate) fn healthy(machine: &mut Machine) {
    let device = plug(machine);
    let terminal = device.terminal();
    let doctor = device.machine.lashloop(&["doctor", terminal]).with_code(0);
    assert!(doctor.stdout.contains("n/a    latency timer  this driver has none"), "{}", doctor.stdout);
}

pub(crate) fn torques(machine: &mut Machine) {
    let device = plug(machine);
    let terminal = device.terminal();
    check_torques(device.machine, terminal, &[SHORT]);
}

pub(crate) fn conforming(machine: &mut Machine) {
    let device = plug(machine);
    let terminal = device.terminal();
    let ended = device.machine.lashloop(&["conformance", "--device", terminal]).with_code(0);
    let last = ended.stdout.lines().last().unwrap_or_default();
    assert!(last.contains(" 0 failed"), "{}", ended.stdout);
}

pub(crate) fn resumed(machine: &mut Machine) {
    let mut device = plug(machine);
    let run = start_run(device.machine, &Kind::DrivePort.stable_name("LASHC1"), &RESUMING);
    await_run(device.machine, run);
    device.replug("LASHC1");
    check_resumed(&finish_run(device.machine, run));
}
