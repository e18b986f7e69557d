//! The cost of a comparison.

use std::time::Duration;

use lashloop_record::diff::{Agreement, Comparison, DiffOptions, RecordFiles};
use lashloop_record::folder::RecordFolder;
use lashloop_record::source::RunSource;
use lashloop_record::writer::RecordWriter;
use rustix::time::{ClockId, clock_gettime};

use super::{run_in_process, scenario};

/// Processor time of this thread, which other programs don't lengthen.
fn processor_s() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32).as_secs_f64()
}

/// Processor time of a comparison of a run with itself, in seconds.
fn comparison_s(duration_s: u32) -> f64 {
    let parent = tempfile::tempdir().expect("a folder");
    let path = parent.path().join("run");
    let folder = RecordFolder::claim(&path, false).expect("a folder");
    let mut writer = RecordWriter::new(folder, RunSource::default());
    let scenario = scenario("shaft-sine.toml", &[&format!("run.duration_s={duration_s}"), "expect=[]"]);
    run_in_process(&scenario, vec![&mut writer]).expect("a run");
    drop(writer);
    let once = || {
        let begin_s = processor_s();
        // One after the other: the command reads both at once.
        let records = [(), ()].map(|()| RecordFiles::read(&path).expect("a record"));
        let comparison = Comparison::new(&records, &DiffOptions::default()).expect("a comparison");
        let compared = 1000 * u64::from(duration_s);
        assert_eq!(
            (comparison.agreement, comparison.coverage.compared as u64),
            (Agreement::Different, compared)
        );
        processor_s() - begin_s
    };
    (0..3).map(|_| once()).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_cost_of_a_comparison_grows_with_the_rows_and_not_faster() {
    let (short_s, long_s) = (comparison_s(6), comparison_s(60));
    assert!(long_s < 15.0 * short_s, "{short_s} s for 6 s, {long_s} s for a minute");
}
