//! The names of the campaign's terms in text: the same as in JSON, CSV and scenarios.

use std::fmt;

use serde::Serialize;

use super::case::Part;
use super::quantiles::Quantile;
use super::score::MissingReason;

macro_rules! named_as_serialized {
    ($($term:ty),+) => {
        $(impl fmt::Display for $term {
            fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.serialize(out)
            }
        })+
    };
}

named_as_serialized!(MissingReason, Part, Quantile);
