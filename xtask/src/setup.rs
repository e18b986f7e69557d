//! Installing what is missing, announced before it happens. Nothing asks a question and nothing waits without end.

use std::time::Duration;

use anyhow::{Context, Result, ensure};

use crate::apt;
use crate::arm_toolchain::{ArmToolchain, TARGET};
use crate::{command, python};

/// Programs that the tests call, each with the Debian package that has it.
const PROGRAMS: [(&str, &str); 3] =
    [("qemu-system-arm", "qemu-system-arm"), ("tshark", "tshark"), ("c++", "g++")];
/// A compiler with the sources of `core`, for a rustup without a network.
const DEBIAN_RUST: [&str; 3] = ["rustc-web", "rust-web-src", "rust-web-clippy"];
const DEBIAN_PYTHON: [&str; 2] = ["python3", "python3-venv"];

/// rustup waits long for a server it can't reach.
const RUSTUP_LIMIT: Duration = Duration::from_secs(60);

/// What is missing here.
struct Missing {
    /// Debian packages of missing programs.
    programs: Vec<&'static str>,
    arm_core: bool,
    python: bool,
    python_package: bool,
}

/// Installs the emulator, a reader of captures, a C++ compiler, a core library for Arm and the Python package.
///
/// # Errors
/// What could not be installed, and what to do.
pub(crate) fn install_missing() -> Result<()> {
    let missing = Missing::find();
    missing.announce();
    let Missing { programs, arm_core, python, python_package } = missing;
    // One failure doesn't keep the rest from being installed.
    let mut failures = Vec::new();
    let python_packages: &[_] = if python { &DEBIAN_PYTHON } else { &[] };
    if let Err(error) = apt::install(&[&programs[..], python_packages].concat()) {
        failures.push(format!("{error:#}"));
    }
    for (program, package) in PROGRAMS {
        if command::find_program(program).is_none() {
            failures
                .push(format!("{program} is missing: install it (Debian package {package}) and call again"));
        }
    }
    let installed = [
        if arm_core { install_arm_core() } else { Ok(()) },
        if python_package { python::set_up() } else { Ok(()) },
    ];
    failures.extend(installed.into_iter().filter_map(Result::err).map(|error| format!("{error:#}")));
    ensure!(failures.is_empty(), "{}", failures.join("\n"));
    Ok(())
}

impl Missing {
    fn find() -> Self {
        let missing = PROGRAMS.into_iter().filter(|(program, _)| command::find_program(program).is_none());
        let python_package = !python::is_set_up();
        Self {
            programs: missing.map(|(_, package)| package).collect(),
            arm_core: ArmToolchain::find().is_err(),
            python: python_package && python::find_python().is_none(),
            python_package,
        }
    }

    fn announce(&self) {
        let mut plan = Vec::new();
        let by_apt = if apt::is_root() { "by apt-get" } else { "by apt-get, as root through sudo" };
        if !self.programs.is_empty() {
            plan.push(format!("{}: {by_apt}", self.programs.join(", ")));
        }
        if self.arm_core {
            plan.push(format!(
                "core library for {TARGET}: by rustup; without its server {}: {by_apt}",
                DEBIAN_RUST.join(", ")
            ));
        }
        if self.python {
            plan.push(format!("{}: {by_apt}", DEBIAN_PYTHON.join(", ")));
        }
        if self.python_package {
            plan.push("the Python package with its test tools: by pip, into target/python".to_owned());
        }
        if plan.is_empty() {
            println!("setup: nothing is missing");
        } else {
            println!("setup installs\n  {}", plan.join("\n  "));
        }
    }
}

fn install_arm_core() -> Result<()> {
    if command::find_program("rustup").is_some() {
        let mut rustup = command::rustup();
        let added = command::run_for(rustup.args(["target", "add", TARGET]), RUSTUP_LIMIT);
        // rustup may have added it to another compiler than the one in PATH, so its exit code is not enough.
        if ArmToolchain::find().is_ok() {
            return Ok(());
        }
        if let Err(error) = added {
            println!("setup: {error:#}; trying Debian's compiler");
        }
    }
    let installed = apt::install(&DEBIAN_RUST);
    ArmToolchain::find().map(drop).or_else(|missing| installed.and(Err(missing)).context("no Arm toolchain"))
}
