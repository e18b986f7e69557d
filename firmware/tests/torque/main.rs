//! The drive's control of a motor's torque, on the physics of motor, bridge and supply.

mod bench;
mod sensor;
mod step;
