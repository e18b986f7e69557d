//! Plans, shards and merges, with synthetic results instead of runs: numbers that are a function of the case.

mod damage;
mod files;
mod no_run;
mod plans;
mod shards;
mod support;
mod tables;
