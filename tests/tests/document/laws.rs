//! `docs/laws.md` against the product: minimum times, settling times, parameters and constants of the laws.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use lashloop::{Bench, Outcome, run};
use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_plant::{PlantValue, Plants};
use regex_lite::Regex;
use tests::workspace;

use crate::markdown::table;

/// Numbers of the plant that a movement in one direction leaves without effect, and the one that the study varies.
const UNUSED: [&str; 12] = [
    "substeps",
    "load_friction_asymmetry",
    "load_mode_fraction",
    "load_mode_hz",
    "load_mode_damping",
    "motor_friction_asymmetry",
    "cogging_nm",
    "cogging_per_turn",
    "torque_offset_nm",
    "bristle_stiffness_nm_rad",
    "bristle_damping_nm_s_rad",
    "torque_saturation_nm",
];

fn read(path: &str) -> String {
    fs::read_to_string(workspace().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn page() -> String {
    read("docs/laws.md")
}

/// Torque limit in N m, minimum settled and minimum at rest in s, as the script wrote them.
fn minima() -> Vec<[String; 3]> {
    let text = read("benchmarks/minimum-time/minimum-time.csv");
    let mut minima = csv::Reader::from_reader(text.as_bytes());
    let header = minima.headers().expect("a header").clone();
    let columns = ["torque_limit_nm", "settle_s", "rest_s"]
        .map(|name| header.iter().position(|column| column == name).expect("the column of a minimum"));
    let rows = minima.records().map(|row| row.expect("a row"));
    rows.map(|row| columns.map(|column| row[column].to_owned())).collect()
}

#[test]
fn minimum_times_are_those_of_the_plant_of_the_product() {
    let constant = Regex::new(r"(?m)^([A-Z0-9_]+) = (.+)$").expect("a pattern");
    let script = read("benchmarks/minimum-time/plant_values.py");
    let have: BTreeMap<String, f64> = constant
        .captures_iter(&script)
        .map(|found| (found[1].to_lowercase(), found[2].parse().expect("a number")))
        .collect();
    let plants = Plants::standard();
    let model = plants.get("backlash-shaft").expect("the plant of the study");
    let number = |value| match value {
        PlantValue::Number(number) => Some(number),
        PlantValue::Integer(integer) => Some(integer as f64),
        _ => None,
    };
    let used = model.keys().iter().filter(|key| !UNUSED.contains(&key.name));
    let want: BTreeMap<String, f64> =
        used.filter_map(|key| Some((key.name.to_owned(), key.default_value().and_then(number)?))).collect();
    assert_eq!(have, want);
}

#[test]
fn documented_minimum_times_are_those_of_the_script() {
    let documented = table(&page(), "torque limit, N m");
    let have: Vec<_> = documented.iter().map(|row| &row[..3]).collect();
    assert_eq!(have, minima());
}

/// A run of a scenario of the shaft in process.
fn outcome(scenario: &str, settings: &[&str]) -> Outcome {
    let bench = Bench::new();
    let path = workspace().join(format!("scenarios/shaft-{scenario}.toml"));
    let settings = [settings, &["expect=[]"]].concat();
    let scenario = bench.scenario(path, &settings).unwrap_or_else(|error| panic!("{settings:?}: {error}"));
    run(&scenario, &bench.device("inproc").expect("the drive in process")).expect("a run")
}

fn metric(outcome: &Outcome, name: &str) -> f64 {
    outcome.metric(name).unwrap_or_else(|reason| panic!("{name}: {reason}"))
}

#[test]
fn documented_ratios_to_the_limit_are_those_of_the_laws() {
    let mut want: Vec<Vec<String>> = Vec::new();
    for [limit_nm, settled, at_rest] in minima() {
        let [settled_s, at_rest_s] =
            [settled, at_rest].map(|minimum| minimum.parse::<f64>().expect("a time"));
        let limits = ["plant.torque_saturation_nm", "controller.parameters.torque_limit_nm"]
            .map(|key| format!("{key}={limit_nm}"));
        let times_s = ["merzouki", "backlash-inverse", "braking-curve"]
            .map(|law| metric(&outcome(law, &limits.each_ref().map(String::as_str)), "settle_time_s"));
        let ratios = times_s
            .map(|time_s| format!("{time_s:.2} s, {:.2} ({:.2})", time_s / settled_s, time_s / at_rest_s));
        want.push([limit_nm].into_iter().chain(ratios).collect());
    }
    assert_eq!(table(&page(), "N m"), want);
}

#[test]
fn documented_limits_of_the_braking_curve_are_those_of_runs() {
    let rows = table(&page(), "--set");
    let mut want = Vec::new();
    for row in &rows {
        let outcome = outcome("braking-curve", &[row[0].as_str(), "meant=mismatch"]);
        let mrad = |name| 1e3 * metric(&outcome, name).abs();
        let deviation_rad = outcome.signal("drive.dead_zone_deviation_rad").expect("a signal of the law");
        want.push(vec![
            row[0].clone(),
            format!("{:.3}", metric(&outcome, "settle_time_s")),
            format!("{:.2}", mrad("overshoot_rad")),
            format!("{:.2}", mrad("static_error_rad")),
            format!("{:.1}", mrad("dead_zone_error_rad")),
            format!("{:.1}", 1e3 * deviation_rad.last().expect("a run has samples")),
        ]);
    }
    assert_eq!(rows, want);
}

#[test]
fn every_constant_of_the_laws_is_documented_with_its_value() {
    let constant =
        Regex::new(r"\bconst ([A-Z0-9_]+): (?:f64|u32|\(f64, f64\)) = ([^;]+);").expect("a pattern");
    let mut want = BTreeSet::new();
    for path in sources(&workspace().join("firmware/src/control")) {
        let text = fs::read_to_string(&path).expect("a source of the laws");
        let product = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
        want.extend(constant.captures_iter(product).map(|found| (found[1].to_owned(), found[2].to_owned())));
    }
    let rows = table(&page(), "constant");
    let have: BTreeSet<_> = rows.iter().map(|row| (row[0].clone(), row[1].clone())).collect();
    assert_eq!(have, want);
}

/// The Rust files below a folder, those of tests left out.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries =
        fs::read_dir(folder).expect("a folder of laws").map(|entry| entry.expect("an entry").path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let files = files.into_iter().filter(|path| path.file_name().is_none_or(|name| name != "tests.rs"));
    files.chain(folders.iter().flat_map(|folder| sources(folder))).collect()
}

/// Parameters and defaults in the tables of parameters of a piece of the page.
fn documented_parameters(text: &str) -> BTreeSet<(String, String)> {
    let row = Regex::new(r"(?m)^\| [^|`]*\| `([a-z0-9_]+)` \| ([^|]+) \|").expect("a pattern");
    row.captures_iter(text).map(|found| (found[1].to_owned(), found[2].to_owned())).collect()
}

#[test]
fn every_parameter_of_the_laws_is_documented_with_its_default() {
    let page = page();
    let (laws, _) = page.split_once("\n## Fixed constants\n").expect("the end of the laws");
    let own = Laws::PARAMETERS.iter().skip_while(|parameter| parameter.name != "load_filter_rad_s").skip(1);
    let mut want: BTreeSet<_> =
        own.map(|parameter| (parameter.name.to_owned(), parameter.range.default().to_string())).collect();
    want.insert(("reduction_ratio".to_owned(), "3".to_owned()));
    assert_eq!(documented_parameters(laws), want);
}

#[test]
fn parameters_of_one_law_are_in_its_section() {
    let page = page();
    for (index, name) in Laws::NAMES.iter().enumerate() {
        let (_, section) = page.split_once(&format!("\n## {name}\n")).unwrap_or_else(|| panic!("no {name}"));
        let documented = documented_parameters(section.split("\n## ").next().unwrap_or(section));
        for parameter in Laws::PARAMETERS.iter().filter(|parameter| parameter.laws == 1 << index) {
            let row = (parameter.name.to_owned(), parameter.range.default().to_string());
            assert!(documented.contains(&row), "{name}: {row:?}");
        }
    }
}
