//! Records from others: what they name is neither followed, opened nor started unasked, and no text of theirs controls a terminal.

use std::fs;
use std::os::unix::fs::{FileTypeExt, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};

use crate::diff::Runs;
use crate::support::{LASHLOOP, root, text};

/// Clears a terminal, sets its title and colour, and reverses the direction of the text.
const EVIL: &str = "\u{1b}[2J\u{1b}]0;x\u{7}\u{9b}31m\u{202e}";

fn called(arguments: &[&str]) -> (Option<i32>, String) {
    // From the tool of the system: a program that hangs is a failure, and not the end of the tests.
    let ended = Command::new("timeout").arg("60").arg(LASHLOOP).args(arguments).output().unwrap();
    (ended.status.code(), format!("{}{}", text(&ended.stdout), text(&ended.stderr)))
}

fn path(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Appends the evil text to every text with one of these keys, or in lists under them.
fn poison(value: &mut Value, keys: &[&str], here: bool) {
    match value {
        Value::String(text) if here => text.push_str(EVIL),
        Value::Array(items) => items.iter_mut().for_each(|item| poison(item, keys, here)),
        Value::Object(fields) => {
            fields.iter_mut().for_each(|(key, value)| poison(value, keys, keys.contains(&&**key)));
        }
        _ => {}
    }
}

fn change(file: &Path, change: impl FnOnce(&mut Value)) {
    let mut value = serde_json::from_slice(&fs::read(file).unwrap()).unwrap();
    change(&mut value);
    fs::write(file, value.to_string()).unwrap();
}

#[test]
fn texts_of_a_record_control_no_terminal() {
    let runs = Runs::new();
    let (good, evil) = (runs.run("a", &[]), runs.run("b", &[]));
    let keys = [
        "name",
        "path",
        "device_description",
        "command_line",
        "working_directory",
        "started",
        "key",
        "value",
        "was",
        "kernel",
        "cpu",
        "firmware",
        "firmware_build",
        "bench_build",
        "warnings",
        "unit",
        "device",
        "scenario",
        "controller",
        "end",
        "signals",
    ];
    for file in ["record.json", "summary.json"] {
        change(&evil.join(file), |it| poison(it, &keys, false));
    }
    let scenario = evil.join("scenario.toml");
    let toml = fs::read_to_string(&scenario).unwrap();
    let (_, rest) = toml.split_once('\n').unwrap();
    fs::write(&scenario, format!("title = \"\\u001B[2J\\u009B31m\\u202E\"\n{rest}")).unwrap();
    let [good, evil, scenario] = [&good, &evil, &scenario].map(|it| path(it));
    let out = runs.folder("out");
    let mut readable = 0;
    for arguments in [
        vec!["diff", good, evil],
        vec!["diff", good, evil, "--json"],
        vec!["report", evil],
        vec!["plot", evil, "--signal", "no_such"],
        vec!["export", evil, "--to", "csv"],
        vec!["replay", evil, "--device", "inproc"],
        vec!["replay", evil, "--device", "inproc", "--json"],
        vec!["rerun", evil],
        vec!["rerun", evil, "--device", "inproc"],
        vec!["show", scenario],
        vec!["run", scenario, "--device", "inproc", "--out", path(&out)],
        vec!["run", scenario, "--device", "inproc", "--json"],
    ] {
        let (code, printed) = called(&arguments);
        let is_control =
            |c: char| (c.is_control() && !"\n\t".contains(c)) || ('\u{202a}'..='\u{202e}').contains(&c);
        assert!(!printed.contains(is_control), "{arguments:?}: {printed:?}");
        readable += usize::from(matches!(code, Some(0 | 1)));
        if arguments.contains(&"--json") && code != Some(2) {
            let whole: Value = serde_json::from_str(&printed).unwrap_or_else(|it| panic!("{it}: {printed}"));
            assert!(whole.is_object());
        }
    }
    assert!(readable >= 8, "{readable} commands have read the record");
}

fn pipe(path: &Path) {
    let _ = fs::remove_file(path);
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

#[test]
fn default_outputs_follow_no_link_of_a_record() {
    let runs = Runs::new();
    let record = runs.run("a", &[]);
    let victim = runs.folder("victim");
    let outputs: [(&[&str], &str); 5] = [
        (&["report"], "report.html"),
        (&["plot"], "record.svg"),
        (&["export", "--to", "csv"], "export.csv"),
        (&["export", "--to", "mcap"], "export.mcap"),
        (&["export", "--to", "mf4"], "export.mf4"),
    ];
    for (command, name) in outputs {
        let output = record.join(name);
        for is_link in [true, false] {
            fs::write(&victim, "kept").unwrap();
            let _ = fs::remove_file(&output);
            if is_link {
                symlink(&victim, &output).unwrap();
            } else {
                pipe(&output);
            }
            let (code, printed) = called(&[&command[..1], &[path(&record)], &command[1..]].concat());
            assert_eq!(code, Some(0), "{command:?}: {printed}");
            assert_eq!(fs::read_to_string(&victim).unwrap(), "kept", "{command:?}");
            assert!(fs::symlink_metadata(&output).unwrap().is_file(), "{command:?}");
        }
    }
    // A name that the user gives is the user's: a link there stays.
    let chosen = runs.folder("chosen.html");
    symlink(&victim, &chosen).unwrap();
    let (code, printed) = called(&["report", path(&record), "--out", path(&chosen)]);
    assert_eq!(code, Some(0), "{printed}");
    assert!(fs::symlink_metadata(&chosen).unwrap().is_symlink() && fs::read(&victim).unwrap().len() > 1000);
}

#[test]
fn a_pipe_in_the_place_of_a_file_ends_in_an_error() {
    let runs = Runs::new();
    let scenario = root().join("scenarios/smooth-after.toml");
    let good = runs.run("good", &[]);
    for name in ["record.json", "run.mcap", "summary.json", "scenario.toml"] {
        let record = runs.folder(&format!("of-{name}"));
        fs::create_dir(&record).unwrap();
        for file in ["record.json", "run.mcap", "summary.json", "scenario.toml"] {
            fs::copy(good.join(file), record.join(file)).unwrap();
        }
        pipe(&record.join(name));
        let [good, record] = [&good, &record].map(|it| path(it));
        for arguments in
            [vec!["diff", good, record], vec!["rerun", record], vec!["replay", record, "--device", "inproc"]]
        {
            let (code, printed) = called(&arguments);
            assert_eq!(code, Some(2), "{arguments:?}: {printed}");
            assert!(printed.contains(name) && printed.contains("pipe"), "{arguments:?}: {printed}");
        }
    }
    let at = |name: &str| {
        let place = runs.folder(name);
        pipe(&place);
        place
    };
    let [csv, capture, toml, parameters, elf] = ["a.csv", "a.pcapng", "a.toml", "p.toml", "a.elf"].map(at);
    let estimates = format!("--gate={}", at("estimates.json").display());
    let reference = format!("reference={{ file = \"{}\" }}", at("reference.csv").display());
    for arguments in [
        vec!["plot", path(&csv)],
        vec!["plot", path(&capture)],
        vec!["decode", path(&capture)],
        vec!["show", path(&toml)],
        vec!["test", path(&toml)],
        vec!["campaign", "run", path(&toml), "--out", path(&runs.folder("campaign"))],
        vec!["doctor", "--rig", path(&toml)],
        vec!["parameters", "restore", path(&parameters), "--device", "inproc"],
        vec!["flash", path(&elf), "--board", "f405-bare"],
        vec!["run", path(&scenario), "--device", "inproc", &estimates],
        vec!["run", path(&scenario), "--device", "inproc", "--set", &reference],
        vec!["run", path(&scenario), "--device", &format!("qemu:{}", elf.display())],
    ] {
        let (code, printed) = called(&arguments);
        assert!(matches!(code, Some(1..=5)), "{arguments:?}: {code:?} {printed}");
    }
    assert!(fs::symlink_metadata(&csv).unwrap().file_type().is_fifo(), "the pipe stays");
}

#[test]
fn a_record_reaches_no_address_and_starts_no_program_unasked() {
    let runs = Runs::new();
    let record = runs.run("a", &[]);
    for device in
        ["tcp:127.0.0.1:1", "rfc2217:127.0.0.1:1", "/dev/ttyNONE0", "qemu:evil.elf", "exec:touch evil"]
    {
        change(&record.join("record.json"), |it| it["device"] = json!(device));
        let (code, printed) = called(&["rerun", path(&record)]);
        assert_eq!(code, Some(2), "{device}: {printed}");
        assert!(printed.contains("--device") && printed.contains(device), "{printed}");
    }
    // With consent it is tried.
    change(&record.join("record.json"), |it| it["device"] = json!("tcp:127.0.0.1:1"));
    assert_eq!(called(&["rerun", path(&record), "--trust"]).0, Some(4));
    change(&record.join("record.json"), |it| it["device"] = json!("inproc"));
    let (mark, scenario): (PathBuf, _) = (runs.folder("started"), record.join("scenario.toml"));
    let settings = fs::read_to_string(&scenario).unwrap();
    let (before, rest) = settings.split_once("[plant]").unwrap();
    let (_, after) = rest.split_once("\n[").unwrap();
    let plant = format!("[plant]\nmodel = \"process\"\ncommand = [\"touch\", \"{}\"]\n\n[", mark.display());
    fs::write(&scenario, format!("{before}{plant}{after}")).unwrap();
    let (code, printed) = called(&["rerun", path(&record)]);
    assert_eq!((code, mark.exists()), (Some(2), false), "{printed}");
    assert!(printed.contains("--trust"), "{printed}");
    let _ = called(&["rerun", path(&record), "--trust"]);
    assert!(mark.exists(), "with consent it is started");
}
