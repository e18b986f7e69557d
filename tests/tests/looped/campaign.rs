//! `lashloop campaign`: shards, kills, a full disk, reruns.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

use rustix::process::Signal;
use tests::program::{self, Ended, Running, lashloop};
use tests::records::Records;
use tests::wait;

const SMALL: &str = "campaign run campaigns/small.toml --points 4";

fn run(line: &str) -> Ended {
    program::run(line.split_whitespace())
}

fn results(records: &Records) -> String {
    fs::read_to_string(records.path("results.csv")).expect("results.csv")
}

/// The results of the campaign in one piece.
fn whole(line: &str) -> (Records, Ended) {
    let records = Records::new();
    let ended = run(&format!("{line} --out {}", records.out()));
    (records, ended)
}

#[test]
fn shards_of_parallel_programs_merge_to_the_results_of_one() {
    let (one, ended) = whole(&format!("{SMALL} --jobs 1").replacen(" run", "", 1));
    let ended = ended.with_code(0);
    assert!(ended.stdout.ends_with("PASS\n"), "{}", ended.stdout);
    assert!(ended.stderr.contains("runs per second and core"), "{}", ended.stderr);
    let shards = Records::new();
    // The recipe of docs/campaigns.md; again, it runs nothing.
    let recipe = format!(
        "seq 3 | xargs -P 2 -I {{}} {} {SMALL} --shard {{}}/3 --jobs 1 --out {} --resume",
        lashloop().display(),
        shards.out()
    );
    for _ in 0..2 {
        let mut xargs = Command::new("sh");
        xargs.args(["-c", &recipe]);
        let _ = Running::start_command(xargs).wait().with_code(0);
    }
    let merged = run(&format!("campaign merge {}", shards.out())).with_code(0);
    assert_eq!(merged.stdout, ended.stdout);
    assert_eq!(results(&shards), results(&one));
    assert_eq!(results(&one).lines().count(), 9);
    // The pages differ in the folder that their commands name, and in the value that permits their script.
    let page = |records: &Records| {
        let text = fs::read_to_string(records.path("report.html")).expect("report.html");
        let main = text.split_once("<main>").and_then(|(_, rest)| rest.split_once("</main>"));
        main.expect("a page").0.replace(&records.out(), "DIR")
    };
    let first = page(&one);
    assert!(page(&shards) == first, "the pages differ");
    fs::remove_file(one.path("report.html")).expect("a page");
    let _ = run(&format!("report {}", one.out())).with_code(0);
    assert!(page(&one) == first, "the page written again differs");
    // The worst run, in the records of both.
    for records in [&one, &shards] {
        let kept = fs::read_dir(records.path("evidence")).expect("evidence").count();
        assert!(kept >= 1, "{kept} records");
    }
}

#[test]
fn row_that_is_run_again_has_the_same_torques_and_an_altered_one_is_refused() {
    let (records, _) = whole(&format!("{SMALL} --variant braking-curve"));
    let table = records.path("results.csv");
    let again = Records::new();
    let line = format!("campaign rerun {} --case 2 --out {}", table.display(), again.out());
    let ended = run(&line).with_code(0);
    let text = results(&records);
    let digest = text.lines().nth(3).and_then(|row| row.rsplit(',').next()).expect("a digest").to_owned();
    assert!(ended.stdout.contains(&digest), "{}", ended.stdout);
    assert_eq!(again.summary()["torque_sha256"], digest.as_str());
    let altered = text.replace(&digest, &digest.chars().rev().collect::<String>());
    fs::write(&table, altered).expect("the table");
    let ended = run(&format!("campaign rerun {} --case 2", records.out())).with_code(1);
    assert!(ended.stderr.contains("case 2: torque digest"), "{}", ended.stderr);
}

const ONE: &str = "campaign run campaigns/small.toml --points 1 --variant braking-curve";

