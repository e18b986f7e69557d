//! The results of `campaigns/link-budget.toml` in the program: the campaign, and the settling time of each case.

use crate::cell::Cell;
use crate::{Campaign, CampaignError, Selection, Source};
use lashloop_plant::Plants;

/// The campaign file, as the tree names it.
pub const CAMPAIGN: &str = "campaigns/link-budget.toml";

const SOURCES: [(&str, &str); 3] = [
    (CAMPAIGN, include_str!("../../data/link-budget.toml")),
    ("campaigns/../scenarios/shaft-merzouki.toml", include_str!("../../data/shaft-merzouki.toml")),
    ("campaigns/../scenarios/shaft-braking-curve.toml", include_str!("../../data/shaft-braking-curve.toml")),
];

/// Columns `case` and `settle_time_s` of its results; the campaign file has the command.
const RESULTS: &str = include_str!("../../data/link-budget.csv");

/// # Errors
/// None, unless the files contradict each other.
pub fn campaign() -> Result<Campaign, CampaignError> {
    let source = |(path, text): (&str, &str)| Source { path: path.to_owned(), text: text.to_owned() };
    Campaign::from_sources(SOURCES.map(source).to_vec(), Selection::default(), &Plants::standard())
}

/// Number and settling time of each case.
pub fn cells() -> impl Iterator<Item = (u64, Cell)> {
    let rows = RESULTS.lines().filter_map(|line| line.split_once(','));
    rows.filter_map(|(case, cell)| Some((case.parse().ok()?, Cell::parse(cell)?)))
}
