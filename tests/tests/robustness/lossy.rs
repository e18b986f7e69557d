//! A million steps on a line that damages a hundredth of all frames in both directions.
//!
//! Two taps, one on each side of the faulty line, have decoders of their own. Computed torques, received torques and damage
//! are thus counted independently of bench and drive.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::Device;
use lashloop_bench::device::kinds::in_process::InProcessDrive;
use lashloop_bench::fault::link::LinkFaults;
use lashloop_bench::run::{self, Clock, End, Outcome, Step, StepObserver};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::timing::StepOutcome;
use lashloop_link::{Link, LinkError};
use lashloop_protocol::enums::TorqueFlags;
use lashloop_protocol::message::LineReport;
use lashloop_protocol::sequence::{nearest_step, of_step};
use lashloop_protocol::{Decoder, DriveMessage, HostMessage};

/// Traffic at a tap since the drive was armed.
#[derive(Default)]
struct Traffic {
    to_drive: Decoder,
    to_bench: Decoder,
    /// Counts of `to_drive` at the start, the origin of the drive's counts, and of `to_bench` at the arming, the origin of the
    /// bench's counts.
    damaged_before: (u32, u32),
    messages_before: (u32, u32),
    /// Step of the last sample sent, counted through wraparounds of sequences.
    last_sent: Option<u32>,
    /// First answer to each sample; on the bench's side only if it arrived before the next sample was sent.
    torques_nm: Vec<Option<f32>>,
    report: Option<LineReport>,
}

impl Traffic {
    fn send(&mut self, mut bytes: &[u8]) {
        while let Some(item) = self.to_drive.next::<HostMessage>(&mut bytes) {
            match item.map(|it| it.message) {
                Ok(HostMessage::Arm(_)) => {
                    let counters = self.to_bench.counters();
                    (self.damaged_before.1, self.messages_before.1) = (counters.damaged(), counters.messages);
                }
                Ok(HostMessage::Start(_)) => {
                    let counters = self.to_drive.counters();
                    (self.damaged_before.0, self.messages_before.0) = (counters.damaged(), counters.messages);
                }
                Ok(HostMessage::EncoderSample(sample)) => {
                    let step = nearest_step(sample.sequence, self.last_sent.unwrap_or(0))
                        .expect("a step of the run");
                    self.last_sent = Some(step);
                    let end = step as usize + 1;
                    self.torques_nm.resize(self.torques_nm.len().max(end), None);
                }
                _ => {}
            }
        }
    }

    fn receive(&mut self, mut bytes: &[u8]) {
        while let Some(item) = self.to_bench.next::<DriveMessage>(&mut bytes) {
            match item.map(|it| it.message) {
                Ok(DriveMessage::TorqueAnswer(answer)) => {
                    let last_sent = self.last_sent.filter(|step| of_step(*step) == answer.sequence);
                    if let Some(step) = last_sent
                        && !answer.status.flags.contains(TorqueFlags::REPEATED)
                    {
                        self.torques_nm[step as usize].get_or_insert(answer.torque_nm);
                    }
                }
                Ok(DriveMessage::LineReport(report)) => self.report = Some(report),
                _ => {}
            }
        }
    }

    fn to_drive(&self) -> (u32, u32) {
        let counters = self.to_drive.counters();
        (counters.messages - self.messages_before.0, counters.damaged() - self.damaged_before.0)
    }

    fn to_bench(&self) -> (u32, u32) {
        let counters = self.to_bench.counters();
        (counters.messages - self.messages_before.1, counters.damaged() - self.damaged_before.1)
    }
}

struct Tap {
    link: Box<dyn Link>,
    traffic: Arc<Mutex<Traffic>>,
}

impl Link for Tap {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(self.link.as_mut())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.traffic.lock().expect("no tap has failed").send(bytes);
        self.link.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        let count = self.link.receive(buffer, deadline)?;
        self.traffic.lock().expect("no tap has failed").receive(&buffer[..count]);
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.link.discard_input()
    }
}

/// Every torque, and whether its step was answered.
#[derive(Default)]
struct Rows(Vec<(f32, bool)>);

impl StepObserver for Rows {
    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.0.push((step.row.torque_nm as f32, step.timing.outcome == StepOutcome::Answered));
        Ok(())
    }
}

struct Run {
    outcome: Outcome,
    rows: Vec<(f32, bool)>,
    at_drive: Traffic,
    at_bench: Traffic,
    took: Duration,
}

