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
//! The same two values make a command line with every command of `lashloop`, as the whole `main` of a program:
//!
//! ```no_run
//! fn main() -> std::process::ExitCode {
//!     lashloop::Bench::new().with_laws::<own_law::OwnLaws>().with_plant(own_plant::model()).main()
//! }
//! ```
//!
//! # What is stable
//!
//! Before 1.0 the items below change in a minor version only, with an entry in the changelog.
//!
//! | stable | in |
//! |---|---|
//! | [`Bench`], [`run`], [`Outcome`] but for [`Outcome::details`], [`Error`], [`NoMetric`], [`UnknownName`] | this crate |
//! | [`Device`] and the names of devices; [`Scenario`] as a value that is read and passed on; [`Verdict`]; [`Signal`] | this crate |
//! | keys of scenarios, columns and files of a record, commands, options and exit codes | the documents in `docs` |
//! | `ControlLaw`, `laws!`, `parameters!`, `signals!`, `image!`, `Measurement`, `ControlOutput`, `DriveParameters` | `lashloop-firmware` |
//! | `Plant`, `PlantModel`, `Key`, `Release`, `Changes`, `Environment`, `Positions`, `PlantError`, `Signal` | `lashloop-plant` |
//! | the wire protocol, by its version | `lashloop-protocol` |
//!
//! Everything else is for the program `lashloop` and changes without notice: the modules below, the fields of a
//! [`Scenario`], and the rest of `lashloop-bench`.
//!
//! # The lab
//!
//! | module | is |
//! |---|---|
//! | [`budget`] | the time budget of a control period on a serial line |
//! | [`campaign`] | control laws on plants outside their tuning: cases, limits, tables |
//! | [`conformance`] | checks of a drive against the protocol, rule by rule |
//! | [`decode`] | the frames of a capture or of a raw stream as text |
//! | [`parameter_set`] | the parameters of a drive as a file and as a fingerprint |
//! | [`ports`], [`doctor`] | the serial ports of this machine, and the examination of a line |
//! | [`live`] | a run in a browser while it lasts |
//! | [`flash`], [`rig`] | firmware onto a drive; benches with hardware: rig file, limits, lock |
//! | [`commission`], [`identify`] | motions that show a drive train; its estimates from records, and what is written of them |
//! | [`replay`] | the samples of a record sent to another firmware, and its torques compared |
//! | [`suite`] | `lashloop test`: folders of scenarios and sweeps, baselines, reports |
//! | [`journal`], [`workers`] | results of many runs line by line; runs in parallel |
//! | [`soak`] | a scenario repeated under rising faults |

#![forbid(unsafe_code)]

mod bench;
pub mod budget;
pub mod campaign;
mod cli;
pub mod cluster;
pub mod commission;
pub mod conformance;
pub mod decode;
pub mod doctor;
mod error;
pub mod flash;
pub mod identify;
pub mod journal;
pub mod live;
mod outcome;
pub mod parameter_set;
pub mod ports;
pub mod replay;
pub mod rig;
mod run;
pub mod soak;
pub mod suite;

pub use bench::Bench;
pub use error::Error;
#[doc(inline)]
pub use lashloop_bench::device::DeviceChoice as Device;
pub use lashloop_bench::names::UnknownName;
pub use lashloop_bench::scenario::Scenario;
pub use lashloop_bench::verdict::Verdict;
pub use lashloop_campaign::workers;
pub use lashloop_plant::Signal;
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
