//! Where the image of the firmware is.

use std::env;
use std::ffi::OsString;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use super::error::{DeviceError, listed};
use crate::regular_file::RegularFile;

/// Names of the images that `cargo xtask image` builds: this one for its default board, the others with the name of theirs.
const IMAGE: &str = "lashloop-firmware.elf";
/// Board of [`IMAGE`].
const DEFAULT_BOARD: &str = "stm32f405";
/// Variable of the environment with the path of an image.
const VARIABLE: &str = "LASHLOOP_IMAGE";
/// The workspace that this program was built in. The build puts the image into its target folder.
const WORKSPACE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The image in a name of a device, `KIND` or `KIND:ELF`; `None` for another kind.
///
/// # Errors
/// The path after the colon is missing.
pub(super) fn parse(kind: &str, text: &str) -> Option<Result<Option<PathBuf>, String>> {
    match text.strip_prefix(kind)?.strip_prefix(':') {
        None => (text == kind).then_some(Ok(None)),
        Some("") => Some(Err(format!("{kind}: needs the path of an image after the colon"))),
        Some(image) => Some(Ok(Some(image.into()))),
    }
}

/// The name that [`parse`] parses.
pub(super) fn name(kind: &str, image: Option<&Path>) -> String {
    image.map_or_else(|| kind.to_owned(), |image| format!("{kind}:{}", image.display()))
}

/// The image to run: the one given, else the first that exists. `kind` is the kind of device that an error suggests to
/// name an image by.
///
/// # Errors
/// No image is there; the error lists the places.
pub fn find(kind: &'static str, given: Option<&Path>) -> Result<PathBuf, DeviceError> {
    let places = match given {
        Some(image) => vec![image.to_owned()],
        None => places(IMAGE, env::var_os(VARIABLE), env::current_exe().ok().as_deref()),
    };
    let image = first(places).map_err(|places| {
        DeviceError::Missing(format!(
            "no image of the firmware at {}: build it with `cargo xtask image`, or name it by {kind}:PATH or {VARIABLE}",
            listed(&places)
        ))
    })?;
    let other = |what: String| {
        let (image, remedy) = (image.display(), "name the ELF that the build of the firmware makes");
        DeviceError::Missing(format!("{image} {what}; {remedy}, by {kind}:PATH or {VARIABLE}"))
    };
    match is_for_arm(&image) {
        Ok(true) => Ok(image),
        Ok(false) => {
            Err(other("isn't an image: neither an ELF for a 32-bit Arm processor nor its bytes".to_owned()))
        }
        Err(error) => Err(other(format!("can't be read: {error}"))),
    }
}

/// Whether a file begins as an ELF of 32 bits for Arm does, or with the vectors of a Cortex-M: a stack in RAM and a function
/// in the flash. An emulator would run any bytes, and the drive would get the blame.
fn is_for_arm(image: &Path) -> io::Result<bool> {
    /// Its class is 32 bits, its bytes are little endian.
    const MAGIC: &[u8] = b"\x7fELF\x01\x01";
    /// `e_machine`, behind `e_ident` and `e_type`.
    const MACHINE: (usize, [u8; 2]) = (18, [40, 0]);
    let mut head = Vec::new();
    RegularFile::open(image)?.file.take(20).read_to_end(&mut head)?;
    let (at, machine) = MACHINE;
    let is_elf = head.starts_with(MAGIC) && head.get(at..) == Some(&machine[..]);
    let word = |at: usize| head.get(at..)?.first_chunk().map(|bytes| u32::from_le_bytes(*bytes));
    let has_vectors = matches!((word(0), word(4)), (Some(stack), Some(reset))
        if (0x1000_0000..0x4000_0000).contains(&stack) && reset & 1 == 1 && reset < 0x1000_0000);
    Ok(is_elf || has_vectors)
}

/// The image of `cargo xtask image` for a board, for the default board without one.
///
/// # Errors
/// No image is there: the places.
pub fn find_for_board(board: Option<&str>) -> Result<PathBuf, Vec<PathBuf>> {
    let image = match board {
        None | Some(DEFAULT_BOARD) => IMAGE.to_owned(),
        Some(board) => format!("lashloop-firmware-{board}.elf"),
    };
    first(places(&image, env::var_os(VARIABLE), env::current_exe().ok().as_deref()))
}

/// The first file that exists.
///
/// # Errors
/// No place has a file: returns the places.
pub(super) fn first(places: Vec<PathBuf>) -> Result<PathBuf, Vec<PathBuf>> {
    places.iter().find(|place| place.is_file()).cloned().ok_or(places)
}

/// Where an image is looked for, in this order. One that the environment names is the only one.
fn places(image: &str, variable: Option<OsString>, program: Option<&Path>) -> Vec<PathBuf> {
    if let Some(image) = variable.filter(|image| !image.is_empty()) {
        return vec![image.into()];
    }
    let workspace = Path::new(WORKSPACE);
    let built = workspace.canonicalize().unwrap_or_else(|_| workspace.to_owned()).join("target").join(image);
    // Next to the program, and above target/debug for one that Cargo has built in another target folder.
    let near = program.into_iter().flat_map(Path::ancestors).skip(1).take(3).map(|folder| folder.join(image));
    let here = env::current_dir().unwrap_or_default().join("target").join(image);
    let mut places: Vec<PathBuf> = Vec::new();
    for place in [built].into_iter().chain(near).chain([here]) {
        if !places.contains(&place) {
            places.push(place);
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_environment_is_the_only_place_and_the_workspace_the_first() {
        let program = Path::new("/opt/lashloop/bin/lashloop");
        assert_eq!(places(IMAGE, Some("x.elf".into()), Some(program)), [PathBuf::from("x.elf")]);
        let places = places(IMAGE, Some(OsString::new()), Some(program));
        let workspace = Path::new(WORKSPACE).canonicalize().unwrap();
        assert_eq!(places[0], workspace.join("target/lashloop-firmware.elf"));
        assert_eq!(places[1], Path::new("/opt/lashloop/bin/lashloop-firmware.elf"));
        assert_eq!(places.last(), Some(&env::current_dir().unwrap().join("target/lashloop-firmware.elf")));
    }

    #[test]
    fn a_missing_image_is_reported_with_its_place() {
        let error = find("qemu", Some(Path::new("none.elf"))).unwrap_err();
        let want = "no image of the firmware at none.elf: build it with `cargo xtask image`, or name it by qemu:PATH or \
                    LASHLOOP_IMAGE";
        assert_eq!(error.to_string(), want);
    }

    #[test]
    fn an_image_is_an_elf_for_arm_or_its_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let image = folder.path().join("image");
        let elf = |machine: u8| [&b"\x7fELF\x01\x01\x01\0\0\0\0\0\0\0\0\0\x02\0"[..], &[machine, 0]].concat();
        let vectors = [0x2000_1000_u32, 0x0800_0181].map(u32::to_le_bytes).concat();
        for (bytes, is_image) in [
            (elf(40), true),
            (vectors, true),
            (elf(62), false),
            (b"# Read me first\n".to_vec(), false),
            (vec![], false),
        ] {
            std::fs::write(&image, &bytes).unwrap();
            assert_eq!(find("qemu", Some(&image)).is_ok(), is_image, "{bytes:x?}");
        }
    }
}