#[test]
fn rerun_into_a_folder_replaces_no_file_of_the_user() {
    let (records, ended) = whole(&format!("{ONE} --jobs 3"));
    assert!(ended.stderr.contains(" s, 1 at a time: "), "{}", ended.stderr);
    let table = results(&records);
    let again = Records::new();
    fs::write(again.path("thesis.txt"), "x").expect("a file");
    let line = format!("campaign rerun {} --case 0 --out", records.out());
    let _ = run(&format!("{line} {}", again.out())).with_code(0);
    assert_eq!(fs::read_to_string(again.path("thesis.txt")).expect("the file"), "x");
    let taken = run(&format!("{line} {}", again.out())).with_code(2);
    assert!(taken.stderr.contains("the folder holds a record"), "{}", taken.stderr);
    let _ = run(&format!("{line} {} --force", again.out())).with_code(0);
    let itself = run(&format!("{line} {} --force", records.out())).with_code(2);
    assert!(itself.stderr.contains("has report.html and no record"), "{}", itself.stderr);
    assert_eq!(results(&records), table);
    assert!(records.path("shard-1-of-1.csv").exists());
}

#[test]
fn edited_number_of_the_results_is_found_by_running_its_row_again() {
    let (records, _) = whole(ONE);
    let table = results(&records);
    let fields = |line: usize| table.lines().nth(line).expect("a line").split(',').collect::<Vec<_>>();
    let place = fields(0).iter().position(|name| *name == "settle_time_s").expect("a column");
    fs::write(records.path("results.csv"), table.replacen(fields(1)[place], "0.001", 1)).expect("the table");
    let ended = run(&format!("campaign rerun {} --case 0", records.out())).with_code(1);
    assert!(
        ended.stderr.contains("case 0: settle_time_s") && ended.stderr.contains("\"0.001\""),
        "{}",
        ended.stderr
    );
}

#[test]
fn merge_that_fails_leaves_no_mark_of_an_earlier_one() {
    let (records, _) = whole(ONE);
    assert!(records.path("report.json").exists() && records.path("report.txt").exists());
    // What a killed merge leaves.
    fs::write(records.path(".results-aBcDeF"), "case").expect("a temporary file");
    fs::write(records.path("shard-1-of-1.csv"), "case\n").expect("a damaged shard");
    let merge = format!("campaign merge {}", records.out());
    let ended = run(&merge).with_code(2);
    assert!(ended.stderr.contains("case 0 is missing"), "{}", ended.stderr);
    let has_any = |names: &[&str]| names.iter().any(|name| records.path(name).exists());
    assert!(!has_any(&["report.json", "report.txt", ".results-aBcDeF"]));
    fs::write(records.path("report.json"), "{}").expect("a report");
    fs::remove_file(records.path("shard-1-of-1.json")).expect("facts");
    let ended = run(&merge).with_code(2);
    assert!(ended.stderr.contains("shard-1-of-1.json: is missing"), "{}", ended.stderr);
    assert!(!has_any(&["report.json"]));
}

/// The stand-in of `sbatch` kills the command that calls it, once the queue has the job.
#[test]
fn job_of_a_killed_submit_is_not_submitted_again() {
    let (records, commands) = (Records::new(), tempfile::tempdir().expect("a folder"));
    let queue = commands.path().join("queue").display().to_string();
    for (name, script) in [
        ("squeue", format!("cat {queue}")),
        (
            "sbatch",
            format!(
                "for script; do :; done\nif [ -s {queue} ]; then echo \"$@\" >>{queue}.more; echo 8; exit; fi\n\
                 echo \"7 1 RUNNING $script\" >{queue}; kill -9 $PPID"
            ),
        ),
    ] {
        let path = commands.path().join(name);
        fs::write(&path, format!("#!/bin/sh\n{script}\n")).expect("a command");
        fs::set_permissions(&path, PermissionsExt::from_mode(0o755)).expect("a program");
    }
    fs::write(&queue, "").expect("a queue");
    let submit = || {
        let mut command = Command::new(lashloop());
        let line = format!("{ONE} --slurm --shards 1 --out {}", records.out()).replacen("run", "submit", 1);
        let path = format!("{}:{}", commands.path().display(), std::env::var("PATH").expect("a path"));
        command.args(line.split_whitespace()).env("PATH", path);
        Running::start_command(command).wait()
    };
    assert_eq!(submit().code, None);
    let again = submit().with_code(0);
    assert_eq!(again.stdout.lines().next(), Some("job 8: merge, after the last shard"), "{}", again.stdout);
    let more = fs::read_to_string(format!("{queue}.more")).expect("a submission");
    assert!(more.contains("--dependency=afterany:7 ") && more.lines().count() == 1, "{more}");
}

