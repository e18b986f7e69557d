//! What a scenario means once it has been read.

use std::f64::consts::FRAC_PI_2;

use lashloop_bench::scenario::controller::ParameterValue;
use lashloop_bench::scenario::{Override, Scenario, ScenarioError};
use lashloop_firmware::Laws;
use lashloop_firmware::law::{LawSet, Range};
use lashloop_plant::Plants;
use lashloop_plant::encoder::{MAX_COUNTS_PER_REV, MIN_COUNTS_PER_REV};
use lashloop_plant::reference::Reference;

use crate::{SHORTEST, printed_and_read, read};

#[test]
fn the_default_plant_is_table_1_of_the_paper() {
    let scenario = read(SHORTEST, &[]).expect("a good scenario");
    let table_1 = [
        ("substeps", 4.0),
        ("load_inertia_kg_m2", 7.5),
        ("load_friction_nm_s_rad", 16.0),
        ("motor_inertia_kg_m2", 9.72e-4),
        ("motor_friction_nm_s_rad", 4.3e-4),
        ("reduction_ratio", 3.0),
        ("stiffness_nm_rad", 1.0),
        ("dead_zone_rad", 0.16),
    ];
    let plant = &scenario.plant;
    assert_eq!(plant.values.iter().map(|(key, _)| key).collect::<Vec<_>>(), table_1.map(|(key, _)| key));
    for (key, value) in table_1 {
        assert_eq!(plant.number(key), Some(value), "{key}");
    }
    assert_eq!(plant.environment, None);
    assert_eq!(plant.initial, lashloop_plant::Start::at_rest(FRAC_PI_2, 3.0 * FRAC_PI_2));
    assert_eq!(scenario.controller.name, "pd");
    assert_eq!(scenario.reference, Reference::Constant { position_rad: 0.0 });
}

#[test]
fn defaults_are_1_khz_fine_encoders_and_a_flawless_link() {
    let scenario = read(SHORTEST, &[]).expect("a good scenario");
    assert_eq!((scenario.run.control_period_us, scenario.run.seed, scenario.run.steps()), (1000, 1, 2000));
    assert_eq!(scenario.run.control_period_s(), 0.001);
    let encoders = &scenario.encoders;
    assert_eq!((encoders.motor_counts_per_rev, encoders.load_counts_per_rev), (131_072, 131_072));
    assert_eq!(encoders.noise_counts, 0.0);
    assert_eq!(scenario.link.answer_timeout().as_millis(), 1000);
    assert_eq!(scenario.link.mean_wait().as_millis(), 100);
    assert_eq!(scenario.link.silence_limit().as_millis(), 2500);
    assert_eq!(scenario.link.baud, 921_600);
    assert_eq!((scenario.allow.lost, scenario.allow.late, scenario.allow.crc_errors), (0, 0, 0));
    assert_eq!((scenario.telemetry.every_steps, scenario.record.flush_rows), (10, 1000));
    assert!(scenario.expectations.is_empty());
}

#[test]
fn each_encoder_has_noise_and_eccentricity_of_its_own() {
    let keys = ["noise_counts=2", "load_noise_counts=0", "motor_eccentricity_rad=0.03"];
    let set = keys.map(|key| Override::Set(format!("encoders.{key}")));
    let encoders = read(SHORTEST, &set).expect("a good scenario").encoders;
    let mut plain = read(SHORTEST, &[]).expect("a good scenario").encoders.load(1).expect("an encoder");
    let [mut motor, mut load] = [encoders.motor(1), encoders.load(1)].map(|it| it.expect("an encoder"));
    assert!((0..100).all(|at| load.read(f64::from(at)) == plain.read(f64::from(at))));
    let error = motor.read(FRAC_PI_2) - plain.read(FRAC_PI_2);
    let eccentricity = 0.03 / std::f64::consts::TAU * 131_072.0;
    assert!((error as f64 - eccentricity).abs() < 3.0, "have {error}, want {eccentricity} counts +- 3");
    let noise: std::collections::BTreeSet<_> = (0..100).map(|_| motor.read(0.0)).collect();
    assert_eq!(noise.into_iter().collect::<Vec<_>>(), [-2, -1, 0, 1]);
}

