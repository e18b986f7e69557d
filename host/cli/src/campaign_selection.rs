//! What of a campaign a command runs, instead of the file's own choice.

use std::path::Path;

use clap::Args;
use lashloop_campaign::{Campaign, Selection};

use super::error::CliError;
use super::options::plants;
use lashloop::Bench;

#[derive(Args)]
pub(super) struct SelectionOptions {
    /// Seed instead of the file's
    #[arg(long)]
    seed: Option<u64>,

    /// Value instead of the scenario's, in every case, such as run.duration_s=5; repeatable
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    set: Vec<String>,

    /// Parts to run, separated by commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    part: Vec<String>,

    /// Variants to run, separated by commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    variant: Vec<String>,

    /// Points of every sampled part, instead of the file's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    points: Option<u64>,
}

impl SelectionOptions {
    /// Reads the campaign with this selection.
    pub(super) fn read(self, file: &Path, bench: &Bench) -> Result<Campaign, CliError> {
        let Self { seed, set, part: parts, variant: variants, points } = self;
        Ok(Campaign::read(file, Selection { seed, set, parts, variants, points }, &plants(bench))?)
    }
}
