//! The campaigns of `lashloop paper battery`, in the program.

use lashloop_campaign::file::CampaignFile;
use lashloop_campaign::{Campaign, CampaignError, Selection, Source};
use lashloop_plant::Plants;

/// The part of the standard battery with random plants. Its others vary one quantity each.
pub const RANDOM_PLANTS: &str = "random-plants";

/// A shipped campaign on plants outside the laws' tuning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Battery {
    /// `campaigns/battery.toml`: parameters of the plant within 30 %.
    Standard,
    /// `campaigns/battery-hard.toml`: real motors, encoders and loads too.
    Hard,
}

type Text = (&'static str, &'static str);

const STANDARD: Text = ("campaigns/battery.toml", include_str!("../data/battery.toml"));
const HARD: Text = ("campaigns/battery-hard.toml", include_str!("../data/battery-hard.toml"));

const SCENARIOS: [Text; 4] = [
    ("campaigns/../scenarios/shaft-pd.toml", include_str!("../data/shaft-pd.toml")),
    ("campaigns/../scenarios/shaft-merzouki.toml", include_str!("../data/shaft-merzouki.toml")),
    (
        "campaigns/../scenarios/shaft-backlash-inverse.toml",
        include_str!("../data/shaft-backlash-inverse.toml"),
    ),
    ("campaigns/../scenarios/shaft-braking-curve.toml", include_str!("../data/shaft-braking-curve.toml")),
];

const MOVES: Text =
    ("campaigns/../scenarios/alternating-moves.csv", include_str!("../data/alternating-moves.csv"));

impl Battery {
    fn sources(self) -> Vec<Text> {
        match self {
            Self::Standard => [STANDARD].into_iter().chain(SCENARIOS).collect(),
            Self::Hard => [HARD].into_iter().chain(SCENARIOS).chain([MOVES]).collect(),
        }
    }

    fn file(self) -> Result<CampaignFile, CampaignError> {
        let (path, text) = match self {
            Self::Standard => STANDARD,
            Self::Hard => HARD,
        };
        Ok(CampaignFile::from_str(path, text)?)
    }

    /// The campaign, as far as it is selected.
    ///
    /// # Errors
    /// The selection names what the campaign lacks.
    pub fn campaign(self, selection: Selection, plants: &Plants) -> Result<Campaign, CampaignError> {
        let source = |(path, text): Text| Source { path: path.to_owned(), text: text.to_owned() };
        Campaign::from_sources(self.sources().into_iter().map(source).collect(), selection, plants)
    }

    /// Names of the parts with random plants, in the order of the tables.
    ///
    /// # Errors
    /// The campaign file is wrong.
    pub fn random_parts(self) -> Result<Vec<String>, CampaignError> {
        let parts = self.file()?.parts.into_iter().filter(|part| part.method.is_sampled());
        Ok(parts.map(|part| part.name).collect())
    }
}

/// Names of the laws, in the order of the tables.
///
/// # Errors
/// The campaign file is wrong.
pub fn laws() -> Result<Vec<String>, CampaignError> {
    Ok(Battery::Standard.file()?.variants.into_iter().map(|variant| variant.name).collect())
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
