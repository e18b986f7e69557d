//! The traffic of a run with a drive that passes every check.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use lashloop_conformance::{CheckResult, CheckStatus, Reporter, run};
use lashloop_link::in_process::InProcess;
use lashloop_link::{Link, LinkError, TimeBase};
use lashloop_protocol::frame::DELIMITER;

use crate::laws::TestLaws;

/// Most messages of a run, in both directions.
const MOST_MESSAGES: u64 = 29_100;
/// Most time of a run on a line of 115,200 Bd, in s: that of every run.
const MOST_TIME_S: f64 = 46.0;
/// Bytes per second of a line of 115,200 Bd, with a start and a stop bit.
const BYTES_PER_S: f64 = 11_520.0;

#[derive(Default)]
struct Traffic {
    bytes: AtomicU64,
    messages: AtomicU64,
}

impl Traffic {
    /// Empty frames and damaged ones count as messages too.
    fn add(&self, bytes: &[u8]) {
        self.bytes.fetch_add(bytes.len() as u64, Ordering::Relaxed);
        let delimiters = bytes.iter().filter(|byte| **byte == DELIMITER).count();
        self.messages.fetch_add(delimiters as u64, Ordering::Relaxed);
    }

    fn so_far(&self) -> (u64, u64) {
        (self.messages.load(Ordering::Relaxed), self.bytes.load(Ordering::Relaxed))
    }
}

/// A UART that counts what passes it. The drive starts to answer a write when the line has carried the first frame of it.
struct Uart {
    drive: InProcess<TestLaws>,
    traffic: Arc<Traffic>,
    /// When the line has carried the last write.
    sent_at: Option<Instant>,
}

fn time_of(bytes: &[u8]) -> Duration {
    Duration::from_secs_f64(bytes.len() as f64 / BYTES_PER_S)
}

impl Link for Uart {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(&mut self.drive)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.traffic.add(bytes);
        let starts_at = self.drive.now().max(self.sent_at.unwrap_or_else(|| self.drive.now()));
        self.sent_at = Some(starts_at + time_of(bytes));
        let first = bytes.split_inclusive(|byte| *byte == DELIMITER).next().unwrap_or_default();
        self.drive.wait_until(starts_at + time_of(first))?;
        self.drive.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        let count = self.drive.receive(buffer, deadline)?;
        self.traffic.add(&buffer[..count]);
        if count > 0 {
            let received_at = self.drive.now() + time_of(&buffer[..count]);
            self.drive.wait_until(self.sent_at.map_or(received_at, |sent_at| sent_at.max(received_at)))?;
        }
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.drive.discard_input()
    }

    fn set_time_base(&mut self, time_base: TimeBase) {
        self.drive.set_time_base(time_base);
    }
}

/// The traffic of each check.
struct PerCheck {
    traffic: Arc<Traffic>,
    before: (u64, u64),
    checks: Vec<(Duration, u64, u64, String)>,
    took: Duration,
    broken: Vec<CheckResult>,
}

impl Reporter for PerCheck {
    fn checked(&mut self, result: &CheckResult) {
        let (messages, bytes) = self.traffic.so_far();
        let (messages_before, bytes_before) = self.before;
        self.checks.push((
            result.took,
            messages - messages_before,
            bytes - bytes_before,
            result.name.clone(),
        ));
        self.before = (messages, bytes);
        self.took += result.took;
        if matches!(result.status, CheckStatus::Failed { .. } | CheckStatus::NotJudged { .. }) {
            self.broken.push(result.clone());
        }
    }
}

#[test]
fn a_run_fits_a_line_of_115_200_baud() {
    let traffic = Arc::new(Traffic::default());
    let mut per_check = PerCheck {
        traffic: traffic.clone(),
        before: (0, 0),
        checks: Vec::new(),
        took: Duration::ZERO,
        broken: Vec::new(),
    };
    let link = Uart { drive: InProcess::default(), traffic: traffic.clone(), sent_at: None };
    run(Box::new(link), 7, &mut per_check).expect("a drive that answers");
    let (messages, bytes) = traffic.so_far();
    let time_s = per_check.took.as_secs_f64();
    let mut checks = per_check.checks;
    checks.sort_unstable_by(|one, other| other.cmp(one));
    checks.iter().take(50).for_each(|(took, messages, bytes, name)| {
        println!("{:5} ms {messages:5} {bytes:6} {name}", took.as_millis());
    });
    println!("\ntotal {messages} messages, {bytes} bytes, {time_s:.1} s at 115,200 Bd");
    assert!(per_check.broken.is_empty(), "{:#?}", per_check.broken);
    assert!(messages <= MOST_MESSAGES, "{messages} messages");
    assert!(time_s <= MOST_TIME_S, "{time_s:.1} s");
}
