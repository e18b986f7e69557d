//! Campaigns on a cluster: shards as tasks of an array job, and a job that merges them. The scheduler is Slurm's.
//!
//! ```text
//! campaign file ──▶ submission ──▶ array job, one task per shard ──▶ merge job
//!                        ▲                     │
//!                  shards without ◀── progress: files of the shards
//!                     a task
//! ```
//!
//! | module | is |
//! |---|---|
//! | [`submission`] | what was submitted into a folder; what a second command submits |
//! | [`jobs`] | the jobs of a plan, submitted and recorded |
//! | [`scripts`] | the two job scripts |
//! | [`slurm`] | Slurm's commands |
//! | [`progress`] | how far each shard is, from its files alone |

pub mod error;
pub mod jobs;
pub mod progress;
pub mod scripts;
pub mod slurm;
pub mod submission;
