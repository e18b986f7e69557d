//! Records of others: damaged, or made to hurt. Every reader ends with a result or an error, soon and in bounded memory.
//!
//! `LASHLOOP_DAMAGED_RECORDS=10000 cargo test -p tests --test robustness -- damaged_records` tries as many; by default it
//! is a share of them.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use lashloop::execution::{Execution, Place};
use lashloop::replay::Recording;
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_record::diff::{Comparison, DiffOptions, RecordFiles, settings};
use lashloop_record::export::{Format, Selection, export};
use lashloop_record::folder::RecordFolder;
use lashloop_record::reader::Record;
use lashloop_record::source::RunSource;
use lashloop_record::writer::RecordWriter;
use lashloop_report::page;
use lashloop_report::runs::{self, Input};
use lz4_flex::frame::{FrameDecoder, FrameEncoder};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Tried without the variable.
const SHARE: usize = 500;
const COUNT: &str = "LASHLOOP_DAMAGED_RECORDS";
/// Longest time for one record, all its readers together. The machine may be busy.
const LIMIT: Duration = Duration::from_secs(20);
/// Most memory of this process at any time, other tests in it included.
const MEMORY_KB: u64 = 1_000_000;

const CHUNK: u8 = 0x06;
const MESSAGE: u8 = 0x05;
/// Opcode and length of a record.
const HEAD: usize = 9;

/// A short record with a fault and telemetry.
fn recorded(path: &Path) {
    let settings = [
        "run.duration_s=0.1",
        "record.flush_rows=20",
        "expect=[]",
        "fault=[{ kind=\"torque-gain\", gain=0.9, at_s=0.03, for_s=0.04 }]",
    ];
    let overrides: Vec<_> = settings.iter().map(|it| Override::Set((*it).to_owned())).collect();
    let scenario = Scenario::from_file(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/smooth-after.toml"),
        &overrides,
    )
    .expect("a scenario");
    let folder = RecordFolder::claim(path, false).expect("a folder");
    let supervisor = Supervisor::without_signals(None).expect("a supervisor");
    let device = "inproc".parse().expect("a device");
    let record = RecordWriter::new(folder, RunSource::default());
    let made =
        Execution::new(scenario, Place::Device(&device)).record(record).run(&supervisor).expect("a run");
    made.finish().expect("a record");
}

/// What a file of a record is read for: by `report`, `plot`, `diff`, `export`, `replay` and `rerun`.
fn read_all(folder: &Path, whole: &RecordFiles) -> bool {
    let _ = Scenario::from_file(&folder.join("scenario.toml"), &[]);
    if let Ok(run) = page::Run::read("damaged", folder) {
        let _ = page::run(&run, &page::Panels::default());
    }
    let Ok(record) = Record::read(folder) else { return false };
    let everything = Selection { signals: Vec::new(), every: 1, from_s: 0.0, until_s: f64::INFINITY };
    for format in [Format::Csv, Format::Mcap, Format::Mf4, Format::Parquet] {
        let _ = export(&record, &everything, format, &folder.join("exported"));
    }
    let chosen = Selection { signals: vec!["torque_nm".to_owned()], every: 3, ..everything };
    let _ = export(&record, &chosen, Format::Mcap, &folder.join("exported"));
    let drawn = runs::Selection {
        shown_s: f64::NEG_INFINITY..=f64::INFINITY,
        signals: Vec::new(),
        panels: Vec::new(),
    };
    if let Ok(figure) = runs::figure(&[("damaged".to_owned(), Input::Record(Box::new(record)))], &drawn) {
        let _ = figure.to_svg();
    }
    let Ok(files) = RecordFiles::read(folder) else { return false };
    let _ = Recording::new(&files);
    let both = [whole.clone(), files];
    let _ = settings(&both);
    for deterministic in [false, true] {
        let options = DiffOptions { deterministic, ..DiffOptions::default() };
        if let Ok(comparison) = Comparison::new(&both, &options) {
            let _ = comparison.to_string();
        }
    }
    true
}

fn below(random: &mut Pcg64Mcg, limit: usize) -> usize {
    (random.next_u64() % limit.max(1) as u64) as usize
}

