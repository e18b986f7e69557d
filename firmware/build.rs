//! Passes the commit to the build, and whether the sources differ from it; memory map and linker script to the Arm image.
//!
//! The linker arguments are not in `.cargo/config.toml` because `RUSTFLAGS` would silently replace them there.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let (build_id, is_dirty) = (build_id(), u8::from(is_dirty()));
    println!("cargo::rustc-env=LASHLOOP_BUILD_ID={build_id}");
    println!("cargo::rustc-env=LASHLOOP_BUILD_DIRTY={is_dirty}");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        println!("cargo::rerun-if-changed=memory.x");
        let folder = env::var("OUT_DIR").expect("cargo sets OUT_DIR");
        // Absolute symbols take no flash. `lashloop flash` compares them with what the drive reports.
        let symbols = format!("_lashloop_build_id = 0x{build_id};\n_lashloop_build_is_dirty = {is_dirty};\n");
        let board = Board::selected();
        board.write_modules(Path::new(&folder));
        // Virtual silicon wires the pins of the board, and `lashloop flash` names the chip to a debug probe.
        let board = format!("\"_lashloop_board_{}\" = 1;\n_lashloop_chip_{} = 1;\n", board.name, board.chip);
        let memory = fs::read_to_string("memory.x").expect("the memory map") + &symbols + &board;
        fs::write(Path::new(&folder).join("memory.x"), memory).expect("cargo makes OUT_DIR writable");
        println!("cargo::rustc-link-search={folder}");
        println!("cargo::rustc-link-arg-bins=-Tlink.x");
        // `lashloop flash` refuses it.
        println!("cargo::rustc-link-arg-bin=codec-cost=--defsym=_lashloop_no_drive=1");
    }
}

/// The selected board: a file with its pins in the folder of its chip family, which says the rest.
struct Board {
    file: PathBuf,
    name: String,
    chip: String,
    /// Interrupts of its link and of its converters.
    link: String,
    sensor: String,
}

impl Board {
    /// The board of the feature `board-...`; the bare board is the default and yields to another one.
    fn selected() -> Self {
        let features = env::vars()
            .filter_map(|(name, _)| Some(name.strip_prefix("CARGO_FEATURE_BOARD_")?.to_lowercase()));
        let (bare, others): (Vec<_>, Vec<_>) = features.partition(|feature| feature == "f405_bare");
        let [feature] = &others[..] else {
            assert!(others.is_empty(), "an image is for one board, and these are selected: {others:?}");
            let [feature] = &bare[..] else {
                panic!("no board is selected: features board-... are in Cargo.toml")
            };
            return Self::read(feature);
        };
        Self::read(feature)
    }

    fn read(feature: &str) -> Self {
        let families = fs::read_dir("src/board").expect("the folder of the boards").flatten();
        let mut files = families.map(|family| family.path().join(format!("{feature}.rs")));
        let file = files.find(|file| file.exists());
        let file =
            file.unwrap_or_else(|| panic!("no folder in src/board has {feature}.rs, the pins of the board"));
        println!("cargo::rerun-if-changed={}", file.display());
        let text = fs::read_to_string(&file).expect("the pins of the board");
        let text_of = |start: &str, end: &str| {
            let value = text.split_once(start).and_then(|(_, rest)| rest.split_once(end));
            value.unwrap_or_else(|| panic!("{} has no `{start}...{end}`", file.display())).0.to_owned()
        };
        let link = text_of("const LINK: Interrupt = Interrupt::", ";");
        let sensor = text_of("const SENSOR: Interrupt = Interrupt::", ";");
        let (name, chip) = (text_of("const NAME: &str = \"", "\";"), text_of("const CHIP: &str = \"", "\";"));
        Self { file: file.canonicalize().expect("it exists"), name, chip, link, sensor }
    }

    /// What depends on the board in `src/board`.
    fn write_modules(&self, folder: &Path) {
        let Self { file, link, sensor, .. } = self;
        let fitted = format!("#[path = {file:?}]\nmod fitted;\n");
        fs::write(folder.join("fitted.rs"), fitted).expect("cargo makes OUT_DIR writable");
        let image = format!(
            "#[doc(hidden)]\n#[macro_export]\nmacro_rules! image_of_board {{\n    ($laws:ty) => {{\n        \
             $crate::image!($laws, {link}, {sensor});\n    }};\n}}\n"
        );
        fs::write(folder.join("image_of_board.rs"), image).expect("cargo makes OUT_DIR writable");
    }
}

/// First 32 bits of the commit in hexadecimal; zeros without a repository or without git.
fn build_id() -> String {
    // Every commit, checkout and reset writes to the log of HEAD; HEAD itself covers repositories without logs.
    // Cargo treats a missing file as changed and would rebuild on every call, so we list existing files only.
    for name in ["HEAD", "logs/HEAD"] {
        if let Some(path) = git(&["rev-parse", "--git-path", name]).filter(|path| Path::new(path).exists()) {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    let commit = git(&["rev-parse", "HEAD"]).unwrap_or_default();
    commit.get(..8).unwrap_or("00000000").to_owned()
}

/// What the firmware is compiled from, besides registry crates: relative to this package, in Lashloop's repository.
const SOURCES: [&str; 5] =
    ["src", "Cargo.toml", "../protocol/src", "../protocol/Cargo.toml", "../Cargo.toml"];

/// Whether the sources differ from the commit, or whether that is unknown.
///
/// The check covers exactly the files that Cargo watches here, so it is repeated whenever its result may change, and costs
/// one `git status` of two folders. It doesn't cover the toolchain, the lock file, new files that git doesn't track, and
/// the crate of a user's own laws: their changes leave the mark at 0.
fn is_dirty() -> bool {
    for source in SOURCES.iter().filter(|source| Path::new(source).exists()) {
        println!("cargo::rerun-if-changed={source}");
    }
    let status = ["status", "--porcelain", "--untracked-files=no", "--"];
    git(&[&status[..], &SOURCES[..]].concat()).is_none_or(|changes| !changes.is_empty())
}

fn git(arguments: &[&str]) -> Option<String> {
    let output =
        Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
