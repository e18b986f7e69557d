//! Control laws for the drive: what a law is, and how a drive gets laws of its own.
//!
//! A law is one type that implements [`ControlLaw`]. Its parameters and signals are structs, declared with unit, default
//! and range; the drive describes them to any host. A set of laws is one enum, declared by [`laws!`](macro@crate::laws); a
//! drive with that set is [`Drive::with_laws`](crate::drive::Drive::with_laws).
//!
//! This is a whole law, a proportional position loop with viscous damping, in a drive of its own:
//!
//! ```
//! use lashloop_firmware::drive::Drive;
//! use lashloop_firmware::law::{ControlLaw, ControlOutput, DriveParameters, LawSet, Measurement, ParameterError};
//!
//! lashloop_firmware::parameters! {
//!     /// Gains of the loop.
//!     pub struct SpringGains {
//!         /// Load error to torque.
//!         spring_nm_rad: F32 = 2.0 in 0.0..=1e3, "N m/rad";
//!         /// Motor velocity to torque.
//!         damping_nm_s_rad: F32 = 0.05 in 0.0..=10.0, "N m s/rad";
//!     }
//! }
//!
//! lashloop_firmware::signals! {
//!     /// Signals of the loop.
//!     pub struct SpringSignals {
//!         /// Load error.
//!         spring_error_rad: "rad",
//!     }
//! }
//!
//! /// A spring from the load to its reference.
//! pub struct Spring {
//!     gains: SpringGains,
//! }
//!
//! impl ControlLaw for Spring {
//!     const NAME: &'static str = "spring";
//!     type Parameters = SpringGains;
//!     type Signals = SpringSignals;
//!
//!     fn new(gains: SpringGains, drive: &DriveParameters) -> Result<Self, ParameterError> {
//!         // A held torque that damps more than this in one period reverses the motor of 1e-3 kg m^2.
//!         let max = 1e-3 / drive.period_s();
//!         ParameterError::at_most("damping_nm_s_rad", gains.damping_nm_s_rad, max, "the control period")?;
//!         Ok(Self { gains })
//!     }
//!
//!     fn step(&mut self, m: &Measurement<f32>) -> ControlOutput<SpringSignals> {
//!         let spring_error_rad = m.load_position_rad - m.reference_position_rad;
//!         let torque_nm = -self.gains.spring_nm_rad * spring_error_rad
//!             - self.gains.damping_nm_s_rad * m.motor_velocity_rad_s;
//!         ControlOutput { torque_nm, signals: SpringSignals { spring_error_rad } }
//!     }
//! }
//!
//! lashloop_firmware::laws! {
//!     /// The laws of this drive: one line each.
//!     pub enum MyLaws {
//!         /// A law of this crate.
//!         Spring(Spring),
//!         /// A law of Lashloop.
//!         Pd(lashloop_firmware::control::pd::Pd),
//!     }
//! }
//!
//! assert_eq!(MyLaws::NAMES, ["spring", "pd"]);
//! let spring = MyLaws::PARAMETERS.iter().find(|parameter| parameter.name == "spring_nm_rad");
//! // Bit 0: the parameter belongs to the first law only.
//! assert_eq!(spring.map(|parameter| parameter.laws), Some(0b01));
//! let drive = Drive::<MyLaws>::with_laws("my-board");
//! assert_eq!(drive.torque_nm(), 0.0);
//! ```
//!
//! | module | is |
//! |---|---|
//! | `control_law` | [`ControlLaw`]: the interface of a law |
//! | `measurement`, `real` | [`Measurement`] in, [`ControlOutput`] out; [`Real`]: the float type |
//! | `parameter_error` | [`ParameterError`]: parameters that don't go together |
//! | `parameter`, `parameter_group` | one parameter as data; structs of parameters, [`parameters!`](crate::parameters) |
//! | `signal` | signals, [`signals!`](crate::signals) |
//! | `drive_parameters`, `drive_signals` | what every law has from the drive |
//! | `law_set` | [`LawSet`] and [`laws!`](macro@crate::laws) |
//! | `table` | the tables of a set, computed at compile time |

mod control_law;
mod drive_parameters;
mod drive_signals;
mod law_set;
mod measurement;
mod parameter;
mod parameter_error;
mod parameter_group;
mod real;
mod signal;
#[doc(hidden)]
pub mod table;

pub use control_law::ControlLaw;
pub use drive_parameters::{COUNTS_PER_REV_MAX, DriveParameters};
pub use drive_signals::DriveSignals;
pub use law_set::LawSet;
pub use measurement::{ControlOutput, Measurement};
pub use parameter::{Parameter, Range};
pub use parameter_error::{ParameterError, ROUNDING};
pub use parameter_group::{Choice, ParameterGroup, ParameterGroups, Words};
pub use real::Real;
pub use signal::{Signal, Signals};
