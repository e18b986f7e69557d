//! Shard K of N owns the cases i with i mod N = K - 1.

use std::fmt;
use std::str::FromStr;

/// Shards of a campaign at most.
pub const MAX_SHARDS: u32 = 100_000;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shard {
    /// From 1.
    pub number: u32,
    pub count: u32,
}

impl Shard {
    pub const WHOLE: Self = Self { number: 1, count: 1 };

    /// A shard, if its number is one of `count`.
    #[must_use]
    pub fn new(number: u32, count: u32) -> Option<Self> {
        ((1..=count).contains(&number) && count <= MAX_SHARDS).then_some(Self { number, count })
    }

    /// Number of its cases among `cases`.
    #[must_use]
    pub fn len(self, cases: u64) -> u64 {
        (cases + u64::from(self.count) - u64::from(self.number)) / u64::from(self.count)
    }

    /// Its case of a row, from 0.
    #[must_use]
    pub fn case(self, row: u64) -> u64 {
        row * u64::from(self.count) + u64::from(self.number - 1)
    }

    /// Name of its file without the ending.
    #[must_use]
    pub fn stem(self) -> String {
        format!("shard-{}-of-{}", self.number, self.count)
    }

    /// The shard of a file name, whichever ending it has.
    #[must_use]
    pub fn of_file_name(name: &str) -> Option<Self> {
        let (stem, _) = name.strip_prefix("shard-")?.split_once('.')?;
        let (number, count) = stem.split_once("-of-")?;
        Self::new(number.parse().ok()?, count.parse().ok()?)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}/{}", self.number, self.count)
    }
}

/// The options and the environment give no shard, and why.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct AutoShardError(String);

/// The choice of `--shard`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShardChoice {
    Fixed(Shard),
    /// From the environment of a scheduler.
    Auto,
}

impl FromStr for ShardChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        let shard = text
            .split_once('/')
            .and_then(|(number, count)| Shard::new(number.parse().ok()?, count.parse().ok()?));
        shard
            .map(Self::Fixed)
            .ok_or_else(|| format!("expected K/N with 1 <= K <= N <= {MAX_SHARDS}, such as 2/7, or auto"))
    }
}

impl ShardChoice {
    /// The shard. `environment` looks up a variable; `count` is the number of shards for schedulers that don't set it.
    ///
    /// # Errors
    /// Not exactly one scheduler's variables are set, or they aren't a shard.
    pub fn resolve(
        self,
        environment: impl Fn(&str) -> Option<String>,
        count: Option<u32>,
    ) -> Result<Shard, AutoShardError> {
        match self {
            Self::Fixed(shard) => match count {
                Some(count) if count != shard.count => Err(AutoShardError(format!(
                    "--shard {shard} is of {} shards, --shards {count}; make them the same",
                    shard.count
                ))),
                _ => Ok(shard),
            },
            Self::Auto => {
                auto(environment, count).map_err(|reason| AutoShardError(format!("--shard auto: {reason}")))
            }
        }
    }
}

const SOURCES: &str = "SLURM_ARRAY_TASK_ID (with _MIN, _COUNT and _STEP), CI_NODE_INDEX (with CI_NODE_TOTAL) or \
                       JOB_COMPLETION_INDEX (with --shards N)";

