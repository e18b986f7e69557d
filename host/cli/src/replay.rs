//! `lashloop replay`: the samples of a record, sent to another firmware.

use std::path::PathBuf;

use clap::Args;
use lashloop_bench::device::{Device, DeviceChoice};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::verdict::Exit;
use lashloop_record::diff::{Agreement, RecordFiles, Tolerance};
use lashloop_session::printable;

use super::error::{CliError, system};
use super::options::plants;
use super::output::{outln, print_json_text};
use super::supervision::start_supervisor;
use lashloop::Bench;
use lashloop::replay::{DriveEnd, Recording, replay};

/// Send the samples of a record to another firmware and compare the torques bit by bit
///
/// There is no plant: the device receives the encoder counts and references of the record, with its parameters, and missed
/// steps stay missed. A torque that differs is a difference of the code. Exit code 0 for equal torques, 1 for different
/// ones, 2 for a record or firmware that can't be compared.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folder of the record, of a run in HIL mode
    #[arg(value_name = "DIR")]
    record: PathBuf,

    /// Drive with the other firmware, see `lashloop run --help`
    #[arg(long, value_name = "DEVICE")]
    device: DeviceChoice,

    /// Largest difference of a torque, in N m or in percent of the largest recorded torque [default: equal bits]
    #[arg(long, value_name = "VALUE")]
    tolerance: Option<Tolerance>,

    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let files = RecordFiles::read(&self.record)?;
        let parameters = &files.record.manifest.parameters;
        let recording = Recording::new(&files)?;
        let scenario = Scenario::from_file_with(&self.record.join("scenario.toml"), &[], &plants(bench))?;
        let supervisor = start_supervisor()?;
        let mut device = Device::open(&self.device, scenario.link.baud, &supervisor)?;
        if !self.json {
            outln!(
                "record      {}: {} samples, {} parameters",
                files.name,
                recording.steps.len(),
                parameters.iter().filter(|it| it.of_law).count()
            );
            outln!("recorded    {}", printable(&files.record.manifest.device_description));
            outln!("replayed    {}", device.description());
        }
        let signals = supervisor.guard_signals();
        let result = replay(&recording, parameters, &scenario.link, self.tolerance, &mut device, || {
            supervisor.interrupted()
        })?;
        drop(signals);
        if self.json {
            print_json_text(&result.to_json().map_err(system("write the result as JSON"))?);
        } else {
            outln!("{result}");
        }
        Ok(match (&result.end, result.agreement()) {
            (Some(DriveEnd::Interrupted), _) => Exit::Invalid,
            (_, Agreement::Bits | Agreement::Tolerance) => Exit::Pass,
            (_, Agreement::Different) => Exit::Fail,
        })
    }
}
