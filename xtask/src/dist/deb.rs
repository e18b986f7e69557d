//! The Debian package. dpkg-deb makes it of a folder, and is on every Debian.

use std::env::consts::ARCH;
use std::path::{Path, PathBuf};
use std::{env, fs};

use anyhow::{Context, Result, bail, ensure};

use super::loader::Glibc;
use super::profile::{FMU_LIBRARY, LOADER, NAME, Profile, VERSION};
use crate::command::{command, first_line, output, run};
use crate::paths;

/// Files of the archive, each with its place on a machine. A folder stands for its files.
const PLACES: [(&str, &str); 9] = [
    (NAME, "usr/bin"),
    (LOADER, "usr/bin"),
    (FMU_LIBRARY, "usr/lib/lashloop"),
    ("README.md", "usr/share/doc/lashloop"),
    ("CHANGELOG.md", "usr/share/doc/lashloop"),
    ("THIRD-PARTY.txt", "usr/share/doc/lashloop"),
    ("LICENSE-MIT", "usr/share/doc/lashloop"),
    ("LICENSE-APACHE", "usr/share/doc/lashloop"),
    ("man", "usr/share/man/man1"),
];

/// Completions, each with the place and the name that its shell looks for.
const COMPLETIONS: [(&str, &str); 3] = [
    ("bash", "usr/share/bash-completion/completions/lashloop"),
    ("zsh", "usr/share/zsh/vendor-completions/_lashloop"),
    ("fish", "usr/share/fish/vendor_completions.d/lashloop.fish"),
];

/// The rule for FTDI adapters, in the tree and on a machine.
const RULE: (&str, &str) =
    ("host/link/src/90-ftdi-latency.rules", "usr/lib/udev/rules.d/90-lashloop-ftdi-latency.rules");

/// Time of every file in seconds since 1970, so that equal contents give an equal package: 1980, since older ones look like a
/// mistake.
const TIME: &str = "315532800";

const COPYRIGHT: &str = "\
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: lashloop

Files: *
Copyright: 2026 The Lashloop developers
License: MIT or Apache-2.0
 The texts are in LICENSE-MIT and LICENSE-APACHE in this folder; those of the crates in the program are in THIRD-PARTY.txt.
";

pub(super) fn make(profile: Profile, contents: &Path, glibc: Glibc) -> Result<PathBuf> {
    let machine = match ARCH {
        "x86_64" => "amd64",
        "aarch64" => "arm64",
        other => bail!("no name of Debian for the processor {other}: add it to {}", file!()),
    };
    let folder = profile.target().join("deb");
    paths::empty_folder(&folder)?;
    for (from, to) in PLACES {
        copy(&contents.join(from), &folder.join(to))?;
    }
    for (shell, to) in COMPLETIONS {
        let from = contents.join("completions").join(format!("{NAME}.{shell}"));
        copy_file(&from, &folder.join(to))?;
    }
    copy_file(&paths::root().join(RULE.0), &folder.join(RULE.1))?;
    fs::write(folder.join("usr/share/doc/lashloop/copyright"), COPYRIGHT)?;
    // Policy: man pages are compressed, and without a time.
    let manual = fs::read_dir(folder.join("usr/share/man/man1"))?;
    let pages = manual.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    run(command("gzip", "--best --no-name").args(pages))?;

    let size_kib = output(command("du", "--apparent-size --summarize --block-size=1024").arg(&folder))?;
    let size_kib = size_kib.split_whitespace().next().context("du printed no size")?;
    fs::create_dir(folder.join("DEBIAN"))?;
    fs::write(
        folder.join("DEBIAN/control"),
        format!(
            "Package: {NAME}
Version: {VERSION}
Architecture: {machine}
Maintainer: The Lashloop developers
Installed-Size: {size_kib}
Depends: libc6 (>= {}.{}), libgcc-s1
Recommends: udev
Suggests: qemu-system-arm, tshark
Section: electronics
Priority: optional
Description: hardware-in-the-loop bench for drives with gear backlash
 The bench simulates a drive with gear backlash, closes the loop around the
 real firmware over a serial line, a pseudo-terminal or an emulator, and says
 with evidence whether the controller is good enough.
",
            glibc.0, glibc.1
        ),
    )?;
    let package = profile.target().join(format!("{NAME}_{VERSION}_{machine}.deb"));
    let build = "--root-owner-group -Zxz --build";
    run(command("dpkg-deb", build).args([&folder, &package]).env("SOURCE_DATE_EPOCH", TIME))
        .context("dpkg-deb of Debian makes the package")?;
    check(&package, &profile.target().join("deb-root"))?;
    Ok(package)
}

/// Installs the package into a folder, runs the program, and removes it again. The folder has none of its dependencies.
fn check(package: &Path, root: &Path) -> Result<()> {
    paths::empty_folder(root)?;
    for folder in ["info", "updates", "triggers"] {
        fs::create_dir_all(root.join("var/lib/dpkg").join(folder))?;
    }
    fs::write(root.join("var/lib/dpkg/status"), "")?;
    let dpkg = || {
        let mut dpkg = command("dpkg", "--force-not-root --force-depends --log=/dev/null");
        dpkg.arg(format!("--root={}", root.display()));
        // dpkg asks for programs of the superuser, which others don't have in PATH.
        let path = env::var("PATH").unwrap_or_default();
        dpkg.env("PATH", format!("{path}:/usr/sbin:/sbin"));
        dpkg
    };
    run(dpkg().arg("--install").arg(package)).context("the package can't be installed")?;
    let version = first_line(&mut command(root.join("usr/bin").join(NAME), "--version"));
    ensure!(version.is_some_and(|line| line.starts_with(NAME)), "the installed program prints no version");
    let fmu = root.join("plant.fmu");
    run(command(root.join("usr/bin").join(NAME), "fmu export scenarios/smooth-after.toml --of plant --out")
        .arg(&fmu))?;
    fs::remove_file(&fmu)?;
    let completions = COMPLETIONS.map(|(_, place)| place);
    for file in
        completions.into_iter().chain([RULE.1, "usr/bin/lashloop-fmu", "usr/share/man/man1/lashloop.1.gz"])
    {
        ensure!(root.join(file).is_file(), "{file} isn't installed");
    }
    run(dpkg().args(["--remove", NAME])).context("the package can't be removed")?;
    let left: Vec<_> = fs::read_dir(root)?.map(|entry| Ok(entry?.file_name())).collect::<Result<_>>()?;
    ensure!(left == ["var"], "a removal leaves {left:?}");
    Ok(())
}

/// Copies a file, or the files of a folder, into a folder.
fn copy(from: &Path, to: &Path) -> Result<()> {
    if from.is_dir() {
        for entry in fs::read_dir(from)? {
            copy(&entry?.path(), to)?;
        }
        return Ok(());
    }
    copy_file(from, &to.join(from.file_name().context("a file has a name")?))
}

fn copy_file(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to.parent().context("a file is in a folder")?)?;
    fs::copy(from, to).with_context(|| format!("{} can't be copied to {}", from.display(), to.display()))?;
    Ok(())
}
