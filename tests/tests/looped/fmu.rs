//! Plants of `plant.model = "fmu"`: one C file as an FMU of FMI 2.0 and 3.0.

use std::fs;
use std::time::{Duration, Instant};

use tests::fmu::{FmuFolder, LINUX, PLANT, START, difference_rad};
use tests::program;
use tests::records::Records;

/// The error of a run with these lines in `[plant]` and after `[plant.start]`, which must come soon.
/// An FMU that fails at its start leaves no record, which begins with the first step.
fn error(fmu: &FmuFolder, plant: &str, start: &str) -> String {
    let records = Records::new();
    let began = Instant::now();
    let ended = fmu.run(&format!("{plant}{START}{start}"), 0.1, &records, &[]).with_code(2);
    assert!(began.elapsed() < Duration::from_secs(20), "{:?}", began.elapsed());
    fmu.check_nothing_is_left();
    assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
    ended.stderr
}

#[test]
fn an_fmu_moves_as_the_smooth_plant_does_and_repeats_bit_for_bit() {
    let smooth = Records::new();
    let fmu = FmuFolder::new("two", &LINUX);
    let _ = fmu.run("[plant]\nmodel = \"smooth\"\n", 3.0, &smooth, &[]).with_code(0);
    for description in ["two", "three"] {
        let fmu = FmuFolder::new(description, &LINUX);
        let runs = [(); 2].map(|()| Records::new());
        for records in &runs {
            let plant = format!("{PLANT}files = [\"scenario.toml\"]\n{START}");
            let _ = fmu.run(&plant, 3.0, records, &[]).with_code(0);
        }
        fmu.check_nothing_is_left();
        let [first, second] = [&runs[0], &runs[1]].map(|records| records.summary()["torque_sha256"].clone());
        assert_eq!(first, second, "{description}");
        let off_rad = difference_rad(&runs[0], &smooth);
        assert!(off_rad <= 1e-9, "{description}: {off_rad} rad");
        assert_eq!(runs[0].trace().column("steps").last(), Some(&2999.0));
        let manifest = runs[0].record().manifest;
        let hashed: Vec<_> =
            manifest.plant_files.iter().filter_map(|file| file.path.rsplit('/').next()).collect();
        assert_eq!(hashed, ["lashloop-fmu", "plant.fmu", "scenario.toml"]);
        let units: Vec<_> = manifest.plant_signals.iter().map(|it| (&*it.name, &*it.unit)).collect();
        assert_eq!(units, [("twist", "rad"), ("steps", "")]);
    }
}

#[test]
fn a_period_is_split_into_communication_steps_at_exact_times() {
    let fmu = FmuFolder::new("two", &LINUX);
    let records = Records::new();
    // The FMU compares the times with its own.
    let plant = format!("{PLANT}step_us = 100\n{START}only_step = 1e-4\nis_wet = true\nnote = \"dry\"\n");
    let delayed = ["--set", "line.delay_us=300"];
    let _ = fmu.run(&plant, 2.0, &records, &delayed).with_code(0);
    assert_eq!(records.trace().column("steps").last(), Some(&19_990.0));
}

