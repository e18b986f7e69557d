//! The FMU as a file.

use std::env::consts::ARCH;
use std::io::{self, Cursor, Write as _};
use std::path::{Path, PathBuf};
use std::{env, fs};

use lashloop_bench::scenario::Scenario;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::description::{Described, Version};
use crate::error::ExportError;
use crate::part::Part;
use crate::side::Side;
use crate::source::{PART, SCENARIO, Source, TABLE};

/// The library that every FMU has.
const LIBRARY: &str = "liblashloop_fmu.so";

/// What the library of this version contains, and no other file.
pub const MARKER: &str = concat!("lashloop-fmu-library ", env!("CARGO_PKG_VERSION"), ";");
/// The licences of what an FMU passes on.
const LICENCES: &str = concat!(
    "This FMU contains a library of Lashloop, under the MIT or the Apache-2.0 licence as you choose. Crates in the library have\n",
    "licences of their own: THIRD-PARTY.txt in the packages of Lashloop has them.\n\n",
    include_str!("../LICENSE-MIT"),
    "\n",
    include_str!("../LICENSE-APACHE")
);

/// Where a package of a distribution has the library, from the folder of the program.
const INSTALLED: &str = "../lib/lashloop";

/// Path of the library: next to this program, or in `../lib/lashloop` from there.
///
/// # Errors
/// It is in neither.
pub fn library() -> Result<PathBuf, ExportError> {
    let failed = |source| ExportError::File { path: PathBuf::from("this program"), source };
    let program = env::current_exe().map_err(failed)?;
    let places = [PathBuf::from(LIBRARY), Path::new(INSTALLED).join(LIBRARY)];
    let mut places = places.map(|place| program.with_file_name(place)).into_iter();
    places.find(|library| library.is_file()).ok_or(ExportError::NoLibrary { library: LIBRARY, program })
}

/// The bytes of an FMU: this part of a scenario with this library.
///
/// # Errors
/// The part can't be in an FMU, the scenario doesn't fit the drive, or the library can't be read.
pub fn export(
    scenario: &Scenario,
    part: Part,
    version: Version,
    library: &Path,
) -> Result<Vec<u8>, ExportError> {
    part.check(scenario)?;
    let platform = platform(version)?;
    let source = Source::of(scenario, part, version)?;
    let interface = Side::interface(&source)?;
    let source = source.packed()?;
    let token = source.token();
    let described = Described { version, part, scenario, interface: &interface, token: &token };
    let unwritten = |source| ExportError::File { path: PathBuf::from("the FMU"), source };
    let description = described.xml().map_err(unwritten)?;
    let binary =
        fs::read(library).map_err(|source| ExportError::File { path: library.to_owned(), source })?;
    let has_marker = binary.windows(MARKER.len()).any(|bytes| bytes == MARKER.as_bytes());
    if !has_marker {
        return Err(ExportError::StrangeLibrary { path: library.to_owned(), marker: MARKER });
    }
    let binary_name = format!("binaries/{platform}/{}.so", part.identifier());
    let in_resources = |name: &str| format!("resources/{name}");
    let kind = source.kind();
    let mut files = vec![
        ("modelDescription.xml".to_owned(), &*description),
        (binary_name, &*binary),
        (in_resources(SCENARIO), source.text.as_bytes()),
        (in_resources(PART), kind.as_bytes()),
        ("documentation/licenses/license.txt".to_owned(), LICENCES.as_bytes()),
    ];
    files.extend(source.table.as_deref().map(|table| (in_resources(TABLE), table)));
    pack(&files).map_err(unwritten)
}

/// The name of this platform in a version of FMI.
fn platform(version: Version) -> Result<&'static str, ExportError> {
    match (version, ARCH) {
        (Version::Two, "x86_64") => Ok("linux64"),
        (Version::Three, "x86_64") => Ok("x86_64-linux"),
        (Version::Three, "aarch64") => Ok("aarch64-linux"),
        _ => Err(ExportError::Platform { version: version.name(), processor: ARCH }),
    }
}

/// Without times, so that equal contents give an equal archive.
fn pack(files: &[(String, &[u8])]) -> io::Result<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        let mode = if name.starts_with("binaries/") { 0o755 } else { 0o644 };
        archive.start_file(name.as_str(), SimpleFileOptions::default().unix_permissions(mode))?;
        archive.write_all(bytes)?;
    }
    Ok(archive.finish()?.into_inner())
}
