//! The archive: the program as one static file, with the loader of FMUs and the library of exported ones, and its checksum.
//!
//! With the target for musl installed the program is built for it. Otherwise only the last step differs from an ordinary
//! build: `main` is linked once more, with the static C library of this machine. Dependencies are those of the other builds.

use std::env::consts::ARCH;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use anyhow::{Context, Result, ensure};
use object::elf;
use object::read::elf::{ElfFile64, FileHeader, ProgramHeader};
use serde_json::Value;

use super::profile::{FMU_LIBRARY, LOADER, NAME, Profile, VERSION};
use crate::command::{cargo, command, first_line, output, run};
use crate::{licences, paths};

/// Its package, and the libraries that its `main` calls.
const PACKAGE: &str = "lashloop-cli";
/// The package of the library of exported FMUs.
const FMU_PACKAGE: &str = "lashloop-fmu-library";
const LIBRARIES: [&str; 2] = ["lashloop_cli", "lashloop"];

/// Options of the build: every feature.
const FEATURES: &str = "--features lashloop-cli/parquet";

/// What the C library of the program is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Library {
    Musl,
    Glibc,
}

/// Builds the program, checks it and packs it. Returns the folder that is in the archive.
pub(super) fn make(profile: Profile) -> Result<PathBuf> {
    let musl = format!("{ARCH}-unknown-linux-musl");
    let libraries = output(command("rustc", "--print target-libdir --target").arg(&musl)).unwrap_or_default();
    let has_musl = Path::new(libraries.trim()).is_dir();
    let (library, triple) =
        if has_musl { (Library::Musl, musl) } else { (Library::Glibc, format!("{ARCH}-unknown-linux-gnu")) };
    let name = format!("{NAME}-{VERSION}-{ARCH}-linux");
    let target = profile.target();
    let folder = target.join(&name);
    paths::empty_folder(&folder)?;
    let program = folder.join(NAME);
    match library {
        Library::Musl => build_for_musl(profile, &triple, &program)?,
        Library::Glibc => link_statically(profile, &program)?,
    }
    check(&program)?;
    check_parquet(&program, &target)?;
    build_loader(profile, &folder.join(LOADER))?;
    build_fmu_library(profile, &folder.join(FMU_LIBRARY))?;
    check_fmu(&program, &target)?;
    for file in ["LICENSE-MIT", "LICENSE-APACHE", "README.md", "CHANGELOG.md"] {
        fs::copy(paths::root().join(file), folder.join(file))
            .with_context(|| format!("{file} can't be copied"))?;
    }
    fs::write(
        folder.join("THIRD-PARTY.txt"),
        licences::collect(&[PACKAGE, LOADER, FMU_PACKAGE], &triple, FEATURES, library == Library::Glibc)?,
    )?;
    complete(&program, &folder)?;
    let archive = pack(&target, &name)?;
    println!("{}", archive.display());
    Ok(folder)
}

fn build_for_musl(profile: Profile, target: &str, program: &Path) -> Result<()> {
    let name = profile.name();
    let arguments = format!("build --workspace --bin {NAME} --profile {name} --target {target} {FEATURES}");
    run(cargo(&arguments).env("CARGO_PROFILE_RELEASE_STRIP", "symbols"))?;
    let built = paths::root().join("target").join(target).join(profile.folder()).join(NAME);
    fs::copy(&built, program).with_context(|| format!("{} can't be copied", built.display()))?;
    Ok(())
}

/// Links `main` and the library of the program with a static C library.
fn link_statically(profile: Profile, program: &Path) -> Result<()> {
    let build = match profile {
        Profile::Dev => "programs".to_owned(), // Of the libraries that the tests have built, see `.cargo/config.toml`.
        Profile::Release => format!("build --workspace --bin {NAME}"),
    };
    let arguments =
        format!("{build} --profile {} --message-format json-render-diagnostics {FEATURES}", profile.name());
    let messages = output(cargo(&arguments).stderr(Stdio::inherit()))?;
    let messages = messages.lines().map(serde_json::from_str).collect::<Result<Vec<Value>, _>>();
    let messages = messages.context("the messages of cargo aren't JSON")?;
    let target = |name: &str, kind: &str| {
        messages.iter().find(|it| it["target"]["name"] == name && it["target"]["kind"][0] == kind)
    };
    let library = |name: &str| {
        let files = target(name, "lib").and_then(|message| message["filenames"].as_array());
        let mut files = files.into_iter().flatten().filter_map(Value::as_str);
        let library =
            files.find(|file| file.ends_with(".rlib")).context("cargo lists no library of the program")?;
        anyhow::Ok(format!("{name}={library}"))
    };
    let main = target(NAME, "bin");
    let target = main.map(|message| &message["target"]).context("cargo lists no program")?;
    let (source, edition) = (target["src_path"].as_str(), target["edition"].as_str());
    let dependencies = paths::root().join("target").join(profile.folder()).join("deps");
    let mut link = command("rustc", "--crate-type bin -C target-feature=+crt-static -C strip=symbols");
    link.args(["--crate-name", NAME, "--edition", edition.context("cargo names no edition")?])
        .arg(source.context("cargo names no source")?)
        .arg("-L")
        .arg(format!("dependency={}", dependencies.display()))
        .arg("-o")
        .arg(program);
    for name in LIBRARIES {
        link.arg("--extern").arg(library(name)?);
    }
    run(&mut link)
        .context("the static C library is missing? libc6-dev has it on Debian, glibc-static elsewhere")
}

