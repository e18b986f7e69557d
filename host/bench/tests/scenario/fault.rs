//! The section `[[fault]]`: every kind, defaults and errors.

use lashloop_bench::scenario::Scenario;
use lashloop_bench::scenario::fault::{FaultKind, FrameFault, Way};

use crate::{SHORTEST, read};

/// Every kind, with all its own keys.
const KINDS: [&str; 25] = [
    "kind = \"link-byte-loss\"\nway = \"to-drive\"\nshare = 0.01",
    "kind = \"link-bit-flip\"\nway = \"to-bench\"\nshare = 0.01",
    "kind = \"link-burst\"\nway = \"both\"\nshare = 0.01\nbytes = 12",
    "kind = \"link-duplicate\"\nway = \"both\"\nshare = 0.01",
    "kind = \"link-reorder\"\nway = \"both\"\nshare = 0.01",
    "kind = \"link-delay\"\nway = \"both\"\ndelay_ms = 2.0\njitter_ms = 0.5",
    "kind = \"link-stall\"\nway = \"both\"",
    "kind = \"link-cut\"\nfor_s = 0.25",
    "kind = \"encoder-stuck\"\nside = \"load\"",
    "kind = \"encoder-dead\"\nside = \"motor\"",
    "kind = \"encoder-jump\"\nside = \"motor\"\ncounts = -500",
    "kind = \"encoder-offset\"\nside = \"load\"\ncounts = 40\nover_s = 0.5",
    "kind = \"encoder-lost-counts\"\nside = \"load\"\nshare = 0.1",
    "kind = \"encoder-noise\"\nside = \"load\"\ncounts = 3",
    "kind = \"encoder-reversed\"\nside = \"motor\"",
    "kind = \"torque-saturation\"\nlimit_nm = 2.5",
    "kind = \"torque-gain\"\ngain = -1.0",
    "kind = \"torque-delay\"\nsteps = 5",
    "kind = \"torque-dead\"",
    "kind = \"gap-growth\"\ngrowth_rad = 0.05",
    "kind = \"stiffness-drop\"\nfactor = 0.5",
    "kind = \"load-torque\"\ntorque_nm = -6.0",
    "kind = \"friction-change\"\nfactor = 2.0",
    "kind = \"device-reset\"",
    "kind = \"device-hang\"\nfor_s = 0.25",
];

fn bench_with(faults: &str) -> Result<Scenario, String> {
    read(&format!("{}{faults}", SHORTEST.replace("\"smooth\"", "\"backlash-shaft\"")), &[])
}

fn fault(keys: &str) -> String {
    format!("[[fault]]\nat_s = 0.5\n{keys}\n")
}

#[test]
fn every_kind_is_read_and_printed_back_key_by_key() {
    for keys in KINDS {
        let text = fault(keys);
        let scenario = bench_with(&text).unwrap_or_else(|errors| panic!("{errors}"));
        let printed = scenario.to_toml().expect("TOML");
        for line in text.lines() {
            let (key, value) = line.split_once(" = ").unwrap_or((line, ""));
            let same = printed.lines().any(|printed| printed == line || (value.is_empty() && printed == key));
            assert!(same, "{line:?} is not in\n{printed}");
        }
        assert_eq!(read(&printed, &[]).expect("a good scenario").faults, scenario.faults, "{printed}");
    }
}

#[test]
fn all_kinds_together_keep_their_order_and_names() {
    let text: String = KINDS.into_iter().map(fault).collect();
    let faults = bench_with(&text).expect("a good scenario").faults;
    for (fault, keys) in faults.iter().zip(KINDS) {
        assert!(
            keys.starts_with(&format!("kind = \"{}\"", fault.kind.name())),
            "{} for {keys}",
            fault.kind.name()
        );
    }
    assert_eq!(faults.len(), 25);
}

#[test]
fn the_list_of_kinds_in_the_message_is_the_list_of_this_test() {
    let message = bench_with(&fault("kind = \"gremlin\"")).expect_err("no such kind");
    for keys in KINDS {
        let name = keys.split('"').nth(1).expect("a name");
        assert!(message.contains(&format!("\"{name}\"")), "{name} is not in {message}");
    }
    assert_eq!(message.matches('"').count(), 2 * (KINDS.len() + 1), "{message}");
}

#[test]
fn a_fault_of_the_link_has_both_directions_by_default() {
    let scenario = bench_with(&fault("kind = \"link-delay\"\ndelay_ms = 1")).expect("a good scenario");
    let FaultKind::Frame { fault: FrameFault::Delay { jitter_ms, .. }, way } = scenario.faults[0].kind else {
        panic!("a delay")
    };
    assert_eq!(way, Way::Both);
    assert_eq!((jitter_ms, scenario.faults[0].for_s), (0.0, None));
}

#[test]
fn errors_of_a_fault_name_line_and_key() {
    let wrong = [
        "",
        "kind = \"link-bit-flip\"",
        "kind = \"link-bit-flip\"\nshare = 1.5",
        "kind = \"link-bit-flip\"\nshare = 0.1\nway = \"up\"",
        "kind = \"link-bit-flip\"\nshare = 0.1\nbytes = 3",
        "kind = \"link-burst\"\nshare = 0.1\nbytes = 65",
        "kind = \"link-delay\"\njitter_ms = 1",
        "kind = \"link-cut\"",
        "kind = \"encoder-stuck\"",
        "kind = \"encoder-jump\"\nside = \"motor\"\ncounts = 0.5",
        "kind = \"encoder-offset\"\nside = \"motor\"\ncounts = 5",
        "kind = \"torque-delay\"\nsteps = 0",
        "kind = \"torque-gain\"",
        "kind = \"device-reset\"\nfor_s = 1",
        "kind = \"device-hang\"",
        "kind = \"torque-dead\"\nfor_s = 0",
        "kind = 5",
    ];
    let messages: String = wrong
        .iter()
        .map(|keys| {
            format!("| {}\n{}\n\n", keys.replace('\n', "; "), bench_with(&fault(keys)).expect_err(keys))
        })
        .collect();
    insta::assert_snapshot!(messages);
}

#[test]
fn plant_faults_need_the_backlash_shaft_plant() {
    for keys in KINDS {
        let text = format!("{SHORTEST}{}", fault(keys));
        let of_the_gears = ["gap-growth", "stiffness-drop", "load-torque", "friction-change"]
            .iter()
            .any(|kind| keys.contains(kind));
        match read(&text, &[]) {
            Ok(_) => assert!(!of_the_gears, "{keys}"),
            Err(message) => {
                assert!(of_the_gears, "{message}");
                assert!(
                    message.starts_with("x.toml:13: fault.0.kind: ") && message.contains("plant.model"),
                    "{message}"
                );
            }
        }
    }
}

#[test]
fn a_fault_that_would_begin_after_the_run_is_refused() {
    let at = |at_s: &str| bench_with(&format!("[[fault]]\nat_s = {at_s}\nkind = \"torque-dead\"\n"));
    // The second is before the end, but nearest to a step that isn't.
    for at_s in ["2.0", "1.9996"] {
        let message = at(at_s).expect_err("a fault that never comes");
        let last = "is not before the end of the run, whose last step begins at 1.999 s";
        assert_eq!(message, format!("x.toml:12: fault.0.at_s: {at_s} {last}"));
    }
    assert!(at("1.9994").is_ok());
}
