//! Shards merge to the table of the single run, or not at all.

use std::path::Path;
use std::process::Command;
use std::{env, fs, thread};

use lashloop_campaign::CampaignError;
use lashloop_campaign::facts::Facts;
use lashloop_campaign::limit::Limits;
use lashloop_campaign::merge::{MergeLock, RESULTS, merge};
use lashloop_campaign::settings::Limit;
use lashloop_campaign::shard::Shard;
use lashloop_campaign::shard_file::{Start, complete_path, facts_path};
use lashloop_campaign::table::Table;
use lashloop_campaign::view::View;
use tempfile::tempdir;

use crate::support::{PARTS, TWO_VARIANTS, campaign, facts, read, run, run_all};

fn merged(count: u32) -> Vec<u8> {
    let folder = tempdir().expect("a folder");
    run_all(&campaign(), folder.path(), count);
    merge(folder.path()).expect("a table");
    fs::read(folder.path().join(RESULTS)).expect("the table")
}

#[test]
fn one_two_and_seven_shards_give_the_same_bytes() {
    let one = merged(1);
    assert_eq!(one.iter().filter(|byte| **byte == b'\n').count(), 35);
    for count in [2, 7, 40] {
        assert!(merged(count) == one, "{count} shards");
    }
}

#[test]
fn expectations_are_judged_over_the_runs_they_name() {
    let text = format!(
        "{TWO_VARIANTS}{PARTS}\n[[expect]]\npart = \"grid\"\nmetric = \"static_error_rad\"\nquantile = 1.0\nmax = 0.76\n\
         [[expect]]\nvariant = \"pd\"\nmetric = \"settle_time_s\"\nquantile = 0.9\nmax = 1000\n\
         [[expect]]\npass = 0.85\n"
    );
    let (campaign, folder) = (read(&text).expect("a campaign"), tempdir().expect("a folder"));
    run_all(&campaign, folder.path(), 2);
    merge(folder.path()).expect("a table");
    let path = folder.path().join(RESULTS);
    let report = View::new(&Table::new(&campaign, &path)).expect("a report").report;
    assert_eq!(
        report.groups.iter().map(|group| (group.runs, group.fail)).collect::<Vec<_>>(),
        [(11, 2), (11, 2), (6, 1), (6, 0)]
    );
    let judged: Vec<_> = report.expectations.iter().map(|it| (it.runs, it.value.value(), it.state)).collect();
    // 4 of the 17 runs of `pd` never settle, so the 16th best has no value.
    use lashloop_campaign::expectation::State::{Met, Missed};
    assert_eq!((judged[1].0, judged[1].1, judged[1].2), (17, None, Missed));
    assert_eq!((judged[2].0, judged[2].1, judged[2].2), (34, Some(29.0 / 34.0), Met));
    let largest =
        (22..34_u64).map(|case| ((case * 7919 % 1009) as f64 / 1009.0 - 0.25).abs()).fold(0.0, f64::max);
    assert_eq!((judged[0].0, judged[0].1), (12, Some(largest)));
    assert_eq!(report.verdict.to_string(), "FAIL");
    // What 0.85 leaves, not 1 - 0.85.
    let limits = Limits::new(&campaign, 0, 0).expect("limits");
    assert_eq!(limits.failures, Some(Limit::Max(0.15)));
}

/// What `merge` reports after `change` to two complete shards.
fn refusal(change: impl FnOnce(&Path, [Shard; 2])) -> String {
    let folder = tempdir().expect("a folder");
    run_all(&campaign(), folder.path(), 2);
    change(folder.path(), [1, 2].map(|number| Shard::new(number, 2).expect("a shard")));
    let error = merge(folder.path()).expect_err("no table");
    assert!(!folder.path().join(RESULTS).exists(), "{error}");
    error.to_string()
}

fn edit(path: &Path, edit: impl FnOnce(&str) -> String) {
    let text = fs::read_to_string(path).expect("a file");
    fs::write(path, edit(&text)).expect("the file");
}

#[test]
fn merge_refuses_what_is_not_one_campaign_and_names_the_shard() {
    let remove =
        |folder: &Path, [_, two]: [Shard; 2]| fs::remove_file(complete_path(folder, two)).expect("a file");
    assert!(refusal(remove).contains("shard 2/2 is missing"));
    let part = |folder: &Path, [one, _]: [Shard; 2]| {
        let path = complete_path(folder, one);
        fs::rename(&path, path.with_extension("csv.part")).expect("a file");
    };
    assert!(refusal(part).contains("shard 1/2 is incomplete"));
    for (from, to, what) in [
        (
            "\"program_sha256\": \"aa\"",
            "\"program_sha256\": \"ab\"",
            "program's SHA-256 is ab, that of shard 1/2 is aa",
        ),
        ("\"drive\": \"bb\"", "\"drive\": \"cc\"", "its drive is cc"),
        ("title = ", "title  = ", "campaign file's SHA-256"),
        ("duration_s = 25.0", "duration_s = 24.0", "scenarios' SHA-256"),
        ("\"seed\": 1", "\"seed\": 2", "its seed is 2"),
    ] {
        let change = |folder: &Path, [_, two]: [Shard; 2]| {
            edit(&facts_path(folder, two), |text| {
                assert!(text.contains(from), "{from}");
                text.replacen(from, to, 1)
            });
        };
        let error = refusal(change);
        assert!(error.contains(what) && error.contains("shard 2/2"), "{error}");
    }
    let lost =
        |folder: &Path, [_, two]: [Shard; 2]| fs::remove_file(facts_path(folder, two)).expect("a file");
    assert!(refusal(lost).contains("shard-2-of-2.json: is missing, so the campaign of its table is unknown"));
    let mixed = |folder: &Path, [one, _]: [Shard; 2]| {
        let third = Shard::new(1, 3).expect("a shard");
        fs::copy(complete_path(folder, one), complete_path(folder, third)).expect("a copy");
    };
    assert!(refusal(mixed).contains("number of shards"));
}

