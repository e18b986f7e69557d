//! The random plants of `lashloop paper battery`, with or without `--hard`, one by one.

use lashloop_bench::scenario::Override;
use lashloop_bench::scenario::plant::standard;
use lashloop_campaign::cell::CaseNumbers;
use lashloop_campaign::plan::{Case, MAX_CASES};
use lashloop_campaign::settings::Divisor;
use lashloop_campaign::{Campaign, CampaignError, Selection};

use super::campaign::{Battery, RANDOM_PLANTS, laws};

/// The random plants of a part and a seed.
#[derive(Debug, Clone)]
pub struct RandomPlants(Campaign);

/// A plant and its encoders.
#[derive(Debug, Clone)]
pub struct RandomPlant<'a> {
    campaign: &'a Campaign,
    case: Case,
}

impl RandomPlants {
    /// Those of the standard battery.
    ///
    /// # Errors
    /// The shipped campaign is wrong.
    pub fn new(seed: u64) -> Result<Self, CampaignError> {
        Self::of(Battery::Standard, RANDOM_PLANTS, seed)
    }

    /// Those of a part of a battery.
    ///
    /// # Errors
    /// The battery lacks the part, or the shipped campaign is wrong.
    pub fn of(battery: Battery, part: &str, seed: u64) -> Result<Self, CampaignError> {
        let selection = Selection {
            seed: Some(seed),
            parts: vec![part.to_owned()],
            // The last law gets all that a part states to the drive.
            variants: laws()?.pop().into_iter().collect(),
            points: Some(MAX_CASES),
            ..Selection::default()
        };
        Ok(Self(battery.campaign(selection, &standard())?))
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

    /// The shortest `settle_time_s` of the plant; `None` if its motor can't move the load.
    #[must_use]
    pub fn minimum_settle_time_s(&self) -> Option<f64> {
        (self.campaign, &self.case).quantity(Divisor::MinimumSettleTime)
    }

    /// The number of a key; `None` if the scenario has no number of this key.
    #[must_use]
    pub fn number(&self, key: &str) -> Option<f64> {
        self.campaign.number(&self.case, key)
    }
}
