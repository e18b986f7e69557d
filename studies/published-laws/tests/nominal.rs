//! The table on the nominal plant: its digits are those of the comparison in `docs/laws.md`.

use std::fs;
use std::path::Path;

use published_laws::PublishedLaws;
use published_laws::study::case::{Plant, figures_on};
use published_laws::study::laws::{LAWS, Tuned};
use published_laws::study::table::{ORDINARY, Row, markdown};

use lashloop::Bench;
use lashloop_firmware::law::LawSet;

#[test]
fn table_of_the_nominal_plant_is_that_of_the_document() {
    let rows = LAWS.map(|law| Row { law, figures: figures_on(&law, &[Plant::Nominal]).expect("a run") });
    let have = markdown(ORDINARY, &rows);
    let document = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/laws.md");
    let document = fs::read_to_string(document).expect("the document");
    assert!(document.contains(&have), "docs/laws.md has another table of the nominal plant than\n\n{have}");
}

#[test]
fn constants_of_each_scenario_are_in_the_searched_range() {
    let bench = Bench::new().with_laws::<PublishedLaws>();
    for law in LAWS.iter().filter(|law| !law.ours && !law.tuned.is_empty()) {
        assert!(PublishedLaws::NAMES.contains(&law.name), "{}", law.name);
        bench.scenario_from_str(law.scenario, &[]).expect("a valid scenario");
        for Tuned { name, range: [low, high] } in law.tuned {
            let line = law.scenario.lines().find(|line| line.split(' ').next() == Some(name));
            let value =
                line.and_then(|line| line.split(" = ").nth(1)?.split(' ').next()?.parse::<f64>().ok());
            let value = value.unwrap_or_else(|| panic!("{}: no {name}", law.name));
            assert!((*low..=*high).contains(&value), "{}: {name} = {value}", law.name);
        }
    }
}
