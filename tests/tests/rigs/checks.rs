//! `lashloop rig check` and `lashloop rig keys`.

use std::process::Command;

use tests::program::{self, Ended, Running};
use tests::twin::Twin;

use crate::bench::RigFile;

/// A check with no program in `PATH`.
fn check(rig: &RigFile) -> Ended {
    let mut command = Command::new(program::lashloop());
    command.args(["rig", "check", &rig.path()]).env("PATH", "");
    Running::start_command(command).wait()
}

/// The state and subject of each finding.
fn findings(ended: &Ended) -> Vec<(&str, &str)> {
    // The columns of a finding.
    ended.stdout.lines().map(|line| (line[..6].trim(), line[7..21].trim())).collect()
}

#[test]
fn everything_about_a_rig_is_found_without_motion() {
    let twin = Twin::start();
    let ended = check(&RigFile::new(&twin.device())).with_code(0);
    let want = [
        ("ok", "rig"),
        ("ok", "open"),
        ("n/a", "DTR"),
        ("n/a", "latency timer"),
        ("ok", "drain"),
        ("ok", "handshake"),
        ("ok", "round trip"),
        ("n/a", "speed"),
        ("ok", "board"),
        ("ok", "build"),
        ("n/a", "pins"),
        ("ok", "limit"),
        ("n/a", "loader"),
    ];
    assert_eq!(findings(&ended), want, "{}", ended.stdout);
    assert!(ended.stdout.contains("the drive offers none"), "{}", ended.stdout);
}

#[test]
fn a_wrong_board_and_a_limit_beyond_the_drive_are_found() {
    let twin = Twin::start();
    let limits = "torque_nm = 1000.0\nload_travel_rad = 2.0\nmotor_speed_rad_s = 0.05";
    let limits = format!("{limits}\n[loader]\nvia = \"dfu\"");
    // No program is in `PATH`.
    let ended = check(&RigFile::with(&twin.device(), "odrive-v3", &limits)).with_code(1);
    let wrong: Vec<_> = findings(&ended).into_iter().filter(|(health, _)| *health == "WRONG").collect();
    assert_eq!(wrong, [("WRONG", "board"), ("WRONG", "limit"), ("WRONG", "loader")], "{}", ended.stdout);
    assert!(ended.stdout.contains("limits.motor_speed_rad_s: "), "{}", ended.stdout);
}

#[test]
fn an_absent_rig_is_never_fine() {
    let ended = check(&RigFile::new("/dev/serial/by-id/usb-none")).with_code(5);
    assert!(ended.stdout.contains("WRONG  port           hardware absent: there is no"), "{}", ended.stdout);
}

#[test]
fn a_port_without_a_drive_is_no_rig() {
    let terminal = tests::terminal::open();
    let ended = check(&RigFile::new(&tests::terminal::device(&terminal))).with_code(4);
    assert!(ended.stdout.contains("WRONG  handshake"), "{}", ended.stdout);
}

#[test]
fn a_name_that_another_adapter_can_take_is_an_error() {
    let ended = check(&RigFile::new("/dev/ttyUSB0")).with_code(2);
    assert!(
        ended
            .stderr
            .contains("rig.toml:5: port.device: \"/dev/ttyUSB0\" is a name that another adapter can take"),
        "{}",
        ended.stderr
    );
}

#[test]
fn the_keys_are_printed_as_page_and_schema() {
    let page = program::run(["rig", "keys"]).with_code(0).stdout;
    assert!(page.starts_with("# Rig files") && page.contains("`torque_per_duty_nm`"), "{page}");
    let schema = program::run(["rig", "keys", "--schema"]).with_code(0).stdout;
    let schema: serde_json::Value = serde_json::from_str(&schema).expect("JSON");
    assert_eq!(
        schema["properties"]["limits"]["required"],
        serde_json::json!(["torque_nm", "load_travel_rad"])
    );
}
