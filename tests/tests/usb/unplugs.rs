//! A run that resumes over many unplugs, next to a program that takes the guest's one processor.

use std::{env, fs};

use crate::machine::{Device, Kind, Machine, Unplug, finish_run, start_run};

/// Variable of the environment with another number of unplugs.
const VARIABLE: &str = "LASHLOOP_UNPLUGS";
const UNPLUGS: u32 = 2;
/// More than a handshake and a set-up send.
const BYTES: usize = 1_500;
/// More samples than come before an unplug, in some 10 ms after these bytes too.
const SAMPLES: u32 = 200;

fn unplugs() -> u32 {
    let Ok(text) = env::var(VARIABLE) else { return UNPLUGS };
    text.parse().unwrap_or_else(|_| panic!("{VARIABLE} is {text:?}; it must be a number"))
}

pub(crate) fn of_an_adapter(machine: &mut Machine) {
    all_resumed(machine, Kind::Adapter, "ftdi_sio");
}

pub(crate) fn of_a_drive(machine: &mut Machine) {
    all_resumed(machine, Kind::DrivePort, "cdc_acm");
}

fn all_resumed(machine: &mut Machine, kind: Kind, driver: &str) {
    let unplugs = unplugs();
    let load = machine.start_own(&["spin"]);
    // Bytes and times of no common measure: over many unplugs every moment of a step is met.
    let unplug = |number: u32| Unplug::After {
        bytes: BYTES + 7 * (number as usize % 31),
        delay_us: 137 * (number % 73),
    };
    let mut device = Device::plug_until(machine, kind, "LASHU1", unplug(0));
    let steps = 100 + SAMPLES * unplugs;
    let settings = [
        format!("run.duration_s={}", f64::from(steps) / 1e3),
        "link.on_loss=\"resume\"".to_owned(),
        "link.resume_limit_ms=60000".to_owned(),
        format!("allow.resumes={unplugs}"),
        "allow.lost=1000000".to_owned(),
        "expect=[]".to_owned(),
    ];
    let settings: Vec<_> = settings.iter().map(String::as_str).collect();
    let run = start_run(device.machine, &kind.stable_name("LASHU1"), &settings);
    let mut made = 0;
    // A run that has ended sends nothing, so no unplug follows.
    while made < unplugs && device.is_unplugged_soon() {
        made += 1;
        device.replug_until("LASHU1", if made < unplugs { unplug(made) } else { Unplug::ByTest });
    }
    let (ended, summary) = finish_run(device.machine, run);
    device.machine.kill(load);
    let line = format!("{driver}: {} of {made} unplugs under load resumed", summary["link"]["resumes"]);
    println!("{line}");
    let reports = tests::workspace().join("target/reports");
    fs::create_dir_all(&reports).expect("the folder of the reports");
    fs::write(reports.join(format!("unplugs-{driver}.txt")), line + "\n").expect("a report");
    assert_eq!(
        (made, &summary["end"], &summary["link"]["resumes"]),
        (unplugs, &"complete".into(), &unplugs.into()),
        "{}\n{}",
        ended.stdout,
        ended.stderr
    );
}
