//! What the page of a campaign is made of.

use std::path::Path;

use lashloop_campaign::Campaign;
use lashloop_campaign::cell::Cell;
use lashloop_campaign::facts::Facts;
use lashloop_campaign::report::Group;
use lashloop_campaign::settings::Limit;
use lashloop_campaign::view::View;
use maud::{Markup, html};

use super::super::input::Run;
use super::super::typeset::{self, apart, shown};

/// A merged campaign.
#[derive(Debug, Clone, Copy)]
pub struct CampaignResults<'a> {
    /// The campaign.
    pub campaign: &'a Campaign,
    /// What its rows come from.
    pub facts: &'a Facts,
    /// Its report with what the page draws.
    pub view: &'a View,
    /// Cases whose records are kept, the worst ones first; `None` for a record that is not there.
    pub evidence: &'a [(u64, Option<Run>)],
    /// Folder of the results, as the commands of the page name it.
    pub folder: &'a Path,
}

impl CampaignResults<'_> {
    /// Part and variant; the part alone or the variant alone if there is one of the other.
    pub(super) fn name(&self, group: &Group) -> String {
        match (self.campaign.file.parts.len(), self.campaign.variants.len()) {
            (_, 1) => group.part.clone(),
            (1, _) => group.variant.clone(),
            _ => format!("{}, {}", group.part, group.variant),
        }
    }
}

/// A number with all its digits as a hint, or the reason for its absence.
pub(super) fn number(cell: Cell, limit: Option<f64>) -> Markup {
    match cell {
        Cell::Value(value) => html! { data value=(value) title=(value) { (apart(value, limit, None)) } },
        Cell::Missing(reason) => html! { span.absent { (reason.word()) } },
    }
}

/// A limit with its sign.
pub(super) fn limit(limit: Limit) -> String {
    match limit {
        Limit::Max(max) => format!("\u{2264} {}", shown(max)),
        Limit::Below(below) => format!("< {}", shown(below)),
    }
}

/// A quantity with its unit, for an axis. A factor of a key has no unit of its own.
pub(super) fn quantity(name: &str, unit: &str, times: Option<&str>) -> String {
    match (times, unit) {
        (Some(key), _) if key == name => format!("factor of {key}"),
        (Some(key), _) => format!("{name}, factor of {key}"),
        (None, "") => name.to_owned(),
        (None, unit) => format!("{name} in {}", typeset::unit(unit)),
    }
}
