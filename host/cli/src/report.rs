//! `lashloop report`: records as a page for a browser.

use std::path::{Path, PathBuf};
use std::slice;

use clap::Args;
use lashloop_bench::verdict::Exit;
use lashloop_record::diff::{RecordFiles, settings};
use lashloop_record::file_names::{COMPARISON_FILE, REPORT_FILE};
use lashloop_report::page;

use super::campaign_report;
use super::error::CliError;
use super::output::{outln, write_file, write_in_folder};
use lashloop::Bench;

/// Make a page of a record: verdict, margins, linked plots, timing, faults; of several records a comparison
///
/// The page is one HTML file that loads nothing from a network. The record of an interrupted run is shown up to its last whole
/// row. Several records share the axes, and the first is what the others are compared with. The folder of a merged campaign gives
/// the page of the campaign.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folders of records, or one folder of a merged campaign
    #[arg(required = true, value_name = "DIR")]
    records: Vec<PathBuf>,

    /// Signals to plot in one chart in front of the others, separated by commas, such as load_position_rad,reference_rad or
    /// drive.*; one chart for each unit. Repeatable
    #[arg(long = "panel", value_name = "NAME,...")]
    panels: Vec<String>,

    /// File for the page [default: report.html in the folder, for several records comparison.html in the first folder]
    #[arg(long, value_name = "FILE.html")]
    out: Option<PathBuf>,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let text = match &self.records[..] {
            [folder] if campaign_report::is_campaign(folder) => {
                if let Some(panel) = self.panels.first() {
                    return Err(CliError::PanelOfCampaign { panel: panel.clone() });
                }
                campaign_report::page_of(folder, bench)?
            }
            [folder] => {
                let run = read(folder)?;
                page::run(&run, &self.panels(slice::from_ref(&run))?)
            }
            folders => self.comparison(folders)?,
        };
        let file = if self.records.len() == 1 { REPORT_FILE } else { COMPARISON_FILE };
        let path = match self.out {
            Some(path) => write_file(&path, &text).map(|()| path),
            None => write_in_folder(&self.records[0], file, text.as_bytes()),
        }?;
        outln!("page: {}", path.display());
        Ok(Exit::Pass)
    }

    fn comparison(&self, folders: &[PathBuf]) -> Result<String, CliError> {
        let records =
            folders.iter().map(|folder| RecordFiles::read(folder)).collect::<Result<Vec<_>, _>>()?;
        let settings = settings(&records);
        let named = folders.iter().zip(records);
        let run = |(folder, files): (&PathBuf, RecordFiles)| {
            page::Run::new(name_among(folders, folder), files.record)
        };
        let runs: Vec<_> = named.map(run).collect();
        Ok(page::comparison(&runs, &settings, &self.panels(&runs)?))
    }

    fn panels(&self, runs: &[page::Run]) -> Result<page::Panels, CliError> {
        let lists: Vec<_> =
            self.panels.iter().map(|it| it.split(',').map(|name| name.trim().to_owned()).collect()).collect();
        Ok(page::Panels::of(runs, &lists)?)
    }
}

/// The last part of a path; the whole path where two of them share it.
pub(super) fn name_among(paths: &[PathBuf], path: &Path) -> String {
    let is_alone = paths.iter().filter(|other| other.file_name() == path.file_name()).count() == 1;
    let name = path.file_name().filter(|_| is_alone).unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}

/// Writes the page of a record into its folder.
pub(super) fn write(folder: &Path) -> Result<(), CliError> {
    let page = page::run(&read(folder)?, &page::Panels::default());
    let path = write_in_folder(folder, REPORT_FILE, page.as_bytes())?;
    outln!("page: {}", path.display());
    Ok(())
}

fn read(folder: &Path) -> Result<page::Run, CliError> {
    let name = folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy();
    Ok(page::Run::read(name, folder)?)
}
