//! Drives behind servers of serial ports that others have written: ser2net and pyserial's RFC 2217 server, and QEMU.

mod servers;

use std::process::ExitCode;

use libtest_mimic::Arguments;
use tests::optional::{self, trial};
use tests::python;

type Check = fn();

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let ser2net = servers::ser2net_missing();
    let python = python::missing();
    let emulator = servers::emulator_missing();
    let trials: [(&str, &Option<String>, Check); 5] = [
        ("ser2net::a_raw_port_gives_the_torques_of_the_terminal", &ser2net, servers::ser2net_raw),
        ("ser2net::an_rfc2217_port_gives_the_torques_of_the_terminal", &ser2net, servers::ser2net_rfc2217),
        ("ser2net::an_rfc2217_port_is_recognised_as_such", &ser2net, servers::ser2net_confused),
        ("pyserial::an_rfc2217_port_gives_the_torques_of_the_terminal", &python, servers::pyserial),
        ("qemu::the_image_behind_a_port_gives_the_torques_of_the_terminal", &emulator, servers::qemu),
    ];
    let missing =
        [&ser2net, &python, &emulator].into_iter().flatten().cloned().collect::<Vec<_>>().join("\n");
    let missing = (!missing.is_empty()).then_some(missing);
    let trials =
        trials.into_iter().map(|(name, missing, check)| trial(name, missing.clone(), check)).collect();
    optional::run(&arguments, "servers of serial ports", missing.as_deref(), trials)
}
