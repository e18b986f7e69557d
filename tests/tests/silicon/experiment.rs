//! `lashloop paper experiment` on a drive without a plant: a person brings the load to its start.

use std::fs;
use std::io::{Read, Write};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use tests::program::{self, lashloop};
use tests::records::Records;
use tests::terminal::{self, Terminal};
use tests::wait;

use crate::equipment;

/// Time for the drive to start.
const PATIENCE: Duration = Duration::from_secs(60);
const PROMPT: &str = "bring the load to 1.5708 rad, power the drive off and on, and press Enter: ";

/// A drive at a terminal, with its encoders open.
struct Drive {
    silicon: Child,
    terminal: Terminal,
}

impl Drive {
    fn start() -> Self {
        let terminal = terminal::open();
        let end = || terminal.far_end.try_clone().expect("a second end");
        let mut command = Command::new(equipment::program());
        command.arg(equipment::image()).stdin(Stdio::from(end())).stdout(Stdio::from(end()));
        let drive = Self { silicon: command.spawn().expect("lashloop-silicon starts"), terminal };
        drive.await_answer();
        drive
    }

    /// On a busy machine its program takes longer to load than a bench waits for a drive.
    fn await_answer(&self) {
        let device = terminal::device(&self.terminal);
        let ask = || program::run(["parameters", "hash", "--device", &device]);
        wait::look(PATIENCE, || (ask().code == Some(0)).then_some(())).expect("the drive answers");
    }

    fn power_off(&mut self) {
        let _ = self.silicon.kill();
        let _ = self.silicon.wait();
    }
}

impl Drop for Drive {
    fn drop(&mut self) {
        self.power_off();
    }
}

/// Writes a rig file for a drive, and returns its path.
fn rig_file(drive: &Drive, records: &Records) -> String {
    let path = records.path("rig.toml");
    fs::create_dir_all(path.parent().expect("a folder")).expect("the folder of the rig file");
    let device = terminal::device(&drive.terminal);
    let text = format!(
        "title = \"Bench 2\"\ncontact = \"A. Engineer\"\nboard = \"stm32f405\"\n[port]\ndevice = \"{device}\"\n\
         [encoders]\nmotor_counts_per_rev = 131072\nload_counts_per_rev = 131072\n\
         [power_stage]\ntorque_per_duty_nm = 62.5\n[limits]\ntorque_nm = 25.0\nload_travel_rad = 7.0\n"
    );
    fs::write(&path, text).expect("a rig file");
    path.display().to_string()
}

pub(crate) fn waits_for_the_start() {
    let (mut drive, records) = (Drive::start(), Records::new());
    let (rig, out) = (rig_file(&drive, &records), records.path("experiment").display().to_string());
    let arguments = ["paper", "experiment", "--rig", &rig, "--out", &out, "--force"];

    // Without a person at the terminal no run is made.
    let ended = program::run(arguments).with_code(2);
    assert!(ended.stdout.ends_with(PROMPT), "{}\n{}", ended.stdout, ended.stderr);

    // After Enter the drive has to answer again, because it was powered off and on. This one stays off.
    let mut experiment = Command::new(lashloop())
        .args(arguments)
        .current_dir(tests::workspace())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("lashloop starts");
    let mut shown = Vec::new();
    let stdout = experiment.stdout.as_mut().expect("a pipe");
    while !shown.ends_with(PROMPT.as_bytes()) {
        let mut byte = [0];
        let read = stdout.read(&mut byte).expect("a pipe");
        assert!(read > 0, "no prompt, but {}", String::from_utf8_lossy(&shown));
        shown.push(byte[0]);
    }
    drive.power_off();
    experiment.stdin.take().expect("a pipe").write_all(b"\n").expect("a pipe");
    let ended = experiment.wait_with_output().expect("it can be waited for");
    let stderr = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(4), "{stderr}");
    assert!(stderr.contains("no drive") || stderr.contains("silent"), "{stderr}");
}

/// Before compensation the friction leaves a third of a rad; after it, one count of these encoders at most. Both are as simulated, through
/// PWM, current loop, winding, gears and encoders.
pub(crate) fn at_a_bridge() {
    const COUNTS_PER_REV: u32 = 4000;
    let records = Records::new();
    let mut arguments = ["paper", "experiment", "--bridge", "--after", "controller.name=braking-curve"]
        .map(str::to_owned)
        .to_vec();
    // The law winds the shaft by up to 0.95 of the torque limit of 25 N m.
    arguments.extend(["--after", "bench.twist_limit_rad=26"].map(str::to_owned));
    for setting in [
        format!("encoders.motor_counts_per_rev={COUNTS_PER_REV}"),
        format!("encoders.load_counts_per_rev={COUNTS_PER_REV}"),
        "run.duration_s=12".to_owned(),
        "expect=[]".to_owned(),
    ] {
        arguments.extend(["--set".to_owned(), setting]);
    }
    arguments.extend(["--out".to_owned(), records.out()]);
    let ended =
        program::run(arguments.into_iter().chain(tests::paper::PATIENCE.map(str::to_owned))).with_code(0);
    assert_eq!(ended.stdout.matches("simulation PASS, experiment PASS").count(), 4, "{}", ended.stdout);
    let count_rad = std::f64::consts::TAU / f64::from(COUNTS_PER_REV);
    for (when, least_rad, most_rad) in [("before", 0.3, 0.34), ("after", 0.0, count_rad)] {
        let error_rad = |of: &str| {
            let summary = records.within(&format!("bench-friction-{when}-{of}")).summary();
            summary["metrics"]["static_error_rad"].as_f64().expect("a metric")
        };
        let (simulation_rad, experiment_rad) = (error_rad("simulation"), error_rad("experiment"));
        println!("{when}: simulation {simulation_rad} rad, experiment {experiment_rad} rad");
        for rad in [simulation_rad, experiment_rad] {
            assert!((least_rad..=1.001 * most_rad).contains(&rad.abs()), "{when}: {rad} rad");
        }
        assert!((simulation_rad - experiment_rad).abs() <= count_rad, "{when}");
    }
}
