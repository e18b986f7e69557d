//! The ways onto the chip whose programs are installed.

use lashloop::rig::way::Way;
use lashloop_bench::supervisor::find_program;

/// The ways whose programs are installed: of all, or of one.
#[must_use]
pub fn installed(only: Option<Way>) -> Vec<Way> {
    let chosen = |way: &Way| only.is_none_or(|only| only == *way);
    Way::ALL.into_iter().filter(chosen).filter(|way| find_program(way.program()).is_ok()).collect()
}

/// Whether a drive that enters its boot loader by request can be written then: a program has to reach the loader. `uart` needs a
/// terminal at the loader's own pins; those of the drive are others.
#[must_use]
pub fn reaches_loader(only: Option<Way>, has_loader_port: bool) -> bool {
    installed(only).into_iter().any(|way| match way {
        Way::Probe => false,
        Way::Dfu => true,
        Way::Uart => has_loader_port,
    })
}

/// The programs of all ways, for messages.
#[must_use]
pub fn programs() -> String {
    Way::ALL.map(Way::program).join(", ")
}
