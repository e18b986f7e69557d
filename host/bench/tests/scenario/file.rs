//! Files as editors and shells leave them.

use std::fs;
use std::path::{Path, PathBuf};

use lashloop_bench::scenario::Scenario;
use rustix::fs::{CWD, FileType, Mode};

use crate::SHORTEST;

fn message(path: &Path) -> String {
    Scenario::from_file(path, &[]).expect_err("no scenario").to_string()
}

/// A file with these bytes; the folder goes with the first value.
fn file(bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let path = directory.path().join("x.toml");
    fs::write(&path, bytes).expect("a file");
    (directory, path)
}

#[test]
fn a_pipe_a_folder_and_a_device_are_refused_without_waiting() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let pipe = directory.path().join("pipe");
    // It has no writer, so opening it would block.
    rustix::fs::mknodat(CWD, &pipe, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0).expect("a pipe");
    for (path, what) in [
        (pipe.as_path(), "is a pipe; write the scenario to a file first"),
        (directory.path(), "is a folder; name a file in it"),
        (Path::new("/dev/zero"), "is a device; name a file"),
    ] {
        assert_eq!(message(path), format!("{}: {what}", path.display()));
    }
}

#[test]
fn a_file_beyond_1_mib_is_refused() {
    let padded = |size: usize| {
        let mut text = SHORTEST.to_owned() + "#";
        text.extend(std::iter::repeat_n('x', size - text.len()));
        text.into_bytes()
    };
    let (_directory, largest) = file(&padded(1 << 20));
    assert!(Scenario::from_file(&largest, &[]).is_ok());
    let (_directory, larger) = file(&padded((1 << 20) + 1));
    let want = "is larger than 1 MiB, so it isn't a scenario; name a TOML file";
    assert_eq!(message(&larger), format!("{}: {want}", larger.display()));
}

#[test]
fn a_byte_order_mark_and_windows_line_ends_are_accepted() {
    let text = SHORTEST.replace('\n', "\r\n");
    let (_directory, path) = file(format!("\u{feff}{text}").as_bytes());
    assert_eq!(Scenario::from_file(&path, &[]).expect("a good scenario").title, "a run");
    let (_directory, path) = file(format!("\u{feff}{}", text.replace("2.0", "-2.0")).as_bytes());
    let place = format!("{}:3: run.duration_s: -2.0", path.display());
    assert!(message(&path).starts_with(&place), "{}", message(&path));
}

#[test]
fn other_encodings_are_named() {
    let utf_16: Vec<u8> = SHORTEST.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let marked: Vec<u8> = [&[0xff, 0xfe][..], &utf_16].concat();
    for bytes in [utf_16, marked] {
        let (_directory, path) = file(&bytes);
        let want = "is in UTF-16 or binary; save it as text in UTF-8";
        assert_eq!(message(&path), format!("{}: {want}", path.display()));
    }
    // Latin-1: the e with acute accent is one byte.
    let latin = [SHORTEST.as_bytes(), b"# caf\xe9\n"].concat();
    let (_directory, path) = file(&latin);
    assert_eq!(
        message(&path),
        format!("{}: is not in UTF-8 in line 11; save it as text in UTF-8", path.display())
    );
}
