//! `lashloop budget`: its text and exit code. `wire` compares it with runs on a modelled UART, `wall_clock` measures
//! lines.

use tests::program;

#[test]
fn the_budget_says_where_the_time_goes_and_what_to_change() {
    let ended =
        program::run(["budget", "scenarios/smooth-after.toml", "--baud", "460800", "--period-us", "900"])
            .with_code(1);
    assert_eq!(ended.stderr, "");
    insta::assert_snapshot!(ended.stdout);
}

#[test]
fn exit_code_is_1_if_the_worst_cycle_exceeds_the_period() {
    // 35 bytes at 460,800 Bd take 0.76 of 0.86 ms, and telemetry of 5 signals delays the torque by 0.08 ms, of 6 by 0.16 ms.
    for (options, code) in [
        (&["budget"][..], 0),
        (&["budget", "--baud", "460800", "--period-us", "900", "--signals", "6"], 1),
        (&["budget", "--baud", "460800", "--period-us", "900", "--signals", "5"], 0),
        (&["budget", "--baud", "460800", "--period-us", "900", "--telemetry-every", "0"], 0),
        (&["budget", "--baud", "460800", "--signals", "6"], 0),
        // The first law has more signals than fit behind a torque at this speed.
        (&["budget", "--baud", "460800"], 1),
        (&["budget", "scenarios/shaft-pd.toml", "--baud", "115200"], 1),
        (&["budget", "scenarios/shaft-pd.toml", "--baud", "115200", "--period-us", "8000"], 0),
        (&["budget", "--baud", "100"], 2),
        (&["budget", "scenarios/none.toml"], 2),
    ] {
        let _ = program::run(options).with_code(code);
    }
}

#[test]
fn port_without_a_drive_and_scenario_without_a_map_are_errors() {
    for (options, code, words) in [
        (&["budget", "--measured", "/dev/no-such-terminal"][..], 4, "/dev/no-such-terminal"),
        (&["budget", "scenarios/shaft-pd.toml", "--measured", "inproc"], 2, "has no law pd"),
        (&["budget", "--measured", "inproc", "--map", "scenarios"], 2, "scenarios/campaign.json"),
        (&["budget", "--rounds", "100"], 2, "--measured"),
    ] {
        let ended = program::run(options).with_code(code);
        assert!(ended.stderr.contains(words), "{options:?}: {}", ended.stderr);
    }
}
