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

#[test]
fn a_comparison_of_ten_minutes_takes_less_than_five_seconds() {
    let parent = tempfile::tempdir().expect("a folder");
    let path = parent.path().join("run");
    let folder = RecordFolder::claim(&path, false).expect("a folder");
    let mut writer = RecordWriter::new(folder, RunSource::default());
    // A tenth of it: reading and comparing are linear in the rows.
    let scenario = scenario("shaft-sine.toml", &["run.duration_s=60", "expect=[]"]);
    run_in_process(&scenario, vec![&mut writer]).expect("a run");
    drop(writer);
    let once = || {
        let begin_s = processor_s();
        // One after the other: the command reads both at once.
        let records = [(), ()].map(|()| RecordFiles::read(&path).expect("a record"));
        let comparison = Comparison::new(&records, &DiffOptions::default()).expect("a comparison");
        assert_eq!((comparison.agreement, comparison.coverage.compared), (Agreement::Different, 60_000));
        10.0 * (processor_s() - begin_s)
    };
    let least_s = (0..3).map(|_| once()).fold(f64::INFINITY, f64::min);
    assert!(least_s < 5.0, "{least_s} s for ten minutes");
}
