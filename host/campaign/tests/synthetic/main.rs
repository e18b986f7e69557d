//! Plans, shards and merges, with synthetic results in place of runs: numbers that are a function of the case.

mod damage;
mod files;
mod plans;
mod shards;
mod support;
mod tables;
