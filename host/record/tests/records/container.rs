//! Another reader of MCAP.

use std::fs;

use lashloop_record::folder::RecordFolder;
use lashloop_record::source::RunSource;
use lashloop_record::writer::RecordWriter;
use mcap::{MessageStream, Summary};

use super::{run_in_process, scenario};

/// 200 steps and 20 telemetries.
#[test]
fn another_reader_finds_every_message_attachment_and_count() {
    let parent = tempfile::tempdir().expect("a folder");
    let path = parent.path().join("run");
    let mut writer =
        RecordWriter::new(RecordFolder::claim(&path, false).expect("a folder"), RunSource::default());
    let scenario =
        scenario("smooth-after.toml", &["run.duration_s=0.2", "record.flush_rows=20", "expect=[]"]);
    run_in_process(&scenario, vec![&mut writer]).expect("a run");
    drop(writer);
    let bytes = fs::read(path.join("run.mcap")).expect("samples");
    let messages: Vec<_> = MessageStream::new(&bytes)
        .expect("MCAP")
        .collect::<Result<_, _>>()
        .expect("messages with their checksums");
    let of = |topic: &str| messages.iter().filter(|it| it.channel.topic == topic).count();
    assert_eq!((of("/step"), of("/drive")), (200, 20));
    assert!(messages.is_sorted_by_key(|it| it.publish_time));
    let summary = Summary::read(&bytes).expect("a summary with its checksum").expect("a summary");
    let counts = summary.stats.expect("counts");
    assert_eq!(counts.message_count, messages.len() as u64);
    assert_eq!((counts.chunk_count, counts.schema_count, counts.channel_count), (10, 4, 4));
    assert_eq!((counts.message_start_time, counts.message_end_time), (0, 199_000_000));
    let attached = summary.attachment_indexes.iter().map(|index| {
        let attachment = mcap::read::attachment(&bytes, index).expect("an attachment with its checksum");
        (attachment.name, attachment.data.len() as u64)
    });
    for (name, length) in attached {
        assert_eq!(fs::metadata(path.join(&name)).expect("the same file").len(), length, "{name}");
    }
    assert!(summary.attachment_indexes.iter().any(|it| it.name == "record.json"));
}
