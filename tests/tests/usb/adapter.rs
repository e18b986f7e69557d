//! An FTDI adapter in software, with a latency timer that holds bytes back, on the kernel's `ftdi_sio`.

use lashloop_link::latency_timer::UDEV_RULE;
use tests::usb_guest::request::User;

use crate::machine::{
    Device, Kind, Machine, RESUMING, SCENARIO, SHORT, await_run, check_resumed, check_torques, finish_run,
    start_run,
};

const TIMER: &str = "/sys/bus/usb-serial/devices/ttyUSB0/latency_timer";
const RULES: &str = "/etc/udev/rules.d/90-ftdi-latency.rules";
/// Few samples, because each takes 16 ms.
const DOCTOR: [&str; 4] = ["doctor", "/dev/ttyUSB0", "--rounds", "60"];

pub(crate) fn listed(machine: &mut Machine) {
    let device = Device::plug(machine, Kind::Adapter, "LASHF1");
    let ports = device.machine.lashloop(&["doctor"]).with_code(0).stdout;
    let wanted = ["/dev/ttyUSB0     USB 0403:6001  FTDI, FT232R USB UART, serial number LASHF1"];
    for line in wanted.into_iter().chain([Kind::Adapter.stable_name("LASHF1").as_str()]) {
        assert!(ports.contains(line), "{line} in\n{ports}");
    }
}

pub(crate) fn torques(machine: &mut Machine) {
    let device = Device::plug(machine, Kind::Adapter, "LASHF1");
    let terminal = device.terminal();
    check_torques(device.machine, terminal, &[SHORT]);
}

/// p50 of the round trip in a report of `doctor`, in us.
fn p50_us(report: &str) -> f64 {
    let (_, after) = report.split_once("p50 ").unwrap_or_else(|| panic!("no round trip in\n{report}"));
    after.split(' ').next().and_then(|word| word.parse().ok()).unwrap_or_else(|| panic!("{report}"))
}

pub(crate) fn warned(machine: &mut Machine) {
    let device = Device::plug(machine, Kind::Adapter, "LASHF1");
    let machine = &mut *device.machine;
    assert_eq!(machine.read(TIMER), "16");
    let doctor = machine.lashloop_as(User::Member, &DOCTOR).with_code(1);
    assert!(
        doctor.stdout.contains("WRONG  latency timer  16 ms and can't be shortened"),
        "{}",
        doctor.stdout
    );
    assert!(p50_us(&doctor.stdout) > 12_000.0, "{}", doctor.stdout);
    let budget =
        machine.lashloop_as(User::Member, &["budget", "--measured", "/dev/ttyUSB0", "--rounds", "40"]);
    let budget = budget.with_code(1).stdout;
    assert!(budget.contains("merzouki       OUTSIDE") || budget.contains("beyond the map"), "{budget}");
    assert!(budget.contains("remedy         the latency timer is 16 ms and can't be shortened"), "{budget}");
    let mut run = vec!["run", SCENARIO, "--device", "/dev/ttyUSB0"];
    // Few samples again.
    for setting in ["run.duration_s=2.0", "run.control_period_us=10000"] {
        run.extend(["--set", setting]);
    }
    let run = machine.lashloop_as(User::Member, &run);
    let warning = "lashloop: warning: the latency timer of /dev/ttyUSB0 is 16 ms";
    assert!(run.stderr.contains(warning) && run.stderr.contains(UDEV_RULE), "{}", run.stderr);
}

pub(crate) fn shortened(machine: &mut Machine) {
    let device = Device::plug(machine, Kind::Adapter, "LASHF1");
    let machine = &mut *device.machine;
    let doctor = machine.lashloop(&DOCTOR);
    assert!(doctor.stdout.contains("was 16 ms, set to 1 ms"), "{}", doctor.stdout);
    assert_eq!(machine.read(TIMER), "1");
    assert!(p50_us(&doctor.stdout) < 12_000.0, "{}", doctor.stdout);
}

pub(crate) fn udev_rule(machine: &mut Machine) {
    machine.write(RULES, &format!("{UDEV_RULE}\n"));
    let _ = machine.run(&["/bin/udevadm", "control", "--reload"]).with_code(0);
    let device = Device::plug(machine, Kind::Adapter, "LASHF1");
    let timer = device.machine.read(TIMER);
    device.machine.write(RULES, "");
    let _ = device.machine.run(&["/bin/udevadm", "control", "--reload"]).with_code(0);
    assert_eq!(timer, "1");
}

pub(crate) fn held(machine: &mut Machine) {
    let device = Device::plug(machine, Kind::Adapter, "LASHF1");
    let machine = &mut *device.machine;
    let holder = start_run(machine, "/dev/ttyUSB0", &["run.duration_s=1000"]);
    await_run(machine, holder);
    let users = [User::Member, User::Root].map(|user| machine.lashloop_as(user, &DOCTOR));
    machine.kill(holder);
    for doctor in users {
        let doctor = doctor.with_code(4);
        assert!(doctor.stdout.contains("another program holds it"), "{}", doctor.stdout);
    }
}

pub(crate) fn resumed(machine: &mut Machine) {
    let mut device = Device::plug(machine, Kind::Adapter, "LASHF1");
    let name = Kind::Adapter.stable_name("LASHF1");
    let run = start_run(device.machine, &name, &RESUMING);
    await_run(device.machine, run);
    device.replug("LASHF1");
    check_resumed(&finish_run(device.machine, run));
}

pub(crate) fn other_adapter(machine: &mut Machine) {
    let mut device = Device::plug(machine, Kind::Adapter, "LASHF1");
    let settings = [&RESUMING[..], &["link.resume_limit_ms=3000"]].concat();
    let run = start_run(device.machine, "/dev/ttyUSB0", &settings);
    await_run(device.machine, run);
    device.replug("LASHF2");
    let (ended, _) = finish_run(device.machine, run);
    let ended = ended.with_code(4);
    for word in ["another adapter has taken the name", "LASHF1", "LASHF2"] {
        assert!(ended.stderr.contains(word), "{word} in\n{}", ended.stderr);
    }
}
