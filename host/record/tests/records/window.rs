//! The record of a window: the steps around the longest silence, with the bits that the whole record has.

use lashloop_bench::run::StepObserver;
use lashloop_record::folder::RecordFolder;
use lashloop_record::reader::Record;
use lashloop_record::source::RunSource;
use lashloop_record::window::WindowRecorder;
use lashloop_record::writer::RecordWriter;

use super::{bits, run_in_process, scenario};

#[test]
fn a_window_has_the_steps_around_the_longest_silence() {
    const AROUND: usize = 50;
    let parent = tempfile::tempdir().expect("a folder");
    let claim = |name: &str| RecordFolder::claim(&parent.path().join(name), false).expect("a folder");
    let stall = |at_s: f64, for_s: f64| format!("{{ kind=\"link-stall\", at_s={at_s}, for_s={for_s} }}");
    let faults = format!("fault=[{}, {}]", stall(0.1, 0.004), stall(0.25, 0.008));
    let scenario = scenario(
        "smooth-after.toml",
        &[
            "run.duration_s=0.5",
            "expect=[]",
            &faults,
            "link.answer_timeout_ms=100",
            "link.silence_limit_ms=10000",
        ],
    );
    let mut whole = RecordWriter::new(claim("whole"), RunSource::default());
    let mut window = WindowRecorder::new(AROUND as f64 * 1e-3, RunSource::default());
    let observers: Vec<&mut dyn StepObserver> = vec![&mut whole, &mut window];
    run_in_process(&scenario, observers).expect("a run");
    drop(whole);
    window.write(&claim("window"), None).expect("a record");

    let [whole, window] =
        ["whole", "window"].map(|name| Record::read(&parent.path().join(name)).expect("a record"));
    let answered = whole.timing.get("answered").expect("the column").to_vec();
    let silences: Vec<_> =
        answered.chunk_by(|a, b| a == b).filter(|it| it[0] == 0.0).map(<[f64]>::len).collect();
    let longest = *silences.iter().max().expect("a silence");
    assert!(silences.len() >= 2 && longest > silences[0], "{silences:?}");
    let end = answered.iter().rposition(|answered| *answered == 0.0).expect("a silence") + 1;
    let expected = end - longest - AROUND..end + AROUND;
    let part = whole.trace.select(|row| expected.contains(&row));
    assert_eq!(bits(&window.trace), bits(&part));
    let steps = expected.len();
    assert_eq!(
        window.interruption(),
        Some(format!("interrupted: no summary.json, {steps} steps reached the disk"))
    );
}
