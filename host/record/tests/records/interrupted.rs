//! A record that was cut short at any byte reads up to there.

use std::fs;

use lashloop_record::folder::RecordFolder;
use lashloop_record::reader::{Completeness, Record};
use lashloop_record::source::RunSource;
use lashloop_record::writer::RecordWriter;

use super::{Memory, run_in_process, scenario};

#[test]
fn samples_cut_at_any_byte_read_up_to_the_last_whole_chunk() {
    let parent = tempfile::tempdir().expect("a folder");
    let path = parent.path().join("run");
    let folder = RecordFolder::claim(&path, false).expect("a folder");
    let settings = ["run.duration_s=0.2", "record.flush_rows=20", "expect=[]"];
    let scenario = scenario("smooth-after.toml", &settings);
    let (mut memory, mut writer) = (Memory::default(), RecordWriter::new(folder, RunSource::default()));
    run_in_process(&scenario, vec![&mut memory, &mut writer]).expect("a run");
    drop(writer);
    let whole = fs::read(path.join("run.mcap")).expect("samples");
    let time_s = memory.0.get("time_s").expect("a time");
    let mut counts = Vec::new();
    for length in (0..whole.len()).rev().step_by(97) {
        fs::write(path.join("run.mcap"), &whole[..length]).expect("a part");
        match Record::read(&path) {
            Ok(record) => {
                let rows = record.trace.len();
                assert_eq!(record.trace.column("time_s").expect("a time"), &time_s[..rows]);
                assert_eq!(record.completeness(), Completeness::Interrupted { steps: rows, is_cut: true });
                counts.push(rows);
            }
            // Before the first chunk nothing is left.
            Err(error) => {
                assert!(counts.last().is_none_or(|rows| *rows <= 20), "{length} bytes: {error}");
                assert!(error.to_string().contains("run.mcap"), "{error}");
            }
        }
    }
    assert!(counts.is_sorted_by(|before, after| before >= after), "{counts:?}");
    assert!(
        counts.contains(&200) && counts.contains(&20) && counts.iter().all(|rows| rows % 20 == 0),
        "{counts:?}"
    );
}
