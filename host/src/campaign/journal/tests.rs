use std::fs;
use std::path::{Path, PathBuf};

use super::*;
use crate::campaign::case::{CaseId, CaseResult, Part};
use crate::campaign::law::Law;
use crate::campaign::score::Scores;
use crate::journal::{Journal, JournalError};

fn header() -> Header {
    let settings = Settings { seed: 1, plants: 2, laws: Law::ALL.to_vec(), sweeps: true };
    Header { lashloop: "0.1.0".to_owned(), program_sha256: "00".repeat(32), settings }
}

fn result(row: u32) -> CaseResult {
    let scores = r#"{"settle_time_s":"never","overshoot_rad":0.0,"static_error_rad":-0.1,"static_error_bands":-50.0,
        "hunting_rad":0.0,"dead_zone_error_rad":0.3333333333333333,"learnt_dead_zone_error_rad":"not learnt",
        "dead_zone_deviation_rad":0.5,"effort_nm2s":1e2,"torque_total_variation_nm":7.5}"#;
    CaseResult {
        case: CaseId { part: Part::RandomPlants, row, law: Law::BEFORE },
        end: "complete".to_owned(),
        scores: serde_json::from_str::<Scores>(scores).expect("scores"),
        torque_sha256: "ff".repeat(32),
    }
}

/// A file with two results, and its folder.
fn written() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("runs.jsonl");
    let mut journal = Journal::create(&path, &header()).expect("a new file");
    for row in [0, 1] {
        journal.append(&result(row)).expect("a result is written");
    }
    (folder, path)
}

fn resume(path: &Path, header: &Header) -> Result<(Journal, Vec<CaseResult>), JournalError> {
    let mut results = Vec::new();
    let journal = Journal::resume(path, header, |result| {
        results.push(result);
        Ok(())
    })?;
    Ok((journal, results))
}

#[test]
fn results_are_restored_and_more_can_follow() {
    let (_folder, path) = written();
    let (mut journal, results) = resume(&path, &header()).expect("the same battery");
    assert_eq!(results, [result(0), result(1)]);
    journal.append(&result(2)).expect("a result is written");
    drop(journal);
    assert_eq!(resume(&path, &header()).expect("the same battery").1, [result(0), result(1), result(2)]);
}

#[test]
fn whole_results_survive_a_file_torn_anywhere() {
    let (_folder, path) = written();
    let whole = fs::read(&path).expect("the file");
    for length in 0..whole.len() {
        fs::write(&path, &whole[..length]).expect("a torn file");
        let lines = whole[..length].iter().filter(|&&byte| byte == b'\n').count();
        let (mut journal, results) = resume(&path, &header()).expect("the same battery");
        assert_eq!(results.len(), lines.saturating_sub(1), "torn at {length}");
        for row in results.len()..2 {
            journal.append(&result(row as u32)).expect("a result is written");
        }
        drop(journal);
        assert_eq!(fs::read(&path).expect("the file"), whole, "torn at {length}");
    }
}

#[test]
fn results_of_another_battery_are_refused_by_the_difference() {
    let (_folder, path) = written();
    let before = fs::read(&path).expect("the file");
    let with = |change: fn(&mut Header)| {
        let mut header = header();
        change(&mut header);
        resume(&path, &header)
            .expect_err("another battery")
            .to_string()
            .replace(&*path.to_string_lossy(), "F")
    };
    for (message, difference) in [
        (with(|it| it.lashloop = "0.2.0".to_owned()), "its version is 0.1.0, here it is 0.2.0"),
        (with(|it| it.settings.seed = 2), "its seed is 1, here it is 2"),
        (with(|it| it.settings.plants = 3), "its number of plants is 2, here it is 3"),
        (
            with(|it| it.settings.laws = vec![Law::BEFORE]),
            "its list of controllers is pd,merzouki,backlash-inverse,braking-curve, here it is pd",
        ),
        (with(|it| it.settings.sweeps = false), "its choice of sweeps is with, here it is without"),
        (with(|it| it.program_sha256 = "11".repeat(32)), "its program's SHA-256 is 0000"),
    ] {
        assert!(message.starts_with(&format!("F can't be resumed: {difference}")), "{message}");
    }
    assert_eq!(fs::read(&path).expect("the file"), before, "a refusal changes nothing");
}

#[test]
fn malformed_line_is_named_and_nothing_is_lost() {
    let (_folder, path) = written();
    let text = fs::read_to_string(&path).expect("the file");
    for (broken, place) in [
        (text.replacen("\"pd\"},\"end\"", "\"pid\"},\"end\"", 1), "runs.jsonl:2: unknown law `pid`"),
        (text.replace("\"row\":1", "\"row\":-1"), "runs.jsonl:3: invalid value: integer `-1`"),
        (text.replace("-0.1", "1e999"), "runs.jsonl:2: number out of range"),
        (text.replace("\"never\"", "\"soon\""), "runs.jsonl:2: data did not match any variant"),
        (text.replacen('{', "[", 1), "runs.jsonl:1: "),
        (format!("{text}\n"), "runs.jsonl:4: EOF"),
    ] {
        assert_ne!(broken, text);
        fs::write(&path, &broken).expect("a broken file");
        let message = resume(&path, &header()).expect_err("a broken line").to_string();
        assert!(message.contains(place), "{place}: {message}");
        assert_eq!(fs::read_to_string(&path).expect("the file"), broken);
    }
}

#[test]
fn refused_result_is_named_by_its_line() {
    let (_folder, path) = written();
    let refuse = |result: CaseResult| if result.case.row == 1 { Err("no such run") } else { Ok(()) };
    let error = Journal::resume(&path, &header(), refuse).expect_err("a refusal");
    assert!(error.to_string().contains("runs.jsonl:3: no such run;"), "{error}");
}

#[test]
fn results_have_one_writer_and_are_not_overwritten() {
    let (_folder, path) = written();
    assert!(matches!(Journal::create(&path, &header()), Err(JournalError::Exists { .. })));
    let first = resume(&path, &header()).expect("the same battery");
    assert!(matches!(resume(&path, &header()), Err(JournalError::InUse { .. })));
    drop(first);
    assert_eq!(resume(&path, &header()).expect("the same battery").1.len(), 2);
}
