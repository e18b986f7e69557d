//! Identification of plants that the estimator does not know, from the counts of their encoders.

mod coverage;
mod electrical;
mod held;
mod hidden_plants;
mod limits;
mod observability;
