//! `exec:CMD ARGS`: a program of the user as the drive, on its standard input and output or on a pseudo-terminal.

use std::ffi::OsString;
use std::io;
use std::path::PathBuf;

use lashloop_link::child_line::ChildLine;
use lashloop_link::terminal::Terminal;

use crate::device::drive_host::DriveHost;
use crate::device::error::{COMMAND, DeviceError};
use crate::device::evidence::DriveFiles;
use crate::device::kind::{DeviceKind, Opened, Syntax, after};
use crate::supervisor::{Program, Supervisor, find_program};

const PREFIX: &str = "exec:";
/// Stands for the path of a pseudo-terminal.
const TTY: &str = "{tty}";

pub(in crate::device) const SYNTAX: Syntax =
    Syntax { form: "exec:CMD ARGS", parse: |text| after(PREFIX, text, parse) };

fn parse(text: &str) -> Result<CommandDrive, String> {
    let words = shlex::split(text).ok_or_else(|| format!("a quote in {text:?} is not closed"))?;
    match words.split_first() {
        Some((program, arguments)) => Ok(CommandDrive {
            text: text.to_owned(),
            program: program.clone(),
            arguments: arguments.to_vec(),
        }),
        None => Err("needs a command after the colon".to_owned()),
    }
}

/// A program of the user, started by the bench. It inherits the environment and the working folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CommandDrive {
    /// The command as the user has written it.
    text: String,
    /// Path of the program, or its name in `PATH`.
    program: String,
    /// Its arguments. `{tty}` in one of them stands for the path of a pseudo-terminal; without it the drive serves its
    /// standard input and output.
    arguments: Vec<String>,
}

impl CommandDrive {
    fn wants_terminal(&self) -> bool {
        self.arguments.iter().any(|argument| argument.contains(TTY))
    }

    fn run(&self, program: PathBuf, supervisor: &Supervisor) -> io::Result<Opened> {
        let with = |arguments| Program { name: COMMAND, program: program.into(), arguments, core: None };
        let arguments = self.arguments.iter();
        let (link, process) = if self.wants_terminal() {
            let terminal = Terminal::open()?;
            let path = terminal.path.display().to_string();
            let program = with(arguments.map(|argument| argument.replace(TTY, &path).into()).collect());
            (ChildLine::terminal(terminal)?, supervisor.spawn_logged(&program)?)
        } else {
            let program = with(arguments.map(OsString::from).collect());
            let (process, to_drive, from_drive) = supervisor.spawn_piped(&program)?;
            (ChildLine::pipes(to_drive, from_drive)?, process)
        };
        Ok(Opened { link: Box::new(link), host: DriveHost::Process(process) })
    }
}

impl DeviceKind for CommandDrive {
    fn name(&self) -> String {
        format!("{PREFIX}{}", self.text)
    }

    fn open(&self, _baud: u32, supervisor: &Supervisor) -> Result<Opened, DeviceError> {
        let program =
            find_program(&self.program).map_err(|problem| DeviceError::unreachable(self.name(), problem))?;
        self.run(program, supervisor).map_err(|source| DeviceError::Spawn { name: COMMAND, source })
    }

    /// The program, and each argument that is a file: the script of an interpreter is the drive.
    fn files(&self, _supervisor: &Supervisor) -> DriveFiles {
        let arguments = self.arguments.iter().map(PathBuf::from).filter(|path| path.is_file());
        DriveFiles {
            paths: find_program(&self.program).into_iter().chain(arguments).collect(),
            rebuilt_by: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_split_as_a_shell_does_without_a_shell() {
        let drive = parse("./drive --name 'my drive' \"a b\"c $HOME *").unwrap();
        assert_eq!(drive.program, "./drive");
        assert_eq!(drive.arguments, ["--name", "my drive", "a bc", "$HOME", "*"]);
        assert!(!drive.wants_terminal());
        assert!(parse("socat {tty},raw EXEC:./drive").unwrap().wants_terminal());
        assert_eq!(drive.name(), "exec:./drive --name 'my drive' \"a b\"c $HOME *");
    }

    #[test]
    fn a_command_that_is_no_command_is_refused() {
        assert_eq!(parse("  "), Err("needs a command after the colon".to_owned()));
        assert_eq!(parse("a 'b"), Err("a quote in \"a 'b\" is not closed".to_owned()));
    }
}
