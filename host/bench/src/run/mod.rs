//! One run: a scenario, a device, a verdict.
//!
//! | module | does |
//! |---|---|
//! | `clock` | what paces a run |
//! | `runner` | from a scenario and a device to a verdict: [`run`] |
//! | `device_under_test` | the device with the faults on its link |
//! | [`mod@simulator`] | the simulated side of the loop: plant, encoders, reference |
//! | `drive_settings` | what a scenario sets on a drive, checked against its description |
//! | [`setup`] | applies the scenario's settings to the drive |
//! | `lockstep` | paces the loop by the drive: the plant waits for it |
//! | [`real_time`] | paces the loop by the wall clock |
//! | `run_loop` | what closes the loop: HIL mode or bench mode |
//! | `loop_state` | what the loops of both modes have in common |
//! | `control_loop` | one step of HIL mode |
//! | `bench_loop` | one period of bench mode: a reference, and the reports of the drive's own steps |
//! | `bench_phase` | where the drive is in a run of bench mode: started, awaited, measuring |
//! | `bench_positions` | positions from the counts of the drive's encoders |
//! | `latched_fault` | the report of a fault that the drive has latched |
//! | `answer_check` | holds every torque answer to the rules of the protocol |
//! | `phase` | where the drive is in the run: started, running, restarting |
//! | `held_torque` | the torque on the motor while answers stay out |
//! | `waiting_time` | the time that a lockstep run waits for its drive |
//! | `reconnect` | getting a lost drive back |
//! | `step` | a finished step: truth, torque, the drive's signals, timing |
//! | [`digest`] | digest of all torques |
//! | `step_sink`, `step_recorder` | where finished steps go, and what is computed from them |
//! | [`outcome`] | the end of a run and its verdict |
//! | `drive_fault` | the fault of a drive that ended a run |
//! | `error` | why a run fails |

mod answer_check;
mod bench_loop;
mod bench_phase;
mod bench_positions;
mod clock;
mod control_loop;
mod device_under_test;
pub mod digest;
mod drive_fault;
mod drive_settings;
mod error;
mod held_torque;
mod latched_fault;
mod lockstep;
mod loop_state;
pub mod outcome;
mod phase;
pub mod real_time;
mod reconnect;
mod run_loop;
mod runner;
pub mod setup;
pub mod simulator;
mod step;
mod step_recorder;
mod step_sink;
mod waiting_time;

pub use clock::Clock;
pub use device_under_test::DeviceUnderTest;
pub use drive_fault::DriveFault;
pub use drive_settings::takes_torque;
pub use error::RunError;
pub use outcome::{End, Outcome};
pub use runner::{check_bench_mode, run};
pub use step::{DriveValues, Observation, Step, TraceRow, TruthValues};
pub use step_sink::{Event, Observers, RunStart, StepObserver};
