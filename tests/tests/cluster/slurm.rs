//! A Slurm cluster of this machine: controller, one node that runs and one that can be started, with all their files in a
//! folder of their own. The programs come from `cargo xtask setup`.

use std::fs::{self, File};
use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use rustix::process::Signal;
use tempfile::TempDir;
use tests::{processes, wait, workspace};

/// The node that runs from the start. Its cores are more than the machine's: jobs of the tests mostly wait.
const NODE: &str = "node";
/// The node that is down until [`Slurm::start_rig_node`].
pub(crate) const RIG_NODE: &str = "rignode";
/// The feature of [`RIG_NODE`], and the one licence of the cluster.
pub(crate) const RIG: &str = "rig";
/// Time for a daemon to start or end.
const LIMIT: Duration = Duration::from_secs(20);
/// Time between two commands of Slurm, which take some 10 ms of processor time each.
const INTERVAL: Duration = Duration::from_millis(100);

/// [`wait::look`] for conditions that start a command of Slurm.
pub(crate) fn look<T>(limit: Duration, mut condition: impl FnMut() -> Option<T>) -> Option<T> {
    wait::look(limit, || {
        let value = condition();
        if value.is_none() {
            thread::sleep(INTERVAL);
        }
        value
    })
}

/// Names missing equipment with the command that installs it.
pub(crate) fn missing() -> Option<String> {
    let folder = workspace().join("target/slurm");
    (!folder.join("installed").is_file())
        .then(|| format!("no Slurm in {}: run `cargo xtask setup`", folder.display()))
}

/// A running cluster. Dropping it ends its jobs and daemons.
pub(crate) struct Slurm {
    folder: TempDir,
    root: PathBuf,
    libraries: PathBuf,
    daemons: Mutex<Vec<Child>>,
}

/// A line of the queue.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Queued {
    pub(crate) job: u32,
    /// `N/A` if the job isn't an array.
    pub(crate) index: String,
    pub(crate) state: String,
    /// Why it waits.
    pub(crate) reason: String,
}

impl Slurm {
    /// Starts the daemons, and returns once the node accepts jobs. The daemons end with the thread that calls this.
    ///
    /// # Errors
    /// A daemon does not start; the error has the end of its log.
    pub(crate) fn start() -> Result<Self> {
        let root = workspace().join("target/slurm/root");
        const MISSING: &str = "Slurm's libraries are not in target/slurm: `cargo xtask setup` unpacks them";
        let entries = fs::read_dir(root.join("usr/lib")).context(MISSING)?;
        let libraries = entries
            .filter_map(|entry| Some(entry.ok()?.path()))
            .find(|path| path.join("slurm-wlm").is_dir())
            .context(MISSING)?;
        let folder = tempfile::Builder::new().prefix("slurm-").tempdir()?;
        let slurm = Self { folder, root, libraries, daemons: Mutex::default() };
        slurm.write_configuration()?;
        slurm.spawn("munged", &["--foreground", "--force", "--num-threads=2"], |munged| {
            for (option, name) in [
                ("key-file", "munge.key"),
                ("socket", "munge.socket"),
                ("pid-file", "munged.pid"),
                ("log-file", "munged.log"),
                ("seed-file", "munge.seed"),
            ] {
                munged.arg(format!("--{option}={}", slurm.path(name).display()));
            }
        })?;
        slurm.await_daemon("munged", || slurm.path("munge.socket").exists())?;
        slurm.spawn("slurmctld-wlm", &["-D", "-c"], |_| {})?;
        slurm.start_node(NODE)?;
        slurm.await_daemon("slurmctld-wlm", || slurm.state_of(NODE) == "idle")?;
        Ok(slurm)
    }

    /// Starts the second node, which has the feature [`RIG`].
    ///
    /// # Errors
    /// The daemon does not start.
    pub(crate) fn start_rig_node(&self) -> Result<()> {
        self.start_node(RIG_NODE)?;
        self.await_daemon(RIG_NODE, || {
            // A node that the configuration declares down stays so until it is resumed.
            let _ = self.output("scontrol", &["update", &format!("NodeName={RIG_NODE}"), "State=RESUME"]);
            ["idle", "mixed", "allocated"].contains(&self.state_of(RIG_NODE).as_str())
        })
    }

    /// A command of Slurm or of this workspace that finds the cluster.
    pub(crate) fn command(&self, program: impl AsRef<Path>) -> Command {
        let mut command = Command::new(program.as_ref());
        let path = std::env::var("PATH").unwrap_or_default();
        command
            .env("PATH", format!("{}:{path}", self.programs().display()))
            .env("SLURM_CONF", self.path("slurm.conf"))
            .env("LD_LIBRARY_PATH", format!("{0}:{0}/slurm-wlm", self.libraries.display()))
            .stdin(Stdio::null());
        command
    }

    /// Folder of Slurm's commands, and of GNU parallel.
    pub(crate) fn programs(&self) -> PathBuf {
        self.root.join("usr/bin")
    }

