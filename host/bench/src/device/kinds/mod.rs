//! Every kind of device. A new kind is a file here and its two lines below.

pub mod command;
pub mod emulator;
pub mod in_process;
pub mod native;
pub mod rfc2217;
pub mod silicon;
pub mod tcp;
pub mod terminal;

use lashloop_firmware::law::LawSet;

use super::kind::Syntax;

/// Number of kinds.
pub const COUNT: usize = 8;

/// All kinds, in the order in which a name is tried on them. The drive in this process has the laws `L`.
#[must_use]
pub const fn all<L: LawSet>() -> [Syntax; COUNT] {
    [
        in_process::syntax::<L>(),
        native::SYNTAX,
        emulator::SYNTAX,
        silicon::SYNTAX,
        command::SYNTAX,
        tcp::SYNTAX,
        rfc2217::SYNTAX,
        // Last: any other text with a slash is a path.
        terminal::SYNTAX,
    ]
}
