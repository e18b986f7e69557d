//! The program of `examples/own-law`: a law from a crate of its own, in process and on the twin. The image is in `emulated`.

use std::fs;

use tests::paper::PATIENCE;
use tests::program::{self, Ended};
use tests::records::Records;

const SCENARIO: &str = "examples/own-law/own-law.toml";

/// Half the gap of the plant, in rad at the motor.
const DEAD_ZONE_RAD: f64 = 0.16;

fn own_law(arguments: &[&str]) -> Ended {
    program::run_example("own-law", arguments)
}

fn pass_on(device: &str, settings: &[&str]) -> Records {
    let records = Records::new();
    let run = ["run", SCENARIO, "--device", device, "--out", &records.out()];
    let _ = own_law(&[&run, settings, &PATIENCE].concat()).with_code(0);
    records
}

fn torque_sha256(records: &Records) -> String {
    records.summary()["torque_sha256"].as_str().expect("a digest").to_owned()
}

#[test]
fn an_own_law_has_equal_torques_on_twin_and_in_process() {
    let [process, twin] = ["inproc", "native"].map(|device| pass_on(device, &[]));
    let [of_process, of_twin] = [&process, &twin].map(Records::summary);
    for key in ["torque_sha256", "metrics", "steps", "expectations"] {
        assert_eq!(of_process[key], of_twin[key], "{key}");
    }
    assert_eq!(of_twin["controller"], "velocity-pi");
    let device = of_twin["device"].as_str().expect("the device");
    assert!(device.starts_with("native (native-twin, "), "{device}");
}

#[test]
fn a_signal_of_an_own_law_is_in_the_record_and_in_the_plot() {
    let records = pass_on("native", &[]);
    let wanted_rad = records.trace().column("drive.wanted_twist_rad");
    assert_eq!(wanted_rad.len(), 8_000);
    // The law leads the motor by the gap, in the direction of the torque.
    let largest_rad = wanted_rad.iter().fold(0.0_f64, |largest, rad| largest.max(rad.abs()));
    assert!(largest_rad > DEAD_ZONE_RAD, "{largest_rad} rad");
    let plot = records.path("plot.svg").display().to_string();
    let signal = ["--signal", "drive.wanted_twist_rad", "--out", &plot];
    let _ = own_law(&[&["plot", &records.out()][..], &signal].concat()).with_code(0);
    let svg = fs::read_to_string(&plot).expect("a plot");
    assert!(svg.contains("wanted_twist_rad"), "the plot names the signal");
}

#[test]
fn a_parameter_of_an_own_law_is_listed_and_takes_effect() {
    for device in ["inproc", "native"] {
        let listed = own_law(&["parameters", "list", "--device", device]).with_code(0).stdout;
        let row = |name: &str| {
            let row = listed.lines().find(|line| line.starts_with(name));
            row.unwrap_or_else(|| panic!("no {name} in\n{listed}")).to_owned()
        };
        let own = row("velocity_integral_nm_rad ");
        assert!(own.contains("60.0") && own.contains("N m/rad") && own.ends_with("velocity-pi"), "{own}");
        assert!(row("stiffness_nm_rad ").ends_with(" all"), "{listed}");
        assert!(row("wanted_twist_rad ").ends_with("velocity-pi"), "{listed}");
    }
    let other = ["--set", "controller.parameters.velocity_integral_nm_rad=40"];
    assert_ne!(torque_sha256(&pass_on("inproc", &other)), torque_sha256(&pass_on("inproc", &[])));
}

#[test]
fn a_parameter_of_another_law_is_an_error_that_names_its_laws() {
    let set = ["--set", "controller.parameters.k_p1=1"];
    let run = ["run", SCENARIO, "--device", "inproc"];
    let stderr = own_law(&[&run, &set[..]].concat()).with_code(2).stderr;
    assert!(stderr.contains("--set controller.parameters.k_p1=1"), "{stderr}");
    assert!(stderr.contains("merzouki"), "{stderr}");
}

#[test]
fn lashloop_names_the_laws_it_has_when_it_lacks_an_own_one() {
    let stderr = program::run(["run", SCENARIO, "--device", "inproc"]).with_code(2).stderr;
    assert!(stderr.contains("velocity-pi") && stderr.contains("pd, merzouki"), "{stderr}");
}

#[test]
fn a_drive_with_an_own_law_conforms() {
    for device in ["inproc", "native"] {
        let ended = own_law(&["conformance", "--device", device]).with_code(0);
        assert!(ended.stdout.contains(" passed, 0 failed, "), "{device}\n{}", ended.stdout);
    }
}

#[test]
fn the_paper_has_the_same_torques_in_a_program_with_an_own_law() {
    let run = tests::paper::RUNS[1];
    let records = Records::new();
    let arguments = ["run", &run.scenario(), "--device", "inproc", "--out", &records.out()];
    let _ = own_law(&arguments).with_code(0);
    assert_eq!(torque_sha256(&records), run.torque_sha256);
}

#[test]
fn a_program_of_your_own_has_its_own_name() {
    let complaint = own_law(&["run", "scenarios/none.toml", "--device", "inproc"]).with_code(2).stderr;
    assert!(complaint.starts_with("own-law: "), "{complaint}");
    let version = own_law(&["--version"]).with_code(0).stdout;
    assert!(version.starts_with("own-law 0."), "{version}");
    let help = own_law(&["--help"]).with_code(0).stdout;
    assert!(help.contains("\nUsage: own-law ") && help.contains("  own-law run scenarios/"), "{help}");
}
