//! What shells get.

use std::fs;
use std::process::Command;

use tests::program;

#[test]
fn completions_and_man_pages_have_every_command() {
    let help = program::run(["--help"]).with_code(0).stdout;
    let (_, commands) = help.split_once("Run a drive on the bench:").expect("the first group");
    let (commands, _) = commands.split_once("Options:").expect("the options");
    let is_command = |line: &&str| line.starts_with("  ");
    let commands: Vec<_> =
        commands.lines().filter(is_command).filter_map(|line| line.split_whitespace().next()).collect();
    assert!(commands.len() > 20 && commands.contains(&"completions"), "{commands:?}");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = program::run(["completions", shell]).with_code(0).stdout;
        for command in &commands {
            assert!(script.contains(command), "{shell} lacks {command}");
        }
    }
    let bash = program::run(["completions", "bash"]).with_code(0).stdout;
    let loaded =
        Command::new("bash").args(["-c", &format!("{bash}\ncomplete -p lashloop")]).output().expect("bash");
    assert!(loaded.status.success(), "{}", String::from_utf8_lossy(&loaded.stderr));
    let folder = tempfile::tempdir().expect("a folder");
    let man = folder.path().display().to_string();
    let _ = program::run(["completions", "--man", &man]).with_code(0);
    for command in &commands {
        let page = fs::read_to_string(folder.path().join(format!("lashloop-{command}.1"))).expect("a page");
        assert!(page.contains(".SH SYNOPSIS"), "{command}");
    }
}
