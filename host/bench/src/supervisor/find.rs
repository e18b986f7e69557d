//! Where a program is.

use std::env;
use std::path::{Path, PathBuf};

use rustix::fs::{Access, access};

/// Path of a program that is named as in a shell: by a path with a slash, or by a name in `PATH`.
///
/// # Errors
/// Which program is missing or may not be executed, and what to do.
pub fn find_program(name: &str) -> Result<PathBuf, String> {
    find_in(name, &env::var_os("PATH").unwrap_or_default())
}

fn find_in(name: &str, path: &std::ffi::OsStr) -> Result<PathBuf, String> {
    let runs = |path: &Path| path.is_file() && access(path, Access::EXEC_OK).is_ok();
    if !name.contains('/') {
        let found = env::split_paths(path).map(|folder| folder.join(name)).find(|path| runs(path));
        return found.ok_or_else(|| {
            let here = if Path::new(name).is_file() {
                format!("; for the file here write ./{name}")
            } else {
                String::new()
            };
            format!("no program {name} in PATH{here}")
        });
    }
    match Path::new(name) {
        path if runs(path) => Ok(path.to_owned()),
        path if path.is_file() => Err(format!("{name} may not be executed: chmod +x {name}")),
        _ => Err(format!("no file {name}; a relative path starts at the working folder of the bench")),
    }
}

#[cfg(test)]
mod tests {
    use std::fs::{self, Permissions};
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    #[test]
    fn a_program_is_found_by_path_or_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("drive");
        fs::write(&file, "").unwrap();
        let name = file.display().to_string();
        fs::set_permissions(&file, Permissions::from_mode(0o600)).unwrap();
        assert_eq!(find_in(&name, "".as_ref()), Err(format!("{name} may not be executed: chmod +x {name}")));
        assert!(find_in("drive", folder.path().as_ref()).is_err(), "not executable");
        fs::set_permissions(&file, Permissions::from_mode(0o700)).unwrap();
        assert_eq!(find_in(&name, "".as_ref()).as_ref(), Ok(&file));
        assert_eq!(find_in("drive", folder.path().as_ref()).as_ref(), Ok(&file));
        assert!(find_in("./drive", folder.path().as_ref()).is_err(), "a slash means a path");
    }
}
