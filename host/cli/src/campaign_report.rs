//! The page of a merged campaign.

use std::path::Path;

use lashloop_campaign::Campaign;
use lashloop_campaign::evidence::{self, Pick};
use lashloop_campaign::facts::{CAMPAIGN, Facts};
use lashloop_campaign::merge::RESULTS;
use lashloop_campaign::table::Table;
use lashloop_campaign::view::View;
use lashloop_record::file_names::SUMMARY_FILE;
use lashloop_report::page::{self, CampaignResults};

use super::error::CliError;
use super::options::plants;
use lashloop::Bench;

/// Whether a folder holds a merged campaign.
pub(super) fn is_campaign(folder: &Path) -> bool {
    folder.join(CAMPAIGN).is_file() && folder.join(RESULTS).is_file()
}

/// The page of a campaign and its evidence.
pub(super) fn page(
    folder: &Path,
    campaign: &Campaign,
    facts: &Facts,
    view: &View,
    picks: &[Pick],
) -> Result<String, CliError> {
    let record = |pick: &Pick| {
        let record = evidence::folder_of(folder, pick.case);
        // An interrupted command leaves some records out.
        let run =
            record.join(SUMMARY_FILE).is_file().then(|| page::Run::read(pick.case.to_string(), &record));
        Ok::<_, CliError>((pick.case, run.transpose()?))
    };
    let evidence = picks.iter().map(record).collect::<Result<Vec<_>, _>>()?;
    Ok(page::campaign(&CampaignResults { campaign, facts, view, evidence: &evidence, folder }))
}

/// The page of the merged campaign in a folder.
pub(super) fn page_of(folder: &Path, bench: &Bench) -> Result<String, CliError> {
    let facts = Facts::read(&folder.join(CAMPAIGN))?;
    let campaign = facts.campaign(&plants(bench))?;
    let results = folder.join(RESULTS);
    let table = Table::new(&campaign, &results);
    page(folder, &campaign, &facts, &View::new(&table)?, &evidence::picks(&table)?)
}
