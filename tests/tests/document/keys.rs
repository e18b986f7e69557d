//! What a reader says about the keys of these files of settings: under a wrong name, absent, of another type, out of range.

use std::fmt::Write;
use std::fs;

use lashloop::rig::Rig;
use lashloop_bench::scenario::cases::Cases;
use lashloop_bench::scenario::{Scenario, plant};
use lashloop_campaign::file::CampaignFile;
use lashloop_campaign::suite::baseline::Baseline;

/// Every section without choices.
const SCENARIO: &str = r#"title = "a run"
description = "long"
[run]
mode = "hil"
duration_s = 2.0
control_period_us = 1000
seed = 1
warm_up_steps = 5
[plant]
model = "backlash-shaft"
substeps = 16
stiffness_nm_rad = 1.0
load_friction = "lugre"
bristle_stiffness_nm_rad = 1e4
load_coulomb_nm = 3.4
load_stiction_nm = 3.82
torque_delay_us = 0
[plant.initial]
load_position_rad = 1.5
load_velocity_rad_s = 0.0
motor_position_rad = 4.5
motor_velocity_rad_s = 0.0
[plant.load_torque]
torque_nm = 1.0
from_s = 0.5
until_s = 1.0
[plant.wear]
growth_rad = 0.1
from_s = 0.5
until_s = 1.0
[encoders]
motor_counts_per_rev = 4096
load_counts_per_rev = 4096
noise_counts = 1.0
motor_noise_counts = 0.5
load_noise_counts = 2.0
motor_eccentricity_rad = 0.01
load_eccentricity_rad = 0.001
[controller]
name = "pd"
[controller.parameters]
torque_limit_nm = 5.0
[bench]
torque_per_duty_nm = 5.0
duty_offset = 0.5
duty_min = 0.1
duty_max = 0.9
twist_limit_rad = 1.0
motor_direction = "forward"
load_direction = "reverse"
torque_direction = "forward"
start = "initial"
load_travel_limit_rad = 4.0
sample_every = 2
[reference]
profile = "constant"
position_rad = 0.0
[line]
delay_us = 10
jitter_us = 10
loss = 0.1
[link]
answer_timeout_ms = 1000
mean_wait_ms = 100
silence_limit_ms = 2500
baud = 921600
modelled_baud = 115200
on_loss = "end"
resume_limit_ms = 5000
[allow]
lost = 1
late = 1
crc_errors = 1
resumes = 1
late_in_a_row = 1
lateness_p99_us = 1
round_trip_p99_us = 1
[telemetry]
every_steps = 10
signals = ["load_error_rad"]
[scope]
signals = ["load_error_rad"]
every_steps = 1
before_rows = 64
trigger = "now"
trigger_signal = "load_error_rad"
level = 0.5
[record]
flush_rows = 1000
[[expect]]
metric = "overshoot_rad"
unit = "rad"
min = 0.0
max = 1.0
from_s = 0.5
to_s = 1.5
note = "a guess"
[[expect]]
signal = "drive.load_error_rad"
statistic = "rms"
unit = "rad"
max = 1.0
"#;

const PROFILES: [&str; 5] = [
    "\"step\"\nbefore_rad = 1.5\nafter_rad = 0.5\nat_s = 1.5",
    "\"sine\"\namplitude_rad = 0.5\nfrequency_hz = 0.05\noffset_rad = 1.5\nphase_rad = 0.0",
    "\"trapezoid\"\nfrom_rad = 1.5\nto_rad = 0.5\nstart_s = 0.1\nvelocity_rad_s = 2\nacceleration_rad_s2 = 3",
    "\"table\"\nfile = \"no/such.csv\"\ninterpolation = \"hold\"",
    "\"step\"\nbefore_rad = 1.5\nafter_rad = 0.5\nat_s = 1.5\namplitude_rad = 3",
];

