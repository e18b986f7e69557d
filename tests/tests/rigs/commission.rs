//! `lashloop commission`: the confirmation at a terminal, and a rig.

use std::process::{Command, Output};

use tests::program::{self, lashloop};
use tests::records::Records;
use tests::terminal;
use tests::twin::Twin;

use crate::bench::RigFile;

const LIMITS: [&str; 6] =
    ["--motor-speed-limit", "400", "--load-speed-limit", "10", "--travel-limit", "0.002"];

/// A commissioning whose user types this at the terminal.
fn answered(answer: &str) -> Output {
    let terminal = terminal::open();
    rustix::io::write(&terminal.far_end, answer.as_bytes()).expect("an answer");
    let arguments = ["commission", "--device", "inproc", "--torque-limit", "20"];
    let mut command = Command::new(lashloop());
    command.args(arguments).args(LIMITS).current_dir(tests::workspace());
    command.stdin(terminal::open_near_end(&terminal.path)).output().expect("lashloop starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn only_the_word_yes_starts_a_motion() {
    for answer in ["no\n", "\n", "y\n", "YES\n", "yes please\n"] {
        let ended = answered(answer);
        let asked = text(&ended.stderr);
        for limit in ["up to 20 N m", "up to 400 rad/s", "up to 10 rad/s", "within 0.002 rad"] {
            assert!(asked.contains(limit), "{asked}");
        }
        assert!(asked.contains("Type yes to start"), "{asked}");
        assert_eq!(text(&ended.stdout), "not confirmed: nothing was moved\n", "{answer:?}");
        assert_eq!(ended.status.code(), Some(3), "{answer:?}");
    }
    let ended = answered("yes\n");
    assert!(text(&ended.stdout).starts_with("rest-1"), "{}", text(&ended.stdout));
    let halted = text(&ended.stderr);
    assert!(halted.contains("the load travel reached") && ended.status.code() == Some(3), "{halted}");
}

#[test]
fn without_a_terminal_the_option_is_needed() {
    let arguments = ["commission", "--device", "inproc", "--torque-limit", "20"];
    let ended = program::run(arguments.into_iter().chain(LIMITS)).with_code(2);
    assert!(ended.stderr.contains("--yes is missing") && ended.stdout.is_empty(), "{}", ended.stderr);
}

#[test]
fn a_rig_bounds_a_commissioning_and_has_its_encoders_in_bench_mode() {
    let twin = Twin::start();
    let limits = "torque_nm = 5.0\nload_travel_rad = 0.002\n[encoders]\nmotor_counts_per_rev = 4000\n\
                  [power_stage]\ntorque_per_duty_nm = 62.5";
    let path = RigFile::with(&twin.device(), "native-twin", limits);
    let on_rig = |more: &[&str]| {
        let speeds = ["--motor-speed-limit", "400", "--load-speed-limit", "10", "--yes"];
        program::run([&["commission", "--rig", &path.path()], &speeds[..], more].concat())
    };
    let above = on_rig(&["--torque-limit", "6"]).with_code(2);
    assert!(above.stderr.contains("--torque-limit 6 exceeds the rig's 5"), "{}", above.stderr);
    // The twin has no pins.
    let bench = on_rig(&[]).with_code(4);
    assert!(bench.stderr.contains("no bench mode"), "{}", bench.stderr);
    assert!(!bench.stderr.contains("about to move"), "{}", bench.stderr);
    let simulated = on_rig(&["--mode", "hil"]).with_code(3);
    assert!(simulated.stderr.contains("torque up to 5 N m"), "{}", simulated.stderr);
    assert!(simulated.stderr.contains("the limit is 0.002 rad"), "{}", simulated.stderr);
}

#[test]
fn another_board_is_neither_commissioned_nor_experimented_with() {
    let (twin, records) = (Twin::start(), Records::new());
    let limits = "torque_nm = 5.0\nload_travel_rad = 3.2\n[power_stage]\ntorque_per_duty_nm = 62.5";
    let file = RigFile::with(&twin.device(), "odrive-v3", limits);
    let (rig, out) = (file.path(), records.out());
    let commission = ["commission", "--rig", &rig, "--mode", "hil", "--yes"];
    let experiment = ["paper", "experiment", "--rig", &rig, "--out", &out];
    for arguments in [[&commission[..], &LIMITS[..4]].concat(), experiment.to_vec()] {
        let ended = program::run(arguments).with_code(4);
        assert!(ended.stderr.contains("its board is native-twin"), "{}", ended.stderr);
        assert!(!ended.stderr.contains("about to move"), "{}", ended.stderr);
        assert!(!ended.stdout.contains("bring the load"), "{}", ended.stdout);
    }
}

#[test]
fn without_the_scale_of_its_amplifier_a_rig_does_not_move() {
    let (twin, records) = (Twin::start(), Records::new());
    let file = RigFile::with(&twin.device(), "native-twin", "torque_nm = 5.0\nload_travel_rad = 3.2");
    let (rig, out) = (file.path(), records.out());
    let commission = ["commission", "--rig", &rig, "--yes"];
    let experiment = ["paper", "experiment", "--rig", &rig, "--out", &out];
    for arguments in [[&commission[..], &LIMITS[..4]].concat(), experiment.to_vec()] {
        let ended = program::run(arguments).with_code(2);
        assert!(ended.stderr.contains("power_stage.torque_per_duty_nm is missing"), "{}", ended.stderr);
    }
}
