//! Scenarios that are valid key by key, but probably not what their author meant.

use std::fs;
use std::path::Path;

use lashloop_bench::scenario::{Scenario, Trap};

use crate::{SHORTEST, printed_and_read, read, set};

const AT_ZERO: &str =
    "model = \"smooth\"\n[plant.initial]\nload_position_rad = 0.0\nmotor_position_rad = 0.0";

/// The shortest scenario with these lines instead of others.
fn with<const N: usize>(changes: [(&str, &str); N]) -> String {
    changes.into_iter().fold(SHORTEST.to_owned(), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 1, "{from:?} isn't unique");
        text.replace(from, to)
    })
}

fn trapped(text: &str) -> String {
    read(text, &[]).expect_err(text)
}

/// The text with this trap declared as meant, which shifts the lines by one.
fn meant(trap: &str, text: &str) -> String {
    format!("meant = [\"{trap}\"]\n{text}")
}

const PLANT: &str = "model = \"smooth\"";
const CONSTANT: &str = "\"constant\"\nposition_rad = 0.0";
const SINE: &str = "\"sine\"\namplitude_rad = 0.5\nfrequency_hz = 0.05";

#[test]
fn a_motor_that_does_not_fit_the_load_within_the_gap_is_a_trap() {
    let text = with([(PLANT, "model = \"smooth\"\ninitial.load_position_rad = 0.0")]);
    assert_eq!(
        trapped(&text),
        "x.toml:6: plant.initial.load_position_rad: 0 leaves a twist of 4.7124 rad, beyond the gap of +-0.16 rad; set \
         plant.initial.motor_position_rad = 0, the reduction ratio times the load position, or write meant = [\"start\"] at \
         the top of the scenario"
    );
    assert_eq!(read(&meant("start", &text), &[]).expect("meant").meant, [Trap::Start]);
    for (motor, fits) in
        [("0.16", true), ("-0.16", true), ("0.1605", true), ("0.165", false), ("-0.2", false)]
    {
        let text = with([(
            PLANT,
            &AT_ZERO.replace("motor_position_rad = 0.0", &format!("motor_position_rad = {motor}")),
        )]);
        assert_eq!(read(&text, &[]).is_ok(), fits, "{motor}");
    }
}

#[test]
fn another_ratio_needs_another_motor_position() {
    let text = with([(
        PLANT,
        "model = \"smooth\"\nreduction_ratio = 5\n[controller.parameters]\nreduction_ratio = 5",
    )]);
    let text = text.replace("[controller]\nname", "[controller]\n#\nname");
    let message = trapped(&text);
    assert!(
        message.starts_with("x.toml:6: plant.reduction_ratio: 5 leaves a twist of -3.1416 rad"),
        "{message}"
    );
}

#[test]
fn a_start_away_from_a_moving_reference_is_a_trap() {
    let sine = with([(CONSTANT, SINE)]);
    assert_eq!(
        trapped(&sine),
        "x.toml:4: plant.initial.load_position_rad: the default of 1.5707963267948966 is not where the reference starts, so \
         the first torque is a jump; set plant.initial.load_position_rad = 0 and plant.initial.motor_position_rad = 0, or \
         write meant = [\"start\"] at the top of the scenario"
    );
    assert!(read(&with([(CONSTANT, SINE), (PLANT, AT_ZERO)]), &[]).is_ok());
    assert!(read(&meant("start", &sine), &[]).is_ok());
    for moving in [
        "\"step\"\nbefore_rad = 0.0\nafter_rad = 1.0\nat_s = 1.0",
        "\"trapezoid\"\nfrom_rad = 0.0\nto_rad = 1.0\nvelocity_rad_s = 1.0\nacceleration_rad_s2 = 1.0",
    ] {
        assert!(trapped(&with([(CONSTANT, moving)])).contains("not where the reference starts"), "{moving}");
        assert!(read(&with([(CONSTANT, moving), (PLANT, AT_ZERO)]), &[]).is_ok(), "{moving}");
    }
}

#[test]
fn degrees_in_place_of_radians_are_a_trap() {
    let text = with([("position_rad = 0.0", "position_rad = 90")]);
    assert_eq!(
        trapped(&text),
        "x.toml:10: reference.position_rad: 90 goes to 90 rad, which are 14.3 turns; 90 degrees are 1.5708 rad; correct it, \
         or write meant = [\"large-angle\"] at the top of the scenario"
    );
    assert!(read(&meant("large-angle", &text), &[]).is_ok());
    // Two turns of the load; the motor turns more by the ratio.
    for (load, motor, fits) in [(12.5, 37.5, true), (-12.5, -37.5, true), (12.6, 37.8, false)] {
        let start = format!(
            "model = \"smooth\"\n[plant.initial]\nload_position_rad = {load}\nmotor_position_rad = {motor}"
        );
        assert_eq!(read(&with([(PLANT, &start)]), &[]).is_ok(), fits, "{load}");
    }
}

#[test]
fn degrees_in_a_table_are_a_trap() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let path = directory.path().join("x.toml");
    fs::write(directory.path().join("ramp.csv"), "time_s,position_rad\n0,0\n2,-90\n3,45\n").expect("a table");
    let text = with([(CONSTANT, "\"table\"\nfile = \"ramp.csv\""), (PLANT, AT_ZERO)]);
    fs::write(&path, &text).expect("a scenario");
    let message = Scenario::from_file(&path, &[]).expect_err("degrees").to_string();
    assert!(message.contains("x.toml:13: reference.file: this file goes to -90 rad"), "{message}");
    fs::write(&path, meant("large-angle", &text)).expect("a scenario");
    assert!(Scenario::from_file(&path, &[]).is_ok());
}

