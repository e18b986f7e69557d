//! Faults of the link, as a middleware between the bench and any link.
//!
//! | module | is |
//! |---|---|
//! | `piece` | a frame on its way |
//! | `impairment` | one direction: frames are hit, held and released |
//! | `faulty_link` | the middleware: both directions and the connection |
//! | `link_faults` | the handle by which the run steers the middleware |

mod faulty_link;
mod impairment;
mod link_faults;
mod piece;

pub use link_faults::LinkFaults;
