//! A record that was cut short at any byte reads up to there.

use std::fs;
use std::time::Duration;

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::run::{DriveValues, Event, RunStart, Step, StepObserver, TraceRow};
use lashloop_bench::timing::{StepOutcome, StepTiming};
use lashloop_plant::Signal;
use lashloop_plant::metrics::SignalTable;
use lashloop_record::columns::Columns;
use lashloop_record::export::{Format, Selection, export};
use lashloop_record::folder::RecordFolder;
use lashloop_record::reader::Record;
use lashloop_record::samples::{RecordedEdge, RecordedText, SampleWriter, Samples, StepTimes};
use lashloop_record::source::RunSource;
use lashloop_record::writer::RecordWriter;
use lashloop_session::LogEntry;
use mcap::sans_io::indexed_reader::ReadOrder;

use super::container::by_index;
use super::{bits, run_in_process, scenario};

/// A fault from step 30 to 70, and a text of the drive in step 50; then the run is killed in its fourth chunk.
#[test]
fn a_killed_run_has_faults_and_texts_up_to_its_last_chunk() {
    let parent = tempfile::tempdir().expect("a folder");
    let path = parent.path().join("run");
    let folder = RecordFolder::claim(&path, false).expect("a folder");
    let settings = [
        "run.duration_s=0.2",
        "record.flush_rows=20",
        "expect=[]",
        "fault=[{ kind=\"torque-gain\", gain=0.9, at_s=0.03, for_s=0.04 }, { kind=\"torque-gain\", gain=0.9, at_s=0.15 }]",
    ];
    let scenario = scenario("smooth-after.toml", &settings);
    let mut writer = RecordWriter::new(folder, RunSource::default());
    run_in_process(&scenario, vec![&mut Talking { writer: &mut writer, step: 0 }]).expect("a run");
    let edge = |number, step, begins| RecordedEdge { step, kind: "torque-gain".to_owned(), number, begins };
    let text = RecordedText { step: 50, text: "supply is low".to_owned() };
    let whole = fs::read(path.join("run.mcap")).expect("samples");
    let (mut found, mut texts) = (Vec::new(), Vec::new());
    for length in (0..whole.len()).step_by(97) {
        fs::write(path.join("run.mcap"), &whole[..length]).expect("a part");
        let Ok(record) = Record::read(&path) else { continue };
        // An event precedes its step, so it is in the chunk of its step.
        let has = |step| record.trace.len() > step;
        let edges = [edge(0, 30, true), edge(0, 70, false), edge(1, 150, true)];
        let expected: Vec<_> = edges.into_iter().filter(|edge| has(edge.step as usize)).collect();
        assert_eq!(record.faults, expected, "{} steps", record.trace.len());
        assert_eq!(record.logs, if has(50) { vec![text.clone()] } else { Vec::new() });
        found.push(expected.len());
        texts.push(record.logs.len());
    }
    assert!(found.is_sorted() && (0..=3).all(|count| found.contains(&count)), "{found:?}");
    assert!(texts.contains(&0) && texts.contains(&1));
}

/// A record of a drive that sends a text in step 50.
struct Talking<'a> {
    writer: &'a mut RecordWriter,
    step: u32,
}

impl StepObserver for Talking<'_> {
    fn begin(&mut self, start: &RunStart<'_>) -> Result<(), WriteError> {
        self.writer.begin(start)
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        if self.step == 50 {
            self.writer.event(50, &Event::Log(LogEntry::Note("supply is low".to_owned())))?;
        }
        self.step += 1;
        self.writer.step(step)
    }

    fn event(&mut self, step: u32, event: &Event) -> Result<(), WriteError> {
        self.writer.event(step, event)
    }
}