const COMPARED: [(&str, f64); 4] = [
    ("reduction_ratio", 3.0),
    ("dead_zone_rad", 0.16),
    ("load_inertia_kg_m2", 7.5),
    ("motor_inertia_kg_m2", 9.72e-4),
];

#[test]
fn parameters_that_describe_another_plant_are_a_trap() {
    for (name, nominal) in COMPARED {
        let text = format!("{SHORTEST}[controller.parameters]\n{name} = {}\n", 1.1 * nominal);
        let message = trapped(&text);
        let place = format!(
            "x.toml:12: controller.parameters.{name}: {} is not {nominal}, the value of plant.{name}; ",
            1.1 * nominal
        );
        assert!(message.starts_with(&place), "{message}");
        assert!(read(&meant("mismatch", &text), &[]).is_ok(), "{name}");
        let equal = text.replace(PLANT, &format!("model = \"smooth\"\n{name} = {}", 1.1 * nominal));
        // Another ratio alone moves the motor out of the gap.
        let equal = if name == "reduction_ratio" { meant("start", &equal) } else { equal };
        assert!(read(&equal, &[]).is_ok(), "{name}");
    }
}

#[test]
fn a_plant_that_differs_from_the_drive_s_defaults_is_a_trap_at_set_up() {
    let default_of = |name: &str| {
        // In single precision, as a drive has them.
        COMPARED.iter().find(|(compared, _)| *compared == name).map(|(_, value)| f64::from(*value as f32))
    };
    assert!(read(SHORTEST, &[]).expect("the paper's plant").check_drive(default_of).is_ok());

    let wider = with([(PLANT, "model = \"smooth\"\ndead_zone_rad = 0.2")]);
    let scenario = read(&wider, &[]).expect("a good scenario");
    let message = scenario.check_drive(default_of).expect_err("another gap").to_string();
    assert!(
        message.starts_with("x.toml:6: plant.dead_zone_rad: 0.2 is not the drive's default of 0.16")
            && message
                .contains("set controller.parameters.dead_zone_rad = 0.2, or write meant = [\"mismatch\"]"),
        "{message}"
    );
    // A law without the parameter doesn't depend on it.
    assert!(scenario.check_drive(|_| None).is_ok());
    // A parameter that the scenario sets isn't a default.
    let equal = format!("{wider}[controller.parameters]\ndead_zone_rad = 0.2\n");
    assert!(read(&equal, &[]).expect("a good scenario").check_drive(default_of).is_ok());
    let meant = meant("mismatch", &wider);
    assert!(read(&meant, &[]).expect("a good scenario").check_drive(default_of).is_ok());
}

#[test]
fn an_entry_that_is_unknown_repeated_or_useless_is_an_error() {
    let parameters: String = COMPARED.iter().map(|(name, value)| format!("{name} = {value}\n")).collect();
    let messages = [
        format!("meant = [\"strat\"]\n{SHORTEST}"),
        format!("meant = [5]\n{SHORTEST}"),
        format!("meant = [\"start\", \"start\"]\n{}", with([(CONSTANT, SINE)])),
        meant("start", SHORTEST),
        format!("meant = \"large-angle\"\n{SHORTEST}"),
        // Nothing is left to the drive's defaults, so no drive can differ.
        meant("mismatch", &format!("{SHORTEST}[controller.parameters]\n{parameters}")),
    ]
    .map(|text| trapped(&text));
    insta::assert_snapshot!(messages.join("\n"), @r#"
    x.toml:1: meant: "strat" is not a choice; it must be "start", "mismatch" or "large-angle" (did you mean "start"?)
    x.toml:1: meant: 5 is a whole number; it must be "start", "mismatch" or "large-angle"
    x.toml:1: meant: "start" is given twice
    x.toml:1: meant: "start" silences nothing: the scenario has no such trap; omit it
    x.toml:1: meant: "large-angle" silences nothing: the scenario has no such trap; omit it
    x.toml:1: meant: "mismatch" silences nothing: the scenario has no such trap; omit it
    "#);
}

#[test]
fn an_entry_may_be_idle_in_a_sweep() {
    let scenario = read(
        &meant("start", &with([(CONSTANT, SINE)])),
        &set(["plant.initial.load_position_rad=0", "plant.initial.motor_position_rad=0"]),
    );
    assert!(scenario.is_ok(), "{scenario:?}");
    assert!(read(SHORTEST, &set(["meant=start", "run.seed=5"])).is_ok());
}

#[test]
fn meant_traps_survive_printing() {
    let scenario = read(&meant("start", &with([(CONSTANT, SINE)])), &[]).expect("a good scenario");
    let printed = scenario.to_toml().expect("TOML");
    assert!(printed.contains("\nmeant = [\"start\"]\n"), "{printed}");
    assert_eq!(printed_and_read(&scenario), scenario);
}

#[test]
fn no_scenario_of_the_tree_is_a_trap_on_a_drive_with_the_paper_s_parameters() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut seen = 0;
    for entry in fs::read_dir(folder).expect("the scenarios") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let scenario = Scenario::from_file(&path, &[]).unwrap_or_else(|errors| panic!("{errors}"));
            let nominal = |name: &str| COMPARED.iter().find(|it| it.0 == name).map(|it| it.1);
            scenario.check_drive(nominal).unwrap_or_else(|errors| panic!("{errors}"));
            seen += 1;
        }
    }
    assert!(seen >= 14, "{seen} scenarios");
}
