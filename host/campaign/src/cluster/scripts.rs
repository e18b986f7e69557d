//! The two job scripts. They hold every option, so that `sbatch SCRIPT` by hand gives the same jobs.

use std::path::Path;

use crate::Selection;

use super::error::ClusterError;
use super::slurm::ranges;

/// What both scripts have in common.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scripts<'a> {
    /// This program.
    pub program: &'a Path,
    /// Name of the jobs in the queue.
    pub name: &'a str,
    pub campaign: &'a Path,
    /// Folder of the results.
    pub out: &'a Path,
    /// Folder of the logs.
    pub logs: &'a Path,
    /// Where relative paths of the device begin.
    pub working_folder: &'a Path,
    pub device: &'a str,
    /// Whether a task runs as many cases at once as it has cores.
    pub is_parallel: bool,
    pub selection: &'a Selection,
    pub shards: u32,
    /// Options of `sbatch`, one a line.
    pub options: &'a [String],
}

impl Scripts<'_> {
    /// The script of the tasks, by default those of `shards`.
    ///
    /// # Errors
    /// A path or option can't be written into a script.
    pub fn of_shards(&self, shards: &[u32]) -> Result<String, ClusterError> {
        let directives = self.directives("", "shard-%a.log")?;
        let Self { shards: count, .. } = self;
        let fixed = [
            path(self.program)?,
            "campaign",
            "run",
            path(self.campaign)?,
            "--out",
            path(self.out)?,
            "--device",
            self.device,
        ];
        let selection = self.selection.options();
        let command = words(fixed.into_iter().chain(selection.iter().map(String::as_str)))?;
        Ok(format!(
            "#!/bin/sh
# The shards of a campaign, one task each. Written by `lashloop campaign submit`.
# By hand: sbatch --array={array} {script}
#SBATCH --array={array}
# A task of a node that fails starts again, and continues after its last row.
#SBATCH --requeue
#SBATCH --open-mode=append
{directives}
# With exec, the signal at the end of the time limit reaches the program, which ends after a whole row.
exec {command} --shard \"$SLURM_ARRAY_TASK_ID/{count}\" --resume{jobs}
",
            jobs = if self.is_parallel { " --jobs \"${SLURM_CPUS_PER_TASK:-1}\"" } else { "" },
            array = ranges(shards),
            script = self.script(SHARDS)?,
        ))
    }

    /// The script that merges the shards.
    ///
    /// # Errors
    /// As [`of_shards`](Self::of_shards).
    pub fn of_merge(&self) -> Result<String, ClusterError> {
        let directives = self.directives("-merge", "merge.log")?;
        let command = words([path(self.program)?, "campaign", "merge", path(self.out)?])?;
        Ok(format!(
            "#!/bin/sh
# Merges the shards of a campaign. Written by `lashloop campaign submit`.
# By hand, after the last shard: sbatch {script}
#SBATCH --open-mode=truncate
{directives}
# Fails with the name of a shard that is missing or incomplete. Runs of the evidence need the drive, as the shards do.
exec {command}
",
            script = self.script(MERGE)?,
        ))
    }

    fn script(&self, name: &str) -> Result<String, ClusterError> {
        words([path(&self.logs.join(name))?])
    }

    fn directives(&self, suffix: &str, log: &str) -> Result<String, ClusterError> {
        let folder = path(self.logs)?.replace('%', "%%");
        let fixed = [
            format!("--job-name={}{suffix}", self.name),
            format!("--chdir={}", path(self.working_folder)?),
            format!("--output={folder}/{log}"),
        ];
        let lines = fixed.iter().chain(self.options).map(|option| match option.contains('\\') {
            // sbatch drops it, in single quotes too.
            true => Err(ClusterError::Unwritable { text: option.clone() }),
            false => Ok(format!("#SBATCH {}", words([option])?)),
        });
        Ok(lines.collect::<Result<Vec<_>, ClusterError>>()?.join("\n"))
    }
}

/// Names of the scripts in the folder of the logs.
pub const SHARDS: &str = "shards.sh";
pub const MERGE: &str = "merge.sh";

/// Words quoted for the shell, and for `sbatch`, which has the shell's quotes but for backslashes, and reads line by line.
fn words<'a>(words: impl IntoIterator<Item = impl AsRef<str> + 'a>) -> Result<String, ClusterError> {
    let quoted = words.into_iter().map(|word| {
        let word = word.as_ref();
        let unwritable = || ClusterError::Unwritable { text: word.to_owned() };
        if word.contains(char::is_control) {
            return Err(unwritable());
        }
        shlex::try_quote(word).map(Into::into).map_err(|_| unwritable())
    });
    Ok(quoted.collect::<Result<Vec<String>, _>>()?.join(" "))
}

fn path(path: &Path) -> Result<&str, ClusterError> {
    path.to_str().ok_or_else(|| ClusterError::Unwritable { text: path.display().to_string() })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::Selection;

    use super::Scripts;
    use crate::cluster::error::ClusterError;

    #[test]
    fn paths_with_blanks_and_percent_signs_reach_shell_and_sbatch_as_one_word() {
        let selection =
            Selection { seed: Some(3), set: vec!["run.note=a b".to_owned()], ..Selection::default() };
        let mut scripts = Scripts {
            program: Path::new("/opt/my tools/lashloop"),
            name: "small",
            campaign: Path::new("/home/small.toml"),
            out: Path::new("/data/50% load"),
            logs: Path::new("/data/50% load/slurm"),
            working_folder: Path::new("/home"),
            device: "inproc",
            is_parallel: true,
            selection: &selection,
            shards: 7,
            options: &["--constraint=rig&fast".to_owned()],
        };
        let text = scripts.of_shards(&[2, 5, 6, 7]).expect("a script");
        let lines: Vec<_> = text.lines().collect();
        assert!(lines.contains(&"#SBATCH --array=2,5-7"), "{text}");
        assert!(lines.contains(&"#SBATCH '--output=/data/50%% load/slurm/shard-%a.log'"), "{text}");
        assert!(lines.contains(&"#SBATCH '--constraint=rig&fast'"), "{text}");
        let command = shlex::split(lines.last().expect("a line")).expect("words of a shell");
        let (program, arguments) = command.split_at(2);
        assert_eq!(program, ["exec", "/opt/my tools/lashloop"]);
        assert_eq!(
            arguments,
            [
                "campaign",
                "run",
                "/home/small.toml",
                "--out",
                "/data/50% load",
                "--device",
                "inproc",
                "--seed=3",
                "--set=run.note=a b",
                "--shard",
                "$SLURM_ARRAY_TASK_ID/7",
                "--resume",
                "--jobs",
                "${SLURM_CPUS_PER_TASK:-1}",
            ]
        );
        scripts.is_parallel = false;
        let one_session = scripts.of_shards(&[1]).expect("a script");
        assert!(one_session.ends_with("--shard \"$SLURM_ARRAY_TASK_ID/7\" --resume\n"), "{one_session}");
        scripts.logs = Path::new("/data/a\\b/slurm");
        assert!(matches!(scripts.of_shards(&[1]), Err(ClusterError::Unwritable { .. })));
        scripts.logs = Path::new("/data/slurm");
        scripts.out = Path::new("/data/two\nlines");
        assert!(matches!(scripts.of_merge(), Err(ClusterError::Unwritable { .. })));
    }
}
