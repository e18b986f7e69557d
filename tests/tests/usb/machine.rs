//! The one guest of all trials, and what they do with it.

use std::ops::{Deref, DerefMut};
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use std::{mem, thread};

use regex_lite::Regex;
use serde_json::Value;
use tests::program;
use tests::usb_guest::guest::{Ended, Guest};
use tests::usb_guest::request::User;

/// The run of most trials: a move and a rest, with expectations that only an undisturbed drive meets.
pub(crate) const SCENARIO: &str = "scenarios/faults.toml";
/// Where a run in the guest leaves its record.
const OUT: &str = "/tmp/out";

/// Boots in a run of all trials: one, and one each after two trials that fail.
const BOOTS: u32 = 3;
/// Time for a trial, in seconds of the guest.
const TRIAL_LIMIT_S: u32 = 600;

/// The guest and its trials.
#[derive(Default)]
struct Power {
    guest: Option<Guest>,
    boots: u32,
    /// Why no trial boots it again.
    failed: Option<String>,
}

static POWER: Mutex<Power> = Mutex::new(Power { guest: None, boots: 0, failed: None });

/// The guest during one trial.
pub(crate) struct Machine {
    guest: Guest,
    /// Name of the trial.
    name: &'static str,
    /// When the trial began, in seconds of the guest.
    began_s: u32,
    is_slow: bool,
}

impl Power {
    /// The guest, booted if it is off.
    fn take(&mut self) -> Result<Guest, String> {
        if let Some(guest) = self.guest.take() {
            return Ok(guest);
        }
        if let Some(reason) = &self.failed {
            return Err(reason.clone());
        }
        self.boots += 1;
        let booted = match self.boots {
            ..=BOOTS => {
                Guest::boot(Path::new(env!("CARGO_BIN_EXE_usb-guest"))).map_err(|error| format!("{error:#}"))
            }
            _ => Err(format!("the guest was booted {BOOTS} times, and trials failed on each")),
        };
        booted.inspect_err(|reason| self.failed = Some(reason.clone()))
    }
}

/// Makes a trial, one at a time. After one that fails, the guest is off: the next trial finds nothing of it. A trial in which
/// the guest stands still is made once more.
///
/// # Panics
/// The trial fails, or the guest did not come up.
pub(crate) fn try_out(name: &'static str, check: fn(&mut Machine)) {
    let mut power = POWER.lock().unwrap_or_else(PoisonError::into_inner);
    for is_last in [false, true] {
        let guest = power.take().unwrap_or_else(|reason| panic!("{reason}"));
        let began_s = guest.seconds();
        let mut machine = Machine { guest, name, began_s, is_slow: false };
        let result = panic::catch_unwind(AssertUnwindSafe(|| check(&mut machine)));
        let stood_still = machine.guest.failed().is_some();
        if is_last {
            println!("second attempt of {name}: {}", if result.is_ok() { "passed" } else { "not passed" });
        }
        match result {
            Ok(()) => return power.guest = Some(machine.guest),
            Err(_) if stood_still && !is_last => println!("the guest stood still in {name}: it boots again"),
            Err(reason) => {
                drop(machine);
                panic::resume_unwind(reason)
            }
        }
    }
}

/// Ends the guest: a static value is never dropped.
pub(crate) fn switch_off() {
    POWER.lock().unwrap_or_else(PoisonError::into_inner).guest = None;
}

impl Machine {
    /// Checks that the trial has time left by the guest's clock.
    fn check_time(&mut self) {
        let taken_s = self.guest.seconds() - self.began_s;
        if taken_s > TRIAL_LIMIT_S / 2 && !mem::replace(&mut self.is_slow, true) {
            println!("test {} has taken {taken_s} s of the guest's clock, half of its limit", self.name);
        }
        assert!(
            taken_s <= TRIAL_LIMIT_S || thread::panicking(),
            "the trial takes more than {TRIAL_LIMIT_S} s"
        );
    }
}

impl Deref for Machine {
    type Target = Guest;

