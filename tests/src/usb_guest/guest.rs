//! A running guest.

use std::fs;
use std::io::BufReader;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use anyhow::{Context, Result, bail};

use super::channel::Channel;
use super::equipment::{EMULATOR, Equipment};
use super::request::{Answer, Line, PROGRAMS, Request, User};
use crate::{program, wait, workspace};

/// Time for the boot, ten times that on an idle machine.
const BOOT_LIMIT: Duration = Duration::from_secs(300);
/// Time without a sign of the guest after which it stands still. It gives one in each second of its clock.
const STILL: Duration = Duration::from_secs(60);
/// Time for a command, in seconds.
const COMMAND_LIMIT_S: u32 = 120;
/// The kernel's command line. A panic ends the emulator.
const KERNEL_ARGUMENTS: &str = "console=ttyS0 quiet panic=-1 mitigations=off nokaslr random.trust_cpu=on tsc=reliable \
                                clocksource=tsc no_timer_check net.ifnames=0";

/// A guest. Dropping it switches it off.
pub struct Guest {
    emulator: Child,
    channel: Channel<BufReader<UnixStream>, UnixStream>,
    /// Why it can't be used any longer.
    failed: Option<String>,
    folder: tempfile::TempDir,
    _equipment: Equipment,
}

/// A command that has ended.
#[derive(Debug)]
pub struct Ended {
    /// Exit code; `None` after a signal.
    pub code: Option<i32>,
    /// Standard output.
    pub stdout: String,
    /// Standard error, without the bar of the progress.
    pub stderr: String,
}

impl Ended {
    /// Checks the exit code.
    ///
    /// # Panics
    /// The exit code differs; the panic shows the output.
    #[must_use]
    pub fn with_code(self, code: i32) -> Self {
        let Self { stdout, stderr, .. } = &self;
        assert_eq!(self.code, Some(code), "exit code\n-- stdout --\n{stdout}-- stderr --\n{stderr}");
        self
    }
}

impl Guest {
    /// Boots a guest whose first process is the program `init`, and waits until its drivers and udev are up.
    ///
    /// # Errors
    /// It does not come up; with the end of its console.
    pub fn boot(init: &Path) -> Result<Self> {
        let equipment = Equipment::prepare(init, &[program::lashloop()])?;
        let folder = tempfile::tempdir()?;
        let console = folder.path().join("console");
        let channel = folder.path().join("agent");
        let programs = program::lashloop().parent().context("a program lies in a folder")?;
        let mut command = Command::new(EMULATOR);
        command
            .args(["-accel", "tcg", "-cpu", "qemu64", "-M", "q35", "-smp", "1", "-m", "512"])
            // Time passes with instructions, so that a busy machine doesn't make the guest slow by its own clock.
            .args(["-icount", "shift=0,sleep=on"])
            .args(["-nodefaults", "-no-user-config", "-no-reboot", "-display", "none", "-monitor", "none"])
            .arg("-serial")
            .arg(format!("file:{}", console.display()))
            .arg("-kernel")
            .arg(&equipment.kernel)
            .arg("-initrd")
            .arg(&equipment.files)
            .args(["-append", KERNEL_ARGUMENTS])
            .args(shared_folder("workspace", workspace()))
            .args(shared_folder("programs", programs))
            .args(["-device", "virtio-serial-pci", "-device", "virtserialport,chardev=agent,name=agent"])
            .arg("-chardev")
            .arg(format!("socket,id=agent,path={},server=on,wait=off", channel.display()))
            .args(["-device", "qemu-xhci,id=usb"])
            .args(["-device", "usb-serial,bus=usb.0,chardev=adapter,serial=QEMU0001"])
            .arg("-chardev")
            .arg(format!(
                "socket,id=adapter,path={},server=on,wait=off",
                adapter_path(folder.path()).display()
            ))
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(fs::File::create(folder.path().join("emulator"))?);
        let mut emulator = command.spawn().with_context(|| format!("{EMULATOR} can't be started"))?;
        let requests = wait::look(BOOT_LIMIT, || match UnixStream::connect(&channel) {
            Ok(socket) => Some(Ok(socket)),
            Err(error) => emulator.try_wait().ok().flatten().map(|status| Err((error, status))),
        });
        let connected = match requests {
            Some(Ok(socket)) => Ok(socket),
            Some(Err((_, status))) => Err(format!("{EMULATOR} ended with {status}")),
            None => Err(format!("{EMULATOR} opens no channel")),
        };
        let requests = match connected {
            Ok(socket) => socket,
            Err(problem) => {
                let _ = emulator.kill();
                let _ = emulator.wait();
                let text = fs::read_to_string(folder.path().join("emulator")).unwrap_or_default();
                bail!("{problem}\n{text}");
            }
        };
        requests.set_read_timeout(Some(BOOT_LIMIT))?;
        let channel = Channel::new(BufReader::new(requests.try_clone()?), requests.try_clone()?);
        let mut guest = Self { emulator, channel, failed: None, folder, _equipment: equipment };
        let up = guest.channel.await_up();
        up.with_context(|| format!("the guest did not come up\n{}", guest.console()))?;
        requests.set_read_timeout(Some(STILL))?;
        Ok(guest)
    }

