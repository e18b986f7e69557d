//! What a user reads about a faulty scenario: one table of input and message.

use std::fmt::Write;
use std::path::Path;

use lashloop_bench::scenario::Scenario;

use crate::{SHORTEST, read};

/// What is changed in the shortest scenario: a line, and what stands there instead.
pub const CHANGES: &[(&str, &str)] = &[
    // Missing.
    ("title = \"a run\"", ""),
    ("duration_s = 2.0", ""),
    ("[run]\nduration_s = 2.0", ""),
    ("model = \"smooth\"", ""),
    ("name = \"pd\"", ""),
    ("profile = \"constant\"", ""),
    ("position_rad = 0.0", ""),
    // Of another type.
    ("title = \"a run\"", "title = 5"),
    ("duration_s = 2.0", "duration_s = \"2\""),
    ("duration_s = 2.0", "duration_s = 2024-05-01"),
    ("model = \"smooth\"", "model = true"),
    ("[run]\nduration_s = 2.0", "run = 2.0"),
    ("duration_s = 2.0", "duration_s = 2.0\nseed = 1.5"),
    ("name = \"pd\"", "name = \"pd\"\nparameters = \"none\""),
    ("name = \"pd\"", "name = \"pd\"\nparameters.gains = [1, 2]"),
    ("name = \"pd\"", "name = \"pd\"\nparameters.limit = nan"),
    ("title = \"a run\"", "title = \"a run\"\nexpect = 5"),
    ("title = \"a run\"", "title = \"a run\"\nexpect = [5]"),
    ("position_rad = 0.0", "position_rad = 0.0\n[expect]\nmetric = \"hunting_rad\"\nunit = \"rad\"\nmax = 1"),
    ("[run]", "[[run]]"),
    ("duration_s = 2.0", "duration_s = \"2,5\""),
    // Out of range.
    ("duration_s = 2.0", "duration_s = 0"),
    ("duration_s = 2.0", "duration_s = nan"),
    ("duration_s = 2.0", "duration_s = inf"),
    ("duration_s = 2.0", "duration_s = 0.0001"),
    ("duration_s = 2.0", "duration_s = 2.0\nseed = -1"),
    ("duration_s = 2.0", "duration_s = 2.0\nseed = 1e300"),
    ("duration_s = 2.0", "duration_s = 2.0\ncontrol_period_us = 50"),
    ("model = \"smooth\"", "model = \"smooth\"\nstiffness_nm_rad = -1"),
    ("model = \"smooth\"", "model = \"smooth\"\ninitial.load_position_rad = 1e9"),
    ("[controller]", "[encoders]\nload_counts_per_rev = 3\n[controller]"),
    ("[controller]", "[telemetry]\nevery_steps = 65536\n[controller]"),
    // Not a choice.
    ("model = \"smooth\"", "model = \"smoth\""),
    ("name = \"pd\"", "name = 5"),
    ("profile = \"constant\"", "profile = \"ramp\""),
    // Unknown, and in a wrong unit.
    ("[run]", "[runn]"),
    ("duration_s = 2.0", "duraton_s = 2.0"),
    ("duration_s = 2.0", "duration_ms = 2000"),
    ("duration_s = 2.0", "duration = 2"),
    ("model = \"smooth\"", "model = \"smooth\"\nstiffness_nm_deg = 0.017"),
    ("model = \"smooth\"", "model = \"smooth\"\nk = 1"),
    ("model = \"smooth\"", "model = \"smooth\"\nJ_s = 7.5"),
    ("model = \"smooth\"", "model = \"smooth\"\ncolour = \"red\""),
    ("model = \"smooth\"", "model = \"smooth\"\n\"odd \\u001b key\" = 1"),
    ("model = \"smooth\"", "model = \"smooth\"\ninitial.load_position_deg = 90"),
    // Of another choice.
    ("model = \"smooth\"", "model = \"smooth\"\nload_coulomb_nm = 3.84"),
    ("position_rad = 0.0", "position_rad = 0.0\namplitude_rad = 1.0"),
    ("\"constant\"", "\"step\""),
    ("\"constant\"\nposition_rad = 0.0", "\"trapezoid\"\nfrom_rad = 0\nto_rad = 1\nvelocity_rpm = 3"),
    ("\"constant\"\nposition_rad = 0.0", "\"table\""),
    ("\"constant\"\nposition_rad = 0.0", "\"table\"\nfile = \"no/such.csv\"\ninterpolation = \"cubic\""),
    ("\"constant\"\nposition_rad = 0.0", "\"table\"\nfile = \"no/such.csv\""),
    // Expectations.
    ("position_rad = 0.0", "position_rad = 0.0\n[[expect]]"),
    ("position_rad = 0.0", "position_rad = 0.0\n[[expect]]\nmetric = \"settle\"\nunit = \"s\"\nmax = 1"),
    (
        "position_rad = 0.0",
        "position_rad = 0.0\n[[expect]]\nmetric = \"hunting_rad\"\nunit = \"mrad\"\nmax = 1",
    ),
    ("position_rad = 0.0", "position_rad = 0.0\n[[expect]]\nmetric = \"hunting_rad\"\nmax = 1"),
    ("position_rad = 0.0", "position_rad = 0.0\n[[expect]]\nmetric = \"hunting_rad\"\nunit = \"rad\""),
    (
        "position_rad = 0.0",
        "position_rad = 0.0\n[[expect]]\nmetric = \"hunting_rad\"\nunit = \"rad\"\nmin = 2\nmax = 1",
    ),
    // Not TOML.
    ("duration_s = 2.0", "duration_s = "),
    ("duration_s = 2.0", "duration_s 2.0"),
    ("duration_s = 2.0", "duration_s = 2,5 # s"),
    ("position_rad = 0.0", "position_rad = -1,5e-3"),
    ("title = \"a run\"", "title = \"a run"),
    ("[plant]", "[plant"),
    ("[plant]", "[run]"),
    ("duration_s = 2.0", "duration_s = 2.0\nduration_s = 3.0"),
    ("duration_s = 2.0", "duration_s = 99999999999999999999"),
];

