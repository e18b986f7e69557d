//! A million steps on a line that damages a hundredth of all frames, either way.
//!
//! Two taps listen, one on each side of the faulty line, with decoders of their own. So what the drive computed, what of it
//! arrived, and what was damaged on the way is known apart from the counts of bench and drive.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::{Device, DeviceChoice};
use lashloop_bench::fault::link::LinkFaults;
use lashloop_bench::link::{Link, LinkError};
use lashloop_bench::run::{self, Clock, End, Outcome, Step, Watcher};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::timing::StepOutcome;
use lashloop_protocol::enums::TorqueFlags;
use lashloop_protocol::message::LineReport;
use lashloop_protocol::sequence::{nearest_step, of_step};
use lashloop_protocol::{Decoder, DriveMessage, HostMessage};

/// What a tap has heard since the drive was armed.
#[derive(Default)]
struct Heard {
    to_drive: Decoder,
    to_bench: Decoder,
    /// Counts of `to_drive` when the drive was started, as it counts itself, and of `to_bench` when it was armed, as the
    /// bench does.
    damaged_before: (u32, u32),
    messages_before: (u32, u32),
    /// The sample sent last, counted on where sequences wrap.
    asked: Option<u32>,
    /// The first answer to each sample; on the bench's side only if it came before the next sample was sent.
    torques_nm: Vec<Option<f32>>,
    report: Option<LineReport>,
}

impl Heard {
    fn send(&mut self, mut bytes: &[u8]) {
        while let Some(message) = self.to_drive.next::<HostMessage>(&mut bytes) {
            match message {
                Ok(HostMessage::Arm(_)) => {
                    let counters = self.to_bench.counters();
                    (self.damaged_before.1, self.messages_before.1) = (counters.damaged(), counters.messages);
                }
                Ok(HostMessage::Start(_)) => {
                    let counters = self.to_drive.counters();
                    (self.damaged_before.0, self.messages_before.0) = (counters.damaged(), counters.messages);
                }
                Ok(HostMessage::EncoderSample(sample)) => {
                    let step =
                        nearest_step(sample.sequence, self.asked.unwrap_or(0)).expect("a step of the run");
                    self.asked = Some(step);
                    let end = step as usize + 1;
                    self.torques_nm.resize(self.torques_nm.len().max(end), None);
                }
                _ => {}
            }
        }
    }

    fn receive(&mut self, mut bytes: &[u8]) {
        while let Some(message) = self.to_bench.next::<DriveMessage>(&mut bytes) {
            match message {
                Ok(DriveMessage::TorqueAnswer(answer)) => {
                    let asked = self.asked.filter(|step| of_step(*step) == answer.sequence);
                    if let Some(step) = asked
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
    heard: Arc<Mutex<Heard>>,
}

impl Link for Tap {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.heard.lock().expect("no tap has failed").send(bytes);
        self.link.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        let count = self.link.receive(buffer, deadline)?;
        self.heard.lock().expect("no tap has failed").receive(&buffer[..count]);
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.link.discard_input()
    }
}

/// Every torque, and whether its step was answered.
#[derive(Default)]
struct Rows(Vec<(f32, bool)>);

impl Watcher for Rows {
    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.0.push((step.row.torque_nm as f32, step.timing.outcome == StepOutcome::Answered));
        Ok(())
    }
}

struct Run {
    outcome: Outcome,
    rows: Vec<(f32, bool)>,
    at_drive: Heard,
    at_bench: Heard,
    took: Duration,
}

fn run_with(fault: &str, duration_s: f64, seed: u32) -> Run {
    let text =
        std::fs::read_to_string(tests::workspace().join("scenarios/smooth-after.toml")).expect("a scenario");
    let settings = [format!("run.duration_s={duration_s}"), format!("run.seed={seed}")].map(Override::Set);
    let text = format!("{text}\n[[fault]]\n{fault}\n");
    let scenario = Scenario::from_str("scenarios/lossy.toml", &text, &settings).expect("a good scenario");
    let supervisor = Supervisor::start(PathBuf::from("never started")).expect("a supervisor");
    let [at_drive, at_bench] = [(); 2].map(|()| Arc::new(Mutex::new(Heard::default())));
    let faults = LinkFaults::new(&scenario).expect("faults of the link");
    let tap =
        |link, heard: &Arc<Mutex<Heard>>| Box::new(Tap { link, heard: Arc::clone(heard) }) as Box<dyn Link>;
    let around = |link| tap(faults.wrap(tap(link, &at_drive), &scenario), &at_bench);
    let device = Device::open_through(&DeviceChoice::InProcess, 0, &supervisor, around);
    let mut device = device.expect("a drive in process").with_link_faults(Some(faults.clone()));
    let mut rows = Rows::default();
    let started = Instant::now();
    let outcome = run::run(&scenario, &mut device, Clock::Lockstep, &mut rows).expect("a run to its end");
    let took = started.elapsed();
    drop(device);
    let [at_drive, at_bench] = [at_drive, at_bench].map(|heard| {
        Arc::into_inner(heard).expect("the taps are gone").into_inner().expect("no tap has failed")
    });
    Run { outcome, rows: rows.0, at_drive, at_bench, took }
}

/// Every torque on the motor is the drive's own for that sample, or the one before.
fn check_torques(run: &Run) -> u64 {
    // A drive takes no other sample than 0 first, so samples are numbered from the first step that was answered.
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

    // The same counts by decoders that belong to neither side.
    let report = at_drive.report.expect("the drive's report");
    let (to_drive, to_bench) = (at_drive.to_drive(), at_bench.to_bench());
    assert_eq!((report.messages, report.damaged), to_drive, "what reached the drive");
    assert_eq!((report.refused, report.overruns), (0, 0));
    assert_eq!(link.damaged_at_drive, u64::from(to_drive.1));
    assert_eq!((link.frames_received, link.crc_errors), (to_bench.0.into(), to_bench.1.into()));
    assert_eq!((link.late, link.resumes, link.overruns_at_drive), (0, 0, 0));

    // Every frame that was hit is damage on one of the sides. A flip can join two frames or part one, so the counts of
    // damage and of hits are near each other and need not be equal.
    let hits = outcome.faults[0].frames.expect("frames hit");
    let damaged = link.crc_errors + link.damaged_at_drive;
    let ratio = damaged as f64 / hits as f64;
    assert!((0.9..1.2).contains(&ratio), "{damaged} damaged of {hits} hit");
    // 2.1 million frames go over the line: a sample and a torque for each step, telemetry for each tenth.
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
    // Among so many some lose the end of their last frame, either way, which then takes the next one with it.
    for seed in 1..=300 {
        let run = run_with("kind = \"link-byte-loss\"\nshare = 0.9\nat_s = 0.01", 0.02, seed);
        assert_eq!(run.outcome.end, End::Complete);
        // That of the last stop, which is repeated where its report was lost.
        let report = run.at_bench.report.expect("the drive's report");
        assert_eq!(run.outcome.link.damaged_at_drive, u64::from(report.damaged));
        assert_eq!(report.damaged, run.at_drive.to_drive().1);
        damaged += report.damaged;
    }
    assert!(damaged > 300, "{damaged} damaged");
}