fn auto(environment: impl Fn(&str) -> Option<String>, count: Option<u32>) -> Result<Shard, String> {
    let number = |name: &str| -> Result<u32, String> {
        let text = environment(name).ok_or_else(|| format!("{name} is not set"))?;
        text.trim().parse().map_err(|_| format!("{name} is {text:?}, which isn't a whole number"))
    };
    let names = ["SLURM_ARRAY_TASK_ID", "CI_NODE_INDEX", "JOB_COMPLETION_INDEX"];
    let present: Vec<_> = names.into_iter().filter(|name| environment(name).is_some()).collect();
    let (shard, total) = match present[..] {
        ["SLURM_ARRAY_TASK_ID"] => {
            let step = if environment("SLURM_ARRAY_TASK_STEP").is_some() {
                number("SLURM_ARRAY_TASK_STEP")?.max(1)
            } else {
                1
            };
            let first = number("SLURM_ARRAY_TASK_MIN")?;
            let offset = number("SLURM_ARRAY_TASK_ID")?.checked_sub(first);
            let offset = offset.ok_or("SLURM_ARRAY_TASK_ID is less than SLURM_ARRAY_TASK_MIN")?;
            (offset / step + 1, number("SLURM_ARRAY_TASK_COUNT")?)
        }
        ["CI_NODE_INDEX"] => (number("CI_NODE_INDEX")?, number("CI_NODE_TOTAL")?),
        ["JOB_COMPLETION_INDEX"] => {
            let count = count
                .ok_or("JOB_COMPLETION_INDEX has no count; add --shards N, the completions of the job")?;
            (number("JOB_COMPLETION_INDEX")?.saturating_add(1), count)
        }
        [] => return Err(format!("no scheduler is there; set {SOURCES}, or write --shard K/N")),
        _ => return Err(format!("{} are set; exactly one may be: {SOURCES}", present.join(" and "))),
    };
    if let Some(count) = count.filter(|count| *count != total) {
        return Err(format!("{} has {total} shards, --shards {count}; make them the same", present[0]));
    }
    Shard::new(shard, total)
        .ok_or_else(|| format!("{} gives {shard}/{total}, which isn't a shard", present[0]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_own_each_case_once() {
        for (cases, count) in [(20, 1), (20, 7), (3, 5), (0, 2)] {
            let mut owned: Vec<_> = (1..=count)
                .filter_map(|number| Shard::new(number, count))
                .flat_map(|shard| (0..shard.len(cases)).map(move |row| shard.case(row)))
                .collect();
            owned.sort_unstable();
            assert_eq!(owned, (0..cases).collect::<Vec<_>>(), "{count} shards");
        }
    }

    #[test]
    fn shard_comes_from_exactly_one_scheduler() {
        let auto = |set: &[(&str, &str)], count| {
            let get =
                |name: &str| set.iter().find(|(key, _)| *key == name).map(|(_, value)| (*value).to_owned());
            auto(get, count).map(|shard| shard.to_string())
        };
        let slurm =
            [("SLURM_ARRAY_TASK_ID", "14"), ("SLURM_ARRAY_TASK_MIN", "10"), ("SLURM_ARRAY_TASK_COUNT", "7")];
        assert_eq!(auto(&slurm, None).as_deref(), Ok("5/7"));
        let stepped = [slurm[0], slurm[1], ("SLURM_ARRAY_TASK_COUNT", "3"), ("SLURM_ARRAY_TASK_STEP", "2")];
        assert_eq!(auto(&stepped, None).as_deref(), Ok("3/3"));
        let ci = [("CI_NODE_INDEX", "2"), ("CI_NODE_TOTAL", "4")];
        assert_eq!(auto(&ci, None).as_deref(), Ok("2/4"));
        let kubernetes = [("JOB_COMPLETION_INDEX", "0")];
        assert_eq!(auto(&kubernetes, Some(4)).as_deref(), Ok("1/4"));
        for (set, count, problem) in [
            (&[][..], None, "no scheduler"),
            (&kubernetes, None, "add --shards"),
            (&[ci[0], ci[1], kubernetes[0]], Some(4), "exactly one"),
            (&ci, Some(5), "has 4 shards, --shards 5"),
            (&[("CI_NODE_INDEX", "5"), ci[1]], None, "isn't a shard"),
            (&[("CI_NODE_INDEX", "x"), ci[1]], None, "isn't a whole number"),
            (&[ci[0]], None, "CI_NODE_TOTAL is not set"),
        ] {
            let error = auto(set, count).expect_err("no shard");
            assert!(error.contains(problem), "{error}");
        }
    }

    #[test]
    fn fixed_shard_of_another_count_is_refused() {
        let shard = Shard::new(2, 3).expect("a shard");
        let resolve = |count| ShardChoice::Fixed(shard).resolve(|_| None, count);
        assert_eq!(resolve(Some(3)).ok(), Some(shard));
        let error = resolve(Some(5)).expect_err("another count").to_string();
        assert_eq!(error, "--shard 2/3 is of 3 shards, --shards 5; make them the same");
    }

    #[test]
    fn file_names_read_back() {
        let shard = Shard::new(3, 7).expect("a shard");
        assert_eq!(Shard::of_file_name(&format!("{}.csv.part", shard.stem())), Some(shard));
        for name in ["shard-8-of-7.csv", "shard-0-of-7.csv", "results.csv", "shard-1.csv"] {
            assert_eq!(Shard::of_file_name(name), None, "{name}");
        }
    }
}