/// No scheduler is needed to refuse.
#[test]
fn submit_refuses_a_folder_with_shards_of_another_campaign() {
    let (records, _) = whole(ONE);
    let submit = ONE.replacen("run", "submit", 1);
    let line = format!("{submit} --slurm --shards 1 --out {}", records.out());
    for (options, what) in
        [("--seed 5", "another seed: 1, here it is 5"), ("--device native", "another device")]
    {
        let ended = run(&format!("{line} {options}")).with_code(2);
        assert!(ended.stderr.contains(what), "{}", ended.stderr);
    }
    let two = format!("{submit} --variant backlash-inverse --slurm --shards 2 --out {}", records.out());
    let ended = run(&two).with_code(2);
    assert!(ended.stderr.contains("another number of shards: 1, here it is 2"), "{}", ended.stderr);
}

#[test]
fn dry_run_prints_the_scripts_and_creates_nothing() {
    let folder = Records::new();
    let out = folder.path("new");
    let line =
        format!("{SMALL} --slurm --shards 3 --dry-run --out {}", out.display()).replacen("run", "submit", 1);
    let ended = run(&line).with_code(0);
    for part in ["#SBATCH --array=1-3\n", "/new/slurm/shards.sh\n", "/new/slurm/merge.sh\n", "campaign merge"]
    {
        assert!(ended.stdout.contains(part), "{part}: {}", ended.stdout);
    }
    assert!(!out.exists());
}

#[test]
fn failures_without_a_record_are_counted() {
    let line = ONE.replace("--points 1", "--points 4");
    let (records, ended) = whole(&format!("{line} --set expect.0.max=0.1"));
    // The worst one, and the first two.
    let kept = fs::read_dir(records.path("evidence")).expect("evidence").count();
    let expected = format!("{} of 4 failures have no record; ", 4 - kept);
    let report = fs::read_to_string(records.path("report.txt")).expect("a report");
    assert!(report.contains(&expected), "{kept} records: {report}");
    assert!(ended.stderr.contains(&expected), "{}", ended.stderr);
}

const LONG: &str = "campaign run campaigns/small.toml --points 10 --jobs 1";

fn part(records: &Records) -> String {
    fs::read_to_string(records.path("shard-1-of-1.csv.part")).unwrap_or_default()
}

#[test]
fn killed_campaign_resumes_to_the_same_results() {
    let (expected, _) = whole(LONG);
    let records = Records::new();
    let line = format!("{LONG} --out {}", records.out());
    let running = Running::start(line.split_whitespace());
    wait::until("rows", || (part(&records).lines().count() > 3).then_some(()));
    running.signal(Signal::KILL);
    assert_eq!(running.wait().code, None);
    assert!(!records.path("results.csv").exists());
    let rows = part(&records).matches('\n').count() - 1;
    let ended = run(&format!("{line} --resume")).with_code(0);
    assert!(ended.stderr.contains(&format!("{rows} of 20 runs restored")), "{}", ended.stderr);
    assert_eq!(results(&records), results(&expected));
}

#[test]
fn interrupted_campaign_keeps_its_rows() {
    let records = Records::new();
    let line = format!("{LONG} --out {}", records.out());
    let running = Running::start(line.split_whitespace());
    wait::until("rows", || (part(&records).lines().count() > 3).then_some(()));
    running.signal(Signal::INT);
    let ended = running.wait().with_code(3);
    assert!(ended.stdout.starts_with("interrupted: "), "{}", ended.stdout);
    assert!(ended.stdout.ends_with("resume with --resume\n"), "{}", ended.stdout);
    assert!(part(&records).ends_with('\n'));
}

