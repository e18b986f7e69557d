//! Parts of the page of a campaign, one per file.

pub(super) mod distributions;
pub(super) mod evidence;
pub(super) mod failures;
pub(super) mod input;
pub(super) mod maps;
pub(super) mod origin;
pub(super) mod still;
pub(super) mod verdict;
