//! Developer chores, called as `cargo xtask <chore>`.

mod apt;
mod arm_toolchain;
mod census;
mod checks;
mod codec_size;
mod command;
mod counts;
mod cpu_time;
mod dependencies;
mod dissector;
mod dist;
mod fuzz;
mod header;
mod image;
mod licences;
mod log;
mod one_test;
mod paths;
mod python;
mod reports;
mod rings;
mod schedule;
mod setup;
mod silicon;
mod site;
mod size;
mod slurm;
mod test_programs;
mod usb_guest;

use std::process::ExitCode;

use anyhow::Result;
use clap::Parser;

#[derive(Parser)]
#[command(about = "Developer chores of Lashloop", bin_name = "cargo xtask")]
enum Chore {
    /// Run every check and every test, after `setup`; the last line is the sum
    Test(rings::Selection),
    /// Check lockfile, format, clippy, rustdoc, benchmarks, dependencies, and the source tree; the last line is the sum
    Check,
    /// Install what the tests need and is missing here, after printing what that is
    Setup,
    /// Build the Arm images, copy them to target/*.elf and print the size of the drive's
    Image {
        /// The board of the only image to build, as `nucleo-f446re`
        board: Option<String>,
    },
    /// Build virtual silicon, the program behind `--device silicon`, into target/virtual-silicon
    Silicon,
    /// Build the program as one static file and pack it as archive, wheel, Debian package and crates into target/dist; check
    /// each
    Dist(dist::Dist),
    /// Write the documentation as a site with a search, and the pages of rustdoc, to target/site
    Site,
    /// Print the size of the Arm image and fail if it exceeds its limits
    Size,
    /// Plant the bugs of tests/census/board.json in a copy of the tree, one after the other, and count those that a test kills
    Census {
        /// Only those whose file, place, test or sentence contains one of these, as `drive/`
        #[arg(default_value = "")]
        filters: Vec<String>,
    },
    /// Write the C header of the wire contract, protocol/include/lashloop.h, and the tables of the Wireshark dissector, from the
    /// layouts of the messages
    Header,
}

fn main() -> Result<ExitCode> {
    match Chore::parse() {
        Chore::Test(selection) => {
            let counts = selection.ring.map_or_else(schedule::run, |ring| Ok(selection.run(ring)))?;
            return Ok(counts.print());
        }
        Chore::Check => return Ok(checks::run_all().print()),
        Chore::Setup => setup::install_missing()?,
        Chore::Image { board: Some(board) } => image::build_for(&board)?,
        Chore::Image { board: None } => {
            image::build()?;
            size::print()?;
        }
        Chore::Silicon => silicon::build()?,
        Chore::Dist(dist) => dist.make()?,
        Chore::Site => {
            site::make()?;
            site::add_api()?;
        }
        Chore::Census { filters } => return census::run(&filters),
        Chore::Size => size::check()?,
        Chore::Header => {
            header::write()?;
            dissector::write()?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::{Chore, schedule};

    #[test]
    fn every_chore_of_the_schedule_is_a_command() {
        for chore in schedule::STAGES.into_iter().flatten().flat_map(|queue| queue.chores) {
            let words = ["xtask"].into_iter().chain(chore.split(' '));
            assert!(Chore::try_parse_from(words).is_ok(), "{chore}");
        }
    }
}