#[test]
fn scenarios_allow_the_encoder_resolutions_of_the_drive() {
    for name in ["motor_counts_per_rev", "load_counts_per_rev"] {
        let entry =
            Laws::PARAMETERS.iter().find(|entry| entry.name == name).expect("a parameter of the drive");
        let Range::U32 { min, max, .. } = entry.range else { panic!("{name} isn't a whole number") };
        assert_eq!((min, max), (MIN_COUNTS_PER_REV, MAX_COUNTS_PER_REV), "{name}");
    }
}

#[test]
fn every_plant_model_is_printed_by_its_name() {
    for model in Plants::standard().iter() {
        let scenario = read(&SHORTEST.replace("smooth", model.name()), &[]).expect("a good scenario");
        assert_eq!(scenario.plant.model, *model);
        let line = format!("model = \"{}\"\n", model.name());
        assert!(scenario.to_toml().expect("TOML").contains(&line), "{line}");
    }
}

#[test]
fn the_hard_gap_brings_its_friction_and_the_smooth_one_has_none() {
    let hard = read(&SHORTEST.replace("smooth", "hard-coulomb"), &[]).expect("a good scenario");
    assert_eq!(hard.plant.model.name(), "hard-coulomb");
    assert_eq!(hard.plant.number("load_coulomb_nm"), Some(3.84));
}

#[test]
fn a_warm_up_leaves_at_least_one_step_to_judge() {
    let with = |steps: u32| {
        let set = |text: String| Override::Set(text);
        read(SHORTEST, &[set("run.duration_s=0.5".to_owned()), set(format!("run.warm_up_steps={steps}"))])
    };
    assert_eq!(with(499).expect("a good scenario").run.warm_up_steps, 499);
    let error = with(500).expect_err("no step is left");
    assert!(
        error.contains("run.warm_up_steps: 500 leaves no step to judge; the run has 500 steps"),
        "{error}"
    );
}

#[test]
fn a_duration_between_two_periods_goes_to_the_nearest() {
    let steps =
        |duration: &str| read(&SHORTEST.replace("2.0", duration), &[]).expect("a good scenario").run.steps();
    assert_eq!(["0.0014", "0.0016", "25", "0.3"].map(steps), [1, 2, 25_000, 300]);
}

#[test]
fn a_whole_number_may_have_an_exponent_or_a_point() {
    let seed =
        |text: &str| read(SHORTEST, &[Override::Set(format!("run.seed={text}"))]).map(|it| it.run.seed);
    assert_eq!(["1e3", "7.0", "1_000"].map(|text| seed(text).expect("a whole number")), [1000, 7, 1000]);
    // 2^53 + 2 is whole, but a file may have meant 2^53 + 1.
    for text in ["1.5", "1e-3", "9007199254740994.0", "inf"] {
        assert!(seed(text).is_err(), "{text}");
    }
}

#[test]
fn drive_parameters_keep_their_order_type_and_place() {
    let text = format!("{SHORTEST}[controller.parameters]\nlimit = 25\nlead = true\nsource = \"model\"\n");
    let parameters = read(&text, &[]).expect("a good scenario").controller.parameters;
    let names: Vec<_> = parameters.iter().map(|setting| setting.name.as_str()).collect();
    assert_eq!(names, ["limit", "lead", "source"]);
    assert_eq!(parameters[0].value, ParameterValue::Number(25.0));
    assert_eq!(parameters[1].value, ParameterValue::Boolean(true));
    assert_eq!(parameters[2].value, ParameterValue::Text("model".to_owned()));
    let refusal = ScenarioError::parameter(&parameters[0], "is out of range; it must be > 0 and <= 20 N m");
    assert_eq!(
        refusal.to_string(),
        "x.toml:12: controller.parameters.limit: 25 is out of range; it must be > 0 and <= 20 N m"
    );
}

#[test]
fn a_table_is_looked_up_in_the_folder_of_its_scenario() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    std::fs::write(directory.path().join("ramp.csv"), "time_s,position_rad\n0,0\n2,1\n").expect("a table");
    let text = SHORTEST.replace("\"constant\"\nposition_rad = 0.0", "\"table\"\nfile = \"ramp.csv\"");
    let text = format!("meant = \"start\"\n{text}");
    let path = directory.path().join("x.toml");
    std::fs::write(&path, text).expect("a scenario");
    let scenario = Scenario::from_file(&path, &[]).expect("a good scenario");
    assert_eq!(scenario.reference.position_rad(0.5), 0.25);
}