    /// Standard output of a command of Slurm that succeeds.
    pub(crate) fn output(&self, program: &str, arguments: &[&str]) -> Result<String> {
        // `PATH` of this process decides where a bare name is found.
        let mut command = self.command(self.programs().join(program));
        let output = command.args(arguments).output().with_context(|| program.to_owned())?;
        let problem = String::from_utf8_lossy(&output.stderr);
        ensure!(output.status.success(), "{program} {}: {problem}", arguments.join(" "));
        Ok(String::from_utf8(output.stdout)?)
    }

    /// Jobs that wait or run, tasks of arrays one by one.
    pub(crate) fn queue(&self) -> Vec<Queued> {
        let text = self.output("squeue", &["--noheader", "--array", "--format=%F|%K|%T|%r"]).expect("squeue");
        let job = |line: &str| {
            let mut fields = line.split('|').map(str::to_owned);
            let mut next = || fields.next().expect("four fields");
            Queued { job: next().parse().expect("a number"), index: next(), state: next(), reason: next() }
        };
        text.lines().map(job).collect()
    }

    /// As [`look`], with a panic that names `what` and shows the queue.
    pub(crate) fn until<T>(&self, what: &str, condition: impl FnMut() -> Option<T>) -> T {
        look(wait::SOON, condition).unwrap_or_else(|| panic!("{what}: {:?}", self.queue()))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn state_of(&self, node: &str) -> String {
        let state = self.output("sinfo", &["--noheader", "--nodes", node, "--format=%T"]);
        state.unwrap_or_default().trim().to_owned()
    }

    fn write_configuration(&self) -> Result<()> {
        // A listener of its own for each, all at once, so that the ports differ.
        let listeners = [(); 3].map(|()| TcpListener::bind((Ipv4Addr::LOCALHOST, 0)));
        let mut ports = Vec::new();
        for listener in listeners {
            ports.push(listener?.local_addr()?.port());
        }
        let host = rustix::system::uname().nodename().to_string_lossy().into_owned();
        let host = host.split('.').next().unwrap_or_default();
        let user = String::from_utf8(Command::new("id").arg("-un").output()?.stdout)?;
        let (user, folder) = (user.trim(), self.folder.path().display());
        let text = format!(
            "ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ctld}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
PluginDir={libraries}/slurm-wlm
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_min_interval=0,batch_sched_delay=0,bf_interval=1
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
JobCompType=jobcomp/none
SlurmdParameters=config_overrides
MailProg=/bin/true
Licenses={RIG}:1
NodeName={NODE} NodeAddr=127.0.0.1 Port={node} CPUs=4 State=UNKNOWN
NodeName={RIG_NODE} NodeAddr=127.0.0.1 Port={rig_node} CPUs=1 Features={RIG} State=DOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
",
            libraries = self.libraries.display(),
            ctld = ports[0],
            node = ports[1],
            rig_node = ports[2],
        );
        fs::create_dir(self.path("state"))?;
        fs::write(self.path("slurm.conf"), text)?;
        let key = self.path("munge.key");
        fs::write(&key, "The key of a cluster that lives for a test, and has no secrets.")?;
        fs::set_permissions(key, std::os::unix::fs::PermissionsExt::from_mode(0o400))?;
        Ok(())
    }

    fn start_node(&self, name: &str) -> Result<()> {
        let stepd = self.root.join("usr/sbin/slurmstepd-wlm");
        self.spawn("slurmd-wlm", &["-D", "-N", name, "-d"], |slurmd| {
            slurmd.arg(stepd);
        })
    }

    /// Starts a daemon that the kernel kills if this process is killed.
    fn spawn(&self, name: &str, arguments: &[&str], add: impl FnOnce(&mut Command)) -> Result<()> {
        let mut daemon = self.command("setpriv");
        daemon.args(["--pdeathsig", "KILL"]).arg(self.root.join("usr/sbin").join(name)).args(arguments);
        add(&mut daemon);
        let log = File::options().create(true).append(true).open(self.path(name))?;
        daemon.stdout(log.try_clone()?).stderr(log);
        let child = daemon.spawn().with_context(|| format!("{name} does not start"))?;
        self.daemons.lock().expect("no panic with the lock").push(child);
        Ok(())
    }

    fn await_daemon(&self, name: &str, mut is_ready: impl FnMut() -> bool) -> Result<()> {
        let ready = look(LIMIT, || is_ready().then_some(()));
        let log = || fs::read_to_string(self.path(name)).unwrap_or_default();
        ready.with_context(|| format!("{name} is not ready within {} s\n{}", LIMIT.as_secs(), log()))
    }
}

impl Drop for Slurm {
    fn drop(&mut self) {
        // A job outlives the daemon of its node.
        let _ = self.output("scancel", &["--me"]);
        let _ = look(LIMIT, || self.queue().is_empty().then_some(()));
        let daemons = self.daemons.get_mut().expect("no panic with the lock");
        for daemon in daemons.iter() {
            processes::signal(daemon.id(), Signal::TERM);
        }
        for daemon in daemons {
            if wait::look(LIMIT, || daemon.try_wait().ok().flatten()).is_none() {
                let _ = daemon.kill();
            }
            let _ = daemon.wait();
        }
    }
}
