//! Installing what is missing, announced before it happens. No installer asks a question or waits without a limit.

use anyhow::{Context, Result, anyhow, ensure};

use crate::arm_toolchain::{ArmToolchain, TARGET};
use crate::command::{command, is_installed, run};
use crate::{apt, python, slurm, usb_guest};

/// Programs that the tests call, each with the Debian packages that it needs.
const PROGRAMS: [(&str, &str); 8] = [
    ("qemu-system-arm", "qemu-system-arm"),
    ("tshark", "tshark"),
    ("c++", "g++"),
    ("arm-none-eabi-gcc", "gcc-arm-none-eabi libnewlib-arm-none-eabi"),
    ("ser2net", "ser2net"),
    ("stm32flash", "stm32flash"),
    ("chromium", "chromium"),
    usb_guest::EMULATOR,
];
/// A compiler with the sources of `core`, for a rustup without a network.
const DEBIAN_RUST: [&str; 3] = ["rustc-web", "rust-web-src", "rust-web-clippy"];
const DEBIAN_PYTHON: [&str; 2] = ["python3", "python3-venv"];

/// Installs the emulators, a browser, a reader of captures, a C++ compiler, a server of serial ports, a program for the boot loader of the
/// chip, a core library for Arm and the Python package, and unpacks the parts of the guest and Slurm.
///
/// # Errors
/// What could not be installed, and what to do.
pub(crate) fn install_missing() -> Result<()> {
    let missing_programs = || PROGRAMS.into_iter().filter(|(program, _)| !is_installed(program));
    let needs_arm_core = ArmToolchain::find().is_err();
    let needs_python_package = !python::is_set_up();
    let needs_usb_guest = usb_guest::is_possible() && !usb_guest::is_set_up();
    let needs_slurm = slurm::is_possible() && !slurm::is_set_up();
    let mut packages: Vec<_> = missing_programs().flat_map(|(_, names)| names.split(' ')).collect();
    if needs_python_package && python::find().is_none() {
        packages.extend(DEBIAN_PYTHON);
    }

    let by_apt = if apt::is_root() { "by apt-get" } else { "by apt-get, as root through sudo" };
    let debian_rust = DEBIAN_RUST.join(", ");
    let plan: String = [
        (!packages.is_empty()).then(|| format!("\n  {}: {by_apt}", packages.join(", "))),
        needs_arm_core.then(|| {
            format!("\n  core library for {TARGET}: by rustup; without its server {debian_rust}: {by_apt}")
        }),
        needs_python_package
            .then(|| "\n  the Python package with its test tools: by pip, into target/python".to_owned()),
        needs_usb_guest.then(|| format!("\n  {}", usb_guest::PLAN)),
        needs_slurm.then(|| format!("\n  {}", slurm::PLAN)),
    ]
    .into_iter()
    .flatten()
    .collect();
    println!("setup: {}{plan}", if plan.is_empty() { "nothing is missing" } else { "installs" });

    // One failure doesn't keep the rest from being installed.
    let mut outcomes = vec![apt::install(&packages)];
    outcomes.extend(missing_programs().map(|(program, package)| {
        Err(anyhow!("{program} is missing: install it (Debian package {package}) and call again"))
    }));
    if needs_arm_core {
        outcomes.push(install_arm_core());
    }
    if needs_python_package {
        outcomes.push(python::set_up());
    }
    if needs_usb_guest && let Err(error) = usb_guest::set_up() {
        println!("setup: NO LINUX GUEST, its tests are left out: {error:#}");
    }
    if needs_slurm && let Err(error) = slurm::set_up() {
        println!("setup: NO SLURM, its tests are left out: {error:#}");
    }
    let failures: Vec<_> =
        outcomes.into_iter().filter_map(Result::err).map(|error| format!("{error:#}")).collect();
    ensure!(failures.is_empty(), "{}", failures.join("\n"));
    Ok(())
}

fn install_arm_core() -> Result<()> {
    if is_installed("rustup") {
        // rustup waits long for a server it can't reach.
        let added = run(command("timeout", "60 rustup target add").arg(TARGET));
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
