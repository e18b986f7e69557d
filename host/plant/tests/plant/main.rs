//! The bench plant against closed forms of its single events, and every plant against parameters at their extremes.

mod events;
mod extremes;