#[test]
fn every_message_names_place_problem_and_remedy() {
    let mut table = String::new();
    for (written, instead) in CHANGES {
        assert_eq!(SHORTEST.matches(written).count(), 1, "{written:?} isn't unique");
        let messages = read(&SHORTEST.replace(written, instead), &[]).expect_err(instead);
        for line in instead.lines().chain(instead.is_empty().then_some("(nothing)")) {
            writeln!(table, "| {line}").expect("a String takes everything");
        }
        writeln!(table, "{messages}\n").expect("a String takes everything");
    }
    insta::assert_snapshot!(table);
}

#[test]
fn all_errors_of_a_file_are_reported_in_its_order() {
    let text = SHORTEST
        .replace("[run]", "[[expect]]\nmetric = \"overshoot_rad\"\nunit = \"rad\"\n[run]\nseed = \"lucky\"")
        .replace("2.0", "-2.0")
        .replace("[controller]", "dead_zone_mrad = 160\n[controller]")
        .replace("\"pd\"", "true");
    insta::assert_snapshot!(read(&text, &[]).expect_err("a faulty scenario"), @r#"
    x.toml:2: expect.0: this section gives neither min nor max; it must give at least one
    x.toml:6: run.seed: "lucky" is text; it must be a whole number >= 0 and <= 9223372036854775807
    x.toml:7: run.duration_s: -2.0 is out of range; it must be > 0 and <= 1e5 s
    x.toml:10: plant.dead_zone_mrad: 160 is in a wrong unit; write dead_zone_rad, in rad
    x.toml:12: controller.name: true is a boolean; it must be the name of one of the drive's laws, in quotes
    "#);
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    let errors = Scenario::from_file(Path::new("no/such.toml"), &[]).expect_err("no file");
    assert_eq!(errors.to_string(), "no/such.toml: can't be read: No such file or directory (os error 2)");
}
