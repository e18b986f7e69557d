//! The bytes of a record, of runs whose timing scatters as in real time.

use std::fs;
use std::path::Path;
use std::time::Duration;

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::run::{Event, RunStart, Step, StepObserver};
use lashloop_bench::timing::{RoundTrip, StepTiming};
use lashloop_record::folder::RecordFolder;
use lashloop_record::source::RunSource;
use lashloop_record::writer::RecordWriter;

use super::{run_in_process, scenario};

/// A record of steps with a timing like that of a terminal on a busy machine, in ns without a pattern.
struct Scattered {
    writer: RecordWriter,
    random: u64,
}

impl Scattered {
    fn between(&mut self, least_ns: u64, most_ns: u64) -> Duration {
        self.random =
            self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        Duration::from_nanos(least_ns + (self.random >> 33) % (most_ns - least_ns))
    }
}

impl StepObserver for Scattered {
    fn begin(&mut self, start: &RunStart<'_>) -> Result<(), WriteError> {
        self.writer.begin(start)
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        let round_trip = Some(RoundTrip {
            send: self.between(2_000, 20_000),
            line_and_device: self.between(20_000, 120_000),
            compute: 100 * self.between(1, 10),
            receive: self.between(200, 3_000),
        });
        let timing = StepTiming { lateness: self.between(20_000, 120_000), round_trip, ..step.timing };
        self.writer.step(&Step { timing, ..step.clone() })
    }

    fn event(&mut self, step: u32, event: &Event) -> Result<(), WriteError> {
        self.writer.event(step, event)
    }
}

/// Bytes of the record of a scenario of this duration.
fn bytes(name: &str, duration_s: u32) -> u64 {
    let parent = tempfile::tempdir().expect("a folder");
    let path = parent.path().join("run");
    let writer =
        RecordWriter::new(RecordFolder::claim(&path, false).expect("a folder"), RunSource::default());
    let scenario = scenario(name, &[&format!("run.duration_s={duration_s}"), "expect=[]"]);
    let mut record = Scattered { writer, random: 1 };
    run_in_process(&scenario, vec![&mut record]).expect("a run");
    drop(record);
    let size = |path: &Path| fs::metadata(path).expect("a file").len();
    fs::read_dir(path).expect("a folder").map(|file| size(&file.expect("a file").path())).sum()
}

#[test]
fn record_of_25_s_at_1_khz_takes_less_than_4_5_mb() {
    for name in ["smooth-after.toml", "friction-after.toml", "shaft-merzouki.toml"] {
        let bytes = bytes(name, 25);
        assert!((2_500_000..4_500_000).contains(&bytes), "{name}: {bytes} bytes");
    }
}

#[test]
fn record_of_10_minutes_at_1_khz_takes_less_than_110_mb() {
    // A sixth of it: the bytes of a step don't grow.
    let bytes = 6 * bytes("smooth-after.toml", 100);
    assert!(bytes < 110_000_000, "{bytes} bytes");
}
