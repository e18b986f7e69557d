//! Tuning and comparison of the laws, in process.
//!
//! | module | is |
//! |---|---|
//! | [`laws`] | the laws with their scenarios, and what is tuned within which range |
//! | [`case`] | one run and its figures |
//! | [`hard`] | constants for the machines of the harder battery |
//! | [`cost`] | what the tuning minimises |
//! | [`search`] | the search, equal for every law |
//! | [`table`] | figures over many plants |

pub mod case;
pub mod cost;
pub mod hard;
pub mod laws;
pub mod search;
pub mod table;
