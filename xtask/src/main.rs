//! Developer chores, called as `cargo xtask <chore>`.

mod apt;
mod arm_toolchain;
mod checks;
mod code_lines;
mod codec_size;
mod command;
mod directions;
mod dissector;
mod fuzz;
mod header;
mod image;
mod lines;
mod metadata;
mod paths;
mod production;
mod python;
mod rings;
mod schedule;
mod setup;
mod size;
mod tally;
mod test_counts;
mod test_programs;
mod words;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use rings::Ring;

#[derive(Parser)]
#[command(about = "Developer chores of Lashloop", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Run every check and every test, after `setup`; the last line is the sum
    Test {
        #[command(subcommand)]
        ring: Option<Ring>,
    },
    /// Check lockfile, format, words, directions, lines, clippy and rustdoc; the last line is the sum
    Check,
    /// Install what the tests need and is missing here, after printing what that is
    Setup,
    /// Build the Arm images, copy them to target/lashloop-firmware.elf and codec-cost.elf and print their sizes
    Image,
    /// Print the size of the Arm image and fail if it exceeds its limits
    Size,
    /// Write the C header of the wire contract, protocol/include/lashloop.h, and the tables of the Wireshark dissector, from the
    /// layouts of the messages
    Header,
    /// Find words that the project doesn't use
    Words,
    /// Find dependencies between crates against their direction, and cycles of files
    Directions,
    /// Count the lines of production code and compare them with their limits
    Lines,
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().chore {
        Chore::Test { ring: None } => return schedule::run(),
        Chore::Test { ring: Some(ring) } => return rings::run(&ring),
        Chore::Check => return checks::run(),
        Chore::Setup => setup::install_missing(),
        Chore::Image => image::build().and_then(|()| size::print().map(drop)),
        Chore::Size => size::check(),
        Chore::Header => header::write().and_then(|()| dissector::write()),
        Chore::Words => words::check(),
        Chore::Directions => directions::check(),
        Chore::Lines => lines::check(),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::{Arguments, schedule};

    #[test]
    fn every_chore_of_the_schedule_is_a_command() {
        for chore in schedule::STAGES.into_iter().flatten().copied().flatten() {
            let words = ["xtask"].into_iter().chain(chore.split(' '));
            assert!(Arguments::try_parse_from(words).is_ok(), "{chore}");
        }
    }
}
