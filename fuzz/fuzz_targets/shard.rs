//! Any bytes are rows of a shard or are not: a row that counts has its fields, its case and a digest.

#![no_main]

use lashloop_campaign::row::{case_of, count_fields};
use lashloop_campaign::shard::Shard;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut lines = bytes.split_inclusive(|byte| *byte == b'\n');
    let Some(header) = lines.next() else { return };
    let fields = count_fields(header);
    for line in lines {
        if case_of(line, fields).is_some() {
            let digest = &line[line.len() - 65..line.len() - 1];
            assert!(digest.iter().all(u8::is_ascii_hexdigit));
            assert!(line.ends_with(b"\n") && line[0].is_ascii_digit() | (line[0] == b'+'));
        }
    }
    if let Ok(name) = std::str::from_utf8(header)
        && let Some(shard) = Shard::of_file_name(name)
    {
        assert!(name.starts_with(&shard.stem()), "{name}");
    }
});