const FAULTS: [&str; 22] = [
    "link-byte-loss\"\nshare = 0.01\nway = \"to-drive\"",
    "link-bit-flip\"\nshare = 0.01",
    "link-burst\"\nshare = 0.01\nbytes = 12",
    "link-duplicate\"\nshare = 0.01",
    "link-reorder\"\nshare = 0.01",
    "link-delay\"\ndelay_ms = 2.0\njitter_ms = 0.5",
    "link-stall\"",
    "link-cut\"\nfor_s = 0.25",
    "encoder-stuck\"\nside = \"load\"",
    "encoder-jump\"\nside = \"motor\"\ncounts = -500",
    "encoder-offset\"\nside = \"load\"\ncounts = 40\nover_s = 0.5",
    "encoder-lost-counts\"\nside = \"load\"\nshare = 0.1",
    "encoder-noise\"\nside = \"load\"\ncounts = 3",
    "torque-saturation\"\nlimit_nm = 2.5",
    "torque-gain\"\ngain = -1.0",
    "torque-delay\"\nsteps = 5",
    "gap-growth\"\ngrowth_rad = 0.05",
    "stiffness-drop\"\nfactor = 0.5",
    "load-torque\"\ntorque_nm = -6.0",
    "friction-change\"\nfactor = 2.0",
    "device-reset\"",
    "device-hang\"\nfor_s = 0.25",
];

const SWEEP: &str = r#"[sweep]
method = "grid"
sampling_seed = 1
seeds = 2
[[sweep.axis]]
key = "plant.dead_zone_rad"
values = [0.1, 0.2]
[[sweep.axis]]
key = "run.duration_s"
min = 1.0
max = 2.0
points = 2
scale = "linear"
"#;

const RIG: &str = r#"title = "t"
contact = "c"
board = "b"
[port]
device = "/dev/serial/by-id/x"
baud = 115200
[encoders]
motor_counts_per_rev = 4096
load_counts_per_rev = 4096
motor_direction = "normal"
load_direction = "reversed"
filter_ns = 119
[power_stage]
torque_per_duty_nm = 5.0
duty_offset = 0.5
duty_min = 0.1
duty_max = 0.9
mode = "amplifier"
frequency_hz = 5000
[limits]
torque_nm = 5.0
motor_speed_rad_s = 300.0
load_speed_rad_s = 100.0
load_travel_rad = 4.0
watchdog_us = 2000
twist_rad = 5.0
[loader]
via = "dfu"
chip = "c"
probe = "p"
port = "/dev/ttyS0"
"#;

const CAMPAIGN: &str = r#"title = "t"
scenario = "a.toml"
seed = 1
set = ["meant=mismatch"]
[[variant]]
name = "pd"
scenario = "b.toml"
set = ["run.seed=2"]
omit = ["controller.parameters.k_21"]
[[part]]
name = "grid"
method = "grid"
set = ["run.seed=3"]
[[part.axis]]
key = "plant.dead_zone_rad"
label = "gap"
unit = "rad"
values = [0.1, 0.2]
times = "plant.dead_zone_rad"
[[part.axis]]
keys = ["run.duration_s"]
min = 1.0
max = 2.0
points = 2
scale = "linear"
[[part]]
name = "random"
method = "random"
points = 1000
[[part.axis]]
key = "plant.dead_zone_rad"
min = 0.1
max = 0.2
[[derive]]
name = "relative"
metric = "overshoot_rad"
per = 2.0
or_count_of = "encoders.load_counts_per_rev"
over = "minimum-settle-time"
only_if = "settle_time_s"
at_most = 5.0
[[expect]]
part = "random"
variant = "pd"
metric = "relative"
quantile = 0.5
max = 1.0
confidence = 0.95
judge = "interval"
[[expect]]
pass = 0.5
[evidence]
worst = 2
of = "relative"
failures = 3
"#;

const BASELINE: &str = r#"[[case]]
settings = ["run.seed=1"]
[case.metrics]
settle_time_s = { value = 5.0, tolerance = 0.5 }
"#;

