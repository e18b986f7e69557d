//! What an FMU can lack or do wrong. Each message says what to do.

use std::io;

/// Why an FMU can't be a plant, or can't continue.
#[derive(Debug, thiserror::Error)]
pub(crate) enum FmuError {
    #[error("{file}: {source}; plant.file must name an FMU")]
    File { file: String, source: io::Error },
    #[error("{file} isn't an FMU: {reason}; export it again")]
    Archive { file: String, reason: String },
    #[error("the FMU has an entry {entry:?} that leaves its folder; don't trust this file")]
    Escape { entry: String },
    #[error("the FMU has a link {entry:?}, which lashloop-fmu doesn't unpack; pack the file itself")]
    Link { entry: String },
    #[error("the FMU has an entry {entry:?} in more than {limit} folders; pack it into fewer")]
    TooDeep { entry: String, limit: usize },
    #[error(
        "the FMU has {count} entries, and lashloop-fmu takes {limit}; pack fewer files, or name them in plant.files"
    )]
    TooMany { count: usize, limit: usize },
    #[error("the FMU's modelDescription.xml has more than {limit} MiB; export the FMU with fewer variables")]
    LargeDescription { limit: u64 },
    #[error(
        "the FMU unpacks to more than {limit} MiB; leave out the documentation, or split its data into plant.files"
    )]
    TooLarge { limit: u64 },
    #[error(
        "the FMU's modelIdentifier {0:?} isn't made of letters, digits and \"_\", and its library has this name; export the \
         FMU again"
    )]
    Identifier(String),
    #[error("modelDescription.xml can't be read: {0}; export the FMU again")]
    Xml(String),
    #[error(
        "the FMU is of FMI {0}, and lashloop-fmu takes 2.0 and 3.0; for 1.0 set plant.command = [\"python3\", \"-m\", \
         \"lashloop.fmu\"], which needs FMPy"
    )]
    Version(String),
    #[error(
        "the FMU is for model exchange only, and lashloop-fmu has no solver; export it for co-simulation, or set \
         plant.command = [\"python3\", \"-m\", \"lashloop.fmu\"], whose solver is that of FMPy"
    )]
    NoCoSimulation,
    #[error("the FMU has binaries for {found}, and none for {wanted}; {remedy}")]
    Platform { found: String, wanted: String, remedy: &'static str },
    #[error("the FMU's library can't be loaded: {reason}{remedy}")]
    Library { reason: String, remedy: &'static str },
    #[error(
        "the FMU has taken {taken_mib} MiB of memory by t = {time_s} s, more than plant.memory_limit_mib = {limit_mib}: it leaks, or \
         needs a higher limit"
    )]
    Memory { taken_mib: u64, limit_mib: u64, time_s: f64 },
    #[error("the FMU has no variable {name:?}, which plant.{key} names{near}")]
    NoVariable { name: String, key: String, near: String },
    #[error("the FMU's variable {name:?} is {is}, and plant.{key} needs {needs}")]
    Unfit { name: String, key: String, is: String, needs: &'static str },
    #[error("plant.start.{name} is the torque input, which the bench sets; remove this start value")]
    TorqueStart { name: String },
    #[error("plant.start.{name} is {value}, and the variable is of type {kind}; give a value of this type")]
    StartType { name: String, value: String, kind: String },
    #[error(
        "the FMU's variable {name:?} is {have} after its start value of {want}; the FMU ignores plant.start.{name}"
    )]
    StartIgnored { name: String, have: f64, want: f64 },
    #[error("the FMU takes steps of {step_s} s, and {held_s} s isn't a multiple of it; {remedy}")]
    Step { step_s: f64, held_s: f64, remedy: &'static str },
    #[error("the FMU refuses the start: {function} answers {status}{log}")]
    Call { function: String, status: &'static str, log: String },
    #[error("the FMU can't {action} {name:?} at t = {time_s} s: {function} answers {status}{log}")]
    Access {
        action: &'static str,
        name: String,
        time_s: f64,
        function: String,
        status: &'static str,
        log: String,
    },
    #[error("the FMU refuses the step of {step_s} s at t = {time_s} s: {function} answers {status}{log}")]
    Refused { function: &'static str, status: &'static str, step_s: f64, time_s: f64, log: String },
    #[error(
        "the FMU returns early from the step of {step_s} s at t = {time_s} s, at {reached_s} s, which the loader doesn't \
         allow; turn early return off where you export it"
    )]
    EarlyReturn { step_s: f64, time_s: f64, reached_s: f64 },
    #[error("the FMU ends the simulation at t = {time_s} s; its model does so")]
    Terminated { time_s: f64 },
    #[error(
        "the FMU's variable {name:?} is {value} at t = {time_s} s; shorten plant.step_us or check plant.start"
    )]
    NotFinite { name: String, value: f64, time_s: f64 },
    #[error(
        "the bench's line {line:?} isn't of the protocol: {reason}; take bench and lashloop-fmu of one version"
    )]
    Line { line: String, reason: String },
    #[error("standard input or output: {0}")]
    Pipe(#[from] io::Error),
}
