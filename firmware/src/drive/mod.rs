//! The drive: the peer of a host on the line.
//!
//! A state machine without I/O. Its owner feeds it received bytes and a clock, transmits [`Drive::output`], calls
//! [`Drive::tick`] about every millisecond, and applies [`Drive::torque_nm`] to the motor if one is connected.
//!
//! ```text
//!            Hello (same version)       Arm           Start
//!     Boot ───────────────────▶ Idle ─────▶ Armed ─────────▶ Running
//!      ▲ Reset (from anywhere)  ▲ ▲  ◀─────  │ ◀──────────────  │
//!                               │ │   Stop; Hello of another   │
//!                    ClearFault │      session                 │ watchdog, encoder jump,
//!                               │                              ▼ non-finite number
//!                             Faulted ◀──────────────────── EmergencyStop (from anywhere)
//! ```
//!
//! Only `Running` gives torque. In HIL mode the encoder sample is the tick of the control loop: no timer is in its path,
//! so the torque depends on the frames only. A drive with encoders and a power stage of its own has bench mode too: its
//! owner calls [`Drive::sample`] once in every period, and applies [`Drive::stage_command`] to the power stage.
//!
//! | module | concept |
//! |---|---|
//! | `machine` | [`Drive`]: bytes in, one handler per request, bytes out |
//! | `arming`, `refusal` | what `Subscribe`, `Capture`, `Arm` and `Start` check; why a request was refused |
//! | `lifecycle` | the states above; each owns what only it has |
//! | `bench_mode` | the tick and the power stage of a drive with pins |
//! | `run` | one run, from `Start` to its end: sequence, held torque |
//! | `pin_run`, `pins` | a run on the pins; what they must show before |
//! | `guard` | what ends a run on the pins without a host |
//! | `zero` | the zero of both encoders |
//! | `watchdog` | the limit on time without a new sample |
//! | `safety` | limits between controller and motor |
//! | `control_loop` | encoder sample to requested torque |
//! | `parameters` | the values of the parameters, and the requests for them |
//! | `store`, `keep` | the requests to store, recall and forget them |
//! | `pin_parameters` | the parameters of bench mode |
//! | `descriptions`, `lists` | names of laws and signals; of faults, outcomes, states, flags and messages |
//! | `subscription` | signals and rate of telemetry |
//! | `scope` | a capture: signals around an event, at the rate of the loop |
//! | `observation` | what a step leaves besides its torque: a row of the capture, telemetry |
//! | `identity` | versions, and the answer to `Hello` |
//! | `torque_answer`, `bench_sample`, `line_counts`, `output` | messages sent, and the transmit buffer |
//!
//! The laws of a drive, and with them the tables of its parameters and signals, are a [`LawSet`](crate::law::LawSet).

mod arming;
mod bench_mode;
mod bench_sample;
mod clock;
mod control_loop;
mod descriptions;
mod guard;
mod identity;
mod keep;
mod lifecycle;
mod line_counts;
mod lists;
mod loader;
mod loader_entry;
mod machine;
mod motor_direction;
mod observation;
mod output;
mod parameters;
mod pin_parameters;
mod pin_run;
mod pins;
mod refusal;
mod run;
mod safety;
mod scope;
mod store;
mod subscription;
mod torque_answer;
mod watchdog;
mod zero;

pub use clock::{Clock, ManualClock};
pub use identity::{BUILD_ID, BUILD_IS_DIRTY, FIRMWARE_VERSION};
pub use machine::Drive;
pub use output::fault_frame;
pub use pin_parameters::{PinParameters, SampleSource};
pub use pins::{EncoderReading, PinHardware, PinReadings};
