//! When the steps of a run are.

/// Start and period of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StepTimes {
    /// Time of step 0, in ns since 1970; 0 in records of format 2.
    pub start_ns: u64,
    /// Control period.
    pub period_us: u32,
}

/// Names in the metadata of a channel.
const START_NS: &str = "start_ns";
const PERIOD_US: &str = "period_us";
/// What the profile of ROS 2 asks for; none.
const QOS: &str = "offered_qos_profiles";

impl StepTimes {
    /// The time of a step, in ns since 1970.
    #[must_use]
    pub fn at(self, step: u64) -> u64 {
        self.start_ns + step * self.period_ns()
    }

    /// The step of a time.
    pub(super) fn step_at(self, time_ns: u64) -> u64 {
        self.since_start(time_ns) / self.period_ns().max(1)
    }

    /// Nanoseconds from the start of the run.
    pub(super) fn since_start(self, time_ns: u64) -> u64 {
        time_ns.saturating_sub(self.start_ns)
    }

    fn period_ns(self) -> u64 {
        1000 * u64::from(self.period_us)
    }

    /// What the metadata of a channel say about them, as texts.
    pub(super) fn metadata(self) -> [(&'static str, String); 3] {
        [(PERIOD_US, self.period_us.to_string()), (START_NS, self.start_ns.to_string()), (QOS, String::new())]
    }

    /// As the metadata of a channel have them.
    pub(super) fn of(metadata: &[(&str, &str)]) -> Option<Self> {
        let get = |key| metadata.iter().find(|(name, _)| *name == key).map(|(_, text)| *text);
        let start_ns = get(START_NS).map_or(Some(0), |text| text.parse().ok())?;
        Some(Self { start_ns, period_us: get(PERIOD_US)?.parse().ok()? })
    }
}