#[test]
fn an_fmu_that_misbehaves_ends_the_run_with_one_sentence() {
    let fmu = FmuFolder::new("two", &LINUX);
    let small = format!("{PLANT}memory_limit_mib = 64\n");
    let fast = PLANT.replace("step_timeout_ms = 30000", "step_timeout_ms = 500");
    for (plant, start, want) in [
        (PLANT, "mode = 1\n", "the plant's process ended in the middle of the run: signal: 11"),
        (&*fast, "mode = 2\n", "wrote no line within 500 ms"),
        (PLANT, "mode = 3\n", "the FMU's variable \"motor.phi\" is NaN at t = 0.003 s"),
        (
            PLANT,
            "mode = 4\n",
            "the FMU refuses the step of 0.001 s at t = 0.002 s: fmi2DoStep answers \"discard\"",
        ),
        (PLANT, "mode = 5\n", "fmi2DoStep answers \"error\": the belt slips"),
        (
            PLANT,
            "mode = 10\n",
            "the FMU can't set \"torque\" at t = 0.002 s: fmi2SetReal answers \"error\"\n",
        ),
        (&*small, "mode = 6\n", "more than plant.memory_limit_mib = 64: it leaks, or needs a higher limit"),
        (PLANT, "only_step = 2e-3\n", "answers \"discard\": this step isn't the one it takes"),
    ] {
        let records = Records::new();
        let ended = fmu.run(&format!("{plant}{START}{start}"), 0.1, &records, &[]).with_code(2);
        // With the end of the line, the FMU's earlier messages aren't part of the error.
        assert!(ended.stderr.contains(want) && ended.stderr.lines().count() == 1, "{want}: {}", ended.stderr);
        fmu.check_nothing_is_left();
        let failure = records.record().failure.expect("why there is no summary").error;
        assert!(failure.contains(want.trim_end()), "{failure}");
    }
    for harmless in ["mode = 6\n", "mode = 7\n"] {
        let _ = fmu.run(&format!("{PLANT}{START}{harmless}"), 0.1, &Records::new(), &[]).with_code(0);
        fmu.check_nothing_is_left();
    }
    let fmu = FmuFolder::new("three", &LINUX);
    let have = error(&fmu, PLANT, "mode = 8\n");
    assert!(have.contains("the FMU ends the simulation at t = 0.002 s"), "{have}");
    let have = error(&fmu, PLANT, "mode = 11\n");
    assert!(
        have.contains("returns early from the step of 0.001 s at t = 0.002 s, at 0.0025 s, which"),
        "{have}"
    );
}

#[test]
fn what_does_not_fit_is_named_before_the_run() {
    let fmu = FmuFolder::new("two", &LINUX);
    let changed = |from: &str, to: &str| PLANT.replace(from, to);
    for (plant, start, want) in [
        (
            changed("\"motor.phi\"", "\"motor.ph\""),
            "",
            "no variable \"motor.ph\", which plant.motor_output names; it has \"motor.phi\"",
        ),
        (
            changed("\"load.phi\"", "\"steps\""),
            "",
            "\"steps\" is of type Integer, causality \"output\", and plant.load_output needs",
        ),
        (
            changed("\"torque\"", "\"stiffness\""),
            "",
            "and plant.torque_input needs an input of type Real or Float64 in N m",
        ),
        (PLANT.to_owned(), "mode = 1.5\n", "plant.start.mode is 1.5, and the variable is of type Integer"),
        (
            PLANT.to_owned(),
            "mode = 9\nstiffness = 2.0\n",
            "\"stiffness\" is 1 after its start value of 2; the FMU ignores plant.start.stiffness",
        ),
        (
            PLANT.to_owned(),
            "mode = 12\nstiffness = 2.0\n",
            "\"stiffness\" is NaN after its start value of 2; the FMU ignores plant.start.stiffness",
        ),
        (PLANT.to_owned(), "torque = 1.0\n", "plant.start.torque is the torque input, which the bench sets"),
        (
            format!("{PLANT}step_us = 300\n"),
            "",
            "the FMU takes steps of 0.0003 s, and 0.001 s isn't a multiple of it",
        ),
        (format!("{PLANT}files = [\"none.csv\"]\n"), "", "none.csv: No such file"),
        (
            format!("{PLANT}preload = [\"libnone.so.1\"]\n"),
            "",
            "libnone.so.1: cannot open shared object file",
        ),
    ] {
        let have = error(&fmu, &plant, start);
        assert!(have.contains(want), "have {have}\nwant {want}");
    }
    let records = Records::new();
    let have = fmu.run(PLANT, 0.1, &records, &[]).with_code(2).stderr;
    assert!(
        have.contains("starts with motor_position_rad = 0, and plant.initial.motor_position_rad is 4.71"),
        "{have}"
    );
    let moving = ["--set", "plant.initial.load_velocity_rad_s=1"];
    let have = fmu.run(&format!("{PLANT}{START}"), 0.1, &records, &moving).with_code(2).stderr;
    assert!(have.contains("plant.initial has a velocity, and an FMU starts as plant.start says"), "{have}");
}

