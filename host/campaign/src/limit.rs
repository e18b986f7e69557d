//! Limits on the value of a single run: those of the campaign, or else those of the scenario itself.

use lashloop_plant::metrics::{Metric, Quantity};

use crate::campaign::Campaign;
use crate::cell::Cell;
use crate::error::CampaignError;
use crate::settings::{Limit, Statistic};

impl Limit {
    #[must_use]
    pub const fn value(self) -> f64 {
        match self {
            Self::Max(value) | Self::Below(value) => value,
        }
    }

    /// Whether a magnitude meets the limit; a missing value meets none.
    #[must_use]
    pub fn is_met(self, cell: Cell) -> bool {
        cell.value().is_some_and(|value| match self {
            Self::Max(max) => value <= max,
            Self::Below(below) => value < below,
        })
    }
}

/// The limits of the runs of a part and variant.
#[derive(Debug, Clone, PartialEq)]
pub struct Limits {
    /// For each column that of the campaign's first expectation of any quantile, else the largest value that the scenario allows.
    pub columns: Vec<Option<Limit>>,
    /// Fraction of the runs that may fail.
    pub failures: Option<Limit>,
}

impl Limits {
    /// # Errors
    /// The scenario rejects a setting of the first case.
    pub fn new(campaign: &Campaign, part: usize, variant: usize) -> Result<Self, CampaignError> {
        let names = campaign.file.number_columns();
        let mut limits = Self { columns: vec![None; names.len()], failures: None };
        let (part_name, variant_name) = (&campaign.file.parts[part].name, &campaign.variants[variant].name);
        for expectation in campaign.file.expectations.iter().filter(|it| it.is_of(part_name, variant_name)) {
            match &expectation.what {
                Statistic::Quantile { column, limit, .. } => {
                    let place = names.iter().position(|name| name == column);
                    place.map(|place| limits.columns[place].get_or_insert(*limit));
                }
                Statistic::Pass { least } => {
                    // 1 - 0.9 is less than the fraction of one failure in ten.
                    let most = ((1.0 - least) * 1e12).round() / 1e12;
                    limits.failures.get_or_insert(Limit::Max(most));
                }
            }
        }
        let scenario = campaign.scenario(&campaign.first_case(part, variant))?;
        for expectation in scenario.expectations.iter().filter(|it| it.window.is_none()) {
            if let (Quantity::Metric(metric), Some(max)) = (&expectation.quantity, expectation.max)
                && let Some(place) = Metric::ALL.iter().position(|it| it == metric)
                && max >= 0.0
            {
                limits.columns[place].get_or_insert(Limit::Max(max));
            }
        }
        Ok(limits)
    }
}