    fn deref(&self) -> &Guest {
        &self.guest
    }
}

/// Every request of a trial passes here.
impl DerefMut for Machine {
    fn deref_mut(&mut self) -> &mut Guest {
        self.check_time();
        &mut self.guest
    }
}

/// A device in a port of the guest. Unplugged when the trial ends, also by a failure.
pub(crate) struct Device<'a> {
    pub(crate) machine: &'a mut Machine,
    kind: Kind,
    command: Option<u32>,
    terminal: &'static str,
}

/// What is plugged in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A drive behind a serial adapter.
    Adapter,
    /// A drive with the USB port of the firmware.
    DrivePort,
    /// A boot loader behind a serial adapter.
    Loader,
}

/// When a device is unplugged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unplug {
    ByTest,
    /// After the host has sent so many bytes, and some time; that of a loader also when it starts what it has received.
    After {
        bytes: usize,
        delay_us: u32,
    },
}

impl Kind {
    fn word(self) -> &'static str {
        match self {
            Self::Adapter => "ftdi",
            Self::DrivePort => "cdc",
            Self::Loader => "loader",
        }
    }

    fn terminal(self) -> &'static str {
        match self {
            Self::Adapter | Self::Loader => "/dev/ttyUSB0",
            Self::DrivePort => "/dev/ttyACM0",
        }
    }

    /// udev's name for a device with this serial number.
    pub(crate) fn stable_name(self, serial_number: &str) -> String {
        match self {
            Self::Adapter | Self::Loader => {
                format!("/dev/serial/by-id/usb-FTDI_FT232R_USB_UART_{serial_number}-if00-port0")
            }
            Self::DrivePort => format!("/dev/serial/by-id/usb-Lashloop_Lashloop_drive_{serial_number}-if00"),
        }
    }
}

impl<'a> Device<'a> {
    /// Plugs a device in and waits for its terminal.
    pub(crate) fn plug(machine: &'a mut Machine, kind: Kind, serial_number: &str) -> Self {
        Self::plug_until(machine, kind, serial_number, Unplug::ByTest)
    }

    pub(crate) fn plug_until(
        machine: &'a mut Machine,
        kind: Kind,
        serial_number: &str,
        unplug: Unplug,
    ) -> Self {
        let mut device = Self { machine, kind, command: None, terminal: kind.terminal() };
        device.replug_until(serial_number, unplug);
        device
    }

    pub(crate) fn unplug(&mut self) {
        if let Some(command) = self.command.take() {
            self.machine.kill(command);
        }
    }

    /// Waits until the device is unplugged.
    pub(crate) fn await_unplug(&mut self) {
        self.machine.await_removal(self.terminal);
    }

    /// Whether the device is unplugged within the time of such a wait.
    pub(crate) fn is_unplugged_soon(&mut self) -> bool {
        self.machine.vanishes(self.terminal)
    }

    /// Plugs another one into the same port.
    pub(crate) fn replug(&mut self, serial_number: &str) {
        self.replug_until(serial_number, Unplug::ByTest);
    }

    pub(crate) fn replug_until(&mut self, serial_number: &str, unplug: Unplug) {
        self.unplug();
        self.await_unplug();
        let mut words = vec!["plug", self.kind.word(), "0", serial_number];
        let after = match unplug {
            Unplug::ByTest => Vec::new(),
            Unplug::After { bytes, delay_us } => vec![bytes.to_string(), delay_us.to_string()],
        };
        words.extend(after.iter().map(String::as_str));
        self.command = Some(self.machine.start_own(&words));
        self.machine.await_file(self.terminal);
        self.machine.await_file(&self.kind.stable_name(serial_number));
    }

    pub(crate) fn terminal(&self) -> &'static str {
        self.terminal
    }
}

impl Drop for Device<'_> {
    fn drop(&mut self) {
        // A guest that no longer answers has failed the trial already.
        if !std::thread::panicking() {
            self.unplug();
        } else if let Some(command) = self.command.take() {
            let _ = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| self.machine.kill(command)));
        }
    }
}

