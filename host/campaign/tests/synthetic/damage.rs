//! A shard that stopped anywhere is completed to the same bytes.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc;
use std::thread;

use lashloop_bench::resume::ResumeError;
use lashloop_campaign::CampaignError;
use lashloop_campaign::facts::Facts;
use lashloop_campaign::shard::Shard;
use lashloop_campaign::shard_file::{Start, complete_path, facts_path, growing_path};
use tempfile::tempdir;

use crate::support::{campaign, facts, run, run_all};

#[test]
fn shard_cut_at_any_byte_resumes_to_the_same_bytes() {
    let (campaign, folder) = (campaign(), tempdir().expect("a folder"));
    run_all(&campaign, folder.path(), 1);
    let (complete, growing) =
        (complete_path(folder.path(), Shard::WHOLE), growing_path(folder.path(), Shard::WHOLE));
    let whole = fs::read(&complete).expect("a table");
    let facts = facts(&campaign, 1);
    let header = whole.iter().position(|byte| *byte == b'\n').expect("a header") + 1;
    let row = header + whole[header..].iter().position(|byte| *byte == b'\n').expect("a row") + 1;
    // The ends of the header and of the first row to the byte, and some lengths beyond.
    let ends = (header - 2..header + 4).chain(row - 2..row + 4);
    for length in [0, 1].into_iter().chain(ends).chain((row + 400..whole.len()).step_by(397)) {
        fs::remove_file(&complete).expect("a table");
        fs::write(&growing, &whole[..length]).expect("a part");
        let runs = AtomicU64::new(0);
        let count = |_| {
            runs.fetch_add(1, Ordering::Relaxed);
            Ok(())
        };
        let done =
            run(&campaign, &facts, folder.path(), Shard::WHOLE, Start::Resume, count).expect("a shard");
        let rows = whole[..length].iter().filter(|byte| **byte == b'\n').count().saturating_sub(1) as u64;
        assert_eq!(done.restored, rows, "cut after {length} bytes");
        assert_eq!(runs.into_inner(), 34 - rows, "cut after {length} bytes: each case once");
        assert!(fs::read(&complete).expect("a table") == whole, "cut after {length} bytes");
        assert!(!growing.exists());
    }
}

#[test]
fn rows_after_a_damaged_line_are_run_again() {
    let (campaign, folder) = (campaign(), tempdir().expect("a folder"));
    run_all(&campaign, folder.path(), 1);
    let (complete, growing) =
        (complete_path(folder.path(), Shard::WHOLE), growing_path(folder.path(), Shard::WHOLE));
    let whole = fs::read_to_string(&complete).expect("a table");
    let mut lines: Vec<_> = whole.split_inclusive('\n').collect();
    // Blocks that a power failure left empty.
    lines[5] = "\0\0\0\0\0\0\n";
    fs::remove_file(&complete).expect("a table");
    fs::write(&growing, lines.concat()).expect("a part");
    let done = run(&campaign, &facts(&campaign, 1), folder.path(), Shard::WHOLE, Start::Resume, |_| Ok(()));
    assert_eq!(done.expect("a shard").restored, 4);
    assert_eq!(fs::read_to_string(&complete).expect("a table"), whole);
}

#[test]
fn failed_run_keeps_the_rows_before_it() {
    let (campaign, folder) = (campaign(), tempdir().expect("a folder"));
    let facts = facts(&campaign, 1);
    let fail = |case: u64| match case {
        20 => {
            let source = io::Error::other("no");
            Err(CampaignError::Io { path: PathBuf::from("drive"), action: "opened", source })
        }
        _ => Ok(()),
    };
    let ended = run(&campaign, &facts, folder.path(), Shard::WHOLE, Start::New, fail);
    assert!(ended.expect_err("a failed run").to_string().starts_with("drive: can't be opened"));
    assert!(
        facts_path(folder.path(), Shard::WHOLE).exists()
            && !complete_path(folder.path(), Shard::WHOLE).exists()
    );
    let done =
        run(&campaign, &facts, folder.path(), Shard::WHOLE, Start::Resume, |_| Ok(())).expect("a shard");
    assert!(done.restored <= 20 && done.rows == 34, "{done:?}");
    let never_failed = tempdir().expect("a folder");
    run_all(&campaign, never_failed.path(), 1);
    let table = |folder: &Path| fs::read(complete_path(folder, Shard::WHOLE)).expect("a table");
    assert!(table(folder.path()) == table(never_failed.path()));
}