/// Builds the loader of FMUs next to the program. It isn't static: it loads libraries, which need the C library of the machine.
fn build_loader(profile: Profile, program: &Path) -> Result<()> {
    let build = match profile {
        Profile::Dev => "programs".to_owned(),
        Profile::Release => format!("build --workspace --bin {LOADER}"),
    };
    run(&mut cargo(&format!("{build} --profile {} {FEATURES}", profile.name())))?;
    let built = paths::root().join("target").join(profile.folder()).join(LOADER);
    run(command("strip", "-o").arg(program).arg(&built))?;
    let version = first_line(&mut command(program, "--version"));
    ensure!(version.is_some_and(|line| line.starts_with(LOADER)), "{} has no version", program.display());
    Ok(())
}

/// Builds the library of exported FMUs next to the program. Importers load it, so it isn't static either.
fn build_fmu_library(profile: Profile, library: &Path) -> Result<()> {
    let build = match profile {
        Profile::Dev => format!("programs {FEATURES}"),
        Profile::Release => format!("build --package {FMU_PACKAGE} --release"),
    };
    run(&mut cargo(&build))?;
    let built = paths::root().join("target").join(profile.folder()).join(FMU_LIBRARY);
    run(command("strip", "--strip-unneeded -o").arg(library).arg(&built))
}

/// Checks that the program exports an FMU that the loader reads.
fn check_fmu(program: &Path, target: &Path) -> Result<()> {
    let fmu = target.join("plant.fmu");
    output(command(program, "fmu export scenarios/smooth-after.toml --of plant --out").arg(&fmu))?;
    let shown = output(command(program, "fmu show").arg(&fmu))?;
    ensure!(shown.contains("torque_nm"), "the exported FMU has no torque: {shown}");
    fs::remove_file(&fmu).with_context(|| format!("{} can't be removed", fmu.display()))
}

/// Checks that the program needs no other file, and runs it.
fn check(program: &Path) -> Result<()> {
    let bytes = fs::read(program).with_context(|| format!("{} can't be read", program.display()))?;
    ensure!(is_static(&bytes)?, "{} loads libraries at its start", program.display());
    let version = first_line(&mut command(program, "--version"));
    ensure!(version.is_some_and(|line| line.starts_with(NAME)), "{} has no version", program.display());
    let mut first_run = command(program, "run scenarios/smooth-after.toml --device inproc");
    // Only this file: no other library and no configuration is at hand.
    let printed = output(first_run.env_clear())?;
    let first = printed.lines().next();
    ensure!(
        first.is_some_and(|line| line.starts_with("PASS  ")),
        "a run of {} prints {first:?}",
        program.display()
    );
    Ok(())
}

/// Checks that the program exports Parquet.
fn check_parquet(program: &Path, target: &Path) -> Result<()> {
    // With a folder around it, because the run makes the link `latest` next to its record.
    let folder = target.join("parquet");
    let record = folder.join("record");
    output(command(program, "run scenarios/smooth-after.toml --device inproc --force --out").arg(&record))?;
    output(command(program, "export --to parquet").arg(&record))?;
    fs::remove_dir_all(&folder).with_context(|| format!("{} can't be removed", folder.display()))
}

/// Whether a program has neither an interpreter nor needed libraries.
fn is_static(bytes: &[u8]) -> Result<bool> {
    let file = ElfFile64::<object::Endianness>::parse(bytes)?;
    let endian = file.endian();
    let headers = file.elf_header().program_headers(endian, bytes)?;
    let is_interpreted = headers.iter().any(|header| header.p_type(endian) == elf::PT_INTERP);
    let mut needed = 0;
    for header in headers {
        if let Some(entries) = header.dynamic(endian, bytes)? {
            needed += entries.iter().filter(|entry| entry.d_tag.get(endian) == elf::DT_NEEDED).count();
        }
    }
    Ok(!is_interpreted && needed == 0)
}

/// Writes completions and man pages, which the program makes.
fn complete(program: &Path, folder: &Path) -> Result<()> {
    let completions = folder.join("completions");
    fs::create_dir_all(&completions)?;
    for shell in ["bash", "zsh", "fish"] {
        let script = output(&mut command(program, &format!("completions {shell}")))?;
        fs::write(completions.join(format!("{NAME}.{shell}")), script)?;
    }
    run(command(program, "completions --man").arg(folder.join("man")))
}

/// Packs a folder and writes the checksum of the archive. Equal contents give an equal archive.
fn pack(target: &Path, name: &str) -> Result<PathBuf> {
    let archive = format!("{name}.tar.gz");
    let mut tar =
        command("tar", "--sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner --mode=u+rw,go=u-w");
    tar.args(["--use-compress-program=gzip -n", "-cf", &archive, name]).current_dir(target);
    run(&mut tar)?;
    let sum = output(command("sha256sum", &archive).current_dir(target))?;
    fs::write(target.join(format!("{archive}.sha256")), sum)?;
    run(command("sha256sum", "--quiet --check").arg(format!("{archive}.sha256")).current_dir(target))?;
    Ok(target.join(archive))
}
