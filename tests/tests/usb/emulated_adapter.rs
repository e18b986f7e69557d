//! QEMU's model of an FTDI adapter on the kernel's `ftdi_sio`, with a native twin of this machine at its far end.

use tests::twin::Twin;
use tests::usb_guest::adapter::Plugged;

use crate::machine::{
    Machine, RESUMING, SHORT, await_run, check_resumed, check_torques, finish_run, start_run,
};

const NAME: &str = "/dev/serial/by-id/usb-QEMU_QEMU_USB_SERIAL_QEMU0001-if00-port0";

fn plug(machine: &mut Machine, drive: &Twin) -> Plugged {
    let plugged = Plugged::insert(&machine.adapter(), drive.path());
    machine.await_file(NAME);
    plugged
}

pub(crate) fn torques(machine: &mut Machine) {
    let drive = Twin::start();
    let plugged = plug(machine, &drive);
    check_torques(machine, NAME, &[SHORT]);
    drop(plugged);
    machine.await_removal(NAME);
}

pub(crate) fn resumed(machine: &mut Machine) {
    let drive = Twin::start();
    let plugged = plug(machine, &drive);
    let run = start_run(machine, NAME, &RESUMING);
    await_run(machine, run);
    drop(plugged);
    machine.await_removal(NAME);
    let plugged = plug(machine, &drive);
    check_resumed(&finish_run(machine, run));
    drop(plugged);
    machine.await_removal(NAME);
}