/// A limit on the size of files stands in for a disk without space: both fail a write in the middle of a row.
#[test]
fn full_disk_ends_a_campaign_that_resumes_once_there_is_space() {
    let (expected, _) = whole(LONG);
    let records = Records::new();
    let line = format!("{LONG} --out {}", records.out());
    let mut limited = Command::new("bash");
    // In KiB; the facts are smaller than the table of 20 runs. An ignored signal leaves the error of the write.
    limited.args(["-c", &format!("trap '' XFSZ; ulimit -f 8; exec {} {line}", lashloop().display())]);
    let ended = Running::start_command(limited).wait().with_code(2);
    assert!(ended.stderr.contains("shard-1-of-1.csv.part: can't be written"), "{}", ended.stderr);
    let rows = part(&records).matches('\n').count() - 1;
    assert!((1..20).contains(&rows) && part(&records).ends_with('\n'), "{rows} rows");
    let ended = run(&format!("{line} --resume")).with_code(0);
    assert!(ended.stderr.contains(&format!("{rows} of 20 runs restored")), "{}", ended.stderr);
    assert_eq!(results(&records), results(&expected));
}

#[test]
fn a_drive_of_another_process_gives_the_rows_of_the_drive_in_process() {
    let line = format!("{SMALL} --variant pd --points 1").replace("pd", "braking-curve");
    let line = line.replacen("--points 4 ", "", 1);
    let (inproc, native) = (whole(&line).0, whole(&format!("{line} --device native")).0);
    assert_eq!(results(&inproc), results(&native));
}

#[test]
fn shard_comes_from_the_environment_of_a_scheduler() {
    let records = Records::new();
    let mut task = Command::new(lashloop());
    task.args(format!("{SMALL} --shard auto --out {}", records.out()).split_whitespace());
    task.envs([("SLURM_ARRAY_TASK_ID", "8"), ("SLURM_ARRAY_TASK_MIN", "5"), ("SLURM_ARRAY_TASK_COUNT", "8")]);
    let ended = Running::start_command(task).wait().with_code(0);
    assert!(ended.stdout.starts_with("shard 4/8 is complete: 1 run;"), "{}", ended.stdout);
    let table = fs::read_to_string(records.path("shard-4-of-8.csv")).expect("the shard");
    assert!(table.lines().nth(1).is_some_and(|row| row.starts_with("3,plants,1,braking-curve,")), "{table}");
}

#[test]
fn wrong_campaigns_are_refused_with_the_remedy() {
    let (serial, absent) = ("--device /dev/ttyUSB0 --jobs 2", Path::new("no-such.toml"));
    for (line, expected) in [
        (format!("campaign run {}", absent.display()), "no-such.toml: can't be read"),
        (format!("{SMALL} --shard 4/3 --out x"), "expected K/N with 1 <= K <= N"),
        (format!("{SMALL} --shard 1/3"), "--out"),
        (format!("{SMALL} --shard auto --out x"), "no scheduler is there"),
        (format!("{SMALL} --variant lqr"), "has no variant lqr; it has backlash-inverse, braking-curve"),
        (format!("{SMALL} --set plant.dead_zone_rad=1"), "varies the key of --set"),
        (format!("{SMALL} {serial}"), "--jobs 2 needs as many drives"),
        (
            "campaign small --out x".to_owned(),
            "small: is neither a command of `lashloop campaign`, see --help, nor a campaign file",
        ),
        ("campaign show campaigns".to_owned(), "is a folder; name a file in it"),
        ("campaign show campaigns/small.toml --case 20".to_owned(), "has cases 0 to 19"),
        ("campaign merge campaigns".to_owned(), "holds no shard of a campaign"),
    ] {
        let ended = run(&line).with_code(2);
        assert!(ended.stderr.contains(expected), "{line}: {}", ended.stderr);
        assert_eq!(ended.stdout, "", "{line}");
    }
}
