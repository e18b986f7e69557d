//! Parts of a page: one section per file.

pub(super) mod command;
pub(super) mod differences;
pub(super) mod expectations;
pub(super) mod faults;
pub(super) mod metrics;
pub(super) mod origin;
pub(super) mod plots;
pub(super) mod settings;
pub(super) mod timing;
pub(super) mod verdict;
