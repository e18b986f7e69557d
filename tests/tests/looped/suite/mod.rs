//! `lashloop test` and `completions`: folders of scenarios, and what editors and shells get.

mod baselines;
mod check;
mod completions;
mod fixture;
mod results;
mod resume;