/// Runs the scenario on a device of the guest, and returns the end and the record's summary.
pub(crate) fn run(machine: &mut Machine, device: &str, settings: &[&str]) -> (Ended, Value) {
    let command = start_run(machine, device, settings);
    finish_run(machine, command)
}

/// Starts a run and waits until it has begun.
pub(crate) fn start_run(machine: &mut Machine, device: &str, settings: &[&str]) -> u32 {
    machine.remove_folder(OUT);
    let mut words = vec!["run", SCENARIO, "--device", device, "--out", OUT, "--set", "record.flush_rows=20"];
    words.extend(settings.iter().flat_map(|setting| ["--set", setting]));
    machine.start_lashloop(User::Root, &words)
}

/// Time for the first chunks of a run, in seconds of the guest.
const CHUNKS_LIMIT_S: u32 = 60;

/// Waits until the samples of a run grow. A run that has none is ended, and what it said is shown.
pub(crate) fn await_run(machine: &mut Machine, command: u32) {
    let samples = format!("{OUT}/run.mcap");
    let began_s = machine.seconds();
    let length = |machine: &mut Machine| machine.read_if_present(&samples).map(|text| text.len());
    let mut first = None;
    while machine.seconds() - began_s < CHUNKS_LIMIT_S {
        let length = length(machine);
        if first.is_some() && length > first {
            return;
        }
        first = first.or(length);
        // Each look is work for the guest.
        thread::sleep(Duration::from_millis(100));
    }
    let Ended { code, stdout, stderr } = machine.wait(command);
    panic!(
        "no steps in run.mcap within {CHUNKS_LIMIT_S} s of the guest's clock: {code:?}\n{stdout}\n{stderr}"
    );
}

/// Waits for the end of a run.
pub(crate) fn finish_run(machine: &mut Machine, command: u32) -> (Ended, Value) {
    let ended = machine.wait(command);
    let summary = machine.read_if_present(&format!("{OUT}/summary.json")).unwrap_or_default();
    (ended, serde_json::from_str(&summary).unwrap_or_default())
}

/// The first half of the move: a step costs the emulator milliseconds, and the expectations are missed.
pub(crate) const SHORT: &str = "run.duration_s=2.0";

/// Checks that a run on a device ends as that of the drive in process, with the same torques.
pub(crate) fn check_torques(machine: &mut Machine, device: &str, settings: &[&str]) {
    let here = ["run", SCENARIO, "--device", "inproc", "--details"].into_iter();
    let here = program::run(here.chain(settings.iter().flat_map(|setting| ["--set", setting])));
    let (there, summary) = run(machine, device, settings);
    assert_eq!(there.code, here.code, "{}\n{}", there.stdout, there.stderr);
    assert_eq!(summary["torque_sha256"], digest(&here.stdout), "{}", there.stdout);
    let link = &summary["link"];
    assert_eq!((&link["lost"], &link["crc_errors"]), (&0.into(), &0.into()), "{}", there.stdout);
}

fn digest(report: &str) -> String {
    let pattern = Regex::new(r"sha256 ([0-9a-f]{64})").expect("a pattern");
    pattern.captures(report).unwrap_or_else(|| panic!("no digest in {report}"))[1].to_owned()
}

/// Settings of a run that resumes once. The law starts anew, so the expectations don't count.
pub(crate) const RESUMING: [&str; 6] = [
    SHORT,
    "link.on_loss=\"resume\"",
    "link.resume_limit_ms=60000",
    "allow.resumes=1",
    "allow.lost=20",
    "record.flush_rows=10",
];

/// Checks that a run went on to its end after one loss.
pub(crate) fn check_resumed((ended, summary): &(Ended, Value)) {
    let text = || format!("{}\n{}", ended.stdout, ended.stderr);
    assert!(matches!(ended.code, Some(0 | 1)), "{:?}\n{}", ended.code, text());
    assert_eq!((&summary["end"], &summary["link"]["resumes"]), (&"complete".into(), &1.into()), "{}", text());
}
