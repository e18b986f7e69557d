//! Directions between the crates of the repository.

use anyhow::{Context, Result};
use serde_json::{Value, json};

/// Each crate with the crates of the repository that it may depend on, development dependencies apart.
const ALLOWED: [(&str, &[&str]); 33] = [
    ("lashloop-protocol", &[]),
    ("lashloop-firmware", &["lashloop-protocol"]),
    ("lashloop-plant", &[]),
    // The drive's library is for the in-process link.
    ("lashloop-link", &["lashloop-protocol", "lashloop-firmware"]),
    // The plant's crate is for its signals with their units, which a drive has alike.
    ("lashloop-session", &["lashloop-protocol", "lashloop-plant", "lashloop-link"]),
    // The drive's library is for the in-process device and the native twin.
    (
        "lashloop-bench",
        &["lashloop-protocol", "lashloop-plant", "lashloop-firmware", "lashloop-link", "lashloop-session"],
    ),
    ("lashloop-record", &["lashloop-protocol", "lashloop-plant", "lashloop-session", "lashloop-bench"]),
    ("lashloop-identify", &["lashloop-plant"]),
    ("lashloop-response", &["lashloop-plant"]),
    (
        "lashloop",
        &[
            "lashloop-protocol",
            "lashloop-plant",
            "lashloop-firmware",
            "lashloop-link",
            "lashloop-session",
            "lashloop-bench",
            "lashloop-record",
            // For `bode`, a run of the library.
            "lashloop-response",
        ],
    ),
    // A drive is checked without a bench.
    ("lashloop-conformance", &["lashloop-protocol", "lashloop-link", "lashloop-session"]),
    (
        "lashloop-decode",
        &[
            "lashloop-protocol",
            "lashloop-plant",
            "lashloop-link",
            "lashloop-session",
            "lashloop-bench",
            "lashloop-record",
        ],
    ),
    (
        "lashloop-hardware",
        &[
            "lashloop-protocol",
            "lashloop-plant",
            "lashloop-link",
            "lashloop-session",
            "lashloop-bench",
            "lashloop-record",
            "lashloop-identify",
            "lashloop",
        ],
    ),
    (
        "lashloop-campaign",
        &[
            "lashloop-protocol",
            "lashloop-plant",
            "lashloop-link",
            "lashloop-session",
            "lashloop-bench",
            "lashloop-record",
            "lashloop",
        ],
    ),
    ("lashloop-plot", &[]),
    (
        "lashloop-report",
        &[
            "lashloop-plant",
            "lashloop-session",
            "lashloop-bench",
            "lashloop-record",
            "lashloop-campaign",
            "lashloop-plot",
            "lashloop-response",
        ],
    ),
    (
        "lashloop-live",
        &["lashloop-protocol", "lashloop-plant", "lashloop-bench", "lashloop-record", "lashloop-report"],
    ),
    // A plant's process of its own: it shares the protocol with the bench and no code.
    ("lashloop-fmu", &[]),
    (
        "lashloop-fmu-export",
        &[
            "lashloop-protocol",
            "lashloop-plant",
            "lashloop-link",
            "lashloop-session",
            "lashloop-bench",
            "lashloop",
        ],
    ),
    ("lashloop-fmu-library", &["lashloop-fmu-export"]),
    // Studies, of which the command line has the commands.
    ("merzouki-2005", &["lashloop-plant", "lashloop-bench", "lashloop-record", "lashloop-plot", "lashloop"]),
    ("lashloop-battery", &["lashloop-plant", "lashloop-bench", "lashloop-campaign"]),
    (
        "lashloop-cli",
        &[
            "lashloop-protocol",
            "lashloop-firmware",
            "lashloop-plant",
            "lashloop-link",
            "lashloop-session",
            "lashloop-bench",
            "lashloop-record",
            "lashloop-identify",
            "lashloop",
            "lashloop-conformance",
            "lashloop-decode",
            "lashloop-hardware",
            "lashloop-campaign",
            "lashloop-report",
            "lashloop-response",
            "lashloop-live",
            "lashloop-fmu-export",
            "merzouki-2005",
            "lashloop-battery",
        ],
    ),
    (
        "tests",
        &[
            "lashloop-protocol",
            "lashloop-firmware",
            "lashloop-plant",
            "lashloop-link",
            "lashloop-session",
            "lashloop-bench",
            "lashloop-record",
            "lashloop-identify",
            "lashloop",
            "lashloop-conformance",
            "lashloop-decode",
            "lashloop-hardware",
            "lashloop-campaign",
            "lashloop-report",
            "lashloop-response",
            "lashloop-battery",
            "lashloop-cli",
        ],
    ),
    ("xtask", &["lashloop-protocol"]),
    ("lashloop-silicon", &["lashloop-plant"]),
    ("silicon-probe", &[]),
    (
        "lashloop-fuzz",
        &[
            "lashloop-protocol",
            "lashloop-firmware",
            "lashloop-link",
            "lashloop-session",
            "lashloop-bench",
            // The readers of files.
            "lashloop",
            "lashloop-campaign",
            "lashloop-decode",
            "lashloop-hardware",
            "lashloop-record",
        ],
    ),
    ("benchmark-codec", &["lashloop-protocol"]),
    ("benchmark-plant", &["lashloop-plant", "lashloop-firmware", "lashloop-bench", "lashloop-campaign"]),
    // Crates of a user: they may use what is for users.
    ("own-law", &["lashloop-firmware", "lashloop", "lashloop-cli"]),
    ("own-plant", &["lashloop-plant", "lashloop", "lashloop-cli"]),
    ("published-laws", &["lashloop-firmware", "lashloop", "lashloop-cli", "lashloop-battery"]),
];

/// Dependencies that the table doesn't allow, one sentence each.
///
/// # Errors
/// A package isn't as cargo describes it.
pub(crate) fn wrong_ways(packages: &[Value]) -> Result<Vec<String>> {
    let members: Vec<_> = packages.iter().filter_map(|package| package["name"].as_str()).collect();
    let mut wrong = Vec::new();
    for package in packages {
        let name = package["name"].as_str().context("a package has no name")?;
        let Some((_, allowed)) = ALLOWED.iter().find(|(known, _)| *known == name) else {
            wrong.push(format!("crate {name} is not in the table of tests/tests/tree/directions/crates.rs"));
            continue;
        };
        let dependencies = package["dependencies"].as_array().context("a package has no dependencies")?;
        let used = dependencies.iter().filter(|dependency| dependency["kind"].as_str() != Some("dev"));
        for used in used.filter_map(|dependency| dependency["name"].as_str()) {
            if members.contains(&used) && !allowed.contains(&used) {
                wrong.push(format!("crate {name} must not depend on {used}"));
            }
        }
    }
    Ok(wrong)
}

#[test]
fn a_dependency_against_the_direction_is_named() {
    let dependency = |name: &str, kind: Option<&str>| json!({ "name": name, "kind": kind });
    let packages = [
        json!({ "name": "lashloop-protocol", "dependencies": [dependency("crc", None)] }),
        json!({ "name": "lashloop-plant", "dependencies": [
            dependency("lashloop-protocol", None), dependency("lashloop-bench", Some("dev")),
        ] }),
        json!({ "name": "lashloop-bench", "dependencies": [dependency("lashloop-plant", None)] }),
        json!({ "name": "newcomer", "dependencies": [] }),
    ];
    let want = [
        "crate lashloop-plant must not depend on lashloop-protocol",
        "crate newcomer is not in the table of tests/tests/tree/directions/crates.rs",
    ];
    assert_eq!(wrong_ways(&packages).expect("packages"), want);
}
