//! Physical backlash in series with a damped shaft, friction that falls with speed, and a drive that lags and saturates.
//!
//! The gap is that of Nordin, Galic and Gutman ("New models for backlash and gear play", 1997): theta_b, the position in
//! the gap, is a state. In contact theta_b = +-j0 and C = K (z - theta_b) + c dz/dt, as long as the contact pushes. Off
//! contact C = 0 and the shaft relaxes, d(theta_b)/dt = dz/dt + (K / c)(z - theta_b), until theta_b reaches a flank. So
//! the contact never pulls, and it closes with the torque that the shaft has at that speed.
//!
//! Load and motor carry Stribeck friction each, and stick while the driving torque stays below stiction. Motor torque
//! follows the command, limited to +-U_max, with the lag T_i. Lag and relaxing shaft are linear, and nothing that moves
//! within a step drives them, so we take both from their closed forms. Neither c nor T_i limits the substep, and either
//! may be zero.
//!
//! | module | concept |
//! |---|---|
//! | `parameters` | what is constant |
//! | `stribeck`, `lugre` | dry friction |
//! | `cogging` | torque of the motor without current |
//! | `load_mode` | a load of two masses |
//! | `shaft`, `state` | prepared parameters; coordinates, modes, and the surroundings, which may change in a run |
//! | `contact` | the gap: transmitted torque, flanks, relaxation |
//! | `motion` | the right-hand side |
//! | `modes` | guards and mode changes |
//! | `substeps` | the substeps that stability needs |
//! | `plant` | the plant made of all these |
//! | `model` | its keys in scenarios |
//! | `minimum_time` | the shortest settling time of its motor |

mod cogging;
mod contact;
mod load_mode;
mod lugre;
mod minimum_time;
mod model;
mod modes;
mod motion;
mod parameters;
mod plant;
mod shaft;
mod state;
mod stribeck;
mod substeps;

pub use model::{NAME, model};
pub use modes::{ShaftGuard, ShaftStride};
pub use parameters::{
    BristleParameters, CoggingParameters, LoadModeParameters, ShaftParameters, StribeckParameters,
};
pub use shaft::BacklashShaft;
pub use state::{BacklashShaftState, ShaftCoordinates, ShaftMode};
