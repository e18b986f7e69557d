//! The page of a campaign.

use maud::html;

use super::campaign::input::CampaignResults;
use super::campaign::{distributions, evidence, failures, maps, origin, verdict};
use super::shell::document;

/// A merged campaign as a self-contained HTML document of at most 1 MB, however many runs it has.
#[must_use]
pub fn campaign(results: &CampaignResults<'_>) -> String {
    let has_maps = !results.view.maps.is_empty();
    let content = html! {
        (verdict::section(results))
        (verdict::expectations(results))
        (distributions::section(results))
        (failures::section(results))
        @if has_maps { (maps::section(results)) }
        (evidence::section(results))
        (origin::section(results))
        (origin::repeat(results))
    };
    let mut links =
        vec![("expectations", "Expectations"), ("distributions", "Distributions"), ("failures", "Failures")];
    links.extend(has_maps.then_some(("maps", "Maps")));
    links.extend([("evidence", "Worst runs"), ("origin", "What was run"), ("repeat", "Run it again")]);
    let report = &results.view.report;
    document(&format!("{}: {}", report.verdict, report.title), &links, None, &content)
}
