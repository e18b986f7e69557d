//! `lashloop-fmu`: an FMU of FMI 2.0 or 3.0 for co-simulation as a plant of the bench.
//!
//! | module | is |
//! |---|---|
//! | `archive` | the FMU's archive, unpacked within limits; its platforms |
//! | `description` | `modelDescription.xml` |
//! | `variable` | a variable: type, unit, start value |
//! | `names` | variables found by name |
//! | `library` | the C functions of the FMU; the only unsafe code |
//! | `status` | statuses of the C functions, and the FMU's messages |
//! | `steps` | communication steps, and their times |
//! | `plant` | an FMU as a plant |
//! | `protocol` | the lines of the plant-process protocol |
//! | `show` | what `lashloop fmu show` prints |
//! | `error` | what an FMU can lack or do wrong |
//!
//! Without arguments the program speaks the protocol of `docs/extend/plant.md` on standard input and output. An FMU is native code:
//! it may crash or hang, so the bench gives each run a process of its own.

mod archive;
mod description;
mod error;
mod library;
mod names;
mod plant;
mod protocol;
mod show;
mod status;
mod steps;
mod variable;

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use archive::Archive;
use description::Description;
use error::FmuError;
use show::plain;

/// FMUs of FMI 2.0 and 3.0 as plants of the Lashloop bench
///
/// Without a command: the plant-process protocol on standard input and output, for `plant.model = "fmu"`.
#[derive(Parser)]
#[command(version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Print what an FMU is and has, and a `[plant]` section for it
    Show {
        /// The FMU
        file: PathBuf,
    },
}

fn show(file: &Path) -> Result<(), FmuError> {
    let mut archive = Archive::open(file)?;
    let description = Description::parse(&archive.description()?)?;
    let text = show::text(file, &description, &archive);
    // A reader that closes the pipe early has what it wants.
    let _ = std::io::stdout().write_all(text.as_bytes());
    Ok(())
}

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Some(Command::Show { file }) => show(&file).map_err(|error| error.to_string()),
        None => protocol::serve().map_err(|error| error.to_string()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("lashloop-fmu: {}", error.lines().map(plain).collect::<Vec<_>>().join("\n"));
            ExitCode::from(2)
        }
    }
}
