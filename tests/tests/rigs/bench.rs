//! A rig file for a twin.

use std::fs;
use std::path::PathBuf;

use tempfile::TempDir;

/// A rig file; the folder goes with it.
pub(crate) struct RigFile {
    _folder: TempDir,
    path: PathBuf,
}

impl RigFile {
    /// A rig with this device, whose torque limit is above the default of the drive.
    pub(crate) fn new(device: &str) -> Self {
        Self::with(device, "native-twin", "torque_nm = 50.0\nload_travel_rad = 2.0")
    }

    pub(crate) fn with(device: &str, board: &str, limits: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("rig.toml");
        let text = format!(
            "title = \"Bench 2\"\ncontact = \"A. Engineer\"\nboard = \"{board}\"\n[port]\ndevice = \"{device}\"\n[limits]\n{limits}\n"
        );
        fs::write(&path, text).expect("a rig file");
        Self { _folder: folder, path }
    }

    /// The file as `--rig` takes it.
    pub(crate) fn path(&self) -> String {
        self.path.display().to_string()
    }
}
