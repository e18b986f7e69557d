//! Every kind of device. A new kind is a file here and its two lines below.

pub mod command;
pub mod emulator;
pub mod in_process;
pub mod native;
pub mod rfc2217;
pub mod tcp;
pub mod terminal;

/// All kinds, in the order in which a name is tried on them.
pub(super) const ALL: [super::kind::Syntax; 7] = [
    in_process::SYNTAX,
    native::SYNTAX,
    emulator::SYNTAX,
    command::SYNTAX,
    tcp::SYNTAX,
    rfc2217::SYNTAX,
    // Last: any other text with a slash is a path.
    terminal::SYNTAX,
];
