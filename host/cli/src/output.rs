//! Standard output, standard error and output files.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::{env, fs, process};

use lashloop_bench::atomic_file::{WriteError, write_whole_at};
use lashloop_bench::verdict::Exit;
use lashloop_record::export::csv_in_folder;
use lashloop_record::folder::RecordFolder;
use lashloop_session::{is_control, without_controls};
use serde::Serialize;

use super::error::{CliError, system};

/// Prints a formatted line on standard output.
macro_rules! outln {
    ($($text:tt)*) => {
        $crate::output::line(format_args!($($text)*))
    };
}

pub(super) use outln;

/// Prints a line on standard output. A closed pipe (`| head`) does not fail a run. Any other write error ends the program
/// (`> /dev/full`), because the user relies on the output.
pub(super) fn line(text: Arguments<'_>) {
    write_line("", &text.to_string());
}

/// Prints a line that begins with a text of this program, which may be coloured.
pub(super) fn styled_line(styled: &str, text: Arguments<'_>) {
    write_line(styled, &text.to_string());
}

/// What files, drives and programs of others have in their texts reaches no terminal as a command.
fn write_line(styled: &str, text: &str) {
    if let Err(error) = writeln!(io::stdout(), "{styled}{}", without_controls(text))
        && error.kind() != ErrorKind::BrokenPipe
    {
        complain(format_args!("standard output can't be written: {error}"));
        process::exit(Exit::UsageOrScenario as i32);
    }
}

/// Prints a line on standard error. Its own write errors have no place to go and are ignored.
pub(super) fn error_line(text: Arguments<'_>) {
    let _ = writeln!(io::stderr(), "{}", without_controls(&text.to_string()));
}

/// The name by which this program was called: a program with laws of its own prints its own.
pub(super) fn program_name() -> String {
    let called = env::args_os().next();
    let name = called.as_deref().and_then(|path| Path::new(path).file_name());
    name.map_or_else(|| "lashloop".to_owned(), |name| name.to_string_lossy().into_owned())
}

/// Prints an error on standard error, after the name of this program.
pub(super) fn complain(text: Arguments<'_>) {
    error_line(format_args!("{}: {text}", program_name()));
}

/// Prints a warning on standard error, after the name of this program.
pub(super) fn warn(text: Arguments<'_>) {
    complain(format_args!("warning: {text}"));
}

/// Prints a value as JSON on standard output.
pub(super) fn print_json(value: &impl Serialize) -> Result<(), CliError> {
    print_json_text(&serde_json::to_string_pretty(value).map_err(system("print JSON"))?);
    Ok(())
}

/// Prints JSON. Its strings escape the controls that JSON allows in them; a reader gets the same strings.
pub(super) fn print_json_text(json: &str) {
    let mut shown = String::with_capacity(json.len());
    for character in json.chars() {
        if is_control(character) {
            let mut units = [0; 2];
            shown.extend(character.encode_utf16(&mut units).iter().map(|unit| format!("\\u{unit:04x}")));
        } else {
            shown.push(character);
        }
    }
    outln!("{shown}");
}

/// Writes the record in a folder as CSV too, if that is wanted. The run has its verdict with or without it.
pub(super) fn write_csv(folder: &Path, is_wanted: bool) {
    if is_wanted && let Err(error) = csv_in_folder(folder) {
        warn(format_args!("no CSV of the run: {error}"));
    }
}

/// Creates an output folder. Removes these files of an earlier command first: next to the files of an interrupted one they
/// would be wrong.
pub(super) fn prepare_folder(folder: &Path, stale: &[&str]) -> Result<(), CliError> {
    let failed = |source| CliError::Output { path: folder.to_owned(), source };
    fs::create_dir_all(folder).map_err(failed)?;
    for name in stale {
        match fs::remove_file(folder.join(name)) {
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(failed(error)),
            _ => {}
        }
    }
    Ok(())
}

pub(super) fn write_file(path: &Path, text: &str) -> Result<(), CliError> {
    write_bytes(path, text.as_bytes())
}

/// Writes a file whose place the user has not named. In a folder from others its name may be a link to another place, or a
/// pipe: the new file replaces it, and nothing is written through it.
pub(super) fn write_in_folder(folder: &Path, name: &str, bytes: &[u8]) -> Result<PathBuf, CliError> {
    let path = folder.join(name);
    RecordFolder::remove_detour(&path)?;
    write_bytes(&path, bytes)?;
    Ok(path)
}

/// Writes a file, whole or not at all, instead of an older one that is not part of a record.
pub(super) fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    RecordFolder::check_output(path)?;
    let written = write_whole_at(path, ".output-", |path| {
        let failed = |source| WriteError { path: path.to_owned(), action: "written", source };
        fs::write(path, bytes).map_err(failed)
    });
    written.map_err(|WriteError { path, source, .. }| CliError::Output { path, source })
}
