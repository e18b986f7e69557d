//! Every kind of device. A new kind is a file here and its two lines below.

pub mod emulator;
pub mod in_process;
pub mod native;
pub mod terminal;

/// All kinds, in the order in which a name is tried on them.
pub(super) const ALL: [super::kind::Syntax; 4] =
    [in_process::SYNTAX, native::SYNTAX, emulator::SYNTAX, terminal::SYNTAX];