#[test]
fn archives_that_cannot_run_here_are_refused_with_a_remedy() {
    let windows = FmuFolder::new("two", &["binaries/win64/plant.dll"]);
    let have = error(&windows, PLANT, "");
    assert!(
        have.contains("the FMU has binaries for win64, and none for linux64; export it on Linux"),
        "{have}"
    );

    let fmu = FmuFolder::new("two", &LINUX);
    let two = fs::read_to_string(tests::workspace().join("tests/data/fmu/two.xml")).expect("a description");
    let line = two.lines().find(|line| line.contains("<CoSimulation")).expect("its line");
    let fixed = two.replace("canHandleVariableCommunicationStepSize=\"true\"", "");
    let exchange = two.replace(line, "");
    let of_one = two.replace("fmiVersion=\"2.0\"", "fmiVersion=\"1.0\"");
    let named = "modelDescription.xml";
    let library = fs::read(fmu.path("plant.so")).expect("the library");
    for (entries, want) in [
        (vec![(named, exchange.as_bytes())], "is for model exchange only, and lashloop-fmu has no solver"),
        (vec![(named, of_one.as_bytes())], "is of FMI 1.0, and lashloop-fmu takes 2.0 and 3.0"),
        (vec![(named, b"<fmi".as_slice())], "modelDescription.xml can't be read"),
        (
            vec![("readme.txt", b"".as_slice())],
            "isn't an FMU: modelDescription.xml: specified file not found",
        ),
        (
            vec![(named, two.as_bytes()), (LINUX[0], &library), ("resources/../../../outside", b"x")],
            "has an entry \"resources/../../../outside\" that leaves its folder",
        ),
    ] {
        fmu.pack(entries);
        let have = error(&fmu, PLANT, "");
        assert!(have.contains(want), "have {have}\nwant {want}");
    }
    assert!(!fmu.path("outside").exists(), "nothing leaves the folder");
    // A torque that arrives within a period splits it.
    fmu.pack([(named, fixed.as_bytes()), (LINUX[0], &library)]);
    let plant = format!("{PLANT}{START}");
    let delayed = ["--set", "line.delay_us=300"];
    let have = fmu.run(&plant, 0.1, &Records::new(), &delayed).with_code(2).stderr;
    assert!(
        have.contains("set plant.step_us to a step that divides the control period and each delay"),
        "{have}"
    );
    let _ = fmu.run(&plant, 0.1, &Records::new(), &[]).with_code(0);
}

#[test]
fn show_prints_a_section_that_runs() {
    for description in ["two", "three"] {
        let fmu = FmuFolder::new(description, &LINUX);
        let file = fmu.path("plant.fmu").display().to_string();
        let shown = program::run(["fmu", "show", &file]).with_code(0).stdout;
        let at = shown.find("[plant]").expect("a section");
        let _ = fmu.run(&shown[at..], 0.1, &Records::new(), &[]).with_code(0);
        insta::assert_snapshot!(format!("fmu_show_{description}"), shown.replace(&file, "plant.fmu"));
    }
    // Of an FMU of our own: its outputs have the names of columns, and parameters state where it starts.
    let fmu = FmuFolder::new("two", &LINUX);
    let file = fmu.path("own.fmu").display().to_string();
    let export = ["fmu", "export", "scenarios/smooth-after.toml", "--of", "plant", "--out", &file];
    let _ = program::run(export).with_code(0);
    let shown = program::run(["fmu", "show", &file]).with_code(0).stdout;
    let at = shown.find("[plant]").expect("a section");
    let _ = fmu.run(&shown[at..], 0.1, &Records::new(), &[]).with_code(0);
    let ended = program::run(["fmu", "show", "README.md"]).with_code(2);
    assert!(ended.stderr.starts_with("lashloop-fmu: README.md isn't an FMU: "), "{}", ended.stderr);
}

/// The program shares no code with the bench, so it has the names a second time.
#[test]
fn the_loader_knows_the_columns_that_every_record_has() {
    let source = include_str!("../../../host/fmu/src/show.rs");
    let (_, list) = source.split_once("const COLUMNS: [&str; 9] = [").expect("the list");
    let (list, _) = list.split_once("];").expect("its end");
    let names: Vec<&str> = list.split('"').skip(1).step_by(2).collect();
    assert_eq!(names, lashloop_plant::FIXED_COLUMNS);
}
