//! The backlash shaft against closed forms of its single events, and every plant at extreme parameters.

mod events;
mod extremes;
mod motor_and_load;
