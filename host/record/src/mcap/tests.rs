use std::fs;

use super::{McapError, McapWriter, MessageHeader, Record, records};

const FIRST: MessageHeader = MessageHeader { channel_id: 0, sequence: 7, log_time: 20, publish_time: 21 };
const SECOND: MessageHeader = MessageHeader { channel_id: 1, sequence: 8, log_time: 10, publish_time: 11 };

/// Two channels, an attachment, and a message in each of two chunks.
fn file() -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.mcap");
    let mut writer = McapWriter::create(&path, ".a-").expect("a file");
    writer.attach("a.txt", "text/plain", "attached");
    let metadata = [("period_us", "1000".to_owned())];
    assert_eq!(writer.add_channel("/a", ("A", "text", "schema a"), "raw", &metadata), 0);
    assert_eq!(writer.add_channel("/b", ("B", "text", "schema b"), "raw", &[]), 1);
    writer.push(&FIRST, &[1; 1000]);
    writer.flush().expect("a chunk");
    writer.push(&SECOND, b"second");
    writer.finish().expect("the end");
    fs::read(&path).expect("the file")
}

/// The records as text, and whether the last one is whole.
fn read(bytes: &[u8]) -> Result<(Vec<String>, bool), McapError> {
    let mut read = Vec::new();
    let is_whole = records(bytes, |record| {
        let is_end = record == Record::DataEnd;
        read.push(match record {
            Record::Schema { id, text } => format!("schema {id}: {}", String::from_utf8_lossy(text)),
            Record::Channel(it) => format!("channel {}: {} {:?}", it.id, it.topic, it.metadata),
            Record::Message(header, data) => format!("message {header:?}: {} bytes", data.len()),
            Record::DataEnd => "end".to_owned(),
        });
        Ok::<_, McapError>(!is_end)
    })?;
    Ok((read, is_whole))
}

#[test]
fn what_is_written_reads_back() {
    let (read, is_whole) = read(&file()).expect("a file");
    let want = [
        "schema 1: schema a".to_owned(),
        "channel 0: /a {\"period_us\": \"1000\"}".to_owned(),
        "schema 2: schema b".to_owned(),
        "channel 1: /b {}".to_owned(),
        format!("message {FIRST:?}: 1000 bytes"),
        format!("message {SECOND:?}: 6 bytes"),
        "end".to_owned(),
    ];
    assert_eq!((&read[..], is_whole), (&want[..], true));
}

#[test]
fn a_file_that_is_cut_off_anywhere_reads_back_up_to_its_last_whole_chunk() {
    let file = file();
    let (whole, _) = read(&file).expect("a file");
    for length in super::MAGIC.len()..file.len() {
        let (read, _) = read(&file[..length]).expect("the begin of a file");
        assert!(whole.starts_with(&read), "{length}: {read:?}");
    }
    assert!(matches!(read(&file[..7]), Err(McapError::Magic)));
}

#[test]
fn a_chunk_with_another_byte_is_damaged() {
    let file = file();
    let chunk = file.windows(4).position(|it| it == b"zstd").expect("a chunk");
    for at in chunk + 12..chunk + 40 {
        let mut damaged = file.clone();
        damaged[at] ^= 0x10;
        let read = read(&damaged);
        assert!(read.is_err(), "byte {at}: {read:?}");
    }
}
