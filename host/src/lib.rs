//! Lashloop as a library: drives with gear backlash on a simulated bench, in a test of your own.
//!
//! A [`Bench`] has laws and plants, yours included. It reads a [`Scenario`] and names a [`Device`]; [`run`] closes the loop
//! in lockstep and returns an [`Outcome`] with verdict, metrics and signals. No program, file or port is needed.
//!
//! A control law of your own in a unit test:
//!
//! ```
//! use lashloop::{Bench, run};
//! use own_law::OwnLaws;
//!
//! let bench = Bench::new().with_laws::<OwnLaws>();
//! let scenario = bench.scenario("../examples/own-law/own-law.toml", &["run.duration_s=2"])?;
//! let outcome = run(&scenario, &bench.device("inproc")?)?;
//! let twist_rad = outcome.signal("drive.wanted_twist_rad")?;
//! let largest_rad = twist_rad.iter().fold(0.0_f64, |largest, twist_rad| largest.max(twist_rad.abs()));
//! assert!(largest_rad > 0.16, "the law crosses the gap: {largest_rad} rad");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A plant of your own:
//!
//! ```
//! use lashloop::{Bench, run};
//!
//! let bench = Bench::new().with_plant(own_plant::model());
//! let scenario = bench.scenario("../examples/own-plant/three-masses.toml", &[])?;
//! let outcome = run(&scenario, &bench.device("inproc")?)?;
//! assert!(outcome.passed(), "{outcome}");
//! assert!(outcome.metric("static_error_rad")? < 0.05);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! With `lashloop-cli` the same two values make a command line with every command of `lashloop`, as the whole `main` of a
//! program:
//!
//! ```no_run
//! fn main() -> std::process::ExitCode {
//!     lashloop_cli::main(&lashloop::Bench::new().with_laws::<own_law::OwnLaws>().with_plant(own_plant::model()))
//! }
//! ```
//!
//! # What is stable
//!
//! Before 1.0 the items below change in a minor version only, with an entry in the changelog.
//!
//! | stable | in |
//! |---|---|
//! | [`Bench`] but for [`Bench::plants`], [`Bench::devices`], [`Bench::in_process`] and [`Bench::serve`]; [`run`], [`Outcome`] but for [`Outcome::details`] and [`Outcome::columns`], [`Error`], [`NoMetric`], [`UnknownName`] | this crate |
//! | [`Device`] and the names of devices; [`Scenario`] as a value that is read and passed on; [`Verdict`]; [`Signal`] | this crate |
//! | keys of scenarios, columns and files of a record, commands, options and exit codes | the documents in `docs` |
//! | `ControlLaw`, `laws!`, `parameters!`, `signals!`, `image!`, `Measurement`, `ControlOutput`, `DriveParameters` | `lashloop-firmware` |
//! | `Plant`, `PlantModel`, `Key`, `Release`, `Changes`, `Environment`, `Positions`, `PlantError`, `Signal` | `lashloop-plant` |
//! | the wire protocol, by its version | `lashloop-protocol` |
//!
//! Everything else is for the program `lashloop` and changes without notice: the modules below, the fields of a
//! [`Scenario`], and the rest of `lashloop-bench`.
//!
//! | module | is |
//! |---|---|
//! | [`execution`] | a run as a value: scenario, place, clock, record, watchers |
//! | [`bode`] | frequency responses of a loop, measured |
//! | [`rig`] | benches with hardware: rig file, limits, lock |
//! | [`replay`] | the samples of a record sent to another firmware, and its torques compared |

#![forbid(unsafe_code)]

mod bench;
pub mod bode;
mod error;
pub mod execution;
pub mod margins;
mod outcome;
pub mod replay;
pub mod rig;
mod run;

pub use bench::Bench;
pub use error::Error;
pub use execution::Execution;
#[doc(inline)]
pub use lashloop_bench::device::DeviceChoice as Device;
pub use lashloop_bench::scenario::Scenario;
pub use lashloop_bench::verdict::Verdict;
pub use lashloop_plant::Signal;
pub use lashloop_session::names::UnknownName;
pub use outcome::{NoMetric, Outcome};
pub use run::run;

/// The Rust of the pages in `docs/extend` as tests.
#[cfg(doctest)]
mod pages {
    #[doc = include_str!("../../docs/extend/law.md")]
    struct Law;

    #[doc = include_str!("../../docs/extend/library.md")]
    struct Library;
}
