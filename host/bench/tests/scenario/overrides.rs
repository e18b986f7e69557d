//! The command line has the last word, and answers for it.

use lashloop_bench::scenario::Override;
use lashloop_bench::scenario::controller::ParameterValue;
use lashloop_plant::reference::Reference;

use crate::{SHORTEST, read, set};

const EXPECTING: &str = "[[expect]]\nmetric = \"peak_tracking_error_rad\"\nunit = \"rad\"\nmax = 0.1\n\
                         [[expect]]\nmetric = \"overshoot_rad\"\nunit = \"rad\"\nmax = 0.2\n";

#[test]
fn a_set_value_replaces_a_written_one_or_adds_it() {
    let overrides = set(["run.duration_s=3", "plant.initial.load_position_rad = 1.55", "allow.lost=7"]);
    let scenario = read(SHORTEST, &overrides).expect("a good scenario");
    assert_eq!(scenario.run.duration_s, 3.0);
    assert_eq!(scenario.plant.initial.load_position_rad, 1.55);
    assert_eq!(scenario.allow.lost, 7);
}

#[test]
fn bare_words_are_text_and_the_last_of_two_counts() {
    let overrides =
        set(["plant.model=\"smooth\"", "plant.model=hard-coulomb", "title=two words", "run.seed=1_000"]);
    let scenario = read(SHORTEST, &overrides).expect("a good scenario");
    assert_eq!(scenario.plant.model.name(), "hard-coulomb");
    assert_eq!(scenario.title, "two words");
    assert_eq!(scenario.run.seed, 1000);
}

#[test]
fn a_scenario_can_be_completed_by_the_command_line() {
    let overrides = set([
        "reference.profile=sine",
        "reference.amplitude_rad=0.5",
        "reference.frequency_hz=0.05",
        "meant=start",
    ]);
    let text = SHORTEST.replace("profile = \"constant\"\nposition_rad = 0.0\n", "");
    let scenario = read(&text, &overrides).expect("a good scenario");
    let sine = Reference::Sine { amplitude_rad: 0.5, frequency_hz: 0.05, offset_rad: 0.0, phase_rad: 0.0 };
    assert_eq!(scenario.reference, sine);
}

#[test]
fn the_controller_option_names_the_law() {
    let scenario = read(SHORTEST, &[Override::Controller("merzouki".to_owned())]).expect("a good scenario");
    assert_eq!(scenario.controller.name, "merzouki");
}

#[test]
fn a_set_drive_parameter_knows_where_it_was_set() {
    let scenario = read(SHORTEST, &set(["controller.parameters.source=observed"])).expect("a good scenario");
    let setting = &scenario.controller.parameters[0];
    assert_eq!(setting.value, ParameterValue::Text("observed".to_owned()));
    assert_eq!(setting.origin.to_string(), "--set controller.parameters.source=observed");
}

#[test]
fn an_expectation_is_named_by_its_index() {
    let scenario = read(&format!("{SHORTEST}{EXPECTING}"), &set(["expect.1.max=0.3", "expect.0.min=0"]))
        .expect("a good scenario");
    let bounds: Vec<_> = scenario.expectations.iter().map(|expected| (expected.min, expected.max)).collect();
    assert_eq!(bounds, [(Some(0.0), Some(0.1)), (None, Some(0.3))]);
}

