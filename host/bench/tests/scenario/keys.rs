//! The page and the JSON Schema of all keys, against the reader.

use std::fs;
use std::path::Path;

use jsonschema::Validator;
use lashloop_bench::scenario::Scenario;
use lashloop_bench::scenario::key::{KeyKind, Keys};
use serde_json::Value;

use crate::messages::CHANGES;
use crate::{SHORTEST, read};

/// Writes both documents.
const WRITE: &str = "cargo run -p lashloop-bench --example scenario_documents";

fn document(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs").join(name);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn validator() -> Validator {
    let schema: Value = serde_json::from_str(&document("scenario.schema.json")).expect("JSON");
    jsonschema::options().build(&schema).expect("a schema")
}

/// A scenario as the schema sees it; `None` if it isn't TOML.
fn json(text: &str) -> Option<Value> {
    toml_edit::de::from_str(text).ok()
}

#[test]
fn the_page_lists_the_keys_of_the_reader() {
    let have = document("scenarios.md");
    assert!(have == Scenario::keys().to_markdown(), "docs/scenarios.md is stale: {WRITE}");
}

#[test]
fn the_schema_lists_the_keys_of_the_reader() {
    let have: Value = serde_json::from_str(&document("scenario.schema.json")).expect("JSON");
    assert!(have == Scenario::keys().to_json_schema(), "docs/scenario.schema.json is stale: {WRITE}");
}

#[test]
fn the_schema_is_one_of_draft_2020_12() {
    let schema: Value = serde_json::from_str(&document("scenario.schema.json")).expect("JSON");
    jsonschema::draft202012::meta::validate(&schema).unwrap_or_else(|error| panic!("{error}"));
}

fn without_meaning(keys: &Keys, path: &str, found: &mut Vec<String>) {
    for key in keys.all() {
        let path = format!("{path}{}", key.name);
        if key.doc.is_empty() {
            found.push(path.clone());
        }
        if let KeyKind::Section(inside) | KeyKind::Sections(inside) = &key.kind {
            without_meaning(inside, &format!("{path}."), found);
        }
    }
}

#[test]
fn every_key_has_a_meaning() {
    let mut found = Vec::new();
    without_meaning(&Scenario::keys(), "", &mut found);
    assert!(found.is_empty(), "no meaning: {}", found.join(", "));
}

#[test]
fn every_key_of_a_printed_scenario_is_listed() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let (validator, mut seen) = (validator(), 0);
    for entry in fs::read_dir(folder).expect("the scenarios") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let written = fs::read_to_string(&path).expect("a scenario");
        let scenario = Scenario::from_file(&path, &[]).unwrap_or_else(|errors| panic!("{errors}"));
        for text in [written, scenario.to_toml().expect("TOML")] {
            let errors: Vec<_> = validator
                .iter_errors(&json(&text).expect("TOML"))
                .map(|error| format!("{}: {error}", error.instance_path()))
                .collect();
            assert!(errors.is_empty(), "{}: {}", path.display(), errors.join("\n"));
        }
        seen += 1;
    }
    assert!(seen >= 14, "{seen} scenarios");
}

/// Rules between keys and files, which the reader alone has.
const BETWEEN_KEYS: [&str; 5] = [
    "is shorter than one control period",
    "can't be read",
    "gives neither min nor max",
    "is not the unit of",
    "is greater than max",
];

#[test]
fn the_schema_refuses_what_the_reader_refuses() {
    let validator = validator();
    assert!(validator.is_valid(&json(SHORTEST).expect("TOML")));
    let mut refused = 0;
    for (written, instead) in CHANGES {
        let text = SHORTEST.replace(written, instead);
        let Some(document) = json(&text) else { continue };
        let message = read(&text, &[]).expect_err(instead);
        let is_between = BETWEEN_KEYS.iter().any(|rule| message.contains(rule));
        assert!(
            is_between || !validator.is_valid(&document),
            "{instead:?} is valid by the schema, but {message}"
        );
        refused += usize::from(!is_between);
    }
    assert!(refused > 40, "{refused} scenarios");
}

#[test]
fn the_schema_has_the_keys_of_each_fault_and_each_plant() {
    let validator = validator();
    let fault = |keys: &str| {
        let text = format!("{}[[fault]]\nat_s = 0.5\n{keys}\n", SHORTEST.replace("smooth", "backlash-shaft"));
        validator.is_valid(&json(&text).expect("TOML"))
    };
    assert!(fault("kind = \"link-bit-flip\"\nshare = 0.5\nway = \"both\""));
    assert!(!fault("kind = \"link-bit-flip\""));
    assert!(!fault("kind = \"link-bit-flip\"\nshare = 0.0"));
    assert!(!fault("kind = \"link-bit-flip\"\nshare = 0.5\nside = \"load\""));
    // The same key has a range of its own in each kind.
    assert!(fault("kind = \"encoder-jump\"\nside = \"load\"\ncounts = -5"));
    assert!(!fault("kind = \"encoder-noise\"\nside = \"load\"\ncounts = -5"));
    let plant = |model: &str, keys: &str| {
        let text = SHORTEST.replace("\"smooth\"", &format!("\"{model}\"\n{keys}"));
        validator.is_valid(&json(&text).expect("TOML"))
    };
    assert!(plant("hard-coulomb", "load_coulomb_nm = 1"));
    assert!(!plant("smooth", "load_coulomb_nm = 1"));
    assert!(plant("backlash-shaft", "load_friction = \"lugre\"\nbristle_stiffness_nm_rad = 1e4"));
    assert!(!plant("backlash-shaft", "load_friction = \"stribeck\"\nbristle_stiffness_nm_rad = 1e4"));
    // Without load_friction its default decides.
    assert!(!plant("backlash-shaft", "bristle_stiffness_nm_rad = 1e4"));
}