#[test]
fn merge_refuses_gaps_duplicates_and_half_lines() {
    let lines = |change: fn(&mut Vec<String>)| {
        refusal(|folder, [_, two]| {
            edit(&complete_path(folder, two), |text| {
                let mut lines: Vec<_> = text.split_inclusive('\n').map(str::to_owned).collect();
                change(&mut lines);
                lines.concat()
            });
        })
    };
    for (error, expected) in [
        (lines(|lines| drop(lines.remove(4))), "line 5: case 9, and case 7 is missing"),
        (lines(|lines| lines.insert(4, lines[3].clone())), "line 5: case 5 again, expected case 7"),
        (lines(|lines| drop(lines.pop())), "line 18: case 33 is missing"),
        (lines(|lines| lines.push("35,x\n".to_owned())), "line 19: a row after the last case"),
        (
            lines(|lines| {
                let _ = lines[17].pop();
            }),
            "line 18: the line has no end",
        ),
        (lines(|lines| lines[0] = "case\n".to_owned()), "header"),
    ] {
        assert!(error.contains(expected) && error.contains("shard 2/2"), "{expected}: {error}");
    }
    let folder = tempdir().expect("a folder");
    assert!(matches!(merge(folder.path()), Err(CampaignError::NoShards { .. })));
}

#[test]
fn two_programs_do_not_merge_in_one_folder() {
    let folder = tempdir().expect("a folder");
    let first = MergeLock::take(folder.path()).expect("a lock");
    let error = MergeLock::take(folder.path()).expect_err("a second merge").to_string();
    assert!(error.contains("is being written by another lashloop: wait for its end"), "{error}");
    drop(first);
    MergeLock::take(folder.path()).expect("the lock again");
}

#[test]
fn edited_number_of_a_row_is_refused_with_both_hashes() {
    let error = refusal(|folder, [_, two]| {
        edit(&complete_path(folder, two), |text| text.replacen("PASS", "FAIL", 1));
    });
    assert!(error.starts_with("shard 2/2: the SHA-256 of ") && error.contains("remove "), "{error}");
}

#[test]
fn shards_of_another_count_are_refused_before_a_run() {
    let (campaign, folder) = (campaign(), tempdir().expect("a folder"));
    run_all(&campaign, folder.path(), 3);
    let no_run = |case: u64| panic!("case {case} runs");
    let ended = run(&campaign, &facts(&campaign, 1), folder.path(), Shard::WHOLE, Start::New, no_run);
    let error = ended.expect_err("other shards").to_string();
    assert!(error.contains("its number of shards is 3, here it is 1"), "{error}");
    assert!(error.contains("another folder with --out"), "{error}");
}

/// Set in a child of the test, to the expected result.
const LIMITED: &str = "LASHLOOP_TEST_OPEN_FILES";

#[test]
fn merge_of_more_shards_than_open_files_raises_the_limit_or_names_it() {
    const SHARDS: u32 = 80;
    if let Ok(expected) = env::var(LIMITED) {
        let folder = tempdir().expect("a folder");
        run_all(&campaign(), folder.path(), SHARDS);
        match merge(folder.path()) {
            Ok(facts) => assert_eq!((facts.shards, &*expected), (SHARDS, "merged")),
            Err(error) => assert!(error.to_string().contains(&expected), "{error}"),
        }
        return;
    }
    for (limit, expected) in [("-Sn", "merged"), ("-n", "the limit of this user is 70; raise it")] {
        let mut child = Command::new("bash");
        let this = env::current_exe().expect("this program");
        let test = thread::current().name().expect("a name").to_owned();
        child.args(["-c", &format!("ulimit {limit} 70; exec \"$0\" --exact \"$1\"")]).arg(this).arg(test);
        let output = child.env(LIMITED, expected).output().expect("the child");
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && text.contains("1 passed"), "{limit}: {text}");
    }
}

#[test]
fn results_of_another_campaign_are_kept_and_not_continued() {
    let (campaign, folder) = (campaign(), tempdir().expect("a folder"));
    run_all(&campaign, folder.path(), 1);
    let before = fs::read(complete_path(folder.path(), Shard::WHOLE)).expect("a table");
    let same = facts(&campaign, 1);
    let again = |facts: &Facts, start| run(&campaign, facts, folder.path(), Shard::WHOLE, start, |_| Ok(()));
    let error = again(&same, Start::New).expect_err("results are there").to_string();
    assert!(error.contains("already holds results: resume with --resume"), "{error}");
    let other = Facts { seed: 2, ..same };
    let error = again(&other, Start::Resume).expect_err("another seed").to_string();
    assert!(error.contains("its seed is 1, here it is 2"), "{error}");
    assert_eq!(fs::read(complete_path(folder.path(), Shard::WHOLE)).expect("a table"), before);
}
