//! Why an export, or a call of an importer, fails.

use std::io;
use std::path::PathBuf;

use lashloop::Error as BenchError;
use lashloop_bench::device::DeviceError;
use lashloop_bench::run::RunError;
use lashloop_bench::scenario::ScenarioErrors;
use lashloop_plant::PlantError;

/// Why an export fails, or why an FMU answers a call with an error.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The scenario is wrong, or a parameter of the FMU is out of its range.
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    /// Plant or drive can't be built from the scenario.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The drive failed.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// The bench has no such drive.
    #[error(transparent)]
    Bench(#[from] BenchError),
    /// The plant failed in a step.
    #[error("the plant fails at t = {time_s} s: {source}")]
    Plant {
        /// Time of the simulation in s.
        time_s: f64,
        /// Why.
        source: PlantError,
    },
    /// The scenario has something that this half of the loop can't have in an FMU.
    #[error("{what} can't be in the FMU of a {part}: {reason}")]
    Unfit {
        /// A key, or a kind of fault.
        what: String,
        /// `plant` or `drive`.
        part: &'static str,
        /// Why, and what to do.
        reason: &'static str,
    },
    /// The library isn't there.
    #[error(
        "there is no {library} next to {} or in ../lib/lashloop from there: it comes with archive, wheel and Debian package, and \
         `cargo programs` builds it; --library names another place",
        program.display()
    )]
    NoLibrary {
        /// Its name.
        library: &'static str,
        /// This program.
        program: PathBuf,
    },
    /// The library is another file, or that of another version.
    #[error("{} isn't the library of this version: it lacks the text \"{marker}\"; take the one of this program's package", path.display())]
    StrangeLibrary {
        /// The file.
        path: PathBuf,
        /// What the library contains.
        marker: &'static str,
    },
    /// A file can't be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// FMI has no name for this platform, or none for a version.
    #[error("FMI {version} has no name for the processor {processor}; take --fmi 3 on x86_64 or aarch64")]
    Platform {
        /// Version of FMI.
        version: &'static str,
        /// Processor.
        processor: &'static str,
    },
    /// The FMU's own files don't belong together.
    #[error("{0}; export the FMU again")]
    Damaged(String),
    /// The importer calls a function at the wrong time.
    #[error("{call} isn't allowed {phase}")]
    Order {
        /// What the importer wants.
        call: &'static str,
        /// When.
        phase: &'static str,
    },
    /// The importer names no variable, or one of another type or causality.
    #[error("value reference {reference} {problem}")]
    Variable {
        /// The reference.
        reference: u32,
        /// What is wrong with it.
        problem: String,
    },
    /// The communication step doesn't fit the control period.
    #[error("a step of {step_s} s at t = {time_s} s: {rule}")]
    Step {
        /// The step in s.
        step_s: f64,
        /// The time at which it begins, in s.
        time_s: f64,
        /// What steps the FMU takes.
        rule: String,
    },
    /// The drive gave no torque.
    #[error("the drive gives no torque at t = {time_s} s: {reason}")]
    NoTorque {
        /// Time of the simulation in s.
        time_s: f64,
        /// The fault with its numbers, or that there was no answer.
        reason: String,
    },
    /// A pointer of the importer is NULL.
    #[error("{0} is NULL")]
    Null(&'static str),
    /// The importer has another number of values than of variables.
    #[error("{values} values for {references} value references: every variable has one value")]
    Count {
        /// Variables.
        references: usize,
        /// Values.
        values: usize,
    },
    /// The place for the bytes of a state is too short.
    #[error("the state has {needed} bytes, and there is room for {given}: ask for the size first")]
    ShortBuffer {
        /// Bytes of the state.
        needed: usize,
        /// Bytes of the place.
        given: usize,
    },
    /// The FMU has states that can't be saved.
    #[error("the state of this FMU can't be saved: its description says so")]
    Unsaved,
    /// A state is another FMU's, or of other parameters.
    #[error("the state isn't one of this FMU: {0}")]
    State(&'static str),
}
