//! Where the image of the firmware is.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::error::{DeviceError, listed};

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
    first(places).map_err(|places| {
        DeviceError::Missing(format!(
            "no image of the firmware at {}: build it with `cargo xtask image`, or name it by {kind}:PATH or {VARIABLE}",
            listed(&places)
        ))
    })
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
}
