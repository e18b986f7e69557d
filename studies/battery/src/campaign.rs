//! The campaign of `lashloop paper battery`, in the program.

use lashloop_campaign::file::CampaignFile;
use lashloop_campaign::{Campaign, CampaignError, Selection, Source};
use lashloop_plant::Plants;

/// The part with random plants. The others vary one quantity each.
pub const RANDOM_PLANTS: &str = "random-plants";

const SOURCES: [(&str, &str); 5] = [
    ("campaigns/battery.toml", include_str!("../../../campaigns/battery.toml")),
    ("campaigns/../scenarios/shaft-pd.toml", include_str!("../../../scenarios/shaft-pd.toml")),
    ("campaigns/../scenarios/shaft-merzouki.toml", include_str!("../../../scenarios/shaft-merzouki.toml")),
    (
        "campaigns/../scenarios/shaft-backlash-inverse.toml",
        include_str!("../../../scenarios/shaft-backlash-inverse.toml"),
    ),
    (
        "campaigns/../scenarios/shaft-braking-curve.toml",
        include_str!("../../../scenarios/shaft-braking-curve.toml"),
    ),
];

/// The campaign, as far as it is selected.
///
/// # Errors
/// The selection names what the campaign lacks.
pub fn campaign(selection: Selection, plants: &Plants) -> Result<Campaign, CampaignError> {
    let source = |(path, text): (&str, &str)| Source { path: path.to_owned(), text: text.to_owned() };
    Campaign::from_sources(SOURCES.map(source).to_vec(), selection, plants)
}

/// Names of its laws, in the order of the tables.
///
/// # Errors
/// The campaign file is wrong.
pub fn laws() -> Result<Vec<String>, CampaignError> {
    let [(path, text), ..] = SOURCES;
    let file = CampaignFile::from_str(path, text)?;
    Ok(file.variants.into_iter().map(|variant| variant.name).collect())
}

/// A law under test.
///
/// # Errors
/// The names there are.
pub fn parse_law(text: &str) -> Result<String, String> {
    let laws = laws().map_err(|error| error.to_string())?;
    if laws.iter().any(|law| law == text) {
        return Ok(text.to_owned());
    }
    let (last, others) = laws.split_last().ok_or("there are no laws")?;
    Err(format!("expected {} or {last}", others.join(", ")))
}

#[cfg(test)]
mod tests;