fn run_with(fault: &str, duration_s: f64, seed: u32) -> Run {
    let text =
        std::fs::read_to_string(tests::workspace().join("scenarios/smooth-after.toml")).expect("a scenario");
    let settings = [
        format!("run.duration_s={duration_s}"),
        format!("run.seed={seed}"),
        // Each lost frame costs its timeout in virtual time; consecutive ones must not add up to a lost drive.
        "link.silence_limit_ms=60000".to_owned(),
    ]
    .map(Override::Set);
    let text = format!("{text}\n[[fault]]\n{fault}\n");
    let scenario = Scenario::from_str("scenarios/lossy.toml", &text, &settings).expect("a good scenario");
    let supervisor = Supervisor::start(PathBuf::from("never started")).expect("a supervisor");
    let [at_drive, at_bench] = [(); 2].map(|()| Arc::new(Mutex::new(Traffic::default())));
    let faults = LinkFaults::new(&scenario).expect("faults of the link");
    let tap = |link, traffic: &Arc<Mutex<Traffic>>| {
        Box::new(Tap { link, traffic: Arc::clone(traffic) }) as Box<dyn Link>
    };
    let around = |link| tap(faults.wrap(tap(link, &at_drive), &scenario), &at_bench);
    let device = Device::open_through(&<InProcessDrive>::default().into(), 0, &supervisor, around);
    let device = device.expect("a drive in process");
    let mut device = run::DeviceUnderTest { device, link_faults: Some(faults.clone()) };
    let mut rows = Rows::default();
    let started = Instant::now();
    let outcome = run::run(&scenario, &mut device, Clock::Lockstep, &mut rows).expect("a run to its end");
    let took = started.elapsed();
    drop(device);
    let [at_drive, at_bench] = [at_drive, at_bench].map(|traffic| {
        Arc::into_inner(traffic).expect("the taps are dropped").into_inner().expect("no tap has failed")
    });
    Run { outcome, rows: rows.0, at_drive, at_bench, took }
}

/// Checks that every motor torque is the drive's torque for that sample, or held. Returns the number of held torques.
fn check_torques(run: &Run) -> u64 {
    // A drive takes no sample but 0 first, so samples are numbered from the first answered step.
    let origin = run.rows.iter().position(|(_, answered)| *answered).expect("an answer");
    let mut before_nm = 0.0_f32;
    let mut lost = 0;
    for (step, (torque_nm, answered)) in run.rows.iter().enumerate() {
        let sample = step.saturating_sub(origin);
        let arrived_nm = run.at_bench.torques_nm[sample].filter(|_| step >= origin);
        assert_eq!(arrived_nm.is_some(), *answered, "step {step}: whether an answer arrived");
        let want_nm = if let Some(arrived_nm) = arrived_nm {
            let computed_nm = run.at_drive.torques_nm[sample].expect("what arrived was computed");
            assert_eq!(arrived_nm.to_bits(), computed_nm.to_bits(), "step {step}: another torque arrived");
            arrived_nm
        } else {
            lost += 1;
            before_nm
        };
        assert_eq!(torque_nm.to_bits(), want_nm.to_bits(), "step {step}: {torque_nm} N m, not {want_nm}");
        before_nm = *torque_nm;
    }
    lost
}

#[test]
fn a_million_steps_with_damaged_frames_count_every_loss() {
    let run = run_with("kind = \"link-bit-flip\"\nshare = 0.01\nat_s = 0.0", 1e3, 1);
    let Run { outcome, at_drive, at_bench, .. } = &run;
    assert_eq!((outcome.steps, &outcome.end), (1_000_000, &End::Complete));
    let lost = check_torques(&run);
    let link = &outcome.link;
    assert_eq!(link.lost, lost, "steps without an answer");

    // The taps' counts are independent of both sides.
    let report = at_drive.report.expect("the drive's report");
    let (to_drive, to_bench) = (at_drive.to_drive(), at_bench.to_bench());
    assert_eq!((report.messages, report.damaged), to_drive, "what reached the drive");
    assert_eq!((report.refused, report.overruns), (0, 0));
    assert_eq!(link.damaged_at_drive, u64::from(to_drive.1));
    assert_eq!((link.frames_received, link.crc_errors), (to_bench.0.into(), to_bench.1.into()));
    assert_eq!((link.late, link.resumes, link.overruns_at_drive), (0, 0, 0));

    // Every hit is counted as damage on one side. A flip can join two frames or split one, so the counts of damage and of
    // hits are close but not equal.
    let hits = outcome.faults[0].frames.expect("frames hit");
    let damaged = link.crc_errors + link.damaged_at_drive;
    let ratio = damaged as f64 / hits as f64;
    assert!((0.9..1.2).contains(&ratio), "{damaged} damaged of {hits} hit");
    // The line carries 2.1 million frames: a sample and a torque per step, telemetry for each tenth step.
    assert!((20_000..22_000).contains(&hits), "{hits} hit");
    assert!((19_000..23_000).contains(&lost), "{lost} lost");
    println!(
        "{} steps in {:.1?}: {hits} frames hit, {damaged} damaged, {lost} lost",
        outcome.steps, run.took
    );
}

#[test]
fn a_run_with_damaged_last_frames_ends_with_both_counts() {
    let mut damaged = 0;
    // In some of the runs the last frame loses its delimiter, which damages the next frame as well.
    for seed in 1..=300 {
        let run = run_with("kind = \"link-byte-loss\"\nshare = 0.9\nat_s = 0.01", 0.02, seed);
        assert_eq!(run.outcome.end, End::Complete);
        // The report of the last stop, which the bench retries if the report is lost.
        let report = run.at_bench.report.expect("the drive's report");
        assert_eq!(run.outcome.link.damaged_at_drive, u64::from(report.damaged));
        assert_eq!(report.damaged, run.at_drive.to_drive().1);
        damaged += report.damaged;
    }
    assert!(damaged > 300, "{damaged} damaged");
}
