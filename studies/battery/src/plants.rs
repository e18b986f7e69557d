//! The random plants of `lashloop paper battery`, one by one.

use lashloop_bench::scenario::Override;
use lashloop_bench::scenario::plant::standard;
use lashloop_campaign::plan::{Case, MAX_CASES};
use lashloop_campaign::{Campaign, CampaignError, Selection};

use super::campaign::{Battery, RANDOM_PLANTS, laws};

/// The random plants of a seed.
#[derive(Debug, Clone)]
pub struct RandomPlants(Campaign);

/// A plant and its encoders.
#[derive(Debug, Clone)]
pub struct RandomPlant<'a> {
    campaign: &'a Campaign,
    case: Case,
}

impl RandomPlants {
    /// # Errors
    /// The shipped campaign is wrong.
    pub fn new(seed: u64) -> Result<Self, CampaignError> {
        let selection = Selection {
            seed: Some(seed),
            parts: vec![RANDOM_PLANTS.to_owned()],
            variants: laws()?.into_iter().take(1).collect(),
            points: Some(MAX_CASES),
            ..Selection::default()
        };
        Ok(Self(Battery::Standard.campaign(selection, &standard())?))
    }

    /// # Errors
    /// The index exceeds ten million.
    pub fn plant(&self, index: u32) -> Result<RandomPlant<'_>, CampaignError> {
        Ok(RandomPlant { campaign: &self.0, case: self.0.case(index.into())? })
    }
}

impl RandomPlant<'_> {
    /// As after `lashloop run --set`.
    #[must_use]
    pub fn settings(&self) -> Vec<String> {
        let set = self.campaign.varied(&self.case).into_iter().filter_map(|it| match it {
            Override::Set(setting) => Some(setting),
            Override::Controller(_) | Override::Mode(_) => None,
        });
        set.collect()
    }

    /// The number of a key; `None` if the scenario has no number of this key.
    #[must_use]
    pub fn number(&self, key: &str) -> Option<f64> {
        self.campaign.number(&self.case, key)
    }
}
