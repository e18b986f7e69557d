//! Estimates of a drive train from records, and what is written of them.
//!
//! | module | does |
//! |---|---|
//! | [`record`] | torques and counts from the columns of a record |
//! | [`files`] | the estimates as a table, as a scenario's plant and as parameters of a drive |
//! | [`models`] | the estimates as a model of another simulator |
//! | [`power_stage`] | errors of the torque of a drive in bench mode |
//! | [`reach`] | a first reach with the gains of the estimates |
//! | [`gate`] | whether the plant of a scenario follows the recorded motion |

pub mod files;
pub mod gate;
pub mod models;
pub mod power_stage;
pub mod reach;
pub mod record;
