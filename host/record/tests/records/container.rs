//! Another reader of MCAP.

use std::fs;
use std::path::PathBuf;

use lashloop_record::folder::RecordFolder;
use lashloop_record::reader::Record;
use lashloop_record::samples::Samples;
use lashloop_record::source::RunSource;
use lashloop_record::writer::RecordWriter;
use mcap::sans_io::indexed_reader::{IndexedReadEvent, IndexedReader, IndexedReaderOptions, ReadOrder};
use mcap::{MessageStream, Summary};
use tempfile::TempDir;

use super::{run_in_process, scenario};

/// A run of `duration_s` with chunks of `flush_rows` steps; its folder.
fn recorded(duration_s: &str, flush_rows: &str) -> (TempDir, PathBuf) {
    let parent = tempfile::tempdir().expect("a folder");
    let path = parent.path().join("run");
    let folder = RecordFolder::claim(&path, false).expect("a folder");
    let mut writer = RecordWriter::new(folder, RunSource::default());
    let settings = [duration_s, flush_rows, "expect=[]"];
    run_in_process(&scenario("smooth-after.toml", &settings), vec![&mut writer]).expect("a run");
    drop(writer);
    (parent, path)
}

/// Topic, time and data of each message, as the index finds them.
pub(crate) fn by_index(bytes: &[u8], order: ReadOrder) -> Vec<(String, u64, Vec<u8>)> {
    let summary = Summary::read(bytes).expect("a summary with its checksum").expect("a summary");
    let options = IndexedReaderOptions::new().with_order(order);
    let mut reader = IndexedReader::new_with_options(&summary, options).expect("an index");
    let mut found = Vec::new();
    while let Some(event) = reader.next_event() {
        match event.expect("the chunk of an index") {
            IndexedReadEvent::ReadChunkRequest { offset, length } => {
                let chunk = &bytes[offset as usize..][..length];
                reader.insert_chunk_record_data(offset, chunk).expect("a chunk");
            }
            IndexedReadEvent::Message { header, data } => {
                let topic = summary.channels[&header.channel_id].topic.clone();
                found.push((topic, header.log_time, data.to_owned()));
            }
        }
    }
    found
}

#[test]
fn another_reader_finds_every_message_attachment_and_count() {
    // Ten chunks of one block, and one of several blocks.
    for (duration_s, flush_rows, steps, chunks) in [("0.2", "20", 200, 10), ("3", "3000", 3000, 1)] {
        let (_parent, path) =
            recorded(&format!("run.duration_s={duration_s}"), &format!("record.flush_rows={flush_rows}"));
        let bytes = fs::read(path.join("run.mcap")).expect("samples");
        let messages: Vec<_> = MessageStream::new(&bytes)
            .expect("MCAP")
            .collect::<Result<_, _>>()
            .expect("messages with their checksums");
        let of = |topic: &str| messages.iter().filter(|it| it.channel.topic == topic).count();
        assert_eq!((of("/step"), of("/drive")), (steps, steps / 10));
        assert!(messages.is_sorted_by_key(|it| it.publish_time));
        let summary = Summary::read(&bytes).expect("a summary with its checksum").expect("a summary");
        let counts = summary.stats.as_ref().expect("counts");
        assert_eq!(counts.message_count, messages.len() as u64);
        assert_eq!((counts.chunk_count, counts.schema_count, counts.channel_count), (chunks, 4, 4));
        let manifest = Record::read(&path).expect("a record").manifest;
        let start_ns = manifest.step_times().start_ns;
        assert!(start_ns > 1_700_000_000_000_000_000, "since 1970: {start_ns}");
        let end_ns = start_ns + (steps as u64 - 1) * 1_000_000;
        assert_eq!((counts.message_start_time, counts.message_end_time), (start_ns, end_ns));
        let mut backwards = by_index(&bytes, ReadOrder::ReverseLogTime);
        backwards.reverse();
        let forwards = by_index(&bytes, ReadOrder::LogTime);
        assert_eq!(forwards.len(), messages.len());
        assert!(forwards.is_sorted_by_key(|(_, time_ns, _)| *time_ns));
        assert!(backwards.is_sorted_by_key(|(_, time_ns, _)| *time_ns));
        let read = |topic: &str, found: &[(String, u64, Vec<u8>)]| -> Vec<_> {
            found.iter().filter(|it| it.0 == topic).cloned().collect()
        };
        for topic in ["/step", "/drive"] {
            let streamed: Vec<_> = messages
                .iter()
                .filter(|it| it.channel.topic == topic)
                .map(|it| (topic.to_owned(), it.log_time, it.data.to_vec()))
                .collect();
            assert!(read(topic, &forwards) == streamed && read(topic, &backwards) == streamed, "{topic}");
        }
        for index in &summary.chunk_indexes {
            assert_eq!(summary.read_message_indexes(&bytes, index).expect("message indexes").len(), 2);
        }
        for index in &summary.attachment_indexes {
            let attachment = mcap::read::attachment(&bytes, index).expect("an attachment with its checksum");
            let length = fs::metadata(path.join(&attachment.name)).expect("the same file").len();
            assert_eq!(length, attachment.data.len() as u64, "{}", attachment.name);
        }
        assert!(summary.attachment_indexes.iter().any(|it| it.name == "record.json"));
    }
}

/// Places of the records of a file, with their kinds.
fn records(bytes: &[u8]) -> Vec<(usize, u8)> {
    let (mut at, mut found) = (8, Vec::new());
    while let Some([kind, length @ ..]) = bytes[at..].first_chunk::<9>() {
        found.push((at, *kind));
        at += 9 + u64::from_le_bytes(*length) as usize;
    }
    found
}

#[test]
fn damage_of_a_finished_file_is_an_error_before_the_end_of_its_data_and_nothing_after_it() {
    let (_parent, path) = recorded("run.duration_s=0.2", "record.flush_rows=20");
    let file = path.join("run.mcap");
    let whole = fs::read(&file).expect("samples");
    let read = |at: usize, bit: u8| {
        let mut damaged = whole.clone();
        damaged[at] ^= bit;
        fs::write(&file, damaged).expect("a file");
        Samples::read(&file).map(|samples| (samples.trace.len(), samples.is_torn))
    };
    let places = records(&whole);
    let end_of_data = places.iter().find(|(_, kind)| *kind == 0x0f).expect("an end of the data").0;
    for (at, _) in places.iter().filter(|(at, kind)| *at < end_of_data && *kind == 0x06) {
        for (byte, bit) in [(at + 4, 1), (at + 1, 1), (at + 200, 0x10)] {
            let read = read(byte, bit);
            assert!(read.is_err(), "byte {} of a chunk at {at}: {read:?}", byte - at);
        }
    }
    // A length of one more, behind which the next record seems to end the data.
    let chunk = places.iter().position(|(_, kind)| *kind == 0x06).expect("a chunk");
    let mut damaged = whole.clone();
    damaged[places[chunk].0 + 1] = damaged[places[chunk].0 + 1].wrapping_add(1);
    damaged[places[chunk + 1].0 + 1] = 0x0f;
    damaged[places[chunk + 1].0 + 2..][..8].copy_from_slice(&4_u64.to_le_bytes());
    fs::write(&file, damaged).expect("a file");
    assert!(Samples::read(&file).is_err(), "the data ends within a record");
    for (at, _) in places.iter().filter(|(at, _)| *at > end_of_data) {
        assert_eq!(read(at + 1, 1).ok(), Some((200, false)), "behind the data, at {at}");
    }
}
