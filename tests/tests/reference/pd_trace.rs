//! The golden trace of the profile `pd`: samples of two closed loops with a moving reference, and the torques of the
//! drive's law in single precision.
//!
//! The counts come from a plant and encoders of the bench. The drive gets its parameters from
//! `protocol/golden/pd-parameters.csv`.

use std::f64::consts::PI;
use std::fmt::Write;
use std::path::PathBuf;
use std::time::Duration;

use lashloop_bench::run::simulator::Simulator;
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_firmware::Laws;
use lashloop_link::in_process::InProcess;
use lashloop_plant::reference::Reference;
use lashloop_protocol::message::{EncoderSample, TorqueAnswer};
use lashloop_session::{Exchange, Session};

/// Samples of a run, those that are left out included.
const STEPS: u32 = 240;

/// A run of the trace.
pub struct Loop {
    /// Name of its column in the table of parameters.
    pub name: &'static str,
    reference: fn(f64) -> f64,
    /// Where load and motor begin, in rad.
    start_rad: (f64, f64),
    /// Steps without a sample.
    left_out: std::ops::Range<u32>,
}

/// The runs of the trace.
pub const LOOPS: [Loop; 2] = [
    // A sine, a jump that isn't a motion, and one that is.
    Loop {
        name: "coarse",
        reference: |time_s| {
            let jumps_rad = 0.15 * f64::from(time_s >= 0.2) - 0.01 * f64::from(time_s >= 0.3);
            sine(-0.5, 0.3, 1.5, time_s) + jumps_rad
        },
        start_rad: (-0.55, -1.8),
        left_out: 170..174,
    },
    // Load and motor wrap around at a load of pi, upwards and downwards.
    Loop {
        name: "fine",
        reference: |time_s| sine(PI, 0.08, 6.0, time_s),
        start_rad: (PI - 0.03, 4.0 * PI - 0.1),
        left_out: 60..62,
    },
];

fn sine(offset_rad: f64, amplitude_rad: f64, frequency_hz: f64, time_s: f64) -> f64 {
    Reference::Sine { amplitude_rad, frequency_hz, offset_rad, phase_rad: 0.0 }.position_rad(time_s)
}

/// A sample of the trace with its answer.
pub type Row = (EncoderSample, TorqueAnswer);

/// File of the trace.
pub fn path() -> PathBuf {
    tests::workspace().join("protocol/golden/pd.csv")
}

/// Names and values of the parameters of a run.
pub fn parameters(run: &str) -> Vec<(String, f64)> {
    let path = tests::workspace().join("protocol/golden/pd-parameters.csv");
    let mut table = csv::Reader::from_path(path).expect("a table of parameters");
    let column = table.headers().expect("a header").iter().position(|name| name == run).expect("a run");
    let rows = table.records().map(|row| row.expect("a row"));
    rows.map(|row| (row[0].to_owned(), row[column].parse().expect("a number"))).collect()
}

/// The whole trace as the text of its file.
pub fn text() -> String {
    let mut text = "run,sequence,motor_counts,load_counts,reference_rad,torque_nm,flags\n".to_owned();
    for run in &LOOPS {
        for (sample, answer) in rows(run) {
            let EncoderSample { sequence, motor_counts, load_counts, reference_rad } = sample;
            let flags: Vec<_> = answer.status.flags.iter_names().map(|(name, _)| name).collect();
            writeln!(
                text,
                "{},{sequence},{},{},{reference_rad},{},{}",
                run.name,
                motor_counts.get(),
                load_counts.get(),
                answer.torque_nm,
                flags.join(" ")
            )
            .expect("a text grows");
        }
    }
    text
}

/// Closes the loop of a run.
pub fn rows(run: &Loop) -> Vec<Row> {
    let parameters = parameters(run.name);
    let mut simulator = simulator(run, &parameters);
    let mut drive = started(&parameters);
    let mut rows = Vec::new();
    let mut torque_nm = 0.0;
    for step in 0..STEPS {
        let (mut sample, observed) = simulator.observe(step).expect("a plant that can be observed");
        sample.reference_rad = (run.reference)(observed.row.time_s) as f32;
        if !run.left_out.contains(&step) {
            let answer = answered(&mut drive, step, &sample);
            torque_nm = answer.torque_nm;
            rows.push((sample, answer));
        }
        simulator.step(step, torque_nm).expect("a plant that can be integrated");
    }
    rows
}

/// A running drive with the law `pd` and these parameters.
pub fn started(parameters: &[(String, f64)]) -> Session {
    let mut drive = Session::open(Box::new(InProcess::<Laws>::default()), 1).expect("a drive");
    drive.set("controller", "pd").expect("the law pd");
    for (name, value) in parameters {
        drive.set(name, *value).expect("a parameter of the law");
    }
    drive.start().expect("a drive that starts");
    drive
}

/// The answer to a sample.
pub fn answered(drive: &mut Session, step: u32, sample: &EncoderSample) -> TorqueAnswer {
    let deadline = drive.line.now() + Duration::from_secs(1);
    match drive.exchange(step, sample, deadline).expect("a line that works") {
        Exchange::Answered(answer) => answer,
        other => panic!("step {step}: {other:?}"),
    }
}

fn simulator(run: &Loop, parameters: &[(String, f64)]) -> Simulator {
    let value = |name: &str| parameters.iter().find(|(it, _)| it == name).expect("a parameter").1;
    let mut settings: Vec<_> = [
        ("run.control_period_us", value("period_us")),
        ("encoders.motor_counts_per_rev", value("motor_counts_per_rev")),
        ("encoders.load_counts_per_rev", value("load_counts_per_rev")),
        ("plant.initial.load_position_rad", run.start_rad.0),
        ("plant.initial.motor_position_rad", run.start_rad.1),
    ]
    .map(|(key, value)| Override::Set(format!("{key}={value}")))
    .into();
    for key in ["reduction_ratio", "stiffness_nm_rad", "load_inertia_kg_m2", "load_friction_nm_s_rad"] {
        settings.push(Override::Set(format!("plant.{key}={}", value(key))));
    }
    let text = "title = \"golden\"\n[run]\nduration_s = 1.0\ncontrol_period_us = 1000\n[plant]\nmodel = \"smooth\"\nmotor_inertia_kg_m2 = 0.005\n\
                motor_friction_nm_s_rad = 0.01\ndead_zone_rad = 0.05\n[controller]\nname = \"pd\"\n\
                [reference]\nprofile = \"constant\"\nposition_rad = 0.0\n";
    let scenario = Scenario::from_str("golden.toml", text, &settings).expect("a good scenario");
    Simulator::new(&scenario).expect("a plant")
}