#[test]
fn samples_cut_at_any_byte_read_up_to_the_last_whole_chunk() {
    let parent = tempfile::tempdir().expect("a folder");
    let path = parent.path().join("run");
    let folder = RecordFolder::claim(&path, false).expect("a folder");
    let settings = ["run.duration_s=0.1", "record.flush_rows=20", "expect=[]"];
    let scenario = scenario("smooth-after.toml", &settings);
    let (mut memory, mut writer) = (Columns::default(), RecordWriter::new(folder, RunSource::default()));
    run_in_process(&scenario, vec![&mut memory, &mut writer]).expect("a run");
    drop(writer);
    let whole = fs::read(path.join("run.mcap")).expect("samples");
    let time_s = memory.get("time_s").expect("a time");
    let names =
        |columns: &Columns| columns.signals().iter().map(|it| it.name.to_string()).collect::<Vec<_>>();
    let ends = ends_of_records(&whole);
    let end_of_data = ends.windows(2).find(|it| whole[it[0]] == DATA_END).expect("an end of the data")[1];
    // Behind the opcode and length of a record too.
    let heads = ends.iter().map(|end| end + 9).filter(|length| *length < whole.len());
    // In the last bytes of a chunk its messages are there, but not its end.
    let tails = ends.iter().flat_map(|end| end.saturating_sub(32)..*end);
    let mut lengths: Vec<_> = (0..whole.len()).step_by(97).chain(tails).chain(ends.iter().copied()).collect();
    lengths.extend(heads);
    lengths.sort_unstable();
    let lengths_of_copies: Vec<_> = lengths.iter().copied().step_by(17).collect();
    let mut counts = Vec::new();
    for length in lengths {
        fs::write(path.join("run.mcap"), &whole[..length]).expect("a part");
        let record = match Record::read_any(&path) {
            Ok(record) => record,
            // Shorter than the mark at its start, it isn't such a file.
            Err(error) => {
                assert!(length < MAGIC && error.to_string().contains("run.mcap"), "{length} bytes: {error}");
                continue;
            }
        };
        let rows = record.trace.len();
        let is_cut = (1..end_of_data).contains(&length) && !ends.contains(&length);
        assert_eq!((record.is_torn, record.summary.is_some()), (is_cut, false), "{length} bytes");
        assert_eq!(record.column("time_s").expect("a time"), &time_s[..rows]);
        if rows > 0 {
            assert_eq!(names(&record.trace), names(&memory), "also before the first telemetry");
        } else {
            assert!(counts.iter().all(|rows| *rows == 0), "{length} bytes have samples");
        }
        counts.push(rows);
        if rows > 0 && lengths_of_copies.contains(&length) {
            assert!(bits(&copy(&record)) == bits(&record.trace), "{length} bytes");
        }
    }
    assert!(counts.is_sorted(), "{counts:?}");
    assert!(
        counts.contains(&100) && counts.contains(&20) && counts.iter().all(|rows| rows % 20 == 0),
        "{counts:?}"
    );
}

/// The trace of a copy with index, which another reader reads in both directions.
fn copy(record: &Record) -> Columns {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("export.mcap");
    let all = Selection { signals: Vec::new(), every: 1, from_s: 0.0, until_s: f64::INFINITY };
    export(record, &all, Format::Mcap, &path).expect("a copy");
    let bytes = fs::read(&path).expect("the copy");
    let [forwards, mut backwards] =
        [ReadOrder::LogTime, ReadOrder::ReverseLogTime].map(|it| by_index(&bytes, it));
    backwards.reverse();
    for topic in ["/step", "/drive"] {
        let of = |found: &[(String, u64, Vec<u8>)]| -> Vec<_> {
            found.iter().filter(|it| it.0 == topic).cloned().collect()
        };
        assert!(of(&forwards) == of(&backwards) && forwards.len() == backwards.len(), "{topic}");
    }
    let samples = Samples::read(&path).expect("samples");
    assert!(!samples.is_torn, "a copy has an end");
    samples.trace
}

#[test]
fn samples_before_the_first_telemetry_have_the_columns_of_the_drive() {
    let folder = tempfile::tempdir().expect("a folder");
    let signals = SignalTable { plant: Vec::new(), drive: vec![Signal::new("load_error_rad", "rad")] };
    let times = StepTimes { start_ns: 1_000_000_007, period_us: 1000 };
    let mut writer = SampleWriter::create(folder.path(), &signals, times, 0, 1, &[]).expect("samples");
    let row = TraceRow {
        time_s: 0.0,
        reference_rad: 0.0,
        load_position_rad: 0.0,
        motor_position_rad: 0.0,
        torque_nm: 0.0,
    };
    let timing = StepTiming {
        lateness: Duration::ZERO,
        outcome: StepOutcome::Answered,
        round_trip: None,
        tick_compute: None,
    };
    let drive = DriveValues { values: [f64::NAN].into_iter().collect(), time_s: None };
    let step = Step { row, sample: None, plant: [].into_iter().collect(), drive, timing };
    writer.push(&step).expect("a step");
    let samples = Samples::read(&folder.path().join("run.mcap")).expect("samples");
    let error = samples.trace.get("drive.load_error_rad").expect("the column of the drive");
    assert!(error.len() == 1 && error[0].is_nan() && !samples.is_torn, "{error:?}");
}

/// Bytes of the mark at the start of a file.
const MAGIC: usize = 8;

/// Kind of the record after the last chunk. What follows repeats schemas and channels.
const DATA_END: u8 = 0x0f;

/// The ends of the records of an MCAP file, each of which is a kind, a length and as many bytes.
fn ends_of_records(bytes: &[u8]) -> Vec<usize> {
    let mut ends = vec![MAGIC];
    while let Some(length) = ends.last().and_then(|end| bytes[*end..].get(1..9)?.first_chunk()) {
        ends.push(ends[ends.len() - 1] + 9 + u64::from_le_bytes(*length) as usize);
    }
    ends
}
