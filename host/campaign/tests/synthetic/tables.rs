//! The table of a reference belongs to the campaign.

use std::fs;
use std::path::Path;

use lashloop_bench::scenario::plant::standard;
use lashloop_campaign::{Campaign, Selection};
use lashloop_plant::reference::Reference;
use tempfile::tempdir;

use crate::support::facts;

fn folder_with(points: &str) -> tempfile::TempDir {
    let folder = tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let scenario = include_str!("../../../../scenarios/shaft-triangle.toml");
    fs::write(path("triangle.toml"), scenario).expect("a scenario");
    fs::write(path("triangle.csv"), points).expect("a table");
    fs::write(path("c.toml"), include_str!("table.toml")).expect("a campaign");
    folder
}

fn read(folder: &Path) -> Campaign {
    Campaign::read(&folder.join("c.toml"), Selection::default(), &standard()).expect("a campaign")
}

const POINTS: &str = include_str!("../../../../scenarios/triangle.csv");

#[test]
fn campaign_with_another_table_is_another_campaign() {
    let folder = folder_with(POINTS);
    let before = facts(&read(folder.path()), 1);
    fs::write(folder.path().join("triangle.csv"), format!("{POINTS}1000,0\n")).expect("a table");
    let (what, there, here) = before.difference(&facts(&read(folder.path()), 1)).expect("a difference");
    assert_eq!(what, "scenarios' SHA-256");
    assert_ne!(there, here);
}

#[test]
fn case_is_made_from_the_facts_alone() {
    let folder = folder_with(POINTS);
    let campaign = read(folder.path());
    let facts = facts(&campaign, 1);
    drop(folder);
    let again = facts.campaign(&standard()).expect("the campaign");
    for number in 0..2 {
        let reference = |campaign: &Campaign| {
            let case = campaign.case(number).expect("a case");
            campaign.scenario(&case).expect("a scenario").reference
        };
        assert!(matches!(reference(&again), Reference::Table(_)));
        assert_eq!(reference(&again), reference(&campaign));
    }
}