/// The kill, or the full disk, is before the facts or in the header: no row is there.
#[test]
fn shard_that_ended_before_its_header_begins_again() {
    let (campaign, whole) = (campaign(), tempdir().expect("a folder"));
    run_all(&campaign, whole.path(), 1);
    let whole = fs::read(complete_path(whole.path(), Shard::WHOLE)).expect("a table");
    let facts = facts(&campaign, 1);
    for (part, start) in [
        (&b""[..], Start::Resume),
        (&whole[..9], Start::Resume),
        (&[0; 4096], Start::Resume),
        (&b""[..], Start::New),
    ] {
        let folder = tempdir().expect("a folder");
        fs::write(growing_path(folder.path(), Shard::WHOLE), part).expect("a part");
        let done = run(&campaign, &facts, folder.path(), Shard::WHOLE, start, |_| Ok(())).expect("a shard");
        assert_eq!((done.restored, done.rows), (0, 34));
        assert!(fs::read(complete_path(folder.path(), Shard::WHOLE)).expect("a table") == whole);
    }
}

/// The row has its case, but a hole instead of its end.
#[test]
fn damaged_end_of_a_row_is_no_row() {
    let (campaign, folder) = (campaign(), tempdir().expect("a folder"));
    run_all(&campaign, folder.path(), 1);
    let complete = complete_path(folder.path(), Shard::WHOLE);
    let whole = fs::read_to_string(&complete).expect("a table");
    let start = whole.split_inclusive('\n').take(6).collect::<String>();
    for row in ["5,random\0\0\0\n".to_owned(), format!("5,{}\n", "0".repeat(64))] {
        fs::remove_file(&complete).expect("a table");
        fs::write(growing_path(folder.path(), Shard::WHOLE), format!("{start}{row}")).expect("a part");
        let facts = facts(&campaign, 1);
        let done = run(&campaign, &facts, folder.path(), Shard::WHOLE, Start::Resume, |_| Ok(()));
        assert_eq!(done.expect("a shard").restored, 5, "{row:?}");
        assert!(fs::read_to_string(&complete).expect("a table") == whole);
    }
}

/// Another program completes the shard of another seed while this one waits for the lock.
#[test]
fn shard_completed_while_waiting_for_the_lock_is_looked_at_again() {
    let (campaign, folder, other) =
        (campaign(), tempdir().expect("a folder"), tempdir().expect("another folder"));
    let facts = facts(&campaign, 1);
    let theirs = Facts { seed: 9, ..facts.clone() };
    run(&campaign, &theirs, other.path(), Shard::WHOLE, Start::New, |_| Ok(())).expect("a shard");
    let (growing, complete) =
        (growing_path(folder.path(), Shard::WHOLE), complete_path(folder.path(), Shard::WHOLE));
    let locked = File::create(&growing).expect("a part");
    locked.lock().expect("the lock");
    facts.write(&facts_path(folder.path(), Shard::WHOLE)).expect("facts");
    let (begun, begin) = mpsc::channel();
    let ended = thread::scope(|scope| {
        let waiting = scope.spawn(|| {
            begun.send(()).expect("a receiver");
            loop {
                let ended = run(&campaign, &facts, folder.path(), Shard::WHOLE, Start::Resume, |_| Ok(()));
                if !matches!(ended, Err(CampaignError::Resume(ResumeError::InUse { .. }))) {
                    return ended;
                }
            }
        });
        begin.recv().expect("the thread");
        for name in [facts_path, complete_path] {
            fs::copy(name(other.path(), Shard::WHOLE), name(folder.path(), Shard::WHOLE)).expect("a copy");
        }
        drop(locked);
        waiting.join().expect("no panic")
    });
    let error = ended.expect_err("another seed").to_string();
    assert!(error.contains("its seed is 9, here it is 1"), "{error}");
    assert!(complete.exists() && !growing.exists());
}

#[test]
fn two_programs_do_not_write_one_shard() {
    let (campaign, folder) = (campaign(), tempdir().expect("a folder"));
    let facts = facts(&campaign, 1);
    let inner = |case: u64| {
        if case == 3 {
            let other = run(&campaign, &facts, folder.path(), Shard::WHOLE, Start::Resume, |_| Ok(()));
            assert!(matches!(other, Err(CampaignError::Resume(ResumeError::InUse { .. }))), "{other:?}");
        }
        Ok(())
    };
    run(&campaign, &facts, folder.path(), Shard::WHOLE, Start::New, inner).expect("the first one");
}