/// A number that lengths, counts and values of bits are wrong with.
fn extreme(random: &mut Pcg64Mcg) -> [u8; 8] {
    let numbers = [
        0,
        1,
        8,
        u64::MAX,
        u64::MAX - 8,
        1 << 63,
        500_000_000_000_000_000,
        u64::from(u32::MAX),
        1 << 31,
        1 << 30,
        f64::NAN.to_bits(),
        f64::INFINITY.to_bits(),
        f64::MAX.to_bits(),
        (-f64::MAX).to_bits(),
        f64::MIN_POSITIVE.to_bits(),
        1e18_f64.to_bits(),
    ];
    numbers[below(random, numbers.len())].to_le_bytes()
}

fn overwrite(bytes: &mut [u8], at: usize, with: &[u8]) {
    let room = bytes.len().saturating_sub(at).min(with.len());
    if room > 0 {
        bytes[at..at + room].copy_from_slice(&with[..room]);
    }
}

/// Begins of the records in `bytes` from `at` on.
fn records(bytes: &[u8], mut at: usize) -> Vec<usize> {
    let mut found = Vec::new();
    while let Some([_, length @ ..]) = bytes.get(at..).and_then(|rest| rest.first_chunk::<HEAD>()) {
        found.push(at);
        at = at.saturating_add(HEAD).saturating_add(u64::from_le_bytes(*length) as usize);
    }
    found
}

/// Anything, anywhere in a span.
fn scribble(bytes: &mut Vec<u8>, random: &mut Pcg64Mcg) {
    let at = below(random, bytes.len());
    match below(random, 5) {
        0 => overwrite(bytes, at, &[1 << below(random, 8)]),
        1 => {
            let number = extreme(random);
            let width = [1, 2, 4, 8][below(random, 4)];
            overwrite(bytes, at, &number[..width]);
        }
        2 => {
            let end = (at + below(random, 300)).min(bytes.len());
            bytes.drain(at..end);
        }
        3 => {
            let end = (at + below(random, 300)).min(bytes.len());
            let copy = bytes[at..end].to_vec();
            let to = below(random, bytes.len());
            bytes.splice(to..to, copy);
        }
        _ => bytes.truncate(at),
    }
}

/// Damages the messages in a chunk and packs them anew, so that neither compression nor checksum finds it.
fn inside_of_a_chunk(bytes: &mut Vec<u8>, random: &mut Pcg64Mcg) {
    let chunks: Vec<_> = records(bytes, 8).into_iter().filter(|at| bytes[*at] == CHUNK).collect();
    let Some(at) = (!chunks.is_empty()).then(|| chunks[below(random, chunks.len())]) else { return };
    // Times, size and checksum are 28 bytes, "lz4" 7, and the size of what follows 8.
    let [head, data] = [at + HEAD, at + HEAD + 43];
    let length = u64::from_le_bytes(*bytes[at + 1..].first_chunk().expect("a length")) as usize;
    let end = head + length;
    let mut inner = Vec::new();
    std::io::Read::read_to_end(&mut FrameDecoder::new(&bytes[data..end]), &mut inner).expect("a whole chunk");
    for _ in 0..=below(random, 3) {
        let places = records(&inner, 0);
        let place = places[below(random, places.len())];
        match below(random, 4) {
            0 => overwrite(&mut inner, place + 1, &extreme(random)),
            // A value of a message, behind channel, number, times and the head of CDR.
            1 if inner[place] == MESSAGE => {
                let value = place + HEAD + 26 + 8 * below(random, 50);
                overwrite(&mut inner, value, &extreme(random));
            }
            2 => overwrite(&mut inner, place + HEAD + 2 * below(random, 11), &extreme(random)),
            _ => scribble(&mut inner, random),
        }
    }
    let chunk = chunk(inner.len() as u64, |packed| packed.write_all(&inner).expect("memory"));
    bytes.splice(at..end, chunk);
}

fn damage_samples(bytes: &mut Vec<u8>, random: &mut Pcg64Mcg) {
    let places = records(bytes, 8);
    let place = places[below(random, places.len())];
    match below(random, 8) {
        0 => overwrite(bytes, place + 1, &extreme(random)),
        // A field at the start of a record: sizes of chunks, lengths of texts.
        1 => overwrite(bytes, place + HEAD + below(random, 48), &extreme(random)),
        2 | 3 => scribble(bytes, random),
        _ => inside_of_a_chunk(bytes, random),
    }
}

