//! The drive's image, unmodified, in bench mode on virtual silicon. A host speaks the protocol over its link in device time.

mod arming;
mod bench;
mod boards;
mod boot;
mod causes;
mod current;
mod docs;
mod duty;
mod encoders;
mod every_row;
mod failures;
mod host;
mod index;
mod line;
mod loader;
mod machine;
mod mutants;
mod off;
mod report;
mod speed;
mod store;
mod tick;
mod time_to_off;
mod turntable;
