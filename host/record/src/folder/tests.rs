use super::*;

const MANIFEST: &str = r#"{"format": 2}"#;

fn claim(path: &Path, force: bool) -> Result<RecordFolder, String> {
    RecordFolder::claim(path, force).map_err(|error| error.to_string())
}

/// Files in a folder, by name.
fn files(path: &Path) -> Vec<String> {
    let entries = fs::read_dir(path).expect("the folder").map(|entry| entry.expect("an entry"));
    let mut names: Vec<_> = entries.map(|entry| entry.file_name().into_string().expect("UTF-8")).collect();
    names.sort();
    names
}

/// Writes these files as the start of a record.
fn begin(folder: &RecordFolder, names: &[&str]) -> Result<(), WriteError> {
    folder.begin(|new| {
        for name in names {
            let text = if *name == MANIFEST_FILE { MANIFEST } else { "new" };
            fs::write(new.join(name), text).expect("a file");
        }
        Ok(())
    })
}

#[test]
fn a_record_is_replaced_only_by_force() {
    let parent = tempfile::tempdir().expect("a folder");
    let path = parent.path().join("a/b");
    drop(claim(&path, false).expect("a new folder"));
    fs::write(path.join("notes.txt"), "mine").expect("a file");
    drop(claim(&path, false).expect("a folder without a record"));
    for name in ["record.json", "run.mcap", "record.svg", "comparison.html", "export.csv", "summary.json"] {
        fs::write(path.join(name), MANIFEST).expect("a file");
    }
    let refused = claim(&path, false).expect_err("a record");
    assert!(refused.contains("(record.json)") && refused.contains("--force"), "{refused}");
    let claimed = claim(&path, true).expect("by force");
    assert!(path.join("run.mcap").exists(), "the record stays until the run begins");
    begin(&claimed, &["run.mcap", "record.json"]).expect("a begin");
    assert_eq!(files(&path), ["notes.txt", "record.json", "run.mcap"], "other files stay");
    assert_eq!(fs::read_to_string(path.join("run.mcap")).expect("samples"), "new");
}

#[test]
fn a_begin_that_fails_leaves_the_old_record_whole() {
    let parent = tempfile::tempdir().expect("a folder");
    let path = parent.path();
    for name in ["run.mcap", "record.json", "report.html"] {
        fs::write(path.join(name), MANIFEST).expect("a file");
    }
    let claimed = claim(path, true).expect("by force");
    let full = |new: &Path| {
        fs::write(new.join("run.mcap"), "new").expect("a file");
        let source = io::Error::from(ErrorKind::StorageFull);
        Err::<(), _>(WriteError { path: new.join("scenario.toml"), action: "written", source })
    };
    let error = claimed.begin(full).expect_err("a full disk");
    assert_eq!(error.path, path.join("scenario.toml"), "the name that the user knows");
    assert_eq!(files(path), ["record.json", "report.html", "run.mcap"]);
    assert_eq!(fs::read_to_string(path.join("run.mcap")).expect("samples"), MANIFEST);
}

#[test]
fn a_begin_that_was_killed_between_its_renames_blocks_no_folder() {
    let parent = tempfile::tempdir().expect("a folder");
    let path = parent.path();
    fs::create_dir(path.join(NEW)).expect("a folder");
    for name in ["run.mcap", "scenario.toml", ".new/record.json"] {
        fs::write(path.join(name), MANIFEST).expect("a file");
    }
    let refused = claim(path, false).expect_err("a record without a step");
    assert!(refused.contains("(record.json)"), "{refused}");
    assert_eq!(files(path), ["record.json", "run.mcap", "scenario.toml"]);
    begin(&claim(path, true).expect("by force"), &["run.mcap", "record.json"]).expect("a begin");
    assert_eq!(files(path), ["record.json", "run.mcap"]);
}

