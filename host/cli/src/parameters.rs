//! `lashloop parameters`: the parameters of a drive, listed, saved and restored.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use lashloop::Bench;
use lashloop_bench::device::Device;
use lashloop_bench::text_table::aligned;
use lashloop_bench::verdict::Exit;
use lashloop_hardware::parameter_set::{
    ParameterSet, Settings, SettingsError, to_plain_value, to_toml_value,
};
use lashloop_protocol::enums::Capabilities;
use lashloop_session::{LawMask, Session, SessionError};

use super::error::CliError;
use super::options::{BaudOption, DeviceOption};
use super::output::outln;
use super::supervision::start_supervisor;

/// List, save, set and compare the parameters of a drive
///
/// The drive keeps parameters until it is reset or loses power; a drive with a memory also has `store`. Every `lashloop run` resets the drive and then applies the
/// scenario's [controller] section, so parameters set here do not reach a run. inproc, native and qemu start a new drive
/// for each command; only a drive at the path of a terminal keeps its parameters between commands.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    drive: DeviceOption,

    #[command(flatten)]
    line: BaudOption,

    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Print the laws of the drive, its signals, and every parameter with its value, default, range, unit and laws
    List,
    /// Print every value as TOML, for `restore`
    Dump,
    /// Set parameters and read them back
    Set {
        /// Parameter and value, such as torque_limit_nm=5 or controller=pd
        #[arg(required = true, value_name = "NAME=VALUE")]
        settings: Vec<String>,
    },
    /// Set the parameters in a file of `dump` and read them back
    Restore {
        /// File with some or all lines of a `dump`
        file: PathBuf,
    },
    /// Store the values in force in the memory of the drive: they become its defaults, also after power-up
    Store,
    /// Set every parameter to its default: the stored value, if the drive has stored any
    Recall,
    /// Forget the stored values and set every parameter to the default of the firmware
    Forget,
    /// Print a SHA-256 over all parameters
    ///
    /// Input of the hash, in the order of the index: the name in UTF-8, a zero byte, the type (1 for u32, 2 for f32), and
    /// the four bytes of the value, little endian.
    Hash,
}

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        // Before the drive starts, so that a typing error costs no time.
        let settings = match &self.verb {
            Verb::Set { settings } => Settings::from_words(settings).map_err(CliError::Settings)?,
            Verb::Restore { file } => Settings::from_file(file).map_err(CliError::Settings)?,
            Verb::List | Verb::Dump | Verb::Store | Verb::Recall | Verb::Forget | Verb::Hash => {
                Settings::default()
            }
        };
        let supervisor = start_supervisor()?;
        let mut device = Device::open(&self.drive.device, self.line.baud, &supervisor)?;
        if let Verb::Store | Verb::Recall | Verb::Forget = self.verb {
            keep(&mut device.session, &self.verb).map_err(|error| match error {
                Some(source) => CliError::from(device.explain(source)),
                None => CliError::NoStore,
            })?;
        }
        let in_force = settings.apply(&mut device.session).map_err(|error| match error {
            SettingsError::Session(source) => CliError::from(device.explain(source)),
            other => CliError::Settings(other),
        })?;
        match self.verb {
            Verb::List => list(&device.session, &in_force),
            Verb::Dump => dump(&device, &in_force),
            Verb::Set { .. } | Verb::Restore { .. } => confirm(&in_force, &settings),
            Verb::Store | Verb::Recall | Verb::Forget => {
                let stored = in_force.iter().filter(|(it, value)| it.default == *value).count();
                outln!("{stored} parameters have their defaults, which are those after power-up");
            }
            Verb::Hash => outln!("{}", in_force.sha256()),
        }
        Ok(Exit::Pass)
    }
}

/// Asks the drive for what a verb of its memory is. `None` for a drive without one.
fn keep(session: &mut Session, verb: &Verb) -> Result<(), Option<SessionError>> {
    if !session.identity.capabilities.contains(Capabilities::STORE) {
        return Err(None);
    }
    let result = match verb {
        Verb::Store => session.store_parameters(),
        Verb::Forget => session.forget_parameters(),
        _ => session.recall_parameters(),
    };
    result.map_err(Some)
}

fn list(session: &Session, in_force: &ParameterSet) {
    let laws = |set: LawMask| {
        if set.is_all(&session.laws) { "all".to_owned() } else { set.names(&session.laws) }
    };
    let rows = in_force.iter().map(|(it, value)| {
        let live = if it.live { "yes" } else { "no" };
        let [value, default] = [*value, it.default].map(|value| to_plain_value(it, value));
        [it.name.clone(), value, default, live.to_owned(), it.range(), laws(it.laws)]
    });
    print_table(["name", "value", "default", "live", "allowed", "laws"], rows, &[1, 2]);
    let names: Vec<_> = session.laws.iter().map(|law| &*law.name).collect();
    outln!("\nlaws: {}", names.join(", "));
    outln!("");
    let rows = session
        .signals
        .iter()
        .map(|it| [it.signal.name.to_string(), it.signal.unit.to_string(), laws(it.laws)]);
    print_table(["signal", "unit", "laws"], rows, &[]);
}

fn print_table<const N: usize>(head: [&str; N], rows: impl Iterator<Item = [String; N]>, right: &[usize]) {
    let rows: Vec<_> = [head.map(str::to_owned)].into_iter().chain(rows).collect();
    for line in aligned(&rows, |column| right.contains(&column)) {
        outln!("{line}");
    }
}

fn dump(device: &Device, in_force: &ParameterSet) {
    outln!("# {}", device.description());
    outln!("# sha256 {}", in_force.sha256());
    outln!("{}", in_force.to_toml().trim_end());
}

fn confirm(in_force: &ParameterSet, settings: &Settings) {
    for (it, value) in in_force.iter().filter(|(it, _)| settings.contains(&it.name)) {
        outln!("{} = {}", it.name, to_toml_value(it, *value));
    }
}