/// The line in other words: each is an error, or the key may be absent.
fn changes(line: &str) -> Vec<String> {
    if let Some(section) = line.strip_prefix("[[") {
        return vec![format!("[{}", section.replacen(']', "", 1))];
    }
    if line.starts_with('[') {
        return vec![format!("[{line}]")];
    }
    let (key, value) = line.split_once(" = ").expect("a key and its value");
    let mut changes = vec![String::new(), format!("{key}_x = {value}"), format!("{key} = 2024-05-01")];
    if value.starts_with('"') {
        changes.push(format!("{key} = \"zzz\""));
    } else if !value.starts_with(['[', '{']) {
        changes.extend([format!("{key} = -1e300"), format!("{key} = 1e300")]);
    }
    changes
}

/// A table of each change of the lines from `from` on, and what the reader says about it.
fn table(document: &str, from: usize, read: impl Fn(&str) -> Result<(), String>) -> String {
    let mut table = String::new();
    if let Err(errors) = read(document) {
        writeln!(table, "as it is\n{errors}").expect("a String takes everything");
    }
    let lines: Vec<_> = document.lines().collect();
    for at in from..lines.len() {
        for change in changes(lines[at]) {
            let mut changed: Vec<&str> = lines.clone();
            changed[at] = &change;
            let errors = read(&changed.join("\n")).err().unwrap_or_else(|| "read".to_owned());
            let shown = if change.is_empty() { format!("without {}", lines[at]) } else { change };
            writeln!(table, "| {shown}\n{errors}").expect("a String takes everything");
        }
    }
    table
}

fn read_scenario(text: &str) -> Result<(), String> {
    Scenario::from_str("x.toml", text, &[]).map(drop).map_err(|errors| errors.to_string())
}

#[test]
fn errors_of_every_key_of_a_scenario() {
    insta::assert_snapshot!(table(SCENARIO, 0, read_scenario));
}

/// A short scenario without profile, and lines after it.
fn short(profile: &str, rest: &str) -> String {
    let head = "title = \"a run\"\n[run]\nduration_s = 2.0\n[plant]\nmodel = \"backlash-shaft\"\n[controller]\nname = \"pd\"\n";
    format!("{head}[reference]\nprofile = {profile}\n{rest}")
}

#[test]
fn errors_of_every_key_of_a_reference() {
    let tables = PROFILES.map(|profile| table(&short(profile, ""), 8, read_scenario));
    insta::assert_snapshot!(tables.join("\n"));
}

#[test]
fn errors_of_every_key_of_a_fault() {
    let tables = FAULTS.map(|fault| {
        let rest = format!("[[fault]]\nat_s = 0.5\nkind = \"{fault}\n");
        table(&short("\"constant\"\nposition_rad = 1.5", &rest), 10, read_scenario)
    });
    insta::assert_snapshot!(tables.join("\n"));
}

#[test]
fn errors_of_every_key_of_a_sweep() {
    let read = |text: &str| {
        Cases::from_str("x.toml", text, &[], &plant::standard())
            .map(drop)
            .map_err(|errors| errors.to_string())
    };
    insta::assert_snapshot!(table(&short("\"constant\"\nposition_rad = 1.5", SWEEP), 10, read));
}

#[test]
fn errors_of_every_key_of_a_rig() {
    let read = |text: &str| Rig::from_str("rig.toml", text).map(drop).map_err(|errors| errors.to_string());
    insta::assert_snapshot!(table(RIG, 0, read));
}

#[test]
fn errors_of_every_key_of_a_campaign() {
    let read =
        |text: &str| CampaignFile::from_str("c.toml", text).map(drop).map_err(|errors| errors.to_string());
    insta::assert_snapshot!(table(CAMPAIGN, 0, read));
}

#[test]
fn errors_of_every_key_of_a_baseline() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.baseline.toml");
    let read = |text: &str| {
        fs::write(&path, text).expect("a file");
        let place = |error: lashloop_campaign::suite::baseline::BaselineError| format!("{:?}", error.place());
        Baseline::read(&path)
            .map(drop)
            .map_err(|error| place(error).replace(&*path.to_string_lossy(), "a.toml"))
    };
    insta::assert_snapshot!(table(BASELINE, 0, read));
}
