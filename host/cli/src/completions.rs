//! `lashloop completions`: completions of a shell, and man pages.

use std::io;
use std::path::PathBuf;

use clap::{Args, Command};
use clap_complete::Shell;
use lashloop_bench::verdict::Exit;

use super::command_line;
use super::error::{CliError, system};
use super::options::DEVICE;
use super::output::{outln, prepare_folder, program_name, write_file};
use lashloop::Bench;

/// Print the completions of a shell, or write man pages
///
/// For bash: `lashloop completions bash > ~/.local/share/bash-completion/completions/lashloop`.
#[derive(Args)]
#[group(required = true, multiple = false)]
pub(crate) struct Arguments {
    /// Shell whose completions are printed
    shell: Option<Shell>,

    /// Folder for the man pages, one for each command
    #[arg(long, value_name = "DIR")]
    man: Option<PathBuf>,
}

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        let name = program_name();
        let mut command = command_line(&name);
        if let Some(shell) = self.shell {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut offered(&command, shell), &name, &mut script);
            outln!("{}", String::from_utf8_lossy(&script).trim_end());
        }
        if let Some(folder) = self.man {
            prepare_folder(&folder, &[])?;
            command.build();
            for (name, page) in pages(&command, &name).map_err(system("write a man page"))? {
                write_file(&folder.join(format!("{name}.1")), &page)?;
            }
        }
        Ok(Exit::Pass)
    }
}

/// Beginnings of the names of devices. Beside them bash completes the path of a terminal; other shells would offer nothing else.
const DEVICES: [&str; 7] = ["native", "inproc", "qemu", "silicon", "exec:", "tcp:", "rfc2217:"];

/// What a shell offers: commands that are not hidden, and the kinds of devices.
fn offered(command: &Command, shell: Shell) -> Command {
    let arguments = command.get_arguments().map(|argument| {
        let argument = argument.clone();
        if argument.get_id() == DEVICE && shell == Shell::Bash {
            argument.value_parser(DEVICES)
        } else {
            argument
        }
    });
    let inside = command.get_subcommands().filter(|it| !it.is_hide_set()).map(|it| offered(it, shell));
    let offered = Command::new(command.get_name().to_owned()).args(arguments).subcommands(inside);
    match command.get_about() {
        Some(about) => offered.about(about.clone()),
        None => offered,
    }
}

/// Name and text of the page of a command and of each command in it.
fn pages(command: &Command, name: &str) -> io::Result<Vec<(String, String)>> {
    let mut page = Vec::new();
    clap_mangen::Man::new(command.clone()).title(name.to_owned()).render(&mut page)?;
    let mut pages = vec![(name.to_owned(), String::from_utf8_lossy(&page).into_owned())];
    for inside in command.get_subcommands().filter(|it| !it.is_hide_set() && it.get_name() != "help") {
        pages.extend(self::pages(inside, &format!("{name}-{}", inside.get_name()))?);
    }
    Ok(pages)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_offers_commands_that_are_not_hidden_and_the_kinds_of_devices() {
        let script = |shell| {
            let mut script = Vec::new();
            let mut command = offered(&command_line("lashloop"), shell);
            clap_complete::generate(shell, &mut command, "lashloop", &mut script);
            String::from_utf8(script).expect("a text")
        };
        let bash = script(Shell::Bash);
        assert!(!bash.contains("tied") && !bash.contains("ping-pong"));
        assert!(bash.contains("rerun") && bash.contains("--tolerance") && bash.contains("rfc2217:"));
        // Without values of their own they complete paths.
        for shell in [Shell::Zsh, Shell::Fish] {
            assert!(script(shell).contains("rerun") && !script(shell).contains("(native inproc"));
        }
    }
}