#[test]
fn a_scenario_that_was_read_can_be_printed_and_read_again() {
    let text = format!(
        "{}[controller.parameters]\nlimit = 25\nsource = \"model\"\n\
         [[expect]]\nmetric = \"effort_nm2s\"\nunit = \"N^2 m^2 s\"\nmax = 3\nnote = \"a guess\"\n",
        SHORTEST.replace("smooth", "hard-coulomb").replace("title", "description = \"long\"\ntitle")
    );
    let scenario = read(&text, &[]).expect("a good scenario");
    let printed = scenario.to_toml().expect("TOML");
    insta::assert_snapshot!(printed, @r#"
    title = "a run"
    description = "long"

    [run]
    mode = "hil"
    duration_s = 2.0
    control_period_us = 1000
    seed = 1
    warm_up_steps = 0

    [plant]
    model = "hard-coulomb"
    substeps = 4
    load_inertia_kg_m2 = 7.5
    load_friction_nm_s_rad = 16.0
    motor_inertia_kg_m2 = 0.000972
    motor_friction_nm_s_rad = 0.00043
    reduction_ratio = 3.0
    stiffness_nm_rad = 1.0
    dead_zone_rad = 0.16
    load_coulomb_nm = 3.84

    [plant.initial]
    load_position_rad = 1.5707963267948966
    load_velocity_rad_s = 0.0
    motor_position_rad = 4.71238898038469
    motor_velocity_rad_s = 0.0

    [encoders]
    motor_counts_per_rev = 131072
    load_counts_per_rev = 131072
    noise_counts = 0.0
    motor_eccentricity_rad = 0.0
    load_eccentricity_rad = 0.0

    [controller]
    name = "pd"

    [controller.parameters]
    limit = 25.0
    source = "model"

    [reference]
    profile = "constant"
    position_rad = 0.0

    [line]
    delay_us = 0
    jitter_us = 0
    loss = 0.0

    [link]
    answer_timeout_ms = 1000
    mean_wait_ms = 100
    silence_limit_ms = 2500
    baud = 921600
    modelled_baud = 0
    on_loss = "end"
    resume_limit_ms = 5000

    [allow]
    lost = 0
    late = 0
    crc_errors = 0
    resumes = 0

    [telemetry]
    every_steps = 10

    [record]
    flush_rows = 1000

    [[expect]]
    metric = "effort_nm2s"
    unit = "N^2 m^2 s"
    max = 3.0
    note = "a guess"
    "#);
    assert_eq!(printed_and_read(&scenario), scenario);
}

#[test]
fn every_profile_survives_printing() {
    for profile in [
        "\"step\"\nbefore_rad = 1\nafter_rad = 0.5\nat_s = 1.5",
        "\"sine\"\namplitude_rad = 0.5\nfrequency_hz = 0.05\nphase_rad = 0.1",
        "\"trapezoid\"\nfrom_rad = 1\nto_rad = 0.5\nvelocity_rad_s = 2\nacceleration_rad_s2 = 3",
        "\"chirp\"\namplitude_rad = 0.1\nfrom_hz = 0.5\nto_hz = 20\nsweep_s = 10\noffset_rad = 0.2",
        "\"multisine\"\namplitude_rad = 0.1\nperiod_s = 2\nlowest_hz = 0.5\nhighest_hz = 20\nlines = 10\nphase_seed = 3",
    ] {
        let text =
            format!("meant = [\"start\"]\n{}", SHORTEST.replace("\"constant\"\nposition_rad = 0.0", profile));
        let scenario = read(&text, &[]).expect(&text);
        assert_eq!(printed_and_read(&scenario), scenario);
    }
}

#[test]
fn multisine_without_a_range_of_frequencies_is_rejected_at_the_higher_end() {
    let profile = "\"multisine\"\namplitude_rad = 0.1\nperiod_s = 2\nlowest_hz = 5\nhighest_hz = 4";
    let text = SHORTEST.replace("\"constant\"\nposition_rad = 0.0", profile);
    let errors = read(&text, &[]).expect_err("no range").to_string();
    assert!(errors.contains("reference.highest_hz: 4 is below lowest_hz; it must be >= 5 Hz"), "{errors}");
}