#[test]
fn a_table_that_the_recorded_scenario_does_not_name_is_of_the_user() {
    for (scenario, is_of_record) in [("", false), ("[reference]\nfile = \"reference.csv\"\n", true)] {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path();
        for (name, text) in
            [("record.json", MANIFEST), ("scenario.toml", scenario), ("reference.csv", "by hand")]
        {
            fs::write(path.join(name), text).expect("a file");
        }
        if !is_of_record {
            let begun = begin(&claim(path, true).expect("by force"), &["reference.csv", "record.json"]);
            assert!(begun.expect_err("in the way").to_string().contains("reference.csv"));
        }
        begin(&claim(path, true).expect("by force"), &["record.json"]).expect("a begin");
        assert_eq!(path.join("reference.csv").exists(), !is_of_record);
    }
}

#[test]
fn files_of_the_user_are_never_replaced() {
    for (name, other) in [
        ("scenario.toml", None),
        ("reference.csv", Some("summary.json")),
        ("report.html", None),
        ("record.json", None),
        ("summary.json", Some("run.mcap")),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path();
        fs::write(path.join(name), "by hand").expect("a file");
        other.map_or(Ok(()), |other| fs::write(path.join(other), "by hand")).expect("a file");
        for force in [false, true] {
            let refused = claim(path, force).expect_err("a file of the user");
            let names_it = refused.contains(name) || other.is_some_and(|other| refused.contains(other));
            assert!(names_it && refused.contains("another folder"), "{refused}");
        }
        fs::write(path.join("record.json"), MANIFEST).expect("a manifest");
        claim(path, true).expect("files of a record");
    }
}

#[test]
fn a_scenario_that_is_run_is_never_replaced() {
    let parent = tempfile::tempdir().expect("a folder");
    let folder = claim(&parent.path().join("q"), true).expect("a folder");
    let scenario = parent.path().join("q/../q/scenario.toml");
    let refused = folder.check_source(&scenario).expect_err("its own scenario").to_string();
    assert!(refused.contains("its own scenario"), "{refused}");
    folder.check_source(&parent.path().join("scenario.toml")).expect("a scenario elsewhere");
    folder.check_source(&parent.path().join("q/mine.toml")).expect("a name that no record has");
}

#[test]
fn a_folder_takes_one_run_at_a_time() {
    let parent = tempfile::tempdir().expect("a folder");
    let first = claim(parent.path(), false).expect("a folder");
    let refused = claim(parent.path(), true).expect_err("in use");
    assert!(refused.contains("another lashloop"), "{refused}");
    drop(first);
    let waiting = claim(parent.path(), false).expect("a released folder");
    // A copy, or a process on a file system without locks, may come first.
    fs::write(parent.path().join("record.json"), MANIFEST).expect("a manifest");
    let error = begin(&waiting, &["run.mcap"]).expect_err("a record since").to_string();
    assert!(error.contains("record.json is there since"), "{error}");
    assert_eq!(files(parent.path()), ["record.json"]);
}

#[test]
fn an_output_replaces_no_file_of_a_record() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    RecordFolder::check_output(&at("run.mcap")).expect("no record is there");
    fs::write(at("record.json"), MANIFEST).expect("a manifest");
    let refused = RecordFolder::check_output(&at("run.mcap")).expect_err("the samples").to_string();
    assert!(refused.contains("run.mcap") && refused.contains("another file"), "{refused}");
    RecordFolder::check_output(&at("report.html")).expect("derived");
}

#[test]
fn latest_points_to_the_last_record_and_replaces_no_folder() {
    let parent = tempfile::tempdir().expect("a folder");
    let claim = |name: &str| RecordFolder::claim(&parent.path().join(name), false).expect("a folder");
    for name in ["first", "second"] {
        claim(name).link_latest().expect("a link");
        assert_eq!(fs::read_link(parent.path().join(LATEST)).expect("a link"), Path::new(name));
    }
    fs::remove_file(parent.path().join(LATEST)).expect("no link");
    claim(LATEST).link_latest().expect("nothing to do");
    claim("third").link_latest().expect("nothing to do");
    assert!(parent.path().join(LATEST).is_dir() && !parent.path().join(LATEST).is_symlink());
}
