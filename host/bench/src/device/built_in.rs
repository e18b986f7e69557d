//! The drive that is part of a program, by its laws.

use std::io;

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_link::Link;
use lashloop_link::in_process::InProcess;

use super::kind::Syntax;
use super::kinds;
use super::twin::Twin;

/// The drive that is part of a program: behind `inproc`, and behind `native` as the program's command `device`.
#[derive(Clone, Copy)]
pub struct BuiltIn {
    /// Every kind of device, `inproc` with these laws.
    pub devices: [Syntax; kinds::COUNT],
    /// The drive in this process.
    pub in_process: fn() -> Box<dyn Link>,
    /// Runs the drive on the terminal of a twin until the line breaks.
    pub serve: fn(&Twin) -> io::Result<()>,
}

impl BuiltIn {
    /// A drive with these laws.
    #[must_use]
    pub fn with_laws<L: LawSet>() -> Self {
        Self {
            devices: kinds::all::<L>(),
            in_process: || Box::new(InProcess::<L>::default()),
            serve: Twin::serve_laws::<L>,
        }
    }
}

impl Default for BuiltIn {
    /// The drive with the laws of Lashloop. A drive is generic code: out of line it is compiled and optimised here, with the
    /// loop, and not with the command line.
    #[inline(never)]
    fn default() -> Self {
        Self::with_laws::<Laws>()
    }
}