/// Replaces a number, or any span, of a text.
fn damage_text(bytes: &mut Vec<u8>, random: &mut Pcg64Mcg) {
    const SCRAPS: [&str; 14] = [
        "0",
        "-1",
        "1e999",
        "1e308",
        "-1e308",
        "18446744073709551615",
        "9223372036854775808",
        "4294967295",
        "null",
        "[]",
        "{}",
        "\"\\u001b[2J\"",
        "true",
        "\"NaN\"",
    ];
    let scrap = SCRAPS[below(random, SCRAPS.len())].as_bytes().to_vec();
    let digits: Vec<_> = (1..bytes.len())
        .filter(|at| {
            bytes[*at].is_ascii_digit() && !bytes[at - 1].is_ascii_alphanumeric() && bytes[at - 1] != b'.'
        })
        .collect();
    if below(random, 4) > 0 && !digits.is_empty() {
        let from = digits[below(random, digits.len())];
        let is_number = |byte: &u8| byte.is_ascii_alphanumeric() || b".+-".contains(byte);
        let length = bytes[from..].iter().take_while(|it| is_number(it)).count();
        bytes.splice(from..from + length, scrap);
    } else {
        scribble(bytes, random);
    }
}

fn peak_kb() -> u64 {
    let status = fs::read_to_string("/proc/self/status").expect("Linux");
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("a peak");
    peak.trim().trim_end_matches(" kB").parse().expect("a number")
}

#[test]
fn damaged_records_end_in_a_result_or_an_error() {
    let parent = tempfile::tempdir().expect("a folder");
    let [good, damaged] = ["good", "damaged"].map(|name| parent.path().join(name));
    recorded(&good);
    let whole = RecordFiles::read(&good).expect("a record");
    fs::create_dir(&damaged).expect("a folder");
    let files: Vec<(PathBuf, Vec<u8>)> = ["run.mcap", "record.json", "summary.json", "scenario.toml"]
        .map(|name| (damaged.join(name), fs::read(good.join(name)).expect("a file of the record")))
        .into();
    let count = std::env::var(COUNT).map_or(SHARE, |text| text.parse().expect("a number of records"));
    let mut random = Pcg64Mcg::seed_from_u64(20_261_130);
    let (mut read, mut longest, mut panics) = (0, Duration::ZERO, Vec::new());
    for number in 0..count {
        for (path, bytes) in &files {
            fs::write(path, bytes).expect("a file");
        }
        // Mostly the samples: they are the largest and have a format of their own.
        let chosen = below(&mut random, 6).saturating_sub(2);
        let (path, bytes) = &files[chosen];
        let mut bytes = bytes.clone();
        match chosen {
            0 => damage_samples(&mut bytes, &mut random),
            _ => damage_text(&mut bytes, &mut random),
        }
        fs::write(path, bytes).expect("a file");
        let started = Instant::now();
        let result = std::panic::catch_unwind(|| read_all(&damaged, &whole));
        let took = started.elapsed();
        longest = longest.max(took);
        let kept = || {
            let kept = std::env::temp_dir().join(format!("lashloop-damaged-record-{number}"));
            let _ = fs::remove_dir_all(&kept);
            fs::rename(&damaged, &kept).expect("a folder for the finding");
            kept.display().to_string()
        };
        if result.is_err() {
            panics.push(format!("record {number}: {}", kept()));
            fs::create_dir_all(&damaged).expect("a folder");
        }
        assert!(took < LIMIT, "record {number} takes {took:?}: {}", kept());
        assert!(peak_kb() < MEMORY_KB, "record {number} takes {} kB: {}", peak_kb(), kept());
        read += usize::from(result.unwrap_or_default());
    }
    println!("{count} records, {read} of them readable, the longest {longest:?}, peak {} kB", peak_kb());
    assert!(panics.is_empty(), "{} panics: {:#?}", panics.len(), &panics[..panics.len().min(10)]);
    // Both kinds have to occur for this to test anything.
    assert!(read > count / 10 && read < count, "{read} of {count} are readable");
}