#[test]
fn every_faulty_option_is_named_in_place_of_file_and_line() {
    let text = format!("{SHORTEST}{EXPECTING}min = 0.0\n").replace("2.0", "0.05");
    let messages: Vec<_> = [
        "plant.stiffness_nm_rad=-1",
        "plant.model=hard",
        "plant.stifness_n_m_rad=2",
        "plnt.model=smooth",
        "run.duration_ms=5",
        "run.duration_s=fast",
        "run.duration_s=1,5",
        "k_p2=3",
        "duration_s=3",
        "dead_zone_rad=0.2",
        "titel=x",
        "run.seed=1.5",
        "run.duration_s",
        "run.duration_s=",
        "=5",
        "run..seed=5",
        "a.b.c.d=5",
        "title=\"open",
        "title.word=5",
        "plant=5",
        "expect.max=5",
        "expect.2.max=5",
        "expect.first.max=5",
        "expect.1.min=0.5",
        "expect.1.max=-1",
        "run.control_period_us=100000",
        "reference.profile=step",
        "reference.at_s=1",
        "controller.parameters.gains=[1, 2]",
    ]
    .into_iter()
    .map(|assignment| read(&text, &set([assignment])).expect_err(assignment))
    .collect();
    insta::assert_snapshot!(messages.join("\n"), @r#"
    --set plant.stiffness_nm_rad=-1: plant.stiffness_nm_rad: -1 is out of range; it must be >= 1e-6 and <= 1e6 N m/rad
    --set plant.model=hard: plant.model: "hard" is not a choice; it must be "smooth", "hard-coulomb", "backlash-shaft", "process" or "fmu"
    --set plant.stifness_n_m_rad=2: plant.stifness_n_m_rad: unknown key; did you mean stiffness_nm_rad?
    --set plnt.model=smooth: plnt: unknown key; did you mean plant?
    --set run.duration_ms=5: run.duration_ms: 5 is in a wrong unit; write duration_s, in s
    --set run.duration_s=fast: run.duration_s: "fast" is text; it must be a number > 0 and <= 1e5 s
    --set run.duration_s=1,5: run.duration_s: "1,5" has a decimal comma; write 1.5
    --set k_p2=3: the key has no section; write controller.parameters.k_p2 (a parameter of the drive)
    --set duration_s=3: the key has no section; write run.duration_s or controller.parameters.duration_s (a parameter of the drive)
    --set dead_zone_rad=0.2: the key has no section; write plant.dead_zone_rad or controller.parameters.dead_zone_rad (a parameter of the drive)
    --set titel=x: titel: unknown key; did you mean title?
    --set run.seed=1.5: run.seed: 1.5 is a fractional number; it must be a whole number >= 0 and <= 9223372036854775807
    --set run.duration_s: it must be section.key=value
    --set run.duration_s=: there is no value after the =; an empty text is ""
    --set =5: the key is incomplete; it must be section.key=value
    --set run..seed=5: the key is incomplete; it must be section.key=value
    --set a.b.c.d=5: no key lies deeper than 3 levels; it must be section.key=value
    --set title="open: invalid basic string, expected `"`
    --set title.word=5: title isn't a section, so it has no key word
    --set plant=5: plant: 5 is a whole number; it must be a section [plant]
    --set expect.max=5: expect is a list; write expect.0.max
    --set expect.2.max=5: there is no expect.2; the index must be >= 0 and <= 1
    --set expect.first.max=5: there is no expect.first; the index must be >= 0 and <= 1
    --set expect.1.min=0.5: expect.1.min: 0.5 is greater than max; it must be <= 0.2 rad
    --set expect.1.max=-1: expect.1.max: -1 is less than min; it must be >= 0 rad
    --set run.control_period_us=100000: run.control_period_us: 100000 is longer than the run; it must be <= 50000 us
    x.toml:10: reference.position_rad: 0.0 is given, but this key belongs to profile = "constant" and --set reference.profile=step chooses profile = "step"
    --set reference.profile=step: reference.before_rad: is missing; it must be a number >= -1e4 and <= 1e4 rad
    --set reference.profile=step: reference.after_rad: is missing; it must be a number >= -1e4 and <= 1e4 rad
    --set reference.profile=step: reference.at_s: is missing; it must be a number >= 0 and <= 1e6 s
    --set reference.at_s=1: reference.at_s: 1 is given, but this key belongs to profile = "step" and the scenario chooses profile = "constant"
    --set controller.parameters.gains=[1, 2]: controller.parameters.gains: [2 items] is a list; it must be a number, a boolean or a text
    "#);
}
