//! `docs/laws.md` against the product: minimum times, settling times of the laws, and their constants.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use lashloop::{Bench, run};
use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_plant::{PlantValue, Plants};
use regex_lite::Regex;
use tests::workspace;

use crate::markdown::rows;

const MINIMUM_TIME: &str = "benchmarks/minimum-time";
/// Keys of the plant without effect on a movement in one direction, or varied.
const UNUSED: [&str; 3] = ["substeps", "load_friction_asymmetry", "torque_saturation_nm"];

fn read(path: impl AsRef<Path>) -> String {
    let path = workspace().join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn page() -> String {
    read("docs/laws.md")
}

/// The minima of the script: torque limit, at rest, settled.
fn minima() -> Vec<[String; 3]> {
    let text = read(format!("{MINIMUM_TIME}/minimum-time.csv"));
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let header = table.headers().expect("a header").clone();
    let columns = ["torque_limit_nm", "rest_s", "settle_s"]
        .map(|name| header.iter().position(|column| column == name).expect("the column of a minimum"));
    let records = table.records().map(|record| record.expect("a row"));
    records.map(|record| columns.map(|column| record[column].to_owned())).collect()
}

#[test]
fn minimum_times_are_of_the_plant_of_the_product() {
    let constant = Regex::new(r"(?m)^([A-Z0-9_]+) = (.+)$").expect("a pattern");
    let script = read(format!("{MINIMUM_TIME}/plant_values.py"));
    let have: BTreeMap<String, f64> = (constant.captures_iter(&script))
        .map(|found| (found[1].to_lowercase(), found[2].parse().expect("a number")))
        .collect();
    let plants = Plants::standard();
    let model = plants.get("backlash-shaft").expect("the plant of the study");
    let defaults = model.defaults();
    let mut want = BTreeMap::new();
    for key in model.keys().iter().filter(|key| !UNUSED.contains(&key.name)) {
        match defaults.get(key.name) {
            Some(PlantValue::Number(number)) => want.insert(key.name.to_owned(), *number),
            Some(PlantValue::Integer(integer)) => want.insert(key.name.to_owned(), *integer as f64),
            _ => None,
        };
    }
    want.retain(|key, _| !key.starts_with("bristle_"));
    assert_eq!(have, want);
}

#[test]
fn documented_minimum_times_are_those_of_the_script() {
    let documented: Vec<_> = rows(&page(), "torque limit, N m").into_iter().map(|row| row[..3].to_vec()).collect();
    assert_eq!(documented, minima().map(|row| row.to_vec()));
}

#[test]
fn documented_settling_times_and_ratios_are_those_of_the_laws() {
    let bench = Bench::new();
    let device = bench.device("inproc").expect("the drive in process");
    let table = rows(&page(), "N m");
    let minima = minima();
    assert_eq!(table.len(), minima.len());
    for (row, [limit_nm, rest_s, settle_s]) in table.iter().zip(&minima) {
        let mut want = vec![limit_nm.clone()];
        for law in ["merzouki", "backlash-inverse", "braking-curve"] {
            let limits = ["plant.torque_saturation_nm", "controller.parameters.torque_limit_nm"]
                .map(|key| format!("{key}={limit_nm}"));
            let mut settings: Vec<&str> = limits.iter().map(String::as_str).collect();
            settings.push("expect=[]");
            let path = workspace().join(format!("scenarios/shaft-{law}.toml"));
            let scenario = bench.scenario(path, &settings).expect("the scenario of the law");
            let outcome = run(&scenario, &device).expect("a run");
            let have_s = outcome.metric("settle_time_s").expect("the law settles");
            let [rest_s, settle_s] = [rest_s, settle_s].map(|minimum| minimum.parse::<f64>().expect("a time"));
            want.push(format!("{have_s:.2} s: {:.2} ({:.2})", have_s / settle_s, have_s / rest_s));
        }
        assert_eq!(row, &want);
    }
}

#[test]
fn every_constant_of_a_law_is_documented_with_its_value() {
    let constant = Regex::new(r"const ([A-Z0-9_]+): (?:f64|u32) = ([^;]+);").expect("a pattern");
    let mut want = BTreeSet::new();
    for path in sources(&workspace().join("firmware/src/control")) {
        let text = fs::read_to_string(&path).expect("a source of the laws");
        let product = text.split("#[cfg(test)]").next().unwrap_or_default();
        want.extend(constant.captures_iter(product).map(|found| (found[1].to_owned(), found[2].to_owned())));
    }
    let table = rows(&page(), "constant");
    let have: BTreeSet<_> = table.iter().map(|row| (row[0].clone(), row[1].clone())).collect();
    assert_eq!(have, want, "constants of firmware/src/control, and the table of docs/laws.md");
}

/// The Rust files below a folder, without those of tests.
fn sources(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder of laws").map(|entry| entry.expect("an entry").path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let files = files.into_iter().filter(|path| path.file_name().is_none_or(|name| name != "tests.rs"));
    files.chain(folders.iter().flat_map(|folder| sources(folder))).collect()
}

#[test]
fn every_parameter_of_a_law_is_named_in_its_section() {
    let page = page();
    for (index, law) in Laws::NAMES.iter().enumerate() {
        let (_, section) = page.split_once(&format!("\n## {law}\n")).unwrap_or_else(|| panic!("no section {law}"));
        let section = section.split("\n## ").next().unwrap_or(section);
        for parameter in Laws::PARAMETERS.iter().filter(|parameter| parameter.laws == 1 << index) {
            assert!(section.contains(&format!("`{}`", parameter.name)) || section.contains(parameter.name), "{law}: {}", parameter.name);
        }
    }
}
