//! The agent: does in the guest what a test requests.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use anyhow::{Context, Result, bail};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::process::{Pid, PidfdFlags, pidfd_open};
use tests::usb_guest::request::{Answer, Line, Numbered, PORTS, Request, UNASKED, User, WORKSPACE};
use tests::wait;

use crate::boot::{power_off, settle};

/// Owner and group of [`User::Member`], as `/etc/passwd` has them.
const MEMBER: (u32, u32) = (1000, 20);

/// Folder of the names that udev makes.
const UDEV_FILES: &str = "/dev/serial/";

/// A command, and what it prints.
struct Running {
    child: Child,
    output: [JoinHandle<String>; 2],
}

/// Serves requests until the test closes the channel or switches the guest off.
///
/// # Errors
/// The channel is missing or fails.
pub(crate) fn serve() -> Result<()> {
    let opened = wait::look(wait::SOON, || File::options().read(true).write(true).open(port()?).ok());
    let channel = opened.with_context(|| format!("no port in {PORTS}"))?;
    let mut requests = BufReader::new(channel.try_clone()?);
    let watched = channel.try_clone()?;
    thread::spawn(move || power_off_without_test(&watched));
    let mut commands = Commands::default();
    let channel = Arc::new(Mutex::new(channel));
    send(&channel, UNASKED, Answer::Up)?;
    let clock = Arc::clone(&channel);
    thread::spawn(move || {
        while send(&clock, UNASKED, Answer::Second).is_ok() {
            thread::sleep(Duration::from_secs(1));
        }
    });
    loop {
        let mut line = String::new();
        if requests.read_line(&mut line)? == 0 {
            return Ok(());
        }
        let Numbered { number, message } = serde_json::from_str(&line).with_context(|| line.clone())?;
        if message == Request::PowerOff {
            return Ok(());
        }
        let answer = commands.serve(message).unwrap_or_else(|error| Answer::Failed(format!("{error:#}")));
        send(&channel, number, answer)?;
    }
}

/// Ends the guest when a test ends without its request: a write to the channel would block forever.
fn power_off_without_test(channel: &File) {
    let mut channel = [PollFd::new(channel, PollFlags::empty())];
    // Without flags poll reports the end of the connection only.
    while poll(&mut channel, None).is_err() {}
    let _ = power_off();
}

/// The channel's port. Its name has the number of the virtio device, which differs with the other devices.
fn port() -> Option<PathBuf> {
    let entry = fs::read_dir(PORTS).ok()?.next()?.ok()?;
    Some(Path::new("/dev").join(entry.file_name()))
}

fn send(channel: &Mutex<File>, number: u32, message: Answer) -> Result<()> {
    let mut line = serde_json::to_vec(&Numbered { number, message })?;
    line.push(b'\n');
    Ok(channel.lock().unwrap_or_else(PoisonError::into_inner).write_all(&line)?)
}

#[derive(Default)]
struct Commands {
    running: BTreeMap<u32, Running>,
    started: u32,
}

impl Commands {
    fn serve(&mut self, request: Request) -> Result<Answer> {
        match request {
            Request::Start(line) => {
                let running = start(&line)?;
                self.started += 1;
                self.running.insert(self.started, running);
                Ok(Answer::Started(self.started))
            }
            Request::Wait { command, limit_s } => {
                let mut running = self.take(command)?;
                if !ends_within(&running.child, limit_s)? {
                    running.child.kill()?;
                }
                let status = running.child.wait()?;
                let [stdout, stderr] = running.output.map(|it| it.join().unwrap_or_default());
                Ok(Answer::Ended { code: status.code(), stdout, stderr })
            }
            Request::Kill { command } => {
                let mut running = self.take(command)?;
                running.child.kill()?;
                running.child.wait()?;
                Ok(Answer::Done)
            }
            Request::Read { path } => {
                Ok(Answer::Text(String::from_utf8_lossy(&fs::read(path)?).into_owned()))
            }
            Request::Write { path, text } => Ok(fs::write(path, text).map(|()| Answer::Done)?),
            Request::RemoveFolder { path } => match fs::remove_dir_all(path) {
                Err(error) if error.kind() != ErrorKind::NotFound => Err(error.into()),
                _ => Ok(Answer::Done),
            },
            Request::Await { path, exists } => {
                let reached = || (Path::new(&path).exists() == exists).then_some(());
                if wait::look(wait::SOON, reached).is_none() {
                    bail!("{path} {}", if exists { "does not appear" } else { "stays" });
                }
                // udev's own files are complete once it has served all events; the kernel's are at once.
                if path.starts_with(UDEV_FILES) {
                    settle()?;
                }
                Ok(Answer::Done)
            }
            Request::PowerOff => Ok(Answer::Done),
        }
    }

    fn take(&mut self, command: u32) -> Result<Running> {
        self.running.remove(&command).with_context(|| format!("no command {command} is running"))
    }
}

/// Waits for the end of a child, and returns whether it came. Polling would cost the emulator as much as a run.
fn ends_within(child: &Child, limit_s: u32) -> Result<bool> {
    let end = pidfd_open(Pid::from_child(child), PidfdFlags::empty())?;
    let limit = Timespec { tv_sec: limit_s.into(), tv_nsec: 0 };
    Ok(poll(&mut [PollFd::new(&end, PollFlags::IN)], Some(&limit))? > 0)
}

fn start(line: &Line) -> Result<Running> {
    let (program, arguments) = line.words.split_first().context("an empty command")?;
    let mut command = Command::new(program);
    command.args(arguments).current_dir(WORKSPACE).env("HOME", "/tmp").env("PATH", "/bin");
    if line.user == User::Member {
        let (user, group) = MEMBER;
        command.uid(user).gid(group);
    }
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    let output = [
        read_to_end(child.stdout.take().context("a pipe")?),
        read_to_end(child.stderr.take().context("a pipe")?),
    ];
    Ok(Running { child, output })
}

fn read_to_end(mut pipe: impl Read + Send + 'static) -> JoinHandle<String> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        let _ = pipe.read_to_end(&mut bytes);
        String::from_utf8_lossy(&bytes).into_owned()
    })
}