    /// Why the guest no longer answers; `None` while it does.
    #[must_use]
    pub fn failed(&self) -> Option<&str> {
        self.failed.as_deref()
    }

    /// Seconds of the guest's clock since it came up.
    #[must_use]
    pub fn seconds(&self) -> u32 {
        self.channel.seconds
    }

    /// Where the far end of the emulator's adapter is.
    #[must_use]
    pub fn adapter(&self) -> PathBuf {
        adapter_path(self.folder.path())
    }

    /// What the guest's kernel and its first process have printed.
    #[must_use]
    pub fn console(&self) -> String {
        let text = fs::read(self.folder.path().join("console")).unwrap_or_default();
        String::from_utf8_lossy(&text).into_owned()
    }

    /// Runs `lashloop` in the guest's workspace, as root, to its end.
    ///
    /// # Panics
    /// The guest does not answer.
    pub fn lashloop(&mut self, arguments: &[&str]) -> Ended {
        self.lashloop_as(User::Root, arguments)
    }

    /// Runs `lashloop` in the guest's workspace to its end.
    ///
    /// # Panics
    /// The guest does not answer.
    pub fn lashloop_as(&mut self, user: User, arguments: &[&str]) -> Ended {
        let command = self.start_lashloop(user, arguments);
        self.wait(command)
    }

    /// Starts `lashloop` and returns the number of the command.
    ///
    /// # Panics
    /// The guest does not answer, or can't start it.
    pub fn start_lashloop(&mut self, user: User, arguments: &[&str]) -> u32 {
        let mut words = vec![format!("{PROGRAMS}/lashloop")];
        words.extend(arguments.iter().map(|word| (*word).to_owned()));
        self.start(words, user)
    }

    /// Runs a command as root to its end.
    ///
    /// # Panics
    /// The guest does not answer, or can't start it.
    pub fn run(&mut self, words: &[&str]) -> Ended {
        let command = self.start(words.iter().map(|word| (*word).to_owned()).collect(), User::Root);
        self.wait(command)
    }

    /// Starts a command of the guest's own program and returns its number. Killing a `plug` unplugs its device.
    ///
    /// # Panics
    /// The guest does not answer, or can't start it.
    pub fn start_own(&mut self, words: &[&str]) -> u32 {
        let words = [&["/init"], words].concat();
        self.start(words.into_iter().map(str::to_owned).collect(), User::Root)
    }

    fn start(&mut self, words: Vec<String>, user: User) -> u32 {
        match self.request(&Request::Start(Line { words, user })) {
            Answer::Started(number) => number,
            other => panic!("the command does not start: {other:?}"),
        }
    }