/// A chunk that claims `claimed` bytes, with what `unpacked` writes.
fn chunk(claimed: u64, unpacked: impl FnOnce(&mut FrameEncoder<Vec<u8>>)) -> Vec<u8> {
    let mut packed = FrameEncoder::new(Vec::new());
    unpacked(&mut packed);
    let packed = packed.finish().expect("memory");
    let mut chunk = vec![0; 16];
    chunk.extend_from_slice(&claimed.to_le_bytes());
    chunk.extend_from_slice(&[0; 4]);
    chunk.extend_from_slice(b"\x03\0\0\0lz4");
    chunk.extend_from_slice(&(packed.len() as u64).to_le_bytes());
    chunk.extend_from_slice(&packed);
    record(CHUNK, &chunk)
}

fn record(opcode: u8, content: &[u8]) -> Vec<u8> {
    [&[opcode][..], &(content.len() as u64).to_le_bytes(), content].concat()
}

/// A record of `bytes` zeros in a chunk that claims `claimed`.
fn bomb(good: &[u8], claimed: u64, bytes: usize) -> Vec<u8> {
    let zeros = vec![0; 1 << 20];
    let chunk = chunk(claimed, |packed| {
        (0..bytes >> 20).for_each(|_| packed.write_all(&zeros).expect("memory"));
    });
    let first = records(good, 8).into_iter().find(|at| good[*at] == CHUNK).expect("a chunk");
    [&good[..first], &chunk, &good[first..]].concat()
}

#[test]
fn a_chunk_that_unpacks_to_gigabytes_is_an_error_in_bounded_memory() {
    let parent = tempfile::tempdir().expect("a folder");
    let path = parent.path().join("run");
    recorded(&path);
    let good = fs::read(path.join("run.mcap")).expect("samples");
    for (claimed, bytes) in [(3 << 30, 3 << 30), (500_000_000_000_000_000, 3 << 30), (u64::MAX, 1 << 20)] {
        fs::write(path.join("run.mcap"), bomb(&good, claimed, bytes)).expect("samples");
        let error = Record::read(&path).expect_err("a bomb").to_string();
        assert!(error.contains("run.mcap") && error.contains("chunk"), "{error}");
        assert!(peak_kb() < MEMORY_KB, "{claimed} bytes: {} kB", peak_kb());
    }
}

/// Schema and channel `number` of a topic whose fields are these, without a name of their own.
fn topic(number: u16, topic: &str, ty: &str, fields: usize) -> Vec<u8> {
    let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let lines: String = (0..fields).map(|field| format!("{ty} f{field} # f{field} []\n")).collect();
    let schema = [&number.to_le_bytes()[..], &text("x"), &text("ros2msg"), &text(&lines)].concat();
    let metadata = [text("period_us"), text("1000")].concat();
    let metadata = [&(metadata.len() as u32).to_le_bytes()[..], &metadata].concat();
    let channel =
        [&number.to_le_bytes()[..], &number.to_le_bytes(), &text(topic), &text("cdr"), &metadata].concat();
    [record(0x03, &schema), record(0x04, &channel)].concat()
}

/// A message of `bytes` zeros behind the head of CDR.
fn message(channel: u16, bytes: usize) -> Vec<u8> {
    let head = [&channel.to_le_bytes()[..], &[0; 20], &[0, 1, 0, 0]].concat();
    record(MESSAGE, &[head, vec![0; bytes]].concat())
}

#[test]
fn samples_that_need_more_memory_than_their_file_can_have_are_an_error() {
    let parent = tempfile::tempdir().expect("a folder");
    let path = parent.path().join("run");
    recorded(&path);
    // A byte of each field is a number of eight in memory; and each step repeats the telemetry in force.
    let wide = [topic(1, "/step", "uint8", 4000), topic(2, "/drive", "uint8", 1)].concat();
    let repeated = [topic(1, "/step", "uint8", 0), topic(2, "/drive", "uint8", 30_000)].concat();
    for (topics, messages, bytes) in [(wide, 50_000, 4000), (repeated, 30_000, 0)] {
        let message = message(1, bytes);
        let chunk = chunk(messages * message.len() as u64, |packed| {
            (0..messages).for_each(|_| packed.write_all(&message).expect("memory"));
        });
        fs::write(path.join("run.mcap"), [&b"\x89MCAP0\r\n"[..], &topics, &chunk].concat()).expect("samples");
        let error = Record::read(&path).expect_err("samples for gigabytes").to_string();
        assert!(error.contains("of memory"), "{error}");
        assert!(peak_kb() < MEMORY_KB, "{} kB", peak_kb());
    }
}
