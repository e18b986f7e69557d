//! The record of a run: everything that it leaves behind.
//!
//! | file | content | written | module |
//! |---|---|---|---|
//! | `record.json` | the manifest: what was run | before the first step | [`manifest`] |
//! | `scenario.toml` | the scenario with every key; it runs again as it is | before the first step | [`resolved`] |
//! | `run.mcap` | every sample with all its bits, schemas inside, the other files attached | by whole chunks | [`samples`] |
//! | `summary.json` | the verdict, and the metrics | at the end | [`summary`] |
//! | `reference.csv` | the points of a reference by table | before the first step | [`resolved`] |
//! | `scope.csv` | what the drive has captured, if the scenario has a `[scope]` | at the end | [`scope`] |
//! | `failure.json` | instead of a summary, the error that ended the run | at the end | [`failure`] |
//!
//! [`writer`] writes them during a run, [`reader`] reads them back, [`columns`] holds them in memory, [`export`] writes them in other formats, [`table`] reads those that are text, and [`diff`]
//! compares two records. Manifest and summary are one type each, for writer and readers. Chunks are written whole, and a summary takes its name only when it is complete: a record without a summary was interrupted, or failed.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod columns;
pub mod diff;
pub mod export;
pub mod failure;
pub mod file_names;
pub mod folder;
pub mod host_facts;
pub mod json_file;
pub mod manifest;
mod mf4;
#[cfg(feature = "parquet")]
pub mod parquet;
mod read_error;
pub mod reader;
pub mod resolved;
pub mod row;
pub mod samples;
pub mod scope;
pub mod source;
pub mod summary;
pub mod table;
pub mod timing;
pub mod trace;
pub mod window;
pub mod writer;