    /// Waits for the end of a command.
    ///
    /// # Panics
    /// The guest does not answer.
    pub fn wait(&mut self, command: u32) -> Ended {
        match self.request(&Request::Wait { command, limit_s: COMMAND_LIMIT_S }) {
            Answer::Ended { code, stdout, stderr } => Ended { code, stdout, stderr },
            other => panic!("command {command} does not end: {other:?}"),
        }
    }

    /// Kills a command.
    ///
    /// # Panics
    /// The guest does not answer.
    pub fn kill(&mut self, command: u32) {
        self.done(&Request::Kill { command });
    }

    /// The contents of a file of the guest, without white space at its end.
    ///
    /// # Panics
    /// The guest has no such file.
    pub fn read(&mut self, path: &str) -> String {
        match self.request(&Request::Read { path: path.to_owned() }) {
            Answer::Text(text) => text.trim_end().to_owned(),
            other => panic!("{path}: {other:?}\n{}", self.console()),
        }
    }

    /// Writes a file of the guest.
    ///
    /// # Panics
    /// The guest refuses.
    pub fn write(&mut self, path: &str, text: &str) {
        self.done(&Request::Write { path: path.to_owned(), text: text.to_owned() });
    }

    /// The contents of a file of the guest; `None` if it has no such file.
    ///
    /// # Panics
    /// The guest does not answer.
    pub fn read_if_present(&mut self, path: &str) -> Option<String> {
        match self.request(&Request::Read { path: path.to_owned() }) {
            Answer::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Removes a folder of the guest, if it exists.
    ///
    /// # Panics
    /// The guest refuses.
    pub fn remove_folder(&mut self, path: &str) {
        self.done(&Request::RemoveFolder { path: path.to_owned() });
    }

    /// Waits until a file exists in the guest.
    ///
    /// # Panics
    /// It does not appear.
    pub fn await_file(&mut self, path: &str) {
        self.done(&Request::Await { path: path.to_owned(), exists: true });
    }

    /// Waits until a file no longer exists in the guest.
    ///
    /// # Panics
    /// It stays.
    pub fn await_removal(&mut self, path: &str) {
        self.done(&Request::Await { path: path.to_owned(), exists: false });
    }

    /// Whether a file stops existing in the guest in time.
    ///
    /// # Panics
    /// The guest does not answer.
    pub fn vanishes(&mut self, path: &str) -> bool {
        self.request(&Request::Await { path: path.to_owned(), exists: false }) == Answer::Done
    }

    fn done(&mut self, request: &Request) {
        match self.request(request) {
            Answer::Done => {}
            other => panic!("{request:?}: {other:?}\n{}", self.console()),
        }
    }

    fn request(&mut self, request: &Request) -> Answer {
        if let Some(reason) = &self.failed {
            panic!("{request:?} to a guest that no longer answers: {reason}");
        }
        self.channel.request(request).unwrap_or_else(|error| {
            self.failed = Some(format!("{error:#}"));
            panic!("{request:?}: {error:#}\n{}", self.console())
        })
    }
}

impl Drop for Guest {
    fn drop(&mut self) {
        let is_off = self.failed.is_none() && self.channel.send(&Request::PowerOff).is_ok();
        let limit = Duration::from_secs(if is_off { 10 } else { 0 });
        let ended = wait::look(limit, || self.emulator.try_wait().ok().flatten());
        if ended.is_none() {
            let _ = self.emulator.kill();
            let _ = self.emulator.wait();
        }
    }
}

fn adapter_path(folder: &Path) -> PathBuf {
    folder.join("adapter")
}

/// A folder of this machine that the guest may read.
fn shared_folder(name: &str, path: &Path) -> [String; 4] {
    [
        "-fsdev".to_owned(),
        format!("local,id={name},path={},security_model=none,readonly=on", path.display()),
        "-device".to_owned(),
        format!("virtio-9p-pci,fsdev={name},mount_tag={name}"),
    ]
}
