//! A commissioning in bench mode on virtual silicon, of plants that it doesn't know.
//!
//! One boot for all motions of a plant; each motion begins where the one before has ended. About half of the motions
//! have an encoder reversed by the drive.

use std::{env, fs};

use serde_json::Value;
use tests::program;
use tests::records::Records;

use crate::hidden_plant_keys::KEYS;
use crate::hidden_plants::{Coverage, HiddenPlant, Shown};

/// A plant takes some 10 s of a core, so the whole test command has a few of them.
const SEEDS: std::ops::Range<u64> = 7000..7004;
/// Variable of the environment with other seeds, `FIRST..END`.
const VARIABLE: &str = "LASHLOOP_HIDDEN_PLANTS";
const LIMITS: [&str; 8] = [
    "--torque-limit",
    "12",
    "--motor-speed-limit",
    "800",
    "--load-speed-limit",
    "10",
    "--travel-limit",
    "0.4",
];

/// Nine of ten truths are within their interval; of few plants one may miss.
pub(crate) fn hidden_plants() {
    let mut coverage = Coverage::default();
    for seed in seeds() {
        commission(seed, &mut coverage);
    }
    let text = format!("commissioning on virtual silicon, {coverage}");
    print!("{text}");
    let reports = tests::workspace().join("target/reports");
    let written =
        fs::create_dir_all(&reports).and_then(|()| fs::write(reports.join("commissioning.txt"), text));
    written.expect("a report");
    let missed = coverage.missed();
    assert!(missed.is_empty(), "truth outside the interval too often:\n{}", missed.join("\n"));
    assert!(coverage.fraction() >= 0.9, "{coverage}");
}

/// The first reach of the drive behind its pins meets what the simulation on the estimates expects of it.
fn confirm(seed: u64, plant: &HiddenPlant, records: &Records) {
    let reach = records.path("reach.toml");
    let text = fs::read_to_string(&reach).unwrap_or_else(|error| panic!("plant {seed}: no reach: {error}"));
    assert!(text.contains("load_direction = \"forward\""), "plant {seed}: {text}");
    let settings = KEYS.map(|key| format!("plant.{key}={:?}", plant.truth(key)));
    let settings = settings.iter().flat_map(|setting| ["--set", setting]);
    let fixed = ["run", reach.to_str().expect("UTF-8"), "--device", "silicon", "--set", "run.duration_s=15"];
    let _ = program::run(fixed.into_iter().chain(settings)).with_code(0);
}

fn seeds() -> std::ops::Range<u64> {
    let Ok(text) = env::var(VARIABLE) else { return SEEDS };
    let range = text.split_once("..").and_then(|(from, to)| Some(from.parse().ok()?..to.parse().ok()?));
    range.unwrap_or_else(|| panic!("{VARIABLE} is {text:?}; it must be FIRST..END"))
}

fn commission(seed: u64, coverage: &mut Coverage) {
    let (plant, records) = (HiddenPlant::draw(seed), Records::new());
    let mut settings = vec!["bench.torque_per_duty_nm=30".to_owned(), "bench.twist_limit_rad=40".to_owned()];
    settings.extend(KEYS.map(|key| format!("plant.{key}={:?}", plant.truth(key))));
    let start = &plant.start;
    settings.push(format!("plant.initial.load_position_rad={:?}", start.load_position_rad));
    settings.push(format!("plant.initial.motor_position_rad={:?}", start.motor_position_rad));
    for (at, encoder) in ["motor", "load"].into_iter().enumerate() {
        settings.push(format!("encoders.{encoder}_counts_per_rev={}", plant.counts_per_rev[at]));
        if plant.signs[at] < 0 {
            settings.push(format!("bench.{encoder}_direction=reverse"));
        }
    }
    let out = records.out();
    let fixed = ["commission", "--device", "silicon", "--mode", "bench", "--yes", "--out", &out];
    let settings = settings.iter().flat_map(|setting| ["--set", setting]);
    let ended = program::run(fixed.into_iter().chain(LIMITS).chain(settings));
    let is_followed = ended.code == Some(0);
    assert!(is_followed || ended.code == Some(3), "plant {seed}: {}\n{}", ended.stdout, ended.stderr);
    let text = fs::read_to_string(records.path("estimates.json"))
        .unwrap_or_else(|error| panic!("plant {seed}: {error}\n{}\n{}", ended.stdout, ended.stderr));
    let estimates: Value = serde_json::from_str(&text).expect("JSON");
    // The encoders of virtual silicon count forward, so a drive needs that setting, not the one that the motions had.
    let parameters = fs::read_to_string(records.path("drive.toml")).expect("the parameters of the drive");
    for encoder in ["motor", "load"] {
        assert_eq!(estimates["directions"][encoder], "forward", "{encoder} encoder of plant {seed}");
        let line = format!("\n{encoder}_direction = \"forward\"");
        assert!(parameters.contains(&line), "plant {seed}: {parameters}");
    }
    coverage.plant(is_followed);
    // The reach takes as long as the motions, so one plant makes it.
    if is_followed && seed == seeds().start {
        confirm(seed, &plant, &records);
    }
    for quantity in estimates["quantities"].as_array().expect("quantities") {
        let name = quantity["name"].as_str().expect("a name");
        if !plant.has_truth(name) {
            continue;
        }
        let end = |key: &str| quantity["estimate"][key].as_f64();
        let shown = end("low").zip(end("high"));
        let truth = plant.truth(name);
        coverage.quantity(seed, name, shown.map(|(low, high)| Shown { low, high, truth }));
    }
}
