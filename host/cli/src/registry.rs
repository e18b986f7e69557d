//! The list of commands: dispatch, and groups in the help.

/// Defines `Command` with its `run`, and `GROUPS` with the heading and the commands of each group. A command has the name
/// of its module.
macro_rules! commands {
    ($( $heading:literal: $( $variant:ident($module:ident) ),+; )+) => {
        #[derive(Subcommand)]
        enum Command {
            $($(
                #[command(name = stringify!($module))]
                $variant($module::Arguments),
            )+)+
            #[command(hide = true)]
            Tied(run_child::Arguments),
            #[command(hide = true)]
            PingPong,
        }

        impl Command {
            fn run(self, bench: &Bench) -> Result<Exit, error::CliError> {
                match self {
                    $($( Self::$variant(arguments) => arguments.run(bench), )+)+
                    Self::Tied(arguments) => arguments.run(),
                    Self::PingPong => ping_pong::answer(),
                }
            }
        }

        const GROUPS: &[registry::Group] = &[$( ($heading, &[$( stringify!($module) ),+]) ),+];
    };
}

pub(super) use commands;

/// Heading and names of commands.
pub(super) type Group = (&'static str, &'static [&'static str]);

/// Lists the commands under the headings of their groups. clap knows headings for options only.
pub(super) fn with_groups(command: clap::Command, groups: &[Group]) -> clap::Command {
    let about = |name: &str| command.find_subcommand(name)?.get_about().map(ToString::to_string);
    let mut list = String::new();
    for (heading, names) in groups {
        list += &format!("{heading}:\n");
        for name in *names {
            list += &format!("  {name:<12} {}\n", about(name).unwrap_or_default());
        }
        list.push('\n');
    }
    command.help_template(format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{list}Options:\n{{options}}{{after-help}}"
    ))
}
