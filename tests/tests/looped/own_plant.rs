//! The program of `examples/own-plant`: a plant from a crate of its own.

use tests::paper::PATIENCE;
use tests::program;
use tests::records::Records;

const SCENARIO: &str = "examples/own-plant/three-masses.toml";

#[test]
fn an_own_plant_has_equal_torques_on_twin_and_in_process() {
    let [process, twin] = ["inproc", "native"].map(|device| {
        let records = Records::new();
        let arguments = ["run", SCENARIO, "--device", device, "--out", &records.out()];
        let _ = program::run_example("own-plant", arguments.into_iter().chain(PATIENCE)).with_code(0);
        records
    });
    assert_eq!(process.summary()["torque_sha256"], twin.summary()["torque_sha256"]);
    let [wheel_rad, of_twin_rad] = [&process, &twin].map(|it| it.trace().column("wheel_position_rad"));
    assert!(wheel_rad == of_twin_rad, "the truth of the plant is equal too");
    let turned_rad = wheel_rad.last().expect("rows") - wheel_rad[0];
    assert!(turned_rad.abs() > 1.0, "{turned_rad} rad");
}

#[test]
fn metrics_without_their_signal_name_it_in_the_report() {
    let arguments = ["run", SCENARIO, "--device", "inproc", "--controller", "merzouki", "--set", "expect=[]"];
    let short = ["--set", "run.duration_s=0.1", "--details"];
    let ended = program::run_example("own-plant", arguments.into_iter().chain(short));
    let report = ended.with_code(0).stdout;
    assert!(report.contains("\nno value    dead_zone_error_rad: no signal dead_zone_rad\n"), "{report}");
}

#[test]
fn keys_of_an_own_plant_are_listed_and_checked() {
    let keys = program::run_example("own-plant", ["show", "--keys"]).with_code(0).stdout;
    assert!(keys.contains("wheel_inertia_kg_m2"), "the keys of the plant are in the list");
    let arguments = ["run", SCENARIO, "--device", "inproc", "--set", "plant.wheel_inertia=1"];
    let stderr = program::run_example("own-plant", arguments).with_code(2).stderr;
    assert!(stderr.contains("write wheel_inertia_kg_m2, in kg m^2"), "{stderr}");
}

#[test]
fn lashloop_names_the_plants_it_has_when_it_lacks_an_own_one() {
    let stderr = program::run(["run", SCENARIO, "--device", "inproc"]).with_code(2).stderr;
    assert!(stderr.contains("three-masses") && stderr.contains("backlash-shaft"), "{stderr}");
}
