//! Developer chores, called as `cargo xtask <chore>`.

mod arm_toolchain;
mod checks;
mod codec_size;
mod command;
mod directions;
mod dissector;
mod fuzz;
mod header;
mod image;
mod metadata;
mod paths;
mod production;
mod python;
mod setup;
mod size;
mod test_counts;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(about = "Developer chores of Lashloop", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Build the Arm images, copy them to target/lashloop-firmware.elf and codec-cost.elf and print the first one's size
    Image,
    /// Print the size of the Arm image and fail if it is beyond its limits
    Size,
    /// Write the C header of the wire contract, protocol/include/lashloop.h, and the tables of the Wireshark dissector, from the
    /// layouts of the messages
    Header,
    /// Install what the tests need and is missing here: QEMU, tshark, a core library for Arm, and the Python package into
    /// target/python
    Setup,
    /// Give every fuzzer some time; installs cargo-fuzz into target/tools if there is none
    Fuzz {
        /// Time for each of them
        #[arg(long, default_value_t = 20)]
        seconds: u32,
    },
    /// Check the directions of dependencies between crates and between files
    Directions,
    /// Run every check and every test; the last line is the sum
    Test,
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().chore {
        Chore::Image => image::build().and_then(|()| size::print().map(drop)),
        Chore::Size => size::check(),
        Chore::Header => header::write().and_then(|()| dissector::write()),
        Chore::Setup => setup::install_missing(),
        Chore::Fuzz { seconds } => fuzz::run(seconds),
        Chore::Directions => directions::check(),
        Chore::Test => return checks::run_all(),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}
