//! `lashloop report`: records as a page for a browser.

use std::path::{Path, PathBuf};

use clap::Args;
use lashloop_bench::verdict::Exit;
use lashloop_report::page;

use super::error::CliError;
use super::output::{outln, write_file};
use crate::bench::Bench;

const RUN_FILE: &str = "report.html";
const COMPARISON_FILE: &str = "comparison.html";

/// Make a page of a record: verdict, margins, linked plots, timing, faults; of several records a comparison
///
/// The page is one HTML file that loads nothing from a network. The record of an interrupted run is shown up to its last whole
/// row. Several records share the axes, and the first is what the others are compared with.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folders of records
    #[arg(required = true, value_name = "DIR")]
    records: Vec<PathBuf>,

    /// File for the page [default: report.html in the folder, for several records comparison.html in the first folder]
    #[arg(long, value_name = "FILE.html")]
    out: Option<PathBuf>,
}

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        if let ([folder], None) = (&self.records[..], &self.out) {
            return write(folder).map(|()| Exit::Pass);
        }
        let read = |folder: &PathBuf| Ok(page::Run::read(self.name(folder), folder)?);
        let runs = self.records.iter().map(read).collect::<Result<Vec<_>, CliError>>()?;
        let text = match &runs[..] {
            [run] => page::run(run),
            runs => page::comparison(runs),
        };
        let path = self.out.unwrap_or_else(|| self.records[0].join(COMPARISON_FILE));
        save(&path, &text).map(|()| Exit::Pass)
    }

    /// The last part of the path; the whole path where two folders share a name.
    fn name(&self, folder: &Path) -> String {
        let has_its_name = |other: &&PathBuf| other.file_name() == folder.file_name();
        let is_alone = self.records.iter().filter(has_its_name).count() == 1;
        let name = folder.file_name().filter(|_| is_alone).unwrap_or(folder.as_os_str());
        name.to_string_lossy().into_owned()
    }
}

/// Writes the page of a record into its folder.
pub(super) fn write(folder: &Path) -> Result<(), CliError> {
    let name = folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy();
    let run = page::Run::read(name, folder)?;
    save(&folder.join(RUN_FILE), &page::run(&run))
}

fn save(path: &Path, text: &str) -> Result<(), CliError> {
    write_file(path, text)?;
    outln!("page: {}", path.display());
    Ok(())
}
